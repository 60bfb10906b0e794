//! What is read from structure files, and the errors of faulty ones.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use iwan_fem::mesh::beam::Configuration;
use iwan_fem::{Formulation, Inertia, Interface, Patch, paper};

use super::{BUILT_IN_STRUCTURES, Point, StructureFile};
use crate::text::InputText;

fn read(text: &str) -> Result<StructureFile, String> {
    StructureFile::read(&InputText::built_in("s.toml", text)).map_err(|e| e.to_string())
}

/// The two built-in files give the same structures as the library, with the same bits in mesh and matrices.
#[test]
fn the_built_in_files_are_the_papers_structures() {
    for (index, configuration) in [Configuration::A, Configuration::B].into_iter().enumerate() {
        let file = read(BUILT_IN_STRUCTURES[index].2).unwrap();
        let (own, library) = (file.structure, paper::structure(configuration, 1).unwrap());
        assert_eq!(own.mesh, library.mesh);
        assert_eq!(own.material, library.material);
        assert_eq!((own.formulation, own.inertia), (Formulation::IncompatibleModes, Inertia::Consistent));
        for (a, b) in own.joints.iter().zip(&library.joints) {
            assert_eq!((&a.name, &a.face, &a.patch, a.interface), (&b.name, &b.face, &b.patch, b.interface));
            for (a, b) in a.slips.iter().zip(&b.slips) {
                assert_eq!(a.direction, b.direction);
                let (a, b) = (a.law.as_ref().unwrap(), b.law.as_ref().unwrap());
                assert_eq!(a.force(1e-4).to_bits(), b.force(1e-4).to_bits());
            }
        }
        assert_eq!((own.joints.len(), file.loads.len(), file.outputs.len()), (4, 1, 1));
        assert!(matches!(&file.loads[0].at, Point::Nodes { direction: [0.0, 0.0, 1.0], .. }));
        assert!(file.notes.is_empty(), "{:?}", file.notes);
    }
}

const TWO_BLOCKS: &str = "\
*NODE
1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1
11,0,0,1\n12,1,0,1\n13,1,1,1\n14,0,1,1\n15,0,0,2\n16,1,0,2\n17,1,1,2\n18,0,1,2
*ELEMENT,TYPE=C3D8I,ELSET=lower\n1,1,2,3,4,5,6,7,8
*ELEMENT,TYPE=C3D8I,ELSET=upper\n2,11,12,13,14,15,16,17,18
*NSET,NSET=top of lower,GENERATE\n5,8
*NSET,NSET=bottom of upper,GENERATE\n11,14
";

const JOINED: &str = "\
[mesh]
path = 'two.inp'
[[material]]
elements = 'lower'
young = 1e6
poisson = 0.3
density = 1
[[material]]
elements = 'upper'
young = 2e6
poisson = 0.2
density = 2
[[joint]]
name = 'bolt'
face = 'bottom of upper'
patch = 'top of lower'
motion = 'node-to-node'
slip = [
  { direction = 'x', law = { kind = 'jenkins', k_t = 1e3, f_s = 1.0 } },
  { direction = [0, 2, 0], law = { kind = 'uniform', k_t = 1e3, f_s = 1.0, width = 0.5 } },
  { direction = 'z' },
]
";

/// Reads a structure file that lies beside its mesh in a folder of its own.
fn in_folder(text: &str) -> Result<StructureFile, String> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("two.inp"), TWO_BLOCKS).unwrap();
    std::fs::write(folder.path().join("s.toml"), text).unwrap();
    let root = folder.path().display().to_string() + "/";
    StructureFile::load(folder.path().join("s.toml")).map_err(|e| e.to_string().replace(&root, ""))
}

