//! The effect of the joints on a mode: the stuck mode, its slipping counterpart, and the stiffness between them.

use super::linear::Modes;
use crate::algebra::dot;
use crate::matrices::Assembled;

/// A stuck mode and the slipping mode that resembles it most.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointMode {
    /// Index of the stuck mode.
    pub stuck: usize,
    /// Index of the slipping mode.
    pub slipping: usize,
    /// Modal assurance criterion of the two modes; 1 means the same shape.
    pub mac: f64,
    /// Modal joint stiffness K_T = ω0² - ω∞², 1/s²; negative if slipping does nothing but free inertia.
    pub k_t: f64,
}

impl Assembled {
    /// Modal assurance criterion of two mode shapes (R. J. Allemang and D. L. Brown, IMAC 1982); 1 means the same shape.
    ///
    /// # Panics
    /// When a mode belongs to another structure or does not exist.
    #[must_use]
    pub fn mac(&self, (first, i): (&Modes, usize), (second, j): (&Modes, usize)) -> f64 {
        let (a, b) = (self.displacements(first.shape(i)), self.displacements(second.shape(j)));
        dot(&a, &b).powi(2) / (dot(&a, &a) * dot(&b, &b))
    }

    /// For each elastic stuck mode the slipping mode with the highest modal assurance criterion, and K_T = ω0² - ω∞².
    ///
    /// # Panics
    /// When a mode belongs to another structure.
    #[must_use]
    pub fn joint_modes(&self, stuck: &Modes, slipping: &Modes) -> Vec<JointMode> {
        // With given matrices there may be few nodes with displacements, or none; then all unknowns are compared, weighted with the mass.
        let weighted = self.structure().given.is_some();
        let shapes = |modes: &Modes, mass: bool| -> Vec<Vec<f64>> {
            let shape = |i| match (weighted, mass) {
                (true, true) => self.mass().times(modes.shape(i)),
                (true, false) => modes.shape(i).to_vec(),
                _ => self.displacements(modes.shape(i)),
            };
            (0..modes.len()).map(shape).collect()
        };
        let (a, b) = (shapes(stuck, true), shapes(slipping, false));
        let mac = |i: usize, j: usize| {
            // The shapes are mass-normalised.
            let size = if weighted { 1.0 } else { dot(&a[i], &a[i]) * dot(&b[j], &b[j]) };
            dot(&a[i], &b[j]).powi(2) / size
        };
        let best = |i: usize| {
            let candidates = (slipping.zero_modes()..slipping.len()).map(|j| (j, mac(i, j)));
            let (j, mac) = candidates.max_by(|x, y| x.1.total_cmp(&y.1))?;
            Some(JointMode { stuck: i, slipping: j, mac, k_t: stuck.eigenvalue(i) - slipping.eigenvalue(j) })
        };
        (stuck.zero_modes()..stuck.len()).filter_map(best).collect()
    }
}
