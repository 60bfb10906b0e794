//! The elastic modes of a structure by name, with all joints stuck and with all slipping.

use iwan_machine::listed;
use std::collections::BTreeMap;

use super::class::Class;
use super::joint_mode::JointMode;
use super::linear::{Limit, Modes};
use crate::algebra::dot;
use crate::error::Error;
use crate::matrices::Assembled;
use crate::structure::Structure;
use iwan_core::Progress;
use iwan_core::progress::UNWATCHED;
use iwan_core::progress::part;

/// Number of rigid motions of a free structure.
const RIGID: usize = 6;
/// Number of bending modes that [`NamedModes::first_bending`] takes, as many as the paper shows.
const FIRST: usize = 3;
/// Smallest modal assurance criterion (MAC) of two shapes that count as the same mode, by the custom of modal testing; the paper's beam has
/// 0.9989 and more. For a bending mode below it a warning is given, and its K_T is reported all the same.
const ALIKE: f64 = 0.9;

/// Coupling of two modes by the damping, over the geometric mean of their own damping, above which a warning is given. A judgement: ten
/// times what light proportional damping leaves after rounding to a few digits, and a third of what close modes need to exchange energy.
const COUPLED: f64 = 0.1;

/// An elastic mode.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedMode {
    /// Kind of motion, and number among the modes of that kind, such as `bending 1`.
    pub name: String,
    /// Kind of motion.
    pub class: Class,
    /// The stuck mode and its slipping counterpart.
    pub pair: JointMode,
}

/// A structure with its modes in both limits.
///
/// ```
/// use iwan_fem::{NamedModes, mesh::beam::Configuration, paper};
/// let modes = NamedModes::new(&paper::structure(Configuration::A, 1)?, 4)?;
/// let mode = modes.named("bending-1")?;
/// assert!((modes.frequency_stuck(mode) - 132.3509).abs() < 1e-3); // Hz
/// assert!((modes.frequency_slipping(mode) - 127.7660).abs() < 1e-3);
/// # Ok::<(), iwan_fem::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct NamedModes {
    /// The matrices.
    pub assembled: Assembled,
    /// Modes with all joints stuck.
    pub stuck: Modes,
    /// Modes with all joints slipping.
    pub slipping: Modes,
    /// The elastic stuck modes, frequencies ascending.
    pub elastic: Vec<NamedMode>,
}

impl NamedModes {
    /// Number of elastic modes among which the command line and the Python package look for names. On the paper's beam these modes reach to
    /// 10 kHz and take a fraction of a second; for a name beyond them the error lists the known names.
    pub const LOOKED_UP: usize = 40;

    /// Computes at least `count` elastic modes in both limits, if the structure has as many, and names the first `count`. If the structure
    /// holds [modes](Structure::kept) of an earlier run, these are used, as many as there are.
    ///
    /// # Errors
    /// The errors of [`Structure::assemble`] and [`Assembled::modes`].
    pub fn new(structure: &Structure, count: usize) -> Result<Self, Error> {
        Self::observed(structure, count, UNWATCHED)
    }

    /// [`new`](Self::new) with a progress report whose listener may stop it.
    ///
    /// # Errors
    /// The errors of [`new`](Self::new), and [`Error::Interrupted`].
    pub fn observed(structure: &Structure, count: usize, progress: Progress<'_>) -> Result<Self, Error> {
        Self::of(structure.assemble()?, count, progress)
    }

    /// [`observed`](Self::observed) for a structure whose matrices are already assembled.
    ///
    /// # Errors
    /// The errors of [`Assembled::modes`], and [`Error::Interrupted`].
    pub fn of(assembled: Assembled, count: usize, progress: Progress<'_>) -> Result<Self, Error> {
        if let Some(kept) = assembled.kept()? {
            let n = assembled.unknowns();
            let stuck = Modes::of_kept(&kept.stuck, Limit::Stuck, n);
            let slipping = Modes::of_kept(&kept.slipping, Limit::Slipping, n);
            let mut elastic = elastic(&assembled, &stuck, &slipping);
            elastic.truncate(count.min(kept.named));
            return Ok(Self { assembled, stuck, slipping, elastic });
        }
        let most = assembled.unknowns();
        if count > most.max(Self::LOOKED_UP) {
            let finding = format!("{count} modes were asked for, the structure has {most} unknowns");
            let remedy = "ask for at most as many as there are unknowns";
            return Err(Error::Analysis { analysis: "modes", finding, remedy });
        }
        let wanted = count.saturating_add(RIGID).min(most);
        assembled.ask_for_search(wanted)?;
        // Without slips both limits have the same matrix, and one search gives both.
        let joined = assembled.slips().is_empty();
        let first = if joined { 1.0 } else { 0.5 };
        let stuck = assembled.modes_observed(Limit::Stuck, wanted, &part(progress, [0.0, first]))?;
        check_rigid_motions(assembled.structure(), &stuck)?;
        if joined {
            let slipping = stuck.clone().called(Limit::Slipping);
            let mut elastic = elastic(&assembled, &stuck, &slipping);
            elastic.truncate(count);
            return Ok(Self { assembled, stuck, slipping, elastic });
        }
        let wanted = count.saturating_add(RIGID + assembled.slips().len()).min(most);
        let slipping = assembled.modes_observed(Limit::Slipping, wanted, &part(progress, [0.5, 1.0]))?;
        let mut elastic = elastic(&assembled, &stuck, &slipping);
        elastic.truncate(count);
        Ok(Self { assembled, stuck, slipping, elastic })
    }

