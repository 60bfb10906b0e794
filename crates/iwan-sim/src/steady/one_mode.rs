//! The forced response of one mode by its first harmonic, in explicit form: two frequencies for each amplitude.
//!
//! With K(a) = K_∞ + K_1(a) and h(a) = D(a)/(π a²), harmonic balance gives a |K - ω² + i (c ω + h)| = f. At a given amplitude K and h are
//! numbers, and the two frequencies are roots of a polynomial, so no iteration on the joint is needed.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use iwan_core::{Backbone, Oscillator};

use super::curve::{SteadyCurve, SteadyPoint};
use super::jointed::SharedLaw;
use super::sweep::{Control, Sweep};
use crate::error::SimulationError;
use crate::mode::Mode;

/// Stiffness and loss of a mode at an amplitude.
#[derive(Debug, Clone, Copy)]
struct AtAmplitude {
    /// Amplitude a of the modal displacement.
    amplitude: f64,
    /// K_∞ + K_1(a), 1/s².
    stiffness: f64,
    /// D/(π a²), 1/s²: the joint's loss as an imaginary stiffness.
    loss: f64,
}

/// The quantities of a mode that its harmonic balance needs.
struct Balance {
    k_inf: f64,
    viscous: f64,
    joint: Option<SharedLaw>,
}

impl Balance {
    fn at(&self, a: f64) -> AtAmplitude {
        let (mut stiffness, mut loss) = (self.k_inf, 0.0);
        if let Some(joint) = &self.joint {
            let (k, d) = joint.stiffness_and_dissipation(a);
            stiffness += k;
            loss = d / (PI * a * a);
        }
        AtAmplitude { amplitude: a, stiffness, loss }
    }

    /// Dynamic stiffness K - ω² + i (c ω + h): real and imaginary part.
    fn dynamic_stiffness(&self, at: AtAmplitude, omega: f64) -> [f64; 2] {
        [at.stiffness - omega * omega, self.viscous * omega + at.loss]
    }

    /// The modal force that sustains the amplitude at the frequency.
    fn force(&self, at: AtAmplitude, omega: f64) -> f64 {
        let [re, im] = self.dynamic_stiffness(at, omega);
        at.amplitude * re.hypot(im)
    }

    /// The circular frequency at which the smallest force sustains the amplitude.
    fn easiest(&self, at: AtAmplitude) -> f64 {
        // |Z|² = (K - ω²)² + (cω + h)² has zero derivative at ω² = K - c (cω + h)/(2ω). The correction to ω² = K is of second
        // order in the damping, so a few rounds suffice.
        let mut omega = at.stiffness.max(0.0).sqrt();
        for _ in 0..4 {
            if omega == 0.0 || self.viscous == 0.0 {
                break;
            }
            let square = at.stiffness - 0.5 * self.viscous * (self.viscous + at.loss / omega);
            let before = std::mem::replace(&mut omega, square.max(0.0).sqrt());
            // A round multiplies the error by the first correction's share of the frequency. After a change of 1e-8 the error is the square
            // of that, which is rounding.
            if (omega - before).abs() <= 1e-8 * omega {
                break;
            }
        }
        omega
    }

    /// The frequency below (`side` = -1) or above (`side` = +1) the resonance `middle` at which the force `f` sustains the amplitude. None
    /// if the force is too small for that at any frequency, or, below resonance, too large.
    fn frequency(&self, at: AtAmplitude, f: f64, side: f64, middle: f64) -> Option<f64> {
        let goal = f / at.amplitude;
        let [re, im] = self.dynamic_stiffness(at, middle);
        let spare = goal * goal - re * re - im * im;
        if spare < 0.0 {
            // At the top of the curve both sides meet; there rounding may make `spare` slightly negative.
            return (spare > -1e-9 * goal * goal).then_some(middle);
        }
        if side < 0.0 && at.stiffness * at.stiffness + at.loss * at.loss < goal * goal {
            return None;
        }
        let start = (middle * middle + side * spare.sqrt()).max(0.0).sqrt();
        Some(self.polish(at, goal, start, middle, side))
    }

    /// Newton's method on |Z|² = goal², on one side of `middle`; without viscous damping the start is exact.
    fn polish(&self, at: AtAmplitude, goal: f64, start: f64, middle: f64, side: f64) -> f64 {
        let mut omega = start;
        if self.viscous == 0.0 {
            return omega;
        }
        for _ in 0..ROUNDS {
            let [re, im] = self.dynamic_stiffness(at, omega);
            let value = re * re + im * im - goal * goal;
            let slope = 2.0 * (self.viscous * im - 2.0 * omega * re);
            let next = omega - value / slope;
            if !next.is_finite() || (next - middle) * side < 0.0 {
                break;
            }
            // The error after a step of Newton's method is the step squared over twice the distance to `middle`, where the slope vanishes.
            let done = (next - omega).powi(2) <= f64::EPSILON * omega * (next - middle).abs();
            omega = next;
            if done {
                break;
            }
        }
        omega
    }
}

