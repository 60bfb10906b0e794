//! Sec. 4 with Figs. 14 to 17: from hits to frequency responses, and from many sensors to dissipation against force.

use iwan_study::laboratory::{DrawnSensor, Hit, Laboratory, ModalTest, Table4Row};

use super::plate::{Plate, Section};
use super::units::ACCELERATION;
use crate::modal::composite;
use crate::page::decimate::{history, thin};
use crate::page::figure::{Axis, Figure, Layer, Mark, colour};

/// Most dots of a measured curve: three curves share a figure, whose axis is 494 units long.
const MEASURED: usize = 60;
/// Points of the envelope, a smooth line drawn over its history.
const ENVELOPE: usize = 120;
/// Number of stretches of a history; the smallest and the largest value of each are drawn: one stretch for each unit of the axis.
const BINS: usize = 500;
/// Duration for which the sensors are drawn beside each other, s: six cycles, so that single cycles can be told apart.
const STRETCH: f64 = 0.05;
/// Most points of that duration: 70 per cycle.
const CLOSE: usize = 500;

/// The laboratory's figures.
pub(super) fn plates(lab: &Laboratory) -> Vec<Plate> {
    let mut plates = Vec::new();
    let mut add = |id: &str, section, figure| plates.push(Plate { id: id.into(), section, figure });
    let (first, second) = (Section::Figures14And15, Section::Figures16And17);
    add("section-4-responses", first, responses(&lab.test));
    if let Some(loudest) = lab.hits.last() {
        add("figure-14-sensors", first, sensors(loudest));
        add("figure-14-misfit", first, misfit(loudest));
        add("figure-15-average", first, average(loudest));
        add("figure-15-frequency", first, frequency(lab));
    }
    add("figure-16-dissipation", second, dissipation(lab));
    add("figure-17-without-viscous", second, without_viscous(lab));
    add("table-4-slopes", second, slopes(lab));
    plates
}

/// Frequency responses of the modal test, the first step of the laboratory study.
fn responses(test: &ModalTest) -> Figure {
    Figure {
        title: "Sec. 4: frequency responses of the modal test".into(),
        caption: format!(
            "Root mean square over {} sensors, {} hits of {} N; the fit is that of mode isolation, all modes refined together.",
            test.responses.functions.len(),
            test.hits(),
            test.force
        ),
        y: Axis::log("acceleration per force", "m/s\u{b2}/N"),
        ..composite(&test.responses, &test.fit.fitted)
    }
}

/// The samples of a record, reduced to what is drawn; the interval is that of the hit.
fn drawn(hit: &Hit, samples: &[f64]) -> Vec<(f64, f64)> {
    history(samples, hit.dt, BINS)
}

fn sensors(hit: &Hit) -> Figure {
    let from = (hit.envelope.trusted.0 / hit.dt) as usize;
    let stretch = (STRETCH / hit.dt) as usize;
    let layer = |(n, DrawnSensor { name, samples }): (usize, &DrawnSensor)| {
        let part: Vec<(f64, f64)> =
            (from..(from + stretch).min(samples.len())).map(|i| (i as f64 * hit.dt, samples[i])).collect();
        Layer::new(if n % 2 == 0 { Mark::Line } else { Mark::Dashed }, colour::of(n), thin(&part, CLOSE))
            .named(name.clone())
    };
    Figure {
        title: format!("Fig. 14: sensors in the band, scaled, hit of {} N", hit.force),
        caption: "Band-passed accelerations over the mode's shape at each point: where the mode is alone they fall on one line. Points near a \
                  node of the mode have little to tell."
            .into(),
        x: Axis::linear("time", "s"),
        y: Axis::linear("modal acceleration q''", ACCELERATION),
        layers: hit.drawn.iter().enumerate().map(layer).collect(),
        marker: None,
    }
}

fn misfit(hit: &Hit) -> Figure {
    let points = hit.average.misfit.iter().enumerate().map(|(k, m)| ((k + 1) as f64, 100.0 * m)).collect();
    Figure {
        title: "Fig. 14: how well each sensor follows the average".into(),
        caption: "Root mean square of what differs from shape times average, over that: large at points near the nodes of the mode.".into(),
        x: Axis::linear("point", "number"),
        y: Axis::log("misfit", "%"),
        layers: vec![Layer::new(Mark::Dots, colour::BLUE, points).named("54 points")],
        marker: None,
    }
}

