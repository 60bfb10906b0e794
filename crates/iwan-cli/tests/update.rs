//! `iwan update`: from the curves that `iwan quasi-static` writes back to the joints, and messages about bad curves.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use crate::common::{folder, iwan};
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
    // Where the curves feel nothing of the washers' joints, from the true values on, these keep them.
    let output =
        iwan(place.path(), "update --json --quiet --out v --curves bending-1,bending-3=m/curves.csv");
    let kept: Value = serde_json::from_slice(&output.stdout).unwrap();
    let washers = kept["groups"][1]["k_t"]["value"].as_f64().unwrap();
    assert!((washers / 2.75e5 - 1.0).abs() < 1e-9, "{washers}");
    // The structure with the joints found opens.
    assert!(iwan(place.path(), "modes u/updated.toml --quiet --out again").status.success());
}

#[test]
fn what_does_not_fit_is_named() {
    let place = folder("");
    std::fs::write(place.path().join("short.csv"), "displacement,frequency\n1e-4,100\n").unwrap();
    std::fs::write(place.path().join("few.csv"), "displacement,frequency,damping_ratio\n1e-4,100,1e-3\n")
        .unwrap();
    for (arguments, said) in [
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
