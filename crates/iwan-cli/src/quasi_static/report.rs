//! The report of `iwan quasi-static`: modal curves, the fitted joint, the slips.

use maud::{Markup, html};

use super::analysis::Analysed;
use super::figures::figures;
use super::summary::{ModeCurves, QuasiStaticSummary};
use crate::failure::VERSION;
use crate::page::html::{grid, page, warnings};
use crate::page::numbers::short;
use crate::page::solid::Solid;
use crate::structures::Linear;
use crate::structures::picture::illustration;

/// The page.
pub(super) fn render(linear: &Linear, analysed: &[Analysed], summary: &QuasiStaticSummary) -> String {
    let mesh = &linear.file.structure.mesh;
    let solid = Solid::new(mesh);
    let body = html! {
        h1 { (summary.structure) }
        p.about {
            "Modal curves from static loads in the shape of each mode, dissipation by Masing's rule. Written by iwan "
            (VERSION) "."
        }
        (summary.size.paragraph())
        (warnings(&summary.warnings))
        nav { @for (n, m) in summary.modes.iter().enumerate() { a href=(format!("#mode-{n}")) { (m.name) } } }
        (table(&summary.modes))
        (illustration(&solid, mesh))
        @for (n, mode) in analysed.iter().enumerate() {
            h2 id=(format!("mode-{n}")) { (mode.mode.name) }
            p { (what(&summary.modes[n])) }
            (grid(&figures(linear, mode)))
        }
    };
    page(&format!("{} \u{2013} iwan quasi-static", summary.structure), &body)
}

fn table(modes: &[ModeCurves]) -> Markup {
    let shown = |value: Option<f64>| value.map_or_else(|| "\u{2013}".into(), short);
    html! {
        div.wide { table {
            thead { tr {
                th { "mode" } th { "stuck, Hz" } th { "slipping, Hz" } th { "MAC" } th { "K_T, 1/s\u{b2}" } th { "F_S" } th { "\u{3c7}" }
                th { "\u{3b2}" }
            } }
            tbody { @for m in modes { tr {
                th { (m.name) }
                td { (format!("{:.4}", m.frequency_stuck)) }
                td { (format!("{:.4}", m.frequency_slipping)) }
                td { (format!("{:.4}", m.mac)) }
                td { (shown(m.k_t)) }
                td { (shown(m.f_s)) }
                td { (shown(m.chi)) }
                td { (shown(m.beta)) }
            } } }
        } }
    }
}

fn what(mode: &ModeCurves) -> String {
    match (&mode.remark, mode.dissipation_misfit, mode.frequency_misfit) {
        (Some(remark), ..) => format!("{remark}."),
        (None, Some(d), Some(f)) => format!(
            "One four-parameter joint follows the structure to {:.1} % in dissipation and {:.1} % of the frequency lost from stuck \
             to slipping.",
            100.0 * d,
            100.0 * f
        ),
        _ => String::new(),
    }
}
