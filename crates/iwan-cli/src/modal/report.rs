//! The report of `iwan modal`.

use std::f64::consts::TAU;

use maud::{Markup, html};

use super::analysis::Level;
use super::figures::{chart, coherence, composite, criteria, fan, misfits, response};
use super::hits::Test;
use super::linearity::Decay;
use super::shape_picture::draw;
use super::summary::{ModalSummary, OtherSummary};
use crate::failure::VERSION;
use crate::page::html::{grid, page, warnings};
use crate::page::numbers::short;

/// The page.
pub(super) fn render(
    test: &Test,
    levels: &[Level],
    level: &Level,
    decay: Option<&Decay>,
    summary: &ModalSummary,
) -> String {
    let figures = [
        Some(composite(&level.responses, &level.fit.fitted)),
        Some(response(level)),
        chart(level),
        coherence(level),
    ];
    let figures: Vec<_> = figures.into_iter().flatten().collect();
    let zeroed: Vec<_> = decay.iter().flat_map(|d| [fan(d, summary.band.into()), misfits(d)]).collect();
    let body = html! {
        h1 { "Modes from hits" }
        p.about {
            (summary.modes.len()) " modes between " (format!("{:.3}", summary.band[0])) " and " (format!("{:.3}", summary.band[1]))
            " Hz, shapes at " (summary.channels.len()) " channels. Written by iwan " (VERSION) "."
        }
        (warnings(&summary.warnings))
        nav { a href="#modes" { "Modes" } a href="#responses" { "Responses" } a href="#shapes" { "Shapes" } a href="#levels" { "Levels" } @if !zeroed.is_empty() { a href="#linear" { "Linear from when on" } } }
        h2 id="modes" { "Modes" }
        p { "\u{b1} is one standard deviation from the scatter of hits and from what the fit leaves; spread of calibrations is not in it. MPC: 1 for a real shape." }
        (table(summary))
        h2 id="responses" { "Responses" }
        (grid(&figures))
        (candidates(level))
        h2 id="shapes" { "Shapes" }
        div.figures { @for m in &level.fit.modes {
            (draw(&test.geometry, &level.fit.freedoms, &m.real_shape, &format!("{:.3} Hz, {:.4} %", m.frequency, 100.0 * m.damping_ratio)))
        } }
        h2 id="levels" { "Levels of force" }
        (by_level(summary))
        div.figures { @for (n, other) in levels.iter().enumerate().filter(|(n, _)| n + 1 != summary.level) {
            (criteria(level, other, &format!("level {}", n + 1)).draw())
        } }
        @if let Some(other) = &summary.other { h2 { "By " (other.method) } (by_other(summary, other)) }
        @if !zeroed.is_empty() { h2 id="linear" { "Linear from when on" } (grid(&zeroed)) (linear(summary)) }
        @if !summary.hits.is_empty() { h2 { "Hits" } (hits(summary)) }
    };
    page("iwan modal", &body)
}

fn table(summary: &ModalSummary) -> Markup {
    let sidebands = summary.modes.iter().any(|m| m.sideband_of.is_some());
    html! {
        div.wide { table {
            thead { tr { th { "mode" } th { "frequency, Hz" } th { "\u{b1}" } th { "damping, %" } th { "\u{b1}" } th { "MPC" } @if sidebands { th { "" } } } }
            tbody { @for (n, m) in summary.modes.iter().enumerate() { tr {
                th { (n + 1) }
                td { (format!("{:.5}", m.frequency)) }
                td { (short(m.frequency_sd)) }
                td { (format!("{:.5}", 100.0 * m.damping_ratio)) }
                td { (short(100.0 * m.damping_ratio_sd)) }
                td { (format!("{:.4}", m.phase_collinearity)) }
                @if let Some(of) = m.sideband_of { td { "probably a sideband of " (format!("{of:.3} Hz")) } }
            } } }
        } }
    }
}

