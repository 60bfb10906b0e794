//! `iwan modal`: files of other programs in and out, and what it says of hits that do not go together.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::fmt::Write;

use crate::common::{csv, folder, iwan, shown};
use crate::hits_of_bench::{bench, hits, refused, run, write};
use crate::support::Bench;
use iwan_modal::measure::{Channel, Freedom, Hit};
use serde_json::Value;

fn warnings(found: &Value) -> String {
    found["warnings"].to_string()
}

fn frequencies(found: &Value) -> Vec<f64> {
    found["modes"].as_array().unwrap().iter().map(|m| m["frequency"].as_f64().unwrap()).collect()
}

/// A data element of a level-5 MATLAB file in little endian.
fn element(code: u32, data: &[u8]) -> Vec<u8> {
    let mut out =
        [code, u32::try_from(data.len()).unwrap()].iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    out.extend(data);
    out.resize(out.len().next_multiple_of(8), 0);
    out
}

/// A column of doubles.
fn matrix(name: &str, x: &[f64]) -> Vec<u8> {
    let words = |words: &[u32]| words.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    let numbers: Vec<u8> = x.iter().flat_map(|v| v.to_le_bytes()).collect();
    // Class 6 (double), dimensions, name, real part.
    let parts = [
        element(6, &words(&[6, 0])),
        element(5, &words(&[u32::try_from(x.len()).unwrap(), 1])),
        element(1, name.as_bytes()),
        element(9, &numbers),
    ];
    element(14, &parts.concat())
}

/// A hit as a level-5 MATLAB file: t, hammer, a1 to a8.
fn matlab(hit: &Hit) -> Vec<u8> {
    let mut out = b"MATLAB 5.0 MAT-file".to_vec();
    out.resize(124, b' ');
    out.extend(*b"\x00\x01IM");
    let times: Vec<f64> = (0..hit.samples()).map(|n| n as f64 * hit.dt).collect();
    out.extend(matrix("t", &times));
    for channel in std::iter::once(&hit.force).chain(&hit.responses) {
        out.extend(matrix(&channel.name, &channel.samples));
    }
    out
}

#[test]
fn hits_in_matlab_files_are_those_in_text() {
    let place = folder("");
    hits(place.path(), 2);
    for (n, hit) in bench().hits(100.0, 2, 1).iter().enumerate() {
        std::fs::write(place.path().join(format!("h{}.mat", n + 1)), matlab(hit)).unwrap();
    }
    let text = run(place.path(), "h1.csv h2.csv --at a1 --band 60:480 --out text");
    let matlab =
        run(place.path(), "h1.mat h2.mat --at a1 --band 60:480 --quantity acceleration --out matlab");
    for (a, b) in frequencies(&text).iter().zip(frequencies(&matlab)) {
        assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
    }
    assert_eq!(text["modes"].as_array().unwrap().len(), matlab["modes"].as_array().unwrap().len());
}

#[test]
fn a_missing_point_of_the_table_and_of_a_level_is_named() {
    let place = folder("");
    hits(place.path(), 1);
    let table = "[[channel]]\nname = \"a9\"\npoint = \"rim\"\n";
    std::fs::write(place.path().join("points.toml"), table).unwrap();
    refused(
        place.path(),
        "h1.csv --at a1 --points points.toml",
        &["points.toml", "point rim is missing", "\"a9\""],
    );
    let mut short = bench().hit(300.0, 7);
    short.responses.pop();
    write(place.path(), "hard.csv", &short);
    let found = run(place.path(), "h1.csv hard.csv --at a1 --band 60:480 --out out");
    assert!(warnings(&found).contains("hard.csv: point a8 is missing, which h1.csv has"), "{found}");
    // Levels are compared at the points that both have.
    let macs: Vec<f64> = (0..4).map(|n| found["levels"][1]["modes"][n]["mac"].as_f64().unwrap()).collect();
    assert!(macs.iter().all(|m| *m > 0.999), "{macs:?}");
}

