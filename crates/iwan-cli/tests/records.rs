//! What users of real data need on the way: peaks, parts of a record, several hits, units, copies.
#![allow(clippy::unwrap_used, clippy::print_stderr, reason = "tests may panic and say why")]

use std::fmt::Write;
use std::path::Path;

use crate::common::{csv, folder, iwan, names, ring_down, shown};
use serde_json::Value;

fn run(place: &Path, arguments: &str) -> Value {
    let output = iwan(place, &format!("envelope {arguments} --json --quiet"));
    assert!(output.status.success(), "{}", shown(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Exit code 2, with these words.
fn refused(place: &Path, arguments: &str, words: &[&str]) {
    let output = iwan(place, arguments);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments}: {said}");
    assert!(words.iter().all(|word| said.contains(word)), "{arguments}: {said}");
}

fn two_modes(place: &Path) {
    let modes = [(80.0, 0.002, 3.0), (220.0, 0.005, 1.0)];
    let text = ring_down(2048.0, 8192, &modes, &[&[1.0, 0.5]], "tip [m/s^2]");
    std::fs::write(place.join("two.csv"), text).unwrap();
}

/// A mode at 80 Hz, struck at 0.25, 2.25 and 4.25 s.
fn three_hits(place: &Path) {
    let mut text = "t [s],tip [m/s^2]\n".to_string();
    for n in 0..12_288 {
        let t = f64::from(n) / 2048.0;
        let wave = |at: f64, size: f64| match t - at {
            s if s < 0.0 => 0.0,
            s => size * (-s).exp() * (502.654_8 * s).sin(),
        };
        writeln!(text, "{t},{}", wave(0.25, 1.0) + wave(2.25, 3.0) + wave(4.25, 2.0)).unwrap();
    }
    std::fs::write(place.join("hits.csv"), text).unwrap();
}

#[test]
fn peaks_are_listed_with_width_and_damping() {
    let place = folder("");
    two_modes(place.path());
    let summary = run(place.path(), "two.csv --peaks --out out");
    let peaks = summary["peaks"].as_array().unwrap();
    assert_eq!(peaks.len(), 2, "{summary}");
    for (peak, (frequency, damping)) in peaks.iter().zip([(80.0, 0.002), (220.0, 0.005)]) {
        let value = |key: &str| peak[key].as_f64().unwrap();
        assert!((value("frequency") - frequency).abs() < 0.1, "{peak}");
        assert!((value("damping_ratio") / damping - 1.0).abs() < 0.05, "{peak}");
        assert!(
            (value("width") / (2.0 * damping * frequency) - 1.0).abs() < 0.8 && value("prominence") > 10.0
        );
    }
    assert_eq!(names(&place.path().join("out")), ["peaks.csv", "report.html", "summary.json"]);
    assert_eq!(csv(&place.path().join("out/peaks.csv")).len(), 5);
    let text = iwan(place.path(), "envelope two.csv --peaks --out text");
    assert!(String::from_utf8_lossy(&text.stdout).contains("--mode HZ"), "{}", shown(&text));
}

#[test]
fn a_mode_is_named_by_its_frequency_and_a_part_by_its_times() {
    let place = folder("");
    two_modes(place.path());
    let summary = run(place.path(), "two.csv --mode 230 --mode 78 --from 0 --to 1 --out out");
    let modes = summary["modes"].as_array().unwrap();
    let peak = |n: usize| modes[n]["band"]["peak"].as_f64().unwrap();
    assert!((peak(0) - 220.0).abs() < 0.1 && (peak(1) - 80.0).abs() < 0.1, "{summary}");
    assert_eq!(
        (summary["record"]["start"].as_f64(), summary["record"]["samples"].as_u64()),
        (Some(0.0), Some(2049))
    );
    refused(place.path(), "envelope two.csv --mode 400", &["no spectral peak", "220.0"]);
    refused(place.path(), "envelope two.csv --from 9", &["at least 2 are needed", "runs from 0 to"]);
    refused(place.path(), "envelope two.csv --mode 80 --band 60:105", &["cannot be used with"]);
    let report = std::fs::read_to_string(place.path().join("out/report.html")).unwrap();
    assert!(report.contains("Spectrum over time") && report.contains("crispEdges"));
}

#[test]
fn several_hits_are_several_records() {
    let place = folder("");
    three_hits(place.path());
    let summary = run(place.path(), "hits.csv --out all");
    let modes = summary["modes"].as_array().unwrap();
    let mode_names: Vec<_> = modes.iter().map(|m| m["name"].as_str().unwrap()).collect();
    assert_eq!(mode_names, ["mode 1, hit 1", "mode 1, hit 2", "mode 1, hit 3"], "{summary}");
    let starts = modes.iter().map(|m| m["window"][0].as_f64().unwrap());
    assert!(starts.zip([0.25, 2.25, 4.25]).all(|(from, at)| from > at && from < at + 0.5), "{summary}");
    assert!(summary["warnings"].to_string().contains("3 hits"), "{summary}");
    // What is said of the file is said once.
    let told = iwan(place.path(), "fit hits.csv --out fit --threads 2");
    assert_eq!(String::from_utf8_lossy(&told.stderr).matches("3 hits, at").count(), 1, "{}", shown(&told));
    let summary = run(place.path(), "hits.csv --hits 2 --out two");
    assert_eq!(summary["modes"].as_array().unwrap().len(), 1);
    assert!(summary["modes"][0]["window"][0].as_f64().unwrap() > 2.25);
    refused(place.path(), "envelope hits.csv --hits 4", &["no hit 4", "3 found"]);
    refused(place.path(), "envelope hits.csv --hits none", &["must be all, first, or a number"]);
}

#[test]
fn a_structure_that_is_pulled_and_let_go_rings_from_its_release_on() {
    let place = folder("");
    let mut text = "t [s],tip [mm]\n".to_string();
    for n in 0..5000 {
        let t = f64::from(n) / 250.0;
        let hand = 0.1 * (11.0 * t).sin() * (2.3 * t).cos();
        let x = match t - 5.0 {
            s if s < -3.0 => 0.0,
            s if s < -1.5 => -(s + 3.0) / 1.5 + hand,
            s if s < 0.0 => -1.0 + hand,
            s => -(-0.25 * s).exp() * (31.415_93 * s).cos(),
        };
        writeln!(text, "{t},{}", 20.0 + x).unwrap();
    }
    std::fs::write(place.path().join("let_go.csv"), text).unwrap();
    let summary = run(place.path(), "let_go.csv --out out");
    let warnings = summary["warnings"].to_string();
    let is_told = warnings.contains("before 5.0") && warnings.contains("pulled, held, handled or driven");
    assert!(is_told && !warnings.contains("jumps") && !warnings.contains("driven again"), "{warnings}");
    let mode = &summary["modes"][0];
    let window = mode["window"][0].as_f64().unwrap();
    assert!(window > 5.0 && window < 6.0 && (mode["band"]["peak"].as_f64().unwrap() - 5.0).abs() < 0.05);
}

/// A mode that only the first of two hits excites.
#[test]
fn a_hit_that_cannot_be_followed_can_be_left_out() {
    let place = folder("");
    let mut text = "t [s],tip [m/s^2]\n".to_string();
    for n in 0..8192 {
        let t = f64::from(n) / 2048.0;
        let wave = |at: f64, size: f64, frequency: f64| match t - at {
            s if s < 0.0 => 0.0,
            s => size * (-s).exp() * (std::f64::consts::TAU * frequency * s).sin(),
        };
        let second = wave(2.25, 3.0, 80.0) + wave(2.25, 1.3, 200.0) + wave(2.25, 1.5, 203.0);
        let sum = wave(0.25, 1.0, 80.0) + wave(0.25, 0.5, 200.0) + second;
        writeln!(text, "{t},{sum}").unwrap();
    }
    std::fs::write(place.path().join("two_hits.csv"), text).unwrap();
    refused(
        place.path(),
        "envelope two_hits.csv --mode 200",
        &["two_hits.csv, hit 2, mode 1", "leave it out", "one hit of a file with --hits N"],
    );
    let summary = run(place.path(), "two_hits.csv --mode 200 --hits 1 --out one");
    assert!((summary["modes"][0]["band"]["peak"].as_f64().unwrap() - 200.0).abs() < 0.1, "{summary}");
}

#[test]
fn what_is_no_motion_or_in_no_unit_is_asked_for() {
    let place = folder("");
    let write = |name: &str, header: &str| {
        let text = ring_down(2048.0, 4096, &[(80.0, 0.002, 3.0)], &[&[1.0]], "X");
        std::fs::write(place.path().join(name), text.replacen('X', header, 1)).unwrap();
    };
    for (unit, word) in [("Pa", "pressure"), ("V", "voltage"), ("N", "force"), ("counts", "not known")] {
        write("a.csv", &format!("sensor [{unit}]"));
        refused(place.path(), "envelope a.csv", &[word, "--quantity", "--channel"]);
        let summary = run(place.path(), &format!("a.csv --quantity velocity --out {unit}"));
        assert_eq!(summary["record"]["quantity"], "velocity");
    }
    write("g.csv", "sensor [g]");
    let summary = run(place.path(), "g.csv --unit SI --out si");
    assert_eq!(summary["record"]["unit"], "m/s^2");
    let amplitude = |s: &Value| s["modes"][0]["first"]["amplitude"].as_f64().unwrap();
    let plain = run(place.path(), "g.csv --out g");
    assert!((amplitude(&summary) / amplitude(&plain) - 9.806_65).abs() < 1e-6);
    refused(place.path(), "envelope g.csv --unit mm", &["different things", "--unit"]);
    refused(place.path(), "envelope g.csv --time-unit furlong", &["no unit of time", "ms, us"]);
}

#[test]
fn the_same_record_twice_is_refused() {
    let place = folder("");
    two_modes(place.path());
    std::fs::copy(place.path().join("two.csv"), place.path().join("copy.csv")).unwrap();
    refused(
        place.path(),
        "fit two.csv copy.csv --band 60:105",
        &["copy.csv holds the same samples as two.csv"],
    );
}
