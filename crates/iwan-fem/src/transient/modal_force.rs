//! The force of the joints on one mode.

use super::response::{History, StructureResponse};
use crate::matrices::Assembled;
use crate::modes::Modes;

impl Assembled {
    /// Modal joint force of stuck mode `index` in a response: F_J = K_T q + Σ φ_s (F_s - k_s s). It is the force by which the mode's
    /// equation differs from that of the slipping structure, q'' + (ω0² - K_T) q + F_J = φᵀ f. With all joints stuck it is K_T q (Deaner et
    /// al., Eq. 5).
    ///
    /// `modal` is the history of the mode's coordinate in the same response, `k_t` the mode's joint stiffness in 1/s².
    ///
    /// # Panics
    /// When `modes` or the response belong to another structure or there is no mode `index`.
    #[must_use]
    pub fn modal_joint_force(
        &self,
        response: &StructureResponse,
        modal: &History,
        (modes, index): (&Modes, usize),
        k_t: f64,
    ) -> Vec<f64> {
        let mut force: Vec<f64> = modal.displacement.iter().map(|q| k_t * q).collect();
        let shape = modes.shape(index);
        for (slip, history) in self.slips().iter().zip(&response.slips) {
            let share = shape[slip.unknown];
            let stuck = slip.law.as_ref().map_or(0.0, |law| law.initial_stiffness());
            for ((sum, f), s) in force.iter_mut().zip(&history.force).zip(&history.slip) {
                *sum += share * (f - stuck * s);
            }
        }
        force
    }
}
