//! `iwan fit`: files, numbers, verdicts, and what comes out is a scenario that runs.
#![allow(clippy::unwrap_used, clippy::print_stderr, reason = "tests may panic and say why")]

use crate::common;
use std::path::Path;

use crate::common::{csv, folder, iwan, names, shown};
use serde_json::Value;

/// Mode 1 of Table 2 with a damper, released from rest: an exact ring-down.
const RELEASE: &str = r#"
[[mode]]
name = "b1"
frequency = 124.0
damping_ratio = 1.0e-3
joint = { k_t = 4.45e4, f_s = 239.4, chi = -0.183, beta = 0.3 }
initial = { displacement = 0.014 }
[force]
kind = "none"
[time]
step = 2.0e-4
duration = 0.6
[method]
kind = "half-cycle"
"#;

const TRUTH: [(&str, f64); 6] = [
    ("frequency", 124.0),
    ("damping_ratio", 1e-3),
    ("k_t", 4.45e4),
    ("f_s", 239.4),
    ("chi", -0.183),
    ("beta", 0.3),
];

fn run(place: &Path, arguments: &str) -> Value {
    let output = iwan(place, &format!("fit {arguments} --json"));
    assert!(output.status.success(), "{}", shown(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// A folder with `NAME.csv`, the acceleration after release at a displacement.
fn record(place: &Path, name: &str, displacement: &str) {
    record_of(place, name, &RELEASE.replace("0.014", displacement));
}

/// The same of any scenario of one mode.
fn record_of(place: &Path, name: &str, scenario: &str) {
    std::fs::write(place.join("in.toml"), scenario).unwrap();
    let output = iwan(place, &format!("simulate in.toml --out {name}-sim"));
    assert!(output.status.success(), "{}", shown(&output));
    let table = csv(&place.join(format!("{name}-sim/response.csv")));
    let rows = table[0].1.iter().zip(&table[3].1).map(|(t, a)| format!("{t},{a}\n"));
    std::fs::write(place.join(format!("{name}.csv")), format!("t,tip [m/s^2]\n{}", rows.collect::<String>()))
        .unwrap();
}

#[test]
fn a_ring_down_through_macro_slip_gives_all_parameters_and_a_scenario_that_runs() {
    let place = folder("");
    record(place.path(), "hard", "0.014");
    let fit = run(place.path(), "hard.csv --out out");
    let mode = &fit["modes"][0];
    for (key, truth) in TRUTH {
        let value = mode[key]["value"].as_f64().unwrap();
        assert!((value / truth - 1.0).abs() < 0.01, "{key}: {value}");
        assert_eq!(mode[key]["identifiable"], true, "{key}");
        let [low, high] = ["low", "high"].map(|end| mode[key][end].as_f64().unwrap());
        assert!(low <= value && value <= high, "{key}: {low} {value} {high}");
    }
    assert_eq!((&mode["adequate"], &mode["force_axis"]), (&Value::from(true), &Value::from("modal")));
    assert!(mode["misfit"].as_str().unwrap().contains("matches"));
    let lengths = ["amplitude", "frequency", "damping_ratio", "dissipation", "force"]
        .map(|key| mode["curves"][key].as_array().unwrap().len());
    assert!(lengths[0] > 20 && lengths.iter().all(|n| *n == lengths[0]), "{lengths:?}");
    assert_eq!(mode["law"], "iwan", "{}", mode["law_in_words"]);
    let expected = [
        "curves.csv",
        "fit.json",
        "report.html",
        "response.csv",
        "scenario-curves.toml",
        "scenario.toml",
        "summary.json",
    ];
    assert_eq!(names(&place.path().join("out")), expected);
    let written: Value =
        serde_json::from_slice(&std::fs::read(place.path().join("out/fit.json")).unwrap()).unwrap();
    assert_eq!(written["modes"], fit["modes"]);
    let short: Value =
        serde_json::from_slice(&std::fs::read(place.path().join("out/summary.json")).unwrap()).unwrap();
    assert_eq!(short["modes"][0]["curves"], Value::Null);

    // The scenario runs as it is, and the response in the folder is what it gives.
    let output = iwan(place.path(), "simulate out/scenario.toml --out again");
    assert!(output.status.success(), "{}", shown(&output));
    let bytes = |name: &str| std::fs::read(place.path().join(name)).unwrap();
    assert!(bytes("again/response.csv") == bytes("out/response.csv"));
    the_report_shows_it(&String::from_utf8(bytes("out/report.html")).unwrap());
    assert_eq!(iwan(place.path(), "fit hard.csv --out out").status.code(), Some(2), "nothing is overwritten");
}

fn the_report_shows_it(page: &str) {
    for title in [
        "95 % intervals",
        "Frequency against amplitude",
        "Damping ratio against amplitude",
        "Dissipation per cycle against force",
        "Density of the sliders",
        "Record and model",
        "Residual",
        "Profile likelihood of F_S",
        "Spectrum in the band",
    ] {
        assert!(page.contains(&format!("<strong>{title}")), "{title}");
    }
    for svg in page.split("<svg").skip(1) {
        let svg = &svg[..svg.find("</svg>").unwrap()];
        assert!(svg.matches("<circle").count() + svg.matches('L').count() >= 5, "an empty figure: {svg}");
        assert!(!svg.contains("NaN") && !svg.contains("inf\""), "{svg}");
    }
    assert!(page.contains("matches these records") && page.contains("[[mode]]") && !page.contains("<script"));
    assert!(page.len() < 2_000_000);
}

#[test]
fn micro_slip_leaves_the_knee_open_and_two_levels_are_one_structure() {
    let place = folder("");
    record(place.path(), "soft", "0.002");
    let fit = run(place.path(), "soft.csv --out soft");
    let mode = &fit["modes"][0];
    assert_eq!(mode["f_s"]["high"], Value::Null, "{}", mode["f_s"]);
    assert_eq!(mode["f_s"]["identifiable"], false);
    assert!((mode["chi"]["value"].as_f64().unwrap() / -0.183 - 1.0).abs() < 0.05, "{}", mode["chi"]);
    assert!(mode["in_words"].to_string().contains("no upper bound"), "{}", mode["in_words"]);

    record(place.path(), "hard", "0.014");
    let both = run(place.path(), "soft.csv hard.csv --out both --force-axis joint");
    let mode = &both["modes"][0];
    assert_eq!(both["records"].as_array().unwrap().len(), 2);
    assert_eq!(mode["releases"].as_array().unwrap().len(), 2);
    let days = mode["frequencies_of_records"].as_array().unwrap();
    let mean = days.iter().map(|day| day.as_f64().unwrap()).sum::<f64>() / 2.0;
    assert!((mean / mode["frequency"]["value"].as_f64().unwrap() - 1.0).abs() < 1e-4, "{days:?}");
    assert_eq!(
        (&mode["f_s"]["identifiable"], &mode["force_axis"]),
        (&Value::from(true), &Value::from("joint"))
    );
    assert!((mode["f_s"]["value"].as_f64().unwrap() / 239.4 - 1.0).abs() < 0.01);
    let records: Vec<u64> =
        mode["curves"]["record"].as_array().unwrap().iter().map(|n| n.as_u64().unwrap()).collect();
    assert!(records.contains(&1) && records.contains(&2) && records.is_sorted());
}

/// The band's filter rings on a wild sample for half of the record: what is left between it and the end was trusted for an instant only.
#[test]
fn one_wild_sample_ends_no_fit() {
    let place = folder("");
    let lines = soft(place.path());
    let largest = lines[1..].iter().map(|line| value(line).abs()).fold(0.0, f64::max);
    let wild = |(n, line): (usize, &String)| match n {
        301 => format!("{},{}", line.split(',').next().unwrap(), -30.0 * largest),
        _ => line.clone(),
    };
    let wild: Vec<String> = lines.iter().enumerate().map(wild).collect();
    std::fs::write(place.path().join("wild.csv"), wild.join("\n")).unwrap();
    let fit = run(place.path(), "wild.csv --out out");
    let mode = &fit["modes"][0];
    assert!((mode["frequency"]["value"].as_f64().unwrap() / 124.0 - 1.0).abs() < 0.01);
    let files = names(&place.path().join("out"));
    assert!(files.contains(&"scenario-curves.toml".to_string()));
    assert_eq!(fit["files"].as_array().unwrap().len(), files.len(), "{}", fit["files"]);
}

/// A block of samples that stands twice makes curves that jump: the fit ended in "frequency[4] = 75.1 is out of range".
#[test]
fn samples_that_stand_twice_end_no_fit() {
    let place = folder("");
    let lines = soft(place.path());
    let (before, after) = lines[1..].split_at(600);
    let twice = [before, &before[536..], after].concat();
    let rows = twice.iter().enumerate().map(|(n, line)| format!("{},{}\n", 2e-4 * n as f64, value(line)));
    std::fs::write(place.path().join("twice.csv"), format!("{}\n{}", lines[0], rows.collect::<String>()))
        .unwrap();
    let fit = run(place.path(), "twice.csv --out out");
    let files = names(&place.path().join("out"));
    assert!(
        files.contains(&"scenario.toml".to_string()) && !files.contains(&"scenario-curves.toml".to_string())
    );
    assert_eq!(fit["files"].as_array().unwrap().len(), files.len(), "{}", fit["files"]);
    let output = iwan(place.path(), "fit twice.csv --law curves --out again");
    assert_eq!(output.status.code(), Some(2), "{}", shown(&output));
    assert!(shown(&output).contains("no curve of a mode"), "{}", shown(&output));
}

/// The lines of `soft.csv`, a ring-down in micro-slip of a second, with their header.
fn soft(place: &Path) -> Vec<String> {
    record_of(place, "soft", &RELEASE.replace("0.014", "0.002").replace("0.6", "1.0"));
    let text = std::fs::read_to_string(place.join("soft.csv")).unwrap();
    text.lines().map(String::from).collect()
}

/// The value in a line.
fn value(line: &str) -> f64 {
    line.split(',').nth(1).unwrap().parse().unwrap()
}

#[test]
fn parameters_can_be_held_and_threads_change_nothing() {
    let place = folder("");
    record(place.path(), "soft", "0.002");
    let held =
        run(place.path(), "soft.csv --out held --hold beta=0.3 --hold damping_ratio=0.001 --threads 1");
    let mode = &held["modes"][0];
    assert_eq!(mode["beta"]["held"], true);
    assert!((mode["beta"]["value"].as_f64().unwrap() / 0.3 - 1.0).abs() < 1e-9);
    assert!((mode["damping_ratio"]["value"].as_f64().unwrap() / 1e-3 - 1.0).abs() < 1e-9);
    run(place.path(), "soft.csv --out again --hold beta=0.3 --hold damping_ratio=0.001 --threads 2");
    let bytes = |name: &str| std::fs::read(place.path().join(name).join("curves.csv")).unwrap();
    assert!(bytes("held") == bytes("again"));
}

#[test]
fn a_linear_mode_needs_no_joint() {
    let place = folder("");
    let text = common::ring_down(2048.0, 2048, &[(80.0, 0.004, 3.0)], &[&[1.0]], "tip [m/s^2]");
    // A little noise, as records have it.
    let mut seed = 1_u64;
    let noisy = text.lines().map(|line| match line.split_once(',').map(|(t, x)| (t, x.parse::<f64>())) {
        Some((t, Ok(x))) => {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            format!("{t},{}\n", x + 0.02 * ((seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5))
        }
        _ => format!("{line}\n"),
    });
    std::fs::write(place.path().join("tap.csv"), noisy.collect::<String>()).unwrap();
    let output = iwan(place.path(), "fit tap.csv --out words");
    assert!(shown(&output).contains("mode 1: a linear mode is enough"), "{}", shown(&output));
    let fit = run(place.path(), "tap.csv --out out");
    let mode = &fit["modes"][0];
    assert_eq!(mode["linear"]["is_enough"], true, "{}", mode["linear"]);
    assert!((mode["linear"]["frequency"].as_f64().unwrap() - 80.0).abs() < 0.01);
    assert!((mode["linear"]["damping_ratio"].as_f64().unwrap() / 0.004 - 1.0).abs() < 0.01);
    assert!(mode["in_words"].to_string().contains("the joint is not needed"));
}

#[test]
fn bad_input_leaves_nothing() {
    let place = folder("");
    let write = |name: &str, text: &str| std::fs::write(place.path().join(name), text).unwrap();
    let one = |names: &str| common::ring_down(1000.0, 3000, &[(80.0, 0.002, 1.0)], &[&[1.0]], names);
    write("acc.csv", &one("tip [m/s^2]"));
    write("other.csv", &one("root [m/s^2]"));
    write("slow.csv", &one("tip [m/s]"));
    write("short.csv", &common::ring_down(1000.0, 90, &[(80.0, 0.002, 1.0)], &[&[1.0]], "tip [m/s^2]"));
    let before = names(place.path());
    let mut all = Vec::new();
    for arguments in [
        "",
        "missing.csv",
        "acc.csv other.csv",
        "acc.csv slow.csv",
        "short.csv",
        "acc.csv --hold stiffness=3",
        "acc.csv --hold chi=-1",
        "acc.csv --hold beta",
        "acc.csv --method fourier",
    ] {
        let output = iwan(place.path(), &format!("fit {arguments} --out bad"));
        assert_eq!(output.status.code(), Some(2), "{arguments}: {}", shown(&output));
        assert!(output.stdout.is_empty());
        assert_eq!(names(place.path()), before, "something was written: {arguments}");
        all.push(format!("iwan fit {arguments}\n{}", String::from_utf8_lossy(&output.stderr)));
    }
    insta::assert_snapshot!(all.join("\n"));
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_a_fit_at_once_and_leaves_nothing_behind() {
    let place = folder("");
    // Two modes within a band of noise, and long: minutes of work.
    let modes = [(80.0, 0.0005, 3.0), (200.0, 0.0005, 1.0)];
    let text = common::ring_down(4096.0, 40_000, &modes, &[&[1.0, 1.0]], "tip [m/s^2]");
    std::fs::write(place.path().join("long.csv"), text).unwrap();
    let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin!("iwan"))
        .args(["fit", "long.csv", "--band", "60:105", "--band", "150:260", "--out", "out"])
        .current_dir(place.path())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    // The hidden folder for the results appears once Ctrl-C is being watched for.
    let started = std::time::Instant::now();
    while names(place.path()).len() == 2 && started.elapsed().as_secs() < 60 {
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    let id = child.id().to_string();
    assert!(std::process::Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert_eq!(names(place.path()), ["in.toml", "long.csv"]);
}

/// A pendulum: viscous, Coulomb and quadratic damping with a cubic spring, and no joint.
const PENDULUM: &str = r#"
[[mode]]
name = "p"
frequency = 20.0
damping_ratio = 2.0e-3
parts = [
    { law = "coulomb", force = 0.02 },
    { law = "power-damping", c = 0.015, n = 2 },
    { law = "spring", k = -800.0, exponent = 3 },
]
initial = { displacement = 1.0 }
[force]
kind = "none"
[time]
step = 1.0e-3
duration = 8.0
"#;

#[test]
fn a_pendulum_is_named_for_what_it_is_and_its_law_and_curves_run() {
    let place = folder("");
    record_of(place.path(), "p", PENDULUM);
    let fit = run(place.path(), "p.csv --out out");
    let mode = &fit["modes"][0];
    // The dry friction is small: the law without it can be within noise.
    let law = mode["law"].as_str().unwrap();
    assert!(["duffing-coulomb-quadratic", "duffing-quadratic"].contains(&law), "{}", mode["law_in_words"]);
    assert_ne!(mode["grade"], "matches");
    let laws = mode["laws"].as_array().unwrap();
    let named = laws.iter().find(|l| l["name"] == mode["law"]).unwrap();
    assert!(named["dissipation_misfit"].as_f64().unwrap() < 0.02 && named["grade"] == "matches", "{named}");
    let whole: Value =
        serde_json::from_slice(&std::fs::read(place.path().join("out/fit.json")).unwrap()).unwrap();
    let backbone = &whole["modes"][0]["backbone"];
    let column = |key: &str| -> Vec<f64> {
        backbone[key].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
    };
    let (f, low, high) = (column("frequency"), column("frequency_low"), column("frequency_high"));
    assert!(f.len() > 7 && (0..f.len()).all(|i| low[i] < f[i] && f[i] < high[i]));
    // Each scenario runs as it is, and begins at the amplitude at which the record does.
    for name in ["scenario", "scenario-law", "scenario-curves"] {
        let output = iwan(place.path(), &format!("simulate out/{name}.toml --out {name} --json"));
        assert!(output.status.success(), "{name}: {}", shown(&output));
        let said: Value = serde_json::from_slice(&output.stdout).unwrap();
        let peak = said["modes"][0]["peak_displacement"].as_f64().unwrap();
        assert!((peak - 1.0).abs() < 0.15, "{name}: {peak}");
    }
    // Asked for another law, scenario.toml is that one's.
    let asked = run(place.path(), "p.csv --law duffing --out duffing");
    assert_eq!(asked["modes"][0]["law"], "duffing");
    let toml = std::fs::read_to_string(place.path().join("duffing/scenario.toml")).unwrap();
    assert!(toml.contains("law = \"spring\"") && !toml.contains("joint = {"), "{toml}");
    let output = iwan(place.path(), "fit p.csv --law pendulum");
    assert_eq!(output.status.code(), Some(2), "{}", shown(&output));
}
