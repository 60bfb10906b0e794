//! `iwan fit --coupled`: from files with their force to modes that share a joint, and messages about what does not fit.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::fmt::Write;
use std::path::Path;

use crate::common::{csv, folder, iwan, shown};
use serde_json::Value;

/// Two modes that share a joint, sampled coarsely so that a fit takes a moment.
const SHARED: &str = r#"
[[mode]]
name = "one"
frequency = 20.0
damping_ratio = 5e-4
[[mode]]
name = "two"
frequency = 52.0
damping_ratio = 5e-4
shape_at_force = -0.7
[[joint]]
name = "bolt"
law = { k_t = 1500.0, f_s = 20.0, chi = -0.3, beta = 0.05 }
participation = { one = 1.0, two = -2.5 }
compliance = 1e-4
[force]
kind = "haversine"
amplitude = 600.0
duration = 0.01
[time]
step = 2.5e-4
duration = 1.5
[method]
kind = "newmark"
joint = "continuum"
"#;

/// A hit as a file: time, both modes' accelerations, force.
fn hit(place: &Path, amplitude: f64) -> String {
    let name = format!("hit-{amplitude}.csv");
    let out = iwan(place, &format!("simulate in.toml --quiet --out s{amplitude} --amplitude {amplitude}"));
    assert!(out.status.success(), "{}", shown(&out));
    let columns = csv(&place.join(format!("s{amplitude}/response.csv")));
    let column = |name: &str| &columns.iter().find(|(n, _)| n == name).unwrap().1;
    let mut text = String::from("t [s],a [m/s^2],b [m/s^2],hammer [N]\n");
    for n in (0..column("t").len()).step_by(4) {
        let t = column("t")[n];
        let force = if t < 0.01 { amplitude * (std::f64::consts::PI * t / 0.01).sin().powi(2) } else { 0.0 };
        let (one, two) = (column("one.acceleration")[n], column("two.acceleration")[n]);
        writeln!(text, "{t},{one},{two},{force}").unwrap();
    }
    std::fs::write(place.join(&name), text).unwrap();
    name
}

#[test]
fn hits_of_three_levels_tell_that_modes_share_a_joint() {
    let place = folder(SHARED);
    std::fs::write(place.path().join("shapes.csv"), "frequency,a,b\n20,1,0\n52,0,1\n").unwrap();
    let files = [60.0, 600.0, 6000.0].map(|amplitude| hit(place.path(), amplitude)).join(" ");
    let kept_out = hit(place.path(), 2000.0);
    let command = format!(
        "fit {files} --coupled --shapes shapes.csv --load hammer --held-out {kept_out} --json --quiet --out f"
    );
    let output = iwan(place.path(), &command);
    assert!(output.status.success(), "{}", shown(&output));
    let fit: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(fit["chosen"], "shared 1", "{}", fit["in_words"]);
    let slip = &fit["joints"][0]["participation"]["mode 2"];
    assert!((slip["value"].as_f64().unwrap() / -2.5 - 1.0).abs() < 0.05, "{slip}");
    let model = |name: &str| {
        let models = fit["models"].as_array().unwrap();
        models.iter().find(|m| m["name"] == name).unwrap()["held_out_misfit"].as_f64().unwrap()
    };
    assert!(model("shared 1") < 0.02 && model("uncoupled") > 3.0 * model("shared 1"));
    assert!(fit["joints"][0]["k_t"]["identifiable"].as_bool().unwrap(), "{}", fit["joints"]);
    let page = std::fs::read_to_string(place.path().join("f/report.html")).unwrap();
    assert!(page.contains("Models side by side") && page.contains("(kept out)") && !page.contains("NaN"));
    // A force that is left out may be the load, which a warning says.
    let unnamed = iwan(place.path(), &format!("fit {files} --coupled --shapes shapes.csv --out g"));
    assert!(unnamed.status.success() && shown(&unnamed).contains("say --load hammer"), "{}", shown(&unnamed));
    // So may a channel that no shape has.
    let bare = std::fs::read_to_string(place.path().join("hit-60.csv")).unwrap().replace(" [N]", "");
    std::fs::write(place.path().join("bare.csv"), bare).unwrap();
    let refused =
        iwan(place.path(), "fit bare.csv --coupled --shapes shapes.csv --quantity acceleration --out h");
    let text = shown(&refused);
    assert!(text.contains("there is no column \"hammer\"") && text.contains("say --load CHANNEL"), "{text}");
    // The scenario runs as it is.
    let again = iwan(place.path(), "simulate f/scenario.toml --quiet --out again");
    assert!(again.status.success(), "{}", shown(&again));
    for (arguments, said) in [
        ("--coupled --shapes shapes.csv --load nowhere", "nowhere"),
        ("--coupled --band 15:25 --load hammer --channel a", "at least two"),
        ("--coupled --band 15:25 --band 45:60 --load hammer", "no mode shapes to tell the modes apart"),
        ("--coupled --shapes shapes.csv --load hammer --shape-at-force 1", "1 numbers for 2 modes"),
    ] {
        let output = iwan(place.path(), &format!("fit hit-600.csv {arguments} --out wrong"));
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments}: {text}");
        assert!(text.contains(said), "{arguments}: {text}");
        assert!(!place.path().join("wrong").exists());
    }
}

/// Two linear modes, struck at the twentieth sample, without noise: all models leave next to nothing, and the one with the fewest unknowns is right. Joints of no strength were found.
#[test]
fn linear_modes_without_noise_need_no_joint() {
    let place = folder("");
    let rate = 1024.0;
    let decay = |f: f64, damping: f64, t: f64| {
        let omega = std::f64::consts::TAU * f;
        (-damping * omega * t).exp() * ((1.0 - damping * damping).sqrt() * omega * t).sin() / omega
    };
    // Blows of three equal samples.
    let at = |n: i32| -> f64 {
        let since = (20..23).map(|blow| f64::from(n - blow) / rate).filter(|t| *t > 0.0);
        since.map(|t| decay(80.0, 0.01, t) + 0.16 * decay(150.0, 0.005, t)).sum()
    };
    let mut text = String::from("time [s],displacement [m]\n");
    for n in 0..4096 {
        writeln!(text, "{},{}", f64::from(n) / rate, at(n)).unwrap();
    }
    std::fs::write(place.path().join("lin.csv"), text).unwrap();
    let out = iwan(place.path(), "fit lin.csv --coupled --band 70:90 --band 140:160 --json --quiet --out f");
    assert!(out.status.success(), "{}", shown(&out));
    let found: Value = serde_json::from_slice(&out.stdout).unwrap();
    let models = found["models"].as_array().unwrap();
    let criterion = |name: &str| models.iter().find(|m| m["name"] == name).unwrap()["criterion"].as_f64();
    assert_eq!(criterion("linear"), Some(0.0), "{models:#?}");
    assert!(criterion("uncoupled") > Some(10.0), "{models:#?}");
}
