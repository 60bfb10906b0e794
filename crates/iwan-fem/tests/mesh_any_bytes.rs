//! No bytes make a mesh reader panic or ask for more memory than it states, and a mesh that it accepts is sound.
#![allow(clippy::unwrap_used)]
#![allow(clippy::format_collect, reason = "files of the tests are short")]

use crate::common::{CORNERS, Encoding, GMSH_EDGES, GMSH_TET_EDGES, Msh, hex20, inp, tet10};
use iwan_fem::mesh::read_bytes;
use proptest::prelude::*;
use std::path::Path;

/// The statement of [`iwan_fem::mesh::read`] about its memory.
const BYTES_PER_BYTE: u64 = 160;
const BYTES_AT_LEAST: u64 = 64 << 10;

fn seeds() -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("a.msh", Msh::block(Encoding::Ascii, &CORNERS, 5).bytes),
        ("a.msh", Msh::block(Encoding::Ascii, &hex20(&GMSH_EDGES), 17).bytes),
        ("a.msh", Msh::block(Encoding::Little, &CORNERS, 5).bytes),
        ("a.msh", Msh::block(Encoding::Big, &hex20(&GMSH_EDGES), 17).bytes),
        ("a.msh", Msh::block_two(Encoding::Ascii, &tet10(&GMSH_TET_EDGES), 11).bytes),
        ("a.msh", Msh::block_two(Encoding::Little, &CORNERS, 5).bytes),
        ("a.inp", inp().into_bytes()),
        ("a.inp", include_bytes!("../../../tests/peers/decks/rigid.inp").to_vec()),
        ("a.inp", PARTS.as_bytes().to_vec()),
        ("a.bdf", BULK.as_bytes().to_vec()),
    ]
}

const PARTS: &str = "*PART, NAME=P\n*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT,TYPE=C3D4,ELSET=B\n1,1,2,3,4\n*SURFACE,NAME=S\nB,S1\n\
    *END PART\n*INSTANCE,NAME=I,PART=P\n*END INSTANCE\n*INSTANCE,NAME=J,PART=P\n0,0,-0.01\n0,0,0,0,0,1,9\n*END INSTANCE\n\
    *NODE,NSET=R\n1,0,0,2\n*TIE,NAME=T\nI.S,J.S\n*COUPLING,REF NODE=R,SURFACE=I.S\n*DISTRIBUTING\n*MPC\nBEAM,I.4,J.4\n*EQUATION\n2\n\
    I.2,1,1.,J.2,1,-1.\n*RIGID BODY,REF NODE=R,ELSET=J.B\n*BOUNDARY\nJ.1,1,3\nR,ENCASTRE\n";
const BULK: &str = "SPC=4\nBEGIN BULK\nCORD2C,2,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nGRID,1,2,1.,90.,0.,2,3\nGRID           2              0.      0.      0.\n\
    GRID*                  3                         1.0+0              0.0\n*                    0.0\nGRID,4,,0.,0.,1.\nCTETRA,9,7,1,2,3,4\nPSOLID,7,8\n\
    MAT1,8,2.8+7,,.29,7.48-4\nSPC1,4,123,1,THRU,2\nRBE2,20,4,123456,1,2\nRBE3,21,,3,123,1.,123,1,2\n,4\nMPC,1,1,1,1.,2,1,-1.\n,,3,2,.5\n\
    CONM2,22,4,,6.,1.,0.,0.\n,1.,.1,2.,.2,.3,3.\nENDDATA\n";

