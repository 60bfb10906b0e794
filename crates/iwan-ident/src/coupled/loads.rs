//! Loads that do not go with the motions of their records: a force of another size, or on another clock.

use nalgebra::{DMatrix, DVector};

use super::beginning::{Opened, shapes_at_force};
use super::model::CoupledModel;
use super::records::CoupledTask;
use super::unknowns::Values;
use crate::estimate::{Found, Model, Squares};

/// Relative change of a load by which the derivative for its gain is taken: the motion is nearly in proportion to the load.
const GAIN_STEP: f64 = 0.01;
/// Delay by which the derivative for the load's delay is taken, in samples of the record.
const DELAY_STEP: f64 = 0.1;
/// Standard deviations of what is plausible before a record is seen: of the gain of a load cell, and of the delay between channels in samples. Where records tell neither,
/// such as a single one with an unknown shape at the load, gain and delay then come out as none.
const PLAUSIBLE: [f64; 2] = [0.3, 10.0];
/// A load is named where its gain is off by more than this, or its delay by more than this many samples: load cells are calibrated to a per cent or two, and what a modal model
/// leaves out of the paper's beam looks like half a per cent and a tenth of a sample.
const NAMED: [f64; 2] = [0.02, 0.5];
/// The sum of squares of the record must also fall below this share: the root mean square falls by three tenths.
const EXPLAINED: f64 = 0.5;

/// A gain or a delay alone is named unless both together leave a root mean square that is smaller by more than this part: a clock that lags by a fifth of a blow looks like a
/// smaller load as well.
const ALONE: f64 = 0.15;

/// A load is in another unit where the record begins with more than this many times the motion that its load makes in the other records, or with less than the inverse: pounds
/// are 4.4 newtons. A joint that slips takes less than half of a mode's motion in its first period.
const OTHER_UNIT: f64 = 3.0;

/// Sentences on records that begin as if their load had another sign or another unit than the loads of the others. Such a load bends the fit so far that [`words`] would name
/// another.
pub(super) fn at_odds(task: &CoupledTask<'_>, opened: &Opened, reference: &Values) -> Vec<String> {
    let count = task.records.len();
    if task.records[0].force.is_none() || count < 2 && task.shape_at_force.is_none() {
        return Vec::new();
    }
    let shapes: Vec<Option<Vec<f64>>> =
        (0..count).map(|k| shapes_at_force(task, opened, reference, k..k + 1)).collect();
    // Of two records either may be wrong: the second is then held against the first, and both are named.
    let two = count == 2 && task.shape_at_force.is_none();
    let usual = |mode: usize| -> Option<f64> {
        if let Some(given) = task.shape_at_force {
            return Some(given[mode]);
        }
        if two {
            return shapes[0].as_ref().map(|first| first[mode]);
        }
        let mut all: Vec<f64> = shapes.iter().flatten().map(|shape| shape[mode]).collect();
        all.sort_by(f64::total_cmp);
        all.get(all.len() / 2).copied()
    };
    let Some(usual) = (0..task.modes.len()).map(usual).collect::<Option<Vec<f64>>>() else {
        return Vec::new();
    };
    let of = |(k, shape): (usize, &Option<Vec<f64>>)| {
        let mut ratios: Vec<f64> =
            shape.as_ref()?.iter().zip(&usual).map(|(own, usual)| own / usual).collect();
        ratios.sort_by(f64::total_cmp);
        let (least, most) = (ratios[0], ratios[ratios.len() - 1]);
        let odd = most < 0.0 || least > OTHER_UNIT || (least > 0.0 && most < 1.0 / OTHER_UNIT);
        let (than, whose) = match task.shape_at_force {
            Some(_) => ("the shapes at the load", "its force"),
            None if two => (task.records[0].name.as_str(), "both forces"),
            None => ("the other records", "its force"),
        };
        odd.then(|| {
            format!(
                "{}: it begins with {:.2} to {:.2} times the motion that its load makes by {than}: check the sign and the unit of {whose}",
                task.records[k].name, least, most
            )
        })
    };
    shapes.iter().enumerate().filter_map(of).collect()
}

/// A load that does not go with its record.
struct Doubt {
    record: usize,
    /// Gain less one, and delay in samples, with which the load would fit the record better.
    by: [f64; 2],
    /// Sum of squares of the record's residuals with that gain and delay over that without.
    left: f64,
}

