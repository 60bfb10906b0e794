//! Any bytes as Nastran bulk data: an error or a sound mesh, never a panic.
#![no_main]

use iwan_fem::mesh::read_bytes;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(file) = read_bytes("fuzz.bdf".as_ref(), bytes) {
        let nodes = file.mesh.positions.len();
        assert!(file.mesh.elements.iter().flat_map(|e| &e.nodes).all(|n| *n < nodes));
    }
});
