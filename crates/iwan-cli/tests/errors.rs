//! The catalogue of errors: each kind is provoked through the program, and the book lists them all.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::fmt::Write as _;
use std::path::Path;

use iwan_machine::Kind;

use crate::common::{SMALL, folder, iwan, ring_down, shown};

/// A kind, the command that provokes it, and its exit code where that is not the kind's usual one.
type Case = (Kind, &'static str, Option<u8>);

const CASES: &[Case] = &[
    (Kind::Usage, "simulate --nosuch", None),
    (Kind::Input, "simulate unknown-key.toml", None),
    (Kind::Value, "simulate chi.toml", None),
    (Kind::Unreadable, "envelope nosuch.csv", None),
    (Kind::Unreadable, "simulate nosuch.toml", None),
    (Kind::Unreadable, "modes nomesh.toml", None),
    (Kind::UnknownFormat, "envelope record.xyz", None),
    (Kind::Unsupported, "envelope complex.npy --rate 1000", None),
    (Kind::Damaged, "envelope cell.csv", None),
    (Kind::Damaged, "modes mesh.toml", None),
    (Kind::CutShort, "envelope short.npy --rate 1000", None),
    (Kind::NoTime, "envelope notime.csv", None),
    (Kind::UnknownName, "envelope ring.csv --channel nosuch", None),
    (Kind::Ambiguous, "envelope nothing.npy --rate 1000", None),
    (Kind::Mismatch, "envelope lengths.npz --time t --channel a", None),
    (Kind::TimeOrder, "envelope backwards.csv", None),
    (Kind::TimeRepeated, "envelope stutter.csv", None),
    (Kind::TimeUneven, "envelope uneven.csv", None),
    (Kind::TimeUnit, "envelope unit.csv", None),
    (Kind::SeveralTimes, "envelope several.npz", None),
    (Kind::Unit, "envelope kilograms.csv --unit SI", None),
    (Kind::NotFinite, "envelope nan.csv", None),
    (Kind::TooShort, "envelope few.csv", None),
    (Kind::Stretch, "envelope ring.csv --from 100 --to 101", None),
    (Kind::Refused, "fit ring.csv --band 300:320", None),
    (Kind::Structure, "modes inverted.toml", None),
    (Kind::MissingMode, "simulate nomode.toml", None),
    (Kind::Exists, "simulate in.toml --out results", None),
    (Kind::Checkpoint, "simulate beam.toml --checkpoint taken", None),
    (Kind::Unwritable, "simulate in.toml --out in.toml/out", Some(2)),
    (Kind::Memory, "simulate in.toml --duration 500 --memory 100MB", None),
    (Kind::Memory, "modes large.toml --memory 100MB", Some(2)),
    (Kind::Analysis, "modes rubber.toml --count 3", None),
    (Kind::Overflow, "simulate overflow.toml", None),
    (Kind::NoStiffness, "simulate soft.toml", None),
    (Kind::BeyondCurves, "simulate curves.toml", None),
    (Kind::Strict, "simulate coarse.toml --strict --out strict", None),
];

/// Kinds that one command by itself does not provoke, and why.
const OTHERS: &[(Kind, &str)] = &[
    (Kind::Busy, "two runs at once: `two_runs_at_once_do_not_mix`"),
    (Kind::Interrupted, "a signal: `ctrl_c_ends_every_command_on_structures`"),
    (Kind::Failed, "what fails in no known way"),
    (Kind::MissingSet, "from Rust: an input file says it with its line, as `input`"),
    (Kind::Fault, "a fault of the program that is not known"),
];

fn npy(kind: &str, shape: &str, bytes: usize) -> Vec<u8> {
    let header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}");
    let header = format!("{header:<117}\n");
    [b"\x93NUMPY\x01\x00".as_slice(), &118_u16.to_le_bytes(), header.as_bytes(), &vec![0; bytes]].concat()
}

