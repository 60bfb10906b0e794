//! `iwan envelope` and `iwan fit` on the measured Brake-Reuss record.
//!
//! Reported as not run without `IWAN_FIELD_DATA`, which names the folder with `field/`.
#![allow(clippy::unwrap_used, reason = "a failed test may panic")]

mod common;
#[path = "../../../tests/support/field.rs"]
mod field;

use std::path::Path;

use common::{csv, folder, iwan, shown};
use serde_json::Value;

fn run(command: &str, place: &Path, arguments: &str) -> Value {
    let output = iwan(place, &format!("{command} {arguments} --json"));
    assert!(output.status.success(), "{}", shown(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn the_brake_reuss_record(record: &Path) {
    let record = record.display();
    let place = folder("");
    let options = "--time HIdata.time --channel HIdata.acc1 --channel HIdata.acc3 --band 60:105 --out out";
    let summary = run("envelope", place.path(), &format!("{record} {options}"));
    let mode = &summary["modes"][0];
    // t (s), Hz, %: by SciPy, with the settings that `crates/iwan-ident/tests/field_record.rs` names.
    let table = csv(&place.path().join("out/envelope.csv"));
    let column = |name: &str| &table.iter().find(|c| c.0 == name).unwrap().1;
    for (t, f, z) in [(0.1, 80.33, 0.273), (1.0, 80.45, 0.187), (3.0, 80.54, 0.149), (4.0, 80.58, 0.141)] {
        let i = column("t").partition_point(|x| *x < t);
        assert!((column("frequency")[i] - f).abs() < 0.05, "{t} s: {}", column("frequency")[i]);
        assert!(
            (100.0 * column("damping_ratio")[i] / z - 1.0).abs() < 0.05,
            "{t} s: {}",
            column("damping_ratio")[i]
        );
    }
    assert_eq!(mode["methods"].as_array().unwrap().len(), 4);
    assert_eq!(summary["record"]["unit"], "m/s^2");
}

fn the_brake_reuss_beam_is_told_with_what_the_law_misses(record: &Path) {
    let record = record.display();
    let place = folder("");
    let fit = run("fit", place.path(), &format!("{record} --channel HIdata.acc1 --band 60:105 --out out"));
    let mode = &fit["modes"][0];
    // Dissipation is missed by some 3 %, where the limit is, and frequency by less than a tenth of its shift: more than noise, which the intervals know. Along what the intervals leave
    // open the misfit varies between 1.7 and 3.4 %, and a change of the model's last digits moves the best value there.
    assert_ne!(mode["grade"], "no", "{}", mode["misfit"]);
    assert!(mode["dissipation_misfit"].as_f64().unwrap() < 0.036);
    assert!(mode["in_words"].to_string().contains("the law itself misses about"), "{}", mode["in_words"]);
    assert!((mode["frequency"]["value"].as_f64().unwrap() - 80.6).abs() < 0.3);
    assert!(
        mode["in_words"].to_string().contains("free-form density to both curves"),
        "{}",
        mode["in_words"]
    );
    assert!(iwan(place.path(), "simulate out/scenario.toml --out again").status.success());
    let page = std::fs::read_to_string(place.path().join("out/report.html")).unwrap();
    assert_eq!(page.contains(r#"<div class="verdict">"#), mode["grade"] == "matches");
}

/// Viscous, dry and quadratic damping with a cubic spring, on a clock that stutters: nothing on the page says that an Iwan joint or
/// a linear mode tells it.
fn a_pendulum_is_not_told_by_an_iwan_joint(record: &Path) {
    let record = record.display();
    let place = folder("");
    let fit = run("fit", place.path(), &format!("{record} --resample --quantity displacement --out out"));
    let mode = &fit["modes"][0];
    assert!(mode["adequate"] == false && mode["grade"] != "matches", "{}", mode["misfit"]);
    let page = std::fs::read_to_string(place.path().join("out/report.html")).unwrap();
    assert!(page.contains(r#"class="verdict look""#) && !page.contains("A linear mode is enough"));
}

field::field_tests! {
    the_brake_reuss_record on "field/brb_hammer_impact.mat",
    the_brake_reuss_beam_is_told_with_what_the_law_misses on "field/brb_hammer_impact.mat",
    a_pendulum_is_not_told_by_an_iwan_joint on "field/pendulum_100.csv",
}
