//! The transients that one configuration of the beam is put through.

use std::sync::atomic::{AtomicUsize, Ordering};

use iwan_core::{Progress, Pulse};
use iwan_fem::{Basis, History, NamedMode, Output, Reduced, Representation, StructureResponse, Transient};
use serde::Serialize;

use super::filter_quality::{FilterQuality, filter_qualities};
use super::paper_beam::PaperBeam;
use crate::blows::{BLOW, DT, LEVELS, STEPS, blow};
use crate::relative_difference::relative_difference;

/// Modes of the reduced model, beside the attachment vectors of the slips: it then stays within 7e-5 of the full model in mode 1 and
/// within 4e-4 in mode 3 under 1000 lbf (`reduction_error` of the results).
pub(crate) const BASIS: usize = 50;
/// Level, by index: 100 lbf, the hardest blow that stays in micro-slip. The ring-downs in one mode alone begin at the
/// velocity it leaves in that mode, so that they pass through the amplitudes of all quieter blows too.
const ALONE: usize = 2;
/// Level, by index, that shows what happens without attachment vectors: 1000 lbf, where the joints slip as a whole.
pub(crate) const WITHOUT_ATTACHMENTS: usize = 3;
/// Levels, by index, at which the full model is integrated too: 10 lbf in micro-slip and 1000 lbf in macro-slip.
const COMPARED: [usize; 2] = [1, 3];
/// Steps of the full model: 20 ms, the blow and two and a half cycles of mode 1, in which the joints slip most. A step
/// of the full model takes far longer than one of the reduced model, so that 0.2 s of it would be most of the whole study.
pub(crate) const FULL: usize = 2000;

/// How far the reduced model is from the full one over the first 20 ms.
///
/// Serialised as a pair: the level, then one number for each bending mode.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(into = "(f64, Vec<f64>)")]
pub struct ReductionError {
    /// Peak force of the blow, lbf.
    pub level: f64,
    /// Relative difference of the accelerations of bending modes 1 to 3.
    pub modes: Vec<f64>,
}

impl From<ReductionError> for (f64, Vec<f64>) {
    fn from(ReductionError { level, modes }: ReductionError) -> Self {
        (level, modes)
    }
}

/// What comes of the runs.
pub(super) struct Responses {
    /// Mean shape of each bending mode at the loaded edge.
    pub(super) tip: Vec<f64>,
    pub(super) blows: Vec<StructureResponse>,
    pub(super) without_attachments: StructureResponse,
    pub(super) alone: Vec<StructureResponse>,
    pub(super) reduction: Vec<ReductionError>,
    pub(super) filters: Vec<FilterQuality>,
}

/// What one configuration is put through.
pub(super) struct Runs<'a> {
    beam: &'a PaperBeam,
    load: Vec<f64>,
    outputs: Vec<Output>,
    progress: Progress<'a>,
    done: AtomicUsize,
}

impl<'a> Runs<'a> {
    /// `progress` hears the share done.
    pub(super) fn new(beam: &'a PaperBeam, progress: Progress<'a>) -> Result<Self, iwan_fem::Error> {
        let (assembled, stuck) = (&beam.modes.assembled, &beam.modes.stuck);
        let output = |mode: &NamedMode| assembled.modal_output(&mode.name, stuck, mode.pair.stuck);
        let outputs = beam.bending.iter().map(output).collect();
        let load = assembled.load("tip", [0.0, 0.0, 1.0])?;
        Ok(Self { beam, load, outputs, progress, done: AtomicUsize::new(0) })
    }

    /// The blow of level `n`.
    fn blow(&self, n: usize, steps: usize) -> Transient<'static> {
        Transient {
            dt: DT,
            steps,
            pulse: blow(LEVELS[n]),
            load: self.load.clone(),
            initial_velocity: None,
            representation: Representation::DEFAULT_IN_A_STRUCTURE,
            outputs: self.outputs.clone(),
        }
    }

    /// A run, which counts for the progress.
    fn run(
        &self,
        integrate: impl FnOnce(Progress<'_>) -> Result<StructureResponse, iwan_fem::Error>,
    ) -> Result<StructureResponse, iwan_fem::Error> {
        let pieces = LEVELS.len() + 1 + COMPARED.len() + self.beam.bending.len();
        let share = |share: f64| (self.done.load(Ordering::Relaxed) as f64 + share) / pieces as f64;
        let response = integrate(&|part| (self.progress)(share(part)));
        self.done.fetch_add(1, Ordering::Relaxed);
        response
    }

    /// Shape of a bending mode with all joints stuck.
    fn shape(&self, mode: &NamedMode) -> &'a [f64] {
        self.beam.modes.stuck.shape(mode.pair.stuck)
    }

    /// All runs.
    pub(super) fn all(&self) -> Result<Responses, iwan_fem::Error> {
        let (assembled, bending) = (&self.beam.modes.assembled, &self.beam.bending);
        let at_tip = |mode| self.shape(mode).iter().zip(&self.load).map(|(a, b)| a * b).sum();
        let reduced = assembled.reduce(BASIS, Basis::default())?;
        let blow = |n: usize| self.run(|report| reduced.transient_observed(&self.blow(n, STEPS), report));
        let blows: Vec<StructureResponse> = (0..LEVELS.len()).map(blow).collect::<Result<_, _>>()?;
        let modes = assembled.reduce(BASIS, Basis::Modes)?;
        let hard = self.blow(WITHOUT_ATTACHMENTS, STEPS);
        let without_attachments = self.run(|report| modes.transient_observed(&hard, report))?;
        let pairs = bending.iter().zip(&blows[ALONE].outputs);
        let alone = pairs.map(|(mode, history)| self.ring_down(&reduced, self.shape(mode), history));
        let alone = alone.collect::<Result<_, _>>()?;
        let reduction =
            COMPARED.into_iter().map(|n| self.reduction(n, &blows[n])).collect::<Result<_, _>>()?;
        Ok(Responses {
            tip: bending.iter().map(at_tip).collect(),
            blows,
            without_attachments,
            alone,
            reduction,
            filters: filter_qualities(&reduced)?,
        })
    }

    /// Starts in one mode with the largest velocity it had after a blow.
    fn ring_down(
        &self,
        reduced: &Reduced<'_>,
        shape: &[f64],
        history: &History,
    ) -> Result<StructureResponse, iwan_fem::Error> {
        let after = history.velocity.iter().skip((BLOW / DT) as usize);
        let speed = after.fold(0.0, |most: f64, v| most.max(v.abs()));
        let initial_velocity = Some(shape.iter().map(|x| speed * x).collect());
        let free = Transient { pulse: Pulse::None, initial_velocity, ..self.blow(0, STEPS) };
        self.run(|report| reduced.transient_observed(&free, report))
    }

    /// Differences from the full model under the blow of level `n`.
    fn reduction(&self, n: usize, reduced: &StructureResponse) -> Result<ReductionError, iwan_fem::Error> {
        let assembled = &self.beam.modes.assembled;
        let full = self.run(|report| assembled.transient_observed(&self.blow(n, FULL), report))?;
        let pairs = reduced.outputs.iter().zip(&full.outputs);
        let apart = pairs.map(|(a, b)| relative_difference(&a.acceleration[..=FULL], &b.acceleration));
        Ok(ReductionError { level: LEVELS[n], modes: apart.collect() })
    }
}
