//! Hostile files through every command that reads one: an answer in time and in bounds, nothing left behind, no panic.
#![allow(clippy::unwrap_used, reason = "tests may panic")]
#![cfg(unix)]

use std::fmt::Write as _;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::time::{Duration, Instant};

use assert_cmd::Command;
use iwan_core::SplitMix64;

use crate::common::{SMALL, folder, names, ring_down};

/// Longest time of a run on a busy machine.
const LONGEST: Duration = Duration::from_secs(60);
/// Addresses that a run may take, kB, as `ulimit -v` counts them.
const MEMORY: u32 = 2_000_000;

/// Every way in which a command reads a file, called F.
const COMMANDS: [&str; 17] = [
    "simulate F",
    "simulate F --stream",
    "simulate F --checkpoint kept",
    "frf F",
    "backbone F",
    "envelope F",
    "envelope F --rate 1000 --channel a",
    "envelope F --peaks",
    "fit F F",
    "fit F --coupled --mode 100 --mode 200",
    "fit --sweep F",
    "fit --backbone F",
    "modal F",
    "modal F F --hammer a",
    "modes F",
    "quasi-static F",
    "update F --curves 1=F",
];

fn lines(count: u32, line: &dyn Fn(u32) -> String) -> String {
    (0..count).map(line).collect::<Vec<_>>().concat()
}