/// A sentence on the load that explains most of the residuals of its record; none where all loads go with their motions.
pub(super) fn words(model: &CoupledModel<'_>, found: &Found, names: &[String]) -> Option<String> {
    let free: Vec<usize> = (0..found.x.len()).collect();
    let jacobian = Squares(model).derivatives_at(&found.x, &free)?;
    let mut residuals = vec![0.0; model.count()];
    if !model.evaluate(&found.x, &mut residuals, None) {
        return None;
    }
    let all = (0..model.records.len()).filter_map(|k| doubt(model, found, (&jacobian, &residuals), k));
    let named = |d: &Doubt| d.left < EXPLAINED && (0..2).any(|i| d.by[i].abs() > NAMED[i]);
    let Doubt { record, by: [gain, delay], left } =
        all.filter(named).min_by(|a, b| a.left.total_cmp(&b.left))?;
    let dt = model.records[record].clock.sample();
    let mut parts = Vec::new();
    if gain.abs() > NAMED[0] {
        let than = if gain > 0.0 { "larger" } else { "smaller" };
        parts.push(format!("{:.1} % {than} than it says", 100.0 * gain.abs()));
    }
    if delay.abs() > NAMED[1] {
        let when = if delay > 0.0 { "later" } else { "earlier" };
        parts.push(format!("{:.1} samples ({:.2e} s) {when}", delay.abs(), (delay * dt).abs()));
    }
    Some(format!(
        "{}: its motion is that of a load {}, which would leave {:.0} % less of it: check the load cell's sensitivity and the clocks of its channels",
        names[record],
        parts.join(" and "),
        100.0 * (1.0 - left.sqrt())
    ))
}

/// What a gain and a delay of the load of record `k` would explain when all unknowns follow.
fn doubt(
    model: &CoupledModel<'_>,
    found: &Found,
    (jacobian, residuals): (&DMatrix<f64>, &[f64]),
    k: usize,
) -> Option<Doubt> {
    let force = &model.records[k].clock.force;
    let samples = model.records[k].clock.sample() / model.records[k].clock.step;
    let at = |n: usize| force.get(n).copied().unwrap_or(0.0);
    let slope = |n: usize| 0.5 * (at(n + 1) - at(n.saturating_sub(1))) * samples;
    let changed = [
        force.iter().map(|p| p * (1.0 + GAIN_STEP)).collect::<Vec<_>>(),
        (0..force.len()).map(|n| at(n) - DELAY_STEP * slope(n)).collect(),
    ];
    let columns = changed.into_iter().zip([GAIN_STEP, DELAY_STEP]).map(|(load, step)| {
        let mut column = DVector::zeros(residuals.len());
        for (row, change) in model.changes_by_load(&found.x, k, load)? {
            column[row] = change / step;
        }
        Some(column)
    });
    let columns = columns.collect::<Option<Vec<_>>>()?;
    let of_record = |r: &[f64]| model.rows_of(k).map(|row| r[row] * r[row]).sum::<f64>();
    let before = of_record(residuals);
    let (n, count) = (found.x.len(), residuals.len());
    let by = |parts: &[usize]| -> Option<Doubt> {
        let mut matrix = DMatrix::zeros(count + parts.len(), n + parts.len());
        matrix.view_mut((0, 0), (count, n)).copy_from(jacobian);
        for (i, part) in parts.iter().enumerate() {
            matrix.view_mut((0, n + i), (count, 1)).copy_from(&columns[*part]);
            matrix[(count + i, n + i)] = 1.0 / PLAUSIBLE[*part];
        }
        let mut right = DVector::zeros(count + parts.len());
        right.rows_mut(0, count).copy_from_slice(residuals);
        // Unknowns that no residual feels stay where they are.
        let solved = matrix.clone().svd(true, true).solve(&right, 1e-9 * matrix.norm()).ok()?;
        let after = right - matrix * &solved;
        let mut doubt =
            Doubt { record: k, by: [0.0; 2], left: of_record(&after.as_slice()[..count]) / before };
        for (i, part) in parts.iter().enumerate() {
            doubt.by[*part] = -solved[n + i];
        }
        Some(doubt)
    };
    let both = by(&[0, 1]).filter(|_| before > 0.0)?;
    let one = [0, 1].into_iter().filter_map(|part| by(&[part])).min_by(|a, b| a.left.total_cmp(&b.left));
    Some(one.filter(|one| one.left.sqrt() < both.left.sqrt() + ALONE).unwrap_or(both))
}
