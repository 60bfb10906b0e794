//! Contributions of modes, inside and outside the band, to responses: columns of a real least-squares problem.

use iwan_machine::memory::ask;
use nalgebra::DMatrix;
use rayon::prelude::*;

use super::band::Band;
use super::outside::OUTSIDE;
use crate::error::Error;
use crate::number::{Complex, I};

/// The columns of a set of poles in a band: weighted, with real parts above imaginary parts.
pub(super) struct Columns {
    /// Number of poles.
    pub(super) poles: usize,
    /// Two columns for each pole (real and imaginary part of its residue), two for each term outside, then two more for each pole where derivatives are wanted.
    pub(super) matrix: DMatrix<f64>,
}

impl Columns {
    /// Columns for `poles` (1/s, upper half plane); `slopes` adds their derivatives with respect to the poles.
    ///
    /// # Errors
    /// [`Error::Memory`] where there is too little for them, for their transpose, and for those of the poles before.
    pub(super) fn new(band: &Band, poles: &[Complex], slopes: bool) -> Result<Self, Error> {
        let (rows, n) = (2 * band.lines(), poles.len());
        let (own, around) = (2 * n * rows, 2 * OUTSIDE * rows);
        let numbers = own + around + if slopes { own } else { 0 };
        let what = format!("a fit of {n} modes to {} lines", band.lines());
        let remedy = "fit a narrower band, or take shorter records";
        ask(what, 3 * (numbers * size_of::<f64>()) as u64, remedy)?;
        let mut values = vec![0.0; numbers];
        let (sought, derivatives) = values.split_at_mut(own + around);
        let (of_poles, outside) = sought.split_at_mut(own);
        outside.copy_from_slice(&band.outside);
        let mut derivatives = derivatives.chunks_mut(2 * rows);
        let mut pairs: Vec<[&mut [f64]; 2]> =
            of_poles.chunks_mut(2 * rows).map(|v| [v, derivatives.next().unwrap_or_default()]).collect();
        pairs.par_iter_mut().zip(poles).for_each(|([value, slope], pole)| mode(band, *pole, value, slope));
        Ok(Self { poles: n, matrix: DMatrix::from_vec(rows, values.len() / rows, values) })
    }

    /// Number of columns whose coefficients are sought: all but the derivatives.
    pub(super) fn linear(&self) -> usize {
        2 * (self.poles + OUTSIDE)
    }
}

/// Writes the two columns of a pole, which multiply real and imaginary part of its residue, into `values`, and their derivatives with respect to the pole
/// into `slopes`, unless that is empty.
fn mode(band: &Band, pole: Complex, values: &mut [f64], slopes: &mut [f64]) {
    let lines = band.lines();
    let in_record = band.responses.record.as_ref().map(|r| r.at(pole));
    let at = |k: usize| {
        if let Some(pole) = &in_record {
            return pole.pair(band.first + k, band.s[k], band.back[k]);
        }
        [pole, pole.conj()].map(|p| {
            let direct = (band.s[k] - p).inv();
            (direct, direct * direct)
        })
    };
    // `x` multiplies the residue, `conjugate` multiplies its conjugate.
    let put = |target: &mut [f64], k: usize, x: Complex, conjugate: Complex| {
        let w = band.weights[k];
        let (re, im) = (x + conjugate, I * (x - conjugate));
        target[k] = w * re.re;
        target[lines + k] = w * re.im;
        target[2 * lines + k] = w * im.re;
        target[3 * lines + k] = w * im.im;
    };
    for k in 0..lines {
        let [(value, slope), (value_of, slope_of)] = at(k);
        put(values, k, value, value_of);
        if !slopes.is_empty() {
            put(slopes, k, slope, slope_of);
        }
    }
}
