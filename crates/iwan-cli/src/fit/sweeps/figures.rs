//! Figures of the measured points over the predictions of the fitted mode.

use std::f64::consts::TAU;

use iwan_ident::sweeps::{ResponsePoint, SteadyData, SteadyFit};
use iwan_sim::Mode;

use super::measurement::{Level, Measurement};
use super::predicted::Curve;
use crate::page::figure::{Axis, Figure, Layer, Mark, Marker, colour};
use crate::page::numbers::short;

/// Most levels that have a name in the legend.
const NAMED: usize = 8;
/// Number of amplitudes of a predicted backbone.
const POINTS: usize = 121;
/// How far a predicted backbone runs beyond the measured amplitudes, as a factor.
const BEYOND: f64 = 3.0;

/// A measurement with its predictions.
pub(super) struct Shown<'a> {
    pub(super) measurement: &'a Measurement,
    pub(super) curves: &'a [Curve],
    pub(super) informed: [f64; 2],
}

/// Amplitude, phase and receptance of a frequency response.
pub(super) fn responses(shown: &Shown<'_>) -> Vec<Figure> {
    let SteadyData::Response(points) = &shown.measurement.data else { return Vec::new() };
    let mut amplitude = layers(shown, points, |p| p.amplitude, |c| c[1]);
    let (low, high) = points
        .iter()
        .fold((f64::INFINITY, 0.0_f64), |(low, high), p| (low.min(p.frequency), high.max(p.frequency)));
    let limit = Layer::new(Mark::Dashed, colour::GREY, [low, high].map(|f| (f, shown.informed[1])).to_vec());
    amplitude.push(limit.named("largest amplitude measured"));
    let degrees = |phase: f64| phase.sin().atan2(phase.cos()).to_degrees();
    vec![
        Figure {
            title: "Amplitude".into(),
            caption: "Dots: measured; lines: the fitted mode at the same levels. Above the dashed line a prediction leaves what the \
                measurements informed."
                .into(),
            x: Axis::linear("frequency", "Hz"),
            y: Axis::log("modal displacement", ""),
            layers: amplitude,
            marker: None,
        },
        Figure {
            title: "Phase".into(),
            caption: "Displacement against force: -90 degrees in resonance.".into(),
            x: Axis::linear("frequency", "Hz"),
            y: Axis::linear("phase", "deg"),
            layers: layers(shown, points, |p| degrees(p.phase), |c| degrees(c[2])),
            marker: None,
        },
    ]
}

fn layers(
    shown: &Shown<'_>,
    points: &[ResponsePoint],
    measured: impl Fn(&ResponsePoint) -> f64,
    predicted: impl Fn(&[f64; 3]) -> f64,
) -> Vec<Layer> {
    let mut layers = Vec::new();
    for curve in shown.curves {
        let line = curve.points.iter().map(|p| (p[0], predicted(p))).collect();
        layers.push(Layer::new(Mark::Line, colour::of(curve.level), line));
    }
    for (n, level) in shown.measurement.levels.iter().enumerate() {
        let dots = level.points.iter().map(|&i| (points[i].frequency, measured(&points[i]))).collect();
        let layer = Layer::new(Mark::Dots, colour::of(n), dots);
        layers.push(if n < NAMED { layer.named(name(level)) } else { layer });
    }
    layers
}

fn name(level: &Level) -> String {
    level
        .held
        .map_or_else(|| "measured".into(), |(control, value)| format!("{} {}", control.name(), short(value)))
}

/// Frequency and damping against amplitude: from the measured points in resonance, and of the fitted mode.
pub(super) fn backbones(mode: &Mode, fit: &SteadyFit, measurements: &[Measurement]) -> Vec<Figure> {
    let [low, high] = fit.informed;
    let at = |i: usize| low * (BEYOND * high / low).powf(i as f64 / (POINTS - 1) as f64);
    let line = |value: &dyn Fn(f64) -> Option<f64>| -> Vec<(f64, f64)> {
        (0..POINTS).filter_map(|i| value(at(i)).map(|y| (at(i), y))).collect()
    };
    let (mut frequency, mut damping) = (Vec::new(), Vec::new());
    for (n, measurement) in measurements.iter().enumerate() {
        let colour = colour::of(n);
        let seen = shown(measurement, fit.others);
        let dots = |which: usize| seen.iter().map(|s| (s[0], s[which])).collect();
        frequency.push(Layer::new(Mark::Dots, colour, dots(1)).named(measurement.file.clone()));
        damping.push(Layer::new(Mark::Dots, colour, dots(2)).named(measurement.file.clone()));
    }
    let of_mode = |points| Layer::new(Mark::Line, colour::BLACK, points).named("fitted mode");
    frequency.push(of_mode(line(&|a| mode.frequency_at(a).ok())));
    damping.push(of_mode(line(&|a| mode.damping_ratio_at(a).ok().map(|z| 100.0 * z))));
    let figure = |title: &str, y: Axis, layers: Vec<Layer>| {
        Figure {
        title: title.into(),
        caption: "Dots: what each measurement shows by itself (responses: their points in resonance); line: the fitted mode. Beyond \
            the mark nothing was measured."
            .into(),
        x: Axis::log("modal displacement", ""),
        y,
        layers,
        marker: Some(Marker { value: high, label: "largest measured" }),
    }
    };
    vec![
        figure("Frequency", Axis::linear("frequency", "Hz"), frequency),
        figure("Damping ratio", Axis::log("damping ratio", "%"), damping),
    ]
}

/// Amplitude, frequency (Hz) and damping (%) of the measured points, computed without a law.
fn shown(measurement: &Measurement, others: f64) -> Vec<[f64; 3]> {
    /// A response point counts as resonant where the magnitude of its dynamic stiffness is at most this many times the imaginary part: damping then
    /// carries at least a third of the force.
    const RESONANT: f64 = 3.0;
    match &measurement.data {
        SteadyData::Backbone(points) => {
            points.iter().map(|p| [p.amplitude, p.frequency, 100.0 * p.damping_ratio]).collect()
        }
        SteadyData::Response(points) => points
            .iter()
            .filter_map(|p| {
                let re = p.amplitude * p.phase.cos() - others * p.force;
                let im = p.amplitude * p.phase.sin();
                let square = re * re + im * im;
                // Dynamic stiffness Z = f/u, u the response without the other modes' static part.
                let (stiffness, loss) = (p.force * re / square, -p.force * im / square);
                let omega = TAU * p.frequency;
                let k = stiffness + omega * omega;
                let resonant = loss > 0.0 && k > 0.0 && p.force / square.sqrt() <= RESONANT * loss;
                resonant.then(|| [square.sqrt(), k.sqrt() / TAU, 50.0 * loss / k])
            })
            .collect(),
    }
}
