//! `iwan modal`: from files of hits to modes, and what it says about hits that are no good.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::f64::consts::TAU;
use std::fmt::Write;
use std::path::Path;

use crate::common::{csv, folder, iwan};
use crate::hits_of_bench::{bench, hits, refused, run, write};
use iwan_modal::measure::{Channel, Hit};
use serde_json::Value;

#[test]
fn hits_become_modes_and_files() {
    let place = folder("");
    hits(place.path(), 3);
    let found = run(place.path(), "h1.csv h2.csv h3.csv --at a1 --band 60:480 --out out");
    let modes = found["modes"].as_array().unwrap();
    assert_eq!(
        (modes.len(), &found["mass_normalised"], found["warnings"].as_array().unwrap().len()),
        (4, &Value::Bool(true), 0),
        "{found}"
    );
    let bench = bench();
    for (mode, truth) in modes.iter().zip(&bench.modes) {
        let number = |key: &str| mode[key].as_f64().unwrap();
        assert!((number("frequency") / truth.frequency - 1.0).abs() < 2e-5);
        assert!((number("damping_ratio") / truth.damping_ratio - 1.0).abs() < 0.01);
        assert!(number("frequency_sd") > 0.0 && number("frequency_sd") < 1e-3 * truth.frequency);
        let (shape, own) =
            (bench.shape(truth), |k: usize| mode["shape"][format!("a{}", k + 1)].as_f64().unwrap());
        let sign = own(0).signum() * shape[0].signum();
        assert!((0..8).all(|k| (own(k) * sign - shape[k]).abs() < 0.01), "{mode}");
    }
    let shapes = csv(&place.path().join("out/shapes.csv"));
    let names: Vec<&str> = shapes.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names[..3], ["frequency", "damping_ratio", "a1"]);
    let frf = csv(&place.path().join("out/frf.csv"));
    assert!(frf[0].1[0] >= 60.0 && frf.len() == 1 + 8 * 5);
    let page = std::fs::read_to_string(place.path().join("out/report.html")).unwrap();
    for word in ["Stabilisation chart", "Coherence", "animate", "Composite response"] {
        assert!(page.contains(word), "{word}");
    }
}

#[test]
fn what_it_writes_it_reads_again() {
    let place = folder("");
    hits(place.path(), 2);
    let first = run(place.path(), "h1.csv h2.csv --at a1 --band 60:480 --out first");
    // Frequency responses as others would measure them. The records end when the mode of 0.01 % has lost a fourth of its amplitude.
    let again = run(
        place.path(),
        "first/shapes.uff --pretrigger 0.0249 --band 60:480 --quantity acceleration --out again",
    );
    let frequency = |all: &Value, n: usize| all["modes"][n]["frequency"].as_f64().unwrap();
    for n in 0..4 {
        let off = frequency(&first, n) / frequency(&again, n) - 1.0;
        assert!(off.abs() < 2e-5, "{n}: {off:e}");
    }
}

#[test]
fn several_hits_in_one_record_are_cut_and_a_fault_is_said_and_left_out_on_request() {
    let place = folder("");
    let (one, two) = (bench().hit(100.0, 1), bench().hit(105.0, 2));
    let join = |a: &Channel, b: &Channel| Channel {
        samples: [a.samples.clone(), b.samples.clone()].concat(),
        ..a.clone()
    };
    let mut both = Hit { force: join(&one.force, &two.force), ..one.clone() };
    both.responses = one.responses.iter().zip(&two.responses).map(|(a, b)| join(a, b)).collect();
    // The first hit bounces.
    (0..8).for_each(|n| both.force.samples[190 + n] += 20.0);
    write(place.path(), "long.csv", &both);
    let found = run(place.path(), "long.csv --at a1 --band 60:480 --out all");
    let hits = found["hits"].as_array().unwrap();
    assert_eq!(hits.len(), 2);
    assert!(hits[0]["faults"][0].as_str().unwrap().contains("double hit"), "{found}");
    assert!(hits[1]["faults"].as_array().unwrap().is_empty(), "{found}");
    let warning = found["warnings"][0].as_str().unwrap();
    assert!(warning.contains("long.csv, hit 1") && warning.contains("--leave-out"), "{warning}");
    let without = run(place.path(), "long.csv --at a1 --band 60:480 --leave-out faulty --out without");
    assert_eq!(without["levels"][0]["hits"], serde_json::json!(["long.csv, hit 2"]));
    refused(place.path(), "long.csv --at a1 --leave-out nonsense", &["nonsense", "long.csv, hit 1"]);
}

