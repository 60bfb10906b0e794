//! Nastran bulk data: fields of all forms, coordinate systems, connections, and the errors of faulty files.
#![allow(clippy::unwrap_used, reason = "a failed test may panic")]

use std::path::Path;

use iwan_fem::mesh::{Freedom, MeshFile, Rule, Shape, read_bytes};

fn bulk(text: &str) -> Result<MeshFile, String> {
    read_bytes(Path::new("a.bdf"), text.as_bytes()).map_err(|e| e.to_string())
}

/// A tetrahedron of 1 x 1 x 1, written in small, large and free fields.
const TETRAHEDRON: &str = "\
$ a comment
SOL 103
CEND
SPC = 4
BEGIN BULK
PARAM   WTMASS  .5
GRID           1              0.      0.      0.
GRID*                  2                         1.0+0              0.0
*                    0.0
GRID,3,,0.,1.,0.
GRID           4              0.      0.      1.             345
CTETRA         9       7       1       2       3       4
PSOLID         7       8
MAT1           8   2.8+7             .29 7.48-4
SPC1           4     123       1  THRU         2
SPC1           5     123       3
EIGRL         10                      12
ENDDATA
anything
";

#[test]
fn fields_of_three_forms_and_chosen_sets() {
    let file = bulk(TETRAHEDRON).unwrap();
    let mesh = &file.mesh;
    assert_eq!(mesh.positions, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    assert_eq!((mesh.elements[0].label, mesh.elements[0].shape), (9, Shape::Tet4));
    assert_eq!(mesh.element_sets["PSOLID 7"], [0]);
    assert_eq!(file.sections[0].constants, [2.8e7, 0.29, 3.74e-4]);
    // The components 3, 4, 5 of GRID itself, then set 4 with its six components; set 5 is not selected.
    let held: Vec<&Rule> = file.constraints.iter().map(|c| &c.rule).collect();
    let of = |node: usize, components: std::ops::Range<usize>| {
        components.map(move |component| Freedom { node, component })
    };
    assert_eq!(
        held,
        [&Rule::Held(of(3, 2..5).collect()), &Rule::Held(of(0, 0..3).chain(of(1, 0..3)).collect())]
    );
    assert_eq!(file.constraints[1].name, "SPC1 4 of line 15");
    let texts: Vec<_> = file.warnings.iter().map(ToString::to_string).collect();
    assert!(texts.iter().any(|t| t.starts_with("EIGRL was passed over")), "{texts:?}");
}

/// A coordinate system very far away once moved a node beyond the range of numbers, and the mesh was accepted as sound.
#[test]
fn nodes_beyond_all_numbers_are_refused() {
    let text = "CORD2R,1,,1.7+308,0.,0.,1.7+308,0.,1.\n,1.7+308,1.,0.\nGRID,7,1,0.,-1.7+308,0.\n";
    let error = bulk(text).unwrap_err();
    assert!(error.starts_with("a.bdf: node 7: found the position ["), "{error}");
    assert!(error.contains("expected finite coordinates"), "{error}");
}

/// Cylindrical and spherical systems inside a turned one, and components along their directions at the node (radial, for instance).
#[test]
fn coordinate_systems() {
    let text = "CORD2R,1,,10.,0.,0.,10.,1.,0.\n,10.,0.,1.\nCORD2C,2,1,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nCORD2S,3,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n\
                GRID,1,2,2.,90.,3.\nGRID,2,3,2.,60.,90.,3\nSPC1,1,1,2\n";
    let file = bulk(text).unwrap();
    let near = |node: usize, expected: [f64; 3]| {
        let found = file.mesh.positions[node];
        assert!((0..3).all(|a| (found[a] - expected[a]).abs() < 1e-12), "{found:?} {expected:?}");
    };
    // System 1: z along the global y, x along the global z, y along the global x. (0, 2, 3) there is (2, 3, 0) beside its origin.
    near(0, [12.0, 3.0, 0.0]);
    // Radius 2, 60 degrees off z, at 90 degrees about it.
    let half = 0.5;
    let root = 0.75_f64.sqrt();
    near(1, [0.0, 2.0 * root, 2.0 * half]);
    let Rule::Equation(terms) = &file.constraints[0].rule else { panic!("{:?}", file.constraints) };
    let along: Vec<f64> = terms.iter().map(|t| t.1).collect();
    assert!(
        along.iter().zip([0.0, root, half]).all(|(a, b)| (a - b).abs() < 1e-12) || along.len() == 2,
        "{along:?}"
    );
}

#[test]
fn rigid_means_equations_and_masses() {
    let text = TETRAHEDRON.replace(
        "EIGRL",
        "RBE2,20,4,123456,1,2\nRBE3,21,,3,123,1.,123,1,2\n,4,2.0,12,2\nMPC,1,1,1,1.,2,1,-1.\n,,3,2,.5\nCONM2,22,4,,6.,1.,0.,0.\n,1.,.1,2.,.2,.3,3.\nEIGRL",
    );
    let file = bulk(&text).unwrap();
    let rules: Vec<&Rule> = file.constraints[2..].iter().map(|c| &c.rule).collect();
    assert!(
        matches!(rules[0], Rule::Rigid { reference: 3, nodes, components: [true, true, true, true, true, true], .. } if nodes == &[0])
    );
    let Rule::Mean { reference: 2, nodes, components, .. } = rules[2] else { panic!("{:?}", rules[2]) };
    assert_eq!(*components, [true, true, true, false, false, false]);
    let weights: Vec<_> = nodes.iter().map(|n| (n.node, n.weight, n.components[2])).collect();
    assert_eq!(weights, [(0, 1.0, true), (1, 1.0, true), (3, 1.0, true), (1, 2.0, false)]);
    let Rule::Equation(terms) = rules[3] else { panic!("{:?}", rules[3]) };
    assert_eq!(terms[2], (Freedom { node: 2, component: 1 }, 0.5));
    let mass = &file.masses[0];
    assert_eq!((mass.node, mass.mass, mass.offset), (3, 3.0, [1.0, 0.0, 0.0]));
    assert_eq!(mass.inertia, [[0.5, -0.05, -0.1], [-0.05, 1.0, -0.15], [-0.1, -0.15, 1.5]]);
}

#[test]
fn errors_name_line_card_and_remedy() {
    let cases = [
        ("GRID,3,,0.,1.,0.", "GRID,2,,0.,1.,0.", "line 10, GRID: found node 2 twice"),
        ("GRID,3,,0.,1.,0.", "GRID,3,5,0.,1.,0.", "line 10, GRID: found system 5 in field 3"),
        (
            "GRID,3,,0.,1.,0.",
            "GRID,3,,0.,1.x,0.",
            "line 10, GRID: found \"1.x\" in field 5, expected a finite number",
        ),
        (
            "GRID,3,,0.,1.,0.",
            "GRID,-3,,0.,1.,0.",
            "line 10, GRID: found -3 in field 2, expected a whole number > 0",
        ),
        (
            "       3       4\n",
            "       3       5\n",
            "line 12, CTETRA: found node 5 in field 7, expected the number of a GRID",
        ),
        (
            "       3       4\n",
            "       3\n",
            "line 12, CTETRA: found element 9 with 3 nodes, expected 4 or 10 nodes",
        ),
        (
            "EIGRL",
            "CQUAD4",
            "line 17: CQUAD4, which may change the model, cannot be read; shells come in as matrices",
        ),
        (
            "EIGRL",
            "FLUX",
            "it is not known to leave the model as it is: say the same in the structure file; then pass over it with ignore = [\"FLUX\"]",
        ),
        (
            "SPC = 4\n",
            "",
            "SPC of a second set, 5, cannot be read; choose a set by SPC = NUMBER before BEGIN BULK",
        ),
        ("    .29", "       ", "MAT1: found material 8 with one of E, G and nu alone"),
        ("     123       3", "     129       3", "digits from 1 to 6"),
        (
            "EIGRL",
            "RBE3,21,,3,123,1.,456,1\nEIGRL",
            "weight 1 on the components \"456\" cannot be read; give a weight > 0 on components among 1, 2",
        ),
        (
            "EIGRL",
            "CORD2R,1,2,0.,0.,0.,0.,0.,1.\n,1.\nEIGRL",
            "found system 1 in system \"2\", expected a system that is defined",
        ),
        ("EIGRL", "CORD2R,1,,0.,0.,0.,0.,0.,1.\n,0.,0.,2.\nEIGRL", "three points on one line"),
    ];
    for (old, new, expected) in cases {
        assert!(TETRAHEDRON.contains(old), "{old}");
        let text = TETRAHEDRON.replacen(old, new, 1).replacen(
            "SPC = 4",
            if new.contains("129") { "SPC = 5" } else { "SPC = 4" },
            1,
        );
        let error = bulk(&text).map(|_| ()).unwrap_err();
        assert!(error.starts_with("a.bdf: ") && error.contains(expected), "{new}\n{error}\n{expected}");
    }
}

/// Mid-edge nodes come in Nastran's order: the upright edges before the top ones.
#[test]
fn mid_edge_nodes_come_in_the_order_of_the_shape() {
    let corners =
        |k: usize| [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1]][k].map(f64::from);
    let edges = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 4), (2, 5), (3, 4), (4, 5), (5, 3)];
    let middle = |(a, b): (usize, usize)| -> [f64; 3] {
        std::array::from_fn(|i| 0.5 * (corners(a)[i] + corners(b)[i]))
    };
    let points: Vec<[f64; 3]> = (0..6).map(corners).chain(edges.map(middle)).collect();
    let grids: String = points
        .iter()
        .zip(1..)
        .fold(String::new(), |text, (p, n)| text + &format!("GRID,{n},,{},{},{}\n", p[0], p[1], p[2]));
    let file = bulk(&format!("{grids}CPENTA,1,1,1,2,3,4,5,6\n,7,8,9,10,11,12,13,14\n,15\n")).unwrap();
    let element = &file.mesh.elements[0];
    assert_eq!(element.shape, Shape::Wedge15);
    for (k, (a, b)) in Shape::Wedge15.edges().iter().enumerate() {
        assert_eq!(file.mesh.positions[element.nodes[6 + k]], middle((*a, *b)), "edge {k}");
    }
}

