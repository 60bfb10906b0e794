//! `iwan modes` and `iwan quasi-static`: numbers of the paper's beam, files, and messages about bad structures.
#![allow(clippy::unwrap_used)]

use crate::common::{csv, folder, iwan, shown};
use serde_json::Value;

fn json(output: &std::process::Output) -> Value {
    assert!(output.status.success(), "{}", shown(output));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn close(value: &Value, expected: f64, tolerance: f64) {
    let value = value.as_f64().unwrap();
    assert!((value / expected - 1.0).abs() <= tolerance, "{value}, expected {expected}");
}

#[test]
fn modes_of_the_papers_beam() {
    let place = folder("");
    let found = json(&iwan(place.path(), "modes --json --quiet --out modes --count 8"));
    close(&found["stuck"][0], 132.3509, 1e-5);
    close(&found["slipping"][0], 127.7660, 1e-5);
    assert_eq!(found["zero_modes"], serde_json::json!({ "stuck": 6, "slipping": 12 }));
    let expected =
        [(132.3509, 127.7660, 4.708e4), (344.2292, 344.3195, -2.46e3), (696.2418, 676.3752, 1.0765e6)];
    for (pair, (stuck, slipping, k_t)) in found["joint_modes"].as_array().unwrap().iter().zip(expected) {
        assert_eq!(pair["class"], "bending");
        close(&pair["frequency_stuck"], stuck, 1e-5);
        close(&pair["frequency_slipping"], slipping, 1e-5);
        close(&pair["k_t"], k_t, 5e-3);
        assert!(pair["mac"].as_f64().unwrap() > 0.9988);
    }
    let names: Vec<_> =
        found["modes"].as_array().unwrap().iter().map(|m| m["name"].as_str().unwrap()).collect();
    assert_eq!(names[..5], ["bending 1", "bending 2", "bending 3", "torsion 1", "lateral 1"]);
    assert_eq!(names.len(), 8);
    let read = |name: &str| std::fs::read(place.path().join("modes").join(name)).unwrap();
    let table = String::from_utf8(read("modes.csv")).unwrap();
    assert!(table.starts_with("mode,frequency_stuck,frequency_slipping,k_t,mac\n"), "{table}");
    assert!(table.lines().nth(1).unwrap().contains(",132.35089"), "{table}");
    assert!(read("modes.vtu").starts_with(b"<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\""));
    let report = String::from_utf8(read("report.html")).unwrap();
    assert_eq!(report.matches("<svg class=\"solid\"").count(), 9);
    assert!(!report.contains("NaN"));
    let summary: Value = serde_json::from_slice(&read("summary.json")).unwrap();
    assert_eq!(summary["joint_modes"], found["joint_modes"]);
}

#[test]
fn quasi_static_curves_of_the_papers_beam() {
    let place = folder("");
    let arguments = "quasi-static --json --quiet --out q --from 1.989e-4 --to 4.981e-2 --points 33";
    let found = json(&iwan(place.path(), &format!("{arguments} --mode bending-1")));
    let mode = &found["modes"][0];
    assert_eq!(mode["name"], "bending 1");
    close(&mode["frequency"][0], 132.2419, 0.01 / 132.0);
    close(&mode["dissipation"][0], 4.722e-5, 0.01);
    close(&mode["frequency"][32], 128.2020, 0.01 / 128.0);
    close(&mode["dissipation"][32], 37.31, 0.01);
    // The fitted joint: K_T is that of the modes. An exact fit is not to be had, and no second program has fitted this one: F_S is only
    // held below the 239.4 that Table 2 prints for the other configuration, and χ above the joints' own -0.3 (Table 1).
    close(&mode["k_t"], 4.708e4, 5e-3);
    assert!((205.0..239.0).contains(&mode["f_s"].as_f64().unwrap()), "{}", mode["f_s"]);
    assert!((-0.3..-0.1).contains(&mode["chi"].as_f64().unwrap()), "{}", mode["chi"]);
    assert!(mode["dissipation_misfit"].as_f64().unwrap() < 0.15);
    for key in ["displacement", "frequency", "dissipation", "joint_force"] {
        assert_eq!(mode[key].as_array().unwrap().len(), 33);
    }
    let table = std::fs::read_to_string(place.path().join("q/curves.csv")).unwrap();
    assert!(
        table.starts_with("mode,displacement,frequency,dissipation,joint_force,left link x.slip,"),
        "{table}"
    );
    assert_eq!(table.lines().count(), 34);
}

/// Mode 2 is linear: it is said, and nothing is fitted.
#[test]
fn a_mode_that_no_joint_softens_is_called_linear() {
    let place = folder("");
    let output =
        iwan(place.path(), "quasi-static --json --out q --from 1e-3 --to 1e-2 --points 8 --mode bending-2");
    let mode = &json(&output)["modes"][0];
    assert!(mode["k_t"].is_null() && mode["f_s"].is_null());
    assert!(mode["remark"].as_str().unwrap().contains("is not positive: slipping does not soften this mode"));
    assert!(String::from_utf8(output.stderr).unwrap().contains("warning: bending 2: K_T = -2.4"));
}

const BLOW: &str = "\
title = 'a blow'
[structure]
name = 'paper-a'
[force]
kind = 'haversine'
amplitude = 10.0
duration = 1.6e-3
[time]
step = 1e-5
duration = 0.03
";

/// Peaks of spec and prototype at 10 lbf, the reduced model with a basis of its own choice.
#[test]
fn a_blow_on_the_papers_beam() {
    let place = folder(&BLOW.replace("name = 'paper-a'", "name = 'paper-a'\nframes = 3"));
    let found = json(&iwan(place.path(), "simulate in.toml --json --quiet --out o"));
    for (mode, peak) in found["modes"].as_array().unwrap().iter().zip([220.78, 328.67, 337.47]) {
        close(&mode["peak_acceleration"], peak, 2e-3);
        assert!(mode["energy_error"].as_f64().unwrap() < 1e-12);
        assert!(mode["time_step_error"].as_f64().unwrap() < 0.02);
        assert!(mode["discretisation_error"].as_f64().unwrap() < 0.01);
        assert_eq!(mode["steps"], 3000);
    }
    close(&found["modes"][0]["slip_ratio"], 0.0289, 0.02);
    assert_eq!(found["points"][0]["name"], "tip");
    let structure = &found["structure"];
    assert_eq!((&structure["model"], &structure["converged"]), (&"reduced".into(), &true.into()));
    assert_eq!(structure["slips"].as_array().unwrap().len(), 8);
    let read = |name: &str| std::fs::read_to_string(place.path().join("o").join(name)).unwrap();
    let response = read("response.csv");
    let head = response.lines().next().unwrap();
    assert!(head.starts_with(
        "t,bending 1.displacement,bending 1.velocity,bending 1.acceleration,bending 1.joint_force,"
    ));
    assert!(
        head.contains(",tip.displacement,tip.velocity,tip.acceleration,left link x.slip,left link x.force,")
    );
    assert_eq!(response.lines().count(), 3002);
    let series = read("response.pvd");
    assert!(
        series.contains("timestep=\"0.03") && series.contains("part=\"0\" file=\"frame-2.vtu\""),
        "{series}"
    );
    assert!(place.path().join("o/frame-2.vtu").exists());
    let report = read("report.html");
    assert!(report.contains("Joint left link x") && !report.contains("NaN"));
    // The run as written repeats it to the last bit.
    json(&iwan(place.path(), "simulate o/scenario.toml --json --quiet --out again"));
    assert_eq!(std::fs::read_to_string(place.path().join("again/response.csv")).unwrap(), response);
}

/// In micro-slip the modal joint force is next to K_T q.
#[test]
fn full_and_reduced_models_agree() {
    let short = BLOW.replace("duration = 0.03", "duration = 0.004");
    let fixed = short.replace("name = 'paper-a'", "name = 'paper-a'\nbasis = 50");
    let place = folder(&short.replace("name = 'paper-a'", "name = 'paper-a'\nmodel = 'full'"));
    std::fs::write(place.path().join("reduced.toml"), fixed).unwrap();
    let full = json(&iwan(place.path(), "simulate in.toml --json --quiet --out full"));
    let reduced = json(&iwan(place.path(), "simulate reduced.toml --json --quiet --out reduced"));
    for mode in 0..3 {
        let peak = full["modes"][mode]["peak_displacement"].as_f64().unwrap();
        close(&reduced["modes"][mode]["peak_displacement"], peak, 1e-4);
        assert!(full["modes"][mode]["time_step_error"].is_null());
    }
    let table = std::fs::read_to_string(place.path().join("full/response.csv")).unwrap();
    let rows: Vec<Vec<f64>> =
        table.lines().skip(1).map(|line| line.split(',').map(|x| x.parse().unwrap()).collect()).collect();
    let last = rows.last().unwrap();
    assert!((last[4] / (4.708e4 * last[1]) - 1.0).abs() < 0.1, "{} {}", last[4], last[1]);
}

#[test]
fn what_cannot_be_computed_is_named_and_nothing_is_written() {
    let structure = block();
    let missing = BLOW.replace("name = 'paper-a'", "path = 'none.toml'");
    let unnamed = BLOW.replace("name = 'paper-a'", "name = 'paper-a'\nmodes = ['bending 99']");
    let loose = BLOW.replace("name = 'paper-a'", "path = 'block.toml'");
    let cases = [
        (
            "modes bad.toml --out o",
            "[mesh]\nkind = 'block'\n",
            "bad.toml:1:1: [mesh]: the key `size` is missing",
        ),
        (
            "modes bad.toml --out o",
            "[msh]\n",
            "bad.toml:1:2: unknown key `msh` in the structure\nremedy: did you mean `mesh`?",
        ),
        ("simulate bad.toml --out o", &loose, "the structure has no [[load]]: the force acts nowhere"),
        ("simulate bad.toml --out o", &unnamed, "paper-a: there is no mode \"bending 99\""),
        ("simulate bad.toml --out o", &missing, "none.toml: cannot be read"),
        ("quasi-static --out o --mode bending-77", "", "paper-a: there is no mode \"bending-77\""),
        ("quasi-static --out o --from 2 --to 1", "", "the range of modal displacements is empty"),
        ("quasi-static bad.toml --out o", &structure, "the structure has no joint with a law"),
    ];
    for (arguments, text, expected) in cases {
        let place = folder("");
        std::fs::write(place.path().join("bad.toml"), text).unwrap();
        std::fs::write(place.path().join("block.toml"), &structure).unwrap();
        let output = iwan(place.path(), arguments);
        assert_eq!(output.status.code(), Some(2), "{}", shown(&output));
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(message.contains(expected), "{message}\n{expected}");
        assert!(!place.path().join("o").exists());
    }
}

/// A block without joints.
fn block() -> String {
    "[mesh]\nkind = 'block'\nsize = [4, 1, 1]\ncells = [4, 1, 1]\n[[material]]\nyoung = 1e6\npoisson = 0.3\ndensity = 1\n".into()
}

/// The modes with the joints they share, from the structure to their response.
#[test]
fn a_structure_becomes_coupled_modes() {
    let place = folder("");
    iwan(place.path(), "quasi-static --json --quiet --out q --points 8");
    let arguments = "simulate q/coupled.toml --json --quiet --out s --amplitude 100 --duration 0.02";
    let found = json(&iwan(place.path(), arguments));
    let coupled = &found["coupled"];
    assert!(coupled["energy_error"].as_f64().unwrap() < 1e-13);
    let joint = &coupled["joints"][0];
    assert_eq!(
        (joint["name"].as_str(), coupled["joints"].as_array().unwrap().len()),
        (Some("left link x + right link x"), 1)
    );
    close(&joint["friction"], coupled["energy"]["friction"].as_f64().unwrap(), 1e-9);
    let columns = csv(&place.path().join("s/response.csv"));
    let slip = &columns.iter().find(|(name, _)| name == "left link x + right link x.slip").unwrap().1;
    let largest = slip.iter().fold(0.0_f64, |most, s| most.max(s.abs()));
    close(&joint["peak_slip"], largest, 1e-12);
    // As it was run, to the last bit.
    let again = json(&iwan(place.path(), "simulate s/scenario.toml --json --quiet --out t"));
    assert_eq!(again["coupled"]["joints"], coupled["joints"]);
}
