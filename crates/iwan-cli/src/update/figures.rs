//! Figures of an update: curves before and after, and the front of compromises between frequency and damping.

use iwan_study::update::{ComparedBlow, ComparedCurve, TradeOff};

use crate::page::figure::{Axis, DEVIATIONS, Figure, Layer, Mark, colour};

/// The band of a curve as a closed line (lower and upper half width from `half`); empty where a half width is infinite at any point.
fn band(q: &[f64], values: &[f64], half: impl Fn(usize) -> (f64, f64)) -> Vec<(f64, f64)> {
    if (0..q.len()).any(|i| !(half(i).0.is_finite() && half(i).1.is_finite())) {
        return Vec::new();
    }
    let upper = (0..q.len()).map(|i| (q[i], values[i] + half(i).1));
    let lower = (0..q.len()).rev().map(|i| (q[i], values[i] - half(i).0));
    upper.chain(lower).collect()
}

fn layers(
    curve: &ComparedCurve,
    measured: &[f64],
    before: &[f64],
    after: &[f64],
    area: Vec<(f64, f64)>,
) -> Vec<Layer> {
    let points = |values: &[f64]| curve.displacement.iter().copied().zip(values.iter().copied()).collect();
    let mut layers = vec![
        Layer::new(Mark::Area, colour::VERMILLION, area),
        Layer::new(Mark::Dots, colour::BLUE, points(measured)).named("measured"),
    ];
    if !before.is_empty() {
        layers.push(Layer::new(Mark::Dashed, colour::GREY, points(before)).named("structure as given"));
    }
    let name = if curve.held_out { "predicted" } else { "with the joints found" };
    layers.push(Layer::new(Mark::Line, colour::VERMILLION, points(after)).named(name));
    layers
}

/// A sentence on the meaning of the band.
const fn open(band: &[(f64, f64)]) -> &'static str {
    if band.is_empty() {
        "There is no band: nothing bounds how far this may be off."
    } else {
        "The pale band is what the curves leave open (95 %)."
    }
}

/// Frequency and damping of a mode against amplitude.
pub(super) fn figures(curve: &ComparedCurve) -> [Figure; 2] {
    let held = if curve.held_out { " The mode was kept out of the fit." } else { "" };
    let q = &curve.displacement;
    let frequency = band(q, &curve.frequency_after, |i| {
        let half = DEVIATIONS * curve.frequency_sd[i];
        (half, half)
    });
    let damping = band(q, &curve.damping_ratio_after, |i| {
        let (value, sd) = (curve.damping_ratio_after[i], DEVIATIONS * curve.log_damping_sd[i]);
        (value * -(-sd).exp_m1(), value * sd.exp_m1())
    });
    [
        Figure {
            title: "Frequency".into(),
            caption: format!("{}{held}", open(&frequency)),
            x: Axis::log("modal displacement q", ""),
            y: Axis::linear("frequency", "Hz"),
            layers: layers(
                curve,
                &curve.frequency,
                &curve.frequency_before,
                &curve.frequency_after,
                frequency,
            ),
            marker: None,
        },
        Figure {
            title: "Damping ratio".into(),
            caption: format!("Joints and viscous damping together. {}{held}", open(&damping)),
            x: Axis::log("modal displacement q", ""),
            y: Axis::log("damping ratio", ""),
            layers: layers(
                curve,
                &curve.damping_ratio,
                &curve.damping_ratio_before,
                &curve.damping_ratio_after,
                damping,
            ),
            marker: None,
        },
    ]
}

/// Amplitude of a mode at a point against time, measured and computed.
pub(super) fn amplitudes(blow: &ComparedBlow) -> Figure {
    let points = |values: &[f64]| blow.time.iter().copied().zip(values.iter().copied()).collect();
    let name = if blow.held_out { "predicted" } else { "with the joints found" };
    Figure {
        title: format!("{}: {} at {}", blow.source, blow.mode, blow.point),
        caption: "Amplitude about the frequency of the mode, in windows.".into(),
        x: Axis::linear("t", "s"),
        y: Axis::log("amplitude", ""),
        layers: vec![
            Layer::new(Mark::Dots, colour::BLUE, points(&blow.measured)).named("measured"),
            Layer::new(Mark::Line, colour::VERMILLION, points(&blow.computed)).named(name),
        ],
        marker: None,
    }
}

/// The front of compromises: the misfit of damping against the misfit of frequency of the best joints at different weights.
pub(super) fn front(front: &[TradeOff]) -> Figure {
    let points: Vec<(f64, f64)> = front.iter().map(|t| (t.frequency, t.damping)).collect();
    Figure {
        title: "Frequency against damping".into(),
        caption: "Best compromises: root-mean-square misfit of frequency, over its measured shift, against that of ln \u{3b6}. One point: both \
                  want the same joints. A long front: the structure cannot have both."
            .into(),
        x: Axis::log("misfit of frequency", ""),
        y: Axis::log("misfit of damping", ""),
        layers: vec![
            Layer::new(Mark::Line, colour::BLUE, points.clone()),
            Layer::new(Mark::Dots, colour::BLUE, points),
        ],
        marker: None,
    }
}
