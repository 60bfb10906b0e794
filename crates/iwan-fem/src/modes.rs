//! Linear modes with all joints stuck or slipping, what they look like, and what joints do to them.

use std::f64::consts::PI;
use std::ops::ControlFlow;

use faer::Mat;

use crate::assembly::Assembled;
use crate::dense::symmetric_eigen;
use crate::eigen::{Pairs, Problem};
use crate::error::Error;
use crate::factor::Cholesky;
use crate::sparse::{Symmetric, dot};
use crate::transient::Progress;

/// What the joints do while a structure vibrates linearly.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Contact {
    /// All sliders stick: K_0 = K_∞ + K_T, the limit of small amplitudes.
    Stuck,
    /// All sliders slip: K_∞, the limit of large amplitudes.
    Slipping,
}

/// Kind of motion in a mode of a slender or plate-like structure, relative to the principal axes of its nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Class {
    /// No elastic energy.
    Zero,
    /// Cross-sections move along the shortest axis.
    Bending,
    /// Cross-sections move along the middle axis.
    Lateral,
    /// Cross-sections turn about the longest axis.
    Torsion,
    /// Cross-sections move along the longest axis.
    Axial,
    /// None of these makes up half of the motion.
    Other,
}

impl Class {
    /// The kind of motion in a word.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Zero => "zero",
            Self::Bending => "bending",
            Self::Lateral => "lateral",
            Self::Torsion => "torsion",
            Self::Axial => "axial",
            Self::Other => "other",
        }
    }
}

/// Mass-normalised modes, by ascending frequency, zero modes first.
#[derive(Debug, Clone, PartialEq)]
pub struct Modes {
    contact: Contact,
    pairs: Pairs,
    unknowns: usize,
    zero: usize,
}

/// A stuck mode and the slipping mode that resembles it most.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointMode {
    /// Index of the stuck mode.
    pub stuck: usize,
    /// Index of the slipping mode.
    pub slipping: usize,
    /// Their modal assurance criterion, 1 = same shape.
    pub mac: f64,
    /// Modal joint stiffness K_T = ω0² - ω∞², 1/s²; negative where slipping only frees inertia.
    pub k_t: f64,
}

/// The shift as part of the squared first axial frequency of a free bar across the structure: hardly above the first
/// elastic mode, as the search loses a digit for each that an eigenvalue lies above the shift.
const SHIFT: f64 = 1e-3;
/// Zero modes have eigenvalues below this part of the shift: far below elastic modes, yet far above what rounding leaves.
const ZERO: f64 = 1e-4;

impl Assembled {
    /// σ > 0 for which K + σM is positive definite and well conditioned, 1/s².
    pub(crate) fn shift(&self) -> f64 {
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

    /// Stiffness in a state of contact.
    #[must_use]
    pub fn stiffness(&self, contact: Contact) -> Symmetric {
        match contact {
            Contact::Stuck => self.stuck_stiffness(),
            Contact::Slipping => self.slipping_stiffness().clone(),
        }
    }

    /// The lowest `count` modes, zero modes included; none is missed, repeated ones included.
    ///
    /// # Errors
    /// [`Error::Analysis`] for a count out of range, or when a factorisation fails its probe.
    ///
    /// ```
    /// use iwan_fem::{Contact, mesh::beam::Configuration, paper};
    /// let modes = paper::structure(Configuration::A, 1)?.assemble()?.modes(Contact::Stuck, 7)?;
    /// assert_eq!(modes.zero_modes(), 6);
    /// assert!((modes.frequency(6) - 132.3509).abs() < 1e-3); // first bending mode, Hz
    /// # Ok::<(), iwan_fem::Error>(())
    /// ```
    pub fn modes(&self, contact: Contact, count: usize) -> Result<Modes, Error> {
        self.modes_observed(contact, count, &mut |_| ControlFlow::Continue(()))
    }

    /// [`modes`](Self::modes) with a progress report, by what the search usually takes, that may break it off. A
    /// factorisation is not broken off.
    ///
    /// # Errors
    /// As [`modes`](Self::modes), and [`Error::Interrupted`].
    pub fn modes_observed(
        &self,
        contact: Contact,
        count: usize,
        progress: Progress<'_>,
    ) -> Result<Modes, Error> {
        self.modes_and_factor(contact, count, progress).map(|(modes, _)| modes)
    }

    /// K + σM, factored.
    pub(crate) fn shifted_factor(&self, contact: Contact) -> Result<Cholesky, Error> {
        let (stiffness, analysis) = (self.stiffness(contact), self.analysis()?);
        Problem { stiffness: &stiffness, mass: self.mass(), shift: self.shift(), analysis }.factor()
    }

    /// The modes and the factor of K + σM that led to them.
    pub(crate) fn modes_and_factor(
        &self,
        contact: Contact,
        count: usize,
        progress: Progress<'_>,
    ) -> Result<(Modes, Cholesky), Error> {
        let (stiffness, analysis) = (self.stiffness(contact), self.analysis()?);
        let shift = self.shift();
        let problem = Problem { stiffness: &stiffness, mass: self.mass(), shift, analysis };
        let factor = problem.factor()?;
        let pairs = problem.lowest(count, &factor, progress)?;
        let zero = pairs.values.iter().filter(|value| **value < ZERO * shift).count();
        Ok((Modes { contact, pairs, unknowns: self.unknowns(), zero }, factor))
    }

    /// Kind of motion in a mode.
    ///
    /// In each of forty slices across the longest principal axis the mean displacement and the rotation about that axis are
    /// taken; the class is the motion that holds at least half of Σ |u|² over the nodes.
    ///
    /// # Panics
    /// When `modes` belongs to another structure or has no mode `index`.
    #[must_use]
    pub fn classify(&self, modes: &Modes, index: usize) -> Class {
        if index < modes.zero {
            return Class::Zero;
        }
        let shares =
            Slices::new(&self.structure().mesh.positions).shares(&self.displacements(modes.shape(index)));
        let kinds = [Class::Axial, Class::Lateral, Class::Bending, Class::Torsion];
        let largest = (0..4).max_by(|&a, &b| shares[a].total_cmp(&shares[b])).expect("four kinds");
        if shares[largest] >= 0.5 { kinds[largest] } else { Class::Other }
    }

    /// Modal assurance criterion of two modes' shapes (R. J. Allemang and D. L. Brown, IMAC 1982): 1 = same shape.
    ///
    /// # Panics
    /// When a mode belongs to another structure or does not exist.
    #[must_use]
    pub fn mac(&self, (first, i): (&Modes, usize), (second, j): (&Modes, usize)) -> f64 {
        let (a, b) = (self.displacements(first.shape(i)), self.displacements(second.shape(j)));
        dot(&a, &b).powi(2) / (dot(&a, &a) * dot(&b, &b))
    }

    /// For each elastic stuck mode the slipping mode that resembles it most, and K_T = ω0² - ω∞².
    ///
    /// # Panics
    /// When a mode belongs to another structure.
    #[must_use]
    pub fn joint_modes(&self, stuck: &Modes, slipping: &Modes) -> Vec<JointMode> {
        let shapes = |modes: &Modes| -> Vec<Vec<f64>> {
            (0..modes.len()).map(|i| self.displacements(modes.shape(i))).collect()
        };
        let (a, b) = (shapes(stuck), shapes(slipping));
        let mac = |i: usize, j: usize| dot(&a[i], &b[j]).powi(2) / (dot(&a[i], &a[i]) * dot(&b[j], &b[j]));
        let best = |i: usize| {
            let candidates = (slipping.zero..slipping.len()).map(|j| (j, mac(i, j)));
            let (j, mac) = candidates.max_by(|x, y| x.1.total_cmp(&y.1))?;
            Some(JointMode { stuck: i, slipping: j, mac, k_t: stuck.eigenvalue(i) - slipping.eigenvalue(j) })
        };
        (stuck.zero..stuck.len()).filter_map(best).collect()
    }
}

impl Modes {
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