#[test]
fn an_own_mesh_with_materials_and_laws() {
    let file = in_folder(JOINED).unwrap();
    let structure = file.structure;
    assert_eq!(
        structure.materials.iter().map(|(set, m)| (set.as_str(), m.young())).collect::<Vec<_>>(),
        [("lower", 1e6), ("upper", 2e6)]
    );
    let joint = &structure.joints[0];
    assert_eq!(joint.interface, Interface::NodeToNode);
    let directions: Vec<_> = joint.slips.iter().map(|slip| slip.direction).collect();
    assert_eq!(directions, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    let forces: Vec<_> = joint.slips.iter().map(|slip| slip.law.as_ref().map(|l| l.slip_force())).collect();
    assert_eq!(forces, [Some(1.0), Some(1.0), None]);
    assert_eq!(structure.assemble().unwrap().slips().len(), 12);
    let tied = in_folder(
        &JOINED
            .replace("[[joint]]", "[[tie]]")
            .split("slip = [")
            .next()
            .unwrap()
            .replace("motion = 'node-to-node'\n", ""),
    )
    .unwrap();
    assert_eq!(tied.structure.joints[0].interface, Interface::Whole(Patch::Averaging));
    assert!(tied.structure.joints[0].slips.is_empty());
}

#[test]
fn errors_name_file_line_key_and_remedy() {
    let cases = [
        ("path = 'two.inp'", "path = 'tow.inp'", "s.toml:2:8: [mesh]: tow.inp: cannot be read"),
        (
            "elements = 'lower'",
            "elements = 'lowr'",
            "s.toml:4:12: material 1: elements = \"lowr\": there is no element set of that name; did you mean \"lower\"? The mesh has lower, upper",
        ),
        (
            "young = 1e6",
            "young = -1",
            "s.toml:5:9: material 1: young = -1 is out of range: Young's modulus must be a number from 1e-30 to 1e30",
        ),
        (
            "face = 'bottom of upper'",
            "face = 'botom of upper'",
            "s.toml:15:8: joint \"bolt\": face = \"botom of upper\": there is no node set of that name; did you mean \"bottom of upper\"?",
        ),
        ("[0, 2, 0]", "[1, 1, 0]", "s.toml:18:8: joint \"bolt\": its directions 1 and 2 are not orthogonal"),
        (
            "[0, 2, 0]",
            "[0, 0, 0]",
            "s.toml:20:17: slip 2 of joint \"bolt\": direction = [0.0, 0.0, 0.0] has no length",
        ),
        (
            "f_s = 1.0 }",
            "f_s = -1.0 }",
            "s.toml:19:65: law of slip 1 of joint \"bolt\": f_s = -1 is out of range",
        ),
        ("motion =", "moton =", "s.toml:17:1: unknown key `moton` in joint 1; did you mean `motion`?"),
        (
            "'node-to-node'",
            "'nodes'",
            "s.toml:17:10: joint \"bolt\": motion = \"nodes\" is not known; choose one of rigid, averaging, node-to-node",
        ),
        (
            "patch = 'top of lower'",
            "patch = 'bottom of upper'",
            "joint `bolt`: face and patch share the nodes 11, 12, 13, 14",
        ),
        ("name = 'bolt'", "name = ''", "s.toml:14:8: joint 1: name is empty"),
        (
            "[[joint]]",
            "[[set]]\nkind = 'nodes'\nname = 'a'\nnumbers = [1, 99]\n[[joint]]",
            "s.toml:16:11: set \"a\": there is no node 99 in the mesh",
        ),
        (
            "[[joint]]",
            "[[set]]\nkind = 'nodes'\nname = 'top of lower'\nnumbers = [1]\n[[joint]]",
            "there is a set of this name already",
        ),
        (
            "[[joint]]",
            "[[set]]\nkind = 'box'\nname = 'a'\nlow = [5, 5, 5]\nhigh = [6, 6, 6]\n[[joint]]",
            "there is no node between",
        ),
    ];
    for (from, to, expected) in cases {
        let text = JOINED.replace(from, to);
        assert_ne!(text, JOINED);
        let error = in_folder(&text).unwrap_err();
        assert!(error.contains(expected), "{error}\n{expected}");
    }
    let loose = in_folder(JOINED.split("[[joint]]").next().unwrap()).unwrap_err();
    assert!(loose.starts_with("s.toml: the structure cannot be computed with:\nthe part of 1 elements around element 2 is connected with nothing; its node 11 is at the place of node 5: merge"), "{loose}");
    let bare =
        JOINED.replacen("[[material]]\nelements = 'lower'\nyoung = 1e6\npoisson = 0.3\ndensity = 1\n", "", 1);
    let bare = in_folder(&bare).unwrap_err();
    assert!(
        bare.contains("1 elements have no material, the first is element 1; add a [[material]] without"),
        "{bare}"
    );
}

#[test]
fn generated_meshes_are_kept_within_reason() {
    let text = BUILT_IN_STRUCTURES[0].2.replace("refinement = 1 ", "refinement = 100 ");
    assert!(read(&text).unwrap_err().contains("refinement would give 662000000 elements"));
}
