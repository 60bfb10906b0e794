//! The figures of forced responses: amplitude and phase over frequency with the backbone on top, excitation, loops.

use iwan_core::Backbone;
use iwan_sim::{Control, SteadyCurve, SteadyPoint};

use super::responses::Response;
use crate::page::figure::{Axis, Figure, Layer, Mark, colour};
use crate::page::numbers::short;

/// Colours of the levels, in turn.
const COLOURS: [&str; 5] = [colour::BLUE, colour::VERMILLION, colour::GREEN, colour::PURPLE, colour::ORANGE];

/// Levels with a name in the legend at most: more would cover the plane.
const NAMED: usize = 8;

/// Points of a loop: corners of straight lines do not show from 100 on.
const LOOP: usize = 241;

/// All figures of a mode.
pub(super) fn figures(response: &Response) -> Vec<Figure> {
    let held = response.curves.first().is_some_and(|curve| curve.control.holds_response());
    let mut figures = if held {
        vec![excitation(response), receptance(response), phase(response)]
    } else {
        vec![amplitude(response), phase(response), receptance(response)]
    };
    figures.extend(loops(response));
    figures
}

/// One line a level.
fn lines(response: &Response, y: impl Fn(&SteadyPoint) -> f64) -> Vec<Layer> {
    let line = |(n, curve): (usize, &SteadyCurve)| {
        let points = curve.points.iter().map(|point| (point.frequency, y(point))).collect();
        let layer = Layer::new(Mark::Line, COLOURS[n % COLOURS.len()], points);
        if n < NAMED { layer.named(level(curve)) } else { layer }
    };
    response.curves.iter().enumerate().map(line).collect()
}

fn level(curve: &SteadyCurve) -> String {
    format!("{} {}", curve.control.name().replace('_', " "), short(curve.level))
}

fn frequency() -> Axis {
    Axis::linear("frequency", "Hz")
}

fn amplitude(response: &Response) -> Figure {
    let mut layers = lines(response, |point| point.amplitude);
    // Backbones within the frequencies of the curves: beyond, they would press them together.
    let all = || response.curves.iter().flat_map(|curve| &curve.points).map(|point| point.frequency);
    let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max));
    for (n, backbone) in response.backbones.iter().enumerate() {
        let within = backbone.iter().copied().filter(|point| (low..=high).contains(&point.0)).collect();
        let layer = Layer::new(Mark::Dashed, colour::BLACK, within);
        layers.push(if n == 0 { layer.named("backbone") } else { layer });
    }
    Figure {
        title: "Amplitude".into(),
        caption: "Amplitude of the first harmonic. Dashed: frequency of the mode against its amplitude, which the peaks \
            follow; where a curve turns back, a response to a creeping frequency jumps."
            .into(),
        x: frequency(),
        y: Axis::log("amplitude", ""),
        layers,
        marker: None,
    }
}

fn phase(response: &Response) -> Figure {
    Figure {
        title: "Phase".into(),
        caption: "Phase of the response against the excitation: -90 degrees (+90 under a base's acceleration) in resonance."
            .into(),
        x: frequency(),
        y: Axis::linear("phase", "deg"),
        layers: lines(response, |point| point.phase.to_degrees()),
        marker: None,
    }
}

fn excitation(response: &Response) -> Figure {
    Figure {
        title: "Force".into(),
        caption: "Amplitude of the force that holds the response: least in resonance, where it covers what is lost.".into(),
        x: frequency(),
        y: Axis::log("force", ""),
        layers: lines(response, |point| point.excitation),
        marker: None,
    }
}

fn receptance(response: &Response) -> Figure {
    let by = match response.curves.first().map(|curve| curve.control) {
        Some(Control::BaseAcceleration) => "base acceleration",
        _ => "force",
    };
    Figure {
        title: "Frequency response".into(),
        caption: format!(
            "Amplitude over {by}. A linear mode would have one curve: with the level the resonance falls in frequency and in height."
        ),
        x: frequency(),
        y: Axis::log(format!("displacement / {by}"), ""),
        layers: lines(response, |point| point.amplitude / point.excitation),
        marker: None,
    }
}

/// The joint's loop at the peak of each level, less the line of the stuck joint.
fn loops(response: &Response) -> Option<Figure> {
    let (law, shape) = response.joint.as_ref()?;
    let mut layers = Vec::new();
    for (n, curve) in response.curves.iter().enumerate().take(NAMED) {
        let Some(peak) = curve.peak() else { continue };
        let points = joint_loop(law, peak.amplitude / shape.abs());
        layers.push(Layer::new(Mark::Line, COLOURS[n % COLOURS.len()], points).named(level(curve)));
    }
    Some(Figure {
        title: "Slip in the joint".into(),
        caption: "Loop of the joint at the peak of each level, less the line of the stuck joint: its area is the energy lost in a \
            cycle."
            .into(),
        x: Axis::linear("modal displacement q", ""),
        y: Axis::linear("F \u{2212} K_T q", ""),
        layers,
        marker: None,
    })
}

/// F - K_T q along one period, by Masing's rule.
fn joint_loop(law: &impl Backbone, a: f64) -> Vec<(f64, f64)> {
    let top = law.force(a);
    let at = |i: usize| {
        let theta = std::f64::consts::TAU * i as f64 / (LOOP - 1) as f64;
        let q = a * theta.cos();
        let back = theta <= std::f64::consts::PI;
        let force =
            if back { top - 2.0 * law.force(0.5 * (a - q)) } else { 2.0 * law.force(0.5 * (a + q)) - top };
        (q, force - law.initial_stiffness() * q)
    };
    (0..LOOP).map(at).collect()
}
