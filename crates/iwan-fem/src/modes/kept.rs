//! Modes that an earlier run found, used instead of a search.

use super::linear::{Limit, Modes};
use crate::algebra::Pairs;
use crate::error::Error;
use crate::matrices::Assembled;
use crate::structure::{Kept, KeptModes};

impl Modes {
    /// These modes in the form in which they are kept.
    pub(crate) fn to_keep(&self) -> KeptModes {
        let values = (0..self.len()).map(|index| self.eigenvalue(index)).collect();
        let vectors = (0..self.len()).flat_map(|index| self.shape(index).iter().copied()).collect();
        KeptModes { values, vectors, zero: self.zero_modes() }
    }

    /// Modes from the form in which they were kept.
    pub(crate) fn of_kept(kept: &KeptModes, limit: Limit, unknowns: usize) -> Self {
        let pairs = Pairs { values: kept.values.clone(), vectors: kept.vectors.clone() };
        Self::found(limit, pairs, unknowns, kept.zero)
    }
}

impl Assembled {
    /// The modes that the structure holds from an earlier run, after a check that they belong to these matrices.
    ///
    /// # Errors
    /// [`Error::Analysis`] if they belong to other matrices or are damaged.
    pub(crate) fn kept(&self) -> Result<Option<&Kept>, Error> {
        let Some(kept) = self.structure().kept.as_deref() else { return Ok(None) };
        let refused = |finding: String| {
            let remedy = "write the reduced model again with `iwan modes STRUCTURE.toml --write-reduced N`";
            Error::Analysis { analysis: "the reduced model", finding, remedy }
        };
        if kept.fingerprint != self.fingerprint() {
            let finding = "stiffness or mass of its structure are not those it was made of: the mesh, a material, a matrix, or the \
                           K_T of a joint has changed";
            return Err(refused(finding.into()));
        }
        let n = self.unknowns();
        for (name, modes) in [
            ("stuck", &kept.stuck),
            ("slipping", &kept.slipping),
            ("basis", &kept.basis),
            ("attachments", &kept.attachments),
        ] {
            let (count, entries) = (modes.values.len(), modes.vectors.len());
            if count * n != entries || modes.zero > count {
                let finding = format!(
                    "`{name}` has {count} eigenvalues, {} zero modes and {entries} entries of vectors for {n} unknowns",
                    modes.zero
                );
                return Err(refused(finding));
            }
        }
        Ok(Some(kept))
    }
}
