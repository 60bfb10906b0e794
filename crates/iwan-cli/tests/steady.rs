//! `iwan frf` and `iwan backbone`: files, contract, what is refused.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::path::Path;

use crate::common::{csv, folder, iwan, names, shown};
use serde_json::Value;
use tempfile::TempDir;

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

/// A mass of 2 on a spring of 1000 and a joint, both to node 1, which moves with the base: one mode of its own.
fn hung() -> TempDir {
    let place = folder("");
    let write = |name: &str, text: &str| std::fs::write(place.path().join(name), text).unwrap();
    let matrix = |entries: &str| format!("%%MatrixMarket matrix coordinate real symmetric\n2 2 {entries}");
    write("k.mtx", &matrix("3\n1 1 1000\n2 1 -1000\n2 2 1000\n"));
    write("m.mtx", &matrix("2\n1 1 5\n2 2 2\n"));
    write("rows.csv", "node,component\n1,x\n2,x\n");
    let structure = "[matrices]\nstiffness = 'k.mtx'\nmass = 'm.mtx'\nrows = 'rows.csv'\n\
        [[joint]]\nname = 'bolt'\nface = '2'\npatch = '1'\nmotion = 'directions'\n\
        slip = [{ direction = 'x', law = { k_t = 400.0, f_s = 3.0, chi = -0.3, beta = 0.1 } }]\n\
        [[load]]\nname = 'push'\nnodes = '2'\ndirection = 'x'\n\
        [[output]]\nname = 'tip'\nnodes = '2'\ndirection = 'x'\n";
    write("free.toml", structure);
    write("hung.toml", &format!("{structure}[[support]]\nname = 'wall'\nnodes = '1'\nfixed = ['x']\n"));
    place
}

/// Base and force, held force and held response: a structure of one freedom is the mode that it is.
#[test]
fn a_structure_on_its_base_is_its_mode() {
    let place = hung();
    let run_on = |what: &str, name: &str, sweep: &str| {
        let text = format!("{what}[sweep]\nfrom = 3.2\nto = 5.0\n{sweep}\nat = 'tip'\n");
        std::fs::write(place.path().join(format!("{name}.toml")), text).unwrap();
        run(place.path(), &format!("frf {name}.toml --out {name}"))
    };
    let on = "[structure]\npath = 'hung.toml'\n";
    // q = √2 u; the base moves the mode by its participation √2, the load by its shape 1/√2.
    let mode = |at_force: f64| {
        format!(
            "[[mode]]\nname = 'mass'\nfrequency = {:?}\ndamping_ratio = 0.01\nshape_at_force = {at_force:?}\n\
             outputs = {{ tip = {:?} }}\njoint = {{ k_t = 200.0, f_s = {:?}, chi = -0.3, beta = 0.1 }}\n",
            700_f64.sqrt() / std::f64::consts::TAU,
            0.5_f64.sqrt(),
            3.0 * 0.5_f64.sqrt()
        )
    };
    let cases = [
        ("base", "base_acceleration = [0.1, 1.0]", "direction = [2.0, 0.0, 0.0]", 2_f64.sqrt()),
        ("held", "acceleration = [0.5, 5.0]", "", 0.5_f64.sqrt()),
    ];
    for (name, levels, direction, at_force) in cases {
        let found =
            run_on(on, &format!("{name}_whole"), &format!("{levels}\n{direction}\ndamping_ratio = 0.01"));
        let own = run_on(&mode(at_force), &format!("{name}_mode"), levels);
        for level in 0..2 {
            let peak = |of: &Value, key: &str| of["modes"][0]["levels"][level]["peak"][key].as_f64().unwrap();
            for key in ["frequency", "amplitude", "excitation"] {
                let (whole, mode) = (peak(&found, key), peak(&own, key));
                // Where a response is held, the least force is that of the points, which are not the same.
                let room = if name == "held" { 5e-4 } else { 1e-4 };
                assert!((whole / mode - 1.0).abs() < room, "{name} {level} {key}: {whole} {mode}");
            }
        }
    }
    let refused = |file: &str, sweep: &str, message: &str| {
        let text = format!("[structure]\npath = '{file}.toml'\n[sweep]\nfrom = 3\nto = 5\n{sweep}\n");
        std::fs::write(place.path().join("bad.toml"), text).unwrap();
        let output = iwan(place.path(), "frf bad.toml --out bad");
        let said = String::from_utf8(output.stderr.clone()).unwrap();
        assert!(output.status.code() == Some(2) && said.contains(message), "{}", shown(&output));
    };
    refused(
        "free",
        "base_acceleration = [1]\ndirection = [1, 0, 0]",
        "nothing holds the structure to its base",
    );
    refused("hung", "base_acceleration = [1]", "needs the direction");
    refused("hung", "force = [1]\ndirection = [1, 0, 0]", "direction is that of base_acceleration");
    refused("hung", "base_acceleration = [1]\ndirection = [0, 0, 0]", "not all 0");
    refused("hung", "force = [1]\nat = 'moon'", "there is no [[output]] \"moon\"");
}

