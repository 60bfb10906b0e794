//! Named sets under construction, with a limit on their total size.

use std::collections::BTreeMap;

/// Number of entries that all sets of a file together may have, per byte of the file. Without a limit, sets of sets and entities in many
/// groups could grow with the square (or a higher power) of the file's size. A written entry takes at least two bytes, a digit and a comma,
/// so ordinary files stay far below. The set that would exceed the limit is refused with its place in the file.
pub(super) const ENTRIES_PER_BYTE: usize = 2;

/// Named sets of indices.
#[derive(Debug)]
pub(super) struct Sets {
    named: BTreeMap<String, Vec<usize>>,
    entries: usize,
    limit: usize,
}

/// The error for sets that would become larger than the limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct TooLarge {
    /// Number of entries allowed.
    pub(super) limit: usize,
}

impl Sets {
    /// No sets yet; `length` is the size of the file in bytes.
    pub(super) fn new(length: usize) -> Self {
        Self { named: BTreeMap::new(), entries: 0, limit: length.saturating_mul(ENTRIES_PER_BYTE) }
    }

    /// Adds members to the set called `name`, which is created if it does not exist.
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

    /// Members of a set so far, in no particular order and possibly repeated.
    pub(super) fn get(&self, name: &str) -> Option<&[usize]> {
        self.named.get(name).map(Vec::as_slice)
    }

    /// The finished sets, each in ascending order without repetitions.
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