#[test]
fn a_second_hit_in_the_decay_and_a_saturated_channel_are_named() {
    let place = folder("");
    let (one, two) = (bench().hit(100.0, 1), bench().hit(105.0, 2));
    let late = |a: &Channel, b: &Channel| {
        let samples =
            (0..a.samples.len()).map(|n| a.samples[n] + if n < 3000 { 0.0 } else { b.samples[n - 3000] });
        Channel { samples: samples.collect(), ..a.clone() }
    };
    let mut both = Hit { force: late(&one.force, &two.force), ..one.clone() };
    both.responses = one.responses.iter().zip(&two.responses).map(|(a, b)| late(a, b)).collect();
    let limit = 0.3 * both.responses[2].samples.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    both.responses[2].samples.iter_mut().for_each(|x| *x = x.clamp(-limit, limit));
    write(place.path(), "both.csv", &both);
    let found = run(place.path(), "both.csv --at a1 --band 60:480");
    let warnings = found["warnings"].to_string();
    assert!(
        warnings.contains("both.csv, hit 2: channel") && warnings.contains("during the decay of the last"),
        "{warnings}"
    );
    assert!(
        warnings.contains("channel a3 is overloaded in all 2 hits: what is said of its point"),
        "{warnings}"
    );
}

#[test]
fn files_that_do_not_belong_together_are_refused() {
    let place = folder("");
    hits(place.path(), 1);
    let mut slow = bench().hit(100.0, 1);
    slow.dt *= 2.0;
    write(place.path(), "slow.csv", &slow);
    refused(place.path(), "h1.csv slow.csv --at a1", &["slow.csv", "2048", "4096", "one sampling rate"]);
    let mut dead = bench().hit(100.0, 1);
    dead.responses[4].samples.fill(0.25);
    write(place.path(), "dead.csv", &dead);
    refused(place.path(), "dead.csv --at a1", &["dead.csv", "channel a5", "0.25"]);
    let text = std::fs::read_to_string(place.path().join("h1.csv")).unwrap();
    std::fs::write(place.path().join("none.csv"), text.replacen("hammer [N]", "a0 [m/s^2]", 1)).unwrap();
    refused(place.path(), "none.csv", &["none.csv", "no channel measures a force", "--hammer"]);
    // A message that names all of many channels was longer than any screen.
    let many: Vec<String> = (0..300).map(|k| format!("c{k}")).collect();
    let rows: Vec<String> =
        (0..64).map(|n| format!("{}{}\n", f64::from(n) * 1e-3, ",1".repeat(300))).collect();
    std::fs::write(place.path().join("many.csv"), format!("t,{}\n{}", many.join(","), rows.concat()))
        .unwrap();
    refused(
        place.path(),
        "many.csv",
        &["no channel measures a force (there are: c0, c1, ", ", c19 and 280 more)"],
    );
    std::fs::write(place.path().join("volts.csv"), text.replacen("a2 [m/s^2]", "a2 [V]", 1)).unwrap();
    refused(place.path(), "volts.csv --at a1", &["volts.csv", "channel a2", "voltage"]);
    refused(place.path(), "h1.csv --at a1 --level 2 --band 60:480", &["--level 2", "one level"]);
    refused(place.path(), "h1.csv --at a1 --band 60:48000", &["48000"]);
}

