//! Residues for given poles by linear least squares, and the products that tell how the poles should move.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rayon::prelude::*;

use super::band::Band;
use super::columns::Columns;
use crate::error::Error;
use crate::number::{Complex, complex};

/// Number of responses whose products are computed together: enough for products of matrices to pay, and few enough for fifty responses to be work for
/// several threads.
const AT_ONCE: usize = 16;

/// The sum of squares that is left of a response is a difference of two sums, which costs digits. Below this fraction of the response it is taken from the
/// residuals themselves, which costs twice the time. Ten digits are left there, and a search needs the first five.
const BY_PRODUCTS: f64 = 1e-6;

/// Least squares for given poles: residues, and the products that a search for better poles needs.
pub(crate) struct Linear {
    /// Number of poles.
    pub(crate) poles: usize,
    /// Coefficients of all linear columns in their original scale: one row for each of these columns, one column for each response.
    pub(crate) coefficients: DMatrix<f64>,
    /// Sum of squares that the fit leaves of each response.
    pub(crate) left: Vec<f64>,
    /// Inverse of the normal matrix of the linear columns.
    pub(crate) inverse: DMatrix<f64>,
    /// Products of the derivatives W⊥ with each other and with the residuals r; W⊥ is W without its part in the space of the linear columns Φ. None where no derivatives were
    /// asked for.
    pub(super) slopes: Option<Slopes>,
    columns: Columns,
}

/// Products of the derivative columns W, two for each pole.
pub(super) struct Slopes {
    /// W⊥ᵀ W⊥.
    pub(super) among: DMatrix<f64>,
    /// W⊥ᵀ r, one column for each response.
    pub(super) with_left: DMatrix<f64>,
    /// Φ⁺ W: how the coefficients follow when poles move.
    pub(super) follow: DMatrix<f64>,
}

impl Linear {
    /// Least squares for `poles` in a band.
    pub(crate) fn new(band: &Band, poles: &[Complex], slopes: bool) -> Result<Self, Error> {
        let columns = Columns::new(band, poles, slopes)?;
        let n = columns.linear();
        let x = &columns.matrix;
        let m = x.ncols() - n;
        // Products of matrices are a few times faster than those of columns.
        let turned = x.transpose();
        let (gram, products) = rayon::join(|| &turned * x, || with_responses(band, &turned));
        let scale: Vec<f64> = (0..n).map(|j| gram[(j, j)].sqrt().max(f64::MIN_POSITIVE).recip()).collect();
        let scaled = DMatrix::from_fn(n, n, |i, j| gram[(i, j)] * scale[i] * scale[j]);
        let factor = factor(scaled, poles)?;
        let solve = |mut b: DMatrix<f64>| {
            scale_rows(&mut b, &scale);
            factor.solve_mut(&mut b);
            scale_rows(&mut b, &scale);
            b
        };
        let with_sought = products.rows(0, n).into_owned();
        let coefficients = solve(with_sought.clone());
        let left_of = |c: usize| band.squares[c] - coefficients.column(c).dot(&with_sought.column(c));
        let mut left: Vec<f64> = (0..products.ncols()).map(left_of).collect();
        let cross = gram.view((0, n), (n, m)).into_owned();
        let mut with_left = products.rows(n, m) - cross.transpose() * &coefficients;
        if left.iter().zip(&band.squares).any(|(left, all)| *left < BY_PRODUCTS * all) {
            let rest = &band.values - x.columns(0, n) * &coefficients;
            left = rest.column_iter().map(|c| c.norm_squared()).collect();
            with_left = turned.rows(n, m) * rest;
        }
        let slopes = slopes.then(|| {
            let follow = solve(cross.clone());
            let among = gram.view((n, n), (m, m)) - cross.transpose() * &follow;
            Slopes { among, with_left, follow }
        });
        let inverse = solve(DMatrix::identity(n, n));
        Ok(Self { poles: poles.len(), coefficients, left, inverse, slopes, columns })
    }

    /// Residuals of the responses, arranged and weighted as in the band.
    pub(crate) fn rest(&self, band: &Band) -> DMatrix<f64> {
        let sought = self.columns.matrix.columns(0, self.columns.linear());
        let of_some = |some: &Vec<usize>| {
            let (from, count) = (some[0], some.len());
            let rest = band.values.columns(from, count) - sought * self.coefficients.columns(from, count);
            rest.data.into()
        };
        let parts: Vec<Vec<f64>> = groups(band).par_iter().map(of_some).collect();
        DMatrix::from_vec(band.values.nrows(), band.values.ncols(), parts.concat())
    }

