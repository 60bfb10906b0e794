//! Too few handles of files, a disk or a limit that is full, and slips of the pen: refused in true words, and before long work.
#![allow(clippy::unwrap_used, reason = "tests may panic")]
#![cfg(unix)]

use std::fmt::Write;
use std::path::Path;
use std::process::Output;

use assert_cmd::Command;

use crate::common::{SMALL, folder, iwan, names, ring_down, shown};
use crate::hits_of_bench::{bench, hits, refused, write};

/// Commands that write results, each with files of its own.
const COMMANDS: [&str; 8] = [
    "simulate in.toml",
    "simulate in.toml --stream",
    "fit r.csv",
    "envelope r.csv",
    "modal h1.csv h2.csv --at a1 --band 60:480",
    "frf in.toml",
    "modes --count 3",
    "quasi-static",
];

fn prepared() -> tempfile::TempDir {
    let place = folder(&(SMALL.to_string() + "[sweep]\nfrom = 100.0\nto = 130.0\nforce = [1.0]\n"));
    let record = ring_down(2000.0, 600, &[(124.0, 0.005, 1.0)], &[&[1.0]], "a [m/s^2]");
    std::fs::write(place.path().join("r.csv"), record).unwrap();
    hits(place.path(), 2);
    place
}

fn under(limit: &str, place: &Path, arguments: &str) -> Output {
    let program = assert_cmd::cargo::cargo_bin!("iwan").display().to_string();
    let line = format!("ulimit {limit}; exec {program} {arguments} --quiet --out out");
    Command::new("bash").args(["-c", &line]).current_dir(place).output().unwrap()
}

/// The system's signal ended the program in the midst of its files, which stayed.
#[test]
fn a_limit_on_the_length_of_files_is_an_error_and_leaves_nothing() {
    let place = prepared();
    let before = names(place.path());
    for command in COMMANDS {
        let output = under("-f 1", place.path(), command);
        assert_eq!(output.status.code(), Some(1), "{command}: {}", shown(&output));
        assert!(
            shown(&output).contains("remedy: raise the limit on the length of files (`ulimit -f`)"),
            "{}",
            shown(&output)
        );
        assert_eq!(names(place.path()), before, "{command}");
    }
}

/// Free memory could not be read, and that was a panic; a folder that may be written to was said to be at fault.
#[test]
fn too_few_handles_are_an_error_and_leave_nothing() {
    let place = prepared();
    let before = names(place.path());
    for command in COMMANDS {
        for handles in [4, 5, 6, 8, 12, 16] {
            let output = under(&format!("-n {handles}"), place.path(), command);
            let told = shown(&output);
            match output.status.code() {
                Some(0) => std::fs::remove_dir_all(place.path().join("out")).unwrap(),
                Some(1) => assert!(told.contains("ulimit -n"), "{command}, {handles}: {told}"),
                _ => panic!("{command}, {handles}: {told}"),
            }
            assert_eq!(names(place.path()), before, "{command}, {handles}");
        }
    }
}

#[test]
fn a_full_disk_under_standard_output_is_an_error() {
    let place = folder(SMALL);
    let program = assert_cmd::cargo::cargo_bin!("iwan").display().to_string();
    for line in ["simulate in.toml --quiet --out out", "scenario --list", "man"] {
        let line = format!("{program} {line} > /dev/full");
        let output = Command::new("sh").args(["-c", &line]).current_dir(place.path()).output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{}", shown(&output));
        assert!(shown(&output).contains("cannot write to standard output"), "{}", shown(&output));
    }
}

/// A level that there is not was named after the analysis of all others, and a channel that the table of shapes cannot hold failed at its end.
#[test]
fn slips_in_modal_tests_are_refused_before_the_analysis() {
    let place = folder("");
    hits(place.path(), 2);
    refused(
        place.path(),
        "h1.csv h2.csv --at a1 --level 3 --band 9000:9100",
        &["--level 3", "there is one level of force"],
    );
    for (n, mut hit) in bench().hits(100.0, 2, 1).into_iter().enumerate() {
        hit.responses[3].name = "frequency".into();
        write(place.path(), &format!("f{n}.csv"), &hit);
    }
    refused(
        place.path(),
        "f0.csv f1.csv --at a1 --band 9000:9100",
        &["channel \"frequency\"", "table of shapes"],
    );
}