fn average(hit: &Hit) -> Figure {
    let side = |sign: f64| -> Vec<(f64, f64)> {
        let all: Vec<(f64, f64)> =
            hit.envelope.t.iter().zip(&hit.envelope.amplitude).map(|(t, a)| (*t, sign * a)).collect();
        thin(&all, ENVELOPE)
    };
    Figure {
        title: format!("Fig. 15: average of 54 sensors, hit of {} N", hit.force),
        caption: "With the envelope over the stretch that can be trusted: the rest is the filter's.".into(),
        x: Axis::linear("time", "s"),
        y: Axis::linear("modal acceleration q''", ACCELERATION),
        layers: vec![
            Layer::new(Mark::Line, colour::BLUE, drawn(hit, &hit.average.samples)).named("average"),
            Layer::new(Mark::Line, colour::VERMILLION, side(1.0)).named("envelope"),
            Layer::new(Mark::Line, colour::VERMILLION, side(-1.0)),
        ],
        marker: None,
    }
}

/// One layer of dots per hit.
fn of_hits(lab: &Laboratory, points: &dyn Fn(&Hit) -> Vec<(f64, f64)>) -> Vec<Layer> {
    let layer = |(n, hit): (usize, &Hit)| {
        Layer::new(Mark::Dots, colour::of(n), thin(&points(hit), MEASURED)).named(format!("{} N", hit.force))
    };
    lab.hits.iter().enumerate().map(layer).collect()
}

fn over_force(hit: &Hit, values: &[f64]) -> Vec<(f64, f64)> {
    hit.curves.force.iter().copied().zip(values.iter().copied()).filter(|p| p.1 > 0.0).collect()
}

fn frequency(lab: &Laboratory) -> Figure {
    Figure {
        title: "Fig. 15: frequency of mode 1".into(),
        caption: "Over the modal force, three hits.".into(),
        x: Axis::log("modal force", ACCELERATION),
        y: Axis::linear("frequency", "Hz"),
        layers: of_hits(lab, &|hit| over_force(hit, &hit.curves.frequency)),
        marker: None,
    }
}

fn dissipation(lab: &Laboratory) -> Figure {
    let mut layers = of_hits(lab, &|hit| over_force(hit, &hit.curves.dissipation));
    let given = lab.viscous();
    let viscous = lab.hits.iter().flat_map(|hit| {
        let left = hit.without(given);
        let c = &hit.curves;
        (0..c.t.len()).map(move |i| (c.force[i], c.dissipation[i] - left[i])).collect::<Vec<_>>()
    });
    let mut viscous: Vec<(f64, f64)> = viscous.collect();
    viscous.sort_by(|a, b| a.0.total_cmp(&b.0));
    layers.push(Layer::new(Mark::Dashed, colour::BLACK, thin(&viscous, MEASURED)).named("viscous term"));
    Figure {
        title: "Fig. 16: dissipation as measured".into(),
        caption: "The suspension's viscous term, of slope 2, rules at low force.".into(),
        x: Axis::log("modal force", ACCELERATION),
        y: Axis::log("dissipation per cycle", "J"),
        layers,
        marker: None,
    }
}

fn without_viscous(lab: &Laboratory) -> Figure {
    Figure {
        title: "Fig. 17: dissipation without the viscous term".into(),
        caption: "What is left is the joints'. From hit to hit one slope holds; within a record it is steeper, because the other modes fade.".into(),
        x: Axis::log("modal force", ACCELERATION),
        y: Axis::log("dissipation per cycle", "J"),
        layers: of_hits(lab, &|hit| over_force(hit, &hit.without(lab.viscous()))),
        marker: None,
    }
}

fn slopes(lab: &Laboratory) -> Figure {
    let layer = |name: &str, colour, mark, slope: &dyn Fn(&Table4Row) -> Option<f64>| {
        let points = lab.table_4.iter().filter_map(|row| Some((row.hit, slope(row)?))).collect();
        Layer::new(mark, colour, points).named(name)
    };
    Figure {
        title: "Table 4: slope against level".into(),
        caption: "Slope of ln D over ln force: within each record, and from the softer hit to this one at equal times.".into(),
        x: Axis::log("peak force of the hit", "N"),
        y: Axis::linear("slope", "1"),
        layers: vec![
            layer("within a record", colour::BLUE, Mark::Line, &|row| Some(row.slope)),
            layer("less viscous", colour::BLUE, Mark::Dashed, &|row| Some(row.slope_without_viscous)),
            layer("hit to hit", colour::VERMILLION, Mark::Line, &|row| row.step),
            layer("hit to hit, less viscous", colour::VERMILLION, Mark::Dashed, &|row| row.step_without_viscous),
        ],
        marker: None,
    }
}
