//! `iwan simulate`: files, contract, repeatability.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::path::Path;

use crate::common::{SMALL, csv, folder, iwan, names, shown};
use serde_json::Value;

fn run(place: &Path, arguments: &str) -> Value {
    let output = iwan(place, &format!("simulate {arguments} --json"));
    assert!(output.status.success(), "{}", shown(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn bytes(place: &Path, file: &str) -> Vec<u8> {
    std::fs::read(place.join(file)).unwrap()
}

#[test]
fn the_built_in_scenario_says_where_the_figures_are_and_overwrites_nothing() {
    let place = folder("");
    let first = iwan(place.path(), "simulate");
    assert!(first.status.success(), "{}", shown(&first));
    let text = String::from_utf8(first.stderr).unwrap();
    assert!(text.contains("figures: iwan-simulate/report.html"), "{text}");
    let files = ["report.html", "response.csv", "scenario.toml", "summary.json"];
    assert_eq!(names(&place.path().join("iwan-simulate")), files);
    let before = bytes(place.path(), "iwan-simulate/summary.json");
    let text = String::from_utf8(iwan(place.path(), "simulate").stderr).unwrap();
    assert!(text.contains("figures: iwan-simulate-2/report.html"), "{text}");
    assert_eq!(bytes(place.path(), "iwan-simulate/summary.json"), before);
    assert!(iwan(place.path(), "simulate --force").status.success());
    assert_eq!(names(place.path()), ["in.toml", "iwan-simulate", "iwan-simulate-2"]);
}

#[test]
fn the_built_in_scenario_is_in_micro_slip_and_exact() {
    let place = folder("");
    let summary = run(place.path(), "--out out");
    let modes = summary["modes"].as_array().unwrap();
    assert_eq!(modes.len(), 3);
    for mode in modes {
        assert!(mode["energy_error"].as_f64().unwrap() < 1e-10, "{mode}");
        assert!(mode["time_step_error"].as_f64().unwrap() < 1e-3, "{mode}");
        assert!(mode["discretisation_error"].as_f64().unwrap() < 1e-3, "{mode}");
    }
    for mode in [0, 2] {
        let ratio = modes[mode]["slip_ratio"].as_f64().unwrap();
        assert!(ratio > 0.5 && ratio < 1.0, "{ratio}");
    }
    assert_eq!(summary["warnings"].as_array().unwrap().len(), 0);
}

#[test]
fn columns_and_keys_are_the_contract() {
    let place = folder(SMALL);
    let summary = run(place.path(), "in.toml --out out");
    let table = csv(&place.path().join("out/response.csv"));
    let quantities = ["displacement", "velocity", "acceleration", "joint_force"];
    let modes = ["bending 1", "linear"].map(|m| quantities.map(|q| format!("{m}.{q}"))).concat();
    let points =
        ["tip", "root"].map(|p| quantities[..3].iter().map(|q| format!("{p}.{q}")).collect::<Vec<_>>());
    let expected = [vec!["t".to_string()], modes, points.concat()].concat();
    assert_eq!(table.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>(), expected);
    assert!(table.iter().all(|(_, values)| values.len() == 1001));
    for mode in summary["modes"].as_array().unwrap() {
        for key in [
            "name",
            "peak_displacement",
            "final_displacement",
            "slip_ratio",
            "energy_error",
            "time_step_error",
            "discretisation_error",
            "steps",
            "seconds",
        ] {
            assert!(mode.get(key).is_some(), "{key}");
        }
    }
    let written: Value = serde_json::from_slice(&bytes(place.path(), "out/summary.json")).unwrap();
    assert_eq!(written["modes"], summary["modes"]);
    assert_eq!(summary["folder"], "out");
    let tip = &table[9].1;
    let superposed: Vec<f64> = table[1].1.iter().zip(&table[5].1).map(|(a, b)| 23.5 * a + 20.0 * b).collect();
    assert!(tip.iter().zip(&superposed).all(|(a, b)| (a - b).abs() <= 1e-15));
}

#[test]
fn the_text_summary() {
    // The continuum: its numbers do not depend on how densities are cut.
    let place = folder(SMALL);
    let output = iwan(place.path(), "simulate in.toml --out out --joint continuum");
    // Times differ from run to run.
    let kept: Vec<_> =
        shown(&output).lines().filter(|l| !l.starts_with("seconds")).map(String::from).collect();
    let digits = |line: &String| !line.starts_with("energy error");
    insta::assert_snapshot!(kept.into_iter().filter(digits).collect::<Vec<_>>().join("\n"));
}

#[test]
fn threads_do_not_change_a_bit() {
    let place = folder(SMALL);
    run(place.path(), "in.toml --out one --threads 1");
    run(place.path(), "in.toml --out two --threads 2");
    assert_eq!(bytes(place.path(), "one/response.csv"), bytes(place.path(), "two/response.csv"));
}

#[test]
fn the_written_scenario_repeats_the_run_to_the_last_bit() {
    let place = folder(SMALL);
    run(place.path(), "in.toml --out one --joint continuum --step 5e-5 --amplitude -3000 --duration 0.05");
    run(place.path(), "one/scenario.toml --out two");
    assert_eq!(bytes(place.path(), "one/response.csv"), bytes(place.path(), "two/response.csv"));
    assert_eq!(bytes(place.path(), "one/scenario.toml"), bytes(place.path(), "two/scenario.toml"));
}

#[test]
fn a_force_from_a_file_goes_along_with_the_results() {
    let formula = "kind = \"haversine\"\namplitude = 4000.0\nduration = 1.6e-3";
    let place = folder(&SMALL.replace(formula, "kind = \"file\"\npath = \"data/blow.csv\""));
    std::fs::create_dir(place.path().join("data")).unwrap();
    std::fs::write(place.path().join("data/blow.csv"), "t,force\n0,0\n0.0005,4000\n0.001,0\n").unwrap();
    run(place.path(), "in.toml --out one");
    assert!(names(&place.path().join("one")).contains(&"force.csv".to_string()));
    run(place.path(), "one/scenario.toml --out two");
    assert_eq!(bytes(place.path(), "one/response.csv"), bytes(place.path(), "two/response.csv"));
    std::fs::write(place.path().join("data/blow.csv"), "t,force\n0,0\n0.0005,4000\n0.002,0\n").unwrap();
    let output = iwan(place.path(), "simulate in.toml --out three");
    assert!(output.status.success());
    assert!(String::from_utf8_lossy(&output.stderr).contains("note: "), "{}", shown(&output));
}

#[test]
fn formats_agree() {
    let place = folder(SMALL);
    run(place.path(), "in.toml --out csv");
    run(place.path(), "in.toml --out npz --format npz");
    run(place.path(), "in.toml --out parquet --format parquet");
    assert!(names(&place.path().join("parquet")).contains(&"response.parquet".to_string()));
    let text = csv(&place.path().join("csv/response.csv"));
    let record = bytes(place.path(), "npz/response.npz");
    for (name, values) in text {
        let data: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        assert!(record.windows(data.len()).any(|w| w == data), "{name}");
    }
}

#[test]
fn nothing_is_overwritten_without_force() {
    let place = folder(SMALL);
    run(place.path(), "in.toml --out out");
    std::fs::write(place.path().join("out/notes.txt"), "mine").unwrap();
    let before = bytes(place.path(), "out/summary.json");
    let output = iwan(place.path(), "simulate in.toml --out out");
    insta::assert_snapshot!(shown(&output));
    assert_eq!(bytes(place.path(), "out/summary.json"), before);
    run(place.path(), "in.toml --out out --force --duration 0.05");
    assert_ne!(bytes(place.path(), "out/summary.json"), before);
    assert_eq!(bytes(place.path(), "out/notes.txt"), b"mine");
}

#[test]
fn quiet_is_quiet_and_warnings_are_words() {
    let coarse =
        SMALL.replace("step = 1.0e-4", "step = 1.0e-3").replace("duration = 1.6e-3", "duration = 8.0e-3");
    let place = folder(&coarse);
    let output = iwan(place.path(), "simulate in.toml --out loud");
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(text.contains("warning: mode \"linear\": only 3.3 samples in a cycle"), "{text}");
    assert!(text.contains("shorten step"), "{text}");
    let output = iwan(place.path(), "simulate in.toml --out quiet --quiet");
    assert!(output.status.success() && output.stderr.is_empty());
}

#[test]
fn an_overflow_is_a_failed_computation() {
    let place = folder(&SMALL.replace("amplitude = 4000.0", "amplitude = 1e308"));
    let output = iwan(place.path(), "simulate in.toml --out new/folder/out");
    assert_eq!(output.status.code(), Some(1), "{}", shown(&output));
    assert_eq!(names(place.path()), ["in.toml"]);
}

#[test]
fn the_report_has_all_figures() {
    let place = folder(SMALL);
    run(place.path(), "in.toml --out out");
    let page = String::from_utf8(bytes(place.path(), "out/report.html")).unwrap();
    assert!(page.len() < 2_000_000);
    // One force, two points, eight of the mode with a joint, five of the linear one.
    assert_eq!(page.matches("<svg").count(), 1 + 4 + 8 + 5);
    for svg in page.split("<svg").skip(1) {
        let svg = &svg[..svg.find("</svg>").unwrap()];
        let drawn = svg.matches("<circle").count() + svg.matches('L').count();
        assert!(drawn >= 20, "an empty figure: {svg}");
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        assert!(svg.matches("class=\"label\"").count() == 2 && svg.contains("class=\"tick\""));
    }
    assert!(!page.contains("<script") && !page.contains("http"), "the page must stand alone");
    assert!(page.contains("[[mode]]") && page.contains("Energy balance"));
}

#[test]
fn rest_is_a_result_too() {
    let place = folder(
        "[[mode]]\nname = 'a <b> & \"c\", d'\nfrequency = 10\n[force]\nkind = 'none'\n[time]\nstep = 1e-3\nduration = 1.0\n",
    );
    let summary = run(place.path(), "in.toml --out out");
    assert_eq!(summary["modes"][0]["peak_displacement"], 0.0);
    assert_eq!(summary["modes"][0]["phi_max"], Value::Null);
    let page = String::from_utf8(bytes(place.path(), "out/report.html")).unwrap();
    assert!(page.contains("a &lt;b&gt; &amp;") && !page.contains("NaN"));
}

#[test]
fn methods_agree_and_repeat() {
    let place = folder(SMALL);
    let mut finals = Vec::new();
    for method in ["newmark", "half-cycle", "averaging", "event"] {
        run(place.path(), &format!("in.toml --step 2e-5 --method {method} --out {method}"));
        let summary = run(place.path(), &format!("{method}/scenario.toml --out {method}-2"));
        assert_eq!(summary["method"], method);
        let [one, two] = ["", "-2"].map(|n| bytes(place.path(), &format!("{method}{n}/response.csv")));
        assert!(one == two, "{method} does not repeat");
        finals.push(summary["modes"][0]["final_displacement"].as_f64().unwrap());
    }
    let peak = 0.004;
    assert!(finals.iter().all(|q| (q - finals[0]).abs() < 0.03 * peak), "{finals:?}");
}

#[test]
fn missing_parents_are_made_and_other_files_kept() {
    let place = folder(SMALL);
    std::fs::create_dir_all(place.path().join("a")).unwrap();
    std::fs::write(place.path().join("a/mine.txt"), "mine").unwrap();
    run(place.path(), "in.toml --out a");
    run(place.path(), "in.toml --out a/b/c");
    let expected = ["b", "mine.txt", "report.html", "response.csv", "scenario.toml", "summary.json"];
    assert_eq!(names(&place.path().join("a")), expected);
    assert_eq!(names(&place.path().join("a/b")), ["c"]);
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_nothing_behind() {
    let long = SMALL.replace("step = 1.0e-4", "step = 1.0e-6").replace("duration = 0.1", "duration = 5.0");
    let place = folder(&long);
    let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin!("iwan"))
        .args(["simulate", "in.toml", "--out", "out"])
        .current_dir(place.path())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    // The hidden folder for the results appears once Ctrl-C is being watched for.
    let started = std::time::Instant::now();
    while names(place.path()).len() == 1 && started.elapsed().as_secs() < 60 {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let id = child.id().to_string();
    assert!(std::process::Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    let code = child.wait().unwrap().code();
    let mut text = String::new();
    std::io::Read::read_to_string(child.stderr.as_mut().unwrap(), &mut text).unwrap();
    assert_eq!((code, text.as_str()), (Some(130), "interrupted: nothing was written\n"));
    assert_eq!(names(place.path()), ["in.toml"]);
}

/// A pendulum with parts, and a mode by its curves from a file: both run, are written out and run again to the same bits, and
/// what leaves the curves is said.
#[test]
fn parts_and_curves_run_and_survive() {
    let scenario = "[[mode]]\nname = 'pendulum'\nfrequency = 0.5\ndamping_ratio = 0.002\ninitial = { displacement = 0.8 }\n\
        parts = [{ law = 'coulomb', force = 0.004 }, { law = 'power-damping', c = 0.03, n = 2 }, \
        { law = 'spring', k = -1.64, exponent = 3 }]\n\
        [[mode]]\nname = 'measured'\ncurves = 'curves.csv'\ninitial = { displacement = 0.01 }\n\
        [force]\nkind = 'none'\n[time]\nstep = 0.004\nduration = 20\n";
    let place = folder(scenario);
    let curves = "amplitude,frequency,damping_ratio\n0.003,1.0,0.01\n0.01,0.99,0.02\n";
    std::fs::write(place.path().join("curves.csv"), curves).unwrap();
    let summary = run(place.path(), "in.toml --out out");
    // SciPy (tests/peers/pendulum.py): q(20 s) = 7.292744e-2.
    let [pendulum, measured] = [0, 1].map(|n| summary["modes"][n].clone());
    assert!((pendulum["final_displacement"].as_f64().unwrap() - 7.292744e-2).abs() < 1e-4, "{pendulum}");
    assert!(pendulum["energy_error"].as_f64().unwrap() < 1e-11, "{pendulum}");
    let below = measured["below_curves_from"].as_f64().unwrap();
    assert!(pendulum.get("below_curves_from").is_none() && below > 10.0 && below < 20.0, "{measured}");
    let warnings = summary["warnings"].to_string();
    assert!(warnings.contains("below the smallest of the curves"), "{warnings}");
    assert!(iwan(place.path(), "simulate out/scenario.toml --out again").status.success());
    assert_eq!(bytes(place.path(), "out/response.csv"), bytes(place.path(), "again/response.csv"));
    let page = String::from_utf8(bytes(place.path(), "out/report.html")).unwrap();
    assert!(page.contains("3 parts stand beside it") && page.contains("known by its curves"));
}

/// Beyond the curves the run fails with the amplitude, the time and what allows it, and leaves no files.
#[test]
fn a_run_beyond_its_curves_is_refused() {
    let scenario = "[[mode]]\nname = 'measured'\n\
        curves = { amplitude = [0.001, 0.01], frequency = [1, 0.99], damping_ratio = [0.01, 0.02] }\n\
        initial = { displacement = 0.02 }\n[force]\nkind = 'none'\n[time]\nstep = 0.01\nduration = 5\n";
    let place = folder(scenario);
    let output = iwan(place.path(), "simulate in.toml --out out");
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("2e-2") && text.contains("extrapolate = true"), "{text}");
    assert_eq!(names(place.path()), ["in.toml"]);
    let allowed = folder(&scenario.replace("[0.01, 0.02] }", "[0.01, 0.02], extrapolate = true }"));
    let summary = run(allowed.path(), "in.toml --out out");
    assert_eq!(summary["modes"][0]["above_curves_from"], 0.0, "{summary}");
}
