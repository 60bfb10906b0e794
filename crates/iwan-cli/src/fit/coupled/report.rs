//! The report of a fit of modes that share joints.

use maud::{Markup, html};

use super::summary::{CoupledSummary, MisfitSummary, ModelSummary};
use crate::failure::VERSION;
use crate::page::figure::Figure;
use crate::page::html::{grid, page, warnings};
use crate::page::numbers::{interval, long, short};

/// The page; `fitted` and `predicted` are the figures of the fitted and the held-out records.
pub(super) fn render(summary: &CoupledSummary, [fitted, predicted]: [&[Figure]; 2], toml: &str) -> String {
    let body = html! {
        h1 { (summary.title) }
        p.about {
            "Linear modes with their joints stuck, and joints that feel all modes at once: whether modes share a joint is compared with joints of \
             their own and with none. Written by iwan " (VERSION) "."
        }
        (warnings(&summary.warnings))
        div.verdict { ul { @for words in &summary.in_words { li { (words) } } } }
        h2 { "The model to take: " (summary.chosen) }
        div.wide { table {
            thead { tr { th { "of" } th { "parameter" } th { "value" } th { "95 % interval" } } }
            tbody { @for (of, name, e) in summary.rows() { tr {
                th { (of) } td.words { (name) } td { (long(e.value)) } td { (interval(e.low, e.high)) }
            } } }
        } }
        p { "Slips are in units of the displacement of the first mode that moves a joint." }
        details {
            summary { "Combinations of unknowns, the best told first" }
            div.wide { table {
                thead { tr { th { "standard deviation" } th { "combination" } } }
                tbody { @for t in &summary.told { tr {
                    th { (t.deviation.map_or_else(|| "not told".into(), short)) } td.words { (t.combination) }
                } } }
            } }
        }
        h2 { "Models side by side" }
        p.about {
            "Misfit: root mean square of the difference over that of the record, in per cent. Criterion (Schwarz): 0 is best, and 10 more speak \
             clearly against a model. Records kept out were not fitted; of a free decay only where it begins was."
        }
        (side_by_side(&summary.models))
        h2 { "Records and models" }
        (grid(fitted))
        @if !predicted.is_empty() { h2 { "Predicted" } (grid(predicted)) }
        h2 id="scenario" { "Scenario" }
        pre { (toml) }
    };
    page(&format!("{} \u{2013} iwan fit", summary.title), &body)
}

fn side_by_side(models: &[ModelSummary]) -> Markup {
    let percent = |share: f64| format!("{:.3}", 100.0 * share);
    let rows = |of: fn(&ModelSummary) -> &Vec<MisfitSummary>, held: &str| {
        let first = models.first().map(of).into_iter().flatten().enumerate();
        html! { @for (n, row) in first { tr {
            th { (row.record) ": " (row.mode) (held) }
            @for m in models { td { (of(m).get(n).map_or_else(|| "-".into(), |x| percent(x.relative))) } }
        } } }
    };
    html! { div.wide { table {
        thead { tr { th { "record" } @for m in models { th { (m.name) } } } }
        tbody {
            (rows(|m| &m.misfits, ""))
            (rows(|m| &m.held_out, " (kept out)"))
            tr { th { "all fitted" } @for m in models { td { (percent(m.misfit)) } } }
            tr { th { "all kept out" } @for m in models { td { (m.held_out_misfit.map_or_else(|| "-".into(), percent)) } } }
            tr { th { "unknowns" } @for m in models { td { (m.unknowns) } } }
            tr { th { "criterion" } @for m in models { td { (format!("{:.0}", m.criterion)) } } }
        }
    } } }
}
