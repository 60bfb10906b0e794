//! Bad input: exit code 2, one clear message with file, place, value and remedy, nothing written.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use crate::common::{SMALL, folder, iwan, names, shown};

/// Replaces once in the small scenario and runs it; the shown result must be a refusal that wrote nothing.
fn refused(from: &str, to: &str) -> String {
    assert!(SMALL.contains(from), "{from}");
    refused_text(SMALL.replacen(from, to, 1).as_bytes(), "simulate in.toml --out out")
}

fn refused_text(scenario: &[u8], arguments: &str) -> String {
    let place = folder("");
    std::fs::write(place.path().join("in.toml"), scenario).unwrap();
    let output = iwan(place.path(), arguments);
    assert_eq!(output.status.code(), Some(2), "{}", shown(&output));
    assert!(output.stdout.is_empty());
    assert_eq!(names(place.path()), ["in.toml"], "something was written");
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(text.starts_with("error: ") && text.contains("\nremedy: "), "{text}");
    text
}

/// All messages in one snapshot: they are read side by side.
#[test]
fn values_keys_and_kinds() {
    let cases = [
        ("chi at -1", "chi = -0.183", "chi = -1.0"),
        ("chi not a number", "chi = -0.183", "chi = nan"),
        ("negative stiffness", "k_t = 4.45e4", "k_t = -4.45e4"),
        ("infinite slip force", "f_s = 239.4", "f_s = inf"),
        ("negative beta", "beta = 0.3", "beta = -0.3"),
        ("joint stiffer than its mode", "k_t = 4.45e4", "k_t = 4.45e6"),
        ("negative frequency", "frequency = 124.0", "frequency = -124.0"),
        ("damping ratio in percent", "damping_ratio = 0.01", "damping_ratio = 1.0"),
        ("unknown key of a mode", "frequency = 124.0", "frequncy = 124.0"),
        ("unknown key of a joint", "f_s = 239.4", "F_S = 239.4"),
        ("unknown table", "[time]", "[tme]"),
        ("nothing like it", "[time]", "[zzzzzz]\n[time]"),
        ("wrong type", "frequency = 124.0", "frequency = \"124 Hz\""),
        ("missing key", "frequency = 124.0", ""),
        ("missing parameter", ", beta = 0.3", ""),
        ("missing table", "[time]\nstep = 1.0e-4\nduration = 0.1\n", ""),
        ("key of another kind", "amplitude = 4000.0", "amplitude = 4000.0\nfrequency = 50.0"),
        ("unknown kind", "kind = \"haversine\"", "kind = \"hammer\""),
        ("no kind of force", "kind = \"haversine\"", ""),
        ("zero step", "step = 1.0e-4", "step = 0.0"),
        ("infinite duration", "duration = 0.1", "duration = inf"),
        ("step longer than the response", "step = 1.0e-4", "step = 1.0"),
        ("step longer than half a period", "step = 1.0e-4", "step = 5.0e-3"),
        ("too many steps", "step = 1.0e-4", "step = 1.0e-13"),
        ("duration of the force", "duration = 1.6e-3", "duration = -1.6e-3"),
        ("duplicate mode name", "name = \"linear\"", "name = \"bending 1\""),
        ("point named like a mode", "root = 1.0", "linear = 1.0"),
        ("shape not finite", "root = 1.0", "root = nan"),
        ("empty name", "name = \"linear\"", "name = \"\""),
        ("sliders for the continuum", "joint = \"sliders\"", "joint = \"continuum\""),
        ("zero sliders", "sliders = 50", "sliders = 0"),
        ("too many sliders", "sliders = 50", "sliders = 1000000000"),
        ("prewarp of another scheme", "sliders = 50", "prewarp = true\nbeta = 0.3"),
        ("beta out of range", "sliders = 50", "beta = 0.0"),
        ("key of another method", "kind = \"newmark\"", "kind = \"half-cycle\""),
        ("duplicate key", "frequency = 124.0", "frequency = 124.0\nfrequency = 125.0"),
        ("not TOML", "[time]", "[time"),
        ("modes that are no tables", "[time]", "[time]\nmode = 3"),
        (
            "missing force file",
            "kind = \"haversine\"\namplitude = 4000.0\nduration = 1.6e-3",
            "kind = \"file\"\npath = \"no.csv\"",
        ),
    ];
    let shown: Vec<_> =
        cases.iter().map(|(name, from, to)| format!("{name}\n{}", refused(from, to))).collect();
    insta::assert_snapshot!(shown.join("\n"));
}

#[test]
fn files_that_are_no_scenarios() {
    let run = "simulate in.toml --out out";
    let texts: [(&str, &[u8], &str); 6] = [
        ("empty", b"  \n", run),
        ("binary", b"\x89PNG\r\n\x1a\n\0\0\0\xff", run),
        ("zero bytes", b"a = 1\0", run),
        ("no mode", b"[force]\nkind = 'none'\n[time]\nstep = 1.0\nduration = 2.0", run),
        ("missing", b"", "simulate other.toml --out out"),
        ("folder", b"", "simulate . --out out"),
    ];
    let shown: Vec<_> = texts
        .iter()
        .map(|(name, text, arguments)| format!("{name}\n{}", refused_text(text, arguments)))
        .collect();
    insta::assert_snapshot!(shown.join("\n"));
}

#[test]
fn changes_that_do_not_fit() {
    let texts = [
        "simulate in.toml --out out --sliders 20 --method half-cycle",
        "simulate in.toml --out out --joint continuum --method event",
        "simulate in.toml --out out --step 0.01",
        "simulate in.toml --out out --duration 1e-9",
        "simulate in.toml --out out --step 1e-12",
        "simulate in.toml --out in.toml",
        "simulate in.toml --out in.toml/below",
    ];
    let shown: Vec<_> = texts
        .iter()
        .map(|arguments| format!("iwan {arguments}\n{}", refused_text(SMALL.as_bytes(), arguments)))
        .collect();
    insta::assert_snapshot!(shown.join("\n"));
}

#[test]
fn force_files_are_checked() {
    let formula = "kind = \"haversine\"\namplitude = 4000.0\nduration = 1.6e-3";
    let scenario = SMALL.replace(formula, "kind = \"file\"\npath = \"blow.csv\"");
    let files = [
        ("three columns", "t,a,b\n0,1,2\n1,2,3\n"),
        ("descending time", "t,force\n0,1\n2,2\n1,3\n"),
        ("before zero", "t,force\n-1,1\n0,2\n1,3\n"),
        ("a word", "t,force\n0,1\n1,many\n"),
        ("one sample", "t,force\n0,1\n"),
        ("not finite", "t,force\n0,1\n1,nan\n"),
        ("empty", ""),
    ];
    let mut shown = Vec::new();
    for (name, text) in files {
        let place = folder(&scenario);
        std::fs::write(place.path().join("blow.csv"), text).unwrap();
        let output = iwan(place.path(), "simulate in.toml --out out");
        assert_eq!(output.status.code(), Some(2), "{name}");
        assert_eq!(names(place.path()), ["blow.csv", "in.toml"], "{name}");
        shown.push(format!("{name}\n{}", String::from_utf8(output.stderr).unwrap()));
    }
    insta::assert_snapshot!(shown.join("\n"));
}
