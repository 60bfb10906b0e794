//! What a force from a file does between the steps.
//!
//! Time steps see a force at their own samples. A force from a file has samples of its own, is straight between them, and need not be smooth: where its samples lie
//! between the steps, or are far more, the steps miss what no halving of their length would show. So companion runs take other samples: those under which the steps
//! push a motion on as the file does.

use iwan_core::Pulse;

/// Nodes of Gauss and Legendre's rule of three points on -1 to 1, and their weights: exact for a straight force times a cubic.
const RULE: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// Samples at n `dt`, n = `first`, `first` + 1, …, with which steps of average acceleration do as a force from a file does; returns how many
/// come before all are zero. None for a force by a formula.
///
/// Such steps work as the trapezoidal rule does: sample n counts `dt` times what a push at its time moves later. The file's force at a time between them is handed to the four
/// samples around it, by the weights with which a cubic through four points gives the value there (at the start through the first four). What a push moves is smooth, a sine of the time
/// that has passed since, so that this is as good as the file up to (ω dt)^4.
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
                        // The first sample stands for half a step only.
                        *sample += push * share * if n == 0 { 2.0 } else { 1.0 };
                    }
                }
            }
            (now, piece) = (until, piece + 1);
        }
    }
    Some(out.iter().rposition(|p| *p != 0.0).map_or(0, |last| last + 1))
}

/// Weights of the values at 0, 1, 2 and 3 in that of the cubic through them at `x`.
fn cubic(x: f64) -> [f64; 4] {
    let [a, b, c, d] = [x, x - 1.0, x - 2.0, x - 3.0];
    [-b * c * d / 6.0, a * c * d / 2.0, -a * b * d / 2.0, a * b * c / 6.0]
}

/// Largest error of steps, over all samples of the double steps: what the file does and they miss, and a `divisor`-th of what steps
/// twice as long differ by.
///
/// `fine` are displacements under the samples that the steps see, `whole` and `double` under those that do as the file does; without a file `whole` is `fine`.
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

    /// The integral of a straight force times t³ - 2 t + 1 is known: so is the sum of the samples by the trapezoidal rule, whatever the two intervals.
    #[test]
    fn steps_push_a_cubic_as_the_file_does() {
        let file = file(40);
        let moves = |t: f64| t * t * t - 2.0 * t + 1.0;
        for own in [0.0137, 0.1, 0.31] {
            let force = Pulse::Sampled { dt: own, samples: &file };
            let mut exact = 0.0;
            for (n, pair) in file.windows(2).enumerate() {
                // Gauss and Legendre's rule again, which is exact.
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
        // The first four make up for the corner at which the force begins.
        assert!(seen[4..17].iter().all(|p| (p - 6.0).abs() < 1e-13), "{seen:?}");
        assert!(seen[21..].iter().all(|p| *p == 0.0), "{seen:?}");
    }

    /// A force whose mean over every step is zero, where the steps see a constant one.
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
