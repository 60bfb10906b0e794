//! Free decay of a mode known by curves: da/dt = -ζ(a) ω(a) a and dθ/dt = ω(a) with q = a cos θ.

use super::mode_curves::{CurvePoint, ModeCurves};
use crate::error::{Error, check};
use crate::step::{AmplitudePhase, EnergyBalance, Motion, Rates, Samples, SlowMotion};

/// Free decay of a mode known by curves, by averaging.
///
/// ```
/// use iwan_core::{AveragedCurves, CurvePoint, ModeCurves, Motion};
/// // The same values at all amplitudes: a damped sine.
/// let curves = ModeCurves::new(&[1e-6, 1.0], &[10.0, 10.0], &[0.01, 0.01], [CurvePoint::default(); 2])?;
/// let mut decay = AveragedCurves::new(&curves, Motion::held_at(0.5))?;
/// let omega = 2.0 * core::f64::consts::PI * 10.0;
/// assert!((decay.at(1.0).amplitude / (0.5 * (-0.01 * omega).exp()) - 1.0).abs() < 1e-12);
/// # Ok::<(), iwan_core::Error>(())
/// ```
#[derive(Debug)]
pub struct AveragedCurves<'a, P> {
    motion: SlowMotion<Borrowed<'a, P>>,
}

/// Borrowed curves.
#[derive(Debug)]
struct Borrowed<'a, P>(&'a ModeCurves<P>);

// Not derived: a derived `Clone` would require that `P` is `Clone`.
impl<P> Clone for Borrowed<'_, P> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<P> Copy for Borrowed<'_, P> {}

impl<P: AsRef<[CurvePoint]>> Rates for Borrowed<'_, P> {
    fn frequency(&self, amplitude: f64) -> f64 {
        self.0.at(amplitude).omega
    }

    fn decay_rate(&self, amplitude: f64) -> f64 {
        let rate = self.0.at(amplitude);
        rate.damping_ratio * rate.omega
    }
}

impl<'a, P: AsRef<[CurvePoint]>> AveragedCurves<'a, P> {
    /// The decay that begins with the motion `start`, without force.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when a value is not finite.
    pub fn new(curves: &'a ModeCurves<P>, start: Motion) -> Result<Self, Error> {
        let omega0 = curves.at(0.0).omega;
        Ok(Self { motion: SlowMotion::new(Borrowed(curves), omega0, start)? })
    }

    /// Amplitude and phase at the time `t` since the start; `t` must not be earlier than in the last call.
    pub fn at(&mut self, t: f64) -> AmplitudePhase {
        self.motion.at(t)
    }

    /// Energy balance from the start to the time `t`, with the energy ½ ω(a)² a² of a motion of amplitude a. `viscous` is the energy lost
    /// to the damping, `friction` the energy lost or gained by the change of stiffness with amplitude. The curves alone do not tell where
    /// that energy goes, so it closes the balance and the residual is 0.
    #[must_use]
    pub fn energy(&self, t: f64) -> EnergyBalance {
        let curves = self.motion.rates.0;
        let energy = |a: f64| {
            let omega = curves.at(a).omega;
            0.5 * (omega * a) * (omega * a)
        };
        // The powers to integrate: that of the damping, with ½ ω² a² at constant ω, and a second one that is not used.
        let powers = |a: f64| {
            let rate = curves.at(a);
            [2.0 * rate.damping_ratio * rate.omega * energy(a), 0.0]
        };
        let ([viscous, _], [first, last]) = self.motion.works(t, powers);
        let (initial, elastic) = (energy(first), energy(last));
        let friction = initial - elastic - viscous;
        EnergyBalance { initial, elastic, viscous, friction, scale: initial, ..EnergyBalance::default() }
    }

    /// Writes the samples at 0, dt, 2 dt, …; the joint force is defined as in [`CurveNewmark`](super::CurveNewmark).
    ///
    /// # Errors
    /// [`Error::Length`], or [`Error::OutOfRange`] when `dt` is not a finite number > 0.
    pub fn sample(&mut self, dt: f64, out: &mut Samples<'_>) -> Result<(), Error> {
        check("time step", dt, dt > 0.0, "must be a finite number of seconds > 0")?;
        let curves = self.motion.rates.0;
        for n in 0..out.checked_len()? {
            let AmplitudePhase { amplitude: a, phase: theta } = self.at(n as f64 * dt);
            let omega = curves.at(a).omega;
            let (q, v) = (a * libm::cos(theta), -a * omega * libm::sin(theta));
            out.set(n, curves.sample(q, v, a, 0.0));
        }
        Ok(())
    }
}
