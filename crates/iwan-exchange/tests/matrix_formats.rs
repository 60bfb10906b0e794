//! One matrix, written in every format, is read as the same matrix.
#![allow(clippy::unwrap_used)]

use crate::common;
use crate::common::{ORDER, abaqus_substructure, files, labels, lower};
use iwan_exchange::{Component, Label, read_bytes, read_rows};
use std::path::Path;

#[test]
fn every_format_is_one_matrix() {
    let files = files();
    assert_eq!(files.len(), 55);
    for (name, bytes) in files {
        let matrices = read_bytes(Path::new(&name), &bytes, None).unwrap();
        assert_eq!(matrices.len(), 1, "{name}");
        let matrix = &matrices[0];
        assert_eq!((matrix.rows, matrix.columns), (ORDER, ORDER), "{name}");
        assert_eq!(matrix.lower_triangle(0.0).unwrap(), lower(), "{name}");
        if let Some(found) = &matrix.labels {
            // A generalised coordinate has no number in netCDF: it is called after its row.
            let same = |(row, (a, b)): (usize, (&Label, &Label))| {
                a == b
                    || (a.component == Component::Scalar
                        && a.node == row as u64 + 1
                        && b.component == Component::Scalar)
            };
            assert!(found.iter().zip(&labels()).enumerate().all(same), "{name}");
        }
    }
}

#[test]
fn names_and_labels_come_along() {
    let of = |wanted: &str| {
        let (name, bytes) = files().into_iter().find(|(name, _)| name == wanted).unwrap();
        read_bytes(Path::new(&name), &bytes, None).unwrap().remove(0)
    };
    assert_eq!(of("text-Packed-false.op4").name, "KAA");
    assert_eq!(of("binary-BigMat-true-true-8.op4").name, "KAA");
    assert_eq!(of("true-true-false.mat").name, "K");
    assert_eq!(of("Kaa.m").name, "Kaa");
    assert_eq!(of("large.pch").labels.unwrap()[5].to_string(), "node 10 component 6");
    assert!(of("input-all.mtx").labels.is_some() && of("csr.npz").labels.is_none());
}

#[test]
fn a_substructure_of_abaqus_has_the_nodes_of_its_comment() {
    let matrix = read_bytes(Path::new("z.mtx"), abaqus_substructure().as_bytes(), None).unwrap().remove(0);
    assert_eq!(matrix.name, "STIFFNESS");
    assert_eq!(matrix.labels.as_deref(), Some(&labels()[..6]));
    let expected: Vec<_> = lower().into_iter().filter(|e| e.0 < 6).collect();
    assert_eq!(matrix.lower_triangle(0.0).unwrap(), expected);
}

#[test]
fn several_matrices_in_one_file() {
    let text = common::op4_text(common::Layout::Dense, false);
    let both = format!("{text}{}", text.replace("KAA ", "MAA "));
    let names: Vec<_> =
        read_bytes(Path::new("a.op4"), both.as_bytes(), None).unwrap().into_iter().map(|m| m.name).collect();
    assert_eq!(names, ["KAA", "MAA"]);
    let text = common::dmig("large");
    let both = format!("GRID,1\n{text}{}ENDDATA\n", text.replace("KAAX", "MAAX"));
    let names: Vec<_> =
        read_bytes(Path::new("a.bdf"), both.as_bytes(), None).unwrap().into_iter().map(|m| m.name).collect();
    assert_eq!(names, ["KAAX", "MAAX"]);
}

#[test]
fn row_maps_of_three_programs_are_one() {
    let folder = tempfolder();
    let write = |name: &str, text: &str| {
        let path = folder.join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let expected = &labels()[..6];
    let plain = write("rows.csv", "node, component\n# a comment\n3,1\n3,2\n3,z\n10,x\n10,2\n10,rz\n");
    assert_eq!(read_rows(plain, None).unwrap(), expected);
    let calculix = write("k.dof", "3.1\n3.2\n3.3\n10.1\n10.2\n10.6\n");
    assert_eq!(read_rows(calculix, None).unwrap(), expected);
    let map = "x = zeros(18, 1);\nx(1) = 1;\nx(2) = 2;\nx(3) = 3;\nx(10) = 4;\nx(11) = 5;\nx(15) = 6;\n";
    let map = write("ASetMap.m", map);
    let numbers = write("gid.m", "x = zeros(2, 1);\nx(1) = 3;\nx(2) = 10;\n");
    assert_eq!(read_rows(map, Some(&numbers)).unwrap(), expected);
    std::fs::remove_dir_all(folder).unwrap();
}

fn tempfolder() -> std::path::PathBuf {
    let folder = std::env::temp_dir().join(format!("iwan-exchange-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}
