//! `--strict`: what makes results doubtful is a failure by the user's word, and like warnings are counted.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::fmt::Write;
use std::path::Path;

use crate::common::{folder, iwan, names, shown, universal};
use crate::hits_of_bench::hits;

/// Runs a command with and without `--strict`: with it the exit code is 1, without it 0, and the results are there both times. Returns
/// the warnings of the summary.
fn breached(place: &Path, arguments: &str, summary: &str) -> Vec<String> {
    let output = iwan(place, &format!("{arguments} --out lenient"));
    assert_eq!(output.status.code(), Some(0), "{}", shown(&output));
    let lenient = String::from_utf8(output.stderr).unwrap();
    let output = iwan(place, &format!("{arguments} --out strict --strict --quiet"));
    assert_eq!(output.status.code(), Some(1), "{}", shown(&output));
    let strict = String::from_utf8(output.stderr).unwrap();
    assert!(strict.contains("error: --strict: "), "{strict}");
    assert_eq!(names(&place.join("strict")), names(&place.join("lenient")));
    let text = std::fs::read_to_string(place.join("strict").join(summary)).unwrap();
    let told: serde_json::Value = serde_json::from_str(&text).unwrap();
    let warnings = told["warnings"].as_array().unwrap().iter().map(|w| w.as_str().unwrap().to_string());
    let all: Vec<String> = warnings.collect();
    // What is breached is said with either, and with both once.
    for text in [&lenient, &strict] {
        let said = text.lines().filter(|line| line.starts_with("warning: "));
        let of_results = said.filter_map(|line| line.strip_prefix("warning: ")).collect::<Vec<_>>();
        assert!(!of_results.is_empty() && of_results.iter().all(|w| all.iter().any(|a| a == w)), "{text}");
        assert_eq!(
            of_results.iter().collect::<std::collections::BTreeSet<_>>().len(),
            of_results.len(),
            "{text}"
        );
    }
    all
}

/// A mode that grows stiffer with amplitude, as no joint does.
fn hardening(unit: &str) -> String {
    let mut text = format!("t [s],a [{unit}]\n");
    for n in 0..3000 {
        let t = f64::from(n) / 2000.0;
        let sigma = 3.0;
        let turns = 100.0 * t + 5.0 * (1.0 - (-2.0 * sigma * t).exp()) / (2.0 * sigma);
        writeln!(text, "{t},{}", (-sigma * t).exp() * (std::f64::consts::TAU * turns).cos()).unwrap();
    }
    text
}

/// A fit whose joint does not match exited with 0.
#[test]
fn a_joint_that_does_not_match_is_a_breach() {
    let place = folder("");
    std::fs::write(place.path().join("r.csv"), hardening("m/s^2")).unwrap();
    let warnings = breached(place.path(), "fit r.csv", "summary.json");
    assert!(warnings.iter().any(|w| w.contains("mode 1: One four-parameter Iwan joint with a viscous damper does not match")), "{warnings:?}");
    // What was assumed in reading the record is no breach.
    std::fs::write(place.path().join("u.csv"), hardening("m/s^2").replace(" [m/s^2]", "")).unwrap();
    let output = iwan(place.path(), "envelope u.csv --strict --out out");
    assert_eq!(output.status.code(), Some(0), "{}", shown(&output));
    assert!(
        shown(&output).contains("warning: u.csv: the file does not say what it measures"),
        "{}",
        shown(&output)
    );
}

/// A decay of 100 Hz in a universal file that names a window.
fn windowed(window: u8) -> String {
    let decay = |n: u16| {
        let t = f64::from(n) * 5e-4;
        (-3.0 * t).exp() * (std::f64::consts::TAU * 100.0 * t).cos()
    };
    let samples: Vec<f64> = (0..3000).map(decay).collect();
    universal::channel("tip", (12, "m/s2"), 5e-4, &samples, window)
}

