//! Many modes, each simulated by itself on all threads; the results are figures and, if requested, histories.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use iwan_core::progress::{Progress, UNWATCHED};
use iwan_core::{Error, Pulse};
use iwan_machine::memory::{Short, ask};
use iwan_machine::threads::together;

use crate::error::SimulationError;
use crate::mode::Mode;
use crate::response::Response;
use crate::settings::Settings;
use crate::simulate::simulate_observed;

/// A history that an ensemble can keep.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum History {
    /// Modal displacement.
    Displacement,
    /// Modal velocity.
    Velocity,
    /// Modal acceleration.
    Acceleration,
    /// Modal joint force.
    JointForce,
}

impl History {
    fn samples(self, response: &Response) -> &[f64] {
        match self {
            Self::Displacement => &response.displacement,
            Self::Velocity => &response.velocity,
            Self::Acceleration => &response.acceleration,
            Self::JointForce => &response.joint_force,
        }
    }
}

/// Results for one member.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Figures {
    /// Largest |q| among the samples.
    pub peak_displacement: f64,
    /// Displacement at the last sample.
    pub final_displacement: f64,
    /// Peak |q| over φ_max: macro-slip above 1.
    pub slip_ratio: f64,
    /// |residual| of the energy balance, relative to the largest energy.
    pub energy_error: f64,
}

/// Many simulations that share force, time axis and method.
#[derive(Clone, Copy)]
pub struct Ensemble<'a> {
    /// Number of members.
    pub members: usize,
    /// The mode of each member, by its index.
    pub mode: &'a (dyn Fn(usize) -> Result<Mode, Error> + Sync),
    /// Force on all members; a mode's `shape_at_force` scales it.
    pub force: Pulse<'a>,
    /// Time axis and method; error estimates (`quality`) are not computed.
    pub settings: Settings,
    /// Histories that are kept.
    pub kept: &'a [History],
}

impl std::fmt::Debug for Ensemble<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Ensemble")
            .field("members", &self.members)
            .field("kept", &self.kept)
            .finish_non_exhaustive()
    }
}

/// Results of an ensemble.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Outcome {
    /// One entry per member.
    pub figures: Vec<Figures>,
    /// One list per kept history: the samples of the first member, then those of the second, and so on.
    pub histories: Vec<Vec<f64>>,
    /// Number of samples per member.
    pub samples: usize,
}

/// An error and the member that it belongs to.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("member {member}: {source}")]
pub struct MemberError {
    /// Index of the member.
    pub member: usize,
    /// What went wrong.
    pub source: SimulationError,
}

/// Largest number of members that a thread takes at a time. A member takes at least some 10 µs, so a few together already hide the cost of
/// the lock that hands them out. Each chunk ends with a call of `progress`, which should come before thousands of members are done.
const CHUNK: usize = 64;

/// Smallest number of chunks per thread, if there are enough members: the threads then end within an eighth of their work of each other.
const CHUNKS_A_THREAD: usize = 8;

/// Some consecutive members, with the memory for their results.
struct Chunk<'a> {
    first: usize,
    figures: &'a mut [Figures],
    histories: Vec<&'a mut [f64]>,
}

impl Ensemble<'_> {
    /// Simulates all members on up to `threads` threads; each thread reuses its own buffers. The results have the same bits for any number
    /// of threads. `progress` is called with the share of members done.
    ///
    /// # Errors
    /// [`MemberError`] with the first member that failed, or with [`SimulationError::Interrupted`] when `progress` returned `Break`.
    ///
    /// ```
    /// use iwan_core::{FourParameter, Motion, Pulse};
    /// use iwan_sim::{Ensemble, JointLaw, Mode, Settings};
    /// let mode = |i: usize| {
    ///     let joint = FourParameter::new(4.45e4, 239.4 * (1.0 + i as f64), -0.183, 0.3)?;
    ///     Ok(Mode { initial: Motion::held_at(1e-3), ..Mode::new("bending 1", 124.0, Some(JointLaw::FourParameter(joint))) })
    /// };
    /// let settings = Settings::new(1e-4, 0.1);
    /// let ensemble = Ensemble { members: 100, mode: &mode, force: Pulse::None, settings, kept: &[] };
    /// let outcome = ensemble.run(2, iwan_core::progress::UNWATCHED)?;
    /// assert!(outcome.figures[0].slip_ratio > 99.0 * outcome.figures[99].slip_ratio);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn run(&self, threads: usize, progress: Progress<'_>) -> Result<Outcome, MemberError> {
        let samples =
            self.settings.samples().map_err(|error| MemberError { member: 0, source: error.into() })?;
        self.ask(samples).map_err(|short| MemberError { member: 0, source: short.into() })?;
        let mut outcome = Outcome {
            figures: vec![Figures::default(); self.members],
            histories: self.kept.iter().map(|_| vec![0.0; self.members * samples]).collect(),
            samples,
        };
        let work = Work { ensemble: *self, done: AtomicUsize::new(0), failed: Mutex::new(None), progress };
        let chunks = Mutex::new(outcome.chunks(threads));
        let serve = || work.serve(&chunks);
        together(threads.clamp(1, self.members.max(1)), &serve);
        drop(chunks);
        match work.failed.into_inner().unwrap_or_else(PoisonError::into_inner) {
            Some(error) => Err(error),
            None => Ok(outcome),
        }
    }
}

impl Ensemble<'_> {
    /// Checks that there is memory for figures and histories.
    fn ask(&self, samples: usize) -> Result<(), Short> {
        let row = samples.saturating_mul(self.kept.len()).saturating_mul(size_of::<f64>());
        let bytes = self.members.saturating_mul(row.saturating_add(size_of::<Figures>()));
        let what = format!("an ensemble of {} members", self.members);
        ask(what, bytes as u64, "keep fewer histories, or take fewer members at a time")
    }
}