/// Bands without a resonance, structures that nothing holds, masses that hang by their joint alone.
#[test]
fn structures_at_the_ends_of_what_can_be_asked() {
    let place = hung();
    let write = |name: &str, text: &str| std::fs::write(place.path().join(name), text).unwrap();
    let run_on = |file: &str, name: &str, sweep: &str| {
        let text = format!(
            "[structure]\npath = '{file}.toml'\n[sweep]\n{sweep}\nat = 'tip'\ndamping_ratio = 0.01\n"
        );
        write(&format!("{name}.toml"), &text);
        let output = iwan(place.path(), &format!("frf {name}.toml --out {name} --json"));
        assert!(output.status.success(), "{}", shown(&output));
        (shown(&output), csv(&place.path().join(name).join("frf.csv")))
    };
    let (said, table) = run_on("hung", "above", "from = 6\nto = 8\nforce = [0.1]");
    assert!(said.contains("no mode has its resonance between 6 and 8 Hz"), "{said}");
    // Above the only resonance the mass alone is left.
    let line = |omega: f64| 0.1 / (2.0 * (omega * omega - 700.0));
    for (frequency, amplitude) in column(&table, "frequency").iter().zip(column(&table, "amplitude")) {
        let stuck = line(std::f64::consts::TAU * frequency);
        assert!((amplitude / stuck - 1.0).abs() < 0.02, "{frequency} {amplitude} {stuck}");
    }
    // Two free masses of 7 together: far below resonance they move as one.
    let (_, table) = run_on("free", "low", "from = 0.01\nto = 0.05\nforce = [0.1]");
    for (frequency, amplitude) in column(&table, "frequency").iter().zip(column(&table, "amplitude")) {
        let rigid = 0.1 / (7.0 * (std::f64::consts::TAU * frequency).powi(2));
        assert!((amplitude / rigid - 1.0).abs() < 1e-3, "{frequency} {amplitude} {rigid}");
    }
    // The joint alone holds the mass. Beyond 4 F_S/π inertia takes what friction, in quadrature or not, leaves of the force.
    write("k.mtx", "%%MatrixMarket matrix coordinate real symmetric\n2 2 2\n1 1 1e-9\n2 2 1e-9\n");
    let (_, table) = run_on("hung", "alone", "from = 0.5\nto = 5\nforce = [5.0]");
    let (first, friction) = (column(&table, "amplitude")[0], 4.0 * 3.0 / std::f64::consts::PI);
    let inertia = 2.0 * (std::f64::consts::TAU * column(&table, "frequency")[0]).powi(2) * first;
    assert!(inertia > (25.0 - friction * friction).sqrt() && inertia < 5.0 + friction, "{inertia}");
}

