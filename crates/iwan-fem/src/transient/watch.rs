//! The listener of a transient's progress, and the checkpoint that keeps its state.

use std::fmt;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use iwan_core::Progress;
use iwan_core::progress::UNWATCHED;
use iwan_machine::checkpoint::{Checkpoint, Digest, State};

use super::response::Recorder;
use super::task::Transient;
use crate::error::Error;
use crate::matrices::Assembled;
use crate::structure::Law;

/// Number of points of a virgin curve by which laws are compared, from a thousandth of the strongest slider's strength to ten times it.
/// Laws that agree in all of them to the last bit count as the same.
const POINTS: i32 = 33;

/// The listener of a transient's progress, which may stop it, and the checkpoint that keeps its state, so that another process can continue
/// it and end with the same bits.
///
/// Functions that take a `Watch` also take a progress alone, by reference: `UNWATCHED`, or a function of the share done.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    /// The listener; it is called with the share done.
    pub progress: Progress<'a>,
    /// The checkpoint that keeps the state; none if nothing is kept.
    pub kept: Option<&'a Checkpoint>,
}

impl Watch<'_> {
    /// The same checkpoint with another listener, for a part of the work.
    pub(crate) fn with<'b>(&'b self, progress: Progress<'b>) -> Watch<'b> {
        Watch { progress, kept: self.kept }
    }
}

impl fmt::Debug for Watch<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Watch").field("kept", &self.kept).finish_non_exhaustive()
    }
}

impl Default for Watch<'_> {
    fn default() -> Self {
        Self { progress: UNWATCHED, kept: None }
    }
}

impl<'a> From<Progress<'a>> for Watch<'a> {
    fn from(progress: Progress<'a>) -> Self {
        Self { progress, kept: None }
    }
}

impl<'a, F: Fn(f64) -> ControlFlow<()> + Sync> From<&'a F> for Watch<'a> {
    fn from(progress: &'a F) -> Self {
        Self { progress, kept: None }
    }
}

/// A function that passes all numbers of a state to another function, which may change them.
pub(crate) type EachNumber<'a> = &'a mut dyn FnMut(&mut dyn FnMut(&mut f64));

/// Saves the state of one transient from time to time.
pub(crate) struct Keeper<'a> {
    kept: Option<(&'a Checkpoint, u128)>,
    last: Instant,
    wait: Duration,
}

impl<'a> Keeper<'a> {
    /// The keeper for one transient; `model` adds to the digest what distinguishes the model of the structure from others.
    pub(crate) fn new(
        watch: &Watch<'a>,
        assembled: &Assembled,
        task: &Transient<'_>,
        force: &[f64],
        model: impl FnOnce(Digest) -> Digest,
    ) -> Self {
        let key = || {
            let laws = assembled.slips().iter().map(|slip| slip.law.as_ref());
            let mut digest = laws.fold(model(Digest::default()), |digest, law| digest.numbers(&points(law)));
            digest = digest.text(&assembled.fingerprint()).text(&task.representation);
            digest = digest.numbers(&[task.dt]).numbers(force).numbers(&task.load);
            digest = digest.numbers(task.initial_velocity.as_deref().unwrap_or(&[]));
            task.outputs.iter().fold(digest, |digest, output| digest.numbers(&output.coefficients)).value()
        };
        Self {
            kept: watch.kept.map(|kept| (kept, key())),
            last: Instant::now(),
            wait: Duration::from_secs(1),
        }
    }

    /// Restores the state that was saved last, and returns the number of steps done; 0 if there is none.
    pub(crate) fn resume(&self, recorder: &mut Recorder, numbers: EachNumber<'_>) -> Result<usize, Error> {
        let Some(State { steps, numbers: lists }) = self.kept.and_then(|(kept, key)| kept.state(key)) else {
            return Ok(0);
        };
        let mut lists = lists.into_iter();
        let mut written = lists.next().unwrap_or_default().into_iter();
        let mut enough = true;
        let mut take = |x: &mut f64| match written.next() {
            Some(number) => *x = number,
            None => enough = false,
        };
        numbers(&mut take);
        recorder.each_number(&mut take);
        let whole = enough && written.next().is_none() && recorder.take_up(lists, steps + 1);
        if whole { Ok(steps) } else { Err(misfit()) }
    }

    /// Saves the state after `steps` steps if enough time has passed since the last time.
    pub(crate) fn keep_in_time(&mut self, steps: usize, recorder: &mut Recorder, numbers: EachNumber<'_>) {
        if self.kept.is_some() && self.last.elapsed() > self.wait {
            self.keep(steps, recorder, numbers);
        }
    }

    /// Saves the state after `steps` steps in any case, as at the end.
    pub(crate) fn keep(&mut self, steps: usize, recorder: &mut Recorder, numbers: EachNumber<'_>) {
        if let Some((kept, key)) = self.kept {
            let mut written = Vec::new();
            let mut write = |x: &mut f64| written.push(*x);
            numbers(&mut write);
            recorder.each_number(&mut write);
            let lists: Vec<&[f64]> = std::iter::once(written.as_slice()).chain(recorder.lists()).collect();
            self.wait = kept.replace(key, steps, &lists);
            self.last = Instant::now();
        }
    }
}

/// Numbers by which a law is distinguished from others.
fn points(law: Option<&Law>) -> Vec<f64> {
    let Some(law) = law else { return Vec::new() };
    let (weakest, strongest) = law.strengths();
    let at = |i: i32| strongest * 10.0_f64.powf(-3.0 + 4.0 * f64::from(i) / f64::from(POINTS - 1));
    let curve = (0..POINTS).flat_map(|i| <[f64; 2]>::from(law.force_and_tangent(at(i))));
    curve.chain([weakest, strongest, law.initial_stiffness(), law.slip_force()]).collect()
}

/// The error for a saved state that is undamaged but belongs to another transient.
fn misfit() -> Error {
    Error::Analysis {
        analysis: "transient",
        finding: "the state in the checkpoint does not fit".into(),
        remedy: "remove the folder of the checkpoint, and begin anew",
    }
}