/// Rates of 1e-300 Hz gave results in numbers of three hundred digits, and a fit with a mass of 1e-300 had no end within a minute.
#[test]
fn absurd_rates_and_masses_are_refused() {
    let place = prepared();
    for rate in ["1e-300", "1e-10", "1e16", "1e308"] {
        let output = iwan(place.path(), &format!("envelope r.csv --rate {rate} --out out"));
        assert_eq!(output.status.code(), Some(2), "{}", shown(&output));
        assert!(shown(&output).contains("it must lie between 1e-9 and 1e15 Hz"), "{}", shown(&output));
    }
    for mass in ["1e-300", "1e31"] {
        let output = iwan(place.path(), &format!("fit r.csv --mass {mass} --out out"));
        assert_eq!(output.status.code(), Some(2), "{}", shown(&output));
        assert!(shown(&output).contains("must lie between 1e-30 and 1e30"), "{}", shown(&output));
    }
    let output = iwan(place.path(), "envelope r.csv --rate 4000 --out out");
    assert_eq!(output.status.code(), Some(0), "{}", shown(&output));
    assert!(
        shown(&output).contains("the rate given, 4000.0 Hz, was used in place of the file's, 2000.0 Hz"),
        "{}",
        shown(&output)
    );
}

/// Lines of what a file holds went into messages as long as they were, and 1e300 as three hundred digits.
#[test]
fn messages_are_short_whatever_the_file_holds() {
    let place = folder("");
    let digits = "7".repeat(400);
    let name = "n".repeat(5000);
    let rows = |cell: &str| {
        (0..20).fold(String::new(), |mut text, n| {
            writeln!(text, "{n},{cell}").unwrap();
            text
        })
    };
    let files = [
        ("cell.csv", format!("t,a\n{}5,x{digits}\n", rows("1"))),
        ("huge.csv", (0..60).fold("t,a\n".to_string(), |text, n| text + &format!("{n}e300,{}e305\n", n % 7))),
        ("back.csv", format!("t,a\n{}1e300,1\n1,2\n", rows("1"))),
        ("name.csv", format!("t,{name}\n{}", rows("x"))),
        ("names.csv", format!("t,{}\n{}", vec![name.as_str(); 50].join(","), rows("1"))),
        ("key.toml", format!("{name} = 1\n{SMALL}")),
        ("number.toml", SMALL.replace("duration = 0.1", "duration = 1e300")),
        ("digits.toml", SMALL.replace("duration = 0.1", &format!("duration = {digits}.0"))),
        ("frequency.toml", SMALL.replace("frequency = 124.0", "frequency = -1e300")),
        ("mesh.inp", format!("*NODE\n1,{digits},0,x{name}\n")),
        (
            "h.uff",
            format!(
                "    -1\n    58\n{name}\nNONE\nNONE\nNONE\nNONE\n{digits}\n{digits} {digits} {digits}\n    -1\n"
            ),
        ),
    ];
    for (file, text) in files {
        std::fs::write(place.path().join(file), text).unwrap();
        for command in ["envelope", "simulate", "modes", "modal"] {
            let output = iwan(place.path(), &format!("{command} {file} --out out --force"));
            let json = iwan(place.path(), &format!("{command} {file} --out out --force --json --quiet"));
            let told: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
            let said = [&output.stdout, &output.stderr]
                .map(|bytes| String::from_utf8_lossy(bytes).into_owned())
                .concat();
            let message = told["error"]["message"].as_str().unwrap_or_default();
            for line in said.lines().chain([message]) {
                assert!(
                    line.chars().count() <= 1010,
                    "{command} {file}: {} characters: {line:.300}",
                    line.chars().count()
                );
                assert!(
                    !line.contains(&"0".repeat(50)) && !line.contains(&"7".repeat(50)),
                    "{command} {file}: {line:.300}"
                );
            }
        }
    }
}

