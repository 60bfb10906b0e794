//! A mode of a structure with its joint.

use iwan_core::{Backbone, Error, Motion, Oscillator, Part, ResidualStiffness, sum_of_parts};

use crate::curves::Curves;
use crate::joint_law::JointLaw;

/// A physical point at which the modes' responses are superposed.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Name of the point, the same in every mode.
    pub name: String,
    /// Mass-normalised mode shape φ at the point (mass^-½).
    pub shape: f64,
}

/// A mass-normalised mode: its small-amplitude frequency, viscous damping in parallel, its joint and further parts; or curves in place of
/// damping, joint and parts.
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
    /// Dampers and springs beside the joint, mass-normalised.
    pub parts: Vec<Part>,
    /// Curves that replace damping ratio, joint and parts, which must then be left out; `frequency` is then the frequency at the smallest
    /// amplitude.
    pub curves: Option<Curves>,
    /// Whether K_∞ = ω0² - K_T may be zero or negative.
    pub residual: ResidualStiffness,
    /// Mass-normalised mode shape at the load: modal force = shape · force.
    pub shape_at_force: f64,
    /// Points at which the physical response is wanted.
    pub outputs: Vec<Point>,
    /// Modal displacement and velocity at t = 0; the virgin joint is loaded statically to this displacement.
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
            parts: Vec::new(),
            curves: None,
            residual: ResidualStiffness::Positive,
            shape_at_force: 1.0,
            outputs: Vec::new(),
            initial: Motion::default(),
        }
    }

    /// A mode known by its curves alone.
    #[must_use]
    pub fn by_curves(name: impl Into<String>, curves: Curves) -> Self {
        let frequency = curves.table()[1].first().copied().unwrap_or(f64::NAN);
        Self { curves: Some(curves), ..Self::new(name, frequency, None) }
    }

    /// Whether the mode consists of an oscillator with a viscous damper and at most one Iwan joint: no parts and no curves.
    #[must_use]
    pub fn is_plain(&self) -> bool {
        self.parts.is_empty() && self.curves.is_none()
    }

    /// Whether friction in its joint drops once a slider slips, so that Masing's rule does not hold.
    #[must_use]
    pub fn friction_drops(&self) -> bool {
        self.joint.as_ref().is_some_and(|law| law.friction_ratio() != 1.0)
    }

    /// The same mode with the cycles of its joint as they are after motions of amplitudes up to `largest`: see [`JointLaw::after`].
    #[must_use]
    pub fn after(&self, largest: f64) -> Self {
        Self { joint: self.joint.as_ref().map(|law| law.after(largest)), ..self.clone() }
    }

    /// The oscillator without the joint and the parts.
    ///
    /// # Errors
    /// As [`Oscillator::new`]; initial conditions and the shape at the force must be finite. [`Error::Unsupported`] for
    /// curves beside a law.
    pub fn oscillator(&self) -> Result<Oscillator, Error> {
        let named = [
            ("initial displacement", self.initial.displacement),
            ("initial velocity", self.initial.velocity),
            ("shape_at_force", self.shape_at_force),
        ];
        if let Some(&(name, value)) = named.iter().find(|(_, value)| !value.is_finite()) {
            return Err(Error::OutOfRange { name, value, allowed: "must be a finite number" });
        }
        let law = self.joint.is_some() || !self.parts.is_empty() || self.damping_ratio != 0.0;
        if self.curves.is_some() && law {
            let what =
                "curves stand in place of joint, parts and damping_ratio: leave these out, or the curves";
            return Err(Error::Unsupported { what });
        }
        let k_t = self.joint.as_ref().map_or(0.0, Backbone::initial_stiffness);
        Oscillator::new(self.frequency, self.damping_ratio, k_t, self.residual)
    }

    /// Amplitude-dependent frequency in Hz by first-harmonic balance: ω² = K_∞ + K_1(a) with joint and parts, at the modal amplitude `a`.
    /// For a mode given by curves, the frequency of the curves.
    ///
    /// # Errors
    /// As [`oscillator`](Self::oscillator).
    pub fn frequency_at(&self, a: f64) -> Result<f64, Error> {
        let oscillator = self.oscillator()?;
        if let Some(curves) = &self.curves {
            return Ok(curves.points().at(a.abs()).omega / (2.0 * std::f64::consts::PI));
        }
        let joint = self.joint.as_ref().map_or(0.0, |law| law.harmonic_stiffness(a));
        let parts = sum_of_parts(&self.parts, |part| part.harmonic_stiffness(a, oscillator.omega0()));
        Ok((oscillator.k_inf() + (joint + parts)).max(0.0).sqrt() / (2.0 * std::f64::consts::PI))
    }

    /// Energy lost per cycle of amplitude `a` to joint and parts, without the viscous damper. For a mode given by curves, all of the loss,
    /// 2π ζ ω² a².
    ///
    /// # Errors
    /// As [`oscillator`](Self::oscillator).
    pub fn dissipation_at(&self, a: f64) -> Result<f64, Error> {
        let omega = 2.0 * std::f64::consts::PI * self.frequency_at(a)?;
        if let Some(curves) = &self.curves {
            let zeta = curves.points().at(a.abs()).damping_ratio;
            return Ok(2.0 * std::f64::consts::PI * zeta * (omega * a).powi(2));
        }
        let joint = self.joint.as_ref().map_or(0.0, |law| law.dissipation(a));
        Ok(joint + sum_of_parts(&self.parts, |part| part.dissipation(a, omega)))
    }

    /// Amplitude-dependent damping ratio ζ = ζ_v ω0/ω + D(a) / (2π ω² a²), with ω from [`frequency_at`](Self::frequency_at) and the
    /// dissipation per cycle D of joint and parts. For a mode given by curves, the damping ratio of the curves.
    ///
    /// # Errors
    /// As [`oscillator`](Self::oscillator).
    pub fn damping_ratio_at(&self, a: f64) -> Result<f64, Error> {
        let omega = 2.0 * std::f64::consts::PI * self.frequency_at(a)?;
        let viscous = self.damping_ratio * self.oscillator()?.omega0() / omega;
        if let Some(curves) = &self.curves {
            return Ok(curves.points().at(a.abs()).damping_ratio);
        }
        Ok(viscous + self.dissipation_at(a)? / (2.0 * std::f64::consts::PI * (omega * a).powi(2)))
    }
}
