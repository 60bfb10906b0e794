//! Figures of a mode extracted from a record: the record, its spectrum, and amplitude, frequency and damping by each method.

use iwan_ident::curves::Line;
use iwan_ident::signal::{Envelope, Method, amplitude_spectrum};

use super::picture::picture;
use crate::page::decimate::{STRETCHES, crests, history, thin};
use crate::page::figure::{Axis, DEVIATIONS, Figure, Layer, Mark, Marker, colour};
use crate::page::heat::HeatMap;
use crate::records::{Extraction, Units};

/// Most points of a curve: four for every five units of the plane's width. More could not be told apart.
const CURVE: usize = 400;
/// Stretches into which a spectrum is cut; the highest line of each is drawn, so that a narrow peak is not lost. Nearly two for each unit of the
/// plane's width are enough.
const LINES: usize = 900;
/// The spectrum near the band is drawn from this multiple of the band's lower edge, so that a neighbouring mode is visible.
const FROM: f64 = 0.6;
/// The spectrum near the band is drawn up to this multiple of the band's upper edge.
const TO: f64 = 1.6;
/// Spectral lines below this part of the highest one are not drawn: they belong to the filter's stop band, and an axis that held them would flatten
/// the peak.
const FLOOR: f64 = 1e-5;

/// A mode and the units of its record.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Extracted<'a> {
    pub(crate) x: &'a Extraction,
    pub(crate) units: &'a Units,
}

/// The mark and colour of a method's curves.
fn style(method: Method) -> (Mark, &'static str) {
    match method {
        Method::Hilbert => (Mark::Line, colour::BLUE),
        Method::Peaks => (Mark::Dashed, colour::VERMILLION),
        Method::PeakFitting => (Mark::Line, colour::GREEN),
        Method::Demodulation => (Mark::Dashed, colour::PURPLE),
        Method::FreeVibration => (Mark::Line, colour::ORANGE),
    }
}

/// A quantity of an envelope with the axis on which it is drawn.
struct Quantity {
    axis: Axis,
    /// Value of the quantity at an index of the envelope.
    value: fn(&Envelope, usize) -> f64,
    /// Standard deviation of the quantity at that index; where it is given, a pale band is drawn around the curve.
    sd: Option<fn(&Envelope, usize) -> f64>,
}

