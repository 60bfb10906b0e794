//! Loads that do not go with the motions: a force of another size, or on another clock.

use nalgebra::{DMatrix, DVector};

use super::beginning::{Opened, shapes_at_force};
use super::model::CoupledModel;
use super::records::CoupledTask;
use super::unknowns::Values;
use crate::estimate::{Found, Model, Squares};

/// Step of the difference by a factor on a load: its motion is nearly in proportion.
const GAIN_STEP: f64 = 0.01;
/// … and by its delay, in samples of the record.
const DELAY_STEP: f64 = 0.1;
/// What is plausible before a record is seen, as standard deviations: the gain of a load cell, and samples by which channels are apart. Records that tell neither, such as a
/// single one with an unknown shape at the load, have none then.
const PLAUSIBLE: [f64; 2] = [0.3, 10.0];
/// A load is named where its gain is off by more than this, or its clock by more than so many samples: load cells are calibrated to a per cent or two, and what a modal model
/// leaves out of the paper's beam looks like half a per cent and a tenth of a sample.
const NAMED: [f64; 2] = [0.02, 0.5];
/// … and the sum of squares of its record would fall below this share: the root mean square by three tenths.
const EXPLAINED: f64 = 0.5;

/// A gain or a delay is told alone where both together leave no more than this part of the root mean square less: a clock that lags by a fifth of a blow looks like a smaller
/// load as well.
const ALONE: f64 = 0.15;

/// A record begins with so many times the motion that its load makes by the other records, or a part of that, where its load is in another unit: pounds are 4.4 newtons. A joint that slips
/// takes less than half of a mode's first period.
const OTHER_UNIT: f64 = 3.0;

/// Records that begin as if their load had another sign or another unit than those of the others, in words. Such a load bends the fit so far that [`words`] would name another.
pub(super) fn at_odds(task: &CoupledTask<'_>, opened: &Opened, reference: &Values) -> Vec<String> {
    let count = task.records.len();
    if task.records[0].force.is_none() || count < 2 && task.shape_at_force.is_none() {
        return Vec::new();
    }
    let shapes: Vec<Option<Vec<f64>>> =
        (0..count).map(|k| shapes_at_force(task, opened, reference, k..k + 1)).collect();
    let usual = |mode: usize| -> Option<f64> {
        if let Some(given) = task.shape_at_force {
            return Some(given[mode]);
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
        let than = if task.shape_at_force.is_some() { "the shapes at the load" } else { "the other records" };
        odd.then(|| {
            format!(
                "{}: it begins with {:.2} to {:.2} times the motion that its load makes by {than}: check the sign and the unit of its force",
                task.records[k].name, least, most
            )
        })
    };
    shapes.iter().enumerate().filter_map(of).collect()
}

/// A load that does not go with its record.
struct Doubt {
    record: usize,
    /// Factor on the load less one, and delay in samples, with which the record would go better.
    by: [f64; 2],
    /// Sum of squares of the record's residuals with that over that without.
    left: f64,
}

/// The load that explains most of what is left of its record, in words with the record's name; none where all go with their motions.
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

/// What a gain and a delay of one load would explain, all unknowns following.
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
        // Unknowns that nothing tells stay where they are.
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
