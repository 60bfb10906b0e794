//! Linear modes with all joints stuck or slipping.

use std::f64::consts::PI;

use crate::algebra::{Cholesky, Pairs, Problem, Symmetric};
use crate::error::Error;
use crate::matrices::Assembled;
use iwan_core::Progress;
use iwan_core::progress::UNWATCHED;

/// State of the joints in a linear vibration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Limit {
    /// All sliders stick: K_0 = K_∞ + K_T, the limit of small amplitudes.
    Stuck,
    /// All sliders slip: K_∞, the limit of large amplitudes.
    Slipping,
}

/// Mass-normalised modes in order of ascending frequency; zero modes come first.
#[derive(Debug, Clone, PartialEq)]
pub struct Modes {
    limit: Limit,
    pairs: Pairs,
    unknowns: usize,
    zero: usize,
}

/// The shift σ, as a part of the squared first axial frequency of a free bar as long as the diagonal of the structure. It lies near the
/// first elastic eigenvalue of a slender structure (1.3 times that of the paper's beam), because high eigenvalues lose a digit for each
/// decade by which they exceed it. A hundredth of this value costs nearly three digits of mode 400; with a hundred times, two bending modes
/// of a bar 1,000 times as long as thick count as zero modes.
const SHIFT: f64 = 1e-3;
/// The shift with which the first eigenvalue of given matrices is sought, as a part of the largest ratio of diagonal entries. That ratio is
/// near the highest eigenvalue. The first elastic eigenvalues of fine meshes lie 1e-6 to 1e-9 below it; those below the shift lose digits
/// in proportion, which does not matter in a first search.
const CRUDE: f64 = 1e-6;
/// Part of the crude shift below which an eigenvalue counts as rounding. Rounding leaves 1e-10 of the highest eigenvalue of K + σM, which
/// is at worst 1e-10 / 1e-6 of the shift; if some zero modes exceed the limit, a few more eigenvalues are computed.
const NOTHING: f64 = 1e-5;
/// Number of eigenvalues of the first search: six rigid motions and some more.
const FIRST_LOOK: usize = 12;
/// Part of the shift below which an eigenvalue belongs to a zero mode. Rounding leaves 1e-12 to 1e-9 of the shift. The first elastic
/// eigenvalue of a free bar of length L and thickness h is 4,200 (h/L)² of the shift, so a bar more than 6,000 times as long as thick would
/// lose its first mode.
const ZERO: f64 = 1e-4;

impl Assembled {
    /// The shift σ > 0, 1/s², for which K + σM is positive definite and well conditioned.
    ///
    /// # Errors
    /// The errors of [`modes`](Self::modes): for given matrices the shift takes a factorisation.
    pub(crate) fn shift(&self) -> Result<f64, Error> {
        if let Some(known) = self.known_shift().get() {
            return Ok(*known);
        }
        let shift = if self.structure().given.is_some() {
            self.shift_from_matrices()?
        } else {
            self.shift_of_a_bar()
        };
        Ok(*self.known_shift().get_or_init(|| shift))
    }

    /// The first eigenvalue above zero with all joints stuck, found with a shift from the diagonals.
    fn shift_from_matrices(&self) -> Result<f64, Error> {
        let (stiffness, analysis) = (self.stiffness(Limit::Stuck), self.analysis()?);
        let ratio = |j: usize| stiffness.diagonal_entry(j) / self.mass().diagonal_entry(j);
        let highest = (0..self.unknowns()).map(ratio).filter(|r| r.is_finite()).fold(0.0, f64::max);
        if highest <= 0.0 {
            let finding = "no unknown has both stiffness and mass".into();
            let remedy = "check that the stiffness and the mass are of one model and not exchanged";
            return Err(Error::Analysis { analysis: "modes", finding, remedy });
        }
        let crude = CRUDE * highest;
        let problem = Problem { stiffness: &stiffness, mass: self.mass(), shift: crude, analysis };
        let factor = problem.factor()?;
        let mut count = FIRST_LOOK.min(self.unknowns());
        loop {
            let pairs = problem.lowest(count, &factor, UNWATCHED)?;
            let elastic = pairs.values.iter().copied().find(|value| *value > NOTHING * crude);
            match elastic {
                Some(value) => return Ok(value),
                None if count == self.unknowns() => return Ok(crude),
                None => count = (2 * count).min(self.unknowns()),
            }
        }
    }

    /// The shift from the speed of sound and the size of the structure.
    fn shift_of_a_bar(&self) -> f64 {
        let structure = self.structure();
        let speed = structure
            .materials
            .iter()
            .map(|(_, m)| m)
            .chain([&structure.material])
            .map(|m| m.young() / m.density())
            .fold(0.0, f64::max);
        let extent = |axis: usize| {
            let range = structure.mesh.positions.iter().map(|p| p[axis]);
            range.clone().fold(f64::NEG_INFINITY, f64::max) - range.fold(f64::INFINITY, f64::min)
        };
        let square: f64 = (0..3).map(|axis| extent(axis).powi(2)).sum();
        SHIFT * PI * PI * speed / square
    }