#[test]
fn a_swapped_channel_and_a_missing_drive_point_are_said() {
    let place = folder("");
    let mut swapped = bench().hit(100.0, 1);
    // The tip's sensor looks the other way.
    swapped.responses[0].samples.iter_mut().for_each(|x| *x = -*x);
    write(place.path(), "swapped.csv", &swapped);
    let found = run(place.path(), "swapped.csv --at a1 --band 60:480");
    assert!(found["warnings"].to_string().contains("goes against the force"), "{found}");
    let free = run(place.path(), "swapped.csv --band 60:480 --out free");
    assert!(free["warnings"].to_string().contains("not mass-normalised") && free["mass_normalised"] == false);
    refused_fit(place.path(), "free");
}

fn refused_fit(place: &Path, modal: &str) {
    let output = iwan(place, &format!("fit --modal {modal}"));
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(2) && text.contains("not mass-normalised"), "{text}");
}

#[test]
fn free_decays_need_no_force() {
    let place = folder("");
    let hit = bench().hit(100.0, 1);
    write(place.path(), "decay.csv", &hit);
    let found = run(place.path(), "decay.csv --free --from 0.03 --band 60:480 --out out");
    let modes = found["modes"].as_array().unwrap();
    assert_eq!((modes.len(), &found["mass_normalised"]), (4, &Value::Bool(false)), "{found}");
    for (mode, truth) in modes.iter().zip(&bench().modes) {
        assert!((mode["frequency"].as_f64().unwrap() / truth.frequency - 1.0).abs() < 1e-4, "{mode}");
    }
    refused(place.path(), "decay.csv --from 1", &["--free"]);
}

#[test]
fn a_table_says_which_file_and_channel_is_which_point() {
    let place = folder("");
    let hit = bench().hit(100.0, 1);
    let mut table =
        "[[channel]]\nname = \"hammer\"\npoint = \"1\"\ndirection = \"z\"\nrole = \"force\"\n".to_string();
    // One sensor roves: eight files with one channel each.
    let mut files = String::new();
    for k in 0..8 {
        let mut own = Hit { responses: vec![hit.responses[k].clone()], ..hit.clone() };
        own.responses[0].name = "acc".into();
        write(place.path(), &format!("p{}.csv", k + 1), &own);
        write!(table, "[[channel]]\nname = \"acc\"\nfile = \"p{}.csv\"\npoint = \"{}\"\ndirection = \"+z\"\n[[point]]\nname = \"{}\"\nposition = [{}, 0, 0]\n", k + 1, k + 1, k + 1, k).unwrap();
        write!(files, "p{}.csv ", k + 1).unwrap();
    }
    std::fs::write(place.path().join("points.toml"), table).unwrap();
    let found = run(place.path(), &format!("{files} --points points.toml --band 60:480 --out out"));
    assert_eq!(
        (found["modes"].as_array().unwrap().len(), &found["mass_normalised"]),
        (4, &Value::Bool(true))
    );
    assert_eq!(found["channels"][7], "8:+z");
    let text = std::fs::read_to_string(place.path().join("out/shapes.uff")).unwrap();
    assert!(text.starts_with("    -1\n    15\n         1") && text.contains("\n    55\n"));
    refused(place.path(), "p1.csv p2.csv --hammer hammer --at nowhere:+q", &["POINT:DIRECTION"]);
}

