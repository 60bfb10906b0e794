//! Every kind of faulty mesh and impossible joint is named, with the numbers of the file.

use iwan_fem::check::Findings;
use iwan_fem::mesh::beam::Configuration;
use iwan_fem::mesh::block::{block, uniform};
use iwan_fem::mesh::{Element, Mesh, Shape};
use iwan_fem::{Interface, Joint, Material, Patch, Structure, Support, paper};

const RIGID: Interface = Interface::Whole(Patch::Rigid);
const AVERAGING: Interface = Interface::Whole(Patch::Averaging);

/// A tie between nodes.
#[derive(Clone, Copy)]
struct Link<'a> {
    name: &'a str,
    interface: Interface,
    face: &'a [usize],
    patch: &'a [usize],
}

fn structure(mesh: &Mesh, links: &[Link]) -> Structure {
    let steel = Material::new(28.0e6, 0.29, 7.48e-4).expect("steel");
    let mut structure = Structure::new(mesh.clone(), steel);
    for link in links {
        let sets = [format!("{} face", link.name), format!("{} patch", link.name)];
        structure.mesh.node_sets.insert(sets[0].clone(), link.face.to_vec());
        structure.mesh.node_sets.insert(sets[1].clone(), link.patch.to_vec());
        structure.joints.push(Joint::new(link.name, &sets[0], &sets[1], link.interface));
    }
    structure
}

/// A bar of four unit cubes along x; nodes numbered from 1, elements from 1.
fn bar() -> Mesh {
    let mut mesh = block(&[uniform(0.0, 4.0, 4), uniform(0.0, 1.0, 1), uniform(0.0, 1.0, 1)]);
    mesh.node_labels = (101..).take(mesh.positions.len()).collect();
    mesh.elements.iter_mut().zip(1..).for_each(|(element, label)| element.label = label);
    mesh
}

fn node(mesh: &Mesh, at: [f64; 3]) -> usize {
    mesh.positions.iter().position(|p| *p == at).expect("a node there")
}

/// Adds a second mesh moved along x; its nodes are numbered from 201, its elements from 11.
fn with(mut mesh: Mesh, other: &Mesh, by: f64) -> Mesh {
    let first = mesh.positions.len();
    mesh.positions.extend(other.positions.iter().map(|p| [p[0] + by, p[1], p[2]]));
    mesh.node_labels.extend((201..).take(other.positions.len()));
    mesh.elements.extend(other.elements.iter().zip(11..).map(|(element, label)| Element {
        label,
        shape: element.shape,
        nodes: element.nodes.iter().map(|n| n + first).collect(),
    }));
    mesh
}

/// Nodes of the plane at x whose numbers are `first` or larger.
fn plane(mesh: &Mesh, x: f64, first: u64) -> Vec<usize> {
    let there = |n: &usize| mesh.positions[*n][0] == x && mesh.node_labels[*n] >= first;
    (0..mesh.positions.len()).filter(there).collect()
}

fn texts(findings: &Findings) -> Vec<String> {
    let defects = findings.defects.iter().map(ToString::to_string);
    defects.chain(findings.remarks.iter().map(|r| format!("remark: {r}"))).collect()
}

fn found(mesh: &Mesh, links: &[Link]) -> Vec<String> {
    texts(&structure(mesh, links).check())
}

#[test]
fn the_papers_beam_is_sound_with_its_joints_and_in_pieces_without() {
    for configuration in [Configuration::A, Configuration::B] {
        let mut beam = paper::structure(configuration, 1).expect("the paper's beam");
        assert_eq!(texts(&beam.check()), Vec::<String>::new());
        assert_eq!(beam.check().message(), None);
        // With one joint missing, one part hangs in the air and touches the beam.
        beam.joints.pop();
        assert_eq!(texts(&beam.check()).len(), 2);
        // Without the joints, the link and the two free washers hang in the air and touch the beam.
        beam.joints.clear();
        let alone = texts(&beam.check());
        assert_eq!(alone.len(), 4, "{alone:?}");
        assert!(
            alone[..3].iter().all(|t| t.starts_with("the part of ") && t.contains("is at the place of node"))
        );
        assert!(alone[3].starts_with("remark: nodes of two parts at the same place"), "{}", alone[3]);
    }
}

