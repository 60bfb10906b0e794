//! The summary of an extraction: `summary.json` and the text on the terminal.

use std::fmt::Write;
use std::path::Path;

use iwan_ident::curves::ForceAxis;
use iwan_ident::signal::{Envelope, Spread};
use iwan_machine::shortened;
use serde::Serialize;

use crate::page::numbers::short;
use crate::records::{Extraction, Recording, Units};
use crate::session::{Summary, Warnings};

/// Rows of the table on the terminal: both ends of the trusted window and five times evenly spaced between them. The table file holds every sample.
const ROWS: usize = 7;

/// Up to this many channels are all named in the text; of more, the first two and the last are named.
const MOST_NAMED: usize = 8;

/// Methods whose damping ratios differ by less than this, relatively, at half of the times agree well: on measured ring-downs with little noise they
/// differ by 0.003 to 0.006.
const WELL: f64 = 0.01;

/// Methods that differ by less than this agree fairly; where they differ by more, the page asks the user to look at the record: on modes that sink
/// into noise within the trusted window the methods differ by 0.04 to 0.06. Both limits are a matter of judgement.
pub(super) const FAIRLY: f64 = 0.05;

/// The summary.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct EnvelopeSummary {
    pub(crate) record: RecordSummary,
    pub(crate) modes: Vec<ModeEnvelope>,
    /// What the reader of the record noticed; these warnings are given before anything is computed.
    pub(crate) warnings: Warnings,
}

/// Characters of a channel's name that a line of text shows.
const NAME: usize = 60;

/// A record in brief.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct RecordSummary {
    pub(crate) file: String,
    pub(crate) channels: Vec<String>,
    pub(crate) quantity: &'static str,
    pub(crate) unit: String,
    /// Sampling rate, Hz.
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
    /// Degree of the method's polynomial, or number of intervals of its spline.
    pub(crate) order: usize,
    /// Start and end of the trusted window on the record's time axis, s.
    pub(crate) window: (f64, f64),
    /// Standard deviation of the noise in the band.
    pub(crate) noise: f64,
    pub(crate) force_axis: &'static str,
    /// Values at both ends of the window.
    pub(crate) first: Point,
    pub(crate) last: Point,
    /// Seven points from the first to the last, for the table on the terminal.
    pub(crate) points: Vec<Point>,
    /// How far the methods disagree; null when there is only one.
    pub(crate) spread: Option<SpreadSummary>,
    /// The methods that were compared.
    pub(crate) methods: Vec<&'static str>,
    pub(crate) notes: Vec<String>,
}

/// Lower and upper edge of the band and the spectral peak in it, Hz.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct BandSummary {
    pub(crate) low: f64,
    pub(crate) high: f64,
    pub(crate) peak: f64,
    pub(crate) automatic: bool,
}

/// Amplitude, frequency and damping of the mode at one time.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct Point {
    pub(crate) t: f64,
    pub(crate) amplitude: f64,
    pub(crate) frequency: f64,
    pub(crate) damping_ratio: f64,
}

/// Largest differences between the methods over their common window.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct SpreadSummary {
    /// Window that all methods trust: start and end, s.
    pub(crate) window: (f64, f64),
    /// Largest relative difference of the amplitude.
    pub(crate) amplitude: f64,
    /// Largest difference of the frequency, Hz.
    pub(crate) frequency: f64,
    /// Largest relative difference of the damping ratio.
    pub(crate) damping_ratio: f64,
    /// Median over time of the relative difference of the damping ratio.
    pub(crate) median_damping_ratio: f64,
}

impl EnvelopeSummary {
    /// Makes the summary of the modes extracted from a record.
    pub(crate) fn new(recording: &Recording, extractions: &[Extraction], units: &Units) -> Self {
        Self {
            record: RecordSummary::new(recording, units),
            modes: extractions.iter().filter_map(ModeEnvelope::new).collect(),
            warnings: recording.warnings.iter().cloned().collect(),
        }
    }
}

impl Summary for EnvelopeSummary {
    fn text(&self) -> String {
        let mut text = self.record.text();
        self.modes.iter().for_each(|m| m.write(&mut text));
        text
    }
}

impl RecordSummary {
    /// Makes the brief description of a recording.
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

    /// The description of the record as one or two lines of text.
    pub(crate) fn text(&self) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" in {}", self.unit) };
        let (file, samples, rate) = (&self.file, self.samples, short(self.rate));
        let names: Vec<String> = self.channels.iter().map(|name| shortened(name, NAME)).collect();
        let channels = match names.as_slice() {
            [first, second, .., last] if self.channels.len() > MOST_NAMED => {
                format!("{} channels: {first}, {second}, …, {last}", self.channels.len())
            }
            all => all.join(", "),
        };
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

    /// Appends the text on the mode. Writing to a string cannot fail.
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

/// Notes on what was done, which methods could not be used and why, and how far the methods agree.
fn notes(x: &Extraction) -> Vec<String> {
    let refused =
        x.opinions.refused.iter().map(|r| format!("{} could not be used: {}", r.method.name(), r.error));
    let words = x.opinions.spread.as_ref().map(agreement);
    x.notes.iter().cloned().chain(refused).chain(words).collect()
}

/// How far the methods disagree, in words.
pub(crate) fn agreement(spread: &Spread) -> String {
    let verdict = match spread.median_damping_ratio {
        d if d < WELL => "the methods agree well",
        d if d < FAIRLY => "the methods agree fairly",
        _ => "the methods disagree: trust the damping to that extent only",
    };
    // Where the damping is next to nothing, a relative difference means nothing: above 100 % no figure is given.
    let percent = |x: f64| if x > 1.0 { "more than 100 %".into() } else { format!("{:.2} %", 100.0 * x) };
    format!(
        "{verdict}: they differ by {} in damping at half of the times and by {} at most, by {:.4} Hz in \
         frequency and {:.2} % in amplitude at most",
        percent(spread.median_damping_ratio),
        percent(spread.damping_ratio),
        spread.frequency,
        100.0 * spread.amplitude
    )
}
