//! Mode shapes of dataset 55.

use std::f64::consts::TAU;

use super::nodal::{ModalScale, NodalMode, NodalValues};
use super::rows::Rows;
use crate::error::ReadError;

/// Number of rows of text before the numbers.
const TITLES: usize = 5;
/// Width in characters of a real number, and how many stand in a row.
const REALS: (usize, usize) = (13, 6);

/// What record 6 states about the values.
struct Kind {
    /// 2 normal mode, 3 complex eigenvalue of first order, 7 of second order.
    analysis: i64,
    complex: bool,
    /// Number of values for each node.
    values: usize,
}

/// A mode, or the reason why the dataset is no mode.
pub(super) fn mode(rows: &mut Rows) -> Result<Result<NodalMode, String>, ReadError> {
    for _ in 0..TITLES {
        let _ = rows.next();
    }
    let head = rows.integers(
        6,
        "six whole numbers: model, analysis, data, what is measured, real or complex, values a node",
    )?;
    let kind = Kind {
        analysis: head[1],
        complex: matches!(head[4], 5 | 6),
        values: usize::try_from(head[5]).unwrap_or(0),
    };
    if !matches!(kind.analysis, 2 | 3 | 7) {
        return Ok(Err(format!("analysis type {} is no mode (2, 3 or 7)", kind.analysis)));
    }
    if !matches!((head[2], kind.values), (2, 3) | (3, 6)) {
        return Ok(Err(format!(
            "{} values of characteristic {} a node are no translations (three, or six with rotations)",
            head[5], head[2]
        )));
    }
    let counts = rows.integers(2, "how many whole and how many real numbers follow")?;
    let [whole, real] = [counts[0], counts[1]].map(|n| usize::try_from(n).unwrap_or(0).min(64));
    // Eight whole numbers stand in a row, and the two counts are the first two of them.
    for _ in 1..(2 + whole).div_ceil(8) {
        let _ = rows.next();
    }
    let reals = rows.numbers(real, REALS, "the real numbers of the mode")?;
    let (pole, scale) = match poles(&kind, &reals) {
        Ok(found) => found,
        Err(reason) => return Ok(Err(reason)),
    };
    let (frequency, damping_ratio) = frequency(pole);
    let mut mode = NodalMode { frequency, damping_ratio, pole, scale, values: values(rows, &kind)? };
    if pole[1] < 0.0 {
        conjugate(&mut mode);
    }
    Ok(Ok(mode))
}

/// Frequency in Hz and damping ratio of a pole in 1/s.
fn frequency([re, im]: [f64; 2]) -> (f64, f64) {
    let size = re.hypot(im);
    (size / TAU, -re / size)
}

/// Replaces a mode by its complex conjugate: of a pair the pole with positive imaginary part is kept.
fn conjugate(mode: &mut NodalMode) {
    mode.pole[1] = -mode.pole[1];
    if let ModalScale::A(a) = &mut mode.scale {
        a[1] = -a[1];
    }
    for value in mode.values.iter_mut().flat_map(|(_, values)| values) {
        value[1] = -value[1];
    }
}

fn poles(kind: &Kind, reals: &[f64]) -> Result<([f64; 2], ModalScale), String> {
    let value = |i: usize| reals.get(i).copied().unwrap_or(0.0);
    if kind.analysis == 2 {
        let (size, zeta) = (TAU * value(0), value(2));
        if !(size > 0.0 && (0.0..1.0).contains(&zeta)) {
            return Err(format!("frequency {} Hz and damping ratio {zeta} are no mode's", value(0)));
        }
        let scale = if value(1) > 0.0 { ModalScale::Mass(value(1)) } else { ModalScale::Unknown };
        return Ok(([-zeta * size, size * (1.0 - zeta * zeta).sqrt()], scale));
    }
    if !(value(1).abs() > 0.0 && value(0) <= 0.0) {
        return Err(format!("{} + {}i is no pole of a vibration that decays", value(0), value(1)));
    }
    let a = [value(2), value(3)];
    Ok(([value(0), value(1)], if a == [0.0; 2] { ModalScale::Unknown } else { ModalScale::A(a) }))
}

fn values(rows: &mut Rows, kind: &Kind) -> Result<Vec<(i64, NodalValues)>, ReadError> {
    let mut values = Vec::new();
    while !rows.ended() {
        let node = rows.integers(1, "the number of a node")?[0];
        let parts = if kind.complex { 2 } else { 1 };
        let numbers = rows.numbers(kind.values * parts, REALS, "the mode's values at the node")?;
        let at = |axis: usize| {
            if kind.complex { [numbers[2 * axis], numbers[2 * axis + 1]] } else { [numbers[axis], 0.0] }
        };
        values.push((node, [at(0), at(1), at(2)]));
    }
    Ok(values)
}
