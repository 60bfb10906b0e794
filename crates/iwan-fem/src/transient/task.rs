//! The task of a transient: force, time axis, initial velocity, and what is recorded.

use iwan_core::Pulse;

use crate::error::{Error, check};
use crate::matrices::Assembled;
use crate::modes::Modes;
use iwan_core::Representation;

/// A recorded output, a linear functional of the unknowns: a displacement, a mean over nodes, or a modal coordinate.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// Name of the output.
    pub name: String,
    /// Coefficients of the functional, one per unknown.
    pub coefficients: Vec<f64>,
}

/// A transient: force, time axis, initial velocity, representation of the joints, and outputs.
#[derive(Debug, Clone)]
pub struct Transient<'a> {
    /// Time step, s.
    pub dt: f64,
    /// Number of steps; the response has one sample more.
    pub steps: usize,
    /// History p(t) of the force.
    pub pulse: Pulse<'a>,
    /// Forces g on the unknowns for p = 1 ([`Assembled::load`]).
    pub load: Vec<f64>,
    /// Velocities of the unknowns at t = 0; none if the structure starts at rest. Displacements and joint forces are zero at t = 0.
    pub initial_velocity: Option<Vec<f64>>,
    /// Representation of the joints: sliders or continuum.
    pub representation: Representation,
    /// The outputs that are recorded.
    pub outputs: Vec<Output>,
}

/// Largest number of recorded numbers (8 GB). A task that needs more is refused before anything is allocated.
const MOST_NUMBERS: f64 = 1e9;

impl Transient<'_> {
    /// Number of whole time steps in a duration; rounding does not lose the last step of a duration that is a multiple of the step.
    #[must_use]
    pub fn steps_in(dt: f64, duration: f64) -> usize {
        (duration / dt * (1.0 + 1e-12)).floor() as usize
    }

    /// Checks numbers and lengths.
    pub(crate) fn check(&self, unknowns: usize, slips: usize) -> Result<(), Error> {
        check("time step", self.dt, self.dt > 0.0, "must be a finite number of seconds > 0")?;
        check(
            "steps",
            self.steps as f64,
            self.steps as f64 * (4 * self.outputs.len() + 2 * slips) as f64 <= MOST_NUMBERS,
            "the response would need more than 8 GB of memory; lengthen the time step, shorten the duration, or ask for fewer outputs",
        )?;
        self.pulse.checked()?;
        let lengths = self.outputs.iter().map(|o| o.coefficients.len());
        let velocity = self.initial_velocity.iter().map(Vec::len);
        if let Some(found) = lengths.chain(velocity).chain([self.load.len()]).find(|&found| found != unknowns)
        {
            let finding = format!(
                "a load, initial velocity or output has {found} entries, the structure has {unknowns} unknowns"
            );
            return Err(Error::Analysis {
                analysis: "transient",
                finding,
                remedy: "make them with the same assembled structure",
            });
        }
        let given = self.load.iter().chain(self.initial_velocity.iter().flatten());
        let bad = given.chain(self.outputs.iter().flat_map(|o| &o.coefficients)).find(|x| !x.is_finite());
        bad.map_or(Ok(()), |&value| {
            Err(Error::OutOfRange {
                name: "load, initial velocity or output",
                value,
                allowed: "must be finite",
            })
        })
    }

    /// Force p at each sample.
    pub(crate) fn force(&self) -> Vec<f64> {
        let mut force = vec![0.0; self.steps + 1];
        self.pulse.sample(self.dt, &mut force);
        force
    }
}

impl Assembled {
    /// The modal coordinate q = φᵀ M x of a mode as an output: the exact modal filter.
    ///
    /// # Panics
    /// When `modes` belongs to another structure or has no mode `index`.
    #[must_use]
    pub fn modal_output(&self, name: impl Into<String>, modes: &Modes, index: usize) -> Output {
        Output { name: name.into(), coefficients: self.mass().times(modes.shape(index)) }
    }

    /// The mean displacement of a node set along `direction` as an output.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn output(&self, name: impl Into<String>, set: &str, direction: [f64; 3]) -> Result<Output, Error> {
        Ok(Output { name: name.into(), coefficients: self.gauge(set, direction)? })
    }
}
