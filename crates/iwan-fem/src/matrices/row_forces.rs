//! Forces on combinations of rows of given matrices, and outputs of such combinations.

use super::assembly::Assembled;
use crate::error::{Error, check};

impl Assembled {
    /// Forces on the unknowns that represent a unit force on Σ c x, a combination of rows of the given matrices (rows counted from 0). The
    /// same coefficients give Σ c x as an output.
    ///
    /// # Errors
    /// [`Error::Connection`] for a structure without given matrices, and for a row that does not exist; [`Error::OutOfRange`] for a
    /// coefficient that is not finite.
    ///
    /// ```
    /// use iwan_fem::{mesh::beam::Configuration, paper};
    /// let assembled = paper::structure(Configuration::A, 1)?.assemble()?;
    /// assert!(assembled.combination(&[(0, 1.0)]).is_err(), "its matrices come from elements");
    /// # Ok::<(), iwan_fem::Error>(())
    /// ```
    pub fn combination(&self, terms: &[(usize, f64)]) -> Result<Vec<f64>, Error> {
        let refused = |finding: String| Error::Connection {
            name: "a combination of rows".into(),
            finding,
            remedy: "name rows of the matrices that were given",
        };
        let Some(given) = &self.structure().given else {
            return Err(refused("the structure has elements, and no given matrices".into()));
        };
        let dofs = given.freedoms(self.structure().mesh.positions.len());
        let mut out = vec![0.0; self.unknowns()];
        for &(row, coefficient) in terms {
            check("coefficient", coefficient, true, "must be finite")?;
            let Some(&dof) = dofs.get(row) else {
                return Err(refused(format!("there is no row {} among {}", row + 1, dofs.len())));
            };
            self.transformation().add_force(dof, coefficient, &mut out);
        }
        Ok(out)
    }
}