/// The third harmonic of mode 1 meets mode 2, and `iwan frf` says so.
#[test]
fn superharmonic_resonances_are_found() {
    let text = SHARED.replace("719.6", "375.0\ndamping_ratio = 1e-3").replace("-4.905", "-2.0");
    let text = text.replace("= 132.35", "= 132.35\ndamping_ratio = 1e-3").replace("to = 135.0", "to = 130.0");
    let text = text.replace("from = 125.0", "from = 115.0").replace("[0.1, 20.0]", "[20.0, 200.0]");
    let place = folder(&format!("{text}at = 'tip'\n"));
    let summary = run(place.path(), "frf in.toml --out out");
    for level in summary["modes"][0]["levels"].as_array().unwrap() {
        // One, just below a third of mode 2's frequency; the primary resonance is none.
        let found = level["superharmonics"].as_array().unwrap();
        let at = found[0]["frequency"].as_f64().unwrap();
        assert!(found.len() == 1 && found[0]["harmonic"] == 3 && (124.0..125.0).contains(&at), "{summary}");
    }
}

const SHARED: &str = r#"
[[mode]]
name = "bending 1"
frequency = 132.35
outputs = { tip = 20.0 }
[[mode]]
name = "bending 3"
frequency = 719.6
outputs = { tip = -15.0 }
[[joint]]
name = "link"
law = { k_t = 3.16e4, f_s = 143.8, chi = -0.3, beta = 0.02 }
participation = { "bending 1" = 1.0, "bending 3" = -4.905 }
compliance = 9.1e-6
[sweep]
from = 125.0
to = 135.0
force = [0.1, 20.0]
harmonics = 3
"#;

#[test]
fn modes_that_share_a_joint_vibrate_together() {
    let place = folder(SHARED);
    let summary = run(place.path(), "frf in.toml --out out");
    let modes = summary["modes"].as_array().unwrap();
    assert_eq!((modes.len(), &modes[0]["name"]), (1, &"bending 1".into()), "{summary}");
    let of = |level: usize, key: &str| modes[0]["levels"][level]["peak"][key].as_f64().unwrap();
    assert!((of(0, "frequency") - 132.35).abs() < 0.2 && of(1, "frequency") < 131.9, "{summary}");
    // The peak lies on the nonlinear mode of the same amplitude.
    let (low, high) = (0.5 * of(0, "amplitude"), of(1, "amplitude"));
    let arguments =
        format!("backbone in.toml --from {low:e} --to {high:e} --points 9 --harmonics 3 --out curves");
    let backbone = run(place.path(), &arguments);
    let mode = &backbone["modes"][0];
    let last = mode["frequency"][8].as_f64().unwrap();
    assert!((last / of(1, "frequency") - 1.0).abs() < 1e-4, "{last} {summary}");
    assert!(mode["damping_ratio"][8].as_f64().unwrap() > 1e-3, "{backbone}");
    assert_eq!(backbone["modes"].as_array().unwrap().len(), 2);
    // At a point, modes superpose: almost all of the motion is mode 1's.
    std::fs::write(place.path().join("tip.toml"), format!("{SHARED}at = 'tip'\n")).unwrap();
    let tip = run(place.path(), "frf tip.toml --out tip");
    let ratio = tip["modes"][0]["levels"][1]["peak"]["amplitude"].as_f64().unwrap() / of(1, "amplitude");
    assert!((ratio / 20.0 - 1.0).abs() < 0.02, "{ratio}");
}

