//! What is to be integrated: the force, the time axis, where the structure starts, what is recorded.

use iwan_core::Pulse;

use crate::error::{Error, check};
use crate::matrices::Assembled;
use crate::modes::Modes;
use iwan_core::Representation;

/// A linear functional of the unknowns that is recorded: a displacement, a mean over nodes, a modal coordinate.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// Name.
    pub name: String,
    /// Its coefficients, one per unknown.
    pub coefficients: Vec<f64>,
}

/// A transient: force, time axis, initial velocity, joints' evaluation, what is recorded.
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
    /// Velocities of the unknowns at t = 0; none: at rest. Displacements and joint forces are zero then.
    pub initial_velocity: Option<Vec<f64>>,
    /// How the joints are evaluated.
    pub representation: Representation,
    /// What is recorded.
    pub outputs: Vec<Output>,
}

/// More numbers than this (8 GB) are not kept in memory: the task is refused before anything is allocated.
const MOST_NUMBERS: f64 = 1e9;

impl Transient<'_> {
    /// Number of whole time steps in a duration; a duration that is a multiple of the step loses none to rounding.
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

    /// Force at each sample.
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