#[test]
fn swapped_and_reversed_channels_are_named_with_their_file() {
    let place = folder("");
    hits(place.path(), 3);
    let mut swapped = bench().hit(110.0, 8);
    let third = std::mem::take(&mut swapped.responses[2].samples);
    swapped.responses[2].samples = std::mem::replace(&mut swapped.responses[3].samples, third);
    swapped.responses[6].samples.iter_mut().for_each(|x| *x = -*x);
    write(place.path(), "late.csv", &swapped);
    let found = run(place.path(), "h1.csv h2.csv h3.csv late.csv --at a1 --band 60:480 --out out");
    let said = warnings(&found);
    assert!(said.contains("late.csv: channels a3 and a4 are swapped against h1.csv"), "{said}");
    assert!(said.contains("late.csv: channel a7 is reversed against h1.csv"), "{said}");
    let good = run(place.path(), "h1.csv h2.csv h3.csv --at a1 --band 60:480 --out good");
    assert!(!warnings(&good).contains("swapped") && !warnings(&good).contains("reversed"), "{good}");
}

#[test]
fn sensors_that_rove_under_a_fixed_hammer_make_one_shape() {
    let place = folder("");
    // Two sensors, four runs of two hits: each hit has a file of its own, every other run in MATLAB's format.
    let mut table =
        "[[channel]]\nname = \"hammer\"\npoint = \"1\"\ndirection = \"z\"\nrole = \"force\"\n".to_string();
    let mut names = String::new();
    for run in 0..4 {
        for hit in 0..2 {
            let own = bench().hit(100.0, 20 + 2 * run + hit);
            let pair = |k: usize, name: &str| Channel {
                name: name.into(),
                ..own.responses[2 * run as usize + k].clone()
            };
            let both = Hit { responses: vec![pair(0, "left"), pair(1, "right")], ..own.clone() };
            let file =
                if run % 2 == 0 { format!("run{run}-{hit}.csv") } else { format!("run{run}-{hit}.mat") };
            if run % 2 == 0 {
                write(place.path(), &file, &both);
            } else {
                std::fs::write(place.path().join(&file), matlab(&both)).unwrap();
            }
            for (k, name) in ["left", "right"].iter().enumerate() {
                write!(
                    table,
                    "[[channel]]\nname = \"{name}\"\nfile = \"{file}\"\npoint = \"{}\"\ndirection = \"+z\"\n",
                    2 * run as usize + k + 1
                )
                .unwrap();
            }
            write!(names, "{file} ").unwrap();
        }
    }
    std::fs::write(place.path().join("points.toml"), table).unwrap();
    let found = run(
        place.path(),
        &format!("{names} --points points.toml --quantity acceleration --band 60:480 --out out"),
    );
    assert_eq!(
        (found["channels"].as_array().unwrap().len(), &found["mass_normalised"]),
        (8, &Value::Bool(true))
    );
    for (mode, truth) in found["modes"].as_array().unwrap().iter().zip(&bench().modes) {
        let own: Vec<f64> = (1..=8).map(|k| mode["shape"][format!("{k}:+z")].as_f64().unwrap()).collect();
        let exact = bench().shape(truth);
        let sign = own[0].signum() * exact[0].signum();
        assert!(own.iter().zip(&exact).all(|(a, b)| (a * sign - b).abs() < 0.01), "{own:?} {exact:?}");
        let at_force = mode["shape_at_force"].as_f64().unwrap();
        assert!((at_force - own[0]).abs() < 1e-12, "{at_force} {own:?}");
    }
}

