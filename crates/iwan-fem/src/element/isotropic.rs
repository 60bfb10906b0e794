//! Stiffness from the gradients of shape functions, for isotropic elasticity.
//!
//! With H = ∫ ∇N_i ∇N_jᵀ the stiffness between functions i and j is K_ij = λ H + μ Hᵀ + μ tr(H) I. This takes nine products per integration
//! point and pair, whereas the product of strain matrices takes a hundred.

use super::material::Material;

/// Sums of ∇N_i ∇N_jᵀ over integration points, for the pairs i <= j of n functions.
#[derive(Debug, Clone)]
pub(crate) struct GradientProducts<const N: usize> {
    /// Row i holds the pairs (i, j) at j; those below the diagonal stay zero.
    sums: Vec<[[[f64; 3]; 3]; N]>,
}

impl<const N: usize> GradientProducts<N> {
    pub(crate) fn new() -> Self {
        Self { sums: vec![[[[0.0; 3]; 3]; N]; N] }
    }

    /// Adds one integration point with its weight times the Jacobian determinant.
    pub(crate) fn add(&mut self, gradients: &[[f64; 3]; N], weight: f64) {
        for (i, row) in self.sums.iter_mut().enumerate() {
            let g = gradients[i].map(|x| weight * x);
            for (sum, h) in row.iter_mut().zip(gradients).skip(i) {
                for a in 0..3 {
                    for b in 0..3 {
                        sum[a][b] += g[a] * h[b];
                    }
                }
            }
        }
    }

    /// Writes the 3N x 3N stiffness row by row.
    pub(crate) fn stiffness(&self, material: &Material, out: &mut [f64]) {
        let (lame, shear) = (material.lame(), material.shear_modulus());
        for i in 0..N {
            for j in i..N {
                let h = &self.sums[i][j];
                let trace = shear * (h[0][0] + h[1][1] + h[2][2]);
                for a in 0..3 {
                    for b in 0..3 {
                        let k = lame * h[a][b] + shear * h[b][a] + if a == b { trace } else { 0.0 };
                        out[(3 * i + a) * 3 * N + 3 * j + b] = k;
                        out[(3 * j + b) * 3 * N + 3 * i + a] = k;
                    }
                }
            }
        }
    }
}

/// Adds ρ N_i N_j times the weight of one integration point to the n x n mass.
pub(crate) fn add_mass<const N: usize>(values: &[f64; N], weight: f64, mass: &mut [f64]) {
    for (row, value) in mass.chunks_exact_mut(N).zip(values) {
        let scaled = weight * value;
        row.iter_mut().zip(values).for_each(|(m, v)| *m += scaled * v);
    }
}
