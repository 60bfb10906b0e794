//! Figures of a modal analysis: composite response with fit, drive point, coherence, stabilisation chart, zeroed spectra, and the shapes of two
//! levels compared.

use iwan_modal::fit::Fitted;
use iwan_modal::responses::FrequencyResponses;

use super::analysis::{Level, alike};
use super::linearity::Decay;
use crate::page::decimate::thin;
use crate::page::figure::{Axis, Figure, Layer, Mark, colour};
use crate::page::heat::HeatMap;

/// Most points of a curve: nearly two for each unit of the plane's width, so that a narrow peak is not lost.
const CURVE: usize = 1200;

type Points = Vec<(f64, f64)>;

/// The highest point of each stretch of points.
fn crests(points: &[(f64, f64)]) -> Points {
    let size = points.len().div_ceil(CURVE).max(1);
    points.chunks(size).filter_map(|c| c.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1))).collect()
}

/// Composite response: root mean square over all functions, measured and fitted.
pub(crate) fn composite(responses: &FrequencyResponses, fitted: &Fitted) -> Figure {
    let count = fitted.curves.first().map_or(0, Vec::len);
    let n = fitted.curves.len().max(1) as f64;
    let frequency = |k: usize| responses.frequency(fitted.first + k);
    let measured = responses.composite();
    let of_fit = |k: usize| (fitted.curves.iter().map(|c| c[k].norm_sqr()).sum::<f64>() / n).sqrt();
    let left = |k: usize| {
        let f = responses.functions.iter().zip(&fitted.curves);
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

/// One response with its fit: that of the drive point, or the first where no point was both hit and measured.
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

/// Mean coherence of all responses; none with one hit, where coherence is not defined.
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

/// Most zeroed spectra that are drawn: more could not be told apart.
const FAN: usize = 7;

/// Zeroed spectra of the hardest hit: spectra of its decay with a growing part of the beginning set to zero.
pub(super) fn fan(decay: &Decay, (low, high): (f64, f64)) -> Figure {
    let colours = [
        colour::VERMILLION,
        colour::ORANGE,
        colour::PURPLE,
        colour::GREEN,
        colour::BLUE,
        "#08305e",
        colour::GREY,
    ];
    let spectra = &decay.zeroed.spectra;
    let layer = |(n, own): (usize, &'static str)| {
        let spectrum = &spectra[n * (spectra.len() - 1) / (FAN - 1)];
        let lines = spectrum.magnitude.iter().enumerate().map(|(k, m)| (k as f64 * spectrum.step, *m));
        let inside: Points = lines.filter(|(f, m)| (low..=high).contains(f) && *m > 0.0).collect();
        Layer::new(Mark::Line, own, crests(&inside))
            .named(format!("from {:.3} s", decay.start + spectrum.time))
    };
    Figure {
        title: "Zeroed early-time spectra".into(),
        caption: format!(
            "{}: what is left when the record's begin is zero. A linear mode only sinks; one whose peak moves is not linear yet.",
            decay.place
        ),
        x: Axis::linear("frequency", "Hz"),
        y: Axis::log("spectrum", ""),
        layers: (0..FAN).zip(colours).map(layer).collect(),
        marker: None,
    }
}

/// Difference, for each mode, between the response and the linear model of the late decay carried backwards in time.
pub(super) fn misfits(decay: &Decay) -> Figure {
    let colours =
        [colour::BLUE, colour::VERMILLION, colour::GREEN, colour::PURPLE, colour::ORANGE, colour::GREY];
    let layer = |(mode, own): (&iwan_modal::LinearFrom, &&'static str)| {
        let points =
            decay.zeroed.spectra.iter().zip(&mode.misfit).map(|(s, m)| (decay.start + s.time, 100.0 * m));
        let name = format!("{:.2} Hz", mode.pole.norm() / std::f64::consts::TAU);
        Layer::new(Mark::Line, own, points.collect()).named(name)
    };
    Figure {
        title: "From when on is it linear?".into(),
        caption: "Distance of each mode's zeroed spectrum from the linear model of the late half: within 5 % for good, it is linear.".into(),
        x: Axis::linear("zeroed until", "s"),
        y: Axis::log("distance", "%"),
        layers: decay.zeroed.modes.iter().zip(colours.iter().cycle()).map(layer).collect(),
        marker: None,
    }
}

/// Modal assurance criteria between the reported modes (axis of x) and those of another level (axis of y).
pub(super) fn criteria(level: &Level, other: &Level, name: &str) -> HeatMap {
    let (a, b) = (&level.fit, &other.fit);
    let column = |m: &iwan_modal::modes::Mode| (0..b.modes.len()).map(|i| alike(a, m, b, i)).collect();
    let span = |count: usize| (0.5, count as f64 + 0.5);
    HeatMap {
        title: format!("MAC with {name}"),
        caption: "Shapes of the reported modes (across) beside those of the other level: dark where they are the same.".into(),
        x: Axis::linear("mode", ""),
        y: Axis::linear("mode of the other level", ""),
        across: span(a.modes.len()),
        up: span(b.modes.len()),
        values: a.modes.iter().map(column).collect(),
        band: None,
        ends: ("0".into(), "1".into()),
    }
}