#[test]
fn geometry_and_shapes_come_and_go_as_universal_files() {
    let place = folder("");
    let hit = bench().hit(100.0, 1);
    let mut named = hit.clone();
    for (k, channel) in named.responses.iter_mut().enumerate() {
        channel.name = format!("{}:+z", k + 1);
    }
    write(place.path(), "hit.csv", &named);
    let mut geometry = "    -1\n  2411\n".to_string();
    for n in 1..=8 {
        writeln!(
            geometry,
            "{n:>10}         1         1        11\n   {}.0D+00   0.0D+00   {}.0D+00",
            n % 5,
            n / 5
        )
        .unwrap();
    }
    geometry += "    -1\n    -1\n    82\n         1         4         0\nedge\n         1         2         3         4\n    -1\n";
    geometry += "    -1\n  2412\n         1        44         1         1         7         4\n         5         6         7         8\n    -1\n";
    std::fs::write(place.path().join("plate.unv"), geometry).unwrap();
    run(place.path(), "hit.csv --at 1:+z --points plate.unv --band 60:480 --out out");
    let written = std::fs::read(place.path().join("out/shapes.uff")).unwrap();
    let model = iwan_io::uff_model("shapes.uff".as_ref(), &written).unwrap();
    assert_eq!(
        (model.nodes.len(), model.edges(), model.modes.len()),
        (8, vec![[1, 2], [2, 3], [3, 4], [5, 6], [5, 8], [6, 7], [7, 8]], 4)
    );
    assert_eq!(model.nodes[6].position, [2.0, 0.0, 1.0]);
    let again = std::fs::read(place.path().join("out/geometry.unv")).unwrap();
    let again = iwan_io::uff_model("geometry.unv".as_ref(), &again).unwrap();
    assert_eq!((&again.nodes, again.edges()), (&model.nodes, model.edges()));
    assert_eq!(again.elements[0], (44, vec![5, 6, 7, 8]));
    let shape = model.modes[0].mass_normalised().unwrap();
    let table = csv(&place.path().join("out/shapes.csv"));
    let column = |name: &str| table.iter().find(|c| c.0 == name).unwrap().1[0];
    for (node, values) in shape {
        let own = column(&format!("{node}:+z"));
        assert!((values[2][0] - own).abs() < 1e-3 * own.abs().max(0.1), "{node}: {values:?} {own}");
    }
    let page = std::fs::read_to_string(place.path().join("out/report.html")).unwrap();
    assert!(page.contains("attributeName=\"d\""), "lines move");
    for word in ["Zeroed early-time spectra", "From when on is it linear?"] {
        assert!(page.contains(word), "{word}");
    }
    // The same modal record by the table and by the universal file.
    let peak = |shapes: &str, out: &str| {
        let output = iwan(
            place.path(),
            &format!(
                "envelope hit.csv --from 0.03 --channel 1:+z --channel 2:+z --channel 3:+z --channel 4:+z --channel 5:+z --channel 6:+z --channel 7:+z --channel 8:+z --shapes {shapes} --band 100:150 --out {out} --json"
            ),
        );
        assert!(output.status.success(), "{}", shown(&output));
        let json: Value = serde_json::from_slice(&output.stdout).unwrap();
        json["modes"][0]["first"]["amplitude"].as_f64().unwrap()
    };
    let (table, universal) = (peak("out/shapes.csv", "one"), peak("out/shapes.uff", "two"));
    assert!((table / universal - 1.0).abs() < 1e-4, "{table} {universal}");
    refused(place.path(), "hit.csv --at 1:+z --points hit.csv", &["hit.csv"]);
}

#[test]
fn decays_by_subspaces_and_ways_beside_each_other() {
    let place = folder("");
    hits(place.path(), 1);
    let arguments = "h1.csv --free --from 0.03 --band 60:480";
    let found = run(place.path(), &format!("{arguments} --method subspace --compare --out out"));
    assert_eq!(found["other"]["method"], "chart");
    assert_eq!(found["other"]["found"], 4);
    for (own, truth) in frequencies(&found).iter().zip(&bench().modes) {
        assert!((own / truth.frequency - 1.0).abs() < 1e-4, "{own}");
    }
    for n in 0..4 {
        let other = found["other"]["modes"][n]["frequency"].as_f64().unwrap();
        assert!((other / frequencies(&found)[n] - 1.0).abs() < 1e-9, "{found}");
    }
    refused(place.path(), "h1.csv --at a1 --method subspace", &["--free"]);
}

#[test]
fn threads_are_obeyed_and_change_nothing() {
    let place = folder("");
    hits(place.path(), 2);
    let with = |threads: usize| {
        let out = format!("out{threads}");
        run(place.path(), &format!("h1.csv h2.csv --at a1 --band 60:480 --threads {threads} --out {out}"));
        let read = |name: &str| std::fs::read(place.path().join(&out).join(name)).unwrap();
        (read("shapes.csv"), read("frf.csv"))
    };
    assert!(with(1) == with(3));
}

