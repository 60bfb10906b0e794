//! What an extraction says about itself: `summary.json` and the text on the terminal.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use iwan_ident::curves::ForceAxis;
use iwan_ident::signal::{Envelope, Spread};
use serde::Serialize;

use crate::extraction::Extraction;
use crate::records::{Recording, Units};
use crate::summary::short;

/// Rows of the table in the text.
const ROWS: usize = 7;

/// The summary.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct EnvelopeSummary {
    pub(crate) version: &'static str,
    pub(crate) record: RecordSummary,
    pub(crate) modes: Vec<ModeEnvelope>,
    pub(crate) warnings: Vec<String>,
    pub(crate) files: Vec<String>,
    /// Where they are: on standard output only, so that the folder may be moved.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) folder: Option<PathBuf>,
}

/// A record in short.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct RecordSummary {
    pub(crate) file: String,
    pub(crate) channels: Vec<String>,
    pub(crate) quantity: &'static str,
    pub(crate) unit: String,
    /// Hz.
    pub(crate) rate: f64,
    pub(crate) samples: usize,
    /// Time of the first sample, s.
    pub(crate) start: f64,
}

/// One mode.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct ModeEnvelope {
    pub(crate) name: String,
    /// Band and spectral peak, Hz.
    pub(crate) band: BandSummary,
    pub(crate) method: &'static str,
    /// Degree of the polynomial or number of intervals.
    pub(crate) order: usize,
    /// Start and end of the trusted window on the record's time axis, s.
    pub(crate) window: (f64, f64),
    /// Standard deviation of the noise in the band.
    pub(crate) noise: f64,
    pub(crate) force_axis: &'static str,
    /// Values at both ends of the window.
    pub(crate) first: Point,
    pub(crate) last: Point,
    /// A few points on the way.
    pub(crate) points: Vec<Point>,
    /// How far the methods disagree; null when there is only one.
    pub(crate) spread: Option<SpreadSummary>,
    /// The methods that were compared.
    pub(crate) methods: Vec<&'static str>,
    pub(crate) notes: Vec<String>,
}

/// Edges and peak, Hz.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct BandSummary {
    pub(crate) low: f64,
    pub(crate) high: f64,
    pub(crate) peak: f64,
    pub(crate) automatic: bool,
}

/// The mode at a time.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct Point {
    pub(crate) t: f64,
    pub(crate) amplitude: f64,
    pub(crate) frequency: f64,
    pub(crate) damping_ratio: f64,
}

/// Largest differences between the methods.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct SpreadSummary {
    /// Window that all methods trust, s.
    pub(crate) window: (f64, f64),
    /// Relative.
    pub(crate) amplitude: f64,
    /// Hz.
    pub(crate) frequency: f64,
    /// Relative.
    pub(crate) damping_ratio: f64,
    /// Relative, median over time.
    pub(crate) median_damping_ratio: f64,
}

impl EnvelopeSummary {
    /// Of the modes of a record.
    pub(crate) fn new(recording: &Recording, extractions: &[Extraction], units: &Units) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION"),
            record: RecordSummary::new(recording, units),
            modes: extractions.iter().filter_map(ModeEnvelope::new).collect(),
            warnings: recording.warnings.clone(),
            files: Vec::new(),
            folder: None,
        }
    }

    /// As JSON text.
    pub(crate) fn json(&self) -> String {
        // Numbers, texts and lists: serialisation cannot fail.
        let mut text = serde_json::to_string_pretty(self).unwrap_or_default();
        text.push('\n');
        text
    }

    /// As text.
    pub(crate) fn text(&self) -> String {
        let mut text = self.record.text();
        self.modes.iter().for_each(|m| m.write(&mut text));
        text
    }
}

impl RecordSummary {
    /// Of a recording.
    pub(crate) fn new(recording: &Recording, units: &Units) -> Self {
        let record = &recording.record;
        Self {
            file: recording.name.clone(),
            channels: record.names().to_vec(),
            quantity: units.quantity,
            unit: record.unit().into(),
            rate: record.rate(),
            samples: record.len(),
            start: record.start(),
        }
    }

