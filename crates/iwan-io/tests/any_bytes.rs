//! No bytes make a reader panic, and what it accepts is a valid record.
#![allow(clippy::unwrap_used)]

use crate::common;
use iwan_io::{Format, ReadOptions, parse_table, read_bytes};
use proptest::prelude::*;
use std::path::Path;

const FORMATS: [Format; 7] =
    [Format::Text, Format::Npy, Format::Npz, Format::Uff, Format::Mat, Format::Lvm, Format::Wav];

fn seeds() -> Vec<(Format, Vec<u8>)> {
    let n = 24;
    let two = [common::uff_ascii(n, "a"), common::uff_binary(&common::wave(n), true, false, "b")].concat();
    vec![
        (Format::Text, common::csv(n)),
        (Format::Text, b"# a comment\nt [ms];acc\ns;m/s^2\n0,0;1,5\n1,0;2,5\n2,0;-1e3\n".to_vec()),
        (Format::Text, b" 0.0  1.0 2\r\n 0.1  1.5 3\r\n 0.2 2.0 4\r\n".to_vec()),
        (Format::Npy, common::npy_table(n)),
        (Format::Npz, common::npz(n)),
        (Format::Uff, two),
        (Format::Uff, common::uff_binary(&common::wave(n), false, true, "c")),
        (Format::Mat, common::mat(n, false, false)),
        (Format::Mat, common::mat(n, true, true)),
        (Format::Mat, common::instruments::mat_cells(n)),
        (Format::Mat, common::instruments::mat_7_3(n)),
        (Format::Lvm, common::instruments::lvm(n)),
        (Format::Wav, common::instruments::wav_wave(n)),
    ]
}

fn options(format: Option<Format>, variant: u8) -> ReadOptions {
    ReadOptions {
        format,
        rate: (variant & 1 != 0).then_some(128.0),
        resample: variant & 2 != 0,
        time: (variant & 4 != 0).then(|| "t".into()),
        channels: if variant & 8 != 0 { vec!["acc".into(), "d.s.acc".into()] } else { Vec::new() },
        ..Default::default()
    }
}

fn check(format: Option<Format>, variant: u8, bytes: &[u8]) {
    let _ = parse_table(Path::new("a"), bytes);
    match read_bytes(Path::new("a"), bytes, &options(format, variant)) {
        Ok(record) => {
            assert!(record.dt() > 0.0 && record.dt().is_finite() && record.len() >= 2);
            let sound = |c: &Vec<f64>| c.len() == record.len() && c.iter().all(|v| v.is_finite());
            assert!(record.samples().iter().all(sound));
        }
        Err(error) => {
            let text = error.to_string();
            assert!(text.starts_with('a') && text.len() < 4000, "{text}");
        }
    }
}

#[test]
fn the_seeds_are_valid() {
    for (format, bytes) in seeds() {
        read_bytes(Path::new("a"), &bytes, &options(Some(format), 0)).unwrap();
    }
}

#[test]
fn every_truncation_is_survived() {
    for (format, bytes) in seeds() {
        for end in 0..bytes.len() {
            check(Some(format), 0, &bytes[..end]);
        }
    }
}

#[test]
fn every_byte_set_to_an_extreme_is_survived() {
    for (format, bytes) in seeds() {
        for at in 0..bytes.len() {
            for value in [0, 0x7f, 0x80, 0xff, b'9', b'-'] {
                let mut bytes = bytes.clone();
                bytes[at] = value;
                check(Some(format), 0, &bytes);
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn mutations_are_survived(
        seed in 0..13_usize,
        variant in 0..16_u8,
        edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..4_u8), 1..12),
    ) {
        let (format, mut bytes) = seeds().swap_remove(seed);
        for (at, value, kind) in edits {
            let at = at.index(bytes.len().max(1)).min(bytes.len().saturating_sub(1));
            match kind {
                _ if bytes.is_empty() => {}
                0 => bytes[at] = value,
                1 => bytes.insert(at, value),
                2 => { bytes.remove(at); }
                _ => bytes[at] ^= 1 << (value % 8),
            }
        }
        check(Some(format), variant, &bytes);
        check(None, variant, &bytes);
    }

    #[test]
    fn noise_is_survived(
        format in 0..7_usize,
        variant in 0..16_u8,
        bytes in prop::collection::vec(any::<u8>(), 0..600),
    ) {
        check(Some(FORMATS[format]), variant, &bytes);
        check(None, variant, &bytes);
    }
}
