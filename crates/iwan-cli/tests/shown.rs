//! Names of files and what stands in them: harmless on the terminal, in JSON, on pages and in tables, whatever characters they hold.
#![allow(clippy::unwrap_used, reason = "tests may panic")]
#![cfg(unix)]

use std::path::Path;
use std::process::Output;

use assert_cmd::Command;

use crate::common::{SMALL, folder, ring_down, shown};
use crate::hits_of_bench::{bench, write};

/// A name that renames the window, clears the screen, in C1 as well, breaks the line and turns the direction of writing.
const HOSTILE: &str = "a\u{1b}]0;owned\u{7}\u{1b}[2J\u{9b}2J\u{7f}\u{202e}b\u{2066}";

fn run(place: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("iwan"));
    command.args(arguments).current_dir(place).output().unwrap()
}

/// Characters that a terminal obeys, or that mislead its reader.
fn harmful(text: &str) -> Option<char> {
    let turns = |c: char| ('\u{202a}'..='\u{202e}').contains(&c) || ('\u{2066}'..='\u{2069}').contains(&c);
    text.chars().find(|c| c.is_control() && !matches!(c, '\n' | '\t') || turns(*c))
}

/// Runs a command twice, with its text and with its JSON, and looks at everything it prints and writes.
fn check(place: &Path, arguments: &[&str]) -> serde_json::Value {
    let mut told = serde_json::Value::Null;
    for json in [false, true] {
        let out = if json { "out-json" } else { "out" };
        let mut all = arguments.to_vec();
        all.extend(["--out", out]);
        all.extend(json.then_some("--json"));
        let output = run(place, &all);
        assert!(output.status.success(), "{arguments:?}: {}", shown(&output));
        for bytes in [&output.stdout, &output.stderr] {
            let text = std::str::from_utf8(bytes).unwrap();
            assert_eq!(harmful(text), None, "{arguments:?}: {}", text.escape_debug());
        }
        for entry in std::fs::read_dir(place.join(out)).unwrap() {
            let path = entry.unwrap().path();
            // Pictures for ParaView hold bytes of numbers.
            if path.extension().is_none_or(|extension| extension != "vtu") {
                let text = std::fs::read_to_string(&path).unwrap();
                assert_eq!(harmful(&text), None, "{arguments:?}: {}", path.display());
            }
        }
        if json {
            told = serde_json::from_slice(&output.stdout).unwrap();
        }
        std::fs::remove_dir_all(place.join(out)).unwrap();
    }
    told
}

/// They were printed as they stood on standard output, and written so into summaries and pages.
#[test]
fn hostile_names_of_records_are_harmless() {
    let place = folder("");
    let record = ring_down(2000.0, 3000, &[(124.0, 0.005, 1.0)], &[&[1.0]], HOSTILE);
    let file = format!("{HOSTILE}\nerror: forged.csv");
    std::fs::write(place.path().join(&file), record).unwrap();
    let told = check(place.path(), &["envelope", &file]);
    let file_told = told["records"][0]["file"].as_str().or(told["record"]["file"].as_str()).unwrap();
    assert!(file_told.contains("\\nerror: forged"), "{file_told}");
    check(place.path(), &["envelope", &file, "--peaks"]);
    check(place.path(), &["fit", &file]);
}

/// A channel that an archive calls so ended `iwan modal` after the analysis: no table of shapes can have such a column.
#[test]
fn hostile_channels_of_modal_tests_are_harmless() {
    let place = folder("");
    let mut files = Vec::new();
    for (n, mut hit) in bench().hits(100.0, 2, 1).into_iter().enumerate() {
        hit.responses[2].name = HOSTILE.into();
        let name = format!("h{n}{HOSTILE}.csv");
        write(place.path(), &name, &hit);
        files.push(name);
    }
    check(place.path(), &["modal", &files[0], &files[1], "--at", "a1", "--band", "60:480"]);
}

/// A text of TOML with these characters as codes.
fn coded(text: &str) -> String {
    text.chars()
        .map(
            |c| if harmful(&c.to_string()).is_some() { format!("\\u{:04X}", u32::from(c)) } else { c.into() },
        )
        .collect()
}

#[test]
fn hostile_titles_and_files_of_scenarios_and_structures_are_harmless() {
    let place = folder("");
    let title = format!("title = \"{}\"\n", coded(HOSTILE));
    let file = format!("{HOSTILE}.toml");
    std::fs::write(place.path().join(&file), title.clone() + SMALL).unwrap();
    check(place.path(), &["simulate", &file]);
    let block = "[mesh]\nkind = \"block\"\nsize = [1.0, 0.1, 0.05]\ncells = [8, 2, 2]\n\
        [[material]]\nyoung = 2.1e11\npoisson = 0.3\ndensity = 7850.0\n";
    std::fs::write(place.path().join(&file), title + block).unwrap();
    check(place.path(), &["modes", &file, "--count", "3"]);
}

/// A name that turns the direction of writing made columns of tables that could not be told apart by eye.
#[test]
fn hostile_names_in_input_files_are_refused() {
    let place = folder("");
    for name in ["bending\u{202e}1", "bending\u{9b}1", "bending\u{7f}"] {
        for (from, what) in [("name = \"bending 1\"", "name"), ("tip =", "outputs")] {
            let to = if what == "name" {
                format!("name = \"{}\"", coded(name))
            } else {
                format!("\"{}\" =", coded(name))
            };
            std::fs::write(place.path().join("in.toml"), SMALL.replacen(from, &to, 1)).unwrap();
            let output = run(place.path(), &["simulate", "in.toml", "--out", "out", "--json"]);
            assert_eq!(output.status.code(), Some(2), "{}", shown(&output));
            for bytes in [&output.stdout, &output.stderr] {
                assert_eq!(harmful(std::str::from_utf8(bytes).unwrap()), None, "{}", shown(&output));
            }
            assert!(shown(&output).contains("readable name"), "{}", shown(&output));
        }
    }
}

/// What clap refuses was printed as it was given, and file names are given by patterns such as `*.csv`.
#[test]
fn hostile_arguments_are_harmless() {
    let place = folder("");
    for arguments in [
        vec!["envelope", &format!("--{HOSTILE}")],
        vec![HOSTILE],
        vec!["simulate", "--json", "--joint", HOSTILE],
    ] {
        let output = run(place.path(), &arguments);
        assert_eq!(output.status.code(), Some(2), "{}", shown(&output));
        for bytes in [&output.stdout, &output.stderr] {
            assert_eq!(harmful(std::str::from_utf8(bytes).unwrap()), None, "{}", shown(&output));
        }
    }
}
