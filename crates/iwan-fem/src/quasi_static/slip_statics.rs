//! Static compliance of the slips, through the modes that a few stuck modes leave out.

use super::curves::static_flexibility;
use crate::algebra::dot;
use crate::error::Error;
use crate::modes::{Limit, NamedMode, NamedModes};

/// Slips in a few stuck modes, and through all other modes under static forces: s = Σ b_r q_r - ρ N + a f.
///
/// The modes left out follow forces statically, as they do far below their own frequencies (R. R. Craig Jr. and C.-J. Chang, NASA CR-2893,
/// 1977): ρ = Eᵀ K_0⁺ E - Σ b bᵀ/ω² over the kept modes.
#[derive(Debug, Clone, PartialEq)]
pub struct SlipStatics {
    /// b by slip and mode: `participation[slip][mode]`.
    pub participation: Vec<Vec<f64>>,
    /// ρ by slip and slip.
    pub compliance: Vec<Vec<f64>>,
    /// a by slip: slip under a unit load, through the modes left out.
    pub at_force: Vec<f64>,
}

/// Largest slip in any of the modes, over the largest slip of all joints, up to which a joint counts as stuck in these modes. A judgement:
/// an interface that slips a hundredth of another one dissipates next to nothing beside it.
const STUCK: f64 = 0.01;
/// Largest difference of slips, over the largest of all, up to which two joints count as moving alike. The two ends of the paper's link
/// differ by 0.0045 in bending 2, in which they hardly slip.
const ALIKE: f64 = 0.01;

/// Slips that move alike in a few modes and can be treated as one.
#[derive(Debug, Clone, PartialEq)]
pub struct SlipGroup {
    /// Indices of the slips, each with its sign relative to the first.
    pub members: Vec<(usize, f64)>,
}

impl SlipGroup {
    /// Mean of a quantity over the members, with their signs.
    fn mean(&self, of: &dyn Fn(usize) -> f64) -> f64 {
        self.members.iter().map(|(i, sign)| sign * of(*i)).sum::<f64>() / self.members.len() as f64
    }
}

impl SlipStatics {
    /// Groups the slips in `wanted`. Returned are the groups of slips that move alike in these modes and for which `same` holds (for
    /// example equal laws), and the slips that stay stuck.
    #[must_use]
    pub fn groups(
        &self,
        wanted: &[usize],
        same: &dyn Fn(usize, usize) -> bool,
    ) -> (Vec<SlipGroup>, Vec<usize>) {
        let size = |b: &[f64]| b.iter().fold(0.0_f64, |most, b| most.max(b.abs()));
        let largest = self.participation.iter().map(|b| size(b)).fold(0.0, f64::max);
        let (mut groups, mut stuck): (Vec<SlipGroup>, Vec<usize>) = (Vec::new(), Vec::new());
        for &i in wanted {
            let b = &self.participation[i];
            if size(b) <= STUCK * largest {
                stuck.push(i);
                continue;
            }
            let alike = |first: usize, sign: f64| {
                let pairs = self.participation[first].iter().zip(b);
                same(first, i) && pairs.into_iter().all(|(a, b)| (a - sign * b).abs() <= ALIKE * largest)
            };
            let found = groups.iter_mut().find_map(|group| {
                let first = group.members[0].0;
                let sign = [1.0, -1.0].into_iter().find(|sign| alike(first, *sign))?;
                Some((group, sign))
            });
            match found {
                Some((group, sign)) => group.members.push((i, sign)),
                None => groups.push(SlipGroup { members: vec![(i, 1.0)] }),
            }
        }
        (groups, stuck)
    }

    /// The same quantities for groups in place of slips: the mean slip of each group, under a force that its members share equally.
    #[must_use]
    pub fn of_groups(&self, groups: &[SlipGroup]) -> Self {
        let modes = self.participation.first().map_or(0, Vec::len);
        let rho =
            |group: &SlipGroup, other: &SlipGroup| group.mean(&|i| other.mean(&|j| self.compliance[i][j]));
        let participation =
            |group: &SlipGroup| (0..modes).map(|r| group.mean(&|i| self.participation[i][r])).collect();
        Self {
            participation: groups.iter().map(participation).collect(),
            compliance: groups
                .iter()
                .map(|group| groups.iter().map(|other| rho(group, other)).collect())
                .collect(),
            at_force: groups.iter().map(|group| group.mean(&|i| self.at_force[i])).collect(),
        }
    }
}