#[test]
fn inverted_folded_and_flat_elements() {
    let mut mesh = bar();
    mesh.elements[1].nodes.rotate_left(4);
    assert_eq!(
        found(&mesh, &[]),
        [
            "inverted element 2: the nodes run the wrong way round; swap the two faces in the order of the nodes, or mirror the geometry back"
        ]
    );
    let mut mesh = bar();
    let corner = node(&mesh, [4.0, 1.0, 1.0]);
    mesh.positions[corner] = [3.6, 0.6, 0.6]; // behind the plane of its neighbours
    let label = mesh.node_labels[corner];
    assert_eq!(
        found(&mesh, &[]),
        [format!(
            "folded element 4 at node {label}: the Jacobian determinant is not positive at that corner; move the node, or mesh anew there"
        )]
    );
    let mut mesh = bar();
    for corner in plane(&mesh, 4.0, 0) {
        mesh.positions[corner][0] = 3.0 + 2e-9 * mesh.positions[corner][1];
    }
    let all = found(&mesh, &[]);
    assert!(all[0].starts_with("collapsed element 4: without volume, or"), "{all:?}");
    let mut mesh = bar();
    mesh.elements[2].nodes[5] = mesh.elements[2].nodes[4];
    let label = mesh.node_labels[mesh.elements[2].nodes[4]];
    let all = found(&mesh, &[]);
    assert!(
        all[0].starts_with(&format!("collapsed element 3 (node {label}): a node occurs twice;")),
        "{all:?}"
    );
}

#[test]
fn a_distorted_element_is_a_remark_with_its_measure() {
    let mut mesh = bar();
    for corner in plane(&mesh, 4.0, 0) {
        mesh.positions[corner][0] += 15.0 * mesh.positions[corner][1];
    }
    let all = found(&mesh, &[]);
    assert!(all.len() == 1 && all[0].starts_with("remark: badly distorted element 4 (0.0"), "{all:?}");
}

#[test]
fn elements_and_nodes_too_many() {
    let mut mesh = bar();
    let mut twin = mesh.elements[0].clone();
    twin.label = 9;
    twin.nodes.rotate_left(4);
    twin.nodes[..4].reverse();
    twin.nodes[4..].reverse();
    mesh.elements.push(twin);
    mesh.positions.push([9.0; 3]);
    mesh.node_labels.push(77);
    assert_eq!(
        found(&mesh, &[]),
        [
            "elements with the same nodes: 1 and 9; delete one of each pair",
            "node 77 without an element; delete what is left over, or check that all elements were exported"
        ]
    );
    assert_eq!(
        found(&Mesh::default(), &[]),
        ["the mesh has no elements; export the volumes with their hexahedra"]
    );
}

#[test]
fn a_slit_within_a_part_is_a_defect() {
    let mut mesh = bar();
    let own = node(&mesh, [2.0, 1.0, 1.0]);
    let copy = mesh.positions.len();
    mesh.positions.push([2.0, 1.0, 1.0 + 1e-7]);
    mesh.node_labels.push(300);
    for slot in mesh.elements[2].nodes.iter_mut().filter(|n| **n == own) {
        *slot = copy;
    }
    let expected =
        format!("nodes of one part at the same place: {} and 300; merge them", mesh.node_labels[own]);
    let all = found(&mesh, &[]);
    assert!(all.len() == 1 && all[0].starts_with(&expected), "{all:?}");
    // The two sides of a joint may belong to one part.
    let links = [Link { name: "crack", interface: Interface::NodeToNode, face: &[copy], patch: &[own] }];
    assert_eq!(found(&mesh, &links), Vec::<String>::new());
}

#[test]
fn parts_that_touch_need_a_tie_or_joint() {
    let mesh = with(bar(), &bar(), 4.0);
    let (own, other) = (plane(&mesh, 4.0, 0), plane(&mesh, 4.0, 201));
    let own: Vec<_> = own.into_iter().filter(|n| !other.contains(n)).collect();
    let all = found(&mesh, &[]);
    assert_eq!(
        all[0],
        format!(
            "the part of 4 elements around element 11 is connected with nothing; its node {} is at the place of node {}: merge the nodes, or add a tie or joint there",
            mesh.node_labels[other[0]], mesh.node_labels[own[0]]
        )
    );
    assert!(all[1].starts_with("remark: nodes of two parts") && all.len() == 2, "{all:?}");
    for interface in [RIGID, AVERAGING, Interface::NodeToNode] {
        let links = [Link { name: "seam", interface, face: &other, patch: &own }];
        assert_eq!(found(&mesh, &links), Vec::<String>::new());
    }
    let apart = with(bar(), &bar(), 7.0);
    assert!(
        found(&apart, &[])[0].ends_with("connected with nothing; add a tie or joint, or leave the part out")
    );
}