/// Sets without a member were taken without a word.
#[test]
fn empty_sets_of_a_mesh_are_named() {
    let place = folder("");
    let mesh = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n*ELEMENT,TYPE=C3D8,ELSET=all\n1,1,2,3,4,5,6,7,8\n\
        *NSET,NSET=nobody\n*ELSET,ELSET=none\n*NSET,NSET=also\nnobody\n*NSET,NSET=far,GENERATE\n90,99\n*NSET,NSET=base\n1,2,3,4\n";
    std::fs::write(place.path().join("m.inp"), mesh).unwrap();
    let text = "[mesh]\nkind = \"file\"\npath = \"m.inp\"\n[[material]]\nyoung = 1.0\npoisson = 0.3\ndensity = 1.0\n";
    std::fs::write(place.path().join("m.toml"), text).unwrap();
    let output = iwan(place.path(), "modes m.toml --count 3 --out out");
    assert_eq!(output.status.code(), Some(0), "{}", shown(&output));
    for said in [
        "the node set nobody is empty",
        "the element set none is empty",
        "the node set also is empty",
        "the node set far runs from 90 to 99",
    ] {
        assert!(shown(&output).contains(said), "{said}: {}", shown(&output));
    }
    assert!(!shown(&output).contains("base"), "{}", shown(&output));
    for set in ["nobody", "far", "also"] {
        let support = format!("{text}[[support]]\nname = \"ground\"\nnodes = \"{set}\"\nfixed = [\"x\"]\n");
        std::fs::write(place.path().join("s.toml"), support).unwrap();
        let output = iwan(place.path(), "modes s.toml --out held");
        assert_eq!(output.status.code(), Some(2), "{}", shown(&output));
        assert!(shown(&output).contains(set), "{}", shown(&output));
    }
}

/// An archive of NumPy arrays of float64, 1 for each of the numbers.
fn archive(path: &Path, arrays: &[(&str, &[f64])]) {
    let mut writer = zip::ZipWriter::new(std::fs::File::create(path).unwrap());
    for (name, numbers) in arrays {
        writer.start_file(format!("{name}.npy"), zip::write::SimpleFileOptions::default()).unwrap();
        let letters = *name == "format";
        let (kind, shape) =
            if letters { ("|S3", "()".to_string()) } else { ("<f8", format!("({},)", numbers.len())) };
        let header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}");
        let header = format!("{header:<117}\n");
        let mut bytes = [b"\x93NUMPY\x01\x00".as_slice(), &118_u16.to_le_bytes(), header.as_bytes()].concat();
        let content: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
        bytes.extend(if letters { b"coo".to_vec() } else { content });
        std::io::Write::write_all(&mut writer, &bytes).unwrap();
    }
    writer.finish().unwrap();
}

/// Of an archive that holds a record and a matrix each reader took its part without a word.
#[test]
fn records_and_matrices_in_one_archive_are_told_apart() {
    let place = folder("");
    let times: Vec<f64> = (0..400).map(|n| f64::from(n) * 1e-3).collect();
    let motion: Vec<f64> = times.iter().map(|t| (-3.0 * t).exp() * (600.0 * t).cos()).collect();
    let both: [(&str, &[f64]); 7] = [
        ("t", &times),
        ("a", &motion),
        ("format", &[]),
        ("shape", &[2.0, 2.0]),
        ("data", &[1.0, 1.0]),
        ("row", &[0.0, 1.0]),
        ("col", &[0.0, 1.0]),
    ];
    archive(&place.path().join("both.npz"), &both);
    let output = iwan(place.path(), "envelope both.npz --out out");
    assert_eq!(output.status.code(), Some(2), "{}", shown(&output));
    assert!(
        shown(&output).contains("a sparse matrix as scipy.sparse.save_npz writes it"),
        "{}",
        shown(&output)
    );
    let output = iwan(place.path(), "envelope both.npz --channel a --out out");
    assert_eq!(output.status.code(), Some(0), "{}", shown(&output));
    archive(&place.path().join("k.npz"), &both[2..]);
    archive(&place.path().join("k2.npz"), &both[1..]);
    let text = |file: &str| format!("[matrices]\nstiffness = \"{file}\"\nmass = \"k.npz\"\n");
    std::fs::write(place.path().join("m.toml"), text("k2.npz")).unwrap();
    let output = iwan(place.path(), "modes m.toml --out modes");
    assert_eq!(output.status.code(), Some(2), "{}", shown(&output));
    assert!(shown(&output).contains("beside it the array 'a'"), "{}", shown(&output));
}
