//! K x from differences of neighbouring displacements, which keeps its digits where stiffness is large and strain small.
//!
//! A common displacement of all nodes causes next to no force, but the entries of the stiffness matrix are large: in Σ_J K_IJ u_J the terms
//! cancel, and rounding leaves a force that does spurious work. With D_I = Σ_J K_IJ, summed once with compensation, the same product is D_I
//! u_I + Σ_J K_IJ (u_J - u_I), whose terms are as small as the strains. The blocks are also read one after another, which takes less time
//! than reading single entries.

use std::collections::BTreeMap;

use super::sparse::Symmetric;

type Block = [f64; 9];

/// A stiffness matrix in the layout for this product.
pub(crate) struct NodalProduct {
    /// Index of the first of the three displacements of each node, or of a joint's reference.
    nodes: Vec<u32>,
    /// D of each node, row by row.
    common: Vec<Block>,
    /// Start of the couplings of each node to later nodes.
    starts: Vec<u32>,
    /// Index of the first displacement of the other node, and K_IJ row by row.
    others: Vec<u32>,
    couplings: Vec<Block>,
    /// Entries of unknowns that are not displacements of nodes, such as slips and rotations.
    rest: Symmetric,
}

impl NodalProduct {
    /// The product for a matrix in which `nodes` are the indices of the first of the three displacements of each node, ascending.
    pub(crate) fn new(matrix: &Symmetric, nodes: Vec<u32>) -> Self {
        let mut node_of = vec![None; matrix.order()];
        for (number, &first) in nodes.iter().enumerate() {
            (0..3).for_each(|axis| node_of[first as usize + axis] = Some((number, axis)));
        }
        let mut common = vec![[(0.0, 0.0); 9]; nodes.len()];
        let mut later: Vec<BTreeMap<u32, Block>> = vec![BTreeMap::new(); nodes.len()];
        let mut rest = BTreeMap::new();
        for j in 0..matrix.order() {
            let (rows, values) = matrix.column(j);
            for (&i, &value) in rows.iter().zip(values) {
                let (Some((first, a)), Some((second, b))) = (node_of[j], node_of[i as usize]) else {
                    rest.insert((j as u32, i), value);
                    continue;
                };
                let mut entry = |node: usize, row: usize, column: usize| {
                    add(&mut common[node][3 * row + column], value);
                };
                entry(first, a, b);
                if first != second {
                    entry(second, b, a);
                    later[first].entry(nodes[second]).or_insert([0.0; 9])[3 * a + b] = value;
                } else if a != b {
                    entry(first, b, a);
                }
            }
        }
        let ends = later.iter().scan(0, |end, others| {
            *end += others.len() as u32;
            Some(*end)
        });
        let starts = std::iter::once(0).chain(ends).collect();
        let (others, couplings) = later.iter().flatten().map(|(&other, &block)| (other, block)).unzip();
        let common = common.iter().map(|block| block.map(|(sum, lost)| sum + lost)).collect();
        Self {
            nodes,
            common,
            starts,
            others,
            couplings,
            rest: Symmetric::from_entries(matrix.order(), &rest),
        }
    }

    /// `y` = K `x`.
    pub(crate) fn multiply(&self, x: &[f64], y: &mut [f64]) {
        self.rest.multiply(x, y);
        for (node, (&first, common)) in self.nodes.iter().zip(&self.common).enumerate() {
            let first = first as usize;
            let own: [f64; 3] = *x[first..].first_chunk().expect("three displacements");
            let mut force = [0.0; 3];
            for row in 0..3 {
                for column in 0..3 {
                    force[row] += common[3 * row + column] * own[column];
                }
            }
            let range = self.starts[node] as usize..self.starts[node + 1] as usize;
            for (&other, k) in self.others[range.clone()].iter().zip(&self.couplings[range]) {
                let other = other as usize;
                let there: &[f64; 3] = x[other..].first_chunk().expect("three displacements");
                let strain = [there[0] - own[0], there[1] - own[1], there[2] - own[2]];
                let answer: &mut [f64; 3] = y[other..].first_chunk_mut().expect("three forces");
                for row in 0..3 {
                    for column in 0..3 {
                        force[row] += k[3 * row + column] * strain[column];
                        answer[column] -= k[3 * row + column] * strain[row];
                    }
                }
            }
            for row in 0..3 {
                y[first + row] += force[row];
            }
        }
    }
}

/// Adds a value to a compensated sum: the sum and its rounding error (Neumaier, ZAMM 54:39, 1974, doi:10.1002/zamm.19740540106).
fn add((sum, lost): &mut (f64, f64), value: f64) {
    let total = *sum + value;
    *lost += if sum.abs() >= value.abs() { (*sum - total) + value } else { (value - total) + *sum };
    *sum = total;
}

#[cfg(test)]
mod tests {
    use super::add;
    use crate::algebra::{Symmetric, largest, random};
    use crate::mesh::beam::Configuration;
    use crate::paper;

    /// A `x` with products and sums in twice the working precision.
    fn doubled(matrix: &Symmetric, x: &[f64]) -> Vec<f64> {
        let mut sums = vec![(0.0, 0.0); x.len()];
        for j in 0..x.len() {
            let (rows, values) = matrix.column(j);
            for (&i, &value) in rows.iter().zip(values) {
                let i = i as usize;
                for (row, column) in if i == j { vec![(i, j)] } else { vec![(i, j), (j, i)] } {
                    let product = value * x[column];
                    add(&mut sums[row], product);
                    add(&mut sums[row], value.mul_add(x[column], -product));
                }
            }
        }
        sums.iter().map(|(sum, lost)| sum + lost).collect()
    }

    fn error(force: &[f64], exact: &[f64]) -> f64 {
        largest(&force.iter().zip(exact).map(|(f, e)| f - e).collect::<Vec<_>>())
    }

    #[test]
    fn differences_give_the_product_and_lose_less() {
        for configuration in [Configuration::A, Configuration::B] {
            let assembled = paper::structure(configuration, 1).unwrap().assemble().unwrap();
            let (plain, nodal) = (assembled.slipping_stiffness(), assembled.nodal_stiffness());
            let mut force = vec![0.0; assembled.unknowns()];
            let rough = random(assembled.unknowns(), 7);
            nodal.multiply(&rough, &mut force);
            let exact = doubled(plain, &rough);
            assert!(error(&force, &exact) < 1e-14 * largest(&exact));
            // The plate bends: displacements of 1, strains of 1e-3.
            let positions = &assembled.structure().mesh.positions;
            let bent: Vec<f64> = (0..assembled.unknowns())
                .map(|j| match assembled.unknown(j) {
                    crate::Unknown::Displacement { node, axis: 2 } => (0.1 * positions[node][0]).powi(2),
                    crate::Unknown::Displacement { node, axis: 0 } => {
                        -0.02 * positions[node][0] * positions[node][2]
                    }
                    _ => 0.0,
                })
                .collect();
            nodal.multiply(&bent, &mut force);
            let exact = doubled(plain, &bent);
            let (here, there) = (error(&force, &exact), error(&plain.times(&bent), &exact));
            assert!(here < 0.2 * there, "{here:e} {there:e}");
        }
    }
}