/// Damping of a record under a window is the window's, too; the header says so, and the exit code was 0.
#[test]
fn a_window_that_the_header_names_is_a_breach() {
    let place = folder("");
    std::fs::write(place.path().join("r.uff"), windowed(4)).unwrap();
    for (command, summary) in [
        ("envelope r.uff", "summary.json"),
        ("fit r.uff", "summary.json"),
        ("modal r.uff --free", "modal.json"),
    ] {
        let warnings = breached(place.path(), command, summary);
        assert!(warnings.iter().any(|w| w.contains("an exponential window")), "{command}: {warnings:?}");
        std::fs::remove_dir_all(place.path().join("lenient")).unwrap();
        std::fs::remove_dir_all(place.path().join("strict")).unwrap();
    }
    std::fs::write(place.path().join("n.uff"), windowed(0)).unwrap();
    let output = iwan(place.path(), "envelope n.uff --strict --out out");
    assert_eq!(output.status.code(), Some(0), "{}", shown(&output));
    // Nothing in these samples shows the window; the fit knows it from the header, and tells no parameter.
    let fitted = |file: &str| {
        let output = iwan(place.path(), &format!("fit {file} --out fit --force"));
        assert_eq!(output.status.code(), Some(0), "{}", shown(&output));
        let fit = std::fs::read_to_string(place.path().join("fit/fit.json")).unwrap();
        let mode = serde_json::from_str::<serde_json::Value>(&fit).unwrap()["modes"][0].clone();
        let told = mode.to_string().contains("as its file says");
        (mode["frequency"]["high"].clone(), mode["grade"].clone(), told)
    };
    let ((high, _, told), (under, grade, told_under)) = (fitted("n.uff"), fitted("r.uff"));
    assert!((high.as_f64().unwrap() - 100.0).abs() < 0.05 && !told, "{high}");
    assert!(under.is_null() && grade == "usable" && told_under, "{under} {grade}");
}

#[test]
fn a_doubt_of_a_modal_analysis_is_a_breach() {
    let place = folder("");
    hits(place.path(), 2);
    let warnings = breached(place.path(), "modal h1.csv h2.csv --band 60:480", "modal.json");
    assert!(warnings.iter().any(|w| w.contains("not mass-normalised")), "{warnings:?}");
}

/// A warning for each of thousands of datasets was a line on the terminal, an entry of the summary and one of the page.
#[test]
fn like_warnings_are_counted() {
    let place = folder("");
    let spectrum = "    -1\n    58\nx\nNONE\n01-Jan-26 00:00:00\nNONE\nNONE\n    1         0    0         0 NONE               1   3 NONE               0   0\n         5         1         1  0.00000E+00  5.00000E-04  0.00000E+00\n        18    0    0    0 Frequency            Hz                  \n        12    0    0    0 Acceleration         m/s2                \n         0    0    0    0 NONE                 NONE                \n         0    0    0    0 NONE                 NONE                \n  0.0  0.0\n    -1\n";
    let spectra: String = (0..20_000).map(|n| spectrum.replacen("\nx\n", &format!("\nx{n}\n"), 1)).collect();
    std::fs::write(place.path().join("r.uff"), spectra + &windowed(0)).unwrap();
    for command in ["envelope r.uff", "envelope r.uff --peaks"] {
        let output = iwan(place.path(), &format!("{command} --out out --force --json"));
        assert_eq!(output.status.code(), Some(0), "{}", shown(&output));
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert!(
            stderr.contains("was left out") && stderr.contains("and 19995 more like the one before"),
            "{stderr}"
        );
        assert!(stderr.lines().count() < 20, "{stderr}");
        let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(told["warnings"].as_array().unwrap().len() < 10, "{}", told["warnings"]);
        let page = std::fs::read_to_string(place.path().join("out/report.html")).unwrap();
        assert!(page.contains("and 19995 more") && page.matches("was left out").count() < 10);
    }
    // Remarks on a mesh pass through the same place.
    let mut mesh = String::from("*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT,TYPE=C3D4\n1,1,2,3,4\n");
    (0..20_000).for_each(|n| writeln!(mesh, "*NSET, NSET=s{n}, GENERATE\n1, 9").unwrap());
    std::fs::write(place.path().join("m.inp"), mesh).unwrap();
    let text = "[mesh]\nkind = \"file\"\npath = \"m.inp\"\n[[material]]\nyoung = 1.0\npoisson = 0.3\ndensity = 1.0\n";
    std::fs::write(place.path().join("m.toml"), text).unwrap();
    let output = iwan(place.path(), "modes m.toml --count 1 --out mesh");
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(stderr.contains("note: and ") && stderr.lines().count() < 20, "{stderr:.2000}");
}
