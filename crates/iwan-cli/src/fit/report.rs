//! The report of `iwan fit`.

use maud::{Markup, html};

use super::figures::Fitted;
use super::intervals;
use super::laws::{percent, ranked};
use super::summary::{FitSummary, ModeFit};
use crate::envelope::{self, Extracted};
use crate::failure::VERSION;
use crate::identified::Identified;
use crate::page::html::{grid, page};
use crate::records::Units;

/// The contents of the report.
#[derive(Debug)]
pub(crate) struct Reported<'a> {
    pub(crate) identified: &'a [Identified],
    pub(crate) summary: &'a FitSummary,
    pub(crate) units: &'a Units,
    /// The fitted model as a scenario, TOML text.
    pub(crate) toml: &'a str,
}

/// The page.
pub(crate) fn render(reported: &Reported<'_>) -> String {
    let summary = reported.summary;
    let body = html! {
        h1 { (summary.title()) }
        @for record in &summary.records { p.about { (record.text()) } }
        (envelope::units(reported.units))
        p.about {
            "Modal quantities: the displacement q is the record's motion times the root of the modal mass (1 unless given), "
            "K_T is in 1/s\u{b2}. Written by iwan " (VERSION) "."
        }
        // Models that do not match are told with each mode.
        @for warning in summary.noticed() { div.verdict.look { (warning) } }
        nav {
            @for (n, mode) in summary.modes.iter().enumerate() { a href=(format!("#mode-{n}")) { (mode.joint.name) } }
            a href="#scenario" { "Scenario" }
        }
        @for (n, i) in reported.identified.iter().enumerate() {
            @if let Some(fit) = summary.modes.get(n) { (mode(n, i, fit, reported.units)) }
        }
        (scenario(reported.toml))
    };
    page(&format!("{} \u{2013} iwan fit", summary.title()), &body)
}

fn mode(n: usize, i: &Identified, fit: &ModeFit, units: &Units) -> Markup {
    let fitted = Fitted { i, units };
    let compared: Vec<_> = (0..i.comparisons.len()).flat_map(|r| fitted.comparison(r)).collect();
    let mut curves = fitted.curves();
    curves.extend(fitted.density());
    html! {
        h2 id=(format!("mode-{n}")) { (fit.joint.name) }
        (verdict(fit))
        (table(fit))
        (intervals::draw(&fit.joint))
        h2 { "Curves and fit" }
        (grid(&curves))
        (laws(fit))
        h2 { "Record and model" }
        (grid(&compared))
        h2 { "More about this fit" }
        details {
            summary { "What the records tell, in words" }
            ul.notes { @for words in fit.in_words.iter().skip(1) { li { (words) } } }
        }
        details {
            summary { "What was found on the way" }
            (notes(fit))
        }
        details {
            summary { "Profile likelihood of each parameter" }
            p {
                "A parameter is held at a value and all others follow; the deviance says by how much the records then contradict. "
                "An interval ends where it crosses the 95 % line."
            }
            (grid(&fitted.profiles()))
        }
        @for (n, x) in i.extractions.iter().enumerate() {
            @let extracted = Extracted { x, units };
            details {
                summary { "How the mode was taken out of the record" @if i.extractions.len() > 1 { " " (n + 1) } }
                (grid(&std::iter::once(extracted.record()).chain(extracted.spectra()).chain(extracted.methods()).collect::<Vec<_>>()))
            }
        }
    }
}

/// The verdict: the grade, the figures that it rests on, and the recommended law.
fn verdict(fit: &ModeFit) -> Markup {
    html! {
        div class=(if fit.joint.adequate { "verdict" } else { "verdict look" }) {
            p { strong {
                @if fit.linear.is_enough && fit.joint.adequate { "A linear mode is enough: the joint is not needed to tell these records." }
                @else { (fit.joint.sentence("these records")) }
            } }
            @if let Some(misfit) = fit.in_words.first() { p { (misfit) } }
            p { (fit.law_in_words) "." }
        }
    }
}

fn table(fit: &ModeFit) -> Markup {
    let share = |residual: f64| format!("{:.3} %", 100.0 * residual);
    fit.joint.table(&[
        ("residual / record", share(fit.relative_residual)),
        ("the same, linear mode", share(fit.linear.relative_residual)),
    ])
}

/// The table of all laws, best first, and the recommended law.
fn laws(fit: &ModeFit) -> Markup {
    html! {
        h2 { "Which law" }
        @if !fit.laws.is_empty() {
            div.wide {
                table {
                    thead { tr {
                        th { "law" } th { "criterion" } th { "dissipation missed" } th { "frequency missed, Hz" } th { "held out" } th { "grade" } th { "parameters" }
                    } }
                    tbody {
                        @for law in ranked(&fit.laws) {
                            tr {
                                th { (law.name) }
                                td { (format!("{:.1}", law.criterion)) }
                                td { (format!("{:.2} %", 100.0 * law.dissipation_misfit)) }
                                td { (format!("{:.5}", law.frequency_misfit)) }
                                td {
                                    @match (law.held_out_dissipation, law.held_out_frequency) {
                                        (Some(d), Some(f)) => { (percent(d)) " %, " (format!("{f:.4} Hz")) }
                                        _ => { "\u{2013}" }
                                    }
                                }
                                td { (law.grade) }
                                td.words { (law.values()) }
                            }
                        }
                    }
                }
            }
            p.about {
                "Criterion: twice the logarithm of the evidence that the best law has over this one; up to 2 is no difference. Misfits: against "
                "smooth curves of the records, root mean square; those of the Iwan joint by its own ring-down, as in the verdict above. Held out: what the law "
                "misses of thirds of the amplitudes, each left out of the fit in turn, so that the lowest and the highest are extrapolated."
            }
        }
    }
}

fn notes(fit: &ModeFit) -> Markup {
    html! { ul.notes { @for note in &fit.notes { li { (note) } } } }
}

fn scenario(toml: &str) -> Markup {
    html! {
        h2 id="scenario" { "Scenario" }
        p {
            "The fitted model, as in " code { "scenario.toml" } " beside this page, released where the loudest record begins: "
            code { "iwan simulate scenario.toml" }
        }
        pre { (toml) }
    }
}
