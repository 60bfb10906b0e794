//! Time steps of a mode known by curves, under any force.
//!
//! q'' + 2 ζ(a) ω(a) q' + ω(a)² q = f(t) with the amplitude a of the analytic signal, a² = q² + (q'/ω(a))². In a free decay a hardly
//! changes within a cycle. The mode therefore has the frequency and the damping ratio of the curves at its amplitude, to first order in the
//! damping, as in averaging.
//!
//! Each step is one of average acceleration with ω and ζ at the mean of the amplitudes at its two ends; amplitudes and motion are made
//! consistent by iteration. The prewarped step is exact for a constant ω.

use super::mode_curves::{CurvePoint, ModeCurves, Rate};
use crate::error::{Error, check};
use crate::step::{EnergyBalance, Motion, Samples, force_at};

/// Largest number of rounds in which a step and its mean amplitude are made consistent; after the last the step is taken as it is. Over a
/// step the amplitude changes at most by the angle of the step times the damping ratio, or by the effect of the force, and ω and ζ change
/// by a share of that. Usually three rounds suffice.
const MOST_ROUNDS: u32 = 50;

/// Time steps of a mode by its curves.
///
/// ```
/// use iwan_core::{CurveNewmark, CurvePoint, ModeCurves, Motion, Samples};
/// let curves = ModeCurves::new(&[1e-6, 1.0], &[1.0, 1.0], &[0.0, 0.0], [CurvePoint::default(); 2])?;
/// let (mut q, mut v, mut a, mut f) = ([0.0; 26], [0.0; 26], [0.0; 26], [0.0; 26]);
/// let mut out = Samples { displacement: &mut q, velocity: &mut v, acceleration: &mut a, joint_force: &mut f };
/// CurveNewmark::new(&curves, 0.01, true)?.integrate(Motion::held_at(0.5), &[], &mut out)?;
/// assert!(q[25].abs() < 1e-12);
/// # Ok::<(), iwan_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct CurveNewmark<'a, P> {
    curves: &'a ModeCurves<P>,
    dt: f64,
    prewarp: bool,
}

/// The end of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvesEnd {
    /// Final displacement and velocity.
    pub motion: Motion,
    /// Energy balance: `elastic` is ½ ω(a)² q², `viscous` the energy lost to the damping, `friction` the energy lost or gained by the
    /// change of stiffness with amplitude.
    pub energy: EnergyBalance,
}

/// Works along a run.
#[derive(Clone, Copy, Default)]
struct Works {
    force: f64,
    damping: f64,
    spring: f64,
}

impl<P: AsRef<[CurvePoint]>> ModeCurves<P> {
    /// One sample of a response: q, q', q'' under the modal force `p`, and the joint force. The joint force is the mode's own force less
    /// that of the undamped linear mode at the smallest amplitude: (ω(a)² - ω(0)²) q + 2 ζ(a) ω(a) q'.
    pub(super) fn sample(&self, q: f64, v: f64, amplitude: f64, p: f64) -> [f64; 4] {
        let Rate { omega, damping_ratio } = self.at(amplitude);
        let linear = self.at(0.0).omega;
        let damping = 2.0 * damping_ratio * omega * v;
        let joint = (omega - linear) * (omega + linear) * q + damping;
        [q, v, p - omega * omega * q - damping, joint]
    }
}

impl<'a, P: AsRef<[CurvePoint]>> CurveNewmark<'a, P> {
    /// Steps of length `dt` (s); with `prewarp` they have no period error at a constant amplitude.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless `dt` is > 0 and, if prewarped, shorter than half a period at all amplitudes.
    pub fn new(curves: &'a ModeCurves<P>, dt: f64, prewarp: bool) -> Result<Self, Error> {
        let fits = !prewarp || curves.fastest() * dt < core::f64::consts::PI;
        check("time step", dt, dt > 0.0 && fits, "must be > 0 and shorter than half a period of the mode")?;
        Ok(Self { curves, dt, prewarp })
    }

    /// Integrates over the samples from the motion `start`. `force` holds one value per time step, the first at the start; after its end
    /// the force is zero.
    ///
    /// # Errors
    /// [`Error::Length`] when the buffers disagree.
    pub fn integrate(&self, start: Motion, force: &[f64], out: &mut Samples<'_>) -> Result<CurvesEnd, Error> {
        let samples = out.checked_len()?;
        let mut at = start;
        let mut amplitude = self.curves.amplitude(at.displacement, at.velocity);
        let elastic = |at: Motion, amplitude: f64| {
            let omega = self.curves.at(amplitude).omega;
            0.5 * (omega * at.displacement) * (omega * at.displacement)
        };
        let first = elastic(at, amplitude);
        let mut works = Works::default();
        let mut p = force_at(force, 0);
        out.set(0, self.curves.sample(at.displacement, at.velocity, amplitude, p));
        for n in 1..samples {
            let next = force_at(force, n);
            (at, amplitude) = self.step(at, amplitude, [p, next], &mut works);
            p = next;
            out.set(n, self.curves.sample(at.displacement, at.velocity, amplitude, p));
        }
        let kinetic = |v: f64| 0.5 * v * v;
        let last = elastic(at, amplitude);
        let gained = kinetic(at.velocity) - kinetic(start.velocity);
        let initial = kinetic(start.velocity) + first;
        let energy = EnergyBalance {
            initial,
            input: works.force,
            kinetic: kinetic(at.velocity),
            elastic: last,
            stored: 0.0,
            viscous: works.damping,
            friction: works.spring - (last - first),
            residual: works.force - gained - works.damping - works.spring,
            scale: initial.max(works.force.abs()).max(kinetic(at.velocity)),
        };
        Ok(CurvesEnd { motion: at, energy })
    }

    /// One step from the motion `at` with its `amplitude`, under a force that changes linearly from `p[0]` to `p[1]`.
    fn step(&self, at: Motion, amplitude: f64, p: [f64; 2], works: &mut Works) -> (Motion, f64) {
        let Motion { displacement: q, velocity: v } = at;
        let mut after = amplitude;
        for round in 1.. {
            let Rate { omega, damping_ratio } = self.curves.at(0.5 * (amplitude + after));
            let (h, scale) = self.warped(omega);
            let (k, c) = (omega * omega, 2.0 * damping_ratio * omega);
            let mean = 0.5 * scale * (p[0] + p[1]);
            let x = 2.0 * (mean + 2.0 * v / h - k * q) / (4.0 / (h * h) + 2.0 * c / h + k);
            let end = Motion { displacement: q + x, velocity: 2.0 * x / h - v };
            let before = after;
            after = self.curves.amplitude_near(end.displacement, end.velocity, omega);
            let settled = libm::fabs(after - before) <= 2.0 * f64::EPSILON * after;
            if settled || round == MOST_ROUNDS || after.is_nan() {
                let way = end.displacement - q;
                works.force += mean * way;
                works.damping += 0.5 * c * (v + end.velocity) * way;
                works.spring += 0.5 * k * (q + end.displacement) * way;
                return (end, after);
            }
        }
        (at, amplitude)
    }

    /// Time step in the formulas (s) and factor on the force, at the circular frequency `omega`.
    fn warped(&self, omega: f64) -> (f64, f64) {
        let angle = omega * self.dt;
        if !self.prewarp || angle == 0.0 {
            return (self.dt, 1.0);
        }
        (2.0 / omega * libm::tan(0.5 * angle), angle / libm::sin(angle))
    }
}