fn check(name: &str, bytes: &[u8]) {
    let mut outcome = None;
    let memory = allocation_counter::measure(|| outcome = Some(read_bytes(Path::new(name), bytes)));
    let allowed = BYTES_PER_BYTE * bytes.len() as u64 + BYTES_AT_LEAST;
    assert!(memory.bytes_max <= allowed, "{} bytes for a file of {}", memory.bytes_max, bytes.len());
    match outcome.unwrap() {
        Ok(file) => {
            let mesh = file.mesh;
            let (nodes, elements) = (mesh.positions.len(), mesh.elements.len());
            assert!(
                mesh.positions.iter().flatten().all(|x| x.is_finite()) && mesh.node_labels.len() == nodes
            );
            assert!(mesh.elements.iter().all(|e| e.nodes.len() == e.shape.nodes()));
            assert!(mesh.elements.iter().flat_map(|e| &e.nodes).all(|n| *n < nodes));
            let sound = |set: &Vec<usize>, below| set.is_sorted() && set.iter().all(|i| *i < below);
            assert!(mesh.node_sets.values().all(|set| sound(set, nodes)));
            assert!(mesh.element_sets.values().all(|set| sound(set, elements)));
        }
        Err(error) => {
            let text = error.to_string();
            assert!(text.starts_with(name) && text.len() < 2000, "{text}");
        }
    }
}

#[test]
fn the_seeds_are_valid() {
    for (name, bytes) in seeds() {
        read_bytes(Path::new(name), &bytes).unwrap();
    }
}

#[test]
fn every_truncation_is_survived() {
    for (name, bytes) in seeds() {
        for end in 0..bytes.len() {
            check(name, &bytes[..end]);
        }
    }
}

#[test]
fn every_byte_set_to_an_extreme_is_survived() {
    for (name, bytes) in seeds() {
        for at in 0..bytes.len() {
            for value in [0, 0x7f, 0x80, 0xff, b'9', b'-', b',', b'\n'] {
                let mut bytes = bytes.clone();
                bytes[at] = value;
                check(name, &bytes);
            }
        }
    }
}

/// Names of a file were once quoted in messages in their full length.
#[test]
fn long_names_are_shortened_in_messages() {
    let name = "N".repeat(5000);
    check("a.inp", format!("*INSTANCE,NAME=I,PART={name}\n*END INSTANCE\n").as_bytes());
    check("a.inp", format!("*NODE\n1,0,0,0\n*MPC\n{name},1,1\n").as_bytes());
}

