//! Running the program in a folder of its own.
#![allow(
    dead_code,
    unreachable_pub,
    clippy::format_push_string,
    clippy::unwrap_used,
    reason = "each test file uses its part; tests may panic"
)]

pub mod universal;

use std::path::Path;
use std::process::Output;

use assert_cmd::Command;
use tempfile::TempDir;

/// A scenario that runs in a moment.
pub const SMALL: &str = r#"
[[mode]]
name = "bending 1"
frequency = 124.0
damping_ratio = 2.5e-4
joint = { k_t = 4.45e4, f_s = 239.4, chi = -0.183, beta = 0.3 }
shape_at_force = 1.0
outputs = { tip = 23.5 }

[[mode]]
name = "linear"
frequency = 300.0
damping_ratio = 0.01
outputs = { tip = 20.0, root = 1.0 }

[force]
kind = "haversine"
amplitude = 4000.0
duration = 1.6e-3

[time]
step = 1.0e-4
duration = 0.1

[method]
kind = "newmark"
joint = "sliders"
sliders = 50
"#;

/// A folder with `scenario.toml`, empty otherwise.
pub fn folder(scenario: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("in.toml"), scenario).unwrap();
    folder
}

/// Runs `iwan` with arguments separated by spaces.
pub fn iwan(folder: &Path, arguments: &str) -> Output {
    Command::new(assert_cmd::cargo::cargo_bin!("iwan"))
        .args(arguments.split_whitespace())
        .env("COLUMNS", "100")
        .current_dir(folder)
        .output()
        .unwrap()
}

/// Exit code, stdout and stderr in one text.
pub fn shown(output: &Output) -> String {
    let [out, err] = [&output.stdout, &output.stderr].map(|b| String::from_utf8_lossy(b).into_owned());
    format!("exit code: {}\n--- stdout\n{out}--- stderr\n{err}", output.status.code().unwrap_or(-1))
}

/// Names in a folder, sorted.
pub fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// The columns of a CSV file.
pub fn csv(path: &Path) -> Vec<(String, Vec<f64>)> {
    let table = iwan_io::read_table(path).unwrap();
    table.names().iter().cloned().zip(table.columns().iter().cloned()).collect()
}

/// A ring-down as text: `frequency` in Hz, damping ratio, amplitude and start time of each mode, columns of text.
pub fn ring_down(
    rate: f64,
    samples: usize,
    modes: &[(f64, f64, f64)],
    shapes: &[&[f64]],
    names: &str,
) -> String {
    let mut text = format!("t,{names}\n");
    for n in 0..samples {
        let t = n as f64 / rate;
        let one = |(f, zeta, a): &(f64, f64, f64)| {
            let omega = std::f64::consts::TAU * f;
            a * (-zeta * omega * t).exp() * (omega * (1.0 - zeta * zeta).sqrt() * t).cos()
        };
        let values: Vec<f64> = modes.iter().map(one).collect();
        let channel = |shape: &&[f64]| shape.iter().zip(&values).map(|(p, q)| p * q).sum::<f64>().to_string();
        let channels: Vec<String> = shapes.iter().map(channel).collect();
        text += &format!("{t},{}\n", channels.join(","));
    }
    text
}
