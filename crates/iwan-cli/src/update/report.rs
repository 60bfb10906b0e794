//! The report of `iwan update`.

use iwan_study::update::{ComparedBlow, TradeOff};
use maud::{Markup, html};

use super::figures::{amplitudes, figures, front};
use super::summary::{UpdateSummary, parameters};
use crate::failure::VERSION;
use crate::page::html::{grid, page, verdict};
use crate::page::numbers::{interval, long, short};

/// Error of the quasi-static curves of a reduced structure, in damping and in the shift of the frequency: where all misfits are below this, their
/// differences are rounding, and no front is shown.
const OWN_ERROR: f64 = 1e-3;

/// The page.
pub(super) fn render(summary: &UpdateSummary) -> String {
    let curves = summary.curves.as_deref().unwrap_or_default();
    let body = html! {
        h1 { (summary.structure) }
        p.about {
            "Joints of the structure from frequency and damping of its modes against amplitude, whose counterparts are curves of static loads, or from \
             blows, whose counterparts are transients of the structure. Written by iwan " (VERSION) "."
        }
        // A verdict against the model stands among the warnings already.
        @let is_told = !summary.warnings.contains(&summary.verdict.in_words);
        (verdict(&summary.warnings, &html! { @if is_told { span { (summary.verdict.in_words) "." } } }))
        h2 { "Joints" }
        (estimates(summary))
        @for curve in curves {
            h2 { (curve.mode) @if curve.held_out { " (predicted)" } }
            p { "Measured: " (curve.source) }
            @for p in summary.predictions.iter().filter(|p| curve.held_out && p.mode == curve.mode && p.source == curve.source) {
                p { (p.in_words()) "." @for why in &p.prediction.not_predicted { " " (why) "." } }
            }
            (grid(&figures(curve)))
        }
        (blows(summary.blows.as_deref().unwrap_or_default()))
        h2 { "What is told" }
        (told(summary))
        (compromises(summary.front.as_deref().unwrap_or_default()))
    };
    page(&format!("{} \u{2013} iwan update", summary.structure), &body)
}

/// The section on blows, measured and computed.
fn blows(all: &[ComparedBlow]) -> Markup {
    let percent = |share: f64| format!("{:.3}", 100.0 * share);
    html! { @if !all.is_empty() {
        h2 { "Blows" }
        p { "Missed: root mean square of the difference of complex amplitudes about the frequency of a mode over that of the record, in per cent." }
        div.wide { table {
            thead { tr { th { "record" } th { "point" } th { "mode" } th { "missed before" } th { "missed" } } }
            tbody { @for blow in all { tr {
                th { (blow.source) @if blow.held_out { " (predicted)" } } td.words { (blow.point) } td.words { (blow.mode) }
                td { (blow.before.map_or_else(|| "-".into(), percent)) } td { (percent(blow.after)) }
            } } }
        } }
        (grid(&all.iter().map(amplitudes).collect::<Vec<_>>()))
    } }
}

/// The front of compromises, where the misfits exceed [`OWN_ERROR`].
fn compromises(all: &[TradeOff]) -> Markup {
    html! {
        @if all.iter().any(|t| t.frequency.max(t.damping) > OWN_ERROR) {
            div.alone { (grid(&[front(all)])) }
        } @else {
            p { "Frequency and damping want the same joints: no compromise misses more than the curves are off by themselves." }
        }
    }
}

fn estimates(summary: &UpdateSummary) -> Markup {
    html! {
        div.wide { table {
            thead { tr { th { "of" } th { "parameter" } th { "value" } th { "95 % interval" } } }
            tbody {
                @for group in &summary.groups { @for (name, e) in parameters(group) { tr {
                    th { (group.name) } td { (name) } td { (long(e.value)) } td { (interval(e.low, e.high)) }
                } } }
                @for f in &summary.factors { tr {
                    th { (f.name) } td { "factor on the stiffness" } td { (long(f.estimate.value)) } td { (interval(f.estimate.low, f.estimate.high)) }
                } }
                @for v in &summary.viscous { tr {
                    th { (v.name) } td { "viscous damping ratio" } td { (long(v.estimate.value)) } td { (interval(v.estimate.low, v.estimate.high)) }
                } }
            }
        } }
    }
}

fn told(summary: &UpdateSummary) -> Markup {
    html! {
        p { "Combinations of unknowns, the best told first, with the standard deviation along each:" }
        div.wide { table {
            thead { tr { th { "standard deviation" } th { "combination" } } }
            tbody { @for t in &summary.told { tr {
                th { (t.deviation.map_or_else(|| "not told".into(), short)) } td.words { (t.combination) }
            } } }
        } }
        @if !summary.measure_next.is_empty() { p { (summary.measure_next) "." } }
        @if !summary.next_modes.is_empty() {
            p {
                "Modes not measured that would tell what is open, those that would tell most first, at amplitudes at which they are no faster than the measured \
                 ones were and no joint slips more than it did:"
            }
            div.wide { table {
                thead { tr { th { "mode" } th { "Hz" } th { "would tell best" } th { "its deviation after, over before" } th { "up to q" } } }
                tbody { @for n in &summary.next_modes { tr {
                    th { (n.mode) } td { (format!("{:.2}", n.frequency)) } td { (n.parameter) } td { (short(n.remaining)) } td { (short(n.displacement)) }
                } } }
            } }
        }
    }
}
