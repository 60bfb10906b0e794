//! A leaf spring from its mesh to its modes: two leaves clamped in one wall and bolted at their tips; frequencies with the bolt stuck and slipping,
//! and K_T of each mode.

use std::error::Error;
use std::sync::Arc;

use iwan::core::FourParameter;
use iwan::fem::mesh::Mesh;
use iwan::fem::mesh::block::{block, uniform};
use iwan::fem::{Interface, Joint, Law, Material, NamedModes, Patch, Structure, Support};

/// Two leaves of 300 x 30 x 5 mm, one on top of the other, with separate nodes where they touch; lengths in m.
fn leaves() -> Mesh {
    let leaf = |z: f64| block(&[uniform(0.0, 0.3, 30), uniform(0.0, 0.03, 3), uniform(z, z + 0.005, 1)]);
    let (mut mesh, upper) = (leaf(0.0), leaf(0.005));
    let first = mesh.positions.len();
    for mut element in upper.elements {
        element.label += 1000;
        element.nodes.iter_mut().for_each(|node| *node += first);
        mesh.elements.push(element);
    }
    mesh.node_labels.extend(upper.node_labels.iter().map(|label| 1000 + label));
    mesh.positions.extend(upper.positions);
    // Node sets: the nodes clamped in the wall, and the nodes of the two faces that the bolt presses together (30 x 30 mm).
    let nodes = mesh.positions.iter().enumerate();
    let wall = nodes.clone().filter(|(_, p)| p[0] == 0.0).map(|(node, _)| node).collect();
    let pressed = nodes.filter(|(_, p)| p[0] > 0.265 && p[2] == 0.005).map(|(node, _)| node);
    let (below, above) = pressed.partition(|node| *node < first);
    let sets: [(&str, Vec<usize>); 3] = [("wall", wall), ("below", below), ("above", above)];
    mesh.node_sets.extend(sets.map(|(name, nodes)| (name.to_owned(), nodes)));
    mesh
}

#[expect(clippy::print_stdout, reason = "an example shows its result")]
pub(crate) fn main() -> Result<(), Box<dyn Error>> {
    let mut structure = Structure::new(leaves(), Material::new(2.1e11, 0.3, 7850.0)?);
    // Each bolted face moves as a rigid body; between the two faces only a slip along the leaves is free. K_T in N/m, F_S in N.
    let law: Law = Arc::new(FourParameter::new(2e7, 1000.0, -0.5, 0.1)?);
    let bolt = Joint::new("bolt", "above", "below", Interface::Whole(Patch::Rigid));
    structure.joints.push(bolt.slip([1.0, 0.0, 0.0], Some(law)));
    structure.supports.push(Support { name: "wall".into(), nodes: "wall".into(), fixed: [true; 3] });
    if let Some(defects) = structure.check().message() {
        return Err(defects.into());
    }

    let modes = NamedModes::new(&structure, 6)?;
    println!("{} unknowns\nmode         stuck, Hz  slipping, Hz   K_T, 1/s²", modes.assembled.unknowns());
    for mode in &modes.elastic {
        let (stuck, slipping) = (modes.frequency_stuck(mode), modes.frequency_slipping(mode));
        println!("{:12} {stuck:9.3} {slipping:13.3} {:12.4e}", mode.name, mode.pair.k_t);
    }
    // Reference values computed with the elements of tests/peers/beam.py: 55.6112 Hz stuck, 46.7351 Hz slipping.
    let first = modes.named("bending 1")?;
    assert!((modes.frequency_stuck(first) - 55.6112).abs() < 1e-3);
    assert!((modes.frequency_slipping(first) - 46.7351).abs() < 1e-3);
    Ok(())
}