/// A shaker's test that `iwan frf` and `iwan backbone` computed gives the mode back, and the scenario says what it was informed of.
#[test]
fn sweeps_and_backbones_give_the_mode_back() {
    let place = folder(&format!("{MODE}{SWEEP}points = 60\n"));
    run(place.path(), "frf in.toml --out shaker");
    run(place.path(), "backbone in.toml --from 1e-5 --to 1e-3 --points 20 --out pll");
    let fit = run(place.path(), "fit --sweep shaker/frf.csv --backbone pll/backbone.csv --out fit");
    let mode = &fit["modes"][0];
    assert_eq!((&mode["adequate"], &mode["grade"]), (&true.into(), &"matches".into()), "{fit}");
    for (key, truth) in
        [("frequency", 124.0), ("k_t", 4.45e4), ("f_s", 239.4), ("chi", -0.183), ("beta", 0.3)]
    {
        let found = mode[key]["value"].as_f64().unwrap();
        assert!((found / truth - 1.0).abs() < 1e-3, "{key} {found} {fit}");
        assert_eq!(mode[key]["identifiable"], true, "{key} {fit}");
    }
    let files = ["curves.csv", "fit.json", "report.html", "scenario.toml", "summary.json"];
    assert_eq!(names(&place.path().join("fit")), files);
    // The same levels are inside what was measured; ten times the force is not.
    let scenario = std::fs::read_to_string(place.path().join("fit/scenario.toml")).unwrap();
    let again = run(place.path(), "frf fit/scenario.toml --out again");
    let informed = again["modes"][0]["informed"]["to"].as_f64().unwrap();
    assert_eq!(Some(informed), mode["informed"][1].as_f64());
    assert_eq!(again["warnings"].as_array().unwrap().len(), 0, "{again}");
    let line = scenario.lines().find(|line| line.starts_with("force = [")).unwrap();
    std::fs::write(place.path().join("harder.toml"), scenario.replace(line, "force = [100.0, 110.0]"))
        .unwrap();
    let harder = run(place.path(), "frf harder.toml --out harder");
    let said = harder["warnings"][0].as_str().unwrap();
    assert!(said.contains("leaves what the records informed: force 110"), "{said}");
}

#[test]
fn bad_tests_of_shakers_are_named() {
    let place = folder(MODE);
    let cases = [
        ("frequency,amplitude,phase\n120,1,0\n", "there is no column excitation or force"),
        ("frequency,phase,force\n120,1,0\n", "there is no column amplitude or displacement"),
        ("mode,frequency,amplitude,phase,force\n1,120,1,0,1\n2,130,1,0,1\n", "several modes apart"),
        ("frequency,amplitude,phase,force\n120,1,1.5,1\n121,1,1.5,1\n", "sign of the phase"),
        ("frequency,amplitude,phase,force\n120,-1,0,1\n", "amplitude = -1 is out of range"),
    ];
    for (text, message) in cases {
        std::fs::write(place.path().join("test.csv"), text).unwrap();
        let output = iwan(place.path(), "fit --sweep test.csv --out out");
        assert_eq!(output.status.code(), Some(2), "{}", shown(&output));
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(said.contains(message), "{said}");
    }
}

#[test]
fn bad_input_is_named() {
    let cases = [
        (MODE.into(), "frf", "the table [sweep] is missing"),
        (format!("{MODE}[sweep]\nfrom = 300\nto = 400\nforce = [1]\n"), "frf", "no mode has its resonance"),
        (format!("{MODE}[sweep]\nfrom = 112\nto = 128\nforce = [0]\n"), "frf", "force = 0 is out of range"),
        (format!("{MODE}[sweep]\nfrom = 0\nto = 128\nforce = [1]\n"), "frf", "from = 0 is out of range"),
        // Nothing but the joint holds the mode.
        (MODE.replace("4.45e4", "7e5") + SWEEP, "frf", "k_t = 700000 of the joint must be below"),
        (format!("{MODE}{SWEEP}direction = [1, 0, 0]\n"), "frf", "direction is that of base_acceleration"),
        (format!("{MODE}{SWEEP}at = 'moon'\n"), "frf", "has no point \"moon\""),
        (format!("{MODE}{SWEEP}damping_ratio = 0.1\n"), "frf", "damping_ratio is for structures"),
        (format!("{MODE}{SWEEP}harmonics = 4\n"), "frf", "harmonics = 4 is out of range"),
        (MODE.replace("joint", "# joint"), "backbone", "no joint slips"),
        (SHARED.replace("compliance = 9.1e-6", "compliance = 1e-3"), "frf", "nothing holds the modes"),
        (SHARED.replace("to = 135", "to = 126"), "frf", "no mode has its resonance"),
        (format!("{SHARED}at = 'moon'\n"), "frf", "has no point \"moon\""),
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
