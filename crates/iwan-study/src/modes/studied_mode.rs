//! A bending mode with its modal counterpart.

use super::bending_mode::BendingMode;
use super::counterpart::Counterpart;
use crate::beam::BeamUnderBlows;
use crate::error::Error;
use crate::printed::TABLE_2;

/// A bending mode and, where it has a joint, its modal Iwan model.
#[derive(Debug, Clone)]
pub struct StudiedMode {
    /// The results of the truth model for the mode.
    pub mode: BendingMode,
    /// The modal model; none for a mode without joint.
    pub counterpart: Option<Counterpart>,
}

impl StudiedMode {
    /// Evaluates bending mode `index` of a configuration. Eq. 14 is solved with three slip forces: the fitted one, that of the static plateau, and
    /// the printed one.
    ///
    /// # Errors
    /// As [`BendingMode::new`] and [`Counterpart::new`].
    pub fn new(truth: &BeamUnderBlows, index: usize) -> Result<Self, Error> {
        let mut mode = BendingMode::new(truth, index)?;
        if !mode.has_joint() {
            return Ok(Self { mode, counterpart: None });
        }
        let counterpart = Counterpart::new(truth, &mode)?;
        let plateau = mode.static_fit.map(|fit| fit.parameters.f_s);
        let slip_forces = [Some(counterpart.parameters.f_s), plateau, Some(TABLE_2[index].f_s)];
        slip_forces.into_iter().flatten().for_each(|f_s| mode.try_eq_14(f_s));
        Ok(Self { mode, counterpart: Some(counterpart) })
    }
}
