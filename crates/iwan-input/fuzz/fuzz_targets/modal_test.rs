//! Any text as the table of a modal test: an error or a sound table, never a panic.
#![no_main]

use iwan_input::{InputText, ModalTable};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    if let Ok(table) = ModalTable::parse(&InputText::built_in("fuzz.toml", text)) {
        assert!(table.channels.iter().all(|c| c.scale.is_finite() && c.scale != 0.0));
        let known = |name: &String| table.points.iter().any(|p| p.name == *name);
        assert!(table.lines.iter().flatten().all(known));
    }
});
