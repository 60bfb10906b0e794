//! The transients that are computed for one configuration of the beam.

use std::sync::atomic::{AtomicUsize, Ordering};

use iwan_core::{Progress, Pulse};
use iwan_fem::{Basis, History, NamedMode, Output, Reduced, Representation, StructureResponse, Transient};
use serde::Serialize;

use super::filter_quality::{FilterQuality, filter_qualities};
use super::paper_beam::PaperBeam;
use crate::blows::{BLOW, DT, LEVELS, STEPS, blow};
use crate::relative_difference::relative_difference;

/// Number of modes in the basis of the reduced model, beside the attachment vectors of the slips. The reduced model then stays within 7e-5 of the
/// full one in mode 1 and within 4e-4 in mode 3 under 1000 lbf (`reduction_error` of the results).
pub(crate) const BASIS: usize = 50;
/// Index of the level 100 lbf, the hardest blow that stays in micro-slip. The ring-downs in one mode alone begin at the velocity that this blow
/// leaves in the mode, so that they pass through the amplitudes of all softer blows, too.
const ALONE: usize = 2;
/// Index of the level that shows the error without attachment vectors: 1000 lbf, at which the joints reach macro-slip.
pub(crate) const WITHOUT_ATTACHMENTS: usize = 3;
/// Indices of the levels at which the full model is integrated, too: 10 lbf in micro-slip and 1000 lbf in macro-slip.
const COMPARED: [usize; 2] = [1, 3];
/// Number of steps of the full model: 20 ms, that is the blow and two and a half cycles of mode 1, in which the joints slip most. A step of the full
/// model takes far longer than one of the reduced model; 0.2 s of it would be most of the time of the whole study.
pub(crate) const FULL: usize = 2000;

/// Difference of the reduced model from the full one over the first 20 ms.
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

/// The results of the runs.
pub(super) struct Responses {
    /// Mean mass-normalised shape of each bending mode at the loaded edge.
    pub(super) tip: Vec<f64>,
    pub(super) blows: Vec<StructureResponse>,
    pub(super) without_attachments: StructureResponse,
    pub(super) alone: Vec<StructureResponse>,
    pub(super) reduction: Vec<ReductionError>,
    pub(super) filters: Vec<FilterQuality>,
}

/// The runs of one configuration.
pub(super) struct Runs<'a> {
    beam: &'a PaperBeam,
    load: Vec<f64>,
    outputs: Vec<Output>,
    progress: Progress<'a>,
    done: AtomicUsize,
}

impl<'a> Runs<'a> {
    /// Prepares the runs; `progress` receives the share done.
    pub(super) fn new(beam: &'a PaperBeam, progress: Progress<'a>) -> Result<Self, iwan_fem::Error> {
        let (assembled, stuck) = (&beam.modes.assembled, &beam.modes.stuck);
        let output = |mode: &NamedMode| assembled.modal_output(&mode.name, stuck, mode.pair.stuck);
        let outputs = beam.bending.iter().map(output).collect();
        let load = assembled.load("tip", [0.0, 0.0, 1.0])?;
        Ok(Self { beam, load, outputs, progress, done: AtomicUsize::new(0) })
    }

    /// The transient under the blow of level `n`.
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

    /// Computes one run and counts it for the progress.
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

    /// Computes a ring-down that starts in one mode, with the largest velocity that the mode had after a blow.
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

    /// The difference of the reduced from the full model under the blow of level `n`.
    fn reduction(&self, n: usize, reduced: &StructureResponse) -> Result<ReductionError, iwan_fem::Error> {
        let assembled = &self.beam.modes.assembled;
        let full = self.run(|report| assembled.transient_observed(&self.blow(n, FULL), report))?;
        let pairs = reduced.outputs.iter().zip(&full.outputs);
        let apart = pairs.map(|(a, b)| relative_difference(&a.acceleration[..=FULL], &b.acceleration));
        Ok(ReductionError { level: LEVELS[n], modes: apart.collect() })
    }
}
