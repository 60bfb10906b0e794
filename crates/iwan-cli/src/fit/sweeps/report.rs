//! The report of a shaker's test.

use maud::html;

use super::summary::SweepSummary;
use crate::failure::VERSION;
use crate::fit::intervals;
use crate::page::figure::Figure;
use crate::page::html::{grid, page, warnings};

/// The page; `responses` are the figures of each measurement.
pub(super) fn render(
    summary: &SweepSummary,
    backbones: &[Figure],
    responses: &[Vec<Figure>],
    toml: &str,
) -> String {
    let body = html! {
        h1 { (summary.title) }
        p.about { "Modal quantities, as in every fit. Written by iwan " (VERSION) "." }
        (warnings(&summary.warnings))
        @for mode in &summary.modes {
            div class=(if mode.joint.adequate { "verdict" } else { "verdict look" }) {
                p { strong { (mode.joint.sentence("these measurements")) } }
                ul { @for words in &mode.in_words { li { (words) } } }
            }
            (mode.joint.table(&[]))
            (intervals::draw(&mode.joint))
        }
        h2 { "Frequency and damping against amplitude" }
        (grid(backbones))
        @for (measurement, figures) in summary.measurements.iter().zip(responses) {
            @if !figures.is_empty() {
                h2 { "Measured and predicted: " (measurement.file) }
                (grid(figures))
            }
        }
        h2 { "Scenario" }
        pre { code { (toml) } }
    };
    page(&format!("{} \u{2013} iwan fit", summary.title), &body)
}
