//! The ring-down of an identified mode, to be compared with a record.

use iwan_core::FourParameter;
use iwan_ident::Parameters;
use iwan_ident::curves::Quantity;
use iwan_sim::{JointLaw, Mode, Response};

/// Samples per cycle of ring-downs that are compared with records. The half-cycle map that computes them has no error from the step. Straight lines
/// between the samples of a drawing miss 1 - cos(π/100) = 5e-4 of the amplitude, less than the width of a line, and the cubic that interpolates at a
/// record's times misses 4e-7.
const PER_CYCLE: f64 = 100.0;

/// The time step (s) of a ring-down beside a record sampled every `dt` (s): the sampling interval divided by a whole number, at most a hundredth of a
/// cycle.
///
/// ```
/// let step = iwan_study::identified::time_step(1e-3, 80.0);
/// assert!((step - 1e-3 / 8.0).abs() < 1e-18);
/// ```
#[must_use]
pub fn time_step(dt: f64, frequency: f64) -> f64 {
    dt / (PER_CYCLE * frequency * dt).ceil().max(1.0)
}

/// A mode with these parameters, released from rest at a displacement.
pub(super) fn released(name: &str, p: &Parameters, displacement: f64) -> Result<Mode, iwan_core::Error> {
    let joint = FourParameter::new(p.k_t, p.f_s, p.chi, p.beta)?;
    Ok(Mode {
        damping_ratio: p.damping_ratio,
        initial: iwan_core::Motion::held_at(displacement),
        ..Mode::new(name, p.frequency, Some(JointLaw::FourParameter(joint)))
    })
}

/// A response at the time `t` (s) between its samples, by the cubic through four samples (Lagrange's polynomial at -1, 0, 1, 2).
pub(super) fn between(response: &Response, quantity: Quantity, t: f64) -> f64 {
    let y = match quantity {
        Quantity::Displacement => &response.displacement,
        Quantity::Velocity => &response.velocity,
        Quantity::Acceleration => &response.acceleration,
    };
    let place = t / response.dt;
    let i = (place as usize).clamp(1, y.len().saturating_sub(3).max(1));
    let s = place - i as f64;
    let [a, b, c, d] = [i - 1, i, i + 1, i + 2].map(|k| y.get(k).copied().unwrap_or_default());
    a * s * (s - 1.0) * (2.0 - s) / 6.0
        + b * (s + 1.0) * (s - 1.0) * (s - 2.0) / 2.0
        + c * s * (s + 1.0) * (2.0 - s) / 2.0
        + d * s * (s + 1.0) * (s - 1.0) / 6.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_samples_lies_the_cubic_through_them() {
        let cubic = |t: f64| 1.0 + t - 0.5 * t * t + 0.25 * t * t * t;
        let displacement: Vec<f64> = (0..10).map(|n| cubic(0.5 * f64::from(n))).collect();
        let response = Response { dt: 0.5, displacement, ..Response::default() };
        for t in [0.0, 0.2, 0.75, 2.0, 4.4] {
            let found = between(&response, Quantity::Displacement, t);
            assert!((found - cubic(t)).abs() < 1e-12, "{t}");
        }
    }

    #[test]
    fn steps_divide_the_sampling_interval() {
        let step = time_step(1e-3, 80.0);
        assert!((1e-3 / step - (1e-3_f64 / step).round()).abs() < 1e-9 && step * 80.0 <= 0.01 + 1e-12);
    }
}
