//! The reduced model in the form for steady vibration: coordinates that are coupled by the joints only.

use crate::error::{Error, check};
use crate::structure::Law;
use crate::transient::Reduced;

/// A coordinate of the reduced model, mass-normalised, with all joints stuck.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteadyCoordinate {
    /// Circular frequency, rad/s; 0 for rigid motions.
    pub omega: f64,
    /// Viscous damping ratio.
    pub damping_ratio: f64,
    /// Modal force of the coordinate per unit of the load.
    pub at_force: f64,
    /// Output per unit of the coordinate.
    pub at_output: f64,
}

/// A slip with a law, in terms of the coordinates.
#[derive(Clone)]
pub struct SteadySlip {
    /// Name of the slip.
    pub name: String,
    /// The law of the slip.
    pub law: Law,
    /// Slip per unit of each coordinate.
    pub participation: Vec<f64>,
}

impl std::fmt::Debug for SteadySlip {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SteadySlip")
            .field("name", &self.name)
            .field("participation", &self.participation)
            .finish_non_exhaustive()
    }
}

/// The coordinates of a reduced model and the slips that couple them. The coordinates are modes, followed by attachment vectors, which
/// contain the static flexibility of all modes left out.
#[derive(Debug, Clone)]
pub struct SteadyModel {
    /// The coordinates, in the order of the reduced model.
    pub coordinates: Vec<SteadyCoordinate>,
    /// The slips with a law; slips without a law slide freely and couple nothing.
    pub slips: Vec<SteadySlip>,
}

impl Reduced<'_> {
    /// The model for steady vibration under a force along `load`, observed along `output`; both have one entry per unknown
    /// ([`Assembled::load`](crate::Assembled::load), [`Output`](crate::Output)).
    ///
    /// # Errors
    /// [`Error::Analysis`] if load or output belong to another structure; [`Error::OutOfRange`] for damping at or above critical.
    ///
    /// ```
    /// use iwan_fem::{Basis, mesh::beam::Configuration, paper};
    /// let assembled = paper::structure(Configuration::A, 1)?.assemble()?;
    /// let reduced = assembled.reduce(12, Basis::default())?.with_damping(|_| 1e-3)?;
    /// let nothing = vec![0.0; assembled.unknowns()];
    /// let model = reduced.steady_model(&nothing, &nothing)?;
    /// assert_eq!(model.coordinates.len(), reduced.coordinates());
    /// assert_eq!(model.coordinates[0].omega, 0.0); // a free beam: rigid motions first
    /// assert!((model.coordinates[6].damping_ratio - 1e-3).abs() < 1e-15);
    /// # Ok::<(), iwan_fem::Error>(())
    /// ```
    pub fn steady_model(&self, load: &[f64], output: &[f64]) -> Result<SteadyModel, Error> {
        let unknowns = self.assembled().unknowns();
        if let Some(found) = [load.len(), output.len()].into_iter().find(|found| *found != unknowns) {
            return Err(Error::Analysis {
                analysis: "steady vibration",
                finding: format!(
                    "a load or output has {found} entries, the structure has {unknowns} unknowns"
                ),
                remedy: "make them with the same assembled structure",
            });
        }
        let (load, output) = (self.project(load), self.project(output));
        let mut coordinates = Vec::with_capacity(self.coordinates());
        for (k, (&at_force, &at_output)) in load.iter().zip(&output).enumerate() {
            let omega = self.eigenvalues()[k].max(0.0).sqrt();
            let damping_ratio = if omega > 0.0 { 0.5 * self.damping()[k] / omega } else { 0.0 };
            let allowed = "must satisfy 0 <= ratio < 1";
            check("modal damping ratio", damping_ratio, (0.0..1.0).contains(&damping_ratio), allowed)?;
            coordinates.push(SteadyCoordinate { omega, damping_ratio, at_force, at_output });
        }
        let rigid = |k: usize| coordinates[k].omega == 0.0;
        // A rigid motion causes no slip, so the rounding errors in its entries are set to 0.
        let part = |k: usize, unknown: usize| if rigid(k) { 0.0 } else { self.column(k)[unknown] };
        let slips = self.assembled().slips().iter().filter_map(|slip| {
            let participation = (0..self.coordinates()).map(|k| part(k, slip.unknown)).collect();
            Some(SteadySlip { name: slip.name.clone(), law: slip.law.clone()?, participation })
        });
        let slips = slips.collect();
        Ok(SteadyModel { coordinates, slips })
    }
}
