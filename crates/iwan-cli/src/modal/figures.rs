//! Figures of a modal analysis: composite response with fit, drive point, coherence, stabilisation chart.

use super::analysis::Level;
use crate::page::decimate::thin;
use crate::page::figure::{Axis, Figure, Layer, Mark, colour};

/// Points of a curve, at most: nearly two for each unit of the plane, so that a narrow peak is not lost.
const CURVE: usize = 1200;

type Points = Vec<(f64, f64)>;

/// The highest of each stretch of points.
fn crests(points: &[(f64, f64)]) -> Points {
    let size = points.len().div_ceil(CURVE).max(1);
    points.chunks(size).filter_map(|c| c.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1))).collect()
}

/// Composite response and fit.
pub(super) fn composite(level: &Level) -> Figure {
    let fitted = &level.fit.fitted;
    let count = fitted.curves.first().map_or(0, Vec::len);
    let n = fitted.curves.len().max(1) as f64;
    let frequency = |k: usize| level.responses.frequency(fitted.first + k);
    let measured = level.responses.composite();
    let of_fit = |k: usize| (fitted.curves.iter().map(|c| c[k].norm_sqr()).sum::<f64>() / n).sqrt();
    let left = |k: usize| {
        let f = level.responses.functions.iter().zip(&fitted.curves);
        (f.map(|(f, c)| (f.values[fitted.first + k] - c[k]).norm_sqr()).sum::<f64>() / n).sqrt()
    };
    let points = |value: &dyn Fn(usize) -> f64| -> Points {
        let all: Points = (0..count).map(|k| (frequency(k), value(k))).filter(|p| p.1 > 0.0).collect();
        crests(&all)
    };
    Figure {
        title: "Composite response".into(),
        caption: "Root mean square over all responses, that of the fit, and what the fit leaves.".into(),
        x: Axis::linear("frequency", "Hz"),
        y: Axis::log("motion per force", ""),
        layers: vec![
            Layer::new(Mark::Line, colour::GREY, points(&|k| measured[fitted.first + k])).named("measured"),
            Layer::new(Mark::Dashed, colour::BLUE, points(&of_fit)).named("fit"),
            Layer::new(Mark::Line, colour::VERMILLION, points(&left)).named("left"),
        ],
        marker: None,
    }
}

/// One response with its fit: the drive point, or the first.
pub(super) fn response(level: &Level) -> Figure {
    let functions = &level.responses.functions;
    let k = functions.iter().position(|f| f.response.is_at(&f.force)).unwrap_or(0);
    let fitted = &level.fit.fitted;
    let frequency = |i: usize| level.responses.frequency(fitted.first + i);
    let points = |values: &[iwan_modal::Complex<f64>]| -> Points {
        let all: Points =
            values.iter().enumerate().map(|(i, v)| (frequency(i), v.norm())).filter(|p| p.1 > 0.0).collect();
        crests(&all)
    };
    let curve = &fitted.curves[k];
    Figure {
        title: format!("Response {} over force {}", functions[k].response, functions[k].force),
        caption: "Magnitude as measured, and of the fit.".into(),
        x: Axis::linear("frequency", "Hz"),
        y: Axis::log("motion per force", ""),
        layers: vec![
            Layer::new(
                Mark::Line,
                colour::GREY,
                points(&functions[k].values[fitted.first..fitted.first + curve.len()]),
            )
            .named("measured"),
            Layer::new(Mark::Dashed, colour::BLUE, points(curve)).named("fit"),
        ],
        marker: None,
    }
}

/// Mean coherence of all responses; none with one hit.
pub(super) fn coherence(level: &Level) -> Option<Figure> {
    let functions: Vec<_> = level.responses.functions.iter().filter(|f| !f.coherence.is_empty()).collect();
    let first = level.fit.fitted.first;
    let count = level.fit.fitted.curves.first().map_or(0, Vec::len);
    let mean = |k: usize| functions.iter().map(|f| f.coherence[k]).sum::<f64>() / functions.len() as f64;
    let all: Points = (first..first + count).map(|k| (level.responses.frequency(k), mean(k))).collect();
    (!functions.is_empty()).then(|| Figure {
        title: "Coherence".into(),
        caption: "Mean over all responses: 1 where every hit says the same.".into(),
        x: Axis::linear("frequency", "Hz"),
        y: Axis::linear("coherence", ""),
        layers: vec![Layer::new(Mark::Line, colour::GREEN, thin(&all, CURVE))],
        marker: None,
    })
}

/// The stabilisation chart; none where mode isolation was chosen.
pub(super) fn chart(level: &Level) -> Option<Figure> {
    let chart = level.fit.stabilisation.as_ref()?;
    let points = |stable: bool| -> Points {
        let own = chart.poles.iter().filter(|p| p.stable == stable);
        own.filter(|p| p.frequency >= level.fit.band.0 && p.frequency <= level.fit.band.1)
            .map(|p| (p.frequency, p.order as f64))
            .collect()
    };
    let highest = chart.poles.iter().map(|p| p.order).max().unwrap_or(0) as f64;
    let modes = level.fit.modes.iter().map(|m| (m.frequency, highest + 2.0)).collect();
    Some(Figure {
        title: "Stabilisation chart".into(),
        caption: "Poles of rational functions of each order; stable: frequency and damping as at the order before. Above: the modes of the fit.".into(),
        x: Axis::linear("frequency", "Hz"),
        y: Axis::linear("order", ""),
        layers: vec![
            Layer::new(Mark::Dots, colour::GREY, points(false)).named("pole"),
            Layer::new(Mark::Dots, colour::BLUE, points(true)).named("stable"),
            Layer::new(Mark::Dots, colour::VERMILLION, modes).named("mode"),
        ],
        marker: None,
    })
}
