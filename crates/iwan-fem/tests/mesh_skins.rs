//! Abaqus input with elements of surfaces and lines, and with stress in the unloaded structure.
#![allow(clippy::unwrap_used, reason = "a failed test may panic")]

use std::path::Path;

use crate::common::{CORNERS, inp_nodes};
use iwan_fem::mesh::{MeshFile, read_bytes};

fn abaqus(text: &str) -> Result<MeshFile, String> {
    read_bytes(Path::new("a.inp"), text.as_bytes()).map_err(|e| e.to_string())
}

/// Gmsh's own export contains elements of lines and surfaces beside those of volumes: they have no section, and become node sets.
#[test]
fn surface_elements_without_a_section_are_node_sets() {
    let solid = "*ELEMENT, TYPE=C3D8I, ELSET=Volume1\n1,11,12,13,14,15,16,17,18\n";
    let skin = "*ELEMENT, type=T3D2, ELSET=Line1\n2, 11, 12\n*ELEMENT, type=CPS4, ELSET=Surface1\n3, 11, 12, 13, 14\n\
                *ELEMENT, type=S3\n4, 11, 12,\n13\n";
    let text = format!("*HEADING\n a.inp\n{}{skin}{solid}", inp_nodes(&CORNERS));
    let read = abaqus(&text).unwrap();
    assert_eq!(read.mesh.elements.len(), 1);
    assert_eq!(read.mesh.node_sets["Surface1"], [0, 1, 2, 3]);
    assert_eq!(read.mesh.node_sets["Line1"], [0, 1]);
    let texts: Vec<String> = read.warnings.iter().map(ToString::to_string).collect();
    assert!(
        texts
            .iter()
            .any(|t| t.contains("1 elements CPS4 have no section") && t.contains("node set Surface1")),
        "{texts:?}"
    );
    assert!(texts.iter().any(|t| t.contains("S3") && t.contains("they are passed over")), "{texts:?}");
    let error = abaqus(&format!("{text}*SOLID SECTION, ELSET=surface1, MATERIAL=A\n1.\n")).unwrap_err();
    assert!(error.contains("a section of elements CPS4 (set surface1)"), "{error}");
    let error = abaqus(&format!("{text}*SHELL SECTION, ELSET=surface1, MATERIAL=A\n1.\n")).unwrap_err();
    assert!(
        error.contains("*SHELL SECTION, which may change the model") && error.contains("[matrices]"),
        "{error}"
    );
    let error = abaqus(&text.replace("3, 11, 12, 13, 14", "3, 11, 12, 13")).unwrap_err();
    assert!(error.contains("an element CPS4 with 3 nodes, expected 4 nodes"), "{error}");
}

/// Gmsh writes a physical group of a surface as a set of its surface elements. A set "left", whose elements were not found, once made the
/// file fail.
#[test]
fn sets_of_surface_elements_are_node_sets() {
    let solid = "*ELEMENT, TYPE=C3D8I, ELSET=Volume1\n3,11,12,13,14,15,16,17,18\n";
    let skin = "*ELEMENT, type=CPS4, ELSET=Surface1\n1, 11, 12, 13, 14\n2, 15, 16, 17, 18\n";
    let sets = "*ELSET,ELSET=left\n1,\n*ELSET,ELSET=body\n3,\n*ELSET,ELSET=both\n2, 3\n*ELSET, ELSET=ends, GENERATE\n1, 2, 1\n";
    let read = abaqus(&format!("{}{skin}{solid}{sets}", inp_nodes(&CORNERS))).unwrap();
    assert_eq!(read.mesh.node_sets["left"], [0, 1, 2, 3]);
    assert_eq!(read.mesh.node_sets["both"], [4, 5, 6, 7]);
    assert_eq!(read.mesh.node_sets["ends"], [0, 1, 2, 3, 4, 5, 6, 7]);
    assert_eq!(read.mesh.element_sets["body"], [0]);
    assert_eq!(read.mesh.element_sets["both"], [0]);
    assert!(!read.mesh.element_sets.contains_key("left") && !read.mesh.element_sets.contains_key("ends"));
    assert!(!read.warnings.iter().any(|w| w.to_string().contains("runs from")), "{:?}", read.warnings);
    let error = abaqus(&format!("{}{skin}{solid}*ELSET,ELSET=none\n4,\n", inp_nodes(&CORNERS))).unwrap_err();
    assert!(error.contains("found element 4"), "{error}");
}

/// Stress in the unloaded structure is refused because it stiffens the structure; temperatures are accepted because they do not.
#[test]
fn initial_stress_is_refused() {
    let text = format!(
        "{}*ELEMENT, TYPE=C3D8I\n1,11,12,13,14,15,16,17,18\n*INITIAL CONDITIONS, TYPE=",
        inp_nodes(&CORNERS)
    );
    assert!(abaqus(&format!("{text}TEMPERATURE\n11, 20.\n")).is_ok());
    assert!(abaqus(&format!("{text}STRESS\n1, 1., 1., 1.\n")).unwrap_err().contains("*INITIAL CONDITIONS"));
}
