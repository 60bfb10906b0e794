//! The report of `iwan frf`.

use maud::{Markup, html};

use super::figures::figures;
use super::responses::Response;
use super::summary::{FrfSummary, ModePeaks};
use crate::failure::VERSION;
use crate::page::html::{grid, page, warnings};
use crate::page::numbers::{long, short};

/// The page.
pub(super) fn render(responses: &[Response], summary: &FrfSummary) -> String {
    let place = summary
        .at
        .as_ref()
        .map_or_else(|| "the displacement".into(), |at| format!("the displacement at {at}"));
    let harmonics = if summary.harmonics == 1 {
        "its fundamental".into()
    } else {
        format!("harmonics up to {}", summary.harmonics)
    };
    let body = html! {
        h1 { (summary.scenario) }
        p.about {
            "Steady forced responses by harmonic balance: " (place) " with " (harmonics) ", the " (summary.held.replace('_', " "))
            " held. No sliders, no samples, no start values. Written by iwan " (VERSION) "."
        }
        (warnings(&summary.warnings))
        nav { @for (n, m) in summary.modes.iter().enumerate() { a href=(format!("#mode-{n}")) { (m.name) } } }
        @for (n, (response, peaks)) in responses.iter().zip(&summary.modes).enumerate() {
            h2 id=(format!("mode-{n}")) { (peaks.name) }
            @if let Some(frequency) = peaks.frequency { p { (long(frequency)) " Hz at small amplitude." } }
            (table(summary.held, peaks))
            (grid(&figures(response)))
        }
    };
    page(&format!("{} \u{2013} iwan frf", summary.scenario), &body)
}

fn table(held: &str, mode: &ModePeaks) -> Markup {
    html! {
        div.wide { table {
            thead { tr {
                th { (held.replace('_', " ")) } th { "resonance, Hz" } th { "amplitude" } th { "phase, deg" } th { "excitation" }
                th { "turns back at, Hz" } th { "superharmonic resonances" }
            } }
            tbody { @for level in &mode.levels { tr {
                th { (short(level.level)) }
                @if let Some(peak) = level.peak {
                    td { (long(peak.frequency)) }
                    td { (short(peak.amplitude)) }
                    td { (format!("{:.2}", peak.phase.to_degrees())) }
                    td { (short(peak.excitation)) }
                } @else { td { "\u{2013}" } td { "\u{2013}" } td { "\u{2013}" } td { "\u{2013}" } }
                td { (turns(level)) }
                td { (superharmonics(level)) }
            } } }
        } }
    }
}

fn turns(level: &super::summary::LevelPeak) -> String {
    if level.jumps.is_empty() {
        return "\u{2013}".into();
    }
    level.jumps.iter().map(|jump| long(jump.frequency)).collect::<Vec<_>>().join(", ")
}

/// Superharmonic resonances of a level, one below the other: a structure may have several.
fn superharmonics(level: &super::summary::LevelPeak) -> Markup {
    let words = |s: &super::summary::Overtone| format!("harmonic {} at {} Hz", s.harmonic, long(s.frequency));
    html! {
        @if level.superharmonics.is_empty() { "\u{2013}" }
        @for (n, resonance) in level.superharmonics.iter().enumerate() {
            @if n > 0 { br; }
            (words(resonance))
        }
    }
}
