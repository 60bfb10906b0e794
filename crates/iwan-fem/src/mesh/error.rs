//! Why a mesh file could not be read, and what a reader noticed in one that could.

use iwan_machine::Kind;
use std::path::PathBuf;

/// Why a mesh file could not be read: file, place, what stands there, what is allowed, what helps.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// The operating system refused the file.
    #[error("{}: cannot be read: {source}; check the path and the permissions", .file.display())]
    Io {
        /// File.
        file: PathBuf,
        /// Reason given by the operating system.
        source: std::io::Error,
    },
    /// Neither a Gmsh nor an Abaqus mesh.
    #[error("{}: unknown format ({found}); known are Gmsh MSH 4.1 and 2.2 (.msh), Abaqus input (.inp) and Nastran bulk data (.bdf): export to one of these", .file.display())]
    UnknownFormat {
        /// File.
        file: PathBuf,
        /// What was looked at.
        found: String,
    },
    /// Something the format allows and this reader does not take.
    #[error("{}: {place}: {found} cannot be read; {remedy}", .file.display())]
    Unsupported {
        /// File.
        file: PathBuf,
        /// Line or byte, element or node.
        place: String,
        /// What stands there.
        found: String,
        /// What helps.
        remedy: String,
    },
    /// The bytes break the rules of the format.
    #[error("{}: {place}: found {found}, expected {expected}; export the mesh again, or repair this place", .file.display())]
    Malformed {
        /// File.
        file: PathBuf,
        /// Line or byte, element or node.
        place: String,
        /// What stands there.
        found: String,
        /// What may stand there.
        expected: String,
    },
}

impl MeshError {
    /// Its kind in the catalogue of errors.
    #[must_use]
    pub fn kind(&self) -> Kind {
        match self {
            Self::Io { source, .. } if source.kind() == std::io::ErrorKind::OutOfMemory => Kind::Memory,
            Self::Io { .. } => Kind::Unreadable,
            Self::UnknownFormat { .. } => Kind::UnknownFormat,
            Self::Unsupported { .. } => Kind::Unsupported,
            Self::Malformed { .. } => Kind::Damaged,
        }
    }
}

/// One remark about a mesh file that could be read all the same.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshWarning {
    /// A keyword, card or section that leaves the model as it is was passed over.
    #[error(
        "{name} was passed over ({times} times, first at {place}): it leaves nodes, elements, connections, stiffness and mass as they are"
    )]
    PassedOver {
        /// Keyword or section.
        name: String,
        /// Line or byte of the first one.
        place: String,
        /// How often it occurs.
        times: usize,
    },
    /// A keyword that changes the model was passed over because the user said so.
    #[error(
        "{name} was ignored as asked ({times} times, first at {place}): the structure is without what it says"
    )]
    Ignored {
        /// Keyword.
        name: String,
        /// Line of the first one.
        place: String,
        /// How often it occurs.
        times: usize,
    },
    /// An element type that names a formulation; the analysis chooses its own.
    #[error(
        "{place}: {found} is read as {read_as}; the formulation is chosen by the structure, not by the mesh file"
    )]
    Formulation {
        /// Line of the first such block.
        place: String,
        /// Element type of the file.
        found: String,
        /// What it is read as.
        read_as: &'static str,
    },
    /// A range of numbers in a set that does not end, or begin, at a number of the file.
    #[error(
        "{place}: the {word} set {set} runs from {first} to {last}, and {missing} is no {word} of this file: it has {found} members of that range"
    )]
    BeyondRange {
        /// Line of the set.
        place: String,
        /// Nodes or elements.
        word: &'static str,
        /// Name of the set.
        set: String,
        /// First number of the range.
        first: u64,
        /// Last number of the range.
        last: u64,
        /// The end that is not there.
        missing: u64,
        /// How many of the range are there.
        found: usize,
    },
    /// Numbers of an instance that were shifted because another has the same.
    #[error("nodes and elements of instance {instance} are numbered from {shift} on: its node 1 is {}", .shift + 1)]
    Renumbered {
        /// Instance.
        instance: String,
        /// What was added to its numbers.
        shift: u64,
    },
    /// How a constraint was obeyed.
    #[error("{name}: {reason}")]
    Constraint {
        /// Keyword, name and place.
        name: String,
        /// What was done or left.
        reason: String,
    },
    /// Surface or line elements without a section: they have no stiffness, and their nodes are a set.
    #[error("{place}: {times} elements {found} have no section and so no stiffness or mass: {as_set}")]
    Skin {
        /// Line of the first such block.
        place: String,
        /// Element type of the file.
        found: String,
        /// How many elements.
        times: usize,
        /// What became of them.
        as_set: String,
    },
    /// Named groups that no entity refers to, or groups without entities.
    #[error("{place}: {reason}")]
    Groups {
        /// Section.
        place: String,
        /// What is odd.
        reason: String,
    },
}

/// What helps with a keyword or card `name` that may not be passed over, by a list of names and remedies.
pub(super) fn remedy_among(known: &[(&str, &str)], name: &str) -> String {
    let own = known.iter().find(|known| known.0 == name);
    let what = own
        .map_or("it is not known to leave the model as it is: say the same in the structure file", |k| k.1);
    format!("{what}; then pass over it with ignore = [\"{name}\"] in [mesh], or delete it from the file")
}
