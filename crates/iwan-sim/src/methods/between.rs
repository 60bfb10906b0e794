//! The effect of a force from a file between the time steps.
//!
//! Time steps use the force at their own samples only. A force from a file has samples of its own, is linear between them, and need not be
//! smooth. Where its samples lie between the steps, or are much denser, the steps miss a part of the force that halving the step would not
//! reveal. So companion runs use other samples of the force: those under which the steps push a motion as the file's force does.

use iwan_core::Pulse;

/// Nodes and weights of the three-point Gauss-Legendre rule on -1 to 1: exact for a linear force times a cubic.
const RULE: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// Samples at n `dt`, n = `first`, `first` + 1, …, under which steps of average acceleration act as a force from a file does. Returns the
/// number of samples after which all are zero; none if the force is given by a formula.
///
/// Such steps act like the trapezoidal rule: sample n counts `dt` times the effect of an impulse at its time. The file's force at a time
/// between samples is distributed to the four samples around it, with the weights of the cubic interpolation through four points (at the
/// start through the first four). The effect of an impulse is a smooth function of its time, a sine of the time that has passed since, so
/// the samples are equivalent to the file's force up to (ω dt)^4.
pub(crate) fn as_the_file_does(force: &Pulse<'_>, dt: f64, first: usize, out: &mut [f64]) -> Option<usize> {
    let Pulse::Sampled { dt: own, samples } = *force else { return None };
    out.fill(0.0);
    let ends = force.settled();
    let intervals = first.saturating_sub(3)..first + out.len() + 1;
    for k in intervals.take_while(|k| (*k as f64) * dt < ends) {
        let stencil = k.saturating_sub(1);
        let (start, end) = (k as f64 * dt, ((k + 1) as f64 * dt).min(ends));
        let mut piece = (start / own) as usize;
        let mut now = start;
        while now < end {
            let until = ((piece + 1) as f64 * own).min(end);
            for (node, weight) in RULE.map(|(x, w)| (0.5 * (now + until + x * (until - now)), w)) {
                let at = (node / own - piece as f64).clamp(0.0, 1.0);
                let next = samples.get(piece + 1).copied().unwrap_or(0.0);
                let value = samples[piece.min(samples.len() - 1)] * (1.0 - at) + next * at;
                let push = 0.5 * (until - now).max(0.0) / dt * weight * value;
                for (share, n) in cubic(node / dt - stencil as f64).into_iter().zip(stencil..) {
                    if let Some(sample) = n.checked_sub(first).and_then(|place| out.get_mut(place)) {
                        // The first sample stands for half a step only, so its weight is doubled.
                        *sample += push * share * if n == 0 { 2.0 } else { 1.0 };
                    }
                }
            }
            (now, piece) = (until, piece + 1);
        }
    }
    Some(out.iter().rposition(|p| *p != 0.0).map_or(0, |last| last + 1))
}

/// Weights of the values at 0, 1, 2 and 3 in the value at `x` of the cubic through them.
fn cubic(x: f64) -> [f64; 4] {
    let [a, b, c, d] = [x, x - 1.0, x - 2.0, x - 3.0];
    [-b * c * d / 6.0, a * c * d / 2.0, -a * b * d / 2.0, a * b * c / 6.0]
}

/// Largest error of the displacement over all samples of the double steps. It is the sum of the effect of the file's force that the steps
/// miss, and of the difference to steps twice as long, divided by `divisor`.
///
/// `fine` are displacements under the force samples of the steps themselves; `whole` and `double` are those under samples that act as the
/// file does, with the same steps and with double ones. Without a file `whole` is `fine`.
pub(crate) fn error(fine: &[f64], whole: &[f64], double: &[f64], divisor: f64) -> f64 {
    let steps = fine.iter().step_by(2).zip(whole.iter().step_by(2)).zip(double);
    steps.fold(0.0, |most: f64, ((fine, whole), double)| {
        most.max((whole - fine + (whole - double) / divisor).abs())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use iwan_core::SplitMix64;

    fn samples(force: &Pulse<'_>, dt: f64, first: usize, count: usize) -> Vec<f64> {
        let mut out = vec![f64::NAN; count];
        as_the_file_does(force, dt, first, &mut out).unwrap();
        out
    }

    fn file(count: usize) -> Vec<f64> {
        let mut random = SplitMix64::new(3);
        (0..count).map(|_| random.next_symmetric()).collect()
    }

    /// The integral of a linear force times t³ - 2 t + 1 is known; the sum of the samples by the trapezoidal rule must equal it for any two
    /// intervals.
    #[test]
    fn steps_push_a_cubic_as_the_file_does() {
        let file = file(40);
        let moves = |t: f64| t * t * t - 2.0 * t + 1.0;
        for own in [0.0137, 0.1, 0.31] {
            let force = Pulse::Sampled { dt: own, samples: &file };
            let mut exact = 0.0;
            for (n, pair) in file.windows(2).enumerate() {
                // The integral by the Gauss-Legendre rule, which is exact here.
                for (x, w) in RULE {
                    let at = 0.5 * (1.0 + x);
                    let value = pair[0] * (1.0 - at) + pair[1] * at;
                    exact += 0.5 * own * w * value * moves((n as f64 + at) * own);
                }
            }
            let dt = 0.1;
            let pushed = samples(&force, dt, 0, 130).iter().enumerate().fold(0.0, |sum, (n, p)| {
                sum + dt * p * moves(n as f64 * dt) * if n == 0 { 0.5 } else { 1.0 }
            });
            assert!((pushed - exact).abs() < 1e-12 * exact.abs().max(1.0), "{own}: {pushed} {exact}");
        }
    }

    #[test]
    fn a_history_in_pieces_is_the_same_to_the_bit() {
        let file = file(50);
        let force = Pulse::Sampled { dt: 0.07, samples: &file };
        let whole = samples(&force, 0.1, 0, 40);
        for first in 0..30 {
            assert_eq!(samples(&force, 0.1, first, 10), whole[first..first + 10], "{first}");
        }
    }

    #[test]
    fn a_constant_force_is_seen_as_it_is_up_to_its_end() {
        let file = [6.0; 30];
        let seen = samples(&Pulse::Sampled { dt: 0.013, samples: &file }, 0.02, 0, 25);
        // The first four samples compensate for the corner at which the force begins.
        assert!(seen[4..17].iter().all(|p| (p - 6.0).abs() < 1e-13), "{seen:?}");
        assert!(seen[21..].iter().all(|p| *p == 0.0), "{seen:?}");
    }

    /// A force whose mean over every step is zero, although its samples at the steps are constant.
    #[test]
    fn what_swings_between_the_steps_is_next_to_nothing() {
        let file: Vec<f64> = (0..1000).map(|n| if n % 10 < 5 { 1.0 } else { -1.0 }).collect();
        let seen = samples(&Pulse::Sampled { dt: 0.001, samples: &file }, 0.01, 0, 90);
        let most = seen[1..].iter().fold(0.0_f64, |most, p| most.max(p.abs()));
        assert!(most < 0.05, "{most}");
        assert_eq!(file.iter().step_by(10).filter(|p| **p == 1.0).count(), 100);
    }

    #[test]
    fn a_force_by_a_formula_is_no_file() {
        let mut out = [0.0; 4];
        assert_eq!(as_the_file_does(&Pulse::None, 0.1, 0, &mut out), None);
    }
}
