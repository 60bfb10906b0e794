//! Writes the matrices of a structure as files for other programs.

use std::fmt::Write;
use std::io;

use iwan_exchange::{Matrix, Stored, to_mat, to_matrix_market, to_npz};
use iwan_fem::{Assembled, Limit, Symmetric, Unknown};

/// A file format for matrices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MatrixFormat {
    /// Matrix Market, one text for each matrix.
    MatrixMarket,
    /// `scipy.sparse.save_npz`, one archive for each matrix.
    Npz,
    /// MATLAB level 5, all matrices in one file.
    Matlab,
}

/// For each matrix the name of its file, the name of its variable, and its meaning.
const MEANINGS: [(&str, &str, &str); 4] = [
    ("stiffness", "K", "stiffness with all joints slipping: that of everything but the joints"),
    ("stuck_stiffness", "K0", "stiffness with all joints stuck: with K_T of each slip on its diagonal"),
    ("mass", "M", "mass"),
    ("displacements", "T", "x, y and z of every node (rows, in the order of nodes.csv) from the unknowns"),
];
/// Names of the files with the meaning of the unknowns and with the positions of all nodes.
const ROWS: &str = "rows.csv";
const NODES: &str = "nodes.csv";
/// The file of all matrices in MATLAB's format.
const MAT: &str = "matrices.mat";

/// Names of the files that [`matrix_files`] writes.
#[must_use]
pub fn matrix_file_names(format: MatrixFormat) -> Vec<String> {
    let each = |suffix: &str| MEANINGS.iter().map(|(name, ..)| format!("{name}.{suffix}")).collect();
    let mut names: Vec<String> = match format {
        MatrixFormat::MatrixMarket => each("mtx"),
        MatrixFormat::Npz => each("npz"),
        MatrixFormat::Matlab => vec![MAT.to_owned()],
    };
    names.extend([ROWS.to_owned(), NODES.to_owned()]);
    names
}

/// Stiffness with all joints slipping and with all stuck, mass, and the displacements of all nodes, all in the unknowns of the structure,
/// with the meaning of each row: in the form that `[matrices]` of a structure file reads. Tied displacements are eliminated; slips and the
/// motions of rigid patches are unknowns of their own, with component 0.
///
/// # Errors
/// An error where a matrix is larger than its format can hold.
///
/// ```
/// use iwan_fem::{mesh::beam::Configuration, paper};
/// use iwan_input::{MatrixFormat, matrix_files};
/// let files = matrix_files(&paper::structure(Configuration::A, 1)?.assemble()?, MatrixFormat::MatrixMarket)?;
/// let names: Vec<&str> = files.iter().map(|file| file.0.as_str()).collect();
/// assert_eq!(names, ["stiffness.mtx", "stuck_stiffness.mtx", "mass.mtx", "displacements.mtx", "rows.csv", "nodes.csv"]);
/// assert!(files[2].1.starts_with(b"%%MatrixMarket matrix coordinate real symmetric\n% mass\n"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn matrix_files(assembled: &Assembled, format: MatrixFormat) -> io::Result<Vec<(String, Vec<u8>)>> {
    let matrices = [
        triangle("K", &assembled.stiffness(Limit::Slipping)),
        triangle("K0", &assembled.stiffness(Limit::Stuck)),
        triangle("M", assembled.mass()),
        displacements(assembled),
    ];
    let names = matrix_file_names(format);
    let mut contents = match format {
        MatrixFormat::Matlab => vec![to_mat(&matrices)?],
        MatrixFormat::Npz => matrices.iter().map(to_npz).collect::<io::Result<_>>()?,
        MatrixFormat::MatrixMarket => {
            let text = |(matrix, meaning): (&Matrix, &(&str, &str, &str))| {
                to_matrix_market(matrix, meaning.2).into_bytes()
            };
            matrices.iter().zip(&MEANINGS).map(text).collect()
        }
    };
    contents.extend([rows(assembled).into_bytes(), nodes(assembled).into_bytes()]);
    Ok(names.into_iter().zip(contents).collect())
}

fn triangle(name: &str, matrix: &Symmetric) -> Matrix {
    let entries = matrix.lower().map(|(i, j, value)| (i as u32, j as u32, value)).collect();
    let (rows, columns) = (matrix.order(), matrix.order());
    Matrix {
        name: name.into(),
        rows,
        columns,
        entries,
        stored: Stored::Triangle,
        labels: None,
        complex: false,
    }
}

fn displacements(assembled: &Assembled) -> Matrix {
    let count = assembled.structure().mesh.positions.len();
    let mut entries = Vec::new();
    for row in 0..3 * count {
        let terms = assembled.displacement_terms(row / 3, row % 3);
        entries.extend(terms.iter().map(|&(unknown, c)| (row as u32, unknown, c)));
    }
    let columns = assembled.unknowns();
    Matrix {
        name: "T".into(),
        rows: 3 * count,
        columns,
        entries,
        stored: Stored::All,
        labels: None,
        complex: false,
    }
}

/// A line `node, component` for each unknown; a comment line precedes an unknown that is no motion of a single node.
fn rows(assembled: &Assembled) -> String {
    let structure = assembled.structure();
    let labels = &structure.mesh.node_labels;
    let mut text = String::from("node,component\n");
    for j in 0..assembled.unknowns() {
        // Writing to a string cannot fail.
        let _ = match assembled.unknown(j) {
            Unknown::Displacement { node, axis } => {
                writeln!(text, "{},{}", labels[node], ["x", "y", "z"][axis])
            }
            Unknown::Rotation { node, axis } => {
                writeln!(text, "{},{}", labels[node], ["rx", "ry", "rz"][axis])
            }
            Unknown::Generalised { row } => {
                writeln!(text, "# generalised coordinate of row {}\n0,0", row + 1)
            }
            Unknown::Reference { joint, component } => {
                let name = structure.joints.get(joint).map_or("a constraint", |joint| &joint.name);
                let motion = ["x", "y", "z", "rx", "ry", "rz"][component];
                writeln!(text, "# rigid motion {motion} of the patch of {name}\n0,0")
            }
            Unknown::Slip { slip } => writeln!(text, "# slip of {}\n0,0", assembled.slips()[slip].name),
        };
    }
    text
}

/// A line `node, x, y, z` for each node.
fn nodes(assembled: &Assembled) -> String {
    let mesh = &assembled.structure().mesh;
    let mut text = String::from("node,x,y,z\n");
    for (label, p) in mesh.node_labels.iter().zip(&mesh.positions) {
        let _ = writeln!(text, "{label},{:e},{:e},{:e}", p[0], p[1], p[2]);
    }
    text
}
