//! `reproduce.json`, and the text on the terminal.

use std::fmt::Write;

use iwan_study::summary::JointParameters;
use serde::Serialize;

use super::plate::Plate;
use crate::page::numbers::short;
use crate::session::Summary;

/// Every number of the report, and a list of the figures with their data files.
#[derive(Debug, Clone, Serialize)]
pub(super) struct ReproduceSummary {
    /// The results of the study.
    #[serde(flatten)]
    pub(super) found: iwan_study::Summary,
    /// The figures, whose data are in figures.json.
    figures: Vec<FigureEntry>,
    /// Wall-clock time, s.
    #[serde(skip)]
    pub(super) seconds: Option<f64>,
}

/// A figure: its identifier, its title and its curves.
#[derive(Debug, Clone, Serialize)]
struct FigureEntry {
    id: String,
    title: String,
    points: Vec<LayerEntry>,
}

/// A curve of a figure; serialised as a pair.
#[derive(Debug, Clone, Serialize)]
#[serde(into = "(String, usize)")]
struct LayerEntry {
    name: String,
    points: usize,
}

impl From<LayerEntry> for (String, usize) {
    fn from(LayerEntry { name, points }: LayerEntry) -> Self {
        (name, points)
    }
}

impl FigureEntry {
    fn new(plate: &Plate) -> Self {
        let layers = plate.figure.layers.iter();
        let entry =
            layers.map(|l| LayerEntry { name: l.name.clone().unwrap_or_default(), points: l.points.len() });
        Self { id: plate.id.clone(), title: plate.figure.title.clone(), points: entry.collect() }
    }
}

impl ReproduceSummary {
    /// Makes the summary of the results and figures; the time is filled in once the files are made.
    pub(super) fn new(found: iwan_study::Summary, plates: &[Plate]) -> Self {
        Self { found, figures: plates.iter().map(FigureEntry::new).collect(), seconds: None }
    }
}

impl Summary for ReproduceSummary {
    fn seconds(&self) -> Option<f64> {
        self.seconds
    }

    /// The text on the terminal: Table 2 and the findings.
    fn text(&self) -> String {
        let mut text = format!(
            "{:<3}{:<11}{:<12}{:>12}{:>11}{:>9}{:>9}\n",
            "", "mode", "", "K_T, 1/s^2", "F_S", "chi", "beta"
        );
        let mut line = |head: [&str; 3], p: Option<JointParameters>| {
            let cells = p.map_or_else(
                || ["linear".into(), "-".into(), "-".into(), "-".into()],
                |p| [p.k_t, p.f_s, p.chi, p.beta].map(short),
            );
            let [a, b, c] = head;
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "{a:<3}{b:<11}{c:<12}{:>12}{:>11}{:>9}{:>9}",
                cells[0], cells[1], cells[2], cells[3]
            );
        };
        for row in &self.found.table_2 {
            line([row.configuration, &row.mode, "identified"], row.identified);
            if row.configuration == "B" {
                line(["", &row.mode, "printed"], Some(row.printed));
            }
        }
        for finding in &self.found.findings {
            let _ = writeln!(text, "\n{}: {}\n  {}", finding.kind.word(), finding.title, finding.text);
        }
        text
    }
}
