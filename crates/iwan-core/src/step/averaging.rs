//! Averaging: the slowly varying amplitude and phase are integrated instead of the oscillation itself.
//!
//! da/dt = -D(a)/(2π a ω) - ζ_v ω0 a and dθ/dt = ω(a) with q = a cos θ (M. Shetty and M. S. Allen, Fast
//! simulation of a single degree-of-freedom system consisting of an Iwan element using the method of
//! averaging, J. Vib. Acoust. 142(5), 2020). Here ω² = K_∞ + K_1(a) contains the first-harmonic stiffness K_1 in place of the secant
//! stiffness, which makes the error of the mean frequency many times smaller. Averaging is an approximation of first order in the damping.

use core::f64::consts::PI;

use super::energy::EnergyBalance;
use super::modal_law::ModalLaw;
use super::motion::Motion;
use super::oscillator::Oscillator;
use super::response::Samples;
use super::slow::{AmplitudePhase, Rates, SlowMotion};
use crate::error::{Error, check};
use crate::law::Backbone;

/// Free decay of a mode by averaging.
///
/// ```
/// use iwan_core::{Averaging, Backbone, FourParameter, Motion, Oscillator, ResidualStiffness};
/// let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3)?;
/// let mode = Oscillator::new(124.0, 0.0, joint.k_t(), ResidualStiffness::Positive)?;
/// let amplitude = 0.1 * joint.phi_max();
/// let mut decay = Averaging::new(&mode, &joint, Motion::held_at(amplitude))?;
/// // After a tenth of a period the amplitude has fallen at the rate D/(2π a² ω).
/// let t = 0.1 / 124.0;
/// let fallen = (amplitude / decay.at(t).amplitude).ln();
/// assert!((fallen / (t * decay.decay_rate(amplitude)) - 1.0).abs() < 1e-3);
/// # Ok::<(), iwan_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Averaging<'a, B> {
    motion: SlowMotion<ModalLaw<'a, B>>,
}

impl<B: Backbone> Rates for ModalLaw<'_, B> {
    fn frequency(&self, amplitude: f64) -> f64 {
        Self::frequency(self, amplitude)
    }

    fn decay_rate(&self, amplitude: f64) -> f64 {
        Self::decay_rate(self, amplitude)
    }
}

impl<'a, B: Backbone> Averaging<'a, B> {
    /// Averaging of a free decay that begins with the motion `start`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when a value is not finite or K_∞ <= 0.
    pub fn new(oscillator: &Oscillator, law: &'a B, start: Motion) -> Result<Self, Error> {
        Self::of_law(ModalLaw::new(*oscillator, Some(law), &[]), start)
    }

    /// Averaging for a law with parts, with or without a joint.
    ///
    /// Dry friction takes the amplitude to zero in a finite time. In reality it stops the mode for good somewhere within F/K of the middle;
    /// averaging does not represent that.
    ///
    /// # Errors
    /// The errors of [`new`](Self::new); also [`Error::OutOfRange`] when a softening spring leaves no stiffness at the start.
    pub fn of_law(law: ModalLaw<'a, B>, start: Motion) -> Result<Self, Error> {
        let oscillator = law.oscillator();
        let k_inf = oscillator.k_inf();
        check("k_inf", k_inf, k_inf > 0.0, "averaging needs K_inf = omega0^2 - k_t > 0")?;
        let omega0 = oscillator.omega0();
        Ok(Self { motion: SlowMotion::new(law, omega0, start)? })
    }

    fn law(&self) -> &ModalLaw<'a, B> {
        &self.motion.rates
    }

    /// Circular frequency ω(a), rad/s.
    #[must_use]
    pub fn frequency(&self, amplitude: f64) -> f64 {
        self.law().frequency(amplitude)
    }

    /// Decay rate -a'/a, 1/s.
    #[must_use]
    pub fn decay_rate(&self, amplitude: f64) -> f64 {
        self.law().decay_rate(amplitude)
    }

    /// Amplitude and phase at the time `t` since the start; `t` must not be earlier than in the last call.
    pub fn at(&mut self, t: f64) -> AmplitudePhase {
        self.motion.at(t)
    }

    /// Energy balance from the start to the time `t` in terms of the amplitude: the work of friction and damper by the averaged equations,
    /// against the energy at the turning points ½ K_∞ a² + G(a). The residual is the error of averaging itself.
    #[must_use]
    pub fn energy(&self, t: f64) -> EnergyBalance {
        let law = self.law();
        let elastic = |a: f64| 0.5 * law.oscillator().k_inf() * a * a;
        let stored = |a: f64| law.added_energy(a);
        // Powers lost to friction and to the damper.
        let powers = |a: f64| {
            let omega = law.frequency(a);
            let damper = 0.5 * law.oscillator().viscous() * (omega * a) * (omega * a);
            [law.added_dissipation(a, omega) * omega / (2.0 * PI), damper]
        };
        let ([friction, viscous], [first, last]) = self.motion.works(t, powers);
        let initial = elastic(first) + stored(first);
        let (elastic, stored) = (elastic(last), stored(last));
        let residual = initial - (elastic + stored) - friction - viscous;
        EnergyBalance {
            initial,
            elastic,
            stored,
            viscous,
            friction,
            residual,
            scale: initial,
            ..EnergyBalance::default()
        }
    }

    /// Writes the samples at 0, dt, 2 dt, …: q = a cos θ, q' = -a ω sin θ and the first harmonic of the joint force.
    ///
    /// # Errors
    /// [`Error::Length`], or [`Error::OutOfRange`] when `dt` is not a finite number > 0.
    pub fn sample(&mut self, dt: f64, out: &mut Samples<'_>) -> Result<(), Error> {
        check("time step", dt, dt > 0.0, "must be a finite number of seconds > 0")?;
        let law = *self.law();
        for n in 0..out.checked_len()? {
            let AmplitudePhase { amplitude: a, phase: theta } = self.at(n as f64 * dt);
            if a * a <= f64::MIN_POSITIVE {
                out.set(n, [0.0; 4]);
                continue;
            }
            let omega = law.frequency(a);
            let (q, v) = (a * libm::cos(theta), -a * omega * libm::sin(theta));
            let damper = law.added_dissipation(a, omega) / (PI * omega * a * a);
            let joint = law.added_stiffness(a, omega) * q + damper * v;
            let acceleration = -law.oscillator().viscous() * v - law.oscillator().k_inf() * q - joint;
            out.set(n, [q, v, acceleration, joint]);
        }
        Ok(())
    }
}
