//! A structure with its linear modes, named: what both structure commands begin with.

use std::collections::BTreeMap;

use iwan_fem::{Assembled, Class, Contact, JointMode, Modes};
use iwan_input::{BUILT_IN_STRUCTURES, Source, StructureFile};

use crate::args::StructureArgs;
use crate::failure::Failure;

/// Shapes less alike than this are not the same mode.
pub(crate) const ALIKE: f64 = 0.9;

/// An elastic mode.
#[derive(Debug, Clone)]
pub(crate) struct Elastic {
    /// Kind of motion and number among its kind, such as `bending 1`.
    pub(crate) name: String,
    /// Kind of motion.
    pub(crate) class: Class,
    /// The stuck mode and its slipping counterpart.
    pub(crate) pair: JointMode,
}

/// A structure and its modes.
#[derive(Debug)]
pub(crate) struct Linear {
    /// Name for messages.
    pub(crate) source: String,
    /// The file.
    pub(crate) file: StructureFile,
    /// The matrices.
    pub(crate) assembled: Assembled,
    /// Modes with all joints stuck.
    pub(crate) stuck: Modes,
    /// Modes with all joints slipping.
    pub(crate) slipping: Modes,
    /// The elastic stuck modes, ascending.
    pub(crate) elastic: Vec<Elastic>,
}

/// The structure file that was given, or the built-in one.
pub(crate) fn load(args: &StructureArgs) -> Result<(String, StructureFile), Failure> {
    let source = match &args.path {
        Some(path) => Source::read(path, "structure", BUILT_IN_STRUCTURES[0].0)?,
        None => Source::built_in(BUILT_IN_STRUCTURES[0].0, BUILT_IN_STRUCTURES[0].2),
    };
    Ok((source.name.clone(), StructureFile::read(&source)?))
}

/// A failure of the analysis in the user's terms: what could not be set up is bad input, the rest failed.
pub(crate) fn explain(source: &str, error: &iwan_fem::Error) -> Failure {
    use iwan_fem::Error;
    match error {
        Error::Interrupted => Failure::Interrupted,
        Error::Analysis { .. } => Failure::Computation(format!("{source}: {error}")),
        error => Failure::input(format!("{source}: {error}"), "change this in the structure"),
    }
}

impl Linear {
    /// Computes at least `count` elastic modes in both limits.
    pub(crate) fn new(source: String, file: StructureFile, count: usize) -> Result<Self, Failure> {
        let failed = |error: iwan_fem::Error| explain(&source, &error);
        let assembled = file.structure.assemble().map_err(failed)?;
        let most = assembled.unknowns();
        let stuck = assembled.modes(Contact::Stuck, (count + RIGID).min(most)).map_err(failed)?;
        let slipping = count + RIGID + assembled.slips().len();
        let slipping = assembled.modes(Contact::Slipping, slipping.min(most)).map_err(failed)?;
        let mut elastic = elastic(&assembled, &stuck, &slipping);
        elastic.truncate(count);
        Ok(Self { source, file, assembled, stuck, slipping, elastic })
    }

    /// Frequency of a stuck mode, Hz.
    pub(crate) fn frequency_stuck(&self, mode: &Elastic) -> f64 {
        self.stuck.frequency(mode.pair.stuck)
    }

    /// Frequency of its slipping counterpart, Hz.
    pub(crate) fn frequency_slipping(&self, mode: &Elastic) -> f64 {
        self.slipping.frequency(mode.pair.slipping)
    }

    /// What the user should know about the modes.
    pub(crate) fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        let zero = self.stuck.zero_modes();
        if zero > RIGID {
            warnings.push(format!(
                "{zero} zero modes with all joints stuck, {RIGID} are rigid motions: parts can move freely; check ties, joints and \
                 the directions of their slips"
            ));
        }
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

/// Rigid motions of a free structure.
const RIGID: usize = 6;

fn elastic(assembled: &Assembled, stuck: &Modes, slipping: &Modes) -> Vec<Elastic> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    let pairs = assembled.joint_modes(stuck, slipping);
    let named = |pair: JointMode| {
        let class = assembled.classify(stuck, pair.stuck);
        let count = counts.entry(word(class)).or_default();
        *count += 1;
        Elastic { name: format!("{} {count}", word(class)), class, pair }
    };
    pairs.into_iter().map(named).collect()
}

/// A kind of motion in words.
pub(crate) fn word(class: Class) -> &'static str {
    match class {
        Class::Zero => "zero",
        Class::Bending => "bending",
        Class::Lateral => "lateral",
        Class::Torsion => "torsion",
        Class::Axial => "axial",
        Class::Other => "other",
    }
}
