//! Amplitude, frequency, damping and dissipation of a free decay, computed from the response's own extremes.
//!
//! Between two neighbouring extremes the response swings by 2A. The swings before and after an extreme give its amplitude √(A₋A₊) and, with
//! the logarithmic decrement ln(A₋/A₊) = πζ/√(1-ζ²), its damping ratio; the time between the extremes before and after is a damped period.
//! A constant offset of the motion has no effect. For a linear oscillator frequency and damping ratio are exact except for the
//! interpolation of the extremes (fourth order).

use std::f64::consts::PI;

use crate::response::Response;

/// A maximum or minimum of a motion, interpolated between samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extreme {
    /// Index of the nearest sample.
    pub sample: usize,
    /// Time, s.
    pub t: f64,
    /// Value of the motion at the extreme.
    pub value: f64,
}

/// Amplitude, frequency and losses of the cycle around one extreme.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cycle {
    /// Time of the extreme, s.
    pub t: f64,
    /// Amplitude at the extreme.
    pub amplitude: f64,
    /// Undamped frequency, Hz.
    pub frequency: f64,
    /// Damping ratio of all losses together.
    pub damping_ratio: f64,
    /// Area of the joint's loop: energy lost to friction in the cycle around the extreme.
    pub dissipation: f64,
}

/// Share of the largest swing below which a swing counts as rounding and makes no cycle. About an offset as large as the motion, rounding
/// causes swings of some 1e-16, so the results for a swing of 1e-12 contain a ten-thousandth of rounding. 1e-14 would still keep rounding
/// out, and 1e-10 would still follow a ring-down through ten decades.
const STILL: f64 = 1e-12;

/// Number of steps of Newton's method for an extreme. They begin within one sample of it, where the slope is nearly linear, and each step
/// doubles the number of correct digits.
const STEPS: usize = 4;

/// The extremes of `samples` from sample `first` on; the first and the last sample never count as extremes.
///
/// ```
/// // A parabola has its top between two samples.
/// let samples: Vec<f64> = (0..5).map(|n| 1.0 - (f64::from(n) - 2.25).powi(2)).collect();
/// let found = iwan_sim::extremes(&samples, 0.1, 0);
/// assert_eq!((found.len(), found[0].sample), (1, 2));
/// assert!((found[0].t - 0.225).abs() < 1e-12 && (found[0].value - 1.0).abs() < 1e-12);
/// ```
#[must_use]
pub fn extremes(samples: &[f64], dt: f64, first: usize) -> Vec<Extreme> {
    let inner = first.max(1)..samples.len().saturating_sub(1);
    let turns = inner.filter(|&n| {
        let (before, after) = (samples[n] - samples[n - 1], samples[n + 1] - samples[n]);
        before * after < 0.0 || (before != 0.0 && after == 0.0)
    });
    turns.map(|n| extreme(samples, dt, n)).collect()
}

/// The extreme near sample `n`: of the quartic through five samples, or of the parabola through three near the ends of the record.
fn extreme(y: &[f64], dt: f64, n: usize) -> Extreme {
    let fits = n >= 2 && n + 2 < y.len();
    let [a, b, c, d, e] =
        if fits { [-2, -1, 0, 1, 2] } else { [0, -1, 0, 1, 0] }.map(|k: isize| y[n.saturating_add_signed(k)]);
    // Central differences: derivatives in units of one sample.
    let (d1, d2, d3, d4) = if fits {
        let d1 = (a - 8.0 * b + 8.0 * d - e) / 12.0;
        let d2 = (-a + 16.0 * b - 30.0 * c + 16.0 * d - e) / 12.0;
        (d1, d2, 0.5 * (-a + 2.0 * b - 2.0 * d + e), a - 4.0 * b + 6.0 * c - 4.0 * d + e)
    } else {
        (0.5 * (d - b), b - 2.0 * c + d, 0.0, 0.0)
    };
    let slope = |x: f64| d1 + x * (d2 + x * (d3 / 2.0 + x * d4 / 6.0));
    let curvature = |x: f64| d2 + x * (d3 + x * d4 / 2.0);
    let newton = |x: f64, _: usize| x - slope(x) / curvature(x);
    let x = (0..STEPS).fold(0.0, newton);
    // On a plateau rounding can spoil Newton's steps; then the sample itself is the extreme.
    let x = if x.abs() <= 1.0 { x } else { 0.0 };
    let value = c + x * (d1 + x * (d2 / 2.0 + x * (d3 / 6.0 + x * d4 / 24.0)));
    Extreme { sample: n, t: (n as f64 + x) * dt, value }
}

/// The cycles of a response from the time `start` (s) on; choose the time at which the force has settled.
///
/// ```
/// use iwan_core::{Motion, Pulse};
/// use iwan_sim::{Mode, Settings, cycles, simulate};
/// let mode = Mode { initial: Motion::held_at(1.0), damping_ratio: 0.01, ..Mode::new("linear", 100.0, None) };
/// let found = cycles(&simulate(&mode, &Pulse::None, &Settings::new(1e-4, 0.1))?, 0.0);
/// assert!((found[3].frequency - 100.0).abs() < 0.01 && (found[3].damping_ratio - 0.01).abs() < 1e-4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn cycles(response: &Response, start: f64) -> Vec<Cycle> {
    let q = &response.displacement;
    let Some(first) = Some((start / response.dt).ceil()).filter(|n| *n < q.len() as f64) else {
        return Vec::new();
    };
    let extremes = extremes(q, response.dt, first as usize);
    let swing = |pair: &[Extreme]| 0.5 * (pair[1].value - pair[0].value).abs();
    let largest = extremes.windows(2).map(swing).fold(0.0, f64::max);
    let cycle = |three: &[Extreme]| {
        let (before, after) = (swing(&three[..2]), swing(&three[1..]));
        let period = three[2].t - three[0].t;
        if before.min(after) <= STILL * largest || period <= 0.0 {
            return None;
        }
        let decrement = (before / after).ln();
        let root = (PI * PI + decrement * decrement).sqrt();
        Some(Cycle {
            t: three[1].t,
            amplitude: (before * after).sqrt(),
            frequency: root / (PI * period),
            damping_ratio: decrement / root,
            dissipation: loop_area(response, three[0].sample, three[2].sample),
        })
    };
    extremes.windows(3).filter_map(cycle).collect()
}