/// Files made to use much memory: every line of a few bytes asks for as much as it can.
#[test]
fn memory_stays_within_what_is_said() {
    let nodes: String = (1..2000).fold("*NODE\n".into(), |text, label| text + &format!("{label}\n"));
    let doubling: String = (1..60).fold("*NSET,NSET=A0,GENERATE\n1,1999\n".into(), |text, n| {
        text + &format!("*NSET,NSET=A{n}\nA{0},A{0}\n", n - 1)
    });
    check("a.inp", format!("{nodes}{doubling}").as_bytes());
    check("a.inp", format!("{nodes}*NSET,NSET=A,GENERATE\n{}", "1,1999\n".repeat(3000)).as_bytes());
    check("a.inp", format!("{nodes}*NSET,NSET=A\n{}", "1,".repeat(50_000)).as_bytes());
    check("a.inp", nodes.as_bytes());
    let names: String = (0..5000).map(|n| format!("*X{n}\n")).collect();
    check("a.inp", names.as_bytes());
    let sets: String = (0..5000).map(|n| format!("*NSET,NSET={n}\n")).collect();
    check("a.inp", sets.as_bytes());
    check("a.inp", format!("*NODE{}", ",A".repeat(20_000)).as_bytes());
    check("a.inp", format!("*ELEMENT,TYPE=C3D8\n{}", "1,1,1,1,1,1,1,1,1\n".repeat(3000)).as_bytes());
    let held = format!("{nodes}*NSET,NSET=A,GENERATE\n1,1999\n*BOUNDARY\n{}", "A,1,6\n".repeat(500));
    check("a.inp", held.as_bytes());
    for tied in ["*EQUATION\n2\nA,1,1,A,2,-1\n", "*MPC\nTIE,A,A\n", "*BOUNDARY\nA,1,6\n"] {
        check("a.inp", format!("{nodes}*NSET,NSET=A,GENERATE\n1,1999\n{}", tied.repeat(300)).as_bytes());
    }
    let grids: String = (1..2000).map(|n| format!("GRID,{n}\n")).collect();
    for end in [
        "SPC1,1,123456,1,THRU,1999\n".repeat(300),
        format!("RBE2,{},1,123{}", "0".repeat(9000), ",2".repeat(5)),
    ] {
        check("a.bdf", format!("BEGIN BULK\n{grids}{end}{}", "\n,2,2,2,2,2,2,2,2".repeat(300)).as_bytes());
    }
    let start = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
    let many =
        "$Nodes\n1 3000 1 3000\n0 0 0 3000\n".to_string() + &"1\n".repeat(3000) + &"0 0 0\n".repeat(3000);
    check("a.msh", format!("{start}{many}").as_bytes());
    let groups = format!("$Entities\n0 0 0 1\n1 0 0 0 0 0 0 3000 {}0\n$EndEntities\n", "1 ".repeat(3000));
    let one = "$Nodes\n1 1 1 1\n0 0 0 1\n1\n0 0 0\n$EndNodes\n";
    let blocks = "3 1 5 1\n1 1 1 1 1 1 1 1 1\n".repeat(500);
    check("a.msh", format!("{start}{groups}{one}$Elements\n500 500 1 1\n{blocks}$EndElements\n").as_bytes());
    let entities = "$Entities\n3000 0 0 0\n".to_string()
        + &(0..3000).map(|n| format!("{n} 0 0 0 1 1\n")).collect::<String>();
    check("a.msh", format!("{start}{entities}").as_bytes());
    let sections: String = (0..3000).map(|n| format!("${n}\n$End{n}\n")).collect();
    check("a.msh", format!("{start}{sections}").as_bytes());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn mutations_are_survived(
        seed in 0..seeds().len(),
        edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..4_u8), 1..12),
    ) {
        let (name, mut bytes) = seeds().swap_remove(seed);
        for (at, value, kind) in edits {
            let at = at.index(bytes.len().max(1)).min(bytes.len().saturating_sub(1));
            match kind {
                _ if bytes.is_empty() => {}
                0 => bytes[at] = value,
                1 => bytes.insert(at, value),
                2 => { bytes.remove(at); }
                _ => bytes[at] ^= 1 << (value % 8),
            }
        }
        check(name, &bytes);
    }

    #[test]
    fn noise_is_survived(format in 0..3_usize, bytes in prop::collection::vec(any::<u8>(), 0..600)) {
        check(["a.msh", "a.inp", "a"][format], &bytes);
    }

    #[test]
    fn words_of_the_formats_in_any_order_are_survived(
        msh in any::<bool>(),
        words in prop::collection::vec(0..24_usize, 0..80),
    ) {
        const MSH: [&str; 24] = ["$Nodes\n", "$EndNodes\n", "$Elements\n", "$EndElements\n", "$Entities\n", "$EndEntities\n",
            "$PhysicalNames\n", "$EndPhysicalNames\n", "$X\n", "$EndX\n", "0 ", "1 ", "2 ", "3 ", "5 ", "17 ", "15 ", "-1 ",
            "\n", "1\n3 1 \"a\"\n", "0 0 0\n", "99999999999999999999 ", "1e3 ", "1 1 1 1\n"];
        const INP: [&str; 24] = ["*NODE", "*ELEMENT,TYPE=C3D8", "*ELEMENT,TYPE=C3D20", "*NSET", "*ELSET", ",NSET=A", ",ELSET=A",
            ",ELSET=B", ",GENERATE", ",INSTANCE=A", "\n", "\n1", "\n2", ",1", ",2", ",3", ",A", ",B", ",", "**", "*PART", "*STEP",
            ",99999999999999999999", "\n1,1,1,1,1,1,1,1,1\n"];
        let table = if msh { MSH } else { INP };
        let start = if msh { "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n" } else { "*NODE\n1,0,0,0\n" };
        let text: String = std::iter::once(start).chain(words.into_iter().map(|w| table[w])).collect();
        check(if msh { "a.msh" } else { "a.inp" }, text.as_bytes());
    }
}
