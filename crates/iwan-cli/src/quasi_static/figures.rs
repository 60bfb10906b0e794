//! Figures of a mode under static loads: the curves of the structure, those of the fitted joint, and the slips.

use iwan_core::Backbone;

use super::analysis::Analysed;
use crate::page::figure::{Axis, Figure, Layer, Mark, colour};
use crate::structures::Linear;

/// Most slips with a line of their own, the largest first: more would cover each other.
const MOST_SLIPS: usize = 5;
/// Slips below this part of the largest are not drawn. Symmetry forbids them, what is left is rounding, and on a logarithmic axis it would squeeze
/// all others together. On the paper's beam the rounding is 3e-11 of the largest slip and the smallest genuine slip 3e-5: any limit between them
/// does.
const LEAST_SLIP: f64 = 1e-6;
/// Frequencies that change by less than this part are drawn as their change: labels of the whole frequency would need six digits or more to differ.
const SMALL_CHANGE: f64 = 1e-3;

/// All figures of a mode.
pub(super) fn figures(linear: &Linear, mode: &Analysed) -> [Figure; 4] {
    [frequency(mode), dissipation(mode), force(mode), slips(linear, mode)]
}

/// Values of a curve against the modal displacement.
fn points(mode: &Analysed, values: &[f64]) -> Vec<(f64, f64)> {
    mode.curves.displacement.iter().copied().zip(values.iter().copied()).collect()
}

/// The curve of the structure and, where there is a fit, that of the joint.
fn layers(
    mode: &Analysed,
    values: &[f64],
    model: impl Fn(&iwan_ident::Parameters, f64) -> Option<f64>,
) -> Vec<Layer> {
    let own = Layer::new(Mark::Line, colour::BLUE, points(mode, values)).named("structure");
    let mut layers = vec![own];
    if let Ok(fit) = &mode.fit {
        let fitted: Option<Vec<f64>> =
            mode.curves.displacement.iter().map(|q| model(&fit.parameters, *q)).collect();
        let fitted = fitted.unwrap_or_default();
        layers
            .push(Layer::new(Mark::Dashed, colour::VERMILLION, points(mode, &fitted)).named("fitted joint"));
    }
    layers
}

fn displacement() -> Axis {
    Axis::log("modal displacement q", "")
}

fn frequency(mode: &Analysed) -> Figure {
    let model = |p: &iwan_ident::Parameters, q: f64| {
        let (oscillator, joint) = p.model().ok()?;
        Some((oscillator.k_inf() + joint.force(q) / q).sqrt() / std::f64::consts::TAU)
    };
    let mut layers = layers(mode, &mode.curves.frequency, model);
    let first = mode.curves.frequency.first().copied().unwrap_or_default();
    let largest = mode.curves.frequency.iter().fold(0.0, |most: f64, f| most.max((f - first).abs()));
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

fn dissipation(mode: &Analysed) -> Figure {
    let model = |p: &iwan_ident::Parameters, q: f64| Some(p.model().ok()?.1.dissipation(q));
    Figure {
        title: "Dissipation per cycle".into(),
        caption: "By Masing's rule from the joints' loops; a slope of \u{3c7} + 3 in micro-slip.".into(),
        x: displacement(),
        y: Axis::log("dissipation", ""),
        layers: layers(mode, &mode.curves.dissipation, model),
        marker: None,
    }
}

fn force(mode: &Analysed) -> Figure {
    let model = |p: &iwan_ident::Parameters, q: f64| Some(p.model().ok()?.1.force(q));
    let positive = mode.curves.joint_force.iter().all(|force| *force > 0.0);
    Figure {
        title: "Modal joint force".into(),
        caption: "What the joints add to the slipping structure, \u{3b1} \u{2212} \u{3c9}\u{221e}\u{b2} q; it levels off at F_S.".into(),
        x: displacement(),
        y: if positive { Axis::log("joint force", "") } else { Axis::linear("joint force", "") },
        layers: layers(mode, &mode.curves.joint_force, model),
        marker: None,
    }
}

fn slips(linear: &Linear, mode: &Analysed) -> Figure {
    let largest = |slip: &Vec<f64>| slip.iter().fold(0.0, |most: f64, s| most.max(s.abs()));
    let named = linear.assembled.slips().iter().zip(&mode.curves.slips);
    let mut slips: Vec<(&str, &Vec<f64>)> =
        named.map(|(slip, values)| (slip.name.as_str(), values)).collect();
    slips.sort_by(|a, b| largest(b.1).total_cmp(&largest(a.1)));
    let least = LEAST_SLIP * slips.first().map_or(0.0, |first| largest(first.1));
    slips.retain(|slip| largest(slip.1) >= least);
    let layer = |(n, (name, values)): (usize, &(&str, &Vec<f64>))| {
        let sizes: Vec<f64> = values.iter().map(|s| s.abs()).collect();
        Layer::new(Mark::Line, colour::of(n), points(mode, &sizes)).named(*name)
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