/// Of a file of these kinds, which are none of what the commands want, and of valid ones that were damaged.
#[allow(clippy::too_many_lines, reason = "a table")]
fn files() -> Vec<(&'static str, Vec<u8>)> {
    let ring = ring_down(1000.0, 60, &[(124.0, 2e-3, 1.0)], &[&[1.0]], "a");
    let npy = |descr: &str, shape: &str, body: usize| {
        let header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}");
        let header = format!("{header:<117}\n");
        [b"\x93NUMPY\x01\x00".as_slice(), &118_u16.to_le_bytes(), header.as_bytes(), &vec![0x40; body]]
            .concat()
    };
    let mesh = "[mesh]\nkind = \"block\"\nsize = [1.0, 1.0, 1.0]\ncells = [2, 2, 2]\n\
                [[material]]\nyoung = 1.0\npoisson = 0.3\ndensity = 1.0\n";
    let mut all: Vec<(&str, Vec<u8>)> = vec![
        ("empty.csv", vec![]),
        ("empty.toml", b"\n\n".to_vec()),
        ("head.csv", b"t,a\n".to_vec()),
        ("row.csv", b"t,a\n0,1\n".to_vec()),
        ("nan.csv", ring.replace("0.0", "nan").into_bytes()),
        ("infinite.csv", ring.replace("0.05", "1e400").into_bytes()),
        ("words.csv", ring.replace("0.02", "twenty").into_bytes()),
        ("quotes.csv", ring.replace("0.03", "\"0.03").into_bytes()),
        ("constant.csv", lines(60, &|n| format!("{n},1\n")).into_bytes()),
        ("zeros.csv", lines(60, &|n| format!("{n},0\n")).into_bytes()),
        ("tiny.csv", lines(60, &|n| format!("{n}e-300,{n}e-320\n")).into_bytes()),
        ("huge.csv", lines(60, &|n| format!("{n}e300,{n}e305\n")).into_bytes()),
        ("backwards.csv", lines(60, &|n| format!("{},{n}\n", 60 - n)).into_bytes()),
        ("wide.csv", vec!["1"; 30_000].join(",").into_bytes()),
        ("long-name.csv", format!("t,{}\n0,1\n1,2\n2,1\n", "n".repeat(100_000)).into_bytes()),
        ("escapes.csv", b"t,\x1b]0;a\x07\x1b[31m\xe2\x80\xae\n0,1\n1,x\n2,1\n".to_vec()),
        ("units.csv", b"t [fortnight],a [barn/acre]\n0,1\n1,2\n2,1\n".to_vec()),
        ("one-line.csv", vec![b'7'; 2_000_000]),
        ("nul.csv", vec![0; 4096]),
        ("random.bin", (0..4096_u32).map(|n| (n.wrapping_mul(2_654_435_761) >> 13) as u8).collect()),
        ("bom.csv", [b"\xff\xfet\x00,\x00a\x00".as_slice(), &[0xd8; 33]].concat()),
        ("rows.npy", npy("<f8", "(9223372036854775807, 9223372036854775807)", 64)),
        ("minus.npy", npy("<f8", "(-5,)", 64)),
        ("deep.npy", npy("<f8", "(1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 8)", 64)),
        ("object.npy", npy("|O", "(8,)", 64)),
        ("text.npy", npy("<U4000000000", "(1,)", 64)),
        ("cut.npy", npy("<f8", "(1000,)", 17)),
        ("cut.npz", b"PK\x03\x04\x14\x00\x00\x00\x08\x00".to_vec()),
        ("central.npz", [b"PK\x05\x06".as_slice(), &[0xff; 18]].concat()),
        (
            "head.mat",
            [b"MATLAB 5.0 MAT-file".as_slice(), &[b' '; 105], &[0, 1, b'I', b'M'], &[0xff; 40]].concat(),
        ),
        (
            "hdf.mat",
            [b"MATLAB 7.3 MAT-file".as_slice(), &[b' '; 105], &[0, 2, b'I', b'M'], b"\x89HDF\r\n\x1a\n"]
                .concat(),
        ),
        (
            "size.wav",
            b"RIFF\xff\xff\xff\xffWAVEfmt \x10\x00\x00\x00\x01\x00\x00\x00\xff\xff\xff\xff".to_vec(),
        ),
        ("58.uff", b"    -1\n    58\nx\nx\nx\nx\nx\n 1 0 0 0\n 2 99999999 1 0.0 1e-3 0.0\n    -1\n".to_vec()),
        ("endless.uff", b"    -1\n    58\n".repeat(500)),
        (
            "head.lvm",
            b"LabVIEW Measurement\nSeparator\tTab\nChannels\t4000000000\n***End_of_Header***\n".to_vec(),
        ),
        ("deep.toml", "[a".repeat(20_000).into_bytes()),
        ("arrays.toml", format!("x = {}{}", "[".repeat(5000), "]".repeat(5000)).into_bytes()),
        ("keys.toml", lines(20_000, &|n| format!("k{n} = {n}\n")).into_bytes()),
        ("twice.toml", SMALL.replace("[time]", "[time]\nstep = 1\n").into_bytes()),
        ("steps.toml", SMALL.replace("duration = 0.1", "duration = 1e12").into_bytes()),
        ("overflow.toml", SMALL.replace("frequency = 300.0", "frequency = 1e308").into_bytes()),
        ("sliders.toml", SMALL.replace("sliders = 50", "sliders = 9223372036854775807").into_bytes()),
        ("minus.toml", SMALL.replace("sliders = 50", "sliders = -1").into_bytes()),
        ("path.toml", format!("{SMALL}[sweep]\nfrom = 0\nto = -1\nforce = [nan]\n").into_bytes()),
        (
            "force.toml",
            SMALL.replace("kind = \"haversine\"", "kind = \"file\"\npath = \"/dev/zero\"").into_bytes(),
        ),
        (
            "self.toml",
            SMALL.replace("kind = \"haversine\"", "kind = \"file\"\npath = \"self.toml\"").into_bytes(),
        ),
        ("cells.toml", mesh.replace("[2, 2, 2]", "[4000000000, 1, 1]").into_bytes()),
        ("nocells.toml", mesh.replace("[2, 2, 2]", "[0, 0, 0]").into_bytes()),
        ("flat.toml", mesh.replace("[1.0, 1.0, 1.0]", "[1.0, 1e-300, 1.0]").into_bytes()),
        ("dense.toml", mesh.replace("density = 1.0", "density = 1e-200").into_bytes()),
        (
            "ring.toml",
            b"[structure]\nname = \"paper-a\"\nreduced = \"ring.toml\"\n[time]\nstep=1\nduration=2\n"
                .to_vec(),
        ),
        ("loop.toml", b"[mesh]\nkind = \"file\"\npath = \"loop.toml\"\n".to_vec()),
        ("zero.toml", b"[mesh]\nkind = \"file\"\npath = \"/dev/zero\"\n".to_vec()),
        ("include.inp", b"*INCLUDE, INPUT=include.inp\n".to_vec()),
        (
            "element.inp",
            b"*NODE\n1,0,0,0\n*ELEMENT, TYPE=C3D8\n1,1,1,1,1,1,1,1,9999999999999999999\n".to_vec(),
        ),
        ("nodes.msh", b"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 18446744073709551615 1 2\n".to_vec()),
        ("card.bdf", b"BEGIN BULK\nGRID,1,,1.0,nan,1e999\nCHEXA,1,1,1,1,1,1,1,1,1,1\nENDDATA\n".to_vec()),
    ];
    let valid: [(&str, &[u8]); 4] = [
        ("ring.csv", ring.as_bytes()),
        ("in.toml", SMALL.as_bytes()),
        ("block.toml", mesh.as_bytes()),
        ("ok.npy", &npy("<f8", "(60,)", 480)),
    ];
    let mut random = SplitMix64::new(17);
    let mut below = move |n: usize| (random.next_symmetric().abs() * n as f64) as usize % n.max(1);
    for (name, bytes) in valid {
        for _ in 0..8 {
            let mut damaged = bytes[..bytes.len() - below(bytes.len() / 2)].to_vec();
            for _ in 0..=below(6) {
                let at = below(damaged.len());
                damaged[at] ^= 1 << below(8);
            }
            all.push((name, damaged));
        }
    }
    all
}

