//! Sets, surfaces and constraints as they are written, before the numbers and names in them are looked up.

use super::keyword::Keyword;

/// What a set is a set of.
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

/// A member as written.
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

/// Additions to a set as written.
#[derive(Debug, Clone)]
pub(super) struct Definition {
    pub(super) kind: SetKind,
    pub(super) name: String,
    /// Line of the keyword, counted from 1.
    pub(super) line: usize,
    pub(super) items: Vec<Item>,
    /// Instance to which its numbers and names belong; 0 outside of all.
    pub(super) within: usize,
}

impl Definition {
    /// A set of the items just read.
    pub(super) fn of(kind: SetKind, name: &str, line: usize, numbers: Vec<u64>, within: usize) -> Self {
        let items = numbers.into_iter().map(Item::Number).collect();
        Self { kind, name: name.into(), line, items, within }
    }
}

/// A line of data, as words.
#[derive(Debug, Clone)]
pub(super) struct Row {
    /// Counted from 1.
    pub(super) line: usize,
    pub(super) fields: Vec<String>,
}

/// A keyword with the data under it, kept until all names are known.
#[derive(Debug, Clone)]
pub(super) struct Pending {
    pub(super) keyword: Keyword,
    pub(super) rows: Vec<Row>,
    /// Steps begun before it; 0 in the model itself.
    pub(super) step: usize,
    /// Instance to which its numbers and names belong; 0 outside of all.
    pub(super) within: usize,
}

/// A surface as written, and its name.
#[derive(Debug, Clone)]
pub(super) struct SurfaceText {
    pub(super) name: String,
    pub(super) text: Pending,
}
