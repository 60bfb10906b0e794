//! A mode shape as a drawing that the browser animates: the points at their positions from the table, or in a row where positions are missing.

use std::fmt::Write;

use iwan_modal::measure::Freedom;
use maud::{Markup, PreEscaped, html};

use super::geometry::Geometry;

/// Width and height of the drawing.
const SIZE: (f64, f64) = (560.0, 220.0);
/// Largest displacement as a part of the drawing's smaller side: the shape is visible, and the structure still recognisable.
const EXAGGERATION: f64 = 0.18;
/// Timing of the animation: 1.6 s per cycle can be followed with the eye; the motion is fast in the middle and slow at the ends, as in a vibration.
const TIMING: &str = "dur=\"1.6s\" repeatCount=\"indefinite\" calcMode=\"spline\" keyTimes=\"0;0.5;1\" keySplines=\"0.37 0 0.63 1;0.37 0 0.63 1\"";

/// A point of the drawing: its position at rest and its displacement.
struct Drawn {
    point: String,
    at: (f64, f64),
    step: (f64, f64),
    /// Whether its largest shape value is negative.
    negative: bool,
}

impl Drawn {
    /// The point at one end of its motion; `side` is 1 or -1.
    fn end(&self, side: f64) -> (f64, f64) {
        (self.at.0 + side * self.step.0, self.at.1 + side * self.step.1)
    }
}

/// The drawing of the real shape values `shape` at `freedoms`.
pub(super) fn draw(geometry: &Geometry, freedoms: &[Freedom], shape: &[f64], title: &str) -> Markup {
    let points = points(geometry, freedoms, shape);
    let mut drawing = String::new();
    let path = |side: f64| -> String {
        let place = |name: &String| points.iter().find(|p| p.point == *name).map(|p| p.end(side));
        let line = |[a, b]: &[String; 2]| {
            let ((x, y), (u, v)) = (place(a)?, place(b)?);
            Some(format!("M{x:.1} {y:.1}L{u:.1} {v:.1}"))
        };
        geometry.edges.iter().filter_map(line).collect()
    };
    let (there, back) = (path(1.0), path(-1.0));
    // Writing to a string cannot fail.
    if !there.is_empty() {
        let _ = write!(
            drawing,
            "<path d=\"{there}\" stroke=\"#7fb5d6\" fill=\"none\"><animate attributeName=\"d\" values=\"{there};{back};{there}\" {TIMING}/></path>"
        );
    }
    for p in &points {
        let ((x, y), there, back) = (p.at, p.end(1.0), p.end(-1.0));
        let _ = write!(
            drawing,
            "<line x1=\"{x:.1}\" y1=\"{y:.1}\" x2=\"{:.1}\" y2=\"{:.1}\" stroke=\"#b9c2cc\"/><circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"3\" fill=\"{}\">\
             <animate attributeName=\"cx\" values=\"{:.1};{:.1};{:.1}\" {TIMING}/>\
             <animate attributeName=\"cy\" values=\"{:.1};{:.1};{:.1}\" {TIMING}/></circle>",
            there.0,
            there.1,
            there.0,
            there.1,
            if p.negative { "#D55E00" } else { "#0072B2" },
            there.0,
            back.0,
            there.0,
            there.1,
            back.1,
            there.1
        );
    }
    html! {
        figure {
            figcaption { strong { (title) } }
            svg viewBox=(format!("0 0 {} {}", SIZE.0, SIZE.1)) role="img" aria-label=(title) { (PreEscaped(drawing)) }
        }
    }
}

/// The points in the units of the drawing, each displaced by the sum of the shape's values in all its directions.
fn points(geometry: &Geometry, freedoms: &[Freedom], shape: &[f64]) -> Vec<Drawn> {
    let places = places(geometry, freedoms);
    let (low, high) = places.iter().fold(([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]), |(a, b), p| {
        ([a[0].min(p[0]), a[1].min(p[1])], [b[0].max(p[0]), b[1].max(p[1])])
    });
    let room = [SIZE.0 * 0.84, SIZE.1 * 0.5];
    let scales = [0, 1].map(|i| if high[i] > low[i] { room[i] / (high[i] - low[i]) } else { f64::INFINITY });
    let scale = scales[0].min(scales[1]);
    let scale = if scale.is_finite() { scale } else { 1.0 };
    let largest = shape.iter().map(|x| x.abs()).fold(f64::MIN_POSITIVE, f64::max);
    let step = EXAGGERATION * SIZE.1 / largest;
    let mut points: Vec<Drawn> = Vec::new();
    for ((place, freedom), value) in places.iter().zip(freedoms).zip(shape) {
        let [dx, dy] = projected(axis(freedom)).map(|c| c * value * step);
        if let Some(known) = points.iter_mut().find(|p| p.point == freedom.point) {
            known.step = (known.step.0 + dx, known.step.1 - dy);
            continue;
        }
        let x = 0.5 * SIZE.0 + (place[0] - 0.5 * (low[0] + high[0])) * scale;
        let y = 0.5 * SIZE.1 - (place[1] - 0.5 * (low[1] + high[1])) * scale;
        points.push(Drawn {
            point: freedom.point.clone(),
            at: (x, y),
            step: (dx, -dy),
            negative: *value < 0.0,
        });
    }
    points
}

/// Positions of the points in the drawing: projected, or in a row in the order of the channels where a position is missing.
fn places(geometry: &Geometry, freedoms: &[Freedom]) -> Vec<[f64; 2]> {
    let position = |f: &Freedom| geometry.position(&f.point).map(projected);
    let all: Option<Vec<_>> = freedoms.iter().map(position).collect();
    all.unwrap_or_else(|| (0..freedoms.len()).map(|i| [i as f64, 0.0]).collect())
}

/// Projection from above and from the right: x points to the right, y backwards, z upwards.
fn projected([x, y, z]: [f64; 3]) -> [f64; 2] {
    [x + 0.35 * y, 0.3 * y + z]
}

/// Unit vector of a freedom; points without a direction move upwards.
fn axis(freedom: &Freedom) -> [f64; 3] {
    let sign = freedom.direction.sign();
    match freedom.direction.code().abs() {
        1 => [sign, 0.0, 0.0],
        2 => [0.0, sign, 0.0],
        _ => [0.0, 0.0, sign],
    }
}