/// Largest number of rounds of Newton's method on the polynomial: the start is in error by the square of the viscous damping, and each
/// round squares the error.
const ROUNDS: usize = 8;

/// Signs of the two sides of a resonance: below and above.
const SIDES: [f64; 2] = [-1.0, 1.0];

/// Ratio of successive amplitudes in the search for the smallest and the largest amplitude.
const SEARCH: f64 = 1.2;

/// Upper limit of the search for the largest amplitude, over the joint's largest strength. The limit is reached when the force exceeds
/// friction and no damper limits the motion; the curve then gets a remark.
const FARTHEST: f64 = 1e9;

/// The steady forced responses of one mode by its first harmonic, one curve per level.
///
/// # Errors
/// [`SimulationError::Parameter`] for the mode, the band and the levels, or shapes of zero.
pub(super) fn explicit_response(
    mode: &Mode,
    sweep: &Sweep,
    shape_at_output: f64,
) -> Result<Vec<SteadyCurve>, SimulationError> {
    sweep.checked()?;
    let oscillator = mode.oscillator()?;
    for (name, value) in [("shape_at_force", mode.shape_at_force), ("shape at the output", shape_at_output)] {
        if value == 0.0 || !value.is_finite() {
            let allowed = "must not be zero: the excitation would not reach the response";
            return Err(iwan_core::Error::OutOfRange { name, value, allowed }.into());
        }
    }
    let task = Task { balance: balance(&oscillator, mode), mode, sweep, shape_at_output };
    Ok(sweep.levels.iter().map(|&level| task.curve(level)).collect())
}

fn balance(oscillator: &Oscillator, mode: &Mode) -> Balance {
    let joint = mode.joint.clone().map(SharedLaw::from);
    Balance { k_inf: oscillator.k_inf(), viscous: oscillator.viscous(), joint }
}

/// One mode with one sweep.
struct Task<'a> {
    balance: Balance,
    mode: &'a Mode,
    sweep: &'a Sweep,
    shape_at_output: f64,
}

