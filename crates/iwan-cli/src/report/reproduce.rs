//! The report of `iwan reproduce`: the paper's tables and figures beside ours, and what came of it.

mod blows;
mod lab;
mod schematics;
mod tables;

use maud::{Markup, html};
use serde_json::json;

use crate::commands::reproduce::{FigureEntry, Finding, Kind, Reproduction, Summary};
use crate::page::figure::{Axis, Figure, Mark};
use crate::page::html::{grid, page};
use crate::page::numbers::short;
use crate::page::scale::Spread;

/// A figure with its place in the report.
#[derive(Debug)]
pub(crate) struct Plate {
    /// Such as `figure-7-a-mode-1-frequency`.
    pub(crate) id: String,
    pub(crate) section: Section,
    pub(crate) figure: Figure,
}

/// Sections of the report that hold figures; A and B stand for the configurations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Section {
    Schematics,
    Figure7(char),
    Figure8(char),
    Figures9To11(char),
    Figures14And15,
    Figures16And17,
}

impl Plate {
    /// What `reproduce.json` says about it.
    pub(crate) fn entry(&self) -> FigureEntry {
        let points = self.figure.layers.iter().map(|l| (l.name.clone().unwrap_or_default(), l.points.len()));
        FigureEntry { id: self.id.clone(), title: self.figure.title.clone(), points: points.collect() }
    }
}

/// All figures.
pub(crate) fn plates(of: &Reproduction) -> Vec<Plate> {
    let mut plates = schematics::plates();
    plates.extend(of.sides.iter().zip(&of.studies).flat_map(|(side, studies)| blows::plates(side, studies)));
    plates.extend(lab::plates(&of.lab));
    plates
}

/// `figures.json`: what is drawn, as numbers.
pub(crate) fn data(plates: &[Plate]) -> String {
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

/// The page.
pub(crate) fn render(of: &Reproduction, summary: &Summary, plates: &[Plate]) -> String {
    let figures = |section: Section| {
        let chosen: Vec<Figure> =
            plates.iter().filter(|p| p.section == section).map(|p| p.figure.clone()).collect();
        grid(&chosen)
    };
    let body = html! {
        h1 { "The paper's tables and figures beside ours" }
        p.about {
            "Deaner, Allen, Starr, Segalman, " em { "Investigation of Modal Iwan Models for Structures with Bolted Joints" }
            ". Everything here is computed on the spot; every number stands in reproduce.json, every curve in figures.json. \
             Written by iwan " (summary.version) "."
        }
        p.about {
            "Truth and modal models in lbf, in, s; the laboratory in SI. Modal quantities are mass-normalised. Printed values that are not \
             to hand are left empty."
        }
        nav {
            a href="#findings" { "Findings" } a href="#schematics" { "Figs. 2 and 4, Table 1" } a href="#modes" { "Modes" }
            a href="#table-2" { "Table 2" }
            @for c in ['A', 'B'] { a href=(format!("#blows-{c}")) { "Figs. 7\u{2013}11, " (c) } }
            a href="#lab" { "Laboratory: Figs. 14\u{2013}17, Tables 3 and 4" }
        }
        h2 id="findings" { "Findings" }
        (findings(&summary.findings))
        h2 id="schematics" { "Figs. 2 and 4, Table 1: the joint" }
        (tables::table_1(summary))
        (figures(Section::Schematics))
        h2 id="modes" { "Truth model: modes and blows" }
        (tables::modes(summary))
        h2 id="table-2" { "Table 2: modal joints" }
        (tables::table_2(summary))
        @for c in ['A', 'B'] {
            h2 id=(format!("blows-{c}")) { "Configuration " (c) ": Fig. 7, frequency and dissipation against force" }
            (figures(Section::Figure7(c)))
            h2 { "Configuration " (c) ": Figs. 8a and 8b, modal model against truth at 10 and 1000 lbf" }
            (tables::figure_8(summary, c))
            (figures(Section::Figure8(c)))
            h2 { "Configuration " (c) ": Figs. 9 to 11, all levels" }
            (figures(Section::Figures9To11(c)))
        }
        h2 id="lab" { "Laboratory: Figs. 14 and 15, from sensors to a modal record" }
        (tables::lab(&summary.lab))
        (figures(Section::Figures14And15))
        h2 { "Figs. 16 and 17, Tables 3 and 4: dissipation and the viscous term" }
        (tables::tables_3_and_4(summary, &of.lab))
        (figures(Section::Figures16And17))
    };
    page("Reproduction \u{2013} iwan reproduce", &body)
}

fn findings(findings: &[Finding]) -> Markup {
    html! {
        @for finding in findings {
            div class=(if finding.kind == Kind::Reproduced { "verdict" } else { "verdict look" }) {
                strong { (finding.kind.word()) ": " (finding.title) }
                p { (finding.text) }
                details {
                    summary { "numbers" }
                    div.wide { table { tbody { @for number in &finding.numbers { tr {
                        th { (number.name) }
                        td { (number.value.map_or_else(|| "none".into(), short)) }
                    } } } } }
                }
            }
        }
    }
}
