//! Geometry and mode shapes of universal files: points (datasets 15, 2411), lines between them (82), elements (2412), shapes (55).
//!
//! Layouts after the pages of the Structural Dynamics Research Laboratory, University of Cincinnati.

use std::path::Path;

use super::nodal::{NodalMode, Node};
use super::rows::{Rows, row};
use super::sections::split;
use super::shape::mode;
use crate::error::ReadError;
use crate::file_bytes::FileBytes;
use crate::warning::Warning;

/// The structure that a universal file describes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct UffModel {
    /// Points, in the order of the file.
    pub nodes: Vec<Node>,
    /// For each line its nodes, from one end to the other; a node 0 interrupts the line.
    pub lines: Vec<Vec<i64>>,
    /// For each element the code of its kind (111 a tetrahedron, 44 a plane quadrilateral, …) and its nodes.
    pub elements: Vec<(i64, Vec<i64>)>,
    /// Mode shapes.
    pub modes: Vec<NodalMode>,
    /// Warnings, among them what was left out.
    pub warnings: Vec<Warning>,
}

/// Edges of solids with four, six and eight corners, as pairs of places (from 0) in the order of nodes.
const TETRAHEDRON: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];
const WEDGE: [[usize; 2]; 9] = [[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3], [0, 3], [1, 4], [2, 5]];
const BRICK: [[usize; 2]; 12] =
    [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];

impl UffModel {
    /// Pairs of nodes that a drawing connects: along the lines and the elements' edges, each pair once.
    #[must_use]
    pub fn edges(&self) -> Vec<[i64; 2]> {
        let along = self.lines.iter().flat_map(|line| line.windows(2).map(|w| [w[0], w[1]]));
        let of = |(kind, nodes): &(i64, Vec<i64>)| -> Vec<[i64; 2]> {
            let pairs: Vec<[usize; 2]> = match (kind, nodes.len()) {
                (_, 0 | 1) => Vec::new(),
                (_, 2) => vec![[0, 1]],
                (111, 4) => TETRAHEDRON.into(),
                (112, 6) => WEDGE.into(),
                (115, 8) => BRICK.into(),
                (_, n) => (0..n).map(|i| [i, (i + 1) % n]).collect(),
            };
            pairs.into_iter().map(|[i, j]| [nodes[i], nodes[j]]).collect()
        };
        let mut edges: Vec<[i64; 2]> = along.chain(self.elements.iter().flat_map(of)).collect();
        // A node 0 interrupts a line.
        edges.retain(|[a, b]| *a != 0 && *b != 0 && a != b);
        for edge in &mut edges {
            edge.sort_unstable();
        }
        edges.sort_unstable();
        edges.dedup();
        edges
    }
}

/// Geometry and mode shapes of a universal file; `name` serves messages only. Other datasets are passed over.
///
/// # Errors
/// [`ReadError`] with the file and the place in it.
///
/// ```
/// use iwan_io::write_uff::{Node, lines, nodes};
/// let text = nodes(&[Node { number: 7, position: [0.0, 0.5, 1.0] }]) + &lines(&[vec![7, 8]]);
/// let model = iwan_io::uff_model("plate.uff".as_ref(), text.as_bytes())?;
/// assert_eq!((model.nodes[0].position[1], model.edges()), (0.5, vec![[7, 8]]));
/// # Ok::<(), iwan_io::ReadError>(())
/// ```
pub fn model(name: &Path, bytes: &[u8]) -> Result<UffModel, ReadError> {
    let source = FileBytes { file: name, bytes };
    let mut others = Vec::new();
    let mut model = UffModel::default();
    split(&source, &mut model.warnings, &mut |other| others.push(other))?;
    for other in &others {
        let mut rows = Rows::new(&source, other);
        match other.number.as_str() {
            "15" => one_line_nodes(&mut rows, &mut model)?,
            "781" | "2411" => two_line_nodes(&mut rows, &mut model)?,
            "82" => line(&mut rows, &mut model)?,
            "2412" => elements(&mut rows, &mut model)?,
            "55" => match mode(&mut rows)? {
                Ok(mode) => model.modes.push(mode),
                Err(reason) => {
                    let name = format!("dataset 55 at byte {}", other.offset);
                    model.warnings.push(Warning::LeftOut { name, reason });
                }
            },
            _ => {}
        }
    }
    Ok(model)
}

const NODE: &str = "a node: its number, three more whole numbers, and x, y, z";