impl Task<'_> {
    fn curve(&self, level: f64) -> SteadyCurve {
        let mut curve =
            SteadyCurve { control: self.sweep.control, level, points: Vec::new(), remarks: Vec::new() };
        if self.sweep.control.holds_response() {
            self.held(level, &mut curve);
        } else {
            self.forced(level * self.mode.shape_at_force.abs(), &mut curve);
        }
        self.remark(&mut curve);
        curve
    }

    /// A point at a modal amplitude and a frequency.
    fn point(&self, at: AtAmplitude, omega: f64, excitation: f64) -> SteadyPoint {
        let [re, im] = self.balance.dynamic_stiffness(at, omega);
        // The base drives the mode against its own acceleration: the modal force is -Γ times the acceleration.
        let sign = if self.sweep.control == Control::BaseAcceleration { -1.0 } else { 1.0 }
            * (self.mode.shape_at_force * self.shape_at_output).signum();
        let phase = if sign > 0.0 { -im.atan2(re) } else { PI - im.atan2(re) };
        SteadyPoint {
            frequency: omega / TAU,
            amplitude: at.amplitude * self.shape_at_output.abs(),
            phase,
            excitation,
            harmonics: Vec::new(),
            slips: Vec::new(),
        }
    }

    /// Response held constant: one force for each frequency.
    fn held(&self, level: f64, curve: &mut SteadyCurve) {
        let modal = level / self.shape_at_output.abs();
        for omega in self.frequencies(modal) {
            let at = self.balance.at(self.sweep.control.displacement(modal, omega));
            let force = self.balance.force(at, omega) / self.mode.shape_at_force.abs();
            curve.points.push(self.point(at, omega, force));
        }
    }

    /// The frequencies of a held response: half of them evenly spaced, half at even steps of the phase, so that narrow resonances are
    /// resolved.
    fn frequencies(&self, level: f64) -> Vec<f64> {
        let (from, to) = (TAU * self.sweep.from, TAU * self.sweep.to);
        let half = self.sweep.points / 2;
        let share = |i: usize, of: usize| i as f64 / (of - 1) as f64;
        let mut found: Vec<f64> = (0..half).map(|i| from + (to - from) * share(i, half)).collect();
        let at = |omega: f64| self.balance.at(self.sweep.control.displacement(level, omega));
        let phase = |omega: f64| {
            let [re, im] = self.balance.dynamic_stiffness(at(omega), omega);
            im.atan2(re)
        };
        let (first, last) = (phase(from), phase(to));
        let rest = self.sweep.points - half;
        for i in 1..=rest {
            let angle = first + (last - first) * share(i, rest + 2);
            if let Some(omega) = self.at_phase(&at, angle).filter(|omega| (from..=to).contains(omega)) {
                found.push(omega);
            }
        }
        found.sort_by(f64::total_cmp);
        found
    }

    /// The frequency at which the response lags by `angle` (rad): K - ω² = (c ω + h) cot(angle). A few rounds account for the change of the
    /// amplitude with frequency. The frequency only places a point, so its accuracy does not matter.
    fn at_phase(&self, at: &impl Fn(f64) -> AtAmplitude, angle: f64) -> Option<f64> {
        let cot = angle.cos() / angle.sin();
        let mut omega = TAU * (self.sweep.from * self.sweep.to).sqrt();
        for _ in 0..6 {
            let state = at(omega);
            let b = 0.5 * self.balance.viscous * cot;
            let root = b * b + state.stiffness - state.loss * cot;
            omega = -b + root.max(0.0).sqrt();
        }
        (omega > 0.0 && omega.is_finite()).then_some(omega)
    }

    /// Force held constant: at each amplitude two frequencies, below and above resonance.
    fn forced(&self, force: f64, curve: &mut SteadyCurve) {
        let ends = [self.sweep.from, self.sweep.to].map(|edge| self.smallest(TAU * edge, force));
        let top = self.largest(ends[0].min(ends[1]), force);
        if !top.is_finite() {
            curve.remarks.push(self.unbounded(force));
        }
        let top = if top.is_finite() { top } else { self.farthest() };
        // Both sides are sampled at the same amplitudes, from the smaller amplitude of the band's two ends upwards. A side that gets fewer
        // than half its points is then sampled by itself, from the amplitude at its own end of the band.
        let (low, count) = (ends[0].min(ends[1]), self.sweep.points / 2);
        let mut sides = self.sampled(force, SIDES, [low.min(top), top], count);
        for ((points, side), end) in sides.iter_mut().zip(SIDES).zip(ends) {
            if points.len() * 2 < count {
                *points = self.side(force, side, [end.min(top), top], [low, ends[0].max(ends[1])]);
            } else {
                let [first] = self.sampled(force, [side], [end.min(top), end.min(top)], 1);
                let least = points.first().map_or(0.0, |point| point.amplitude);
                let beyond = |own: &SteadyPoint| own.amplitude < least;
                let first: Vec<SteadyPoint> = first.into_iter().filter(beyond).collect();
                points.splice(0..0, first);
            }
        }
        // In order along the curve: upwards on the lower side, downwards on the upper side.
        let [up, down] = &mut sides;
        down.reverse();
        up.append(down);
        curve.points = std::mem::take(up);
    }

    /// The points of one side within the band, amplitudes ascending. `range` limits the amplitudes of the search; `ends` are the amplitudes
    /// at both ends of the band.
    fn side(&self, force: f64, side: f64, range: [f64; 2], ends: [f64; 2]) -> Vec<SteadyPoint> {
        /// Largest number of rounds in which the amplitudes are confined to the band; usually two to three suffice.
        const ROUNDS: usize = 6;
        let (count, scale) = (self.sweep.points / 2, self.shape_at_output.abs());
        let mut reach = range;
        let sampled = |reach| {
            let [points] = self.sampled(force, [side], reach, count);
            points
        };
        let mut points = sampled(reach);
        for _ in 0..ROUNDS {
            if points.len() * 4 >= count * 3 {
                break;
            }
            // Most amplitudes lie outside the band, so those inside are sampled again, more densely.
            let step = (reach[1] / reach[0]).powf(2.0 / count as f64);
            reach = match (points.first(), points.last()) {
                (Some(low), Some(high)) => [low.amplitude / scale / step, high.amplitude / scale * step],
                _ => ends,
            };
            reach = [reach[0].max(range[0].min(ends[0])), reach[1].min(range[1])];
            if reach[0] >= reach[1] {
                break;
            }
            points = sampled(reach);
        }
        points
    }

    /// The points of each of the given sides at `count` amplitudes.
    fn sampled<const N: usize>(
        &self,
        force: f64,
        sides: [f64; N],
        [low, high]: [f64; 2],
        count: usize,
    ) -> [Vec<SteadyPoint>; N] {
        let (from, to) = (self.sweep.from, self.sweep.to);
        let excitation = force / self.mode.shape_at_force.abs();
        let range = (high / low).ln();
        // With room for the points of the other side, which are appended.
        let mut points = sides.map(|_| Vec::with_capacity(2 * count + 2));
        for i in 0..count {
            // Amplitudes are dense near the top, where the frequency changes with the square root of the amplitude's distance to the top.
            let y = 1.0 - i as f64 / (count - 1).max(1) as f64;
            let at = self.balance.at(high * (-range * y * y).exp());
            let middle = self.balance.easiest(at);
            for (points, side) in points.iter_mut().zip(sides) {
                let Some(omega) = self.balance.frequency(at, force, side, middle) else { continue };
                if (from..=to).contains(&(omega / TAU)) {
                    points.push(self.point(at, omega, excitation));
                }
            }
        }
        points
    }

    fn farthest(&self) -> f64 {
        FARTHEST * self.mode.joint.as_ref().map_or(1.0, |law| law.strengths().1)
    }

    /// The smallest amplitude that the force sustains at a frequency.
    fn smallest(&self, omega: f64, force: f64) -> f64 {
        let k_t = self.mode.joint.as_ref().map_or(0.0, Backbone::initial_stiffness);
        let k = self.balance.k_inf + k_t;
        // The dynamic stiffness differs from that at small amplitudes by at most K_T.
        let bound = (k - omega * omega).abs() + self.balance.viscous * omega + 2.0 * k_t;
        let missing = |a: f64| self.balance.force(self.balance.at(a), omega) - force;
        crossing(force / bound, self.farthest(), missing)
    }

    /// The largest amplitude that the force sustains at any frequency; infinite if nothing limits it.
    fn largest(&self, low: f64, force: f64) -> f64 {
        let missing = |a: f64| {
            let at = self.balance.at(a);
            self.balance.force(at, self.balance.easiest(at)) - force
        };
        let found = crossing(low, self.farthest(), missing);
        if found < self.farthest() { found } else { f64::INFINITY }
    }

    fn unbounded(&self, force: f64) -> String {
        let most = self.mode.joint.as_ref().map_or(0.0, |law| 4.0 * law.slip_force() / PI);
        format!(
            "mode \"{}\": without viscous damping friction takes a modal force of 4 F_S/\u{3c0} = {most:.6e} at the most, \
             and {force:.6e} acts: the amplitude grows without bound at resonance; give damping_ratio, or a lower level",
            self.mode.name
        )
    }

    fn remark(&self, curve: &mut SteadyCurve) {
        let below = |point: &SteadyPoint| point.phase.abs() < FRAC_PI_2;
        let quadrature = curve.points.windows(2).any(|w| below(&w[0]) != below(&w[1]));
        if !quadrature {
            let frequency = self.mode.frequency;
            curve.remarks.push(format!(
                "mode \"{}\": no resonance at this level between {} and {} Hz; at small amplitude it lies at {frequency} Hz",
                self.mode.name, self.sweep.from, self.sweep.to
            ));
        }
    }
}