/// Slips of the whole structure under static forces; the part of a few modes can be subtracted ([`beside`](Self::beside)).
#[derive(Debug, Clone)]
pub struct SlipFlexibility<'a> {
    named: &'a NamedModes,
    forces: Vec<f64>,
    /// Eᵀ K_0⁺ E by slip and slip, and Eᵀ K_0⁺ f.
    slips: Vec<Vec<f64>>,
    at_force: Vec<f64>,
}

impl NamedModes {
    /// Slips under unit forces on each slip, and under the load `forces`, which has one entry per unknown
    /// ([`Assembled::load`](crate::Assembled::load)).
    ///
    /// # Errors
    /// The errors of [`Assembled::modes`](crate::Assembled::modes); [`Error::Analysis`] for the load of another structure.
    pub fn slip_flexibility(&self, forces: Vec<f64>) -> Result<SlipFlexibility<'_>, Error> {
        let assembled = &self.assembled;
        let unknowns = assembled.unknowns();
        if forces.len() != unknowns {
            let finding =
                format!("the load has {} entries, the structure has {unknowns} unknowns", forces.len());
            let remedy = "make it with the same assembled structure";
            return Err(Error::Analysis { analysis: "statics of the slips", finding, remedy });
        }
        let factor = assembled.shifted_factor(Limit::Stuck)?;
        let columns = static_flexibility(assembled, &self.stuck, &factor, assembled.shift()?);
        let at: Vec<usize> = assembled.slips().iter().map(|slip| slip.unknown).collect();
        let entry = |i: usize, j: usize| 0.5 * (columns[j][at[i]] + columns[i][at[j]]);
        let all = 0..at.len();
        let slips = all.clone().map(|i| all.clone().map(|j| entry(i, j)).collect()).collect();
        let at_force = columns.iter().map(|column| dot(column, &forces)).collect();
        Ok(SlipFlexibility { named: self, forces, slips, at_force })
    }
}

impl SlipFlexibility<'_> {
    /// Slips in the given modes, and those that all other modes add under static forces on the slips and under the load.
    ///
    /// ```
    /// use iwan_fem::{NamedModes, mesh::beam::Configuration, paper};
    /// let named = NamedModes::new(&paper::structure(Configuration::A, 1)?, 12)?;
    /// let load = named.assembled.load("tip", [0.0, 0.0, 1.0])?;
    /// let statics = named.slip_flexibility(load)?.beside(&named.first_bending());
    /// // Two ends of the link, each with K_T = 2.75e5: as one joint they have K_T rho = 0.2875.
    /// let [one, other] = [0, 2];
    /// let rho = &statics.compliance;
    /// assert!((2.75e5 * (rho[one][one] - rho[one][other]) - 0.2875).abs() < 1e-3);
    /// assert!((statics.participation[one][0].abs() - 0.2397).abs() < 1e-4);
    /// # Ok::<(), iwan_fem::Error>(())
    /// ```
    #[must_use]
    pub fn beside(&self, modes: &[NamedMode]) -> SlipStatics {
        let stuck = &self.named.stuck;
        let shapes: Vec<(&[f64], f64)> = modes
            .iter()
            .map(|mode| (stuck.shape(mode.pair.stuck), stuck.eigenvalue(mode.pair.stuck)))
            .collect();
        let at: Vec<usize> = self.named.assembled.slips().iter().map(|slip| slip.unknown).collect();
        let kept = |i: usize, of: &dyn Fn(&[f64]) -> f64| -> f64 {
            shapes.iter().map(|(shape, eigenvalue)| shape[at[i]] * of(shape) / eigenvalue).sum()
        };
        let rho = |i: usize, j: usize| self.slips[i][j] - kept(i, &|shape| shape[at[j]]);
        let all = 0..at.len();
        SlipStatics {
            participation: at
                .iter()
                .map(|&slip| shapes.iter().map(|(shape, _)| shape[slip]).collect())
                .collect(),
            compliance: all.clone().map(|i| all.clone().map(|j| rho(i, j)).collect()).collect(),
            at_force: all.map(|i| self.at_force[i] - kept(i, &|shape| dot(shape, &self.forces))).collect(),
        }
    }
}
