//! Classification of modes by their motion: bending, lateral, torsion, axial.

use faer::Mat;

use super::linear::Modes;
use crate::algebra::symmetric_eigen;
use crate::matrices::Assembled;

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
    /// None of these motions makes up half of the mode.
    Other,
}

impl Class {
    /// The name of the motion.
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

impl Assembled {
    /// Class of a mode.
    ///
    /// The nodes are divided into forty slices along the longest principal axis. Each slice contributes its mean displacement and its
    /// rotation about that axis. The class is the motion that holds at least half of Σ |u|² over the nodes.
    ///
    /// # Panics
    /// When `modes` belongs to another structure or has no mode `index`.
    #[must_use]
    pub fn classify(&self, modes: &Modes, index: usize) -> Class {
        if index < modes.zero_modes() {
            return Class::Zero;
        }
        if self.structure().given.as_ref().is_some_and(|given| !given.placed) {
            return Class::Other;
        }
        let shares =
            Slices::new(&self.structure().mesh.positions).shares(&self.displacements(modes.shape(index)));
        let kinds = [Class::Axial, Class::Lateral, Class::Bending, Class::Torsion];
        let largest = (0..4).max_by(|&a, &b| shares[a].total_cmp(&shares[b])).expect("four kinds");
        if shares[largest] >= 0.5 { kinds[largest] } else { Class::Other }
    }
}

/// Number of slices along the longest axis: in the paper's beam each holds two planes of nodes. A slice without nodes is left out. Half a
/// wave of a mode should be longer than a slice.
const SLICES: usize = 40;

/// Nodes in principal axes, longest first, and the slice of each node.
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

    /// Shares of Σ|u|² in the slices' axial, lateral and bending motion and in their rotation.
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
            let mean =
                |vectors: &[[f64; 3]], a: usize| members.iter().map(|&i| vectors[i][a]).sum::<f64>() / count;
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
