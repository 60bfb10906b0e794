//! `iwan envelope`: files, numbers, records of all kinds.
#![allow(clippy::unwrap_used, clippy::print_stderr, reason = "tests may panic and say why")]

use crate::common;
use std::path::Path;

use crate::common::{csv, folder, iwan, names, ring_down, shown};
use serde_json::Value;

fn run(place: &Path, arguments: &str) -> Value {
    let output = iwan(place, &format!("envelope {arguments} --json"));
    assert!(output.status.success(), "{}", shown(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn write(place: &Path, name: &str, text: &str) {
    std::fs::write(place.join(name), text).unwrap();
}

/// Two modes at 80 Hz (0.2 %) and 220 Hz (0.5 %) on two channels.
fn two_modes() -> String {
    let shapes: [&[f64]; 2] = [&[1.0, 0.5], &[-0.8, 0.7]];
    ring_down(2048.0, 4096, &[(80.0, 0.002, 3.0), (220.0, 0.005, 1.0)], &shapes, "tip [m/s^2],root [m/s^2]")
}

#[test]
fn a_linear_mode_gives_its_frequency_and_damping() {
    let place = folder("");
    let text = ring_down(2048.0, 4096, &[(80.0, 0.002, 3.0)], &[&[1.0]], "tip [m/s^2]");
    write(place.path(), "tap.csv", &text);
    for method in ["hilbert", "peaks", "pff"] {
        let summary = run(place.path(), &format!("tap.csv --out {method} --method {method}"));
        let mode = &summary["modes"][0];
        assert_eq!(mode["method"], method);
        // At the very ends of the window polynomials know less.
        for p in &mode["points"].as_array().unwrap()[1..6] {
            let value = |key: &str| p[key].as_f64().unwrap();
            let expected = 3.0 * (-0.002 * std::f64::consts::TAU * 80.0 * value("t")).exp();
            assert!((value("amplitude") / expected - 1.0).abs() < 2e-3, "{p}");
            assert!((value("frequency") - 80.0).abs() < 0.01, "{p}");
            assert!((value("damping_ratio") / 0.002 - 1.0).abs() < 0.02, "{p}");
        }
        assert!(mode["spread"]["median_damping_ratio"].as_f64().unwrap() < 0.01);
    }
    assert_eq!(names(&place.path().join("pff")), ["envelope.csv", "report.html", "summary.json"]);
}

#[test]
fn columns_are_the_contract() {
    let place = folder("");
    write(place.path(), "two.csv", &two_modes());
    let summary = run(place.path(), "two.csv --band 60:105 --band 180:260 --out out");
    assert_eq!(summary["modes"].as_array().unwrap().len(), 2);
    let table = csv(&place.path().join("out/envelope.csv"));
    let expected = [
        "mode",
        "t",
        "amplitude",
        "frequency",
        "damping_ratio",
        "log_amplitude_sd",
        "frequency_sd",
        "damping_ratio_sd",
        "displacement",
        "dissipation",
        "force",
    ];
    assert_eq!(table.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), expected);
    let column = |name: &str| &table.iter().find(|c| c.0 == name).unwrap().1;
    for (i, mode) in column("mode").iter().enumerate() {
        if !(0.3..1.2).contains(&column("t")[i]) {
            continue; // at the ends of the window polynomials know less
        }
        let (f, zeta) = if *mode == 1.0 { (80.0, 0.002) } else { (220.0, 0.005) };
        assert!((column("frequency")[i] - f).abs() < 0.02);
        assert!((column("damping_ratio")[i] / zeta - 1.0).abs() < 0.05);
        let omega = std::f64::consts::TAU * f;
        assert!((column("displacement")[i] * omega * omega / column("amplitude")[i] - 1.0).abs() < 1e-3);
        assert!(
            (column("force")[i] / column("amplitude")[i] - 1.0).abs() < 1e-9,
            "modal force = q'' for unit mass"
        );
    }
    run(place.path(), "two.csv --band 60:105 --out npz --format npz");
    assert!(names(&place.path().join("npz")).contains(&"envelope.npz".to_string()));
}

#[test]
fn mode_shapes_make_modal_records() {
    let place = folder("");
    write(place.path(), "two.csv", &two_modes());
    write(place.path(), "shapes.csv", "frequency,root,tip\n80,-0.8,1.0\n220,0.7,0.5\n");
    let summary = run(place.path(), "two.csv --shapes shapes.csv --out both");
    for (n, (f, a)) in [(80.0, 3.0), (220.0, 1.0)].into_iter().enumerate() {
        let mode = &summary["modes"][n];
        assert!((mode["first"]["frequency"].as_f64().unwrap() - f).abs() < 0.01, "{mode}");
        let zeta = [0.002, 0.005][n];
        let t = mode["first"]["t"].as_f64().unwrap();
        let expected = a * (-zeta * std::f64::consts::TAU * f * t).exp();
        assert!((mode["first"]["amplitude"].as_f64().unwrap() / expected - 1.0).abs() < 5e-3, "{mode}");
        assert!(mode["notes"].to_string().contains("rank 2"), "{mode}");
    }
    // A wrong sign in the shape is noticed, and a band chooses one of the modes.
    write(place.path(), "wrong.csv", "frequency,tip,root\n80,1.0,0.8\n220,0.5,0.7\n");
    let summary = run(place.path(), "two.csv --shapes wrong.csv --band 60:105 --out wrong");
    assert_eq!(summary["modes"].as_array().unwrap().len(), 1);
    assert!(summary["modes"][0]["notes"].to_string().contains("do not move with the shape"));
}

#[test]
fn mass_scales_and_the_joint_axis_takes_less() {
    let place = folder("");
    write(place.path(), "two.csv", &two_modes());
    let (one, four) = ("two.csv --channel tip --out one", "two.csv --channel tip --mass 4 --out four");
    let [one, four] =
        [one, four].map(|a| run(place.path(), a)["modes"][0]["first"]["amplitude"].as_f64().unwrap());
    assert!((four / one - 2.0).abs() < 1e-9);
    write(
        place.path(),
        "in.toml",
        &common::SMALL.replace("4000.0", "2000.0").replace("duration = 0.1", "duration = 1.0"),
    );
    assert!(iwan(place.path(), "simulate in.toml --out sim").status.success());
    let record = "sim/response.csv --time t --quantity acceleration --band 95:150";
    let place_of = |axis: &str| {
        let channel = format!("{record} --out {axis} --force-axis {axis}");
        let output = std::process::Command::new(assert_cmd::cargo::cargo_bin!("iwan"))
            .arg("envelope")
            .args(channel.split_whitespace())
            .args(["--channel", "bending 1.acceleration", "--quiet"])
            .current_dir(place.path())
            .output()
            .unwrap();
        assert!(output.status.success() && output.stderr.is_empty(), "{}", shown(&output));
        csv(&place.path().join(axis).join("envelope.csv"))[10].1.clone()
    };
    let (modal, joint) = (place_of("modal"), place_of("joint"));
    assert!(modal.iter().zip(&joint).all(|(m, j)| *j < 0.2 * m && *j > 0.0));
}

#[test]
fn time_and_rate_and_quantity_follow_the_user() {
    let place = folder("");
    let text = ring_down(1000.0, 3000, &[(80.0, 0.002, 1.0)], &[&[1.0]], "x");
    let column: String =
        text.lines().skip(1).map(|l| l.split(',').next_back().unwrap().to_string() + "\n").collect();
    write(place.path(), "bare.csv", &column);
    let output = iwan(place.path(), "envelope bare.csv --out none");
    assert_eq!(output.status.code(), Some(2));
    let summary = run(place.path(), "bare.csv --rate 2000 --quantity displacement --out twice");
    assert!((summary["modes"][0]["first"]["frequency"].as_f64().unwrap() - 160.0).abs() < 0.02);
    assert_eq!(summary["record"]["quantity"], "displacement");
    // Uneven times are refused, and resampled on request.
    let uneven: String = text
        .lines()
        .enumerate()
        .map(|(n, l)| match (n, l.split_once(',')) {
            (0, _) => format!("{l}\n"),
            (n, Some((t, x))) => {
                format!("{},{x}\n", t.parse::<f64>().unwrap() + if n == 1000 { 3e-4 } else { 0.0 })
            }
            _ => String::new(),
        })
        .collect();
    write(place.path(), "uneven.csv", &uneven);
    let output = iwan(place.path(), "envelope uneven.csv --out refused");
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("--resample"), "{}", shown(&output));
    run(place.path(), "uneven.csv --resample --out resampled");
    let warned = run(place.path(), "uneven.csv --resample --out warned");
    assert!(warned["warnings"].to_string().contains("resampled"));
}

#[test]
fn the_text_and_the_report() {
    let place = folder("");
    write(place.path(), "two.csv", &two_modes());
    let output = iwan(place.path(), "envelope two.csv --band 60:105 --out out");
    insta::assert_snapshot!(shown(&output));
    let page = std::fs::read_to_string(place.path().join("out/report.html")).unwrap();
    assert_eq!(page.matches("<svg").count(), 11);
    for svg in page.split("<svg").skip(1) {
        let svg = &svg[..svg.find("</svg>").unwrap()];
        assert!(
            svg.matches("<circle").count() + svg.matches('L').count() + svg.matches('h').count() >= 20,
            "an empty figure"
        );
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
    assert!(page.contains("The methods agree") && page.contains("m/s\u{b2}") && !page.contains("<script"));
}

#[test]
fn results_are_not_overwritten_and_bad_records_leave_nothing() {
    let place = folder("");
    write(place.path(), "two.csv", &two_modes());
    run(place.path(), "two.csv --out out");
    assert_eq!(iwan(place.path(), "envelope two.csv --out out").status.code(), Some(2));
    run(place.path(), "two.csv --out out --force");
    write(place.path(), "three.csv", "1,1\n2,1\n");
    write(place.path(), "flat.csv", &ring_down(1000.0, 500, &[(80.0, 0.002, 0.0)], &[&[1.0]], "x"));
    write(place.path(), "growing.csv", &ring_down(1000.0, 3000, &[(80.0, -0.002, 1.0)], &[&[1.0]], "x"));
    write(place.path(), "short.csv", &ring_down(1000.0, 90, &[(80.0, 0.002, 1.0)], &[&[1.0]], "x"));
    write(
        place.path(),
        "near.csv",
        &ring_down(1000.0, 3000, &[(80.0, 0.002, 1.0), (82.0, 0.002, 1.0)], &[&[1.0, 1.0]], "x"),
    );
    write(place.path(), "force.csv", &ring_down(1000.0, 3000, &[(80.0, 0.002, 1.0)], &[&[1.0]], "x [N]"));
    write(place.path(), "nan.csv", "t,x\n0,1\n1,nan\n2,3\n");
    write(place.path(), "shapes.csv", "tip\n1\n");
    write(place.path(), "many.csv", "tip,root\n1,1\n1,-1\n");
    write(place.path(), "same.csv", "tip,root\n1,1\n2,2\n");
    let before = names(place.path());
    let mut shown_all = Vec::new();
    for arguments in [
        "missing.csv",
        ".",
        "in.toml",
        "flat.csv",
        "growing.csv",
        "short.csv",
        "near.csv --band 60:105",
        "force.csv",
        "nan.csv",
        "two.csv --channel middle",
        "two.csv --time clock",
        "two.csv --band 600:1200",
        "two.csv --band 300:400",
        "two.csv --shapes shapes.csv",
        "two.csv --shapes many.csv",
        "two.csv --band 105:60",
        "two.csv --band 60",
        "two.csv --rate 0",
        "two.csv --mass -1",
        "two.csv --shapes many.csv --mass 2",
    ] {
        let output = iwan(place.path(), &format!("envelope {arguments} --out bad"));
        assert_eq!(output.status.code(), Some(2), "{arguments}: {}", shown(&output));
        assert!(output.stdout.is_empty());
        assert_eq!(names(place.path()), before, "something was written: {arguments}");
        shown_all.push(format!("iwan envelope {arguments}\n{}", String::from_utf8_lossy(&output.stderr)));
    }
    insta::assert_snapshot!("bad_records", shown_all.join("\n"));
    // Shapes that are not told apart leave the average over the shape, which says so and names what does not move with it.
    let output =
        iwan(place.path(), "envelope two.csv --shapes same.csv --band 60:105 --band 180:260 --out alike");
    let said = shown(&output);
    assert!(output.status.success(), "{said}");
    assert!(
        said.contains("2 channels tell only 1 of 2 mode shapes apart")
            && said.contains("do not move with the shape"),
        "{said}"
    );
}
