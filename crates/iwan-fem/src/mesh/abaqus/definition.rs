//! Sets as they are written, before the numbers and names in them are looked up.

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
#[derive(Debug)]
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
#[derive(Debug)]
pub(super) struct Definition {
    pub(super) kind: SetKind,
    pub(super) name: String,
    /// Line of the keyword, counted from 1.
    pub(super) line: usize,
    pub(super) items: Vec<Item>,
}

impl Definition {
    /// A set of the items just read.
    pub(super) fn of(kind: SetKind, name: &str, line: usize, numbers: Vec<u64>) -> Self {
        Self { kind, name: name.into(), line, items: numbers.into_iter().map(Item::Number).collect() }
    }
}
