//! Smooth functions of the amplitude: computed at a few amplitudes, the nodes of a table, and interpolated by polynomials in ln amplitude.

/// Nodes of an interpolating polynomial. Six nodes in place of eight need six tenths of the spacing for the same error, four a fifth.
const POINTS: usize = 8;

/// The polynomial through neighbouring nodes in Newton's form (`places` in ln amplitude, divided `differences`), and the ln amplitudes `from` (upper)
/// and `to` (lower) between which it is used.
#[derive(Debug, Clone, Copy)]
struct Piece<const V: usize> {
    places: [f64; POINTS],
    differences: [[f64; V]; POINTS],
    from: f64,
    to: f64,
}

impl<const V: usize> Piece<V> {
    /// The polynomial through the nodes `through`, for ln amplitudes between node `middle` and the next one.
    fn new(through: &[Node<V>; POINTS], middle: usize) -> Self {
        let places: [f64; POINTS] = std::array::from_fn(|i| through[i].0);
        let mut differences: [[f64; V]; POINTS] = std::array::from_fn(|i| through[i].1);
        for order in 1..POINTS {
            for i in (order..POINTS).rev() {
                let over = 1.0 / (places[i] - places[i - order]);
                differences[i] = std::array::from_fn(|k| (differences[i][k] - differences[i - 1][k]) * over);
            }
        }
        Self { places, differences, from: places[middle], to: places[middle + 1] }
    }

    fn at(&self, log: f64) -> [f64; V] {
        let mut sum = self.differences[POINTS - 1];
        for (place, difference) in self.places.iter().zip(&self.differences).rev().skip(1) {
            let late = log - place;
            sum.iter_mut().zip(difference).for_each(|(s, d)| *s = *s * late + d);
        }
        sum
    }
}

/// The logarithm of an amplitude, and what begins there.
pub(super) type Node<const V: usize> = (f64, [f64; V]);

/// What is known of a node.
#[derive(Debug, Clone, Copy)]
enum Known<const V: usize> {
    NotYet,
    /// What begins there cannot be computed, or is of another kind than the table holds.
    Unfit,
    Node(Node<V>),
}

/// Values at a few amplitudes (or half travels), each computed when it is first asked for, and interpolated between them.
#[derive(Debug, Clone)]
pub(super) struct Tabled<const V: usize> {
    /// ln amplitude at which the computation of the first node begins, and the distance to the next node in ln amplitude.
    pub(super) top: f64,
    pub(super) spacing: f64,
    /// Number of nodes.
    pub(super) count: usize,
    /// What is known of each node, from the largest amplitude on.
    known: Vec<Known<V>>,
    /// The polynomial between each node and the next one, where it was asked for.
    pieces: Vec<Option<Piece<V>>>,
    /// Place of the polynomial that was used last.
    last: Option<usize>,
}

impl<const V: usize> Tabled<V> {
    pub(super) const fn new(top: f64, spacing: f64, count: usize) -> Self {
        Self { top, spacing, count, known: vec![], pieces: vec![], last: None }
    }

    /// The polynomial between node `place` and the next one, where it is known.
    fn piece(&self, place: usize) -> Option<&Piece<V>> {
        self.pieces.get(place)?.as_ref()
    }

    /// The values at the ln amplitude `log`; none above the first node, below the last one, and where nodes are unfit. `compute` is given the ln
    /// amplitude at which the computation of a node begins.
    pub(super) fn at(
        &mut self,
        log: f64,
        mut compute: impl FnMut(f64) -> Option<Node<V>>,
    ) -> Option<[f64; V]> {
        let last = self.last.and_then(|place| self.piece(place));
        if let Some(piece) = last.filter(|p| log <= p.from && log > p.to) {
            return Some(piece.at(log));
        }
        // A node lies at the amplitude at which its computation began, or below it by less than the spacing.
        let begun = (self.top - log) / self.spacing;
        let begun = if begun >= 0.0 { begun as usize } else { return None };
        let mut is_above = |i: &usize| self.node(*i, &mut compute).is_some_and(|n| n.0 >= log);
        let above = [Some(begun), begun.checked_sub(1)].into_iter().flatten().find(&mut is_above)?;
        self.last = Some(above);
        if let Some(piece) = self.piece(above) {
            return (log > piece.to).then(|| piece.at(log));
        }
        // As many nodes below `log` as above it, where the table goes so far.
        let highest = self.count.checked_sub(POINTS)?;
        let first = (above + 1).saturating_sub(POINTS / 2).min(highest);
        let first = (first..=above.min(highest)).find(|i| self.node(*i, &mut compute).is_some())?;
        let mut through = [(0.0, [0.0; V]); POINTS];
        for (i, node) in through.iter_mut().enumerate() {
            *node = self.node(first + i, &mut compute)?;
        }
        let middle = (above - first).min(POINTS - 2);
        let piece = Piece::new(&through, middle);
        if self.pieces.len() <= above {
            self.pieces.resize(above + 1, None);
        }
        self.pieces[above] = Some(piece);
        (log > piece.to).then(|| piece.at(log))
    }

    /// Node `i`, computed when it is first asked for; none where it is unfit for a table.
    fn node(&mut self, i: usize, compute: &mut impl FnMut(f64) -> Option<Node<V>>) -> Option<Node<V>> {
        if i >= self.count {
            return None;
        }
        if self.known.len() <= i {
            self.known.resize(i + 1, Known::NotYet);
        }
        match self.known[i] {
            Known::Node(node) => return Some(node),
            Known::Unfit => return None,
            Known::NotYet => {}
        }
        let node = compute(self.top - self.spacing * i as f64);
        self.known[i] = node.map_or(Known::Unfit, Known::Node);
        node
    }
}
