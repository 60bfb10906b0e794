//! Gmsh and Abaqus files: what is read from them, and the errors of faulty ones.

use crate::common::{
    CORNERS, EDGES, Encoding, GMSH_EDGES, GMSH_TET_EDGES, GMSH_WEDGE_EDGES, Msh, TET_EDGES, WEDGE_EDGES,
    hex20, inp, inp_nodes, tet10, wedge15,
};
use iwan_fem::mesh::{MeshFile, Shape, read, read_bytes};
use std::path::Path;

fn msh(bytes: &[u8]) -> Result<MeshFile, String> {
    read_bytes(Path::new("a.msh"), bytes).map_err(|e| e.to_string())
}

fn abaqus(text: &str) -> Result<MeshFile, String> {
    read_bytes(Path::new("a.inp"), text.as_bytes()).map_err(|e| e.to_string())
}

#[test]
fn gmsh_in_three_encodings_is_one_mesh() {
    let read = |encoding| msh(&Msh::block(encoding, &CORNERS, 5).bytes).unwrap();
    let ascii = read(Encoding::Ascii);
    let mesh = &ascii.mesh;
    assert_eq!(mesh.positions, CORNERS);
    assert_eq!(mesh.node_labels, [11, 12, 13, 14, 15, 16, 17, 18]);
    assert_eq!(mesh.elements.len(), 1);
    assert_eq!((mesh.elements[0].label, mesh.elements[0].shape), (2, Shape::Hex8));
    assert_eq!(mesh.elements[0].nodes, [0, 1, 2, 3, 4, 5, 6, 7]);
    assert_eq!(mesh.node_sets["bottom face"], [0, 1, 2, 3]);
    assert_eq!(mesh.node_sets["block"].len(), 8);
    assert_eq!(mesh.element_sets["block"], [0]);
    assert_eq!(mesh.element_sets["volume 6"], [0]);
    assert!(mesh.node_sets["nothing"].is_empty() && !mesh.element_sets.contains_key("nothing"));
    assert_eq!(ascii, read(Encoding::Little));
    assert_eq!(ascii, read(Encoding::Big));
}

#[test]
fn mid_edge_nodes_of_gmsh_come_in_the_order_of_the_shape() {
    for encoding in [Encoding::Ascii, Encoding::Little] {
        let mesh = msh(&Msh::block(encoding, &hex20(&GMSH_EDGES), 17).bytes).unwrap().mesh;
        let element = &mesh.elements[0];
        assert_eq!(element.shape, Shape::Hex20);
        let positions: Vec<_> = element.nodes.iter().map(|n| mesh.positions[*n]).collect();
        assert_eq!(positions, hex20(&EDGES));
        assert_eq!(*Shape::Hex20.edges(), EDGES);
    }
}

#[test]
fn gmsh_two_in_three_encodings_is_one_mesh() {
    let read = |encoding| msh(&Msh::block_two(encoding, &CORNERS, 5).bytes).unwrap();
    let ascii = read(Encoding::Ascii);
    let mesh = &ascii.mesh;
    assert_eq!((&mesh.positions[..], &mesh.node_labels[..2]), (&CORNERS[..], &[11, 12][..]));
    assert_eq!((mesh.elements.len(), mesh.elements[0].label, mesh.elements[0].shape), (1, 2, Shape::Hex8));
    assert_eq!(mesh.node_sets["bottom face"], [0, 1, 2]);
    assert_eq!((mesh.node_sets["block"].len(), &mesh.element_sets["block"]), (8, &vec![0]));
    assert!(mesh.node_sets["nothing"].is_empty());
    assert_eq!(ascii, read(Encoding::Little));
    assert_eq!(ascii, read(Encoding::Big));
    let sound = String::from_utf8(Msh::block_two(Encoding::Ascii, &CORNERS, 5).bytes).unwrap();
    for (old, new, expected) in [
        ("2 5 3 5", "2 7 3 5", "element 2, a 5-node pyramid (type 7), cannot be read"),
        ("2 5 3 5", "2 93 3 5", "element type 93 cannot be read"),
        ("$Nodes\n8", "$Nodes\n9", "found '$EndNodes', expected the number of a node"),
        ("$Nodes\n8", "$Nodes\n999", "found 999, expected the number of nodes: at most"),
        ("$Nodes\n8", "$Nodes\nx", "found 'x', expected the number of nodes"),
        ("17 18 \n", "17 19 \n", "found node 19, expected the number of a node in $Nodes"),
        ("2 5 3 5", "-2 5 3 5", "found -2, expected the number of an element: a number >= 0"),
    ] {
        assert!(sound.contains(old), "{old} is not in\n{sound}");
        let error = msh(sound.replacen(old, new, 1).as_bytes()).unwrap_err();
        assert!(error.starts_with("a.msh: line ") && error.contains(expected), "{error}\n{expected}");
    }
}

