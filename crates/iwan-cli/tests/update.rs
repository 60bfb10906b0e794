//! `iwan update`: from the curves that `iwan quasi-static` writes back to the joints, and messages about bad curves.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::fmt::Write;

use crate::common::{folder, iwan, universal};
use serde_json::Value;

/// The built-in beam's own curves, and a file whose link joints are off: the file comes back.
#[test]
fn curves_of_static_loads_give_the_joints_back() {
    let place = folder("");
    let measured = "quasi-static --quiet --out m --mode bending-1 --mode bending-3";
    assert!(iwan(place.path(), measured).status.success());
    let text = String::from_utf8(iwan(place.path(), "scenario paper-a").stdout).unwrap();
    let wrong = "k_t = 2.2e5, f_s = 400.0, chi = -0.5, beta = 0.1";
    let off = text.replace("k_t = 2.75e5, f_s = 300.0, chi = -0.3, beta = 0.02", wrong);
    assert_ne!(off, text);
    std::fs::write(place.path().join("off.toml"), off).unwrap();
    let update =
        "update off.toml --json --quiet --out u --undamped --curves bending-1,bending-3=m/curves.csv";
    let output = iwan(place.path(), update);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let links = &found["groups"][0];
    assert_eq!(links["name"], "left link + right link");
    for (key, expected) in [("k_t", 2.75e5), ("f_s", 300.0), ("chi", -0.3)] {
        let value = links[key]["value"].as_f64().unwrap();
        assert!((value / expected - 1.0).abs() < 1e-3, "{key} {value}");
    }
    // β stands at the onset of macro-slip alone, a corner between few of the entries.
    let end = |key: &str| links["beta"][key].as_f64().unwrap();
    assert!(end("low") < 0.02 && 0.02 < end("high") && end("high") < 0.03, "{}", links["beta"]);
    assert_eq!(found["groups"][1]["f_s"]["identifiable"], false);
    assert_eq!(found["verdict"]["adequate"], true, "{}", found["verdict"]);
    for file in ["update.json", "summary.json", "updated.toml", "report.html"] {
        assert!(place.path().join("u").join(file).exists(), "{file}");
    }
    // Where the curves feel next to nothing of the washers' joints, from the true values on, these keep them.
    let output =
        iwan(place.path(), "update --json --quiet --out v --curves bending-1,bending-3=m/curves.csv");
    let kept: Value = serde_json::from_slice(&output.stdout).unwrap();
    let washers = kept["groups"][1]["k_t"]["value"].as_f64().unwrap();
    assert!((washers / 2.75e5 - 1.0).abs() < 1e-4, "{washers}");
    // The structure with the joints found opens.
    assert!(iwan(place.path(), "modes u/updated.toml --quiet --out again").status.success());
}

#[test]
fn what_does_not_fit_is_named() {
    let place = folder("");
    std::fs::write(place.path().join("short.csv"), "displacement,frequency\n1e-4,100\n").unwrap();
    std::fs::write(place.path().join("few.csv"), "displacement,frequency,damping_ratio\n1e-4,100,1e-3\n")
        .unwrap();
    let broken = "# measured\ndisplacement,frequency,damping_ratio\n1e-4,130,1e-3\n2e-4,nan,1e-3\n";
    std::fs::write(place.path().join("broken.csv"), broken).unwrap();
    let rows: String = (1..8).map(|i| format!("{i}e-4,{},0\n", 132 - i)).collect::<Vec<_>>().concat();
    std::fs::write(place.path().join("zero.csv"), format!("displacement,frequency,damping_ratio\n{rows}"))
        .unwrap();
    for (arguments, said) in [
        ("update --out o --curves bending-1=broken.csv", "broken.csv, line 4, column 2 (`frequency`)"),
        ("update --out o --curves bending-1=zero.csv", "0 or less in all entries"),
        ("update --out o --curves bending-1=short.csv", "there is no column `damping_ratio`"),
        ("update --out o --curves few.csv", "does not say which modes"),
        ("update --out o --curves a,b=few.csv", "2 modes are named, the file has 1"),
        ("update --out o --curves bending-1=few.csv", "1 usable entries"),
        ("update --out o --curves bending-1=few.csv --group x=nowhere", "there is no joint \"nowhere\""),
        ("update --out o --curves bending-1=few.csv --correct air", "the structure has no such part"),
    ] {
        let output = iwan(place.path(), arguments);
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments}: {text}");
        assert!(text.contains(said), "{arguments}: {text}");
        assert!(!place.path().join("o").exists());
    }
}

