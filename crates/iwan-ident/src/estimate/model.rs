//! What a model has to provide to be estimated.

use nalgebra::DMatrix;

use crate::search::Problem;

/// A model as residuals that depend on unknowns, each residual over its standard deviation.
pub trait Model: Sync {
    /// Lower and upper bound of each unknown. Unknowns are of order one: logarithms and shares.
    fn bounds(&self) -> &[(f64, f64)];

    /// Number of residuals.
    fn count(&self) -> usize;

    /// Fills the residuals and, where they are asked for, their derivatives: `derivatives[unknown][residual]`. An unknown whose column is empty is held, and its
    /// derivatives are not asked for. False where the model does not exist at `x`.
    fn evaluate(&self, x: &[f64], residuals: &mut [f64], derivatives: Option<&mut [Vec<f64>]>) -> bool;
}

/// A model seen as a least-squares problem.
pub(crate) struct Squares<'a, M: Model + ?Sized>(pub(crate) &'a M);

impl<M: Model + ?Sized> Squares<'_, M> {
    /// Derivatives of the residuals with respect to the unknowns in `free`, one column for each; none where the model does not exist or they are not finite.
    pub(crate) fn derivatives_at(&self, x: &[f64], free: &[usize]) -> Option<DMatrix<f64>> {
        let (mut residuals, mut derivatives) = (vec![0.0; self.0.count()], vec![Vec::new(); x.len()]);
        for j in free {
            derivatives[*j] = vec![0.0; self.0.count()];
        }
        let known = self.0.evaluate(x, &mut residuals, Some(&mut derivatives));
        let finite = free.iter().all(|j| derivatives[*j].iter().all(|d| d.is_finite()));
        (known && finite)
            .then(|| DMatrix::from_fn(self.0.count(), free.len(), |i, k| derivatives[free[k]][i]))
    }
}

impl<M: Model + ?Sized> Problem for Squares<'_, M> {
    fn residuals(&mut self, x: &[f64], out: &mut [f64]) -> bool {
        self.0.evaluate(x, out, None)
    }

    fn derivatives(&mut self, x: &[f64], free: &[usize]) -> Option<DMatrix<f64>> {
        self.derivatives_at(x, free)
    }
}
