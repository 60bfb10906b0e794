//! The records that are fitted, in which several modes move at once, and what is known of the modes.

use std::sync::atomic::AtomicBool;

use iwan_core::Progress;

use crate::curves::Quantity;
use crate::error::{Error, check, check_dt, check_length, check_samples};
use crate::parameters::Parameters;

/// Least number of samples of a record: with fewer not even the slowest cycle of a mode is there, and the record is refused.
const FEWEST: usize = 32;

/// One blow or ring-down of all modes.
#[derive(Debug, Clone, PartialEq)]
pub struct CoupledRecord {
    /// Name for messages and results.
    pub name: String,
    /// Sampling interval, s.
    pub dt: f64,
    /// The measured series, as [`Seen`] says: one for each mode, or one that is the sum of all. All have the same number of samples.
    pub motions: Vec<Vec<f64>>,
    /// Load at each sample. None: a free decay from the first sample on, with unknown displacement and velocity of each mode there.
    pub force: Option<Vec<f64>>,
}

/// What the series of a record measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Seen {
    /// Modal coordinates by mass-normalised shapes: one series for each mode.
    Modes,
    /// One series that is the sum of all modes, each with an unknown shape at the sensor.
    Sum,
}

/// A mode fitted without the others, as a start: from this crate's other fits, or from values read off curves.
#[derive(Debug, Clone, PartialEq)]
pub struct UncoupledMode {
    /// Name of the mode.
    pub name: String,
    /// The mode's parameters where the other modes are left out.
    pub parameters: Parameters,
}

/// Records, start values and options of a fit.
#[derive(Clone)]
pub struct CoupledTask<'a> {
    /// Records that are fitted.
    pub records: &'a [CoupledRecord],
    /// Records that are kept out of the fit and predicted by it.
    pub held_out: &'a [CoupledRecord],
    /// The modes fitted one by one, at least two.
    pub modes: &'a [UncoupledMode],
    /// What the series measure.
    pub quantity: Quantity,
    /// What the series are.
    pub seen: Seen,
    /// Mass-normalised shape of each mode at the load, where it is known.
    pub shape_at_force: Option<&'a [f64]>,
    /// Number of threads; the results do not depend on it.
    pub threads: usize,
    /// Set to true from outside to end the fit soon.
    pub stopped: &'a AtomicBool,
    /// Called with the share of the work done after each model and each interval; `Break` ends the fit there.
    pub progress: Progress<'a>,
}

impl std::fmt::Debug for CoupledTask<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { records, held_out, modes, quantity, seen, .. } = self;
        write!(f, "CoupledTask {{ {records:?}, {held_out:?}, {modes:?}, {quantity:?}, {seen:?}, .. }}")
    }
}

impl CoupledTask<'_> {
    /// Refuses records, modes and shapes that do not fit together.
    pub(super) fn check(&self) -> Result<(), Error> {
        let (modes, n) = (self.modes.len(), self.records.len());
        check("modes", modes as f64, modes >= 2, "at least two", "name the modes with --band or --mode")?;
        check("records", n as f64, n >= 1, "at least one", "give a record")?;
        for mode in self.modes {
            mode.parameters.model()?;
        }
        if let Some(shape) = self.shape_at_force {
            check_length("shape_at_force", shape.len(), modes)?;
            check_samples("shape_at_force", shape, modes, "give one number for each mode")?;
        }
        let series = if self.seen == Seen::Modes { modes } else { 1 };
        for record in self.records.iter().chain(self.held_out) {
            check_dt(record.dt)?;
            check_length("motions", record.motions.len(), series)?;
            let samples = record.motions[0].len();
            for motion in &record.motions {
                check_samples("record", motion, FEWEST, "record longer")?;
                check_length("motion", motion.len(), samples)?;
            }
            if let Some(force) = &record.force {
                check_samples("force", force, FEWEST, "record longer")?;
                check_length("force", force.len(), samples)?;
                let peak = force.iter().fold(0.0, |most: f64, f| most.max(f.abs()));
                if peak == 0.0 {
                    return Err(Error::Refused {
                        finding: format!("{}: the force is zero throughout", record.name),
                        remedy: "name the channel that holds the force, or leave the force of all records out: they are free decays then",
                    });
                }
            }
            let all = self.records.iter().chain(self.held_out);
            if all.clone().any(|other| other.force.is_some() != record.force.is_some()) {
                return Err(Error::Refused {
                    finding: format!("{} and others differ in whether the force is known", record.name),
                    remedy: "give the force of all records, or of none",
                });
            }
        }
        Ok(())
    }
}