/// An archive of arrays of these numbers.
fn npz(path: &Path, arrays: &[(&str, Vec<f64>)]) {
    let mut writer = zip::ZipWriter::new(std::fs::File::create(path).unwrap());
    for (name, numbers) in arrays {
        writer.start_file(format!("{name}.npy"), zip::write::SimpleFileOptions::default()).unwrap();
        let mut bytes = npy("<f8", &format!("({},)", numbers.len()), 0);
        bytes.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
        std::io::Write::write_all(&mut writer, &bytes).unwrap();
    }
    writer.finish().unwrap();
}

/// Times and values, where the time of sample n is `time(n)` and its value `value(n)`.
fn record(head: &str, count: u32, time: impl Fn(u32) -> f64, value: impl Fn(u32) -> f64) -> String {
    let mut text = format!("{head}\n");
    (0..count).for_each(|n| writeln!(text, "{},{}", time(n), value(n)).unwrap());
    text
}

/// All files that the cases need.
fn write_files(place: &Path) {
    let write = |name: &str, content: &[u8]| std::fs::write(place.join(name), content).unwrap();
    let wave = |n: u32| (0.3 * f64::from(n)).sin();
    let even = |n: u32| 1e-3 * f64::from(n);
    write("unknown-key.toml", SMALL.replace("chi =", "chy =").as_bytes());
    write("chi.toml", SMALL.replace("chi = -0.183", "chi = -1.5").as_bytes());
    write("coarse.toml", SMALL.replace("step = 1.0e-4", "step = 3.0e-4").as_bytes());
    write("overflow.toml", SMALL.replace("amplitude = 4000.0", "amplitude = 1e300").as_bytes());
    let mesh = |path: &str, more: &str| {
        format!(
            "[mesh]\nkind = \"file\"\npath = \"{path}\"\n[[material]]\nyoung = 1.0\npoisson = 0.3\ndensity = 1.0\n{more}"
        )
    };
    write("nomesh.toml", mesh("nosuch.msh", "").as_bytes());
    write("mesh.toml", mesh("damaged.inp", "").as_bytes());
    write("damaged.inp", b"*NODE\n1, 0, 0\nx, y, z, w\n");
    write("inverted.toml", mesh("inverted.inp", "").as_bytes());
    let corners = "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT,TYPE=C3D4\n";
    write("inverted.inp", format!("{corners}1,1,3,2,4\n").as_bytes());
    let block = "[mesh]\nkind = \"block\"\nsize = [1.0, 1.0, 1.0]\ncells = [2, 2, 2]\n\
                 [[material]]\nyoung = 1.0\npoisson = 0.3\ndensity = 1.0\n";
    write("large.toml", block.replace("[2, 2, 2]", "[100, 100, 100]").as_bytes());
    let rubber = "[mesh]\nkind = \"block\"\nsize = [1.0, 0.1, 0.05]\ncells = [20, 4, 2]\n\
                  [[material]]\nyoung = 2.1e11\npoisson = 0.4999999999\ndensity = 7850.0\n";
    write("rubber.toml", rubber.as_bytes());
    let beam = "[structure]\nname = \"paper-a\"\n[force]\nkind = \"haversine\"\namplitude = 1.0\nduration = 1e-3\n\
                [time]\nstep = 1e-5\nduration = 1e-3\n";
    write("beam.toml", beam.as_bytes());
    write("nomode.toml", beam.replace("[force]", "modes = [\"bending 99\"]\n[force]").as_bytes());
    let free =
        "initial = { displacement = 1.0 }\n[force]\nkind = \"none\"\n[time]\nstep = 1e-3\nduration = 1.0\n";
    let curves = "[[mode]]\nname = \"m\"\ncurves = { amplitude = [0.001, 0.01], frequency = [1, 0.99], damping_ratio = [0.01, 0.02] }\n";
    write("curves.toml", format!("{curves}{free}").as_bytes());
    let spring = "[[mode]]\nname = \"m\"\nfrequency = 1.0\ndamping_ratio = 0.01\n\
                  parts = [{ law = \"spring\", k = -1e6, exponent = 3 }]\n";
    write("soft.toml", format!("{spring}{free}").as_bytes());
    write("record.xyz", b"\x00\x01\x02 no record");
    write("complex.npy", &npy("<c16", "(50,)", 800));
    write("short.npy", &npy("<f8", "(5000,)", 80));
    write("nothing.npy", &npy("<f8", "(0,)", 0));
    let ring = ring_down(1000.0, 2000, &[(124.0, 2e-3, 1.0)], &[&[1.0]], "a");
    write("ring.csv", ring.as_bytes());
    write("again.csv", ring.as_bytes());
    write("cell.csv", b"t,a\n0,1\n0.1,x%y\n0.2,1\n");
    write("notime.csv", record("p,q", 50, |n| wave(n + 7), wave).as_bytes());
    write("backwards.csv", record("t,a", 50, |n| if n == 30 { 0.0 } else { even(n) }, wave).as_bytes());
    write("stutter.csv", record("t,a", 50, |n| even(n / 2), wave).as_bytes());
    write("uneven.csv", record("t,a", 50, |n| even(n) * (1.0 + 0.1 * even(n)).powi(60), wave).as_bytes());
    write("unit.csv", record("time [parsec],a", 50, even, wave).as_bytes());
    write("kilograms.csv", record("t [s],a [kg]", 500, even, wave).as_bytes());
    let holes = |n: u32| if n % 5 == 3 { f64::NAN } else { wave(n) };
    write("nan.csv", record("t,a", 500, even, holes).as_bytes());
    write("few.csv", record("t,a", 8, even, wave).as_bytes());
    let times = |count: u32, step: f64| (0..count).map(|n| step * f64::from(n)).collect::<Vec<f64>>();
    npz(&place.join("lengths.npz"), &[("t", times(50, 1e-3)), ("a", times(70, 0.1))]);
    npz(
        &place.join("several.npz"),
        &[
            ("x_time", times(50, 1e-3)),
            ("x_a", times(50, 1.0)),
            ("y_time", times(60, 2e-3)),
            ("y_a", times(60, 1.0)),
        ],
    );
    std::fs::create_dir(place.join("taken")).unwrap();
    write("taken/file", b"x");
    std::fs::create_dir(place.join("results")).unwrap();
    write("results/summary.json", b"{}");
}

