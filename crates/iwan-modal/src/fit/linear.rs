//! Residues by linear least squares for given poles, and what the poles' own change would do.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rayon::prelude::*;

use super::band::Band;
use super::columns::Columns;
use crate::error::Error;
use crate::number::{Complex, complex};

/// Responses whose products are computed together, each such group by itself: so many that matrices are worth it, and so few that fifty responses are work for
/// several threads.
const AT_ONCE: usize = 16;

/// Residues of given poles, with the products that a search for better poles needs.
pub(crate) struct Linear {
    /// Number of poles.
    pub(crate) poles: usize,
    /// Coefficients of all linear columns, scaled back: rows as in the columns, one column for each response.
    pub(crate) coefficients: DMatrix<f64>,
    /// Sum of squares that is left of each response.
    pub(crate) left: Vec<f64>,
    /// What is left of the responses, as they stand in the band.
    pub(crate) rest: DMatrix<f64>,
    /// Inverse of the linear columns' normal matrix.
    pub(crate) inverse: DMatrix<f64>,
    /// Slopes, what lies in the linear columns' space taken off: products with each other and with what is left of the responses.
    pub(super) slopes: Option<Slopes>,
}

/// Products of the slope columns, two for each pole.
pub(super) struct Slopes {
    /// W⊥ᵀ W⊥.
    pub(super) among: DMatrix<f64>,
    /// W⊥ᵀ r, one column for each response.
    pub(super) with_left: DMatrix<f64>,
    /// Φ⁺ W: how residues follow where poles move.
    pub(super) follow: DMatrix<f64>,
}

impl Linear {
    /// Least squares for `poles` in a band.
    pub(crate) fn new(band: &Band, poles: &[Complex], slopes: bool) -> Result<Self, Error> {
        let columns = Columns::new(band, poles, slopes);
        let n = columns.linear();
        let x = &columns.matrix;
        // Products of matrices are a few times faster than those of columns.
        let turned = x.transpose();
        let gram = &turned * x;
        let scale: Vec<f64> = (0..n).map(|j| gram[(j, j)].sqrt().max(f64::MIN_POSITIVE).recip()).collect();
        let scaled = DMatrix::from_fn(n, n, |i, j| gram[(i, j)] * scale[i] * scale[j]);
        let factor = factor(scaled, poles)?;
        let solve = |b: &DMatrix<f64>| {
            let mut b = b.clone();
            scale_rows(&mut b, &scale);
            let mut x = factor.solve(&b);
            scale_rows(&mut x, &scale);
            x
        };
        let sought = x.columns(0, n);
        let of_some = |first: &usize| {
            let values = band.values.columns(*first, AT_ONCE.min(band.values.ncols() - first));
            let coefficients = solve(&(turned.rows(0, n) * values));
            let rest = values - sought * &coefficients;
            let with_left = turned.rows(n, x.ncols() - n) * &rest;
            [coefficients, rest, with_left]
        };
        let groups: Vec<usize> = (0..band.values.ncols()).step_by(AT_ONCE).collect();
        let groups: Vec<[DMatrix<f64>; 3]> = groups.par_iter().map(of_some).collect();
        let [coefficients, rest, with_left] = [0, 1, 2].map(|part| side_by_side(&groups, part));
        let slopes = slopes.then(|| {
            let m = x.ncols() - n;
            let cross = gram.view((0, n), (n, m)).into_owned();
            let follow = solve(&cross);
            let among = gram.view((n, n), (m, m)) - cross.tr_mul(&follow);
            Slopes { among, with_left, follow }
        });
        let left = (0..rest.ncols()).map(|c| rest.column(c).norm_squared()).collect();
        let inverse = solve(&DMatrix::identity(n, n));
        Ok(Self { poles: poles.len(), coefficients, left, rest, inverse, slopes })
    }

    /// Residue of a pole in a response.
    pub(crate) fn residue(&self, pole: usize, response: usize) -> Complex {
        complex(self.coefficients[(2 * pole, response)], self.coefficients[(2 * pole + 1, response)])
    }
}

impl Linear {
    /// By how much more of a response's sum of squares would be left without a pole, all others as they are: c P⁻¹ c of its two coefficients c and
    /// their part P of the normal matrix's inverse.
    pub(crate) fn loss(&self, pole: usize, response: usize) -> f64 {
        let i = 2 * pole;
        let [a, b, d] = [self.inverse[(i, i)], self.inverse[(i, i + 1)], self.inverse[(i + 1, i + 1)]];
        let [x, y] = [self.coefficients[(i, response)], self.coefficients[(i + 1, response)]];
        (d * x * x - 2.0 * b * x * y + a * y * y) / (a * d - b * b)
    }
}

/// One part of all groups of responses.
fn side_by_side(groups: &[[DMatrix<f64>; 3]], part: usize) -> DMatrix<f64> {
    let rows = groups.first().map_or(0, |g| g[part].nrows());
    let mut all = DMatrix::zeros(rows, groups.iter().map(|g| g[part].ncols()).sum());
    let mut from = 0;
    for group in groups {
        all.columns_mut(from, group[part].ncols()).copy_from(&group[part]);
        from += group[part].ncols();
    }
    all
}

fn factor(scaled: DMatrix<f64>, poles: &[Complex]) -> Result<Cholesky<f64, Dyn>, Error> {
    Cholesky::new(scaled).ok_or_else(|| {
        let list: Vec<String> =
            poles.iter().map(|p| format!("{:.6}", p.norm() / std::f64::consts::TAU)).collect();
        let finding = format!("the lines of the band do not tell the modes at {} Hz apart", list.join(", "));
        Error::refused("modal fit", finding, "leave one out, or record longer")
    })
}

fn scale_rows(matrix: &mut DMatrix<f64>, scale: &[f64]) {
    for (i, s) in scale.iter().enumerate() {
        matrix.row_mut(i).scale_mut(*s);
    }
}

impl Slopes {
    /// Normal matrix and gradient of the poles, real and imaginary parts in turn, for responses with the weights `precision`.
    pub(super) fn normal(&self, linear: &Linear, precision: &[f64]) -> (DMatrix<f64>, DVector<f64>) {
        let n = linear.poles;
        // What multiplies the two slope columns of a pole: (a, b) for its real part, (-b, a) for its imaginary part.
        let factors = |p: usize, c: usize| {
            let r = linear.residue(p, c);
            [[r.re, r.im], [-r.im, r.re]]
        };
        let mut matrix = DMatrix::zeros(2 * n, 2 * n);
        let mut gradient = DVector::zeros(2 * n);
        for (c, weight) in precision.iter().enumerate() {
            let all: Vec<_> = (0..n).map(|p| factors(p, c)).collect();
            for (p, rows) in all.iter().enumerate() {
                for (i, row) in rows.iter().enumerate() {
                    let own = row[0] * self.with_left[(2 * p, c)] + row[1] * self.with_left[(2 * p + 1, c)];
                    gradient[2 * p + i] += weight * own;
                    for (q, columns) in all.iter().enumerate().take(p + 1) {
                        for (j, column) in columns.iter().enumerate() {
                            let at =
                                |a: usize, b: usize| self.among[(2 * p + a, 2 * q + b)] * row[a] * column[b];
                            matrix[(2 * p + i, 2 * q + j)] +=
                                weight * (at(0, 0) + at(0, 1) + at(1, 0) + at(1, 1));
                        }
                    }
                }
            }
        }
        for i in 0..2 * n {
            for j in i + 1..2 * n {
                matrix[(i, j)] = matrix[(j, i)];
            }
        }
        (matrix, gradient)
    }
}