    /// State of the joints.
    #[must_use]
    pub fn contact(&self) -> Contact {
        self.contact
    }

    /// Number of zero modes: rigid motions, and sliding without stiffness.
    #[must_use]
    pub fn zero_modes(&self) -> usize {
        self.zero
    }

    /// ω² of mode `index`, 1/s²; zero modes carry what rounding leaves.
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

/// Number of slices across the longest axis.
const SLICES: usize = 40;

/// Nodes in principal axes, longest first, with the slice each is in.
struct Slices {
    axes: [[f64; 3]; 3],
    positions: Vec<[f64; 3]>,
    slice: Vec<usize>,
}

impl Slices {
    fn new(nodes: &[[f64; 3]]) -> Self {
        let n = nodes.len() as f64;
        let centre: [f64; 3] = std::array::from_fn(|a| nodes.iter().map(|p| p[a]).sum::<f64>() / n);
        let covariance = Mat::from_fn(3, 3, |a, b| {
            nodes.iter().map(|p| (p[a] - centre[a]) * (p[b] - centre[b])).sum::<f64>()
        });
        let eigen = symmetric_eigen(&covariance).expect("positions are finite");
        let axes: [[f64; 3]; 3] = std::array::from_fn(|k| std::array::from_fn(|a| eigen.vectors[(a, 2 - k)]));
        let along = |v: &[f64; 3], axis: &[f64; 3]| (0..3).map(|a| v[a] * axis[a]).sum::<f64>();
        let positions: Vec<[f64; 3]> = nodes.iter().map(|p| axes.map(|axis| along(p, &axis))).collect();
        let ends =
            positions.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| (l.min(p[0]), h.max(p[0])));
        let width = (ends.1 - ends.0) / SLICES as f64;
        let slice = positions.iter().map(|p| (((p[0] - ends.0) / width) as usize).min(SLICES - 1)).collect();
        Self { axes, positions, slice }
    }

    /// Parts of Σ|u|² in axial, lateral and bending motion of the slices and in their rotation.
    fn shares(&self, displacements: &[f64]) -> [f64; 4] {
        let local: Vec<[f64; 3]> = displacements
            .chunks_exact(3)
            .map(|u| self.axes.map(|axis| axis[0] * u[0] + axis[1] * u[1] + axis[2] * u[2]))
            .collect();
        let total: f64 = displacements.iter().map(|u| u * u).sum();
        let mut shares = [0.0; 4];
        for slice in 0..SLICES {
            let members: Vec<usize> = (0..local.len()).filter(|&i| self.slice[i] == slice).collect();
            if members.is_empty() {
                continue;
            }
            let count = members.len() as f64;
            let mean = |of: &[[f64; 3]], a: usize| members.iter().map(|&i| of[i][a]).sum::<f64>() / count;
            let arm: [f64; 3] = std::array::from_fn(|a| mean(&self.positions, a));
            let moved: [f64; 3] = std::array::from_fn(|a| mean(&local, a));
            let (mut moment, mut inertia) = (0.0, 0.0);
            for &i in &members {
                let (y, z) = (self.positions[i][1] - arm[1], self.positions[i][2] - arm[2]);
                moment += y * (local[i][2] - moved[2]) - z * (local[i][1] - moved[1]);
                inertia += y * y + z * z;
            }
            (0..3).for_each(|a| shares[a] += count * moved[a] * moved[a] / total);
            shares[3] += if inertia > 0.0 { moment * moment / inertia / total } else { 0.0 };
        }
        shares
    }
}