/// ∮ F_J dq from sample `from` to sample `to`, about a cycle later; a straight line closes the loop.
fn loop_area(response: &Response, from: usize, to: usize) -> f64 {
    let (q, force) = (&response.displacement, &response.joint_force);
    let along = |a: usize, b: usize| 0.5 * (force[a] + force[b]) * (q[b] - q[a]);
    (from..to).map(|n| along(n, n + 1)).sum::<f64>() + along(to, from)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{JointLaw, Method, Mode, Representation, Settings, simulate};
    use iwan_core::{Backbone, FourParameter, Pulse};

    /// A free decay from its formula: `offset` + e^(-ζ ω0 t) cos(ω_d t), `n` samples.
    fn decay(f: f64, zeta: f64, offset: f64, dt: f64, n: usize) -> Response {
        let omega = 2.0 * PI * f;
        let damped = omega * (1.0 - zeta * zeta).sqrt();
        let at = |t: f64| offset + (-zeta * omega * t).exp() * (damped * t).cos();
        let displacement: Vec<f64> = (0..n).map(|i| at(i as f64 * dt)).collect();
        Response { dt, joint_force: vec![0.0; n], displacement, ..Response::default() }
    }

    #[test]
    fn a_linear_decay_gives_its_frequency_and_damping_ratio() {
        for (zeta, offset) in [(2.5e-4, 0.0), (0.01, 0.3), (0.1, 0.0)] {
            let found = cycles(&decay(124.0, zeta, offset, 1e-5, 20_000), 0.0);
            assert!(found.len() > 40);
            for cycle in &found[..20] {
                assert!((cycle.frequency / 124.0 - 1.0).abs() < 1e-8, "{cycle:?}");
                assert!((cycle.damping_ratio / zeta - 1.0).abs() < 1e-6, "{cycle:?}");
                let expected = (-zeta * 2.0 * PI * 124.0 * cycle.t).exp();
                assert!((cycle.amplitude / expected - 1.0).abs() < 0.6 * zeta, "{cycle:?}");
            }
        }
    }

    #[test]
    fn twenty_samples_in_a_cycle_are_enough() {
        for cycle in cycles(&decay(100.0, 0.01, 0.0, 5e-4, 400), 0.0) {
            assert!((cycle.frequency / 100.0 - 1.0).abs() < 1e-4, "{cycle:?}");
            assert!((cycle.damping_ratio / 0.01 - 1.0).abs() < 2e-2, "{cycle:?}");
        }
    }

    #[test]
    fn nothing_is_read_off_rest_or_a_short_response() {
        assert_eq!(cycles(&Response::default(), 0.0), []);
        assert_eq!(cycles(&decay(100.0, 0.0, 0.0, 1e-4, 3), 0.0), []);
        let still = Response { dt: 1e-3, displacement: vec![0.0; 99], ..Response::default() };
        assert_eq!(cycles(&still, 0.0), []);
    }

    /// Heavy damping about an offset: once the motion is below 1e-16 the samples hold only rounding, which has extremes too.
    #[test]
    fn rounding_about_an_offset_is_no_cycle() {
        let response = decay(124.0, 0.1, 0.3, 1e-5, 60_000);
        let found = cycles(&response, 0.0);
        assert!(extremes(&response.displacement, response.dt, 0).len() > found.len() + 100);
        for cycle in &found {
            assert!((cycle.frequency / 124.0 - 1.0).abs() < 1e-2, "{cycle:?}");
            assert!((cycle.damping_ratio / 0.1 - 1.0).abs() < 1e-2, "{cycle:?}");
        }
        assert!(found.last().unwrap().amplitude < 1e-11);
    }

    #[test]
    fn an_iwan_mode_follows_its_closed_forms_in_micro_slip() -> Result<(), Box<dyn std::error::Error>> {
        let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3)?;
        let mut mode = Mode::new("m", 124.0, Some(JointLaw::FourParameter(joint)));
        mode.initial.displacement = 0.3 * joint.phi_max();
        let continuum =
            Method::Newmark { beta: 0.25, gamma: 0.5, prewarp: true, joint: Representation::Continuum };
        let settings = Settings { method: continuum, ..Settings::new(1e-5, 0.2) };
        let response = simulate(&mode, &Pulse::None, &settings)?;
        let found = cycles(&response, 0.0);
        assert!(found.len() > 40);
        for cycle in found {
            let a = cycle.amplitude;
            assert!((cycle.frequency / mode.frequency_at(a)? - 1.0).abs() < 1e-3, "{cycle:?}");
            assert!((cycle.damping_ratio / mode.damping_ratio_at(a)? - 1.0).abs() < 0.02, "{cycle:?}");
            assert!((cycle.dissipation / joint.dissipation(a) - 1.0).abs() < 0.02, "{cycle:?}");
        }
        Ok(())
    }
}
