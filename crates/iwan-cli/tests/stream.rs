//! Responses that are written as they are computed: the same files, in memory that does not grow with them.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::path::Path;

use serde_json::Value;

use crate::common::{SMALL, folder, iwan, shown};

fn run(place: &Path, arguments: &str) -> Value {
    let output = iwan(place, &format!("simulate {arguments} --quiet --json"));
    assert_eq!(output.status.code(), Some(0), "{arguments}: {}", shown(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn bytes(place: &Path, file: &str) -> Vec<u8> {
    std::fs::read(place.join(file)).unwrap()
}

/// Both summaries say the same but for the time that it took, errors to rounding.
fn agree(whole: &Value, stream: &Value, path: &str) {
    match (whole, stream) {
        (Value::Object(a), Value::Object(b)) => {
            assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>(), "{path}");
            for (key, value) in a.iter().filter(|(key, _)| *key != "seconds" && *key != "folder") {
                agree(value, &b[key], &format!("{path}.{key}"));
            }
        }
        (Value::Array(a), Value::Array(b)) => {
            assert_eq!(a.len(), b.len(), "{path}");
            a.iter().zip(b).enumerate().for_each(|(i, (a, b))| agree(a, b, &format!("{path}[{i}]")));
        }
        (Value::Number(a), Value::Number(b)) => {
            let [a, b] = [a, b].map(|x| x.as_f64().unwrap());
            // What rounding leaves of the energy is of no size of its own; other errors are relative to the peak.
            let residue = path.ends_with("energy_error") || path.ends_with("residual");
            let rounding = if residue { 1e-10 } else { 1e-12 * f64::from(path.ends_with("_error")) };
            assert!((a - b).abs() <= (1e-9 * a.abs()).max(rounding), "{path}: {a} {b}");
        }
        (a, b) => assert_eq!(a, b, "{path}"),
    }
}

/// Three stretches and a bit of modes with parts, a mode by its curves, a linear one and both kinds of joints.
#[test]
fn a_stream_is_the_response_bit_by_bit() {
    let more = "\n[[mode]]\nname = \"damped\"\nfrequency = 200.0\nparts = [{ law = \"power-damping\", c = 3.0, n = 2.0 }]\n\
        [[mode]]\nname = \"measured\"\n\
        curves = { amplitude = [1e-6, 1e-2], frequency = [80.0, 79.0], damping_ratio = [0.001, 0.002], extrapolate = true }\n";
    let place = folder(&(SMALL.replace("\n[force]", &format!("{more}\n[force]"))));
    let line = |n: u32| format!("{},{}", 7e-5 * f64::from(n), n * n % 23);
    let force = (0..400).map(line).collect::<Vec<_>>().join("\n");
    std::fs::write(place.path().join("force.csv"), format!("t,f\n{force}")).unwrap();
    let filed = SMALL.replace(
        "kind = \"haversine\"\namplitude = 4000.0\nduration = 1.6e-3",
        "kind = \"file\"\npath = \"force.csv\"",
    );
    std::fs::write(place.path().join("filed.toml"), filed).unwrap();
    let sine = SMALL.replace(
        "kind = \"haversine\"\namplitude = 4000.0\nduration = 1.6e-3",
        "kind = \"sine\"\namplitude = 9.0\nfrequency = 90.0",
    );
    std::fs::write(place.path().join("sine.toml"), sine).unwrap();
    let step = SMALL.replace(
        "kind = \"haversine\"\namplitude = 4000.0\nduration = 1.6e-3",
        "kind = \"step\"\namplitude = 9.0\nduration = 0.7000137",
    );
    std::fs::write(place.path().join("step.toml"), step).unwrap();
    let runs = [
        "in.toml --step 1e-5 --duration 2.10007",
        "filed.toml --step 1e-5 --duration 0.70001",
        "sine.toml --step 1e-5 --duration 0.9 --joint continuum",
        // Stops between two steps, in the second stretch.
        "step.toml --step 1e-5 --duration 1.1",
        "in.toml --step 1e-4 --duration 3e-4",
    ];
    for (n, arguments) in runs.iter().enumerate() {
        let whole = run(place.path(), &format!("{arguments} --out whole{n}"));
        let stream = run(place.path(), &format!("{arguments} --stream --out stream{n}"));
        agree(&whole, &stream, arguments);
        for file in ["response.csv", "scenario.toml"] {
            let [a, b] = ["whole", "stream"].map(|from| bytes(place.path(), &format!("{from}{n}/{file}")));
            assert!(a == b, "{arguments}: {file}");
        }
    }
    let page = String::from_utf8(bytes(place.path(), "stream0/report.html")).unwrap();
    assert!(
        page.contains("Displacement at tip") && page.contains("as it was computed") && page.contains("<svg")
    );
}

#[test]
fn every_other_format_and_every_seventh_sample() {
    let place = folder(SMALL);
    let arguments = "in.toml --step 1e-5 --duration 0.70003 --every 7";
    for format in ["csv", "npz", "parquet"] {
        run(place.path(), &format!("{arguments} --format {format} --out whole-{format}"));
        run(place.path(), &format!("{arguments} --format {format} --stream --out stream-{format}"));
        let [a, b] =
            ["whole", "stream"].map(|of| bytes(place.path(), &format!("{of}-{format}/response.{format}")));
        assert!(a == b, "{format}");
        assert_eq!(std::fs::read_dir(place.path().join(format!("stream-{format}"))).unwrap().count(), 4);
    }
    let text = String::from_utf8(bytes(place.path(), "stream-csv/response.csv")).unwrap();
    let times: Vec<&str> = text.lines().skip(1).map(|line| line.split(',').next().unwrap()).collect();
    assert_eq!(
        (times.len(), times[0], times[1]),
        (70_004_usize.div_ceil(7), "0.0", "0.00007000000000000001")
    );
}

/// Ten million steps of two modes are 640 MB of samples.
#[cfg(unix)]
#[test]
fn memory_does_not_grow_with_the_response() {
    let place = folder(SMALL);
    let program = assert_cmd::cargo::cargo_bin!("iwan").display().to_string();
    let bounded = |options: &str| {
        let arguments =
            format!("simulate in.toml --step 1e-5 --duration 100 --threads 1 --quiet --json {options}");
        // The program, its libraries and what threads reserve take some 150 MB of addresses.
        let line = format!("ulimit -v 300000; exec {program} {arguments}");
        let mut command = assert_cmd::Command::new("sh");
        command.args(["-c", &line]).current_dir(place.path()).output().unwrap()
    };
    let output = bounded("--stream --every 1000 --out out");
    assert_eq!(output.status.code(), Some(0), "{}", shown(&output));
    assert_eq!(bounded("--every 1000 --out whole").status.code(), Some(1));
}

#[test]
fn what_cannot_be_streamed_is_refused_by_name() {
    let place = folder(SMALL);
    let refused = |arguments: &str, said: &str| {
        let output = iwan(place.path(), &format!("simulate {arguments} --stream --out out"));
        let text = shown(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments}: {text}");
        assert!(text.contains(said), "{text}");
        assert!(!place.path().join("out").exists());
    };
    refused("in.toml --method half-cycle", "newmark");
    refused("in.toml --method event", "newmark");
    refused("in.toml --every 0", "--every");
    let beam =
        "[structure]\nfile = \"paper-a\"\n[force]\nkind = \"none\"\n[time]\nstep = 1e-5\nduration = 1e-3\n";
    std::fs::write(place.path().join("beam.toml"), beam).unwrap();
    refused("beam.toml", "[structure]");
}
