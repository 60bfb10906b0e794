//! Extrema and zero crossings of an oscillation, between the samples.

/// A turning point of an oscillation, between the samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Extremum {
    /// Time in samples.
    pub(super) time: f64,
    /// |x| there.
    pub(super) height: f64,
}

/// Extrema of |x| between zero crossings: one per half cycle.
///
/// The extremum is that of a sinusoid of `omega` (radian per sample) through the largest sample and its neighbours: near a peak it equals
/// the parabola, and it stays accurate with few samples a cycle.
pub(super) fn extrema(x: &[f64], omega: f64) -> Vec<Extremum> {
    let mut found = Vec::new();
    let mut from = 0;
    for to in 1..=x.len() {
        if to < x.len() && (x[to] >= 0.0) == (x[from] >= 0.0) {
            continue;
        }
        let top = (from..to).max_by(|&i, &j| x[i].abs().total_cmp(&x[j].abs())).unwrap_or(from);
        // Half cycles cut off by the ends of the record, and slivers made by noise, have no peak of their own.
        if from > 0 && to < x.len() && (to - from) as f64 * omega > 0.5 * std::f64::consts::PI {
            found.push(crest(x, top, omega));
        }
        from = to;
    }
    found
}

/// Crest of the sinusoid A cos(ω(n - n0)) through three samples.
fn crest(x: &[f64], n: usize, omega: f64) -> Extremum {
    let quadrature = (x[n + 1] - x[n - 1]) / (2.0 * omega.sin());
    let shift = (quadrature / x[n]).atan() / omega;
    Extremum { time: n as f64 + shift.clamp(-1.0, 1.0), height: x[n].hypot(quadrature) }
}

/// Zero crossings in samples, by straight lines, which suffice because the curvature of an oscillation vanishes at a crossing.
pub(super) fn crossings(x: &[f64]) -> Vec<f64> {
    let crossing = |i: &usize| (x[*i - 1] >= 0.0) != (x[*i] >= 0.0);
    (1..x.len()).filter(crossing).map(|i| i as f64 - x[i] / (x[i] - x[i - 1])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crests_of_a_sinusoid_are_exact_with_few_samples() {
        let omega = 0.61;
        let x: Vec<f64> = (0..200).map(|n| 3.0 * (omega * f64::from(n) + 0.4).cos()).collect();
        let found = extrema(&x, omega);
        assert_eq!(found.len(), 38);
        for (k, crest) in found.iter().enumerate() {
            assert!((crest.height - 3.0).abs() < 1e-12, "{}", crest.height);
            let expected = (std::f64::consts::PI * (k + 1) as f64 - 0.4) / omega;
            assert!((crest.time - expected).abs() < 1e-9);
        }
    }

    #[test]
    fn crossings_of_a_sinusoid() {
        let x: Vec<f64> = (0..1000).map(|n| (0.05 * f64::from(n) + 0.3).sin()).collect();
        for (k, n) in crossings(&x).iter().enumerate() {
            assert!((n - (std::f64::consts::PI * (k + 1) as f64 - 0.3) / 0.05).abs() < 1e-3);
        }
    }
}
