//! `iwan envelope --peaks`: the peaks of the spectrum of the record, listed before any mode is extracted.

use std::fmt::Write;

use iwan_ident::signal::{SpectralPeak, spectral_peaks};
use maud::html;
use serde::Serialize;

use super::args::EnvelopeArgs;
use super::picture::picture;
use super::summary::RecordSummary;
use crate::failure::{Failure, VERSION};
use crate::page::html::page;
use crate::page::numbers::{long, short};
use crate::records::{Recording, Units};
use crate::session::{PAGE, SUMMARY, Session, Summary, Warnings};

/// The peaks of a record.
#[derive(Debug, Clone, Serialize)]
struct PeakSummary {
    record: RecordSummary,
    /// The peaks in ascending frequency.
    peaks: Vec<Peak>,
    warnings: Warnings,
}

/// One peak.
#[derive(Debug, Clone, Copy, Serialize)]
struct Peak {
    /// Frequency of the peak, Hz.
    frequency: f64,
    /// Height of the peak over the height of the highest peak.
    height: f64,
    /// Width at half its power, Hz; null where a neighbour hides it.
    width: Option<f64>,
    /// Damping ratio of a linear mode whose peak had this width; null where the record is too short to resolve it.
    damping_ratio: Option<f64>,
    /// Height of the peak over the higher of the two minima of the spectrum beside it.
    prominence: f64,
}

impl From<SpectralPeak> for Peak {
    fn from(p: SpectralPeak) -> Self {
        let SpectralPeak { frequency, height, width, damping_ratio, prominence } = p;
        Self { frequency, height, width, damping_ratio, prominence }
    }
}

impl Peak {
    /// The values of the peak as cells of a table.
    fn cells(&self) -> [String; 5] {
        let or_dash = |text: Option<String>| text.unwrap_or_else(|| "-".into());
        [
            long(self.frequency),
            short(self.height),
            or_dash(self.width.map(short)),
            or_dash(self.damping_ratio.map(|z| format!("{:.4}", 100.0 * z))),
            short(self.prominence),
        ]
    }
}

/// Peaks in the text on the terminal, the highest ones: a screen holds no more, and the files hold all.
const SHOWN: usize = 20;
/// Headings of the table.
const HEADS: [&str; 5] = ["frequency, Hz", "height", "width, Hz", "damping ratio, %", "prominence"];
/// Explanation of the columns below the table.
const MEANING: &str = "Height over that of the highest peak; width at half the power; the damping ratio of a linear mode with a peak as wide, \
    which a frequency that changes with amplitude makes too large; height over the valleys beside it.";

impl Summary for PeakSummary {
    fn text(&self) -> String {
        let mut text = self.record.text();
        let line = |text: &mut String, cells: [&str; 5]| {
            let [f, h, w, z, p] = cells;
            let _ = writeln!(text, "{f:>15}{h:>12}{w:>12}{z:>20}{p:>14}");
        };
        text.push('\n');
        line(&mut text, HEADS);
        let mut heights: Vec<f64> = self.peaks.iter().map(|p| p.height).collect();
        heights.sort_by(|a, b| b.total_cmp(a));
        let least = heights.get(SHOWN - 1).copied().unwrap_or(0.0);
        for peak in self.peaks.iter().filter(|p| p.height >= least) {
            let cells = peak.cells();
            line(&mut text, [&cells[0], &cells[1], &cells[2], &cells[3], &cells[4]]);
        }
        if let Some(more) = self.peaks.len().checked_sub(SHOWN).filter(|more| *more > 0) {
            let _ = writeln!(text, "and {more} lower ones in the files");
        }
        if self.peaks.is_empty() {
            text.push_str("no peak stands out of the noise\n");
        } else {
            text.push_str("\nname one with --mode HZ\n");
        }
        text
    }
}

/// Runs the command with `--peaks`.
pub(super) fn run(args: &EnvelopeArgs, recording: &Recording) -> Result<(), Failure> {
    let table = args.format.file("peaks");
    let mut session = Session::open(args.place(), &args.common, [table.as_str(), SUMMARY, PAGE])?;
    Recording::announce(std::slice::from_ref(recording), &mut session);
    let record = &recording.record;
    let channels: Vec<&[f64]> = record.samples().iter().map(Vec::as_slice).collect();
    let found = spectral_peaks(&channels, record.dt()).map_err(|e| Failure::said(&recording.name, &e))?;
    let units = Units::new(record.unit(), recording.quantity, false);
    let peaks: Vec<Peak> = found.into_iter().map(Peak::from).collect();
    let summary = PeakSummary {
        record: RecordSummary::new(recording, &units),
        peaks,
        warnings: recording.warnings.iter().cloned().collect(),
    };
    session.columns(&table, &columns(&summary.peaks), args.format)?;
    session.summary(SUMMARY, &summary)?;
    session.page(&render(recording, &summary))?;
    session.finish(&summary)
}

/// The columns of the table; NaN stands where a peak has no value.
fn columns(peaks: &[Peak]) -> Vec<(&'static str, Vec<f64>)> {
    let column = |of: fn(&Peak) -> f64| peaks.iter().map(of).collect::<Vec<f64>>();
    vec![
        ("frequency", column(|p| p.frequency)),
        ("height", column(|p| p.height)),
        ("width", column(|p| p.width.unwrap_or(f64::NAN))),
        ("damping_ratio", column(|p| p.damping_ratio.unwrap_or(f64::NAN))),
        ("prominence", column(|p| p.prominence)),
    ]
}

fn render(recording: &Recording, summary: &PeakSummary) -> String {
    let record = &recording.record;
    let pictures = record.samples().iter().zip(record.names()).filter_map(|(samples, name)| {
        let mut picture = picture(samples, record.dt(), record.start(), None)?;
        picture.title = format!("{}: {name}", picture.title);
        Some(picture)
    });
    let body = html! {
        h1 { "Spectral peaks of " (summary.record.name()) }
        p.about { (summary.record.text().trim_end()) ". Written by iwan " (VERSION) "." }
        @for warning in summary.warnings.iter() { div.verdict.look { (warning) } }
        div.wide {
            table {
                thead { tr { @for head in HEADS { th { (head) } } } }
                tbody { @for peak in &summary.peaks { tr { @for cell in peak.cells() { td { (cell) } } } } }
            }
        }
        p.caption { (MEANING) }
        div.figures { @for picture in pictures { (picture.draw()) } }
    };
    page(&format!("{} \u{2013} spectral peaks", summary.record.name()), &body)
}
