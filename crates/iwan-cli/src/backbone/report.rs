//! The report of `iwan backbone`.

use iwan_sim::BackbonePoint;
use maud::html;

use super::curves::Traced;
use super::summary::BackboneSummary;
use crate::failure::VERSION;
use crate::page::figure::{Axis, Figure, Layer, Mark, Marker, colour};
use crate::page::html::{grid, page, warnings};
use crate::page::numbers::long;

/// Most slips with a line of their own: more would cover each other.
const MOST_SLIPS: usize = 5;

/// The page.
pub(super) fn render(traced: &[Traced], summary: &BackboneSummary) -> String {
    let body = html! {
        h1 { (summary.scenario) }
        p.about {
            "Nonlinear modes by harmonic balance with harmonics up to " (summary.harmonics) ": free vibration at every amplitude, "
            "kept going by a damping that gives back what is lost. Written by iwan " (VERSION) "."
        }
        (warnings(&summary.warnings))
        nav { @for (n, m) in summary.modes.iter().enumerate() { a href=(format!("#mode-{n}")) { (m.name) } } }
        @for (n, traced) in traced.iter().enumerate() {
            h2 id=(format!("mode-{n}")) { (traced.name) }
            p { (long(traced.frequency)) " Hz at small amplitude." }
            (grid(&figures(traced)))
        }
    };
    page(&format!("{} \u{2013} iwan backbone", summary.scenario), &body)
}

fn figures(traced: &Traced) -> Vec<Figure> {
    let mut figures = vec![
        figure(
            traced,
            "Frequency",
            "Frequency of the mode against its amplitude.",
            Axis::linear("frequency", "Hz"),
            |p| p.frequency,
        ),
        figure(
            traced,
            "Damping ratio",
            "Viscous damping and what friction takes, over a cycle.",
            Axis::log("damping ratio", "%"),
            |p| 100.0 * p.damping_ratio,
        ),
    ];
    figures.extend(harmonics(traced));
    figures.extend(slips(traced));
    figures
}

fn line(traced: &Traced, y: impl Fn(&BackbonePoint) -> f64) -> Vec<(f64, f64)> {
    traced.curve.points.iter().map(|point| (point.amplitude, y(point))).collect()
}

fn figure(
    traced: &Traced,
    title: &str,
    caption: &str,
    y: Axis,
    value: impl Fn(&BackbonePoint) -> f64,
) -> Figure {
    Figure {
        title: title.into(),
        caption: caption.into(),
        x: Axis::log("amplitude of q", ""),
        y,
        layers: vec![Layer::new(Mark::Line, colour::BLUE, line(traced, value))],
        marker: traced.onset.map(|value| Marker { value, label: "first macro-slip" }),
    }
}

/// Amplitudes of the harmonics over that of the fundamental; none where only the fundamental was computed.
fn harmonics(traced: &Traced) -> Option<Figure> {
    let count = traced.curve.points.first()?.response.len();
    if count < 2 {
        return None;
    }
    let layer = |index: usize| {
        let points = line(traced, |p| p.response[index] / p.response[0]);
        Layer::new(Mark::Line, colour::beside(colour::BLUE, index - 1), points)
            .named(format!("harmonic {}", 2 * index + 1))
    };
    Some(Figure {
        title: "Harmonics".into(),
        caption: "Amplitudes of the higher harmonics over that of the first.".into(),
        x: Axis::log("amplitude of q", ""),
        y: Axis::log("harmonic / first harmonic", ""),
        layers: (1..count).map(layer).collect(),
        marker: None,
    })
}

/// Slips of a structure's joints over the modal amplitude, as a ratio that would be constant if the mode kept its linear shape; none for fewer than
/// two slips.
fn slips(traced: &Traced) -> Option<Figure> {
    /// A slip smaller than this part of the largest one is not drawn: symmetry forbids it, and what is left is rounding.
    const LEAST: f64 = 1e-6;
    if traced.slips.len() < 2 {
        return None;
    }
    let first = traced.curve.points.first()?;
    let most = first.slips.iter().fold(0.0, |most: f64, slip| most.max(slip[0]));
    let shown: Vec<usize> = (0..traced.slips.len()).filter(|&j| first.slips[j][0] > LEAST * most).collect();
    let layer = |(n, &j): (usize, &usize)| {
        let points = line(traced, |p| p.slips[j][0] / p.amplitude);
        Layer::new(Mark::Line, colour::beside(colour::BLUE, n), points).named(traced.slips[j].clone())
    };
    Some(Figure {
        title: "Slips".into(),
        caption: "First harmonic of the slips over the modal amplitude: level where the shape of the mode does not change."
            .into(),
        x: Axis::log("amplitude of q", ""),
        y: Axis::log("slip / amplitude", ""),
        layers: shown.iter().take(MOST_SLIPS).enumerate().map(layer).collect(),
        marker: None,
    })
}