/// Tetrahedra and wedges of both orders, from all three formats, with their mid-edge nodes in one order.
#[test]
fn tetrahedra_and_wedges_of_all_formats() {
    let cases = [
        (Shape::Tet4, "C3D4", 4, tet10(&TET_EDGES)[..4].to_vec(), tet10(&TET_EDGES)[..4].to_vec()),
        (Shape::Tet10, "C3D10", 11, tet10(&TET_EDGES), tet10(&GMSH_TET_EDGES)),
        (Shape::Wedge6, "C3D6", 6, wedge15(&WEDGE_EDGES)[..6].to_vec(), wedge15(&WEDGE_EDGES)[..6].to_vec()),
        (Shape::Wedge15, "C3D15", 18, wedge15(&WEDGE_EDGES), wedge15(&GMSH_WEDGE_EDGES)),
    ];
    for (shape, name, kind, ours, gmsh) in cases {
        let labels: Vec<_> = (11..).take(ours.len()).map(|n: u32| n.to_string()).collect();
        let deck = format!("{}*ELEMENT, TYPE={name}\n1, {}\n", inp_nodes(&ours), labels.join(", "));
        let files = [
            abaqus(&deck).unwrap(),
            msh(&Msh::block_two(Encoding::Ascii, &gmsh, kind).bytes).unwrap(),
            msh(&Msh::block_two(Encoding::Little, &gmsh, kind).bytes).unwrap(),
            msh(&Msh::block(Encoding::Big, &gmsh, kind).bytes).unwrap(),
        ];
        for MeshFile { mesh, .. } in files {
            let element = &mesh.elements[0];
            let positions: Vec<_> = element.nodes.iter().map(|n| mesh.positions[*n]).collect();
            assert_eq!((element.shape, positions), (shape, ours.clone()), "{name}");
        }
        if shape.has_middles() {
            let edges = if shape == Shape::Tet10 { &TET_EDGES[..] } else { &WEDGE_EDGES };
            assert_eq!(shape.edges(), edges);
        }
    }
}

#[test]
fn abaqus_nodes_elements_and_sets() {
    let MeshFile { mesh, warnings, .. } = abaqus(&inp()).unwrap();
    assert_eq!(mesh.positions.len(), 28);
    assert_eq!((mesh.node_labels[0], mesh.node_labels[27]), (11, 38));
    assert_eq!(mesh.elements[0].nodes, [0, 1, 2, 3, 4, 5, 6, 7]);
    let large = &mesh.elements[1];
    assert_eq!((large.label, large.shape, &large.nodes), (2, Shape::Hex20, &(8..28).collect()));
    assert_eq!(mesh.node_sets["Bottom"], [0, 1, 2, 3]);
    assert_eq!(mesh.node_sets["odd"], [0, 2, 4]);
    assert_eq!(mesh.node_sets["both"], [0, 1, 2, 3, 4]);
    assert_eq!(mesh.node_sets["all small"], [0, 1, 2, 3, 4, 5, 6, 7]);
    assert_eq!(mesh.element_sets["Small"], [0]);
    assert_eq!(mesh.element_sets["every"], [0, 1]);
    let texts: Vec<_> = warnings.iter().map(ToString::to_string).collect();
    assert!(texts[0].starts_with("line 33: C3D8 is read as a hexahedron of 8 nodes"), "{texts:?}");
    let passed: Vec<_> = texts[1..].iter().map(|t| t.split(' ').next().unwrap()).collect();
    assert_eq!(passed, ["*END", "*HEADING", "*STEP"]);
}