    /// Stiffness in one of the two limits.
    #[must_use]
    pub fn stiffness(&self, limit: Limit) -> Symmetric {
        match limit {
            Limit::Stuck => self.stuck_stiffness(),
            Limit::Slipping => self.slipping_stiffness().clone(),
        }
    }

    /// The lowest `count` modes, including zero modes. No mode is missed, and repeated frequencies appear as often as they occur.
    ///
    /// # Errors
    /// [`Error::Analysis`] for a count out of range, or when a factorisation fails its probe.
    ///
    /// ```
    /// use iwan_fem::{Limit, mesh::beam::Configuration, paper};
    /// let modes = paper::structure(Configuration::A, 1)?.assemble()?.modes(Limit::Stuck, 7)?;
    /// assert_eq!(modes.zero_modes(), 6);
    /// assert!((modes.frequency(6) - 132.3509).abs() < 1e-3); // first bending mode, Hz
    /// # Ok::<(), iwan_fem::Error>(())
    /// ```
    pub fn modes(&self, limit: Limit, count: usize) -> Result<Modes, Error> {
        self.modes_observed(limit, count, UNWATCHED)
    }

    /// [`modes`](Self::modes) with a progress report, which estimates the usual course of the search and whose listener may stop it. A
    /// factorisation is not interrupted.
    ///
    /// # Errors
    /// The errors of [`modes`](Self::modes), and [`Error::Interrupted`].
    pub fn modes_observed(&self, limit: Limit, count: usize, progress: Progress<'_>) -> Result<Modes, Error> {
        self.modes_and_factor(limit, count, progress).map(|(modes, _)| modes)
    }

    /// The Cholesky factor of K + σM.
    pub(crate) fn shifted_factor(&self, limit: Limit) -> Result<Cholesky, Error> {
        let (stiffness, analysis) = (self.stiffness(limit), self.analysis()?);
        Problem { stiffness: &stiffness, mass: self.mass(), shift: self.shift()?, analysis }.factor()
    }

    /// The modes and the factor of K + σM that led to them.
    pub(crate) fn modes_and_factor(
        &self,
        limit: Limit,
        count: usize,
        progress: Progress<'_>,
    ) -> Result<(Modes, Cholesky), Error> {
        let (stiffness, analysis) = (self.stiffness(limit), self.analysis()?);
        let shift = self.shift()?;
        let problem = Problem { stiffness: &stiffness, mass: self.mass(), shift, analysis };
        let factor = problem.factor()?;
        let pairs = problem.lowest(count, &factor, progress)?;
        let zero = pairs.values.iter().filter(|value| **value < ZERO * shift).count();
        Ok((Modes { limit, pairs, unknowns: self.unknowns(), zero }, factor))
    }
}

impl Modes {
    /// Modes from their parts.
    pub(super) fn found(limit: Limit, pairs: Pairs, unknowns: usize, zero: usize) -> Self {
        Self { limit, pairs, unknowns, zero }
    }

    /// The same modes under the name of the other limit, for a structure without slips, where both limits are the same.
    pub(super) fn called(self, limit: Limit) -> Self {
        Self { limit, ..self }
    }

    /// Number of modes.
    #[must_use]
    pub fn len(&self) -> usize {
        self.pairs.values.len()
    }

    /// Never true: there is at least one mode.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether the joints stick or slip.
    #[must_use]
    pub fn limit(&self) -> Limit {
        self.limit
    }

    /// Number of zero modes: rigid motions, and parts that slide without stiffness.
    #[must_use]
    pub fn zero_modes(&self) -> usize {
        self.zero
    }

    /// ω² of mode `index`, 1/s²; for zero modes it is a rounding error.
    ///
    /// # Panics
    /// When there is no such mode; so do the other accessors.
    #[must_use]
    pub fn eigenvalue(&self, index: usize) -> f64 {
        self.pairs.values[index]
    }

    /// Frequency of mode `index`, Hz; 0 for zero modes.
    #[must_use]
    pub fn frequency(&self, index: usize) -> f64 {
        if index < self.zero { 0.0 } else { self.eigenvalue(index).sqrt() / (2.0 * PI) }
    }

    /// All frequencies, Hz, ascending.
    #[must_use]
    pub fn frequencies(&self) -> Vec<f64> {
        (0..self.len()).map(|i| self.frequency(i)).collect()
    }

    /// Mass-normalised shape of mode `index` in the unknowns.
    #[must_use]
    pub fn shape(&self, index: usize) -> &[f64] {
        &self.pairs.vectors[index * self.unknowns..(index + 1) * self.unknowns]
    }
}
