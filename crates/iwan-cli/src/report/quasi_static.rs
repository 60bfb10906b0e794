//! The report of `iwan quasi-static`: modal curves, the fitted joint, the slips.

use iwan_core::Backbone;
use maud::{Markup, html};

use super::figure::{Axis, Figure, Layer, Mark, colour};
use super::modes::{mesh_picture, size};
use super::solid::Solid;
use super::{grid, page};
use crate::commands::quasi_static::{Analysed, ModeCurves, QuasiStaticSummary};
use crate::linear::Linear;
use crate::summary::short;

/// What the report is about.
#[derive(Debug)]
pub(crate) struct Input<'a> {
    pub(crate) linear: &'a Linear,
    pub(crate) analysed: &'a [Analysed],
    pub(crate) summary: &'a QuasiStaticSummary,
}

/// Colours of the slips, in turn.
const COLOURS: [&str; 5] = [colour::BLUE, colour::VERMILLION, colour::GREEN, colour::PURPLE, colour::ORANGE];
/// Slips with a line of their own at most: the largest.
const MOST_SLIPS: usize = 5;
/// Slips below this part of the largest are rounding.
const LEAST_SLIP: f64 = 1e-6;
/// Frequencies that change less than this, relatively, are drawn as their change.
const SMALL_CHANGE: f64 = 1e-3;
/// Meshes with more outer faces than this are not drawn.
const MOST_FACES: usize = 40_000;

/// The page.
pub(crate) fn render(input: &Input<'_>) -> String {
    let summary = input.summary;
    let mesh = &input.linear.file.structure.mesh;
    let solid = Solid::new(mesh);
    let body = html! {
        h1 { (summary.structure) }
        p.about {
            "Modal curves from static loads in the shape of each mode, dissipation by Masing's rule. Written by iwan "
            (summary.version) "."
        }
        (size(&summary.size))
        (super::warnings(&summary.warnings))
        nav { @for (n, m) in summary.modes.iter().enumerate() { a href=(format!("#mode-{n}")) { (m.name) } } }
        (table(&summary.modes))
        @if solid.faces() <= MOST_FACES { (mesh_picture(&solid, mesh)) }
        @for (n, of) in input.analysed.iter().enumerate() {
            h2 id=(format!("mode-{n}")) { (of.mode.name) }
            p { (what(&summary.modes[n])) }
            (grid(&[frequency(of), dissipation(of), force(of), slips(input.linear, of)]))
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

/// Points over the modal displacement.
fn points(of: &Analysed, values: &[f64]) -> Vec<(f64, f64)> {
    of.curves.displacement.iter().copied().zip(values.iter().copied()).collect()
}

/// The structure's curve and, where there is a fit, the joint's.
fn layers(
    of: &Analysed,
    values: &[f64],
    model: impl Fn(&iwan_ident::Parameters, f64) -> Option<f64>,
) -> Vec<Layer> {
    let own = Layer::new(Mark::Line, colour::BLUE, points(of, values)).named("structure");
    let mut layers = vec![own];
    if let Ok(fit) = &of.fit {
        let fitted: Option<Vec<f64>> =
            of.curves.displacement.iter().map(|q| model(&fit.parameters, *q)).collect();
        let fitted = fitted.unwrap_or_default();
        layers.push(Layer::new(Mark::Dashed, colour::VERMILLION, points(of, &fitted)).named("fitted joint"));
    }
    layers
}

fn displacement() -> Axis {
    Axis::log("modal displacement q", "")
}

fn frequency(of: &Analysed) -> Figure {
    let model = |p: &iwan_ident::Parameters, q: f64| {
        let (oscillator, joint) = p.model().ok()?;
        Some((oscillator.k_inf() + joint.force(q) / q).sqrt() / std::f64::consts::TAU)
    };
    let mut layers = layers(of, &of.curves.frequency, model);
    let first = of.curves.frequency.first().copied().unwrap_or_default();
    let largest = of.curves.frequency.iter().fold(0.0, |most: f64, f| most.max((f - first).abs()));
    let mut label = "frequency".to_string();
    if largest < SMALL_CHANGE * first {
        label = format!("frequency \u{2212} {first:.4} Hz");
        layers.iter_mut().flat_map(|layer| &mut layer.points).for_each(|point| point.1 -= first);
    }
    Figure {
        title: "Frequency".into(),
        caption: "Secant frequency: from the stuck limit at small to the slipping limit at large amplitude."
            .into(),
        x: displacement(),
        y: Axis::linear(label, "Hz"),
        layers,
        marker: None,
    }
}

fn dissipation(of: &Analysed) -> Figure {
    let model = |p: &iwan_ident::Parameters, q: f64| Some(p.model().ok()?.1.dissipation(q));
    Figure {
        title: "Dissipation per cycle".into(),
        caption: "By Masing's rule from the joints' loops; a slope of \u{3c7} + 3 in micro-slip.".into(),
        x: displacement(),
        y: Axis::log("dissipation", ""),
        layers: layers(of, &of.curves.dissipation, model),
        marker: None,
    }
}

fn force(of: &Analysed) -> Figure {
    let model = |p: &iwan_ident::Parameters, q: f64| Some(p.model().ok()?.1.force(q));
    let positive = of.curves.joint_force.iter().all(|force| *force > 0.0);
    Figure {
        title: "Modal joint force".into(),
        caption: "What the joints add to the slipping structure, \u{3b1} \u{2212} \u{3c9}\u{221e}\u{b2} q; it levels off at F_S.".into(),
        x: displacement(),
        y: if positive { Axis::log("joint force", "") } else { Axis::linear("joint force", "") },
        layers: layers(of, &of.curves.joint_force, model),
        marker: None,
    }
}

fn slips(linear: &Linear, of: &Analysed) -> Figure {
    let largest = |slip: &Vec<f64>| slip.iter().fold(0.0, |most: f64, s| most.max(s.abs()));
    let named = linear.assembled.slips().iter().zip(&of.curves.slips);
    let mut slips: Vec<(&str, &Vec<f64>)> =
        named.map(|(slip, values)| (slip.name.as_str(), values)).collect();
    slips.sort_by(|a, b| largest(b.1).total_cmp(&largest(a.1)));
    let least = LEAST_SLIP * slips.first().map_or(0.0, |first| largest(first.1));
    slips.retain(|slip| largest(slip.1) >= least);
    let layer = |(n, (name, values)): (usize, &(&str, &Vec<f64>))| {
        let sizes: Vec<f64> = values.iter().map(|s| s.abs()).collect();
        Layer::new(Mark::Line, COLOURS[n % COLOURS.len()], points(of, &sizes)).named(*name)
    };
    Figure {
        title: "Slips".into(),
        caption: "Slip of the joints that slip most, without sign.".into(),
        x: displacement(),
        y: Axis::log("slip", ""),
        layers: slips.iter().take(MOST_SLIPS).enumerate().map(layer).collect(),
        marker: None,
    }
}
