//! Converts the numbers of a file to indices.

/// Numbers of nodes or elements in ascending order, each with its index.
#[derive(Debug, Clone, Default)]
pub(super) struct Labels {
    sorted: Vec<(u64, usize)>,
}

/// A number that two items share.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Twice {
    pub(super) label: u64,
    /// Indices of the two items.
    pub(super) first: usize,
    pub(super) second: usize,
}

impl Labels {
    /// Sorts `labels`; the error is a number that occurs twice.
    pub(super) fn new(labels: impl ExactSizeIterator<Item = u64>) -> Result<Self, Twice> {
        let mut sorted: Vec<(u64, usize)> = labels.enumerate().map(|(index, label)| (label, index)).collect();
        sorted.sort_unstable();
        match sorted.windows(2).find(|w| w[0].0 == w[1].0) {
            Some(w) => Err(Twice { label: w[0].0, first: w[0].1, second: w[1].1 }),
            None => Ok(Self { sorted }),
        }
    }

    /// Index of the item with this number.
    pub(super) fn index(&self, label: u64) -> Option<usize> {
        self.sorted.binary_search_by_key(&label, |entry| entry.0).ok().map(|at| self.sorted[at].1)
    }

    /// Indices of the items numbered `first`, `first + step`, ... up to `last`.
    pub(super) fn range(&self, first: u64, last: u64, step: u64) -> impl Iterator<Item = usize> + '_ {
        let from = self.sorted.partition_point(|entry| entry.0 < first);
        let inside = self.sorted[from..].iter().take_while(move |entry| entry.0 <= last);
        inside.filter(move |entry| (entry.0 - first).is_multiple_of(step.max(1))).map(|entry| entry.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_found_and_doubles_named() {
        let labels = Labels::new([7, 3, 12, 5].into_iter()).unwrap();
        assert_eq!(labels.index(12), Some(2));
        assert_eq!(labels.index(4), None);
        assert_eq!(labels.range(3, 7, 2).collect::<Vec<_>>(), [1, 3, 0]);
        assert_eq!(labels.range(4, u64::MAX, 4).collect::<Vec<_>>(), [2]);
        let twice = Twice { label: 7, first: 0, second: 2 };
        assert_eq!(Labels::new([7, 3, 7].into_iter()).unwrap_err(), twice);
    }
}
