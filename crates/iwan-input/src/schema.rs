//! A shipped JSON Schema beside the keys that a reader knows, for the tests of both readers.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use serde_json::Value;
use toml::de::{DeTable, DeValue};

use crate::section::TableKind;

/// A JSON Schema.
pub(crate) struct Schema(Value);

impl Schema {
    pub(crate) fn new(text: &str) -> Self {
        Self(serde_json::from_str(text).unwrap())
    }

    pub(crate) fn validator(&self) -> jsonschema::Validator {
        jsonschema::validator_for(&self.0).unwrap()
    }

    /// The table at a place of the schema has these keys and no others.
    pub(crate) fn has(&self, pointer: &str, keys: &[&str]) {
        let properties = self.0.pointer(pointer).and_then(Value::as_object).unwrap();
        let (mut there, mut known): (Vec<&str>, _) =
            (properties.keys().map(String::as_str).collect(), keys.to_vec());
        there.sort_unstable();
        known.sort_unstable();
        assert_eq!(there, known, "{pointer}");
    }

    /// A table whose key `tells` names its kind has these kinds, each with its own keys.
    pub(crate) fn has_kinds(&self, table: &str, tells: &str, kinds: &[TableKind]) {
        let variants = self.0.pointer(&format!("/$defs/{table}/oneOf")).and_then(Value::as_array).unwrap();
        assert_eq!(variants.len(), kinds.len());
        for (n, kind) in kinds.iter().enumerate() {
            assert_eq!(variants[n]["properties"][tells]["const"], kind.name);
            let keys: Vec<_> = [tells].iter().chain(kind.keys).copied().collect();
            self.has(&format!("/$defs/{table}/oneOf/{n}/properties"), &keys);
        }
    }
}

/// An input file in the form that a schema's validator takes.
pub(crate) fn as_json(text: &str) -> Value {
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
