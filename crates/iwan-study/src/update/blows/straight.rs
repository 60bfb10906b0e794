//! A linearised model about one point: it gives the intervals of unknowns where each residual takes a whole transient to compute.

use iwan_ident::Error;
use iwan_ident::estimate::Model;

/// Residuals at a point and their derivatives there. Walks along profile likelihoods would need some hundred derivatives of all blows; with this
/// model they need none, and give the linearised profile. A wide interval may in truth be skewed.
#[derive(Debug)]
pub(super) struct Straight {
    at: Vec<f64>,
    residuals: Vec<f64>,
    slopes: Vec<Vec<f64>>,
    bounds: Vec<(f64, f64)>,
}

impl Straight {
    /// Linearises a model at `x`.
    pub(super) fn at(model: &impl Model, x: &[f64]) -> Result<Self, Error> {
        let count = model.count();
        let (mut residuals, mut slopes) = (vec![0.0; count], vec![vec![0.0; count]; x.len()]);
        if !model.evaluate(x, &mut residuals, Some(&mut slopes)) {
            return Err(Error::Refused {
                finding: "the best values have no derivatives".into(),
                remedy: "leave out the hardest blow",
            });
        }
        Ok(Self { at: x.to_vec(), residuals, slopes, bounds: model.bounds().to_vec() })
    }
}

impl Model for Straight {
    fn bounds(&self) -> &[(f64, f64)] {
        &self.bounds
    }

    fn count(&self) -> usize {
        self.residuals.len()
    }

    fn evaluate(&self, x: &[f64], residuals: &mut [f64], derivatives: Option<&mut [Vec<f64>]>) -> bool {
        residuals.copy_from_slice(&self.residuals);
        for ((x, at), slopes) in x.iter().zip(&self.at).zip(&self.slopes) {
            residuals.iter_mut().zip(slopes).for_each(|(r, slope)| *r += slope * (x - at));
        }
        if let Some(derivatives) = derivatives {
            let asked_for = derivatives.iter_mut().zip(&self.slopes).filter(|(out, _)| !out.is_empty());
            asked_for.for_each(|(out, slopes)| out.copy_from_slice(slopes));
        }
        true
    }
}