#[test]
fn each_kind_is_provoked_and_told_to_programs() {
    let place = folder(SMALL);
    write_files(place.path());
    let mut faults = String::new();
    for (kind, arguments, code) in CASES {
        let output = iwan(place.path(), &format!("{arguments} --json --quiet"));
        let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap_or_default();
        let error = &told["error"];
        let expected = code.unwrap_or(kind.exit_code());
        let right = output.status.code() == Some(expected.into())
            && error["kind"] == kind.name()
            && error["exit_code"] == expected
            && error["message"].as_str().is_some_and(|text| !text.is_empty())
            && told["version"].is_string();
        // The results are there, and the summary says what is to be looked at.
        let warned =
            || output.status.code() == Some(1) && told["warnings"].as_array().is_some_and(|w| !w.is_empty());
        if !(right || *kind == Kind::Strict && warned()) {
            writeln!(faults, "{} by {arguments}: {}", kind.name(), shown(&output)).unwrap();
        }
    }
    assert!(faults.is_empty(), "{faults}");
    let provoked = |kind: &Kind| CASES.iter().any(|case| case.0 == *kind);
    let excused = |kind: &Kind| OTHERS.iter().any(|other| other.0 == *kind);
    for kind in Kind::ALL {
        assert!(provoked(kind) != excused(kind), "{} is provoked, or has a reason why not", kind.name());
    }
}

/// What the book says is what the program says.
#[test]
fn the_book_lists_the_catalogue() {
    let mut table = String::from("| kind | exit code | cause | what helps |\n|---|---|---|---|\n");
    for kind in Kind::ALL {
        let (name, code, cause, remedy) = (kind.name(), kind.exit_code(), kind.cause(), kind.remedy());
        writeln!(table, "| `{name}` | {code} | {cause} | {remedy} |").unwrap();
    }
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../book/src/errors.md");
    let found = std::fs::read_to_string(page).unwrap();
    assert!(found.contains(&table), "book/src/errors.md should hold:\n{table}");
    let names: std::collections::BTreeSet<&str> = Kind::ALL.iter().map(|kind| kind.name()).collect();
    assert_eq!(names.len(), Kind::ALL.len(), "two kinds have one name");
}
