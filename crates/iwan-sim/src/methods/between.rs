//! What the samples of a force leave out: the motion of a linear mode under the difference of two forces.
//!
//! Time steps see a force at their own samples and take it for straight in between. A force from a file has samples of its own. Where these
//! lie between the steps, or are far more, the steps miss what no halving of their length would show. The difference of the two forces is
//! straight from one sample of either to the next, so that a linear mode's motion under it has a closed form.

use iwan_core::Oscillator;

/// A force that is straight between samples at a uniform interval, and zero behind the last.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Polyline<V> {
    pub(crate) dt: f64,
    /// Value of the sample of a number.
    pub(crate) value: V,
    /// Number of samples.
    pub(crate) count: usize,
    /// Whether it ends with its last sample, and not one interval later at zero.
    pub(crate) ends: bool,
}

impl<V: Fn(usize) -> f64> Polyline<V> {
    /// Between the samples before and behind `t`, of which the one before is number `n`: value just behind it, and slope.
    fn piece(&self, n: usize) -> [f64; 2] {
        let value = |i: usize| if i < self.count { (self.value)(i) } else { 0.0 };
        if self.ends && n + 1 >= self.count {
            return [0.0; 2];
        }
        let first = value(n);
        [first, (value(n + 1) - first) / self.dt]
    }
}

/// Closed form of q'' + 2ζω q' + ω² q = a + b t over one interval.
struct Propagator {
    omega: f64,
    zeta: f64,
    damped: f64,
    /// The interval, and exp, cos and sin for it: most are as long as the one before.
    known: [f64; 4],
}

impl Propagator {
    fn new(oscillator: &Oscillator) -> Self {
        let (omega, zeta) = (oscillator.omega0(), oscillator.damping_ratio());
        // Scenarios keep ζ below 1; at 1 itself the limit is as good as any value beside it.
        let damped = omega * (1.0 - zeta * zeta).max(1e-12).sqrt();
        Self { omega, zeta, damped, known: [0.0, 1.0, 1.0, 0.0] }
    }

    fn advance(&mut self, [q, v]: [f64; 2], [a, b]: [f64; 2], h: f64) -> [f64; 2] {
        if h != self.known[0] {
            let (s, c) = libm::sincos(self.damped * h);
            self.known = [h, libm::exp(-self.zeta * self.omega * h), c, s];
        }
        let [_, decay, c, s] = self.known;
        let (square, decrement) = (self.omega * self.omega, self.zeta * self.omega);
        let velocity = b / square;
        let rest = (a - 2.0 * self.zeta * self.omega * velocity) / square;
        let cosine = q - rest;
        let sine = (v - velocity + decrement * cosine) / self.damped;
        let swing = decay * (cosine * c + sine * s);
        let turned = decay * (sine * c - cosine * s);
        [swing + rest + velocity * h, self.damped * turned - decrement * swing + velocity]
    }
}

/// Displacement at n dt, n = 0, 1, …, of the linear mode that starts at rest under `force` less what steps of `seen.dt` see of it.
pub(crate) fn unseen(
    oscillator: &Oscillator,
    force: Polyline<impl Fn(usize) -> f64>,
    seen: Polyline<impl Fn(usize) -> f64>,
) -> impl Iterator<Item = f64> {
    let mut propagator = Propagator::new(oscillator);
    let mut state = [0.0; 2];
    // Number of the sample of `force` that was passed last; a sample that rounding left beside one of the steps stands on it.
    let (mut passed, near) = (0_usize, 1e-9 * seen.dt.min(force.dt));
    (0..).map(move |n: usize| {
        let moved = state[0];
        let (start, end) = (n as f64 * seen.dt, (n + 1) as f64 * seen.dt);
        let [value, slope] = seen.piece(n);
        let mut now = start;
        while now < end - near {
            while (passed + 1) as f64 * force.dt <= now + near {
                passed += 1;
            }
            // Behind its last sample the force is zero for good.
            let last = passed > force.count;
            let until = if last { end } else { end.min((passed + 1) as f64 * force.dt) };
            let until = if end - until < near { end } else { until };
            let [a, b] = force.piece(passed);
            let at = [a + b * (now - passed as f64 * force.dt), b];
            let less = [at[0] - value - slope * (now - start), at[1] - slope];
            state = propagator.advance(state, less, until - now);
            now = until;
        }
        moved
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use iwan_core::ResidualStiffness;

    fn line(dt: f64, samples: &[f64], ends: bool) -> Polyline<impl Fn(usize) -> f64> {
        Polyline { dt, value: |i| samples[i], count: samples.len(), ends }
    }

    fn oscillator() -> Oscillator {
        Oscillator::new(10.0, 0.02, 0.0, ResidualStiffness::Positive).unwrap()
    }

    /// Under a constant force q = P/ω² (1 - e^(-ζωt)(cos ω_d t + ζω/ω_d sin ω_d t)).
    #[test]
    fn a_step_that_the_steps_do_not_see_moves_the_mode_as_in_closed_form() {
        let (force, seen) = (line(1.0, &[6.0; 3], true), line(0.013, &[], false));
        let moved: Vec<f64> = unseen(&oscillator(), force, seen).take(100).collect();
        let (w, z) = (oscillator().omega0(), 0.02);
        let d = w * f64::sqrt(1.0 - z * z);
        for (n, q) in moved.iter().enumerate() {
            let t = n as f64 * 0.013;
            let exact =
                6.0 / (w * w) * (1.0 - (-z * w * t).exp() * ((d * t).cos() + z * w / d * (d * t).sin()));
            assert!((q - exact).abs() < 1e-14, "{n} {q} {exact}");
        }
    }

    /// A force whose samples are those of the steps, or every other of them, is seen whole.
    #[test]
    fn nothing_is_left_of_a_force_that_is_seen() {
        let samples: Vec<f64> = (0..50).map(|n| f64::from(n * n % 17)).collect();
        let force = line(0.01, &samples, false);
        let halved: Vec<f64> = (0..100)
            .map(|n| {
                if n % 2 == 0 {
                    samples[n / 2]
                } else {
                    0.5 * (samples[n / 2] + samples.get(n / 2 + 1).copied().unwrap_or(0.0))
                }
            })
            .collect();
        let seen = line(0.005, &halved, false);
        let moved: Vec<f64> = unseen(&oscillator(), force, seen).take(150).collect();
        assert!(moved.iter().all(|q| q.abs() < 1e-12), "{moved:?}");
    }

    /// A force whose mean over every step is zero and that the steps see as constant: the mode hardly moves, where they push it on.
    #[test]
    fn what_swings_between_the_steps_is_told() {
        let samples: Vec<f64> = (0..1000).map(|n| if n % 10 < 5 { 1.0 } else { -1.0 }).collect();
        let force = line(0.001, &samples, true);
        let coarse: Vec<f64> = samples.iter().copied().step_by(10).collect();
        let seen = line(0.01, &coarse, false);
        let missed = unseen(&oscillator(), force, seen).take(100).fold(0.0_f64, |m, q| m.max(q.abs()));
        let peak = 2.0 / oscillator().omega0().powi(2);
        assert!((0.8 * peak..1.1 * peak).contains(&missed), "{missed} {peak}");
    }
}