fn node(rows: &Rows, number: f64, xyz: &[f64]) -> Result<Node, ReadError> {
    if number.fract() != 0.0 || !(1.0..=1e15).contains(&number) {
        return Err(rows.wrong(&number.to_string(), "the number of a node, whole and > 0"));
    }
    Ok(Node { number: number as i64, position: [xyz[0], xyz[1], xyz[2]] })
}

/// Reads dataset 15: Format(4I10,1P3E13.5).
fn one_line_nodes(rows: &mut Rows, model: &mut UffModel) -> Result<(), ReadError> {
    while !rows.ended() {
        let text = rows.next().unwrap_or_default();
        if text.trim().is_empty() {
            continue;
        }
        let by_columns = || {
            let first = row(text.get(..10)?, 10, 1)?;
            Some([first, vec![0.0; 3], row(text.get(40..)?, 13, 3)?].concat())
        };
        let all = row(&text, 10, 7).filter(|_| text.split_whitespace().count() == 7).or_else(by_columns);
        let all = all.ok_or_else(|| rows.wrong(&text, NODE))?;
        model.nodes.push(node(rows, all[0], &all[4..7])?);
    }
    Ok(())
}

/// Reads dataset 2411: Format(4I10) and Format(1P3D25.16).
fn two_line_nodes(rows: &mut Rows, model: &mut UffModel) -> Result<(), ReadError> {
    while !rows.ended() {
        let head = rows.integers(1, NODE)?;
        let xyz = rows.numbers(3, (25, 3), NODE)?;
        model.nodes.push(node(rows, head[0] as f64, &xyz)?);
    }
    Ok(())
}

/// Reads dataset 82: number of the line, number of nodes and colour; a name; nodes, eight in a row.
fn line(rows: &mut Rows, model: &mut UffModel) -> Result<(), ReadError> {
    let what = "a line: its number and how many nodes it has";
    let head = rows.integers(2, what)?;
    let count = usize::try_from(head[1]).map_err(|_| rows.wrong(&head[1].to_string(), what))?;
    let _ = rows.next();
    let mut nodes = Vec::new();
    while nodes.len() < count && !rows.ended() {
        nodes.extend(rows.integers(1, "numbers of nodes")?);
    }
    if nodes.len() < count {
        return Err(rows.wrong(&format!("{} nodes", nodes.len()), "as many nodes as the first row says"));
    }
    nodes.truncate(count);
    model.lines.push(nodes);
    Ok(())
}

/// Code of an element of two nodes that needs no further data: a rod.
pub const ROD: i64 = 11;
/// Codes of beams, whose nodes follow a row with their orientation.
pub(super) const BEAMS: [i64; 5] = [ROD, 21, 22, 23, 24];

