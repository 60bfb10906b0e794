//! The shipped JSON Schema and the reader agree: they know the same keys, and accept and refuse the same files.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use serde_json::Value;
use toml::de::{DeTable, DeValue};

use super::file::KEYS;
use super::{
    BUILT_IN_STRUCTURES, STRUCTURE_SCHEMA, StructureFile, ends, given, joints, materials, meshes, sets,
};
use crate::section::TableKind;
use crate::text::InputText;
use crate::written_law::LAWS;

fn schema() -> Value {
    serde_json::from_str(STRUCTURE_SCHEMA).unwrap()
}

fn keys_at(pointer: &str) -> Vec<String> {
    let schema = schema();
    let properties = schema.pointer(pointer).and_then(Value::as_object).unwrap();
    properties.keys().cloned().collect()
}

fn same(mut a: Vec<String>, b: &[&str]) {
    let mut b: Vec<String> = b.iter().map(ToString::to_string).collect();
    a.sort();
    b.sort();
    assert_eq!(a, b);
}

#[test]
fn plain_tables_have_the_same_keys() {
    same(keys_at("/properties"), KEYS);
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
        same(keys_at(&format!("/$defs/{table}/properties")), keys);
    }
}

#[test]
fn every_kind_has_the_same_keys() {
    let tables: [(&str, &[TableKind]); 3] = [("mesh", meshes::KINDS), ("set", sets::KINDS), ("law", LAWS)];
    for (table, kinds) in tables {
        let schema = schema();
        let variants = schema.pointer(&format!("/$defs/{table}/oneOf")).and_then(Value::as_array).unwrap();
        assert_eq!(variants.len(), kinds.len());
        for (n, kind) in kinds.iter().enumerate() {
            assert_eq!(variants[n]["properties"]["kind"]["const"], kind.name);
            let keys: Vec<_> = ["kind"].iter().chain(kind.keys).copied().collect();
            same(keys_at(&format!("/$defs/{table}/oneOf/{n}/properties")), &keys);
        }
    }
}

/// A structure file in the form that the schema's validator takes.
fn as_json(text: &str) -> Value {
    fn convert(value: &DeValue<'_>) -> Value {
        match value {
            DeValue::String(s) => s.as_ref().into(),
            DeValue::Integer(i) => i.as_str().parse::<i64>().unwrap().into(),
            DeValue::Float(f) => f.as_str().parse::<f64>().unwrap().into(),
            DeValue::Boolean(b) => (*b).into(),
            DeValue::Array(a) => a.iter().map(|v| convert(v.get_ref())).collect(),
            DeValue::Table(t) => {
                t.iter().map(|(k, v)| (k.get_ref().to_string(), convert(v.get_ref()))).collect()
            }
            DeValue::Datetime(d) => d.to_string().into(),
        }
    }
    let table = DeTable::parse(text).unwrap();
    table.get_ref().iter().map(|(k, v)| (k.get_ref().to_string(), convert(v.get_ref()))).collect()
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
    let validator = jsonschema::validator_for(&schema()).unwrap();
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
    let validator = jsonschema::validator_for(&schema()).unwrap();
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