/// Poles that remain in the stabilisation chart, and whether the fit has a mode there: the candidates for --add-poles and --drop-poles.
fn candidates(level: &Level) -> Markup {
    let taken = |frequency: f64| level.fit.mode_at(frequency, &level.responses).is_some();
    html! { @if let Some(chart) = &level.fit.stabilisation {
        p { "Poles that stay in the chart. --add-poles with the frequency of one that was not taken makes a mode of it, --drop-poles with that of a mode leaves it out." }
        div.wide { table {
            thead { tr { th { "pole" } th { "frequency, Hz" } th { "damping, %" } th { "stays over orders, %" } th { "mode" } } }
            tbody { @for (n, c) in chart.candidates.iter().enumerate() { tr {
                th { (n + 1) }
                td { (format!("{:.4}", c.pole.norm() / TAU)) }
                td { (format!("{:.4}", -100.0 * c.pole.re / c.pole.norm())) }
                td { (format!("{:.0}", 100.0 * c.stays)) }
                td { (if taken(c.pole.norm() / TAU) { "taken" } else { "not taken" }) }
            } } }
        } }
    } }
}

/// Frequency and damping of each mode at each level: a mode that changes with the level is not linear.
fn by_level(summary: &ModalSummary) -> Markup {
    html! {
        div.wide { table {
            thead { tr { th { "mode" } @for l in &summary.levels { th { "force " (short(l.force)) ": Hz" } th { "%" } th { "MAC" } } } }
            tbody { @for n in 0..summary.modes.len() { tr {
                th { (n + 1) }
                @for l in &summary.levels { @match &l.modes[n] {
                    Some(m) => { td { (format!("{:.4}", m.frequency)) } td { (format!("{:.4}", 100.0 * m.damping_ratio)) } td { (format!("{:.4}", m.mac)) } },
                    None => { td { "\u{2013}" } td { "\u{2013}" } td { "\u{2013}" } },
                } }
            } } }
        } }
    }
}

/// The poles by both methods, mode by mode.
fn by_other(summary: &ModalSummary, other: &OtherSummary) -> Markup {
    html! {
        p { (other.found) " modes by " (other.method) ", " (summary.modes.len()) " reported." }
        div.wide { table {
            thead { tr { th { "mode" } th { "frequency, Hz" } th { (other.method) ", Hz" } th { "damping, %" } th { (other.method) ", %" } th { "MAC" } } }
            tbody { @for (n, (own, m)) in summary.modes.iter().zip(&other.modes).enumerate() { tr {
                th { (n + 1) }
                td { (format!("{:.5}", own.frequency)) }
                td { (m.as_ref().map_or("\u{2013}".into(), |m| format!("{:.5}", m.frequency))) }
                td { (format!("{:.5}", 100.0 * own.damping_ratio)) }
                td { (m.as_ref().map_or("\u{2013}".into(), |m| format!("{:.5}", 100.0 * m.damping_ratio))) }
                td { (m.as_ref().map_or("\u{2013}".into(), |m| format!("{:.4}", m.mac))) }
            } } }
        } }
    }
}

/// For each mode, the time and amplitude from which its decay is linear.
fn linear(summary: &ModalSummary) -> Markup {
    html! { @if let Some(found) = &summary.linear_from {
        div.wide { table {
            thead { tr { th { "late decay, Hz" } th { "%" } th { "linear from, s" } th { "amplitude" } } }
            tbody { @for m in &found.modes { tr {
                td { (format!("{:.4}", m.frequency)) }
                td { (format!("{:.4}", 100.0 * m.damping_ratio)) }
                td { (m.time.map_or("not before the late half".into(), |t| format!("{t:.4}"))) }
                td { (m.amplitude.map_or(String::new(), short)) }
            } } }
        } }
    } }
}

fn hits(summary: &ModalSummary) -> Markup {
    html! {
        div.wide { table {
            thead { tr { th { "hit" } th { "peak force" } th { "faults" } } }
            tbody { @for h in &summary.hits { tr {
                th { (h.name) @if h.left_out { " (left out)" } }
                td { (short(h.peak_force)) }
                td { (h.faults.join("; ")) }
            } } }
        } }
    }
}