/// Reads dataset 2412: six whole numbers, the last of which is the number of nodes; then the nodes, eight in a row.
fn elements(rows: &mut Rows, model: &mut UffModel) -> Result<(), ReadError> {
    let what = "an element: six whole numbers, the second its kind and the last how many nodes it has";
    while !rows.ended() {
        let head = rows.integers(6, what)?;
        let count = usize::try_from(head[5]).map_err(|_| rows.wrong(&head[5].to_string(), what))?;
        if BEAMS.contains(&head[1]) {
            let _ = rows.next();
        }
        let mut nodes = Vec::new();
        while nodes.len() < count {
            nodes.extend(rows.integers(1, "numbers of nodes")?);
        }
        nodes.truncate(count);
        model.elements.push((head[1], nodes));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::nodal::ModalScale;
    use super::super::write;
    use super::*;

    fn read(text: &str) -> UffModel {
        model("m.uff".as_ref(), text.as_bytes()).unwrap()
    }

    fn refused(text: &str) -> String {
        model("m.uff".as_ref(), text.as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn what_is_written_is_read_again() {
        let nodes = [(3, [0.0, -0.5, 1e-3]), (12, [1.0, 2.0, 3.0])]
            .map(|(number, position)| Node { number, position });
        let mode = NodalMode {
            frequency: 100.0,
            damping_ratio: 0.01,
            pole: [-6.25, 628.25],
            scale: ModalScale::A([0.0, 1256.5]),
            values: vec![
                (3, [[0.0; 2], [1.5, -0.25], [2.0, 0.0]]),
                (12, [[-1.0, 1e-9], [0.0; 2], [0.5, 0.125]]),
            ],
        };
        let line = vec![3, 12, 0, 3, 4, 5, 6, 7, 8, 9];
        let text = write::nodes(&nodes)
            + &write::lines(std::slice::from_ref(&line))
            + &write::modes(std::slice::from_ref(&mode));
        let found = read(&text);
        assert_eq!((found.nodes.as_slice(), found.lines.as_slice()), (nodes.as_slice(), [line].as_slice()));
        assert_eq!(found.edges(), [[3, 4], [3, 12], [4, 5], [5, 6], [6, 7], [7, 8], [8, 9]]);
        let own = &found.modes[0];
        let size = 6.25_f64.hypot(628.25);
        assert!((own.frequency * std::f64::consts::TAU / size - 1.0).abs() < 1e-9);
        assert!((own.damping_ratio - 6.25 / size).abs() < 1e-9);
        assert_eq!((&own.values, own.scale), (&mode.values, mode.scale));
        // Modal A is written as 2i ω_d: the shape is mass-normalised as it stands.
        let normalised = own.mass_normalised().unwrap();
        assert!((normalised[0].1[1][0] - 1.5).abs() < 1e-5 && (normalised[0].1[1][1] + 0.25).abs() < 1e-5);
    }

    #[test]
    fn nodes_in_full_and_elements_are_read_again_to_the_bit() {
        let nodes = [(3, [0.1, -1.0 / 3.0, 1e-300]), (12, [f64::MAX, 2.0, -0.0])]
            .map(|(number, position)| Node { number, position });
        let elements = [(ROD, vec![3, 12]), (115, (1..=8).collect()), (118, (1..=10).collect())];
        let found = read(&(write::nodes_in_full(&nodes) + &write::elements(&elements)));
        let bits = |nodes: &[Node]| nodes.iter().map(|n| n.position.map(f64::to_bits)).collect::<Vec<_>>();
        assert_eq!(bits(&found.nodes), bits(&nodes));
        assert_eq!(found.elements, elements);
    }

    #[test]
    fn normal_modes_bring_their_modal_mass() {
        let text = "    -1\n    55\na\nb\nc\nd\ne\n         1         2         2         8         2         3\n         2         4         1         1\n  1.00000e+01  4.00000e+00  2.00000e-02  0.00000e+00\n         7\n -2.00000e+00 -1.46518E+00-1.46518E+00\n    -1\n";
        let mode = &read(text).modes[0];
        assert_eq!((mode.frequency, mode.scale), (10.0, ModalScale::Mass(4.0)));
        assert!((mode.damping_ratio - 0.02).abs() < 1e-12);
        assert_eq!(mode.mass_normalised().unwrap(), [(7, [[-1.0, 0.0], [-0.73259, 0.0], [-0.73259, 0.0]])]);
        let unscaled = read(&text.replace("4.00000e+00", "0.00000e+00"));
        assert_eq!(unscaled.modes[0].mass_normalised(), None);
        let forced = read(&text.replacen("         1         2", "         1         5", 1));
        assert!(forced.modes.is_empty() && forced.warnings[0].to_string().contains("analysis type 5"));
    }

    #[test]
    fn nodes_in_two_rows_and_elements_give_edges() {
        let text = "    -1\n  2411\n         1         0         0        11\n   1.0000000000000000D+00   5.0000000000000000D-01  -2.5000000000000000D+00\n    -1\n    -1\n  2412\n         1        11         1         1         1         2\n         0         1         1\n         1         2\n         2        44         1         1         1         4\n         1         2         3         4\n    -1\n";
        let found = read(text);
        assert_eq!(found.nodes, [Node { number: 1, position: [1.0, 0.5, -2.5] }]);
        assert_eq!(found.edges(), [[1, 2], [1, 4], [2, 3], [3, 4]]);
    }

    #[test]
    fn mistakes_are_named_with_dataset_and_row() {
        let text =
            refused("    -1\n    15\n         1         0         0         8  0.0  zero  1.0\n    -1\n");
        assert!(
            text.contains("m.uff") && text.contains("dataset 15 at byte 7, row 1") && text.contains("zero"),
            "{text}"
        );
        let text =
            refused("    -1\n    15\n       1.5         0         0         8  0.0  0.0  1.0\n    -1\n");
        assert!(text.contains("1.5") && text.contains("whole"), "{text}");
        let text =
            refused("    -1\n    82\n         1         5         1\nrim\n         1         2\n    -1\n");
        assert!(text.contains("2 nodes"), "{text}");
    }
}
