//! Hostile files, a machine that lacks something, processes that are killed: an answer each time, and nothing left behind.
#![allow(clippy::unwrap_used, reason = "tests may panic")]
#![cfg(unix)]

use std::path::Path;
use std::process::{Output, Stdio};
use std::time::{Duration, Instant};

use crate::common::{SMALL, folder, iwan, names, ring_down, shown};
use crate::hits_of_bench::hits;
use assert_cmd::Command;

/// Longest time that a refusal may take on a busy machine, s.
const PROMPT: Duration = Duration::from_secs(20);

/// Runs `iwan` with at most 2 GB of addresses, so that a fault does no harm, and with further variables.
fn bounded(place: &Path, arguments: &str, variables: &[(&str, &str)]) -> Output {
    let program = assert_cmd::cargo::cargo_bin!("iwan").display().to_string();
    let line = format!("ulimit -v 2000000; exec {program} {arguments}");
    let mut command = Command::new("sh");
    command.args(["-c", &line]).current_dir(place).envs(variables.iter().copied());
    command.timeout(PROMPT).output().unwrap()
}

/// The error of a run that was refused with `code` and left only what was there.
fn refused(place: &Path, arguments: &str, code: i32) -> String {
    let before = names(place);
    let output = bounded(place, arguments, &[]);
    assert_eq!(output.status.code(), Some(code), "{arguments}: {}", shown(&output));
    assert_eq!(names(place), before, "{arguments} left something");
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(text.starts_with("error: ") && text.contains("\nremedy: "), "{arguments}: {text}");
    text
}

/// A NumPy array by its shape, with these bytes behind the header.
fn npy(shape: &str, data: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
    let header = format!("{header:<117}\n");
    [b"\x93NUMPY\x01\x00".as_slice(), &118_u16.to_le_bytes(), header.as_bytes(), data].concat()
}

/// A file of 128 bytes hung: columns of no rows were counted one by one.
#[test]
fn an_array_of_nothing_is_refused_at_once() {
    let place = folder("");
    for shape in ["(0, 9223372036854775807)", "(9223372036854775807, 0)", "(0,)"] {
        std::fs::write(place.path().join("zero.npy"), npy(shape, &[])).unwrap();
        assert!(refused(place.path(), "envelope zero.npy --rate 1000 --out out", 2).contains("no channel"));
    }
}

/// An archive of two arrays with one name: the last was taken without a word. Half a gigabyte of zeros, 0.5 MB packed, was unpacked
/// and filled the memory many times over.
#[test]
fn archives_say_each_name_once_and_grow_a_hundredfold_at_most() {
    let place = folder("");
    let archive = |entries: &[(&str, Vec<u8>)]| {
        let mut bytes = std::io::Cursor::new(Vec::new());
        let mut writer = zip::ZipWriter::new(&mut bytes);
        let packed = zip::write::SimpleFileOptions::default();
        for (name, content) in entries {
            writer.start_file(*name, packed).unwrap();
            std::io::Write::write_all(&mut writer, content).unwrap();
        }
        writer.finish().unwrap();
        bytes.into_inner()
    };
    let small = npy("(2,)", &[0; 16]);
    let mut twice = archive(&[("a.npy", small.clone()), ("b.npy", small)]);
    while let Some(at) = twice.windows(5).position(|w| w == b"b.npy") {
        twice[at] = b'a';
    }
    std::fs::write(place.path().join("twice.npz"), twice).unwrap();
    assert!(
        refused(place.path(), "envelope twice.npz --rate 9 --out out", 2).contains("two entries 'a.npy'")
    );
    let bomb = archive(&[("a.npy", npy("(20000000,)", &vec![0; 160_000_000]))]);
    assert!(bomb.len() < 200_000);
    std::fs::write(place.path().join("bomb.npz"), bomb).unwrap();
    assert!(refused(place.path(), "envelope bomb.npz --rate 9 --out out", 2).contains("100 times"));
}

/// A pipe without a writer was waited for without end, /dev/zero was read until the memory was full.
#[test]
fn what_is_no_file_is_refused() {
    let place = folder("");
    let made = std::process::Command::new("mkfifo").arg(place.path().join("pipe")).status().unwrap();
    assert!(made.success());
    for command in ["envelope", "simulate", "modes"] {
        let text = refused(place.path(), &format!("{command} pipe --out out"), 2);
        assert!(text.contains("nothing was written into it"), "{text}");
        let text = refused(place.path(), &format!("{command} /dev/zero --out out"), 2);
        assert!(text.contains("is a device"), "{text}");
    }
}

