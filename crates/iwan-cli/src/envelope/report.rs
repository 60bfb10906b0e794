//! The report of `iwan envelope`.

use maud::{Markup, html};

use super::figures::Extracted;
use super::summary::{EnvelopeSummary, FAIRLY, Point, agreement};
use crate::failure::VERSION;
use crate::page::html::{grid, page};
use crate::page::numbers::short;
use crate::records::{Extraction, Units};

/// The page.
pub(super) fn render(extractions: &[Extraction], summary: &EnvelopeSummary, units: &Units) -> String {
    let record = &summary.record;
    let body = html! {
        h1 { "Envelope of " (record.name()) }
        p.about { (record.text().trim_end()) ". Written by iwan " (VERSION) "." }
        (self::units(units))
        @for warning in summary.warnings.iter() { div.verdict.look { (warning) } }
        nav { @for (n, x) in extractions.iter().enumerate() { a href=(format!("#mode-{n}")) { (x.name) } } }
        @for (n, x) in extractions.iter().enumerate() { (mode(n, x, summary, units)) }
    };
    page(&format!("{} \u{2013} iwan envelope", record.name()), &body)
}

/// A paragraph that says in which units the values are.
pub(crate) fn units(units: &Units) -> Markup {
    html! {
        p.about {
            @if units.samples.is_empty() {
                "The file names no unit: all quantities are in the unit of the record, seconds and hertz."
            } @else {
                "Units follow from the record's, " (units.samples) "; times in s, frequencies in Hz."
            }
        }
    }
}

fn mode(n: usize, x: &Extraction, summary: &EnvelopeSummary, units: &Units) -> Markup {
    let extracted = Extracted { x, units };
    let head: Vec<_> = std::iter::once(extracted.record()).chain(extracted.spectra()).collect();
    let mut found = extracted.methods();
    found.insert(3, extracted.disagreement());
    found.push(extracted.dissipation());
    html! {
        h2 id=(format!("mode-{n}")) { (x.name) }
        (verdict(x))
        (table(summary.modes.get(n).map(|m| m.points.as_slice()).unwrap_or_default()))
        div.figures {
            @for figure in &head { (figure.draw()) }
            @if let Some(picture) = extracted.over_time() { (picture.draw()) }
        }
        h2 { "What the methods found" }
        (grid(&found))
    }
}

/// How well the methods agree, in words, and the notes on what was done.
fn verdict(x: &Extraction) -> Markup {
    let good =
        x.opinions.spread.is_some_and(|s| s.median_damping_ratio < FAIRLY) && x.opinions.refused.is_empty();
    html! {
        div class=(if good { "verdict" } else { "verdict look" }) {
            @match &x.opinions.spread {
                Some(spread) => p { strong { (sentence(&agreement(spread))) } },
                None => p { strong { "Only one method could be used: there is no second opinion." } },
            }
            ul {
                @for note in &x.notes { li { (note) } }
                @for refused in &x.opinions.refused { li { (refused.method.name()) " could not be used: " (refused.error) } }
            }
        }
    }
}

/// The words as a sentence: with a capital letter and a full stop.
fn sentence(words: &str) -> String {
    let mut letters = words.chars();
    let first = letters.next().map(|c| c.to_uppercase().to_string()).unwrap_or_default();
    format!("{first}{}.", letters.as_str())
}

fn table(points: &[Point]) -> Markup {
    html! {
        div.wide {
            table {
                thead { tr { th { "time, s" } th { "amplitude" } th { "frequency, Hz" } th { "damping ratio, %" } } }
                tbody {
                    @for p in points {
                        tr {
                            th { (format!("{:.4}", p.t)) }
                            td { (short(p.amplitude)) }
                            td { (format!("{:.4}", p.frequency)) }
                            td { (format!("{:.4}", 100.0 * p.damping_ratio)) }
                        }
                    }
                }
            }
        }
    }
}
