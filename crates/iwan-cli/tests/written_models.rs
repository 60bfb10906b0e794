//! `iwan modes --write-matrices` and `--write-reduced`: what is written opens again.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::path::Path;

use crate::common::{folder, iwan, shown};
use serde_json::Value;

fn json(output: &std::process::Output) -> Value {
    assert!(output.status.success(), "{}", shown(output));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

fn read(place: &Path, name: &str) -> Vec<u8> {
    std::fs::read(place.join(name)).unwrap()
}

const BLOW: &str = "[force]\nkind = \"haversine\"\namplitude = 100.0\nduration = 1.6e-3\n\
                    [time]\nstep = 1e-5\nduration = 0.01\n";

/// A reduced model that was written and opened again gives the same bits as the one that was reduced for the run.
#[test]
fn a_reduced_model_opens_again_with_the_same_bits() {
    let place = folder("");
    json(&iwan(place.path(), "modes --json --quiet --out models/r --write-reduced 30"));
    let once = format!("[structure]\nname = \"paper-a\"\nbasis = 30\nframes = 2\n{BLOW}");
    let again = format!("[structure]\nreduced = \"models/r\"\nframes = 2\n{BLOW}");
    std::fs::write(place.path().join("once.toml"), once).unwrap();
    std::fs::write(place.path().join("again.toml"), again).unwrap();
    json(&iwan(place.path(), "simulate once.toml --json --quiet --out once"));
    json(&iwan(place.path(), "simulate again.toml --json --quiet --out again"));
    for file in ["response.csv", "frame-1.vtu"] {
        assert!(
            read(place.path(), &format!("once/{file}")) == read(place.path(), &format!("again/{file}")),
            "{file}"
        );
    }
    // The scenario that is written beside the response runs from its own folder.
    json(&iwan(&place.path().join("again"), "simulate scenario.toml --json --quiet --out ../third"));
    assert!(read(place.path(), "once/response.csv") == read(place.path(), "third/response.csv"));
    let first = json(&iwan(place.path(), "modes --json --quiet --out f --count 8"));
    let opened = json(&iwan(place.path(), "modes models/r --json --quiet --out g --count 8"));
    for (a, b) in numbers(&first["stuck"]).into_iter().zip(numbers(&opened["stuck"])) {
        assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
    }
}

/// A folder whose structure has changed, or that is damaged, is refused with what helps.
#[test]
fn a_reduced_model_of_another_structure_is_refused() {
    let place = folder("");
    json(&iwan(place.path(), "modes --json --quiet --out r --write-reduced 10"));
    std::fs::write(place.path().join("s.toml"), format!("[structure]\nreduced = \"r\"\n{BLOW}")).unwrap();
    let refused = |expected: &str| {
        let output = iwan(place.path(), "simulate s.toml --quiet --out out");
        let text = shown(&output);
        assert!(!output.status.success() && text.contains(expected), "{text}");
        assert!(text.contains("--write-reduced"), "{text}");
        assert!(!place.path().join("out").exists());
    };
    let file = |name: &str| place.path().join("r").join(name);
    let text = std::fs::read_to_string(file("reduced-structure.toml")).unwrap();
    let young = text.find("young").unwrap();
    let line = &text[young..young + text[young..].find('\n').unwrap()];
    std::fs::write(file("reduced-structure.toml"), text.replace(line, "young = 2.0e7")).unwrap();
    refused("a material, a matrix, or the K_T of a joint has changed");
    std::fs::write(file("reduced-structure.toml"), &text).unwrap();
    let arrays = std::fs::read(file("reduced.npz")).unwrap();
    std::fs::write(file("reduced.npz"), &arrays[..arrays.len() / 2]).unwrap();
    refused("reduced.npz");
    std::fs::write(file("reduced.npz"), &arrays).unwrap();
    let table = std::fs::read_to_string(file("reduced.toml")).unwrap();
    std::fs::write(file("reduced.toml"), table.replace("zero_modes = [6", "zero_modes = [999")).unwrap();
    refused("zero_modes has 999");
    std::fs::write(file("reduced.toml"), table.replace("format = 1", "format = 2")).unwrap();
    refused("format must be 1");
}

/// Matrices in each format are read again, and have the frequencies of the structure.
#[test]
fn written_matrices_have_the_same_frequencies() {
    let place = folder("");
    let first = json(&iwan(place.path(), "modes --json --quiet --out mtx --count 10 --write-matrices"));
    json(&iwan(place.path(), "modes --json --quiet --out npz --count 10 --write-matrices=npz"));
    json(&iwan(place.path(), "modes --json --quiet --out mat --count 10 --write-matrices=mat"));
    let expected = numbers(&first["stuck"]);
    for (folder, stiffness, mass) in [
        ("mtx", "stuck_stiffness.mtx'", "mass.mtx'"),
        ("npz", "stuck_stiffness.npz'", "mass.npz'"),
        ("mat", "matrices.mat'\nstiffness_name = 'K0'", "matrices.mat'"),
    ] {
        let text = format!(
            "[matrices]\nstiffness = '{folder}/{stiffness}\nmass = '{folder}/{mass}\nrows = '{folder}/rows.csv'\n\
             coordinates = '{folder}/nodes.csv'\n"
        );
        std::fs::write(place.path().join("again.toml"), text).unwrap();
        let again = json(&iwan(
            place.path(),
            &format!("modes again.toml --json --quiet --out again-{folder} --count 10"),
        ));
        for (a, b) in expected.iter().zip(numbers(&again["stuck"])) {
            assert!((a / b - 1.0).abs() < 1e-8, "{folder}: {a} {b}");
        }
        assert_eq!(again["zero_modes"]["stuck"], 6);
    }
}
