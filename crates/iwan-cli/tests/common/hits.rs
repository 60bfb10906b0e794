//! Hits of a bench of four modes at eight points as files, and `iwan modal` on them.
#![allow(dead_code, clippy::unwrap_used, reason = "each test file uses its part; tests may panic")]

use std::fmt::Write;
use std::path::Path;

use iwan_modal::measure::{Channel, Hit};
use serde_json::Value;

use crate::common::{iwan, shown};
use crate::support::{Bench, TrueMode, ten_modes};

pub(crate) fn run(place: &Path, arguments: &str) -> Value {
    let output = iwan(place, &format!("modal {arguments} --json"));
    assert!(output.status.success(), "{}", shown(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

pub(crate) fn refused(place: &Path, arguments: &str, words: &[&str]) {
    let output = iwan(place, &format!("modal {arguments}"));
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments}: {text}");
    for word in words {
        assert!(text.contains(word), "{arguments}: no \"{word}\" in {text}");
    }
}

/// Four modes at eight points.
pub(crate) fn bench() -> Bench {
    let modes: Vec<TrueMode> = ten_modes().into_iter().take(4).collect();
    Bench { stations: 4, rate: 4096.0, samples: 8192, calibration: 0.0, ..Bench::new(modes) }
}

/// A hit as a CSV file: t, force, a1 to a8.
pub(crate) fn write(place: &Path, name: &str, hit: &Hit) {
    let channels: Vec<&Channel> = std::iter::once(&hit.force).chain(&hit.responses).collect();
    let mut text = "t".to_string();
    for channel in &channels {
        let unit = if channel.name == "hammer" { "N" } else { "m/s^2" };
        write!(text, ",{} [{unit}]", channel.name).unwrap();
    }
    for n in 0..hit.samples() {
        write!(text, "\n{}", n as f64 * hit.dt).unwrap();
        for channel in &channels {
            write!(text, ",{}", channel.samples[n]).unwrap();
        }
    }
    std::fs::write(place.join(name), text).unwrap();
}

pub(crate) fn hits(place: &Path, count: usize) {
    for (n, hit) in bench().hits(100.0, count, 1).iter().enumerate() {
        write(place, &format!("h{}.csv", n + 1), hit);
    }
}