/// A pipe that never ends filled the memory: no scenario is as long.
#[test]
fn a_pipe_without_an_end_is_refused() {
    let place = folder("");
    let program = assert_cmd::cargo::cargo_bin!("iwan").display().to_string();
    for command in ["simulate", "modes", "frf"] {
        let line = format!("cat /dev/zero | {program} {command} /dev/stdin --out out");
        let output =
            Command::new("sh").args(["-c", &line]).current_dir(place.path()).timeout(PROMPT).output();
        let output = output.unwrap();
        assert_eq!(output.status.code(), Some(2), "{}", shown(&output));
        assert!(shown(&output).contains("over 16 MB"), "{}", shown(&output));
    }
}

#[test]
fn a_pipe_with_a_writer_is_a_file() {
    let place = folder(SMALL);
    let program = assert_cmd::cargo::cargo_bin!("iwan").display().to_string();
    let line = format!("cat in.toml | {program} simulate /dev/stdin --out out --quiet");
    let output = Command::new("sh").args(["-c", &line]).current_dir(place.path()).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", shown(&output));
}

/// Responses, tables and factors that do not fit ended in an abort, or took the machine with them.
#[test]
fn memory_is_asked_for_before_it_is_taken() {
    let place = folder(&SMALL.replace("step = 1.0e-4", "step = 2.0e-9"));
    let text = refused(place.path(), "simulate in.toml --out out", 1);
    assert!(text.contains("50000001 samples") && text.contains("GB of memory"), "{text}");
    let text = refused(place.path(), "simulate in.toml --duration 1e-3 --memory 20MB --out out", 1);
    assert!(text.contains("--memory allows"), "{text}");
    let block = "[mesh]\nkind = \"block\"\nsize = [1.0, 1.0, 1.0]\ncells = [100, 100, 100]\n[[material]]\nyoung = 1.0\n\
                 poisson = 0.3\ndensity = 1.0\n";
    std::fs::write(place.path().join("block.toml"), block).unwrap();
    let text = refused(place.path(), "modes block.toml --out out", 2);
    assert!(text.contains("block.toml:4:") && text.contains("GB of memory"), "{text}");
}

/// Analyses that took no account of their memory before they began, and those whose estimate is too small, end in words as well.
#[test]
fn what_memory_allows_holds_for_every_command() {
    let place = folder(SMALL);
    hits(place.path(), 2);
    let sweep =
        SMALL.to_string() + "[sweep]\nfrom = 100.0\nto = 130.0\nforce = [1.0, 2.0]\npoints = 1000000\n";
    std::fs::write(place.path().join("sweep.toml"), sweep).unwrap();
    for (line, said) in [
        ("modal h1.csv h2.csv --at a1 --band 60:480 --memory 24MB", "the analysis of "),
        ("frf sweep.toml --memory 400MB", "points of steady responses"),
        ("backbone in.toml --points 100000 --memory 40MB", "points of backbones"),
        ("modes --memory 20MB", "needs about"),
    ] {
        let text = refused(place.path(), &format!("{line} --out out"), 1);
        assert!(text.contains(said) && text.contains("--memory allows"), "{line}: {text}");
    }
}

/// Under a bound on address space the kernels of matrices reserved a gigabyte and aborted the process, and so did a response that seemed to fit.
#[cfg(target_os = "linux")]
#[test]
fn a_bound_on_address_space_is_no_abort() {
    let place = folder("");
    let program = assert_cmd::cargo::cargo_bin!("iwan").display().to_string();
    // As many windows as a record can have, and with them the largest matrices of a fit; fits take longest, so that they run under three bounds.
    let text = ring_down(2000.0, 2000, &[(124.0, 2e-3, 1.0)], &[&[1.0]], "a [m/s^2]");
    std::fs::write(place.path().join("hit.csv"), text).unwrap();
    for megabytes in [50, 100, 200, 300, 400, 600, 1000, 1500] {
        for command in ["simulate --duration 20", "modes", "quasi-static", "fit hit.csv", "envelope hit.csv"]
        {
            if command.starts_with("fit") && ![100, 300, 400].contains(&megabytes) {
                continue;
            }
            let line =
                format!("ulimit -v {megabytes}000; exec {program} {command} --force --out out --quiet");
            let output = Command::new("bash").args(["-c", &line]).current_dir(place.path()).output().unwrap();
            let code = output.status.code();
            assert!(
                code == Some(0) || code == Some(1),
                "{megabytes} MB, {command}: {code:?} {}",
                shown(&output)
            );
            assert!(
                code == Some(0) || shown(&output).contains("ulimit -v"),
                "{megabytes} MB, {command}: {}",
                shown(&output)
            );
        }
    }
}

