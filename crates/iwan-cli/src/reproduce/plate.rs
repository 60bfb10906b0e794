//! A figure with its place in the report, and `figures.json`, which holds the drawn points as numbers.

use serde_json::json;

use crate::page::figure::{Axis, Figure, Mark};
use crate::page::scale::Spread;

/// A figure with its place in the report.
#[derive(Debug)]
pub(super) struct Plate {
    /// Identifier, such as `figure-7-a-mode-1-frequency`.
    pub(super) id: String,
    pub(super) section: Section,
    pub(super) figure: Figure,
}

/// Sections of the report that hold figures; A and B stand for the configurations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Section {
    Schematics,
    Figure7(char),
    Figure8(char),
    Figures9To11(char),
    Figures14And15,
    Figures16And17,
}

/// The text of `figures.json`.
pub(super) fn data(plates: &[Plate]) -> String {
    let axis = |axis: &Axis| {
        let scale = if axis.spread == Spread::Log { "log" } else { "linear" };
        json!({ "label": axis.label, "unit": axis.unit, "scale": scale })
    };
    let mark = |mark| match mark {
        Mark::Line => "line",
        Mark::Dashed => "dashed",
        Mark::Dots => "dots",
        Mark::Area => "area",
    };
    let figure = |plate: &Plate| {
        let f = &plate.figure;
        let layers: Vec<_> = f
            .layers
            .iter()
            .map(|l| json!({ "name": l.name, "mark": mark(l.mark), "points": l.points }))
            .collect();
        let (x, y) = (axis(&f.x), axis(&f.y));
        json!({ "id": plate.id, "title": f.title, "caption": f.caption, "x": x, "y": y, "layers": layers })
    };
    let figures: Vec<_> = plates.iter().map(figure).collect();
    format!("{}\n", json!(figures))
}