    /// Residue of a pole in a response.
    pub(crate) fn residue(&self, pole: usize, response: usize) -> Complex {
        complex(self.coefficients[(2 * pole, response)], self.coefficients[(2 * pole + 1, response)])
    }
}

impl Linear {
    /// Increase of a response's remaining sum of squares if one pole were left out and all others kept: cᵀ P⁻¹ c with its two coefficients c and
    /// their part P of the normal matrix's inverse.
    pub(crate) fn loss(&self, pole: usize, response: usize) -> f64 {
        let i = 2 * pole;
        let [a, b, d] = [self.inverse[(i, i)], self.inverse[(i, i + 1)], self.inverse[(i + 1, i + 1)]];
        let [x, y] = [self.coefficients[(i, response)], self.coefficients[(i + 1, response)]];
        (d * x * x - 2.0 * b * x * y + a * y * y) / (a * d - b * b)
    }
}

/// Indices of the responses in groups of [`AT_ONCE`].
fn groups(band: &Band) -> Vec<Vec<usize>> {
    let all: Vec<usize> = (0..band.values.ncols()).collect();
    all.chunks(AT_ONCE).map(<[usize]>::to_vec).collect()
}

/// Products of the rows of `turned` with all responses.
pub(super) fn with_responses(band: &Band, turned: &DMatrix<f64>) -> DMatrix<f64> {
    let of_some =
        |some: &Vec<usize>| -> Vec<f64> { (turned * band.values.columns(some[0], some.len())).data.into() };
    let parts: Vec<Vec<f64>> = groups(band).par_iter().map(of_some).collect();
    DMatrix::from_vec(turned.nrows(), band.values.ncols(), parts.concat())
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
    /// Normal matrix and gradient for real and imaginary parts of the poles in turn; responses have the weights `precision`.
    pub(super) fn normal(&self, linear: &Linear, precision: &[f64]) -> (DMatrix<f64>, DVector<f64>) {
        let n = linear.poles;
        // Factors of the two derivative columns of a pole: (a, b) for its real part, (-b, a) for its imaginary part.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::{Channel, Freedom, Motion};
    use crate::responses::free_responses;

    /// Products and residuals give the same, for close poles, and for remainders on either side of the limit.
    #[test]
    fn products_tell_what_residuals_do() {
        for (noise, below) in [(1e-1, false), (1e-2, false), (1e-4, true)] {
            let value = |n: usize, a: f64| {
                let t = n as f64;
                (-1e-3 * t).exp() * (0.3 * t).cos()
                    + a * (-2e-3 * t).exp() * (0.303 * t).sin()
                    + noise * (1.7 * t * t).sin()
            };
            let channel = |name: &str, a: f64| Channel {
                name: name.into(),
                freedom: Freedom::point(name),
                samples: (0..2048).map(|n| value(n, a)).collect(),
            };
            let decay = vec![channel("a", 0.3), channel("b", -0.7)];
            let responses = free_responses(&[decay], 1e-3, Motion::Acceleration).unwrap();
            let band = Band::new(&responses, (20.0, 120.0)).unwrap();
            let poles = [complex(-1.0, 300.0), complex(-2.0, 303.0), complex(-5.0, 306.0)];
            let found = Linear::new(&band, &poles, true).unwrap();
            let slopes = found.slopes.as_ref().unwrap();
            let columns = Columns::new(&band, &poles, true).unwrap();
            let n = columns.linear();
            let sought = columns.matrix.columns(0, n).into_owned();
            // By orthogonal triangles, which square nothing.
            let q = sought.qr().q();
            let rest = &band.values - &q * (q.transpose() * &band.values);
            let own = columns.matrix.columns(n, 2 * poles.len());
            let with_left = own.transpose() * &rest;
            for (c, left) in found.left.iter().enumerate() {
                let exact = rest.column(c).norm_squared();
                assert_eq!(exact < BY_PRODUCTS * band.squares[c], below, "{noise}: {exact}");
                assert!((left / exact - 1.0).abs() < 1e-8, "{noise} {c}: {left} {exact}");
                for j in 0..2 * poles.len() {
                    let off = slopes.with_left[(j, c)] - with_left[(j, c)];
                    let size = own.column(j).norm() * exact.sqrt();
                    assert!(off.abs() < 1e-8 * size, "{noise} {c} {j}: {off} of {size}");
                }
            }
            assert!((found.rest(&band) - &rest).norm() < 1e-8 * rest.norm());
        }
    }
}