#[test]
fn calibration_counts_in_the_standard_deviations_of_shapes() {
    let place = folder("");
    hits(place.path(), 2);
    let sd = |more: &str, out: &str| {
        let found = run(place.path(), &format!("h1.csv h2.csv --at a1 --band 60:480 {more} --out {out}"));
        let mode = &found["modes"][0];
        let value = |key: &str| mode[key]["a1"].as_f64().unwrap();
        (value("shape_sd"), value("shape").abs())
    };
    let ((plain, _), (wide, shape)) = (sd("", "plain"), sd("--calibration 1", "wide"));
    assert!((wide - plain.hypot(0.005 * shape)).abs() < 1e-6 * wide, "{plain} {wide} {shape}");
}

#[test]
fn odd_files_and_options_are_named_with_file_and_channel() {
    let place = folder("");
    hits(place.path(), 3);
    refused(place.path(), "h1.csv --hammer a99", &["h1.csv", "--hammer a99", "hammer, a1"]);
    refused(place.path(), "h1.csv --free --from 1e6", &["h1.csv", "--from 1000000 s", "lasts"]);
    // A record, and words, in place of the table of points.
    std::fs::write(place.path().join("words.txt"), "hello world\n").unwrap();
    for junk in ["h2.csv", "words.txt"] {
        let arguments = format!("h1.csv --at a1 --points {junk}");
        refused(place.path(), &arguments, &[junk, "as a table of points", "[[channel]]", "universal file"]);
    }
    // A hit twice, a hit without a channel that the others have, and a second force.
    let found = run(place.path(), "h1.csv h2.csv h1.csv --at a1 --band 60:480 --out twice");
    assert!(warnings(&found).contains("h1.csv holds the samples of h1.csv again"), "{found}");
    let mut short = bench().hit(100.0, 7);
    short.responses.pop();
    let mut second = short.force.clone();
    second.name = "force at the back".into();
    second.freedom = Freedom::point("back");
    short.responses.push(second);
    write(place.path(), "short.csv", &short);
    let text = std::fs::read_to_string(place.path().join("short.csv")).unwrap();
    let text = text.replace("back [m/s^2]", "back [stone]");
    std::fs::write(place.path().join("short.csv"), text).unwrap();
    let found = run(place.path(), "h1.csv h2.csv short.csv --at a1 --band 60:480 --out out");
    let said = warnings(&found);
    assert!(
        said.contains("short.csv: point a8 is missing, which h1.csv has; it is averaged over 2 hits"),
        "{said}"
    );
    assert!(said.contains("the unit \\\"stone\\\" is not known"), "{said}");
    assert!(said.contains("short.csv, channel force at the back: its name speaks of a force"), "{said}");
}

#[test]
fn a_hammer_that_is_cut_off_and_a_hit_that_shortens_all_are_named() {
    let place = folder("");
    let mut hit = bench().hit(100.0, 1);
    let peak = hit.peak_force();
    // Of the pulse's five samples three are above a third of its height.
    hit.force.samples.iter_mut().for_each(|f| *f = f.min(0.3 * peak));
    write(place.path(), "cut.csv", &hit);
    let found = run(place.path(), "cut.csv --at a1 --band 60:480 --out cut");
    let scale = "channel hammer is overloaded in cut.csv: the scale of all shapes";
    assert!(warnings(&found).contains(scale), "{found}");
    // A second hit a fifth of a second after the first: the first is too short for the order.
    let (mut twice, later) = (bench().hit(100.0, 1), (0.2 / hit.dt) as usize);
    let add = |x: &mut Vec<f64>| (later..x.len()).rev().for_each(|n| x[n] += x[n - later]);
    add(&mut twice.force.samples);
    twice.responses.iter_mut().for_each(|c| add(&mut c.samples));
    write(place.path(), "again.csv", &twice);
    let words = ["again.csv, hit 1 lasts 0.", "all hits are cut to it", "--leave-out"];
    refused(place.path(), "again.csv --at a1 --band 60:480", &words);
}

