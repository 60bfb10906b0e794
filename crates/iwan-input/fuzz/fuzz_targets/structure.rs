//! Any text as a structure file, alone, behind the mesh of a block, or behind two small matrices: an error or a sound structure,
//! never a panic.
#![no_main]

use std::path::PathBuf;
use std::sync::OnceLock;

use iwan_input::{InputText, StructureFile, is_structure};
use libfuzzer_sys::fuzz_target;

const BLOCK: &str = "[mesh]\nkind = 'block'\nsize = [1, 1, 2]\ncells = [1, 1, 2]\n";
const MATRICES: &str =
    "[matrices]\nstiffness = 'k.mtx'\nmass = 'm.mtx'\nrows = 'rows.csv'\ncoordinates = 'nodes.csv'\n";

/// Two brackets of two nodes each, with springs in x and y.
const FILES: [(&str, &str); 4] = [
    (
        "k.mtx",
        "%%MatrixMarket matrix coordinate real symmetric\n8 8 12\n1 1 1200\n3 1 -1000\n3 3 1000\n2 2 1700\n4 2 -1500\n\
         4 4 1500\n5 5 1000\n7 5 -1000\n7 7 1300\n6 6 1500\n8 6 -1500\n8 8 1800\n",
    ),
    (
        "m.mtx",
        "%%MatrixMarket matrix coordinate real symmetric\n8 8 8\n1 1 1\n2 2 1\n3 3 1.25\n4 4 1.25\n5 5 1.5\n6 6 1.5\n\
         7 7 1.75\n8 8 1.75\n",
    ),
    ("rows.csv", "node,component\n1,x\n1,y\n2,x\n2,y\n11,x\n11,y\n12,x\n12,y\n"),
    ("nodes.csv", "1, 0, 0, 0\n2, 1, 0, 0\n11, 1, 0, 0\n12, 2, 0, 0\n"),
];

/// A folder with the matrices, written once.
fn folder() -> &'static PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = std::env::temp_dir().join("iwan-input-fuzz");
        std::fs::create_dir_all(&folder).expect("the folder for temporary files can be written to");
        for (name, text) in FILES {
            std::fs::write(folder.join(name), text)
                .expect("the folder for temporary files can be written to");
        }
        folder
    })
}

fuzz_target!(|text: &str| {
    // No file of this machine is opened, and no large mesh made.
    let Some(rest) = text.get(1..) else { return };
    if ["/", "cells", "refinement", "paper", "\\"].iter().any(|word| rest.contains(word)) {
        return;
    }
    let head = match text.as_bytes()[0] % 3 {
        0 => "",
        1 => BLOCK,
        _ => MATRICES,
    };
    let source =
        InputText { folder: folder().clone(), ..InputText::built_in("fuzz.toml", &format!("{head}{rest}")) };
    let _ = is_structure(&source);
    if let Ok(file) = StructureFile::read(&source) {
        let nodes = file.structure.mesh.positions.len();
        assert!(file.structure.mesh.elements.iter().flat_map(|e| &e.nodes).all(|n| *n < nodes));
    }
});
