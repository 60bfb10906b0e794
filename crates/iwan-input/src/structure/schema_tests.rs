//! The shipped JSON Schema and the reader agree: they know the same keys, and accept and refuse the same files.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use super::file::KEYS;
use super::{
    BUILT_IN_STRUCTURES, STRUCTURE_SCHEMA, StructureFile, ends, given, joints, materials, meshes, sets,
};
use crate::schema::{Schema, as_json};
use crate::section::TableKind;
use crate::text::InputText;
use crate::written_law::LAWS;

fn schema() -> Schema {
    Schema::new(STRUCTURE_SCHEMA)
}

#[test]
fn plain_tables_have_the_same_keys() {
    schema().has("/properties", KEYS);
    let tables = [
        ("matrices", given::MATRICES_KEYS),
        ("elements", materials::ELEMENT_KEYS),
        ("material", materials::MATERIAL_KEYS),
        ("joint", joints::JOINT_KEYS),
        ("tie", joints::TIE_KEYS),
        ("slip", joints::SLIP_KEYS),
        ("support", ends::SUPPORT_KEYS),
        ("lump", ends::LUMP_KEYS),
        ("load", ends::LOAD_KEYS),
        ("output", ends::OUTPUT_KEYS),
    ];
    for (table, keys) in tables {
        schema().has(&format!("/$defs/{table}/properties"), keys);
    }
}

#[test]
fn every_kind_has_the_same_keys() {
    let tables: [(&str, &[TableKind]); 3] = [("mesh", meshes::KINDS), ("set", sets::KINDS), ("law", LAWS)];
    for (table, kinds) in tables {
        schema().has_kinds(table, "kind", kinds);
    }
}

const GOOD: &str = "\
[mesh]
kind = 'block'
size = [4, 1, 1.0]
cells = [4, 1, 1]
[[set]]
kind = 'box'
name = 'root'
low = [0, 0, 0]
high = [0, 1, 1]
[[set]]
kind = 'nodes'
name = 'corner'
numbers = [1]
[[material]]
young = 1e6
poisson = 0.3
density = 1
[[support]]
name = 'wall'
nodes = 'root'
fixed = ['x', 'y', 'z']
[[load]]
name = 'push'
nodes = 'corner'
direction = [0, 0, 1]
[[output]]
name = 'corner'
nodes = 'corner'
direction = '-z'
";

fn read(text: &str) -> Result<StructureFile, crate::InputError> {
    StructureFile::read(&InputText::built_in("test.toml", text))
}

#[test]
fn shipped_and_other_good_files_are_valid() {
    let validator = schema().validator();
    let variants = [
        ("density = 1", "density = 1\n[elements]\nformulation = 'displacement'\nmass = 'lumped'"),
        ("young = 1e6", "elements = 'block'\nyoung = 1e6"),
        (
            "[[load]]",
            "[[lump]]\nname = 'tip mass'\nnodes = 'corner'\nmass = 2.5\nstiffness = [0, 0, 1e3]\n[[load]]",
        ),
        ("direction = [0, 0, 1]", "direction = [0, 0, 1]\nfactor = -2"),
        (
            "kind = 'nodes'\nname = 'corner'",
            "kind = 'elements'\nname = 'some'\nnumbers = [2, 3]\n[[set]]\nkind = 'nodes'\nname = 'corner'",
        ),
    ];
    let texts = BUILT_IN_STRUCTURES.iter().map(|b| b.2.to_string());
    for text in texts.chain([GOOD.to_string()]).chain(variants.map(|(from, to)| GOOD.replace(from, to))) {
        let errors: Vec<_> = validator.iter_errors(&as_json(&text)).map(|e| e.to_string()).collect();
        assert!(errors.is_empty(), "{errors:?}\n{text}");
        read(&text).unwrap();
    }
}

#[test]
fn what_the_schema_refuses_the_reader_refuses() {
    let validator = schema().validator();
    let bad = [
        ("kind = 'block'", "kind = 'brick'"),
        ("kind = 'block'", "kind = 'block'\npath = 'a.msh'"),
        ("size = [4, 1, 1.0]", "size = [4, 1]"),
        ("size = [4, 1, 1.0]", "size = [4, -1, 1]"),
        ("cells = [4, 1, 1]", "cells = [4, 0, 1]"),
        ("cells = [4, 1, 1]", "cells = [4, 1.5, 1]"),
        ("young = 1e6", "young = 0"),
        ("poisson = 0.3", "poisson = 0.5"),
        ("density = 1", "density = 1\nname = 'steel'"),
        ("fixed = ['x', 'y', 'z']", "fixed = ['w']"),
        ("fixed = ['x', 'y', 'z']", "fixed = []"),
        ("direction = '-z'", "direction = 'up'"),
        ("direction = '-z'", "direction = [0, 0, 0]"),
        ("direction = '-z'\n", ""),
        ("name = 'push'", "name = ''"),
        ("[[load]]", "[[lod]]"),
    ];
    for (from, to) in bad {
        let text = GOOD.replace(from, to);
        assert!(text != GOOD && !validator.is_valid(&as_json(&text)), "{text}");
        assert!(read(&text).is_err(), "{text}");
    }
}
