//! Sets, surfaces and constraints as the file writes them, before their numbers and names are looked up.

use super::keyword::Keyword;

/// Type of the members of a set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SetKind {
    Nodes,
    Elements,
}

impl SetKind {
    pub(super) const fn word(self) -> &'static str {
        match self {
            Self::Nodes => "node",
            Self::Elements => "element",
        }
    }
}

/// Member of a set as the file writes it.
#[derive(Debug, Clone)]
pub(super) enum Item {
    Number(u64),
    Range {
        first: u64,
        last: u64,
        step: u64,
    },
    Set(String),
    /// The nodes of a set of elements.
    NodesOf(String),
}

/// Members that one keyword adds to a set, as the file writes them.
#[derive(Debug, Clone)]
pub(super) struct Definition {
    pub(super) kind: SetKind,
    pub(super) name: String,
    /// Line of the keyword, counted from 1.
    pub(super) line: usize,
    pub(super) items: Vec<Item>,
    /// Instance to which the numbers and names belong; 0 outside all instances.
    pub(super) within: usize,
}

impl Definition {
    /// Definition of a set from the items that were just read.
    pub(super) fn of(kind: SetKind, name: &str, line: usize, numbers: Vec<u64>, within: usize) -> Self {
        let items = numbers.into_iter().map(Item::Number).collect();
        Self { kind, name: name.into(), line, items, within }
    }
}

/// One line of data, split into fields.
#[derive(Debug, Clone)]
pub(super) struct Row {
    /// Number of the line, counted from 1.
    pub(super) line: usize,
    pub(super) fields: Vec<String>,
}

/// A keyword with its data, kept until all names are known.
#[derive(Debug, Clone)]
pub(super) struct Pending {
    pub(super) keyword: Keyword,
    pub(super) rows: Vec<Row>,
    /// Number of steps that begin before the keyword; 0 before the first step.
    pub(super) step: usize,
    /// Instance to which the numbers and names belong; 0 outside all instances.
    pub(super) within: usize,
}

/// Name of a surface and its definition as the file writes it.
#[derive(Debug, Clone)]
pub(super) struct SurfaceText {
    pub(super) name: String,
    pub(super) text: Pending,
}
