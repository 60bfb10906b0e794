//! The paper's beam with its link, washers and four bolted interfaces (Deaner et al., Sec. 3.1).
//!
//! ```text
//!                   ______________________ link 3.5 x 0.5 x 0.125
//!                   |__|_|__________|_|__|
//!                      |w|          |w|    washers 0.5 x 0.5, merged with the link
//!   ___________________|_|__________|_|___________________
//!  |__________________________ beam 20 x 2 x 0.25 ________|  x from -10 to 10
//!                      |w|          |w|    free washers
//!                    -1.25          1.25
//! ```
//!
//! The paper gives the dimensions of beam and link and the number of nodes, 1,554; the washers and the mesh lines are inferred. Lengths in
//! inches.

use super::block::{Lines, Part, refined, uniform};
use super::topology::Mesh;

/// Two choices for the details that the paper does not give.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Configuration {
    /// Uniform mesh, washers 0.125 thick; meant for rigid patches.
    A,
    /// Washers 0.09375 thick, mesh lines across the beam at 0, ±0.25, ±0.6, ±0.9, ±1; meant for averaging
    /// patches. It meets the paper's "within 1 % of a fine mesh" and its Table 2.
    B,
}

/// Half length, half width and thickness of the beam, in.
const BEAM: [f64; 3] = [10.0, 1.0, 0.25];
/// Half length of the link, half width of link and washers, and thickness of the link, in.
const LINK: [f64; 3] = [1.75, 0.25, 0.125];
/// Distance from the middle of the beam at which a washer begins and ends, on both sides, in.
const WASHER: [f64; 2] = [1.0, 1.5];

/// The four interfaces: name, side (-1 left, 1 right) and whether the interface is one of the link's, above the beam.
pub const INTERFACES: [(&str, f64, bool); 4] = [
    ("left link", -1.0, true),
    ("right link", 1.0, true),
    ("left washer", -1.0, false),
    ("right washer", 1.0, false),
];

/// Mesh of the beam, with every cell divided into `refinement`³ cells (1 gives the paper's 1,554 nodes).
///
/// Node sets: `tip`, the upper edge at x = 10; for each of the [`INTERFACES`] `NAME face`, the washer's nodes, and
/// `NAME patch`, the beam's nodes inside the washer's footprint. Element sets: `beam`, `link`, `washers`.
///
/// ```
/// use iwan_fem::mesh::beam::{Configuration, beam};
/// let mesh = beam(Configuration::A, 1);
/// assert_eq!(mesh.positions.len(), 1554);
/// assert_eq!(mesh.node_sets["tip"].len(), 9);
/// assert_eq!(mesh.node_sets["left link patch"].len(), 9);
/// ```
#[must_use]
pub fn beam(configuration: Configuration, refinement: usize) -> Mesh {
    let parts = refinement.max(1);
    let (thickness, across) = match configuration {
        Configuration::A => (0.125, uniform(-BEAM[1], BEAM[1], 8)),
        Configuration::B => (0.09375, vec![-1.0, -0.9, -0.6, -0.25, 0.0, 0.25, 0.6, 0.9, 1.0]),
    };
    let lines = |x: Vec<f64>, y: &[f64], z: [f64; 2]| -> Lines { [x, refined(y, parts), refined(&z, parts)] };
    let along = |from: f64, to: f64| uniform(from, to, ((to - from) * 4.0).round() as usize * parts);
    let (top, narrow) = (BEAM[2], [-LINK[1], LINK[1]]);
    let mut mesh = Mesh::default();
    Part::default().add(&mut mesh, "beam", &lines(along(-BEAM[0], BEAM[0]), &across, [0.0, top]));
    let beam_nodes = mesh.positions.len();
    let above = top + thickness;
    let mut link = Part::default();
    link.add(&mut mesh, "link", &lines(along(-LINK[0], LINK[0]), &narrow, [above, above + LINK[2]]));
    for (name, side, is_link) in INTERFACES {
        let (from, to) = if side < 0.0 { (-WASHER[1], -WASHER[0]) } else { (WASHER[0], WASHER[1]) };
        let (z, plane) = if is_link { ([top, above], top) } else { ([-thickness, 0.0], 0.0) };
        let mut own = Part::default();
        let part = if is_link { &mut link } else { &mut own };
        let first = mesh.positions.len();
        part.add(&mut mesh, "washers", &lines(along(from, to), &narrow, z));
        let face = nodes(&mesh, first..mesh.positions.len(), |p| p[2] == plane);
        let inside = |p: [f64; 3]| {
            lies_between(p[0], from, to) && lies_between(p[1], narrow[0], narrow[1]) && p[2] == plane
        };
        let patch = nodes(&mesh, 0..beam_nodes, inside);
        mesh.node_sets.insert(format!("{name} face"), face);
        mesh.node_sets.insert(format!("{name} patch"), patch);
    }
    let tip = nodes(&mesh, 0..beam_nodes, |p| p[0] == BEAM[0] && p[2] == top);
    mesh.node_sets.insert("tip".to_owned(), tip);
    mesh
}

/// Whether `x` lies between two mesh lines or on one of them; 1e-9 in allows for rounding, where cells are 0.25 in wide.
fn lies_between(x: f64, from: f64, to: f64) -> bool {
    x > from - 1e-9 && x < to + 1e-9
}

fn nodes(mesh: &Mesh, among: std::ops::Range<usize>, keep: impl Fn([f64; 3]) -> bool) -> Vec<usize> {
    among.filter(|&i| keep(mesh.positions[i])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Refinement preserves the volumes and the sets, and gives the expected number of nodes.
    #[test]
    fn both_configurations_have_the_papers_nodes() {
        for configuration in [Configuration::A, Configuration::B] {
            let mesh = beam(configuration, 1);
            assert_eq!((mesh.positions.len(), mesh.elements.len()), (1554, 640 + 14 + 8));
            for (name, side, _) in INTERFACES {
                let face = &mesh.node_sets[&format!("{name} face")];
                let patch = &mesh.node_sets[&format!("{name} patch")];
                assert_eq!((face.len(), patch.len()), (6, 9), "{name}");
                assert!(face.iter().chain(patch).all(|&i| mesh.positions[i][0] * side >= 1.0));
            }
            let fine = beam(configuration, 2);
            assert_eq!(fine.elements.len(), 8 * mesh.elements.len());
            assert_eq!(fine.node_sets["tip"].len(), 17);
            assert_eq!(fine.node_sets["left washer face"].len(), 15);
            assert_eq!(fine.node_sets["left washer patch"].len(), 25);
        }
    }
}
