//! Order of elimination of the unknowns: nested dissection by position.
//!
//! A. George, SIAM J. Numer. Anal. 10:345, 1973, doi:10.1137/0710032. A part is cut across its longest extent; the nodes on one side that
//! are coupled to the other side separate the two and are eliminated last. Nodes are ordered, not unknowns: the unknowns of a node stay
//! together.

use super::sparse::Symmetric;

/// Largest number of nodes of a part that is not cut any further. Any value from 1 to 12 gives the same number of entries in the factor
/// within 4 % (beams of 4,500 to 75,000 unknowns, cubes of 4,000 to 28,000); 40 gives 3 to 15 % more, 150 up to half as many again.
const LEAF: usize = 12;

/// Position and group of an unknown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Site {
    pub(crate) position: [f64; 3],
    /// Unknowns of one group are eliminated together, such as those of a node.
    pub(crate) group: u32,
}

/// The order of elimination: entry k is the unknown that is eliminated k-th.
pub(crate) fn nested_dissection(matrix: &Symmetric, sites: &[Site]) -> Vec<u32> {
    let nodes = Nodes::new(matrix, sites);
    let mut order = Vec::with_capacity(nodes.members.len());
    let mut side = vec![0_u32; nodes.members.len()];
    nodes.dissect((0..nodes.members.len() as u32).collect(), &mut order, &mut side, &mut 0);
    order.iter().flat_map(|&node| nodes.members[node as usize].iter().copied()).collect()
}

/// Groups of unknowns with a common position, and the groups to which each is coupled.
struct Nodes {
    members: Vec<Vec<u32>>,
    positions: Vec<[f64; 3]>,
    neighbours: Vec<Vec<u32>>,
}

impl Nodes {
    fn new(matrix: &Symmetric, sites: &[Site]) -> Self {
        let mut numbers = vec![u32::MAX; sites.iter().map(|site| site.group as usize + 1).max().unwrap_or(0)];
        let (mut members, mut positions): (Vec<Vec<u32>>, Vec<[f64; 3]>) = (Vec::new(), Vec::new());
        let mut group_of = Vec::with_capacity(sites.len());
        for (j, site) in sites.iter().enumerate() {
            let number = &mut numbers[site.group as usize];
            if *number == u32::MAX {
                *number = members.len() as u32;
                members.push(Vec::new());
                positions.push(site.position);
            }
            members[*number as usize].push(j as u32);
            group_of.push(*number);
        }
        let mut neighbours: Vec<Vec<u32>> = vec![Vec::new(); members.len()];
        for j in 0..sites.len() {
            let column = group_of[j];
            for &i in matrix.column(j).0 {
                let row = group_of[i as usize];
                // Consecutive entries mostly repeat the group. Those repetitions are cheap to leave out here; the others are removed below.
                if row != column && neighbours[column as usize].last() != Some(&row) {
                    neighbours[column as usize].push(row);
                    neighbours[row as usize].push(column);
                }
            }
        }
        for list in &mut neighbours {
            list.sort_unstable();
            list.dedup();
        }
        Self { members, positions, neighbours }
    }

    /// Appends the order of a part; `side` marks the side of the present cut on which each node lies.
    fn dissect(&self, mut part: Vec<u32>, order: &mut Vec<u32>, side: &mut [u32], mark: &mut u32) {
        if part.len() <= LEAF {
            order.extend(part);
            return;
        }
        let Some((axis, at)) = self.cut(&mut part) else {
            order.extend(part);
            return;
        };
        let (low, high) = (*mark + 1, *mark + 2);
        *mark += 2;
        for &node in &part {
            side[node as usize] = if self.positions[node as usize][axis] <= at { low } else { high };
        }
        let touches = |node: u32, other: u32| {
            self.neighbours[node as usize].iter().any(|&next| side[next as usize] == other)
        };
        let border = |own: u32, other: u32| -> Vec<u32> {
            part.iter().copied().filter(|&node| side[node as usize] == own && touches(node, other)).collect()
        };
        let (below, above) = (border(low, high), border(high, low));
        let (separator, cut_off) = if below.len() <= above.len() { (below, low) } else { (above, high) };
        for &node in &separator {
            side[node as usize] = 0;
        }
        let rest = |which: u32| part.iter().copied().filter(|&node| side[node as usize] == which).collect();
        let (first, second): (Vec<u32>, Vec<u32>) = (rest(cut_off), rest(low + high - cut_off));
        self.dissect(first, order, side, mark);
        self.dissect(second, order, side, mark);
        order.extend(separator);
    }

    /// Axis of the longest extent, and a coordinate that halves the part; none if all nodes are at one place.
    fn cut(&self, part: &mut [u32]) -> Option<(usize, f64)> {
        let coordinate = |node: u32, axis: usize| self.positions[node as usize][axis];
        let extent = |axis: usize| {
            let (low, high) = part.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &node| {
                (l.min(coordinate(node, axis)), h.max(coordinate(node, axis)))
            });
            (high - low, high)
        };
        let extents = [extent(0), extent(1), extent(2)];
        let axis = (0..3).max_by(|&a, &b| extents[a].0.total_cmp(&extents[b].0))?;
        let middle = part.len() / 2;
        part.select_nth_unstable_by(middle, |&a, &b| {
            coordinate(a, axis).total_cmp(&coordinate(b, axis)).then(a.cmp(&b))
        });
        let median = coordinate(part[middle], axis);
        let at = if median < extents[axis].1 {
            median
        } else {
            part.iter()
                .map(|&n| coordinate(n, axis))
                .filter(|&c| c < median)
                .fold(f64::NEG_INFINITY, f64::max)
        };
        part.sort_unstable();
        (extents[axis].0 > 0.0 && at.is_finite()).then_some((axis, at))
    }
}