#[test]
fn abaqus_capitals_blanks_and_exponents() {
    let text = format!(
        "{}19, 1.5D0, -2.d-1,\r\n * element , TYPE = c3d8r\n 7 ,11,12,13,14,\n15,16,17,18\n*Nset, nset=\"My Set\"\n19\n*nset,NSET=MY SET\n11\n",
        inp_nodes(&CORNERS)
    );
    let mesh = abaqus(&text).unwrap().mesh;
    assert_eq!(mesh.positions[8], [1.5, -0.2, 0.0]);
    assert_eq!(mesh.elements[0].label, 7);
    assert_eq!(mesh.node_sets.keys().collect::<Vec<_>>(), ["My Set"]);
    assert_eq!(mesh.node_sets["My Set"], [0, 8]);
}

/// Nodes in local coordinates were once put into the wrong place, because these keywords were passed over.
#[test]
fn nodes_in_local_coordinates_land_in_their_place() {
    let near = |text: &str, expected: [[f64; 3]; 2]| {
        let mesh = abaqus(text).unwrap().mesh;
        for (found, expected) in mesh.positions.iter().zip(expected) {
            assert!((0..3).all(|a| (found[a] - expected[a]).abs() < 1e-12), "{text}\n{found:?} {expected:?}");
        }
    };
    let nodes = "*NODE\n1, 1., 2., 3.\n";
    // A pure translation, then the global axes again.
    near(
        &format!("*SYSTEM\n10., 20., 30.\n{nodes}*SYSTEM\n*NODE\n2, 1., 2., 3.\n"),
        [[11., 22., 33.], [1., 2., 3.]],
    );
    // x to the global y, y to the global z: x, y, z become z, x, y.
    near(&format!("*SYSTEM\n0., 0., 0., 0., 5., 0.\n0., 1., 7.\n{nodes}"), [[3., 1., 2.], [0.; 3]]);
    // Without c: turned about z by the angle of the projected x-axis, here 90 degrees.
    near(&format!("*SYSTEM\n1., 0., 0., 1., 2., 9.\n{nodes}"), [[-1., 1., 3.], [0.; 3]]);
    // The parameter of *NODE: cylindrical, radius 2 at 30 degrees; spherical, radius 2 at 90 degrees and an elevation of 30 degrees.
    let round = "*NODE, SYSTEM=C\n1, 2., 30., 3.\n*NODE, SYSTEM=S\n2, 2., 90., 30.\n";
    let (root, half) = (3_f64.sqrt(), 1.0);
    near(round, [[root, half, 3.], [0., root, half]]);
}

#[test]
fn keywords_that_change_the_model_are_passed_over_when_the_user_says_so() {
    let text = format!("{}*TIE, NAME=T\na, b\n*Boundary\n11, 1\n*TIE\nc, d\n", inp_nodes(&CORNERS));
    let path = tempfile(&text);
    let read = iwan_fem::mesh::read_ignoring(&path, &["tie".into(), "*BOUNDARY".into()]).unwrap();
    let texts: Vec<_> = read.warnings.iter().map(ToString::to_string).collect();
    std::fs::remove_file(&path).unwrap();
    assert_eq!(
        texts[0],
        "*BOUNDARY was ignored as asked (1 times, first at line 12): the structure is without what it says"
    );
    assert!(texts[1].starts_with("*TIE was ignored as asked (2 times, first at line 10)"), "{texts:?}");
}

fn tempfile(text: &str) -> std::path::PathBuf {
    let path = std::env::temp_dir().join(format!("iwan-ignored-{}.inp", std::process::id()));
    std::fs::write(&path, text).expect("the folder for temporary files can be written");
    path
}

#[test]
fn one_part_in_its_own_place_is_read_as_if_alone() {
    let body = format!("{}*ELEMENT, TYPE=C3D8I\n1,11,12,13,14,15,16,17,18\n", inp_nodes(&CORNERS));
    let part = format!(
        "*PART, NAME=P\n{body}*END PART\n*ASSEMBLY, NAME=A\n*INSTANCE, NAME=P-1, PART=P\n*END INSTANCE\n\
         *NSET, NSET=tip, INSTANCE=P-1\n12\n*END ASSEMBLY\n"
    );
    let read = abaqus(&part).unwrap();
    assert_eq!(read.mesh.node_sets["tip"], [1]);
    assert!(read.warnings.is_empty(), "{:?}", read.warnings);
}

