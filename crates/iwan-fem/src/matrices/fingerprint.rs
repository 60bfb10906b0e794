//! A fingerprint of the matrices, to recognise results that were computed from the same ones.

use super::assembly::Assembled;
use crate::algebra::Symmetric;

/// FNV-1a with 64 bits (G. Fowler, L. C. Noll, K.-P. Vo), word by word. It detects a changed model, but does not protect against deliberate
/// forgery.
struct Fnv(u64);

impl Fnv {
    fn word(&mut self, word: u64) {
        self.0 = (self.0 ^ word).wrapping_mul(0x0000_0100_0000_01b3);
    }

    fn matrix(&mut self, matrix: &Symmetric) {
        for (i, j, value) in matrix.lower() {
            self.word((i as u64) << 32 | j as u64);
            self.word(value.to_bits());
        }
    }
}

impl Assembled {
    /// A number that changes with any entry of the mass, of the damping, or of the stiffness with all joints stuck or slipping, and with
    /// the order of the unknowns. It is the same on all machines.
    ///
    /// ```
    /// use iwan_fem::{mesh::beam::Configuration, paper};
    /// let [a, b] = [Configuration::A, Configuration::B].map(|c| paper::structure(c, 1).and_then(|s| s.assemble()));
    /// let (a, b) = (a?.fingerprint(), b?.fingerprint());
    /// assert_ne!(a, b);
    /// # Ok::<(), iwan_fem::Error>(())
    /// ```
    #[must_use]
    pub fn fingerprint(&self) -> u64 {
        let mut hash = Fnv(0xcbf2_9ce4_8422_2325);
        hash.matrix(self.slipping_stiffness());
        hash.matrix(self.mass());
        self.damping().into_iter().for_each(|damping| hash.matrix(damping));
        for slip in self.slips() {
            hash.word(slip.unknown as u64);
            hash.word(slip.law.as_ref().map_or(0.0, |law| law.initial_stiffness()).to_bits());
        }
        hash.0
    }
}
