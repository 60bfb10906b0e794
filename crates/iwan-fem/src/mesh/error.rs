//! Errors and warnings of the readers of mesh files.

use iwan_machine::{Kind, lacking};
use std::path::PathBuf;

/// Error in a mesh file: the file, the place, what the reader found, what is allowed, and a remedy.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// The operating system refused the file.
    #[error("{}: cannot be read: {source}; {}", .file.display(), lacking(source).unwrap_or("check the path and the permissions"))]
    Io {
        /// File.
        file: PathBuf,
        /// Reason given by the operating system.
        source: std::io::Error,
    },
    /// The file is not of a known format (Gmsh, Abaqus or Nastran).
    #[error("{}: unknown format ({found}); known are Gmsh MSH 4.1 and 2.2 (.msh), Abaqus input (.inp) and Nastran bulk data (.bdf): export to one of these", .file.display())]
    UnknownFormat {
        /// File.
        file: PathBuf,
        /// What the reader examined, for the message.
        found: String,
    },
    /// The file uses a feature of the format that this reader does not support.
    #[error("{}: {place}: {found} cannot be read; {remedy}", .file.display())]
    Unsupported {
        /// File.
        file: PathBuf,
        /// Line or byte, element or node.
        place: String,
        /// What the reader found.
        found: String,
        /// Remedy, for the message.
        remedy: String,
    },
    /// The bytes break the rules of the format.
    #[error("{}: {place}: found {found}, expected {expected}; export the mesh again, or repair this place", .file.display())]
    Malformed {
        /// File.
        file: PathBuf,
        /// Line or byte, element or node.
        place: String,
        /// What the reader found.
        found: String,
        /// What is allowed there.
        expected: String,
    },
}

impl MeshError {
    /// Kind of the error in the catalogue of errors.
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

/// Warning about a mesh file that could be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshWarning {
    /// A keyword, card or section was passed over because it leaves the model unchanged.
    #[error(
        "{name} was passed over ({times} times, first at {place}): it leaves nodes, elements, connections, stiffness and mass as they are"
    )]
    PassedOver {
        /// Keyword or section.
        name: String,
        /// Line or byte of the first occurrence.
        place: String,
        /// Number of occurrences.
        times: usize,
    },
    /// A keyword that changes the model was ignored at the user's request.
    #[error(
        "{name} was ignored as asked ({times} times, first at {place}): the structure is without what it says"
    )]
    Ignored {
        /// Keyword.
        name: String,
        /// Line of the first occurrence.
        place: String,
        /// Number of occurrences.
        times: usize,
    },
    /// An element type implies a formulation; the analysis chooses its own.
    #[error(
        "{place}: {found} is read as {read_as}; the formulation is chosen by the structure, not by the mesh file"
    )]
    Formulation {
        /// Line of the first such block.
        place: String,
        /// Element type of the file.
        found: String,
        /// What the element type is read as.
        read_as: &'static str,
    },
    /// A range of numbers in a set begins or ends at a number that the file does not have.
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
        /// End of the range that the file does not have.
        missing: u64,
        /// Number of members of the range that the file has.
        found: usize,
    },
    /// A set without a member.
    #[error("{place}: the {word} set {set} is empty")]
    EmptySet {
        /// Line of the set.
        place: String,
        /// Nodes or elements.
        word: &'static str,
        /// Name of the set.
        set: String,
    },
    /// The numbers of an instance were shifted because another instance has the same ones.
    #[error("nodes and elements of instance {instance} are numbered from {shift} on: its node 1 is {}", .shift + 1)]
    Renumbered {
        /// Instance.
        instance: String,
        /// Number added to the numbers of its nodes and elements.
        shift: u64,
    },
    /// Remark on how a constraint was applied.
    #[error("{name}: {reason}")]
    Constraint {
        /// Keyword, name and place.
        name: String,
        /// What was done, or left undone.
        reason: String,
    },
    /// Surface or line elements have no section and therefore no stiffness; their nodes form a set.
    #[error("{place}: {times} elements {found} have no section and so no stiffness or mass: {as_set}")]
    Skin {
        /// Line of the first such block.
        place: String,
        /// Element type of the file.
        found: String,
        /// Number of elements.
        times: usize,
        /// Use that is made of the elements.
        as_set: String,
    },
    /// Named groups of different dimension share a name.
    #[error("{place}: {reason}")]
    Groups {
        /// Section.
        place: String,
        /// What is unusual.
        reason: String,
    },
}

/// Remedy for a keyword or card `name` that may not be passed over, from a list of names and remedies.
pub(super) fn remedy_among(known: &[(&str, &str)], name: &str) -> String {
    let own = known.iter().find(|known| known.0 == name);
    let what = own
        .map_or("it is not known to leave the model as it is: say the same in the structure file", |k| k.1);
    format!("{what}; then pass over it with ignore = [\"{name}\"] in [mesh], or delete it from the file")
}