/// A thread that cannot be had was a panic, also with `--threads 1`. A stack of 100 TB cannot be had anywhere.
#[test]
fn work_is_done_without_threads() {
    let place = folder(SMALL);
    let record = ring_down(2000.0, 1000, &[(124.0, 0.005, 1.0)], &[&[1.0]], "acc");
    std::fs::write(place.path().join("r.csv"), record).unwrap();
    hits(place.path(), 2);
    for (n, line) in [
        "simulate in.toml",
        "simulate in.toml --threads 1000",
        "envelope r.csv",
        "fit r.csv",
        "modal h1.csv h2.csv --at a1 --band 60:480",
        "modes --count 3",
    ]
    .iter()
    .enumerate()
    {
        let none = [("RUST_MIN_STACK", "100000000000000")];
        let output = bounded(place.path(), &format!("{line} --quiet --out out{n}"), &none);
        assert_eq!(output.status.code(), Some(0), "{line}: {}", shown(&output));
    }
}

/// Searches for modes had no end.
#[test]
fn absurd_structures_are_refused() {
    let place = folder("");
    let beam = String::from_utf8(iwan(place.path(), "scenario paper-a").stdout).unwrap();
    let cases = [
        ("young = 28.0e6", "young = 1e300", "1e30", 2),
        ("young = 28.0e6", "young = 1e-300", "1e-30", 2),
        ("density = 7.48e-4", "density = 1e-200", "1e-30", 2),
        ("poisson = 0.29", "poisson = 0.4999999", "zero modes of a free body", 1),
    ];
    for (from, to, said, code) in cases {
        std::fs::write(place.path().join("in.toml"), beam.replacen(from, to, 1)).unwrap();
        let before = names(place.path());
        let output = bounded(place.path(), "modes in.toml --out out", &[]);
        assert_eq!(output.status.code(), Some(code), "{to}: {}", shown(&output));
        assert!(shown(&output).contains(said), "{to}: {}", shown(&output));
        assert_eq!(names(place.path()), before);
    }
    // A body without joints as well: it has one search for both limits.
    let block = "[mesh]\nkind = \"block\"\nsize = [1.0, 0.1, 0.05]\ncells = [20, 4, 2]\n\
        [[material]]\nyoung = 2.1e11\npoisson = 0.4999999999\ndensity = 7850.0\n";
    std::fs::write(place.path().join("block.toml"), block).unwrap();
    let output = bounded(place.path(), "modes block.toml --count 3 --out out", &[]);
    assert_eq!(output.status.code(), Some(1), "{}", shown(&output));
    assert!(shown(&output).contains("zero modes of a free body"), "{}", shown(&output));
    // One whose nodes are all held: a panic in the factorisation of nothing.
    let set = "[[set]]\nkind = \"box\"\nname = \"all\"\nlow = [-9.0, -9.0, -9.0]\nhigh = [9.0, 9.0, 9.0]\n";
    let support = "[[support]]\nname = \"ground\"\nnodes = \"all\"\nfixed = [\"x\", \"y\", \"z\"]\n";
    let held = block.replace("0.4999999999", "0.3") + set + support;
    std::fs::write(place.path().join("held.toml"), held).unwrap();
    let output = bounded(place.path(), "modes held.toml --out out", &[]);
    assert_eq!(output.status.code(), Some(1), "{}", shown(&output));
    assert!(shown(&output).contains("no unknowns are left"), "{}", shown(&output));
    std::fs::write(place.path().join("in.toml"), beam).unwrap();
    let output = bounded(place.path(), "modes in.toml --count 100000 --out out", &[]);
    assert!(shown(&output).contains("100000 modes were asked for"), "{}", shown(&output));
}

/// Control characters of files went to the terminal as they were.
#[test]
fn names_from_files_are_shown_harmlessly() {
    let place = folder("");
    std::fs::write(place.path().join("r.csv"), "t,\u{1b}]0;owned\u{7}acc\n0,1\n1,x\u{1b}[31m\n").unwrap();
    for line in ["envelope r.csv --out out", "envelope \u{1b}[2J.csv --out out"] {
        let output = bounded(place.path(), &line.replace('\u{1b}', "'\u{1b}'").replace('[', "'['"), &[]);
        assert!(!output.status.success());
        assert!(!output.stderr.contains(&0x1b) && !output.stderr.contains(&7), "{}", shown(&output));
    }
}

/// Of two runs without a folder of their own the second one computed and failed; both took one folder that was there.
#[test]
fn two_runs_at_once_do_not_mix() {
    let place = folder(SMALL);
    std::fs::create_dir(place.path().join("there")).unwrap();
    let start = |arguments: &str| {
        let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin!("iwan"));
        command.args(arguments.split_whitespace()).current_dir(place.path());
        command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
    };
    let both = [0.05, 0.06].map(|d| start(&format!("simulate in.toml --duration {d}")));
    let codes = both.map(|child| child.wait_with_output().unwrap().status.code());
    assert_eq!(codes, [Some(0), Some(0)]);
    assert_eq!(names(place.path()), ["in.toml", "iwan-simulate", "iwan-simulate-2", "there"]);
    let both = [0.05, 0.06].map(|d| start(&format!("simulate in.toml --duration {d} --out there")));
    let won = both.map(|child| child.wait_with_output().unwrap().status.success());
    assert_eq!(won.iter().filter(|won| **won).count(), 1, "{won:?}");
    assert_eq!(names(&place.path().join("there")).len(), 4);
}