    /// Frequency of a stuck mode, Hz.
    #[must_use]
    pub fn frequency_stuck(&self, mode: &NamedMode) -> f64 {
        self.stuck.frequency(mode.pair.stuck)
    }

    /// Frequency of the mode's slipping counterpart, Hz.
    #[must_use]
    pub fn frequency_slipping(&self, mode: &NamedMode) -> f64 {
        self.slipping.frequency(mode.pair.slipping)
    }

    /// The mode of this name; hyphens in `name` count as blanks.
    ///
    /// # Errors
    /// [`Error::MissingMode`] with the known names.
    pub fn named(&self, name: &str) -> Result<&NamedMode, Error> {
        let wanted = name.replace('-', " ");
        self.elastic.iter().find(|mode| mode.name == wanted).ok_or_else(|| {
            let known = listed(self.elastic.iter().map(|mode| &mode.name));
            Error::MissingMode { name: name.to_owned(), known }
        })
    }

    /// The first three bending modes, or the first three modes of any kind if there is no bending mode.
    #[must_use]
    pub fn first_bending(&self) -> Vec<NamedMode> {
        let bending = self.elastic.iter().filter(|mode| mode.class == Class::Bending);
        let bending: Vec<NamedMode> = bending.take(FIRST).cloned().collect();
        if bending.is_empty() { self.elastic.iter().take(FIRST).cloned().collect() } else { bending }
    }

    /// The modes of these names, or the first bending modes if no name is given.
    ///
    /// # Errors
    /// The errors of [`named`](Self::named).
    pub fn chosen(&self, names: &[String]) -> Result<Vec<NamedMode>, Error> {
        if names.is_empty() {
            return Ok(self.first_bending());
        }
        names.iter().map(|name| self.named(name).cloned()).collect()
    }

    /// A warning if given damping couples the named modes noticeably: reduced models use its diagonal alone.
    fn damping_left_out(&self) -> Option<String> {
        let damping = self.assembled.damping()?;
        let shape = |mode: &NamedMode| self.stuck.shape(mode.pair.stuck);
        let images: Vec<Vec<f64>> = self.elastic.iter().map(|mode| damping.times(shape(mode))).collect();
        let entry = |i: usize, j: usize| dot(shape(&self.elastic[i]), &images[j]);
        let own: Vec<f64> = (0..images.len()).map(|i| entry(i, i)).collect();
        let pairs = (0..own.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
        let ratio = |(i, j): (usize, usize)| (entry(i, j).abs() / (own[i] * own[j]).sqrt(), i, j);
        let found =
            pairs.map(ratio).filter(|(ratio, ..)| *ratio > COUPLED).max_by(|a, b| a.0.total_cmp(&b.0));
        found.map(|(ratio, i, j)| {
            let names = (&self.elastic[i].name, &self.elastic[j].name);
            format!(
                "the damping of the matrices couples {} and {} by {ratio:.2} of their own: reduced models and forced responses leave that out",
                names.0, names.1
            )
        })
    }

    /// Warnings about the modes for the user.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        let zero = self.stuck.zero_modes();
        if zero > RIGID {
            warnings.push(format!(
                "{zero} zero modes with all joints stuck, {RIGID} are rigid motions: parts can move freely; check ties, joints and \
                 the directions of their slips"
            ));
        }
        warnings.extend(self.damping_left_out());
        let unlike = self.elastic.iter().filter(|m| m.class == Class::Bending && m.pair.mac < ALIKE);
        warnings.extend(unlike.map(|m| {
            format!(
                "{}: the slipping mode most like it has a MAC of {:.3}: its K_T has little meaning",
                m.name, m.pair.mac
            )
        }));
        warnings
    }
}

/// Refuses a free body with fewer than six zero modes: a body that nothing holds has six rigid motions without stiffness, and if fewer are
/// found, rounding has destroyed the digits of all low modes.
fn check_rigid_motions(structure: &Structure, stuck: &Modes) -> Result<(), Error> {
    let held = !structure.supports.is_empty()
        || !structure.constraints.is_empty()
        || structure.given.is_some()
        || structure.lumps.iter().any(|lump| lump.stiffness.iter().any(|k| *k > 0.0));
    if held || stuck.zero_modes() >= RIGID.min(stuck.len()) {
        return Ok(());
    }
    Err(Error::Analysis {
        analysis: "modes",
        finding: format!(
            "{} zero modes of a free body, which has six: the stiffness has lost their digits",
            stuck.zero_modes()
        ),
        remedy: "take Poisson's ratio at most 0.4999, or stiffnesses and sizes that lie less far apart",
    })
}

fn elastic(assembled: &Assembled, stuck: &Modes, slipping: &Modes) -> Vec<NamedMode> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    let pairs = assembled.joint_modes(stuck, slipping);
    let named = |pair: JointMode| {
        let class = assembled.classify(stuck, pair.stuck);
        let count = counts.entry(class.word()).or_default();
        *count += 1;
        NamedMode { name: format!("{} {count}", class.word()), class, pair }
    };
    pairs.into_iter().map(named).collect()
}
