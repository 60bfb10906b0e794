//! Curves of the model's ring-down beside those of the record.

use crate::curve_fit::{Compared, Pairs};
use crate::curves::Curves;
use crate::refine::TurningPoint;

/// Curves of records and model, value by value: at the times that they share, and at the amplitudes that they share.
///
/// Neither says enough alone. A model that damps too much is too small after a while, and loses as much energy there as the record does: at equal
/// times the two errors cancel. A model that damps too little never comes down to the record's last amplitudes: there is nothing to compare them with.
///
/// Frequencies are those of the mean day, so that what hits stray by is neither a misfit nor a shift.
pub(super) fn beside_record(curves: &[Curves], model: &[Curves], starts: &[TurningPoint]) -> [Pairs; 2] {
    let (mut at_times, mut at_amplitudes) = (Pairs::default(), Pairs::default());
    for ((record, model), start) in curves.iter().zip(model).zip(starts) {
        let mean_day = (-start.day).exp();
        for (j, t) in model.t.iter().enumerate() {
            let Some(i) = record.t.iter().position(|s| s == t) else { continue };
            add(&mut at_times, record, i, (model.dissipation[j], model.frequency[j]), mean_day);
        }
        let by_amplitude = ByAmplitude::new(model);
        for (i, amplitude) in record.displacement.iter().enumerate() {
            if let Some(found) = by_amplitude.at(*amplitude) {
                add(&mut at_amplitudes, record, i, found, mean_day);
            }
        }
    }
    [at_times, at_amplitudes]
}

fn add(pairs: &mut Pairs, record: &Curves, i: usize, (dissipation, frequency): (f64, f64), mean_day: f64) {
    if record.dissipation[i] > 0.0 && dissipation > 0.0 {
        pairs.dissipation.push(Compared {
            measured: record.dissipation[i].ln(),
            deviation: record.log_dissipation_sd[i],
            model: dissipation.ln(),
        });
    }
    pairs.frequency.push(Compared {
        measured: mean_day * record.frequency[i],
        deviation: mean_day * record.frequency_sd[i],
        model: mean_day * frequency,
    });
}

/// Dissipation and frequency of a model against ln amplitude, in rising order.
struct ByAmplitude(Vec<Point>);

#[derive(Clone, Copy)]
struct Point {
    log_amplitude: f64,
    log_dissipation: f64,
    frequency: f64,
}

impl ByAmplitude {
    fn new(model: &Curves) -> Self {
        let point = |i: usize| Point {
            log_amplitude: model.displacement[i].ln(),
            log_dissipation: model.dissipation[i].ln(),
            frequency: model.frequency[i],
        };
        let told = |p: &Point| p.log_amplitude.is_finite() && p.log_dissipation.is_finite();
        let mut points: Vec<Point> = (0..model.t.len()).map(point).filter(told).collect();
        points.sort_by(|a, b| a.log_amplitude.total_cmp(&b.log_amplitude));
        Self(points)
    }

    /// Dissipation and frequency at an amplitude, linear between neighbours in ln amplitude; none where the model never has this amplitude.
    fn at(&self, amplitude: f64) -> Option<(f64, f64)> {
        let x = amplitude.ln();
        let above = self.0.partition_point(|p| p.log_amplitude < x);
        let (low, high) = (self.0.get(above.checked_sub(1)?)?, self.0.get(above)?);
        let part = (x - low.log_amplitude) / (high.log_amplitude - low.log_amplitude);
        let between = |low: f64, high: f64| low + part * (high - low);
        let dissipation = between(low.log_dissipation, high.log_dissipation).exp();
        Some((dissipation, between(low.frequency, high.frequency)))
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::curve_fit::{Beside, Verdict};
    use crate::curves::ForceAxis;

    /// Curves of a decay whose rate is `rate` times the amplitude, in closed form: an amplitude of 1 / (1 + rate t).
    fn decay(rate: f64) -> Curves {
        let t: Vec<f64> = (0..28).map(|i| 0.01 * f64::from(i)).collect();
        let displacement: Vec<f64> = t.iter().map(|t| 1.0 / (1.0 + rate * t)).collect();
        let (frequency, all_alike) = (100.0, vec![1e-3; t.len()]);
        Curves {
            frequency: vec![frequency; t.len()],
            damping_ratio: displacement.iter().map(|a| rate * a / (TAU * frequency)).collect(),
            dissipation: displacement.iter().map(|a| TAU * TAU * frequency * rate * a.powi(3)).collect(),
            force: displacement.clone(),
            axis: ForceAxis::Modal,
            log_dissipation_sd: all_alike.clone(),
            frequency_sd: all_alike,
            independent: 5.0,
            displacement,
            t,
        }
    }

    #[test]
    fn errors_that_cancel_at_equal_times_are_seen_at_equal_amplitudes() {
        let record = [decay(3.0)];
        let start = [TurningPoint { displacement: 1.0, time: 0.0, day: 0.0 }];
        for pairs in beside_record(&record, &record, &start) {
            assert!(pairs.dissipation.len() >= 27, "{}", pairs.dissipation.len());
            assert!(pairs.dissipation.iter().all(|c| (c.measured - c.model).abs() < 1e-12));
        }
        let half_as_much_again = [decay(4.5)];
        let [at_times, at_amplitudes] = beside_record(&record, &half_as_much_again, &start);
        assert!(
            at_amplitudes.dissipation.iter().all(|c| (c.model - c.measured - 1.5_f64.ln()).abs() < 1e-9),
            "D is a power of the amplitude, and straight between cycles"
        );
        let misfit = |pairs: &[Pairs]| Verdict::beside(&Beside::default(), pairs).dissipation_misfit;
        let (times, both) =
            (misfit(std::slice::from_ref(&at_times)), misfit(&[at_times.clone(), at_amplitudes]));
        assert!((both - 1.5_f64.ln()).abs() < 1e-9, "{both}");
        assert!(times < 0.6 * both, "{times}");
        // A model that damps so little that it never comes down to the record's amplitudes is held against the times.
        let [at_times, at_amplitudes] = beside_record(&[decay(300.0)], &[decay(1e-3)], &start);
        assert!(at_times.dissipation.len() == 28 && at_amplitudes.dissipation.len() < 2);
        assert!(misfit(&[at_times, at_amplitudes]) > 1.0);
    }
}
