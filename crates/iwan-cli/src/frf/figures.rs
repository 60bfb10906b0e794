//! The figures of forced responses: amplitude and phase over frequency with the backbone on top, excitation, loops.

use iwan_sim::{Control, SteadyCurve, SteadyPoint};

use super::loops::{Loop, level};
use super::responses::Response;
use crate::page::figure::{Axis, Figure, Layer, Mark, colour};

/// Most levels that have a name in the legend: more would cover the plane.
const NAMED: usize = 8;

/// All figures of a mode.
pub(super) fn figures(response: &Response) -> Vec<Figure> {
    let held = response.curves.first().is_some_and(|curve| curve.control.holds_response());
    let mut figures = if held {
        vec![excitation(response), receptance(response), phase(response)]
    } else {
        vec![amplitude(response), phase(response), receptance(response)]
    };
    figures.extend(harmonics(response));
    figures.extend(loops(response));
    figures
}

/// One line per level.
fn lines(response: &Response, y: impl Fn(&SteadyPoint) -> f64) -> Vec<Layer> {
    let line = |(n, curve): (usize, &SteadyCurve)| {
        let points = curve.points.iter().map(|point| (point.frequency, y(point))).collect();
        let layer = Layer::new(Mark::Line, colour::of(n), points);
        if n < NAMED { layer.named(level(curve)) } else { layer }
    };
    response.curves.iter().enumerate().map(line).collect()
}

fn frequency() -> Axis {
    Axis::linear("frequency", "Hz")
}

fn amplitude(response: &Response) -> Figure {
    let mut layers = lines(response, |point| point.amplitude);
    // Backbones are cut to the frequencies of the curves: the parts beyond would squeeze the curves together.
    let all = || response.curves.iter().flat_map(|curve| &curve.points).map(|point| point.frequency);
    let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max));
    for (n, backbone) in response.backbones.iter().enumerate() {
        let within = backbone.iter().copied().filter(|point| (low..=high).contains(&point.0)).collect();
        let layer = Layer::new(Mark::Dashed, colour::BLACK, within);
        layers.push(if n == 0 { layer.named("backbone") } else { layer });
    }
    if let Some([_, to]) = response.informed {
        let limit = Layer::new(Mark::Dashed, colour::GREY, vec![(low, to), (high, to)]);
        layers.push(limit.named("largest amplitude of the records"));
    }
    let jumps: Vec<(f64, f64)> = (response.curves.iter())
        .flat_map(|curve| curve.jumps().into_iter().map(|jump| (jump.frequency, jump.amplitude)))
        .collect();
    if !jumps.is_empty() {
        layers.push(Layer::new(Mark::Dots, colour::BLACK, jumps).named("jump"));
    }
    Figure {
        title: "Amplitude".into(),
        caption: "Amplitude of the first harmonic. Dashed: frequency of the mode against its amplitude, which the peaks \
            follow; where a curve turns back (circles), a response to a creeping frequency jumps."
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

/// Amplitudes of the higher harmonics at the last level, with their superharmonic resonances marked; none with one harmonic.
fn harmonics(response: &Response) -> Option<Figure> {
    let curve = response.curves.last()?;
    let count = curve.points.first()?.harmonics.len();
    if count == 0 {
        return None;
    }
    let layer = |index: usize| {
        let points = curve.points.iter().map(|point| (point.frequency, point.harmonics[index][0]));
        Layer::new(Mark::Line, colour::of(index), points.filter(|point| point.1 > 0.0).collect())
            .named(format!("harmonic {}", 2 * index + 3))
    };
    let mut layers: Vec<Layer> = (0..count).map(layer).collect();
    let resonances: Vec<(f64, f64)> =
        curve.superharmonics().into_iter().map(|s| (s.frequency, s.amplitude)).collect();
    if !resonances.is_empty() {
        layers.push(Layer::new(Mark::Dots, colour::BLACK, resonances).named("superharmonic resonance"));
    }
    Some(Figure {
        title: "Harmonics".into(),
        caption: format!(
            "Amplitudes of the higher harmonics at {}. Circles: a harmonic in resonance with a mode, which its phase tells from \
             one that is large because the fundamental is.",
            level(curve)
        ),
        x: frequency(),
        y: Axis::log("amplitude", ""),
        layers,
        marker: None,
    })
}

/// Hysteresis loops of the joints.
fn loops(response: &Response) -> Option<Figure> {
    let layer = |(n, one): (usize, &Loop)| {
        Layer::new(Mark::Line, colour::of(n), one.points()).named(one.name.clone())
    };
    let layers: Vec<Layer> = response.loops.iter().take(NAMED).enumerate().map(layer).collect();
    if layers.is_empty() {
        return None;
    }
    let (which, slip) = match response.curves.last() {
        Some(last) if response.loops.iter().all(|one| one.name != level(last)) => {
            (format!("Loops of the joints that slip most at the peak under {}", level(last)), "slip s")
        }
        _ => (
            "Loop of the joint at the peak of each level".into(),
            "slip s (of a mode's own joint: its displacement q)",
        ),
    };
    Some(Figure {
        title: "Slip in the joints".into(),
        caption: format!(
            "{which}, less the line of the stuck joint: the area is the energy lost in a cycle. Drawn for the slip's first harmonic."
        ),
        x: Axis::linear(slip, ""),
        y: Axis::linear("F \u{2212} K_T s", ""),
        layers,
        marker: None,
    })
}
