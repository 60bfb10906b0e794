//! By how much the frequencies of several records differ at the same amplitude: the search for each day's frequency begins with these differences.

use super::prepared::Prepared;
use crate::curves::Curves;
use crate::refine::may_stray;

/// ln of each record's frequency over the mean of all records, taken at amplitudes that the record shares with the loudest one; before the mean is
/// taken off, records that share none count as zero. None where records are not taken to differ by the day.
pub(super) fn days(prepared: &[Prepared<'_>]) -> Option<Vec<f64>> {
    let curves: Vec<&Curves> = prepared.iter().map(|p| &p.curves).collect();
    let loudness: Vec<f64> = curves.iter().map(|c| largest(c)).collect();
    let loudest =
        curves.iter().max_by(|a, b| largest(a).total_cmp(&largest(b))).filter(|_| may_stray(&loudness))?;
    let apart: Vec<f64> = curves.iter().map(|c| apart(c, loudest)).collect();
    let mean = apart.iter().sum::<f64>() / apart.len() as f64;
    Some(apart.iter().map(|day| day - mean).collect())
}

/// The same curves with the day's offset (ln of the frequency ratio) taken off the frequency.
pub(super) fn on_mean_day(curves: &Curves, day: f64) -> Curves {
    let mut curves = curves.clone();
    curves.frequency.iter_mut().for_each(|f| *f *= (-day).exp());
    curves
}

pub(super) fn largest(curves: &Curves) -> f64 {
    curves.displacement.iter().copied().fold(0.0, f64::max)
}

/// Median of ln of a record's frequency over that of another one at the same amplitudes; zero where they share no amplitude.
pub(super) fn apart(curves: &Curves, other: &Curves) -> f64 {
    let pairs = curves.displacement.iter().zip(&curves.frequency);
    let mut logs: Vec<f64> = pairs
        .filter_map(|(a, f)| Some((f / frequency_at(other, *a)?).ln()))
        .filter(|l| l.is_finite())
        .collect();
    logs.sort_by(f64::total_cmp);
    logs.get(logs.len() / 2).copied().unwrap_or(0.0)
}

/// Frequency (Hz) at an amplitude that decaying curves pass; none outside their amplitudes.
fn frequency_at(curves: &Curves, displacement: f64) -> Option<f64> {
    let pairs = curves.displacement.windows(2).zip(curves.frequency.windows(2));
    let mut passed = pairs.filter(|(a, _)| a[0] >= displacement && displacement >= a[1]);
    passed.next().map(|(a, f)| {
        let part = if a[0] > a[1] { (a[0] - displacement) / (a[0] - a[1]) } else { 0.0 };
        f[0] + part * (f[1] - f[0])
    })
}
