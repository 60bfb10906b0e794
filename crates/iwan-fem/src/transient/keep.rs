//! Modes and a reduced basis, kept for later runs.

use super::reduction::Basis;
use crate::error::Error;
use crate::modes::NamedModes;
use crate::structure::{Kept, KeptModes};
use iwan_core::Progress;

impl NamedModes {
    /// These modes and a reduced basis of `modes` stuck modes with the attachment vectors of the slips: all results for which a later run
    /// of the same structure would need factorisations.
    ///
    /// # Errors
    /// [`Error::Modes`] for no modes, or more than there are unknowns; the errors of [`Assembled::reduce_observed`](crate::Assembled::reduce_observed).
    ///
    /// ```
    /// use std::sync::Arc;
    /// use iwan_fem::{NamedModes, mesh::beam::Configuration, paper};
    /// let mut structure = paper::structure(Configuration::A, 1)?;
    /// let first = NamedModes::new(&structure, 4)?;
    /// structure.kept = Some(Arc::new(first.keep(20, iwan_core::progress::UNWATCHED)?));
    /// let again = NamedModes::new(&structure, 4)?; // no factorisation
    /// assert_eq!((&again.stuck, &again.slipping), (&first.stuck, &first.slipping));
    /// # Ok::<(), iwan_fem::Error>(())
    /// ```
    pub fn keep(&self, modes: usize, progress: Progress<'_>) -> Result<Kept, Error> {
        let modes = self.assembled.check_modes("modes", modes)?;
        let reduced = self.assembled.reduce_observed(modes, Basis::default(), progress)?;
        let behind = reduced.modes().len()..reduced.coordinates();
        let attachments = KeptModes {
            values: reduced.eigenvalues()[behind.clone()].to_vec(),
            vectors: behind.flat_map(|k| reduced.column(k).iter().copied()).collect(),
            zero: 0,
        };
        Ok(Kept {
            fingerprint: self.assembled.fingerprint(),
            named: self.elastic.len(),
            stuck: self.stuck.to_keep(),
            slipping: self.slipping.to_keep(),
            basis: reduced.modes().to_keep(),
            attachments,
        })
    }
}
