//! Integration points and the map from the reference cube to the element.

use crate::error::Error;

/// Finding of an element whose Jacobian determinant is not positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NoVolume {
    determinant: f64,
    point: usize,
}

impl NoVolume {
    /// The error that names the element by its number.
    pub(crate) fn in_element(self, label: u64) -> Error {
        Error::Element { label, determinant: self.determinant, point: self.point }
    }
}

/// Abscissae and weights of Gauss-Legendre quadrature with two points.
pub(crate) const TWO: [(f64, f64); 2] = [(-0.577_350_269_189_625_8, 1.0), (0.577_350_269_189_625_8, 1.0)];
/// The same with three points.
pub(crate) const THREE: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// Points (ξ, η, ζ) and weights of the product of a rule in three directions.
pub(crate) fn points(rule: &[(f64, f64)]) -> impl Iterator<Item = ([f64; 3], f64)> + '_ {
    rule.iter().flat_map(move |&(z, c)| {
        rule.iter().flat_map(move |&(y, b)| rule.iter().map(move |&(x, a)| ([x, y, z], a * b * c)))
    })
}

/// The inverse of J_ab = ∂x_b/∂ξ_a, and its determinant.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Jacobian {
    inverse: [[f64; 3]; 3],
    pub(crate) determinant: f64,
}

impl Jacobian {
    /// The Jacobian from the derivatives ∂N_i/∂ξ_a of the shape functions at integration point number `point`.
    pub(crate) fn new(
        derivatives: &[[f64; 3]],
        positions: &[[f64; 3]],
        point: usize,
    ) -> Result<Self, NoVolume> {
        let mut j = [[0.0; 3]; 3];
        for (d, x) in derivatives.iter().zip(positions) {
            for a in 0..3 {
                for b in 0..3 {
                    j[a][b] += d[a] * x[b];
                }
            }
        }
        let cofactor = |a: usize, b: usize| {
            let (p, q, r, s) = ((a + 1) % 3, (a + 2) % 3, (b + 1) % 3, (b + 2) % 3);
            j[p][r] * j[q][s] - j[p][s] * j[q][r]
        };
        let determinant = j[0][0] * cofactor(0, 0) + j[0][1] * cofactor(0, 1) + j[0][2] * cofactor(0, 2);
        let size: f64 = j.iter().map(|row| row.iter().map(|x| x * x).sum::<f64>().sqrt()).product();
        // In a brick the determinant equals the product of the lengths of the Jacobian's rows. A determinant as small as this beside that
        // product is rounding, and the element is flat. Rounding leaves 1e-16, and the mesh check already refuses 1e-6; the limit lies
        // between the two.
        if determinant.is_nan() || determinant <= 1e-12 * size {
            return Err(NoVolume { determinant, point });
        }
        let inverse = std::array::from_fn(|b| std::array::from_fn(|a| cofactor(a, b) / determinant));
        Ok(Self { inverse, determinant })
    }

    /// ∂N/∂x_b = Σ_a (J⁻¹)_ba ∂N/∂ξ_a.
    pub(crate) fn gradient(&self, d: [f64; 3]) -> [f64; 3] {
        self.inverse.map(|row| row[0] * d[0] + row[1] * d[1] + row[2] * d[2])
    }
}