#[test]
fn modes_that_were_found_are_overruled_pole_by_pole() {
    let place = folder("");
    hits(place.path(), 2);
    let frequencies = |found: &Value| -> Vec<f64> {
        found["modes"].as_array().unwrap().iter().map(|m| m["frequency"].as_f64().unwrap()).collect()
    };
    let all = frequencies(&run(place.path(), "h1.csv h2.csv --at a1 --band 60:480 --out all"));
    let dropped = format!("{:.2},{:.2}", all[0], all[2]);
    let fewer =
        run(place.path(), &format!("h1.csv h2.csv --at a1 --band 60:480 --drop-poles {dropped} --out fewer"));
    let left = frequencies(&fewer);
    assert!(
        left.len() == 2 && (left[0] - all[1]).abs() < 0.02 && (left[1] - all[3]).abs() < 0.02,
        "{left:?}"
    );
    let page = std::fs::read_to_string(place.path().join("fewer/report.html")).unwrap();
    assert!(
        page.contains("<td>not taken</td>") && page.contains("<td>taken</td>"),
        "candidates of the chart"
    );
    let again = format!(
        "h1.csv h2.csv --at a1 --band 60:480 --drop-poles {dropped} --add-poles {:.2} --out again",
        all[2]
    );
    let again = frequencies(&run(place.path(), &again));
    assert!(again.len() == 3 && (again[1] - all[2]).abs() < 0.02, "{again:?}");
    refused(
        place.path(),
        "h1.csv --at a1 --band 60:480 --drop-poles 99",
        &[
            "frequency of a mode to leave out = 99",
            "there are modes at 122.4",
            "give the frequency of one of them",
        ],
    );
    refused(place.path(), "h1.csv --at a1 --poles 122 --add-poles 243", &["--poles", "--add-poles"]);
}

#[test]
fn modes_that_were_not_asked_for_are_no_fault_of_the_channels() {
    let place = folder("");
    hits(place.path(), 1);
    let found = run(place.path(), "h1.csv --at a1 --band 60:480 --poles 243.1");
    let said = found["warnings"].to_string();
    assert!(
        said.contains("--poles: the modes leave") && said.contains("other modes stand there too"),
        "{said}"
    );
    assert!(!said.contains("does not move as the other channels do"), "{said}");
}

/// A sensor on a structure that sways: phases of all modes turn with the sway.
#[test]
fn sidebands_of_a_sway_are_named_and_can_be_left_out() {
    let place = folder("");
    let modes = [(82.0, 3e-3), (133.0, 2e-3), (195.0, 2e-3), (251.0, 2.5e-3)];
    let mut text = String::from("time [s],a1 [m/s^2],a2 [m/s^2]\n");
    for n in 0..4096 {
        let t = f64::from(n) * 1e-3;
        let sway = 0.2 * (-t).exp() * (TAU * 5.8 * t).sin();
        let mode = |(f, damping): (f64, f64)| (-damping * TAU * f * t).exp() * (TAU * f * t + sway).cos();
        let [a, b, c, d] = modes.map(mode);
        let noise = 1e-4 * (1.7 * f64::from(n) * f64::from(n)).sin();
        writeln!(text, "{t},{},{}", a + b + c + d + noise, a - 0.5 * b + 0.3 * c - 0.8 * d + noise).unwrap();
    }
    std::fs::write(place.path().join("sway.csv"), text).unwrap();
    let found = run(place.path(), "sway.csv --free --band 50:300 --out found");
    let said = found["warnings"].to_string();
    assert!(
        said.contains("sidebands of stronger modes") && said.contains("modulates the structure"),
        "{said}"
    );
    let sidebands: Vec<&Value> =
        found["modes"].as_array().unwrap().iter().filter(|m| !m["sideband_of"].is_null()).collect();
    assert!(sidebands.len() >= 6, "{found}");
    let page = std::fs::read_to_string(place.path().join("found/report.html")).unwrap();
    assert!(page.contains("probably a sideband of 133.0"), "the report says it beside the mode");
    let list = said.split("--drop-poles ").nth(1).unwrap().split('"').next().unwrap();
    let left = run(place.path(), &format!("sway.csv --free --band 50:300 --drop-poles {list} --out left"));
    let count = |all: &Value| all["modes"].as_array().unwrap().len();
    assert_eq!(count(&left), count(&found) - sidebands.len());
}