/// A simulation of 40 MB of samples, begun; returns when its table is being written.
fn writing(place: &Path) -> std::process::Child {
    let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin!("iwan"));
    command.args("simulate in.toml --duration 100 --out out".split_whitespace()).current_dir(place);
    let child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let begun = Instant::now();
    let long = |entry: std::fs::DirEntry| {
        let table = entry.path().join("response.csv");
        std::fs::metadata(table).is_ok_and(|meta| meta.len() > 1_000_000)
    };
    while !std::fs::read_dir(place).unwrap().flatten().any(long) {
        assert!(begun.elapsed() < PROMPT, "no table is written");
        std::thread::sleep(Duration::from_millis(1));
    }
    child
}

fn send(child: &std::process::Child, signal: &str) {
    let sent = std::process::Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
}

/// While a long table was written, a request to end was heard after seconds.
#[test]
fn a_request_to_end_is_heard_while_files_are_written() {
    let place = folder(SMALL);
    let mut child = writing(place.path());
    let asked = Instant::now();
    send(&child, "-TERM");
    let status = child.wait().unwrap();
    assert!(asked.elapsed() < Duration::from_millis(700), "{:?}", asked.elapsed());
    assert_eq!(status.code(), Some(130));
    assert_eq!(names(place.path()), ["in.toml"]);
}

/// What a killed run leaves goes with the next run.
#[test]
fn a_killed_run_leaves_nothing_under_a_final_name_and_the_next_one_clears_up() {
    let place = folder(SMALL);
    let mut child = writing(place.path());
    send(&child, "-KILL");
    child.wait().unwrap();
    assert!(!place.path().join("out").exists());
    assert_eq!(names(place.path()).len(), 2);
    let output = iwan(place.path(), "simulate in.toml --out out --quiet");
    assert_eq!(output.status.code(), Some(0), "{}", shown(&output));
    assert_eq!(names(place.path()), ["in.toml", "out"]);
}

/// A tolerance that is not met is a failure where that is asked for; the results are there all the same.
#[test]
fn a_warning_is_a_failure_by_the_users_word() {
    let place = folder(&SMALL.replace("step = 1.0e-4", "step = 3.0e-4"));
    let output = iwan(place.path(), "simulate in.toml --out a");
    assert_eq!(output.status.code(), Some(0), "{}", shown(&output));
    assert!(shown(&output).contains("warning: "), "{}", shown(&output));
    let output = iwan(place.path(), "simulate in.toml --strict --quiet --out b");
    assert_eq!(output.status.code(), Some(1), "{}", shown(&output));
    assert!(shown(&output).contains("--strict: ") && place.path().join("b/summary.json").exists());
}

/// Commands that work on structures for long: the work goes on in factorisations and searches that do not look up.
#[test]
fn ctrl_c_ends_every_command_on_structures() {
    let place = folder("");
    let beam = String::from_utf8(iwan(place.path(), "scenario paper-a").stdout).unwrap();
    let fine = beam.replacen("refinement = 1", "refinement = 4", 1);
    assert_ne!(fine, beam);
    std::fs::write(place.path().join("beam.toml"), fine).unwrap();
    let scenario = "[structure]\npath = \"beam.toml\"\n[force]\nkind = \"haversine\"\namplitude = 100.0\nduration = 1e-3\n\
        [time]\nstep = 1e-5\nduration = 0.1\n\
        [sweep]\nfrom = 100.0\nto = 160.0\nforce = [1.0]\nat = \"tip\"\n";
    std::fs::write(place.path().join("run.toml"), scenario).unwrap();
    let there = names(place.path());
    for line in [
        "modes beam.toml",
        "quasi-static beam.toml",
        "simulate run.toml",
        "frf run.toml",
        "backbone run.toml",
    ] {
        let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin!("iwan"))
            .args(line.split(' ').chain(["--out", "out"]))
            .current_dir(place.path())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        std::thread::sleep(std::time::Duration::from_secs(1));
        assert!(child.try_wait().unwrap().is_none(), "{line} ended before it was interrupted");
        let id = child.id().to_string();
        assert!(std::process::Command::new("kill").args(["-INT", &id]).status().unwrap().success());
        let output = child.wait_with_output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(130), "{line}: {said}");
        assert!(said.ends_with("interrupted: nothing was written\n"), "{line}: {said}");
        assert_eq!(names(place.path()), there, "{line}");
    }
}