/// Two instances of one part, the second moved by 2 along x and then turned by 90 degrees about z through (2, 0, 0).
#[test]
fn instances_are_parts_moved_turned_and_numbered_apart() {
    let part = format!(
        "*PART, NAME=P\n{}*ELEMENT, TYPE=C3D8I, ELSET=Body\n1,11,12,13,14,15,16,17,18\n*NSET, NSET=corner\n12\n\
         *SURFACE, NAME=side\nBody, S1\n*END PART\n",
        inp_nodes(&CORNERS)
    );
    let deck = format!(
        "{part}*ASSEMBLY, NAME=A\n*INSTANCE, NAME=Left, PART=p\n*END INSTANCE\n*INSTANCE, NAME=Right, PART=P\n2., 0., 0.\n\
         2., 0., 0., 2., 0., 1., 90.\n*END INSTANCE\n*NSET, NSET=both\nLeft.corner, Right.12\n*NSET, NSET=r, INSTANCE=Right\n11, 12\n\
         *END ASSEMBLY\n*EQUATION\n2\nLeft.corner, 1, 1., Right.corner, 1, -1.\n"
    );
    let read = abaqus(&deck).unwrap();
    let mesh = &read.mesh;
    assert_eq!(mesh.node_labels[..2], [111, 112]);
    assert_eq!(mesh.node_labels[8..10], [211, 212]);
    assert_eq!((mesh.elements[0].label, mesh.elements[1].label), (101, 201));
    // (1, 0, 0) is moved to (3, 0, 0), at distance 1 from the axis, and turned to (2, 1, 0).
    assert!(
        (0..3).all(|a| (mesh.positions[9][a] - [2.0, 1.0, 0.0][a]).abs() < 1e-15),
        "{:?}",
        mesh.positions[9]
    );
    assert_eq!(mesh.node_sets["both"], [1, 9]);
    assert_eq!(mesh.node_sets["r"], [8, 9]);
    assert_eq!(mesh.node_sets["Right.side"], [8, 9, 10, 11]);
    assert_eq!(mesh.element_sets["Left.Body"], [0]);
    assert_eq!(read.constraints[0].nodes(), [1, 9]);
    assert_eq!(mesh.instances["Right"], 200);
    assert!(read.warnings.iter().any(|w| w.to_string().contains("instance Right are numbered from 200 on")));
    let error = abaqus(&deck.replace("Right.12", "Wrong.12")).unwrap_err();
    assert!(error.contains("node set 'both': found the name \"Wrong.12\""), "{error}");
    let error = abaqus(&deck.replace("NAME=Right", "NAME=left")).unwrap_err();
    assert!(error.contains("found the instance \"left\" twice"), "{error}");
}