#[test]
fn a_channel_that_no_hit_spares_is_not_mended_by_leaving_hits_out() {
    let place = folder("");
    let mut hits = [bench().hit(100.0, 1), bench().hit(105.0, 2)];
    for (hit, name) in hits.iter_mut().zip(["h1.csv", "h2.csv"]) {
        for channel in [0, 2] {
            let limit = 0.3 * hit.responses[channel].samples.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
            hit.responses[channel].samples.iter_mut().for_each(|x| *x = x.clamp(-limit, limit));
        }
        write(place.path(), name, hit);
    }
    let found = run(place.path(), "h1.csv h2.csv --at a1 --band 60:480");
    let said = warnings(&found);
    let [drive, other] = ["a1", "a3"].map(|name| format!("channel {name} is overloaded in all 2 hits: "));
    assert!(said.contains(&format!("{drive}the scale of all shapes")), "{said}");
    assert!(said.contains(&format!("{other}what is said of its point")), "{said}");
    assert!(!said.contains("--leave-out"), "{said}");
}

#[test]
fn a_hammer_that_roves_over_the_points_makes_one_shape() {
    let place = folder("");
    // One sensor, at point 1: each run hits another point.
    let (mut table, mut names) = (String::new(), String::new());
    for drive in 0..8 {
        let mut own = Bench { drive, ..bench() }.hit(100.0, 40 + drive as u64);
        own.responses.truncate(1);
        let file = format!("at{drive}.csv");
        write(place.path(), &file, &own);
        for (name, point, role) in [("hammer", drive + 1, "force"), ("a1", 1, "response")] {
            writeln!(
                table,
                "[[channel]]\nname = \"{name}\"\nfile = \"{file}\"\npoint = \"{point}\"\ndirection = \"z\"\nrole = \"{role}\""
            )
            .unwrap();
        }
        write!(names, "{file} ").unwrap();
    }
    std::fs::write(place.path().join("points.toml"), table).unwrap();
    let found = run(place.path(), &format!("{names} --points points.toml --band 60:480"));
    assert_eq!((&found["mass_normalised"], &found["warnings"]), (&true.into(), &serde_json::json!([])));
    for (mode, truth) in found["modes"].as_array().unwrap().iter().zip(&bench().modes) {
        assert!((mode["frequency"].as_f64().unwrap() / truth.frequency - 1.0).abs() < 1e-5, "{mode}");
        let shape: Vec<f64> =
            mode["shape"].as_object().unwrap().values().map(|v| v.as_f64().unwrap()).collect();
        let exact = bench().shape(truth);
        assert_eq!(shape.len(), exact.len());
        let sign = shape[0] * exact[0];
        for (own, exact) in shape.iter().zip(&exact) {
            assert!((own * sign.signum() - exact).abs() < 0.01, "{shape:?}");
        }
    }
}

#[test]
fn a_force_without_a_pulse_is_refused_and_a_second_force_is_said() {
    let place = folder("");
    hits(place.path(), 1);
    let mut hit = bench().hit(100.0, 2);
    let samples = (0..hit.samples()).map(|n| f64::from(((n * 7919) % 101) as u32) - 50.0).collect();
    let noise = Channel { samples, ..hit.force.clone() };
    write(place.path(), "noise.csv", &Hit { force: noise.clone(), ..hit.clone() });
    let words = [
        "noise.csv: no pulse stands out of the noise of channel hammer",
        "--leave-out \"noise.csv\"",
        "--whole-force",
    ];
    refused(place.path(), "h1.csv noise.csv --at a1 --band 60:480", &words);
    let found = run(place.path(), "h1.csv noise.csv --at a1 --band 60:480 --leave-out faulty");
    assert_eq!(found["hits"][1]["left_out"], true, "{found}");
    // A load cell beside the hammer, in the hammer's unit.
    hit.responses.push(Channel { name: "cell".into(), freedom: Freedom::point("cell"), ..noise });
    write(place.path(), "two.csv", &hit);
    let text = std::fs::read_to_string(place.path().join("two.csv")).unwrap();
    std::fs::write(place.path().join("two.csv"), text.replacen("cell [m/s^2]", "cell [N]", 1)).unwrap();
    let said = warnings(&run(place.path(), "two.csv --at a1 --band 60:480 --out two"));
    assert!(
        said.contains("two.csv, channel cell: it measures a force too and is left out, the hammer is hammer"),
        "{said}"
    );
}
