//! A mode of a structure with the joint's part in it.

use iwan_core::{Backbone, Error, Motion, Oscillator, ResidualStiffness};

use crate::joint_law::JointLaw;

/// A physical point at which the modes' responses are superposed.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Name of the point, the same in every mode.
    pub name: String,
    /// Mass-normalised mode shape φ there (mass^-½).
    pub shape: f64,
}

/// A mass-normalised mode: small-amplitude frequency, viscous damping in parallel, and its joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Mode {
    /// Name, unique among the modes of a structure.
    pub name: String,
    /// Frequency at small amplitude (all sliders stuck), Hz.
    pub frequency: f64,
    /// Viscous damping ratio ζ_v, 0.01 = 1 %.
    pub damping_ratio: f64,
    /// The joint in modal coordinates; none for a linear mode.
    pub joint: Option<JointLaw>,
    /// Whether K_∞ = ω0² - K_T may be zero or negative.
    pub residual: ResidualStiffness,
    /// Mass-normalised mode shape at the load: modal force = shape · force.
    pub shape_at_force: f64,
    /// Points at which the physical response is wanted.
    pub outputs: Vec<Point>,
    /// Modal displacement, to which the virgin joint is loaded, and velocity at t = 0.
    pub initial: Motion,
}

impl Mode {
    /// A mode of the given frequency (Hz) and joint: undamped, unit shape at the force, at rest.
    #[must_use]
    pub fn new(name: impl Into<String>, frequency: f64, joint: Option<JointLaw>) -> Self {
        Self {
            name: name.into(),
            frequency,
            damping_ratio: 0.0,
            joint,
            residual: ResidualStiffness::Positive,
            shape_at_force: 1.0,
            outputs: Vec::new(),
            initial: Motion::default(),
        }
    }

    /// The oscillator without the joint.
    ///
    /// # Errors
    /// As [`Oscillator::new`]; initial conditions and the shape at the force must be finite.
    pub fn oscillator(&self) -> Result<Oscillator, Error> {
        let named = [
            ("initial displacement", self.initial.displacement),
            ("initial velocity", self.initial.velocity),
            ("shape_at_force", self.shape_at_force),
        ];
        if let Some(&(name, value)) = named.iter().find(|(_, value)| !value.is_finite()) {
            return Err(Error::OutOfRange { name, value, allowed: "must be a finite number" });
        }
        let k_t = self.joint.as_ref().map_or(0.0, Backbone::initial_stiffness);
        Oscillator::new(self.frequency, self.damping_ratio, k_t, self.residual)
    }

    /// Amplitude-dependent frequency in Hz by first-harmonic balance: ω² = K_∞ + K_1(a) at the modal
    /// amplitude `a`.
    ///
    /// # Errors
    /// As [`oscillator`](Self::oscillator).
    pub fn frequency_at(&self, a: f64) -> Result<f64, Error> {
        let oscillator = self.oscillator()?;
        let joint = self.joint.as_ref().map_or(0.0, |law| law.harmonic_stiffness(a));
        Ok((oscillator.k_inf() + joint).max(0.0).sqrt() / (2.0 * std::f64::consts::PI))
    }

    /// Amplitude-dependent damping ratio ζ = ζ_v ω0/ω + D(a) / (2π ω² a²), with ω of
    /// [`frequency_at`](Self::frequency_at) and the joint's dissipation per cycle D.
    ///
    /// # Errors
    /// As [`oscillator`](Self::oscillator).
    pub fn damping_ratio_at(&self, a: f64) -> Result<f64, Error> {
        let omega = 2.0 * std::f64::consts::PI * self.frequency_at(a)?;
        let viscous = self.damping_ratio * self.oscillator()?.omega0() / omega;
        let joint = self.joint.as_ref().map_or(0.0, |law| law.dissipation(a));
        Ok(viscous + joint / (2.0 * std::f64::consts::PI * (omega * a).powi(2)))
    }
}