#[test]
fn included_files_stand_in_place_and_are_named_in_errors() {
    let folder = std::env::temp_dir().join(format!("iwan-include-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
    write("nodes.inp", &inp_nodes(&CORNERS));
    write(
        "main.inp",
        "*HEADING\n*INCLUDE, INPUT=nodes.inp\n*ELEMENT, TYPE=C3D8I\n1,11,12,13,14,15,16,17,18\n",
    );
    let read = |name: &str| iwan_fem::mesh::read(folder.join(name)).map_err(|e| e.to_string());
    assert_eq!(read("main.inp").unwrap().mesh.positions, CORNERS);
    write("nodes.inp", "*NODE\n11, 0, 0, 0\n12, 1, x, 0\n");
    let error = read("main.inp").unwrap_err();
    assert!(error.contains("line 3 of") && error.contains("nodes.inp: found 'x'"), "{error}");
    write("nodes.inp", "*NODE\n11, 0, 0, 0\n");
    assert!(read("main.inp").unwrap_err().contains("main.inp: line 4, element 1: found node 12"));
    write("circle.inp", "*INCLUDE, INPUT=circle.inp\n");
    assert!(
        read("circle.inp").unwrap_err().contains("write files that do not include each other in a circle")
    );
    write("missing.inp", "*INCLUDE, INPUT=nowhere.inp\n");
    assert!(read("missing.inp").unwrap_err().contains("nowhere.inp: cannot be read"));
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn errors_of_abaqus_files_name_line_element_and_node() {
    let nodes = inp_nodes(&CORNERS);
    let cases = [
        (
            "*ELEMENT, TYPE=C3D5\n1,11,12,13,14,15\n",
            "line 10: element type 'C3D5' cannot be read; mesh with hexahedra, tetrahedra or wedges",
        ),
        ("*ELEMENT, ELSET=A\n1,11\n", "line 10: found *ELEMENT without TYPE, expected TYPE=..."),
        ("*ELEMENT, TYPE=C3D8\n3,11,12,13,14,15,16,17,99\n", "line 11, element 3: found node 99"),
        ("*ELEMENT, TYPE=C3D8\n3,11,12,13,14,15,16,17\n", "line 11: found element 3 with 7 nodes"),
        (
            "*ELEMENT, TYPE=C3D8\n3,11,12,13,14,15,16,17,18,11\n",
            "line 11: found element 3 with more than 8 nodes",
        ),
        (
            "*ELEMENT, TYPE=C3D8\n3,11,x,13,14,15,16,17,18\n",
            "line 11: found 'x', expected a node of element 3",
        ),
        ("*NODE\n12, 0, 0, 0\n", "line 11: found node 12, which stands in line 3 already"),
        ("*NODE\n19, 0, nan, 0\n", "line 11: found 'nan', expected y of node 19: a finite number"),
        ("*NODE, SYSTEM=X\n", "line 10: SYSTEM=X of *NODE cannot be read; give R, C or S"),
        ("*NODE, INPUT=a.inp\n", "line 10: parameter 'INPUT' of *NODE cannot be read"),
        (
            "*TIE, NAME=T\na, b\n",
            "line 10: found the name \"a\", expected a *SURFACE or node set of this file",
        ),
        (
            "*Kinematic Coupling\n1, 2\n",
            "line 10: *KINEMATIC COUPLING, which may change the model, cannot be read",
        ),
        (
            "*EQUATION\n2\n11, 1, 1., 99, 1, -1.\n",
            "line 12: found \"99\", expected a node, or a node set with nodes,",
        ),
        (
            "*EQUATION\n2\n11, 7, 1., 12, 1, -1.\n",
            "line 12: found the degree of freedom \"7\", expected a number from 1 to 6",
        ),
        ("*EQUATION\n3\n11, 1, 1., 12, 1, -1.\n", "line 11: found 2 terms of an equation, expected 3"),
        ("*BOUNDARY\n11, 3, 1\n", "line 11: found degrees of freedom from 3 to 1, expected first <= last"),
        (
            "*BOUNDARY\n11, 1, 3, 0.1\n",
            "line 11: a displacement that is not zero cannot be read; hold the node at zero",
        ),
        (
            "*STEP\n*BOUNDARY\n11, 1\n*STEP\n",
            "line 11: *BOUNDARY in one of 2 steps cannot be read; put it before the first *STEP",
        ),
        (
            "*MPC\nSLIDER, 11, 12\n",
            "line 11: *MPC of type SLIDER cannot be read; obeyed are BEAM, TIE, PIN and LINK",
        ),
        (
            "*COUPLING, REF NODE=11, SURFACE=S\n",
            "line 10: found *COUPLING without what it does, expected *KINEMATIC or",
        ),
        ("*KINEMATIC\n", "line 10: found *KINEMATIC without *COUPLING"),
        ("*RIGID BODY, REF NODE=11\n", "line 10: found *RIGID BODY without nodes"),
        ("*MASS, ELSET=A\n1\n", "line 10: found ELSET=A, expected the ELSET of an *ELEMENT, TYPE=MASS above"),
        ("*PART, NAME=P\n", "the end of the file: found part P still open"),
        ("*INSTANCE, NAME=I, PART=P\n", "line 10: found PART=P, expected a part defined above"),
        ("*END INSTANCE\n", "line 10: found *END INSTANCE, expected *INSTANCE before it"),
        (
            "*FLUX CAPACITOR\n",
            "line 10: *FLUX CAPACITOR, which may change the model, cannot be read; it is not known",
        ),
        ("*SYSTEM\n0, 0, 0, 1, 0, 0\n2, 0, 0\n", "line 10: found *SYSTEM whose points span no plane"),
        ("*SYSTEM\n0, 0, x\n", "line 11: found 'x', expected a coordinate of *SYSTEM"),
        ("*NSET, NSET=S\n11, nowhere\n", "line 10, node set 'S': found the name \"nowhere\""),
        ("*NSET, NSET=S\n11, 45\n", "line 10, node set 'S': found node 45"),
        ("*NSET, NSET=S, GENERATE\n14, 11\n", "found the range 14 to 11, expected first <= last"),
        ("*ELSET, ELSET=S\n5\n", "line 10, element set 'S': found element 5"),
        ("*INCLUDE, INPUT=more.inp\n", "*INCLUDE, another file, cannot be read; read the file from a folder"),
        ("*ELEMENT, TYPE=C3D8,\n", "line 10: found a comma at the end"),
    ];
    for (text, expected) in cases {
        let error = abaqus(&format!("{nodes}{text}")).unwrap_err();
        assert!(error.starts_with("a.inp: ") && error.contains(expected), "{text}\n{error}\n{expected}");
    }
    assert!(abaqus("11, 0, 0\n").unwrap_err().contains("line 1: found '11, 0, 0', expected a keyword"));
}

#[test]
fn errors_of_gmsh_files_name_the_place() {
    let sound = String::from_utf8(Msh::block(Encoding::Ascii, &CORNERS, 5).bytes).unwrap();
    let cases = [
        ("4.1 0 8", "3.0 0 8", "line 2: MSH version '3.0' cannot be read; save as MSH 4.1 or 2.2"),
        ("4.1 0 8", "4.1 0 7", "line 2: found data size '7', expected 8 or 4"),
        ("3 1 5 1 2", "3 1 7 1 2", "line 17: element 2, a 5-node pyramid (type 7), cannot be read"),
        ("3 1 5 1 2", "3 1 92 1 2", "line 17: element type 92 cannot be read; mesh in first or second order"),
        ("17 18 \n$EndEl", "17 99 \n$EndEl", "line 17, element 2: found node 99"),
        ("17 18 \n$EndEl", "17 \n$EndEl", "found '$EndElements', expected a node of element 2"),
        ("2 8 11 18", "2 9 11 18", "found 8 nodes in the blocks, expected 9"),
        ("2 8 11 18", "99999 8 11 18", "found 99999, expected the number of blocks of nodes: at most"),
        ("15 16 17 18 ", "15 16 17 15 ", "found node 15 twice"),
        ("0 0 1 1 0 1", "0 0 1 inf 0 1", "found inf, expected x of node 16: a finite number"),
        ("$EndNodes", "$EndNode", "found '$EndNode', expected $EndNodes"),
        ("$Elements", "$Others", "found the end of the file, expected $EndOthers"),
        ("$Entities", "$PartitionedEntities", "a partitioned mesh cannot be read"),
        ("2 7 \"bottom", "2 7 bottom", "line 6: found '2 7 bottom face\"', expected dimension"),
    ];
    for (old, new, expected) in cases {
        assert!(sound.contains(old), "{old} is not in\n{sound}");
        let error = msh(sound.replacen(old, new, 1).as_bytes()).unwrap_err();
        assert!(error.starts_with("a.msh: ") && error.contains(expected), "{new}\n{error}\n{expected}");
    }
    let mut binary = Msh::block(Encoding::Little, &CORNERS, 5).bytes;
    binary.truncate(binary.len() - 40);
    let error = msh(&binary).unwrap_err();
    assert!(error.contains(": byte ") && error.contains("expected a node of element 2"), "{error}");
}

#[test]
fn other_files_are_told_apart() {
    let error = read_bytes(Path::new("a.stl"), b"solid a").unwrap_err().to_string();
    assert_eq!(
        error,
        "a.stl: unknown format (extension 'stl', content 'solid a'); known are Gmsh MSH 4.1 and 2.2 (.msh), Abaqus input (.inp) and Nastran bulk data (.bdf): export to one of these"
    );
    assert!(
        read("no/such/file.msh").unwrap_err().to_string().starts_with("no/such/file.msh: cannot be read: ")
    );
    // The content takes precedence over the extension.
    assert!(read_bytes(Path::new("a.txt"), inp().as_bytes()).is_ok());
}
