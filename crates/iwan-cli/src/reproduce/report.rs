//! The report of `iwan reproduce`: the paper's tables and figures beside ours, and the findings.

use iwan_study::Summary;
use iwan_study::findings::{Finding, FindingKind};
use iwan_study::laboratory::Laboratory;
use maud::{Markup, html};

use super::plate::{Plate, Section};
use super::tables;
use crate::failure::VERSION;
use crate::page::figure::Figure;
use crate::page::html::{grid, page};
use crate::page::numbers::short;

/// The page.
pub(super) fn render(summary: &Summary, laboratory: &Laboratory, plates: &[Plate]) -> String {
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
             Written by iwan " (VERSION) "."
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
        (tables::laboratory(&summary.lab))
        (figures(Section::Figures14And15))
        h2 { "Figs. 16 and 17, Tables 3 and 4: dissipation and the viscous term" }
        (tables::tables_3_and_4(summary, laboratory))
        (figures(Section::Figures16And17))
    };
    page("Reproduction \u{2013} iwan reproduce", &body)
}

fn findings(findings: &[Finding]) -> Markup {
    html! {
        @for finding in findings {
            div class=(if finding.kind == FindingKind::Reproduced { "verdict" } else { "verdict look" }) {
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
