//! Settings of a simulation: time axis and method.

use iwan_core::{Error, Grid, Representation};

use crate::error::SimulationError;

/// The method of integration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// Newmark-β time stepping.
    Newmark {
        /// β: 1/4 is average acceleration.
        beta: f64,
        /// γ: 1/2 has no numerical damping.
        gamma: f64,
        /// Whether the period error at small amplitude is removed; average acceleration only.
        prewarp: bool,
        /// Sliders or continuum for the joint.
        joint: Representation,
    },
    /// Half-cycle energy map after the force has settled; until then time steps (Newmark, continuum).
    HalfCycle,
    /// Averaging (Shetty and Allen, J. Vib. Acoust. 142(5), 2020) after the force has settled; approximate.
    Averaging,
    /// Event-driven exact solution of a population of sliders; slow, for reference.
    Event {
        /// Number of bins into which the density is cut.
        bins: usize,
        /// Grid on which the bins lie.
        grid: Grid,
    },
}

impl Method {
    /// The default: prewarped average acceleration on 100 graded bins.
    #[must_use]
    pub fn default_newmark() -> Self {
        Self::Newmark { beta: 0.25, gamma: 0.5, prewarp: true, joint: Representation::default_sliders() }
    }
}

/// Time axis and method of a simulation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Time between samples, s; also the time step of Newmark's method.
    pub dt: f64,
    /// Length of the response, s: samples at 0, dt, 2 dt, …; the last is not later than this.
    pub duration: f64,
    /// Method of integration.
    pub method: Method,
    /// Whether to estimate time-step and discretisation error by companion runs.
    pub quality: bool,
}

impl Settings {
    /// Default method with quality figures.
    #[must_use]
    pub fn new(dt: f64, duration: f64) -> Self {
        Self { dt, duration, method: Method::default_newmark(), quality: true }
    }

    /// Checks that there is memory for the responses of `modes` modes and for `histories` further numbers per sample; allocates nothing.
    ///
    /// # Errors
    /// The errors of [`samples`](Self::samples), and [`SimulationError::Memory`].
    pub(crate) fn ask(&self, modes: usize, histories: usize) -> Result<(), SimulationError> {
        /// Numbers per sample and mode that the check counts: displacement, velocity, acceleration and joint force, and the shares of the
        /// superposed motion of a point, of the times and of the companion runs. Three modes and a point took 5.3 numbers per sample and
        /// mode at 8 million samples.
        const NUMBERS: usize = 6;
        /// Numbers per sample that the companion runs of one mode add under a force from a file: a run with the same step, one with twice
        /// the step, and two forces.
        const COMPANIONS: usize = 6;
        let samples = self.samples()?;
        let bytes = samples
            .saturating_mul(modes.saturating_mul(NUMBERS).saturating_add(COMPANIONS + histories))
            .saturating_mul(8);
        let what = format!("a response of {samples} samples of {modes} modes");
        let remedy = "take a longer step, a shorter duration or fewer modes";
        Ok(iwan_machine::memory::ask(what, bytes as u64, remedy)?)
    }

    /// Number of samples of the response, the initial state included.
    ///
    /// ```
    /// assert_eq!(iwan_sim::Settings::new(1e-5, 0.2).samples()?, 20_001);
    /// # Ok::<(), iwan_core::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when the time step or the duration is not a finite number > 0, or their ratio is not
    /// between 1 and 1e11.
    pub fn samples(&self) -> Result<usize, Error> {
        /// Largest number of steps. More of them, with 32 bytes per sample 3.2 TB, must be a mistake in the input; they are refused by name
        /// before memory is requested. The number is repeated in the message.
        const MOST: f64 = 1e11;
        let positive = |name, value: f64| {
            let allowed = "must be a finite number of seconds > 0";
            if value > 0.0 && value.is_finite() {
                Ok(())
            } else {
                Err(Error::OutOfRange { name, value, allowed })
            }
        };
        positive("time step", self.dt)?;
        positive("duration", self.duration)?;
        // The small factor keeps the rounding of the division from losing the last sample when the duration is a multiple of the step.
        let value = (self.duration / self.dt * (1.0 + 4.0 * f64::EPSILON)).floor();
        if (1.0..MOST).contains(&value) {
            return Ok(value as usize + 1);
        }
        Err(Error::OutOfRange {
            name: "duration / time step",
            value,
            allowed: "must be between 1 and 1e11 steps",
        })
    }
}