/// Largest number of rounds of [`crossing`]: bisection alone would take 53. If they do not suffice, the lower end of the bracket is
/// returned.
const ROUNDS_IN: usize = 64;

/// The first zero of a function that is negative at small `low`, found by steps of the ratio [`SEARCH`] and then by the Illinois method;
/// `high` if there is none.
fn crossing(low: f64, high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (mut a, mut fa) = (low, f(low));
    if fa >= 0.0 {
        return a;
    }
    let mut b = a * SEARCH;
    let mut fb = f(b);
    while fb < 0.0 {
        (a, fa) = (b, fb);
        b *= SEARCH;
        if b >= high {
            return high;
        }
        fb = f(b);
    }
    let mut last = 0.0;
    for _ in 0..ROUNDS_IN {
        let line = (a * fb - b * fa) / (fb - fa);
        let at = if a < line && line < b { line } else { 0.5 * (a + b) };
        if at <= a || at >= b {
            break;
        }
        let value = f(at);
        // The value at an end that stays is halved, so that the next point falls beyond the zero.
        if value < 0.0 {
            (a, fa) = (at, value);
            fb *= if last < 0.0 { 0.5 } else { 1.0 };
        } else {
            (b, fb) = (at, value);
            fa *= if last > 0.0 { 0.5 } else { 1.0 };
        }
        last = if value < 0.0 { -1.0 } else { 1.0 };
        if b - a <= 4.0 * f64::EPSILON * b {
            break;
        }
    }
    a
}