/// Blows on the built-in beam as `iwan simulate` writes them, with the force beside: the link's joints come back without any curve.
#[test]
fn blows_give_the_joints_back() {
    let place = folder("");
    let scenario = |amplitude: f64| {
        format!(
            "[structure]\nname = \"paper-a\"\nmodes = [\"bending-1\", \"bending-3\"]\n[force]\nkind = \"haversine\"\namplitude = {amplitude}\n\
             duration = 1.6e-3\n[time]\nstep = 1e-5\nduration = 0.15\n"
        )
    };
    for amplitude in [30.0, 1000.0] {
        let name = format!("blow-{amplitude}");
        std::fs::write(place.path().join(format!("{name}.toml")), scenario(amplitude)).unwrap();
        let output = iwan(place.path(), &format!("simulate {name}.toml --quiet --out {name}"));
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        // The record of a hammer stands beside the motions.
        let text = std::fs::read_to_string(place.path().join(&name).join("response.csv")).unwrap();
        let mut lines = text.lines();
        let mut out = format!("{},hammer\n", lines.next().unwrap());
        let pulse = iwan_core::Pulse::Haversine { amplitude, duration: 1.6e-3 };
        for (n, line) in lines.enumerate() {
            writeln!(out, "{line},{}", pulse.at(n as f64 * 1e-5)).unwrap();
        }
        std::fs::write(place.path().join(format!("{name}.csv")), out).unwrap();
    }
    let text = String::from_utf8(iwan(place.path(), "scenario paper-a").stdout).unwrap();
    let wrong = "k_t = 2.5e5, f_s = 330.0, chi = -0.35, beta = 0.05";
    std::fs::write(
        place.path().join("off.toml"),
        text.replace("k_t = 2.75e5, f_s = 300.0, chi = -0.3, beta = 0.02", wrong),
    )
    .unwrap();
    let update = "update off.toml --json --quiet --out u --records blow-30.csv --records blow-1000.csv --load hammer --mode bending-1 \
                  --mode bending-3";
    let output = iwan(place.path(), update);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let links = &found["groups"][0];
    for (key, expected) in [("k_t", 2.75e5), ("f_s", 300.0), ("chi", -0.3)] {
        let [value, low, high] = ["value", "low", "high"].map(|part| links[key][part].as_f64().unwrap());
        assert!((value / expected - 1.0).abs() < 0.03, "{key} {value}");
        // The hundred sliders of the records are not the continuum of the fit.
        assert!(low < expected && expected < high, "{key} {low} {high}");
    }
    assert_eq!(found["verdict"]["adequate"], true, "{}", found["verdict"]);
    assert!(found["blows"].as_array().unwrap().len() >= 4);
    assert!(std::fs::read_to_string(place.path().join("u/report.html")).unwrap().contains("Blows"));
    for (arguments, said) in [
        ("update --out o --records blow-30.csv --load hammer", "no mode to compare"),
        ("update --out o --records blow-30.csv --load hummer --mode bending-1", "hummer"),
        ("update --out o --records blow-30.csv --mode bending-1", "--load"),
        ("update --out o --records blow-30.csv --load hammer --mode bending-77", "bending"),
    ] {
        let output = iwan(place.path(), arguments);
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments}: {text}");
        assert!(text.contains(said), "{arguments}: {text}");
        assert!(!place.path().join("o").exists());
    }
}

/// The window's damping would be found in the joints.
#[test]
fn blows_under_a_window_are_refused() {
    let place = folder("");
    let motion: Vec<f64> = (0..2000).map(|n| (0.08 * f64::from(n)).sin()).collect();
    let force: Vec<f64> = (0..2000).map(|n| f64::from(u8::from(n < 16))).collect();
    let text = universal::channel("hammer", (13, "N"), 1e-4, &force, 0)
        + &universal::channel("bending 1", (12, "m/s^2"), 1e-4, &motion, 4);
    std::fs::write(place.path().join("hit.uff"), text).unwrap();
    let output = iwan(place.path(), "update --out o --records hit.uff --load hammer --mode bending-1");
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(
        text.contains("hit.uff: an exponential window")
            && text.contains("lies over 'bending 1'")
            && text.contains("without a window"),
        "{text}"
    );
    assert!(!place.path().join("o").exists());
}