/// Tabs stand for blanks up to the next multiple of eight columns, and INCLUDE for the lines of another file.
#[test]
fn tabs_and_included_files_are_read() {
    let tabs = "GRID\t1\t\t0.\t0.\t0.\nGRID\t2\t\t1.\nGRID\t3\t\t\t1.\nGRID\t4\t\t\t\t1.\nCTETRA\t9\t7\t1\t2\t3\t4\n";
    let expected = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    assert_eq!(bulk(tabs).unwrap().mesh.positions, expected);
    let folder = std::env::temp_dir().join(format!("iwan-nastran-include-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
    write("grids.bdf", &tabs.lines().take(4).map(|line| format!("{line}\n")).collect::<Vec<_>>().concat());
    write("main.bdf", "BEGIN BULK\nINCLUDE 'grids.bdf'\nCTETRA,9,7,1,2,3,4\nPSHELL,1,2,.1\nENDDATA\n");
    let read = iwan_fem::mesh::read(folder.join("main.bdf")).unwrap();
    assert_eq!(read.mesh.positions, expected);
    write("grids.bdf", "GRID,1,,x\n");
    let error = iwan_fem::mesh::read(folder.join("main.bdf")).unwrap_err().to_string();
    assert!(error.contains("line 1 of") && error.contains("grids.bdf"), "{error}");
    std::fs::remove_dir_all(&folder).unwrap();
    let error = bulk("INCLUDE 'grids.bdf'\n").unwrap_err();
    assert!(error.contains("INCLUDE, another file, cannot be read"), "{error}");
}

/// Properties of a fluid are refused, because a fluid is no solid.
#[test]
fn fluid_properties_are_refused() {
    let text = TETRAHEDRON.replace("PSOLID         7       8", "PSOLID,7,8,,,,,PFLUID");
    assert!(bulk(&text).unwrap_err().contains("PSOLID 7, a fluid, cannot be read"));
}