#[test]
fn joints_that_cannot_work() {
    let mesh = with(bar(), &bar(), 4.0);
    let near = plane(&mesh, 4.0, 201);
    let lead: Vec<_> = plane(&mesh, 4.0, 0).into_iter().filter(|n| !near.contains(n)).collect();
    let far = plane(&mesh, 0.0, 0);
    let label = |n: usize| mesh.node_labels[n];
    let with_joint = |interface, face: &[usize], patch: &[usize]| {
        let link = Link { name: "bolt", interface, face, patch };
        found(&mesh, &[link]).into_iter().filter(|t| t.contains("bolt")).collect::<Vec<_>>()
    };
    let rigid = |face: &[usize], patch: &[usize]| with_joint(RIGID, face, patch).join("; ");
    assert_eq!(
        rigid(&[], &lead),
        "tie `bolt`: the node set `bolt face` has no members; choose another, or fill it when meshing"
    );
    assert!(rigid(&near, &near).contains(&format!("face and patch share the nodes {}", label(near[0]))));
    assert!(rigid(&near, &lead[..2]).contains(&format!(
        "only the nodes {}, {}:",
        label(lead[0]),
        label(lead[1])
    )));
    let line: Vec<_> = [1.0, 2.0, 3.0, 4.0].iter().map(|x| node(&mesh, [*x, 0.0, 0.0])).collect();
    assert!(rigid(&near, &line).contains("the nodes of its patch are on one line"));
    assert!(rigid(&near, &far).contains("apart (between nodes"), "{}", rigid(&near, &far));
    assert!(rigid(&near[..2], &lead).starts_with("remark: tie `bolt`: the nodes of its face"));
    let pairs = with_joint(Interface::NodeToNode, &near, &lead[1..]).join("; ");
    assert!(
        pairs.contains(&format!("the nodes {} of its face have no node of the patch", label(near[0]))),
        "{pairs}"
    );
    let two = |interface| {
        let one = Link { name: "one", interface, face: &near, patch: &lead };
        let other = Link { name: "other", face: &far, ..one };
        found(&mesh, &[one, other])
    };
    assert!(
        two(RIGID)
            .iter()
            .any(|t| t
                .contains(&format!("tie `other`: its node {} follows tie `one` already", label(lead[0]))))
    );
    assert!(!two(AVERAGING).iter().any(|t| t.contains("already")));
}

#[test]
fn twenty_node_elements_are_checked_with_their_edges() {
    let corners = block(&[uniform(0.0, 1.0, 1), uniform(0.0, 1.0, 1), uniform(0.0, 1.0, 1)]);
    let edges =
        [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)];
    let mut mesh = corners;
    let nodes = mesh.elements[0].nodes.clone();
    for (a, b) in edges {
        let (a, b) = (mesh.positions[nodes[a]], mesh.positions[nodes[b]]);
        mesh.elements[0].nodes.push(mesh.positions.len());
        mesh.positions.push(std::array::from_fn(|i| 0.5 * (a[i] + b[i])));
    }
    mesh.node_labels = (1..=20).collect();
    mesh.elements[0].shape = Shape::Hex20;
    assert_eq!(found(&mesh, &[]), Vec::<String>::new());
    let middle = mesh.elements[0].nodes[8];
    let corner = mesh.elements[0].nodes[0];
    mesh.positions[middle] = [0.25, 0.0, 0.0]; // the quarter point of its edge
    let all = found(&mesh, &[]);
    let expected = format!("folded element {} at node {}", mesh.elements[0].label, mesh.node_labels[corner]);
    assert!(all.len() == 1 && all[0].starts_with(&expected), "{all:?}");
}

#[test]
fn sets_that_are_missing_are_named_with_those_that_are_there() {
    let mut structure = structure(&bar(), &[]);
    let nodes = "root".to_string();
    structure.supports.push(Support { name: "clamp".into(), nodes, fixed: [true; 3] });
    structure.materials.push(("steel parts".into(), structure.material));
    assert_eq!(
        texts(&structure.check()),
        [
            "support `clamp`: there is no node set `root`: the mesh has no node sets; name them when meshing",
            "a material: there is no element set `steel parts`; choose one of block"
        ]
    );
}