/// What is wrong with the answer to one command, if anything.
fn fault(place: &Path, arguments: &str) -> Option<String> {
    let program = assert_cmd::cargo::cargo_bin!("iwan").display().to_string();
    let line = format!("ulimit -v {MEMORY}; exec {program} {arguments} --out out");
    let begun = Instant::now();
    let output = Command::new("sh").args(["-c", &line]).current_dir(place).timeout(LONGEST).output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    let said = |what: &str| {
        Some(format!("{arguments}: {what} after {:.1} s: {errors:.600}", begun.elapsed().as_secs_f64()))
    };
    let left = names(place);
    let made = left.iter().any(|name| name == "out");
    match output.status.code() {
        None => return said(&format!("signal {:?}", output.status.signal())),
        Some(0) => {
            std::fs::remove_dir_all(place.join("out")).unwrap();
        }
        Some(1 | 2) if made => return said("results of a failure"),
        Some(1 | 2) if !errors.contains("error: ") => return said("no message"),
        // What clap refuses is no message of ours.
        Some(1 | 2)
            if !errors.contains("remedy: ") && !errors.contains("; ") && !errors.contains("--help") =>
        {
            return said("no remedy");
        }
        Some(1 | 2) => {}
        Some(code) => return said(&format!("exit code {code}")),
    }
    if errors.contains("panicked") || errors.contains('\u{1b}') || errors.contains('\u{202e}') {
        return said("a panic, or raw control characters");
    }
    let (own, other): (Vec<_>, Vec<_>) = left.into_iter().partition(|name| name.starts_with('.'));
    if !own.is_empty() || other.len() > 2 + usize::from(made) {
        return said(&format!("left {own:?} {other:?}"));
    }
    None
}

/// More than a thousand runs: what no file may do to any command.
#[test]
fn hostile_files_are_answered_by_every_command() {
    let all = files();
    let runs: Vec<(usize, &str)> =
        (0..all.len()).flat_map(|n| COMMANDS.map(|command| (n, command))).collect();
    assert!(runs.len() > 1000);
    let next = std::sync::atomic::AtomicUsize::new(0);
    let faults = std::sync::Mutex::new(String::new());
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                loop {
                    let at = next.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
                    let Some((n, command)) = runs.get(at) else { break };
                    let (name, bytes) = &all[*n];
                    let place = folder("");
                    std::fs::remove_file(place.path().join("in.toml")).unwrap();
                    std::fs::write(place.path().join(name), bytes).unwrap();
                    let arguments = command.split(' ').map(|word| if word == "F" { name } else { word });
                    let arguments = arguments.collect::<Vec<_>>().join(" ");
                    if let Some(fault) = fault(place.path(), &arguments) {
                        writeln!(faults.lock().unwrap(), "{fault}\n").unwrap();
                    }
                }
            });
        }
    });
    let faults = faults.into_inner().unwrap();
    assert!(faults.is_empty(), "{faults}");
}
