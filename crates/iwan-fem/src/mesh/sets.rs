//! Named sets under construction, with a bound on their total size.

use std::collections::BTreeMap;

/// Entries that all sets of a file may have together, per byte of the file. Sets of sets and entities in many groups
/// could otherwise grow with the square (or worse) of the file. An entry that is written out takes two bytes at least, a digit and a comma,
/// so that ordinary files stay far below; one that would pass the limit is refused with the place.
pub(super) const ENTRIES_PER_BYTE: usize = 2;

/// Named sets of indices.
#[derive(Debug)]
pub(super) struct Sets {
    named: BTreeMap<String, Vec<usize>>,
    entries: usize,
    limit: usize,
}

/// The sets of a file would become larger than is kept in memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct TooLarge {
    /// Entries allowed.
    pub(super) limit: usize,
}

impl Sets {
    /// No sets yet; `length` is the size of the file in bytes.
    pub(super) fn new(length: usize) -> Self {
        Self { named: BTreeMap::new(), entries: 0, limit: length.saturating_mul(ENTRIES_PER_BYTE) }
    }

    /// Adds to the set called `name`, which is made when it is not there.
    pub(super) fn extend(
        &mut self,
        name: &str,
        indices: impl Iterator<Item = usize>,
    ) -> Result<(), TooLarge> {
        if !self.named.contains_key(name) {
            self.named.insert(name.to_string(), Vec::new());
        }
        let Some(set) = self.named.get_mut(name) else { return Ok(()) };
        for index in indices {
            self.entries += 1;
            if self.entries > self.limit {
                return Err(TooLarge { limit: self.limit });
            }
            set.push(index);
        }
        Ok(())
    }

    /// Members of a set so far, in no order, doubles possible.
    pub(super) fn get(&self, name: &str) -> Option<&[usize]> {
        self.named.get(name).map(Vec::as_slice)
    }

    /// The sets, each ascending without doubles.
    pub(super) fn finish(self) -> BTreeMap<String, Vec<usize>> {
        let mut sets = self.named;
        for set in sets.values_mut() {
            set.sort_unstable();
            set.dedup();
            set.shrink_to_fit();
        }
        sets
    }
}