impl Extracted<'_> {
    /// The record as measured and after the band-pass filter.
    pub(crate) fn record(&self) -> Figure {
        let (x, dt, start) = (self.x, self.x.isolated.dt, self.x.start);
        let shifted = |samples: &[f64]| -> Vec<(f64, f64)> {
            history(samples, dt, STRETCHES).into_iter().map(|(t, y)| (start + t, y)).collect()
        };
        let (from, to) = x.isolated.trusted();
        Figure {
            title: "Record".into(),
            caption: format!(
                "The record, and the mode in its band. Amplitude and frequency are trusted from {:.4} to {:.4} s: before, \
                 the impact and the filter's transient, behind, noise or the end of the record.",
                start + from,
                start + to
            ),
            x: Axis::linear("time", "s"),
            y: self.samples_axis(self.units.quantity, false),
            layers: vec![
                Layer::new(Mark::Line, colour::GREY, shifted(&x.samples)).named("record"),
                Layer::new(Mark::Line, colour::BLUE, shifted(&x.isolated.samples)).named("mode"),
            ],
            marker: None,
        }
    }

    fn samples_axis(&self, label: &str, log: bool) -> Axis {
        if log { Axis::log(label, &self.units.samples) } else { Axis::linear(label, &self.units.samples) }
    }

    /// The spectrogram with the edges of the band; none where the record is too short for it.
    pub(crate) fn over_time(&self) -> Option<HeatMap> {
        let Extraction { samples, isolated, start, .. } = self.x;
        picture(samples, isolated.dt, *start, Some(isolated.band))
    }

    /// The spectrum of the whole record with the band marked, and the spectrum near the band.
    pub(crate) fn spectra(&self) -> Vec<Figure> {
        let (x, band) = (self.x, self.x.isolated.band);
        let spectrum = |samples: &[f64]| -> Vec<(f64, f64)> {
            let lines = amplitude_spectrum(samples, x.isolated.dt).unwrap_or_default();
            lines.iter().map(|line| (line.frequency, line.amplitude)).collect()
        };
        let (whole, filtered) = (spectrum(&x.samples), spectrum(&x.isolated.samples));
        let label = format!("amplitude of {}", self.units.quantity);
        let figure = |title: &str, caption: &str, x: Axis, layers| Figure {
            title: title.into(),
            caption: caption.into(),
            x,
            y: self.samples_axis(&label, true),
            layers,
            marker: Some(Marker { value: band.peak, label: "peak" }),
        };
        let lines = crests(&whole, LINES);
        let reach = (FROM * band.low, TO * band.high);
        let near = |points: &[(f64, f64)]| -> Vec<(f64, f64)> {
            let floor = FLOOR * points.iter().map(|p| p.1).fold(0.0, f64::max);
            let inside = points.iter().copied().filter(|p| (reach.0..=reach.1).contains(&p.0) && p.1 > floor);
            crests(&inside.collect::<Vec<_>>(), LINES)
        };
        let (around, passed) = (near(&whole), near(&filtered));
        vec![
            figure(
                "Spectrum of the record",
                "Hann-windowed amplitude spectrum; the pale area is the band that was cut out.",
                Axis::log("frequency", "Hz"),
                vec![
                    pale((band.low, band.high), &lines),
                    Layer::new(Mark::Line, colour::GREY, lines).named("record"),
                ],
            ),
            figure(
                "Spectrum in the band",
                "A second peak inside the pale band would be a second mode; the filter must leave the first one whole.",
                Axis::linear("frequency", "Hz"),
                vec![
                    pale((band.low, band.high), &around),
                    Layer::new(Mark::Line, colour::GREY, around).named("record"),
                    Layer::new(Mark::Line, colour::BLUE, passed).named("mode"),
                ],
            ),
        ]
    }

    /// Amplitude, frequency and damping against time by all methods; frequency and damping also against amplitude.
    pub(crate) fn methods(&self) -> Vec<Figure> {
        let label = format!("amplitude of {}", self.units.quantity);
        let level = || Quantity {
            axis: Axis::log(&label, &self.units.samples),
            value: |e, i| e.amplitude[i],
            sd: None,
        };
        let frequency = || Quantity {
            axis: Axis::linear("frequency", "Hz"),
            value: |e, i| e.frequency[i],
            sd: Some(|e, i| e.frequency_sd[i]),
        };
        let damping = || Quantity {
            axis: Axis::linear("damping ratio", "%"),
            value: |e, i| 100.0 * e.damping_ratio[i],
            sd: Some(|e, i| 100.0 * e.damping_ratio_sd[i]),
        };
        let bands = "The pale band is what the method chosen may be wrong by, at 95 %; where the methods differ by more, the \
            difference is theirs.";
        vec![
            self.figure(
                "Amplitude against time",
                "Logarithmic: a linear mode is a straight line.",
                None,
                level(),
            ),
            self.figure("Frequency against time", bands, None, frequency()),
            self.figure("Damping ratio against time", bands, None, damping()),
            self.figure(
                "Frequency against amplitude",
                "Falling with amplitude: the joint softens.",
                Some(level()),
                frequency(),
            ),
            self.figure(
                "Damping ratio against amplitude",
                "Rising with amplitude: friction; level: viscous.",
                Some(level()),
                damping(),
            ),
        ]
    }

    /// The damping ratio by each method minus the mean over all methods, at the times at which every method gives a value.
    pub(crate) fn disagreement(&self) -> Figure {
        let (all, start) = (&self.x.opinions.envelopes, self.x.start);
        let mean = |t: f64| -> Option<f64> {
            let values: Option<Vec<f64>> = all.iter().map(|e| e.at(t).map(|p| p.damping_ratio)).collect();
            values.map(|v| v.iter().sum::<f64>() / v.len() as f64)
        };
        let layer = |e: &Envelope| {
            let difference =
                |i: usize| mean(e.t[i]).map(|m| (start + e.t[i], 100.0 * (e.damping_ratio[i] / m - 1.0)));
            let points: Vec<_> = (0..e.t.len()).filter_map(difference).collect();
            let (mark, colour) = style(e.method);
            Layer::new(mark, colour, thin(&points, CURVE)).named(e.method.name())
        };
        Figure {
            title: "Damping ratio: how far the methods disagree".into(),
            caption: "Each method less the mean of all of them. Wide at the ends, where every method knows only one side.".into(),
            x: Axis::linear("time", "s"),
            y: Axis::linear("difference from the mean", "%"),
            layers: all.iter().map(layer).collect(),
            marker: None,
        }
    }

    /// A quantity by all methods, against time or, where `over` is given, against another quantity.
    fn figure(&self, title: &str, caption: &str, over: Option<Quantity>, shown: Quantity) -> Figure {
        let start = self.x.start;
        let abscissa =
            |e: &Envelope, i: usize| over.as_ref().map_or(start + e.t[i], |over| (over.value)(e, i));
        let line = |e: &Envelope| {
            let points: Vec<_> = (0..e.t.len()).map(|i| (abscissa(e, i), (shown.value)(e, i))).collect();
            let (mark, colour) = style(e.method);
            Layer::new(mark, colour, thin(&points, CURVE)).named(e.method.name())
        };
        let mut layers = Vec::new();
        if let (Some(sd), Some(e)) = (shown.sd, self.x.envelope()) {
            let edge = |sign: f64| {
                let points: Vec<_> = (0..e.t.len())
                    .map(|i| (abscissa(e, i), (shown.value)(e, i) + sign * DEVIATIONS * sd(e, i)))
                    .collect();
                thin(&points, CURVE)
            };
            let outline = edge(1.0).into_iter().chain(edge(-1.0).into_iter().rev()).collect();
            layers.push(Layer::new(Mark::Area, style(e.method).1, outline));
        }
        layers.extend(self.x.opinions.envelopes.iter().map(line));
        let x = over.map_or_else(|| Axis::linear("time", "s"), |over| over.axis);
        Figure { title: title.into(), caption: caption.into(), x, y: shown.axis, layers, marker: None }
    }

    /// Energy dissipated per cycle against force, with the fitted power law, a straight line on logarithmic axes.
    pub(crate) fn dissipation(&self) -> Figure {
        let c = &self.x.curves;
        let points: Vec<(f64, f64)> = c.force.iter().copied().zip(c.dissipation.iter().copied()).collect();
        let axis = if c.axis == iwan_ident::curves::ForceAxis::Modal { "modal force" } else { "joint force" };
        let mut layers = Vec::new();
        let mut caption = "Logarithmic on both axes.".to_string();
        if let Some(Line { slope, intercept }) = c.slope((0.0, f64::INFINITY)) {
            let ends = points.iter().fold((f64::INFINITY, 0.0_f64), |e, p| (e.0.min(p.0), e.1.max(p.0)));
            let line = [ends.0, ends.1].map(|f| (f, (intercept + slope * f.ln()).exp()));
            layers
                .push(Layer::new(Mark::Dashed, colour::GREY, line.into()).named(format!("slope {slope:.3}")));
            caption = format!(
                "Logarithmic on both axes. The slope is {slope:.3}: 2 for a viscous damper, \u{3c7} + 3 between 2 and 3 for \
                 an Iwan joint in micro-slip."
            );
        }
        layers.push(Layer::new(Mark::Dots, colour::BLUE, thin(&points, CURVE)).named(self.x.method.name()));
        Figure {
            title: "Dissipation per cycle against force".into(),
            caption,
            x: Axis::log(axis, &self.units.force),
            y: Axis::log("energy per cycle", &self.units.energy),
            layers,
            marker: None,
        }
    }
}

/// A pale area over the frequency band, from the lowest to the highest of the points.
fn pale((low, high): (f64, f64), points: &[(f64, f64)]) -> Layer {
    let positive = points.iter().map(|p| p.1).filter(|y| *y > 0.0);
    let (bottom, top) = positive.fold((f64::INFINITY, 0.0_f64), |e, y| (e.0.min(y), e.1.max(y)));
    Layer::new(Mark::Area, colour::ORANGE, vec![(low, bottom), (high, bottom), (high, top), (low, top)])
        .named("band")
}