impl Outcome {
    /// The members in their order, divided into chunks.
    fn chunks(&mut self, threads: usize) -> std::vec::IntoIter<Chunk<'_>> {
        let size = (self.figures.len() / (CHUNKS_A_THREAD * threads.max(1))).clamp(1, CHUNK);
        let row = size * self.samples.max(1);
        let mut histories: Vec<_> = self.histories.iter_mut().map(|h| h.chunks_mut(row)).collect();
        let chunk = |(i, figures)| Chunk {
            first: i * size,
            figures,
            histories: histories.iter_mut().filter_map(Iterator::next).collect(),
        };
        self.figures.chunks_mut(size).enumerate().map(chunk).collect::<Vec<_>>().into_iter()
    }
}

struct Work<'a> {
    ensemble: Ensemble<'a>,
    done: AtomicUsize,
    failed: Mutex<Option<MemberError>>,
    progress: Progress<'a>,
}

impl Work<'_> {
    /// Takes chunk after chunk until none is left or a member has failed. Chunks are handed out in order, and a chunk that has begun is
    /// finished unless one of its own members fails. So the reported first failure is the same for any number of threads.
    fn serve(&self, chunks: &Mutex<std::vec::IntoIter<Chunk<'_>>>) {
        let mut spare = Response::default();
        loop {
            if lock(&self.failed).is_some() {
                return;
            }
            let Some(mut chunk) = lock(chunks).next() else { return };
            let mut result = self.simulate(&mut chunk, &mut spare);
            let done = self.done.fetch_add(chunk.figures.len(), Ordering::Relaxed) + chunk.figures.len();
            let share = done as f64 / self.ensemble.members as f64;
            if result.is_ok() && (self.progress)(share).is_break() {
                result = Err(MemberError { member: 0, source: SimulationError::Interrupted });
            }
            if let Err(error) = result {
                let mut failed = lock(&self.failed);
                if failed.as_ref().is_none_or(|other| error.member < other.member) {
                    *failed = Some(error);
                }
            }
        }
    }

    fn simulate(&self, chunk: &mut Chunk<'_>, spare: &mut Response) -> Result<(), MemberError> {
        let settings = Settings { quality: false, ..self.ensemble.settings };
        for (i, figures) in chunk.figures.iter_mut().enumerate() {
            let member = chunk.first + i;
            let named = |source| MemberError { member, source };
            let mode = (self.ensemble.mode)(member).map_err(|error| named(error.into()))?;
            let buffers = std::mem::take(spare);
            let response = simulate_observed(&mode, &self.ensemble.force, &settings, buffers, UNWATCHED);
            let response = response.map_err(named)?;
            *figures = Figures {
                peak_displacement: response.peak_displacement(),
                final_displacement: response.displacement.last().copied().unwrap_or(0.0),
                slip_ratio: response.slip_ratio(),
                energy_error: response.energy.error(),
            };
            let rows = response.displacement.len() * i..response.displacement.len() * (i + 1);
            for (history, kept) in chunk.histories.iter_mut().zip(self.ensemble.kept) {
                history[rows.clone()].copy_from_slice(kept.samples(&response));
            }
            *spare = response;
        }
        Ok(())
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use iwan_core::FourParameter;

    use super::*;
    use crate::{JointLaw, Method, simulate};

    fn mode(i: usize) -> Result<Mode, Error> {
        let joint = FourParameter::new(4.45e4 - 10.0 * i as f64, 239.4, -0.183, 0.3)?;
        Ok(Mode::new("mode", 124.0, Some(JointLaw::FourParameter(joint))))
    }

    fn ensemble(mode: &(dyn Fn(usize) -> Result<Mode, Error> + Sync), method: Method) -> Ensemble<'_> {
        let force = Pulse::Haversine { amplitude: 2e3, duration: 1.6e-3 };
        let settings = Settings { method, ..Settings::new(1e-4, 0.05) };
        Ensemble { members: 150, mode, force, settings, kept: &[History::Velocity, History::JointForce] }
    }

    /// Reused buffers leave no trace in the results, and neither does the number of threads.
    #[test]
    fn members_are_simulations_by_themselves() {
        for method in [Method::default_newmark(), Method::HalfCycle] {
            let ensemble = ensemble(&mode, method);
            let one = ensemble.run(1, UNWATCHED).unwrap();
            assert_eq!(one, ensemble.run(3, UNWATCHED).unwrap());
            for i in [0, 1, 63, 64, 149] {
                let alone = simulate(&mode(i).unwrap(), &ensemble.force, &ensemble.settings).unwrap();
                let rows = i * one.samples..(i + 1) * one.samples;
                assert_eq!(one.histories[0][rows.clone()], alone.velocity);
                assert_eq!(one.histories[1][rows], alone.joint_force);
                assert_eq!(one.figures[i].peak_displacement, alone.peak_displacement());
                assert_eq!(one.figures[i].energy_error, alone.energy.error());
            }
        }
    }

    #[test]
    fn the_first_member_that_fails_is_named() {
        let bad = |i: usize| {
            if i % 40 == 37 { FourParameter::new(-1.0, 1.0, 0.0, 0.0).and(mode(i)) } else { mode(i) }
        };
        for threads in [1, 2, 5] {
            let error = ensemble(&bad, Method::default_newmark()).run(threads, UNWATCHED).unwrap_err();
            assert_eq!(error.member, 37, "{threads} threads");
        }
        let stop: Progress<'_> = &|_| std::ops::ControlFlow::Break(());
        let error = ensemble(&mode, Method::default_newmark()).run(2, stop).unwrap_err();
        assert_eq!(error.source, SimulationError::Interrupted);
    }
}
