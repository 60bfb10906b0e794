//! `iwan frf` and `iwan backbone`: files, contract, what is refused.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

mod common;

use std::path::Path;

use common::{csv, folder, iwan, names, shown};
use serde_json::Value;

const MODE: &str = r#"
[[mode]]
name = "bending 1"
frequency = 124.0
damping_ratio = 2.5e-4
joint = { k_t = 4.45e4, f_s = 239.4, chi = -0.183, beta = 0.3 }
outputs = { tip = 23.5 }
"#;

const SWEEP: &str = r"
[sweep]
from = 112.0
to = 128.0
force = [1.0, 100.0]
";

fn run(place: &Path, arguments: &str) -> Value {
    let output = iwan(place, &format!("{arguments} --json"));
    assert!(output.status.success(), "{}", shown(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn column<'a>(table: &'a [(String, Vec<f64>)], name: &str) -> &'a [f64] {
    &table.iter().find(|column| column.0 == name).unwrap_or_else(|| panic!("no column {name}")).1
}

fn headers(table: &[(String, Vec<f64>)]) -> Vec<&str> {
    table.iter().map(|column| column.0.as_str()).collect()
}

#[test]
fn the_built_in_example_needs_no_arguments() {
    let place = folder("");
    let summary = run(place.path(), "frf --out out");
    assert_eq!(names(&place.path().join("out")), ["frf.csv", "frf.json", "report.html"]);
    let modes = summary["modes"].as_array().unwrap();
    assert_eq!(modes.len(), 1, "modes 2 and 3 lie outside the band");
    let peaks: Vec<f64> = modes[0]["levels"]
        .as_array()
        .unwrap()
        .iter()
        .map(|l| l["peak"]["frequency"].as_f64().unwrap())
        .collect();
    assert!(peaks.len() == 4 && peaks.windows(2).all(|w| w[0] > w[1]), "{peaks:?}");
    assert_eq!(summary["warnings"].as_array().unwrap().len(), 0, "{summary}");
    let summary = run(place.path(), "backbone --out curves");
    assert_eq!(names(&place.path().join("curves")), ["backbone.csv", "report.html", "summary.json"]);
    assert_eq!(summary["modes"].as_array().unwrap().len(), 3);
    // Nothing is overwritten without --force.
    assert_eq!(iwan(place.path(), "frf --out out").status.code(), Some(2));
}

#[test]
fn columns_and_keys_are_the_contract() {
    let place = folder(&format!("{MODE}{SWEEP}harmonics = 5\nat = 'tip'\n"));
    let summary = run(place.path(), "frf in.toml --out out");
    let file: Value =
        serde_json::from_slice(&std::fs::read(place.path().join("out/frf.json")).unwrap()).unwrap();
    assert_eq!(file["modes"], summary["modes"]);
    assert_eq!(
        (&summary["held"], &summary["harmonics"], &summary["at"]),
        (&"force".into(), &5.into(), &"tip".into())
    );
    let table = csv(&place.path().join("out/frf.csv"));
    let expected = [
        "mode",
        "level",
        "frequency",
        "amplitude",
        "phase",
        "excitation",
        "harmonic_3.amplitude",
        "harmonic_3.phase",
        "harmonic_5.amplitude",
        "harmonic_5.phase",
    ];
    assert_eq!(headers(&table), expected);
    // The peak is the largest amplitude of its level, and lies in quadrature.
    let strong: Vec<usize> = (0..table[0].1.len()).filter(|&i| column(&table, "level")[i] == 100.0).collect();
    let most = strong.iter().map(|&i| column(&table, "amplitude")[i]).fold(0.0, f64::max);
    let peak = &summary["modes"][0]["levels"][1]["peak"];
    assert_eq!(peak["amplitude"].as_f64().unwrap(), most);
    assert!((peak["phase"].as_f64().unwrap() + std::f64::consts::FRAC_PI_2).abs() < 0.05, "{peak}");
}

#[test]
fn a_backbone_has_the_amplitudes_it_was_asked_for() {
    let place = folder(MODE);
    let summary =
        run(place.path(), "backbone in.toml --from 1e-4 --to 1e-2 --points 9 --harmonics 3 --out out");
    let mode = &summary["modes"][0];
    let of =
        |key: &str| mode[key].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect::<Vec<_>>();
    let (amplitude, frequency, damping) = (of("amplitude"), of("frequency"), of("damping_ratio"));
    assert!(
        amplitude.len() == 9 && (amplitude[8] - 1e-2).abs() < 1e-15 && (amplitude[0] - 1e-4).abs() < 1e-15
    );
    assert!(frequency.windows(2).all(|w| w[0] > w[1]) && damping.windows(2).all(|w| w[0] < w[1]));
    let table = csv(&place.path().join("out/backbone.csv"));
    assert_eq!(headers(&table), ["mode", "amplitude", "frequency", "damping_ratio", "harmonic_3.amplitude"]);
    assert_eq!(column(&table, "frequency"), frequency);
}

#[test]
fn a_structure_has_responses_and_nonlinear_modes() {
    let text = "[structure]\nname = 'paper-a'\nbasis = 20\n[sweep]\nfrom = 125\nto = 140\nforce = [0.01]\n\
        damping_ratio = 1e-3\nharmonics = 3\n";
    let place = folder(text);
    let summary = run(place.path(), "frf in.toml --out out");
    let peak = summary["modes"][0]["levels"][0]["peak"]["frequency"].as_f64().unwrap();
    assert!((peak - 132.35).abs() < 0.2, "{summary}");
    assert_eq!(summary["warnings"].as_array().unwrap().len(), 0, "{summary}");
    let summary =
        run(place.path(), "backbone in.toml --mode bending-1 --points 8 --harmonics 3 --out curves");
    let mode = &summary["modes"][0];
    let ends = [&mode["frequency"][0], &mode["frequency"][7]].map(|f| f.as_f64().unwrap());
    // From stuck to slipping.
    assert!((ends[0] - 132.35).abs() < 0.05 && (127.7..131.0).contains(&ends[1]), "{ends:?}");
    assert_eq!(summary["warnings"].as_array().unwrap().len(), 0, "{summary}");
}

#[test]
fn bad_input_is_named() {
    let cases = [
        (MODE.into(), "frf", "the table [sweep] is missing"),
        (format!("{MODE}[sweep]\nfrom = 300\nto = 400\nforce = [1]\n"), "frf", "no mode has its resonance"),
        (format!("{MODE}[sweep]\nfrom = 112\nto = 128\nforce = [0]\n"), "frf", "force = 0 is out of range"),
        (format!("{MODE}{SWEEP}at = 'moon'\n"), "frf", "has no point \"moon\""),
        (format!("{MODE}{SWEEP}damping_ratio = 0.1\n"), "frf", "damping_ratio is for structures"),
        (format!("{MODE}{SWEEP}harmonics = 4\n"), "frf", "harmonics = 4 is out of range"),
        (MODE.replace("joint", "# joint"), "backbone", "no joint slips"),
        (MODE.into(), "backbone --harmonics 2", "harmonics = 2"),
        (MODE.into(), "backbone --from 2 --to 1", "no range of amplitudes"),
    ];
    for (text, command, message) in cases {
        let place = folder(&text);
        let output = iwan(place.path(), &format!("{command} --out out in.toml"));
        assert_eq!(output.status.code(), Some(2), "{}", shown(&output));
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(said.contains(message) && said.contains("remedy:"), "{said}");
        assert_eq!(names(place.path()), ["in.toml"], "nothing is left behind");
    }
}