    /// Name of the file without its folders.
    pub(crate) fn name(&self) -> &str {
        Path::new(&self.file).file_name().and_then(|n| n.to_str()).unwrap_or(&self.file)
    }

    /// In a line or two.
    pub(crate) fn text(&self) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" in {}", self.unit) };
        let (file, samples, rate) = (&self.file, self.samples, short(self.rate));
        let channels = self.channels.join(", ");
        format!("{file}: {}{unit}, {samples} samples at {rate} Hz, from {channels}\n", self.quantity)
    }
}

impl ModeEnvelope {
    fn new(x: &Extraction) -> Option<Self> {
        let e = x.envelope()?;
        let point = |i: usize| Point {
            t: x.start + e.t[i],
            amplitude: e.amplitude[i],
            frequency: e.frequency[i],
            damping_ratio: e.damping_ratio[i],
        };
        let last = e.t.len().checked_sub(1)?;
        let shifted = |(from, to): (f64, f64)| (x.start + from, x.start + to);
        let band = x.isolated.band;
        Some(Self {
            name: x.name.clone(),
            band: BandSummary {
                low: band.low,
                high: band.high,
                peak: band.peak,
                automatic: x.notes.iter().any(|n| n.contains("(automatic)")),
            },
            method: e.method.name(),
            order: e.order,
            window: shifted(e.trusted),
            noise: e.noise,
            force_axis: if x.curves.axis == ForceAxis::Modal { "modal" } else { "joint" },
            first: point(0),
            last: point(last),
            points: (0..ROWS).map(|k| point(k * last / (ROWS - 1))).collect(),
            spread: x.opinions.spread.map(|s| SpreadSummary {
                window: shifted(s.window),
                amplitude: s.amplitude,
                frequency: s.frequency,
                damping_ratio: s.damping_ratio,
                median_damping_ratio: s.median_damping_ratio,
            }),
            methods: x.opinions.envelopes.iter().map(|e: &Envelope| e.method.name()).collect(),
            notes: notes(x),
        })
    }

    /// Writing to a string cannot fail.
    fn write(&self, text: &mut String) {
        let (band, (from, to)) = (self.band, self.window);
        let _ = writeln!(
            text,
            "\n{}: {:.4} to {:.4} Hz at {} to {}, by {}; trusted from {:.4} to {:.4} s",
            self.name,
            self.first.frequency,
            self.last.frequency,
            short(self.first.amplitude),
            short(self.last.amplitude),
            self.method,
            from,
            to
        );
        let _ = writeln!(
            text,
            "  band {:.4} to {:.4} Hz, spectral peak at {:.4} Hz",
            band.low, band.high, band.peak
        );
        let _ = writeln!(
            text,
            "\n{:>12}{:>14}{:>16}{:>18}",
            "t, s", "amplitude", "frequency, Hz", "damping ratio, %"
        );
        for p in &self.points {
            let (t, a, f, z) = (p.t, short(p.amplitude), p.frequency, 100.0 * p.damping_ratio);
            let _ = writeln!(text, "{t:>12.4}{a:>14}{f:>16.4}{z:>18.4}");
        }
        text.push('\n');
        for note in &self.notes {
            let _ = writeln!(text, "  {note}");
        }
    }
}

/// What was done, what a method refused and how far the methods agree.
fn notes(x: &Extraction) -> Vec<String> {
    let refused =
        x.opinions.refused.iter().map(|r| format!("{} could not be used: {}", r.method.name(), r.error));
    let words = x.opinions.spread.as_ref().map(agreement);
    x.notes.iter().cloned().chain(refused).chain(words).collect()
}

/// How far the methods disagree, in words.
pub(crate) fn agreement(spread: &Spread) -> String {
    let verdict = match spread.median_damping_ratio {
        d if d < 0.01 => "the methods agree well",
        d if d < 0.05 => "the methods agree fairly",
        _ => "the methods disagree: trust the damping to that extent only",
    };
    format!(
        "{verdict}: they differ by {:.2} % in damping at half of the times and by {:.2} % at most, by {:.4} Hz in \
         frequency and {:.2} % in amplitude at most",
        100.0 * spread.median_damping_ratio,
        100.0 * spread.damping_ratio,
        spread.frequency,
        100.0 * spread.amplitude
    )
}
