//! A mode shape as a drawing that moves in the browser: points where the table says they are, or in a row.

use std::fmt::Write;

use iwan_input::ModalTable;
use iwan_modal::measure::Freedom;
use maud::{Markup, PreEscaped, html};

/// Size of the drawing.
const SIZE: (f64, f64) = (560.0, 220.0);
/// Largest displacement over the smaller side of the drawing: a shape is seen, and the structure recognised.
const EXAGGERATION: f64 = 0.18;
/// Length of a cycle in the browser, s: slow enough to follow with the eye.
const CYCLE: f64 = 1.6;

/// The drawing of real shape values at freedoms.
pub(super) fn draw(table: &ModalTable, freedoms: &[Freedom], shape: &[f64], title: &str) -> Markup {
    let places = places(table, freedoms);
    let (low, high) = places.iter().fold(([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]), |(a, b), p| {
        ([a[0].min(p[0]), a[1].min(p[1])], [b[0].max(p[0]), b[1].max(p[1])])
    });
    let span = [high[0] - low[0], high[1] - low[1]];
    let room = [SIZE.0 * 0.84, SIZE.1 * 0.5];
    let scales = [0, 1].map(|i| if span[i] > 0.0 { room[i] / span[i] } else { f64::INFINITY });
    let scale = scales[0].min(scales[1]);
    let scale = if scale.is_finite() { scale } else { 1.0 };
    let largest = shape.iter().map(|x| x.abs()).fold(f64::MIN_POSITIVE, f64::max);
    let step = EXAGGERATION * SIZE.1 / largest;
    let mut drawing = String::new();
    for ((place, freedom), value) in places.iter().zip(freedoms).zip(shape) {
        let x = 0.5 * SIZE.0 + (place[0] - 0.5 * (low[0] + high[0])) * scale;
        let y = 0.5 * SIZE.1 - (place[1] - 0.5 * (low[1] + high[1])) * scale;
        let [dx, dy] = projected(axis(freedom)).map(|c| c * value * step);
        let (there, back) = ((x + dx, y - dy), (x - dx, y + dy));
        // Writing to a string cannot fail.
        let _ = write!(
            drawing,
            "<line x1=\"{x:.1}\" y1=\"{y:.1}\" x2=\"{:.1}\" y2=\"{:.1}\" stroke=\"#b9c2cc\"/><circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"3\" fill=\"{}\">\
             <animate attributeName=\"cx\" values=\"{:.1};{:.1};{:.1}\" dur=\"{CYCLE}s\" repeatCount=\"indefinite\" calcMode=\"spline\" keyTimes=\"0;0.5;1\" keySplines=\"0.37 0 0.63 1;0.37 0 0.63 1\"/>\
             <animate attributeName=\"cy\" values=\"{:.1};{:.1};{:.1}\" dur=\"{CYCLE}s\" repeatCount=\"indefinite\" calcMode=\"spline\" keyTimes=\"0;0.5;1\" keySplines=\"0.37 0 0.63 1;0.37 0 0.63 1\"/></circle>",
            there.0,
            there.1,
            there.0,
            there.1,
            if *value < 0.0 { "#D55E00" } else { "#0072B2" },
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

/// Where the points are drawn: projected positions, or a row in the order of the channels where a position is missing.
fn places(table: &ModalTable, freedoms: &[Freedom]) -> Vec<[f64; 2]> {
    let position =
        |f: &Freedom| table.points.iter().find(|p| p.name == f.point).map(|p| projected(p.position));
    let all: Option<Vec<_>> = freedoms.iter().map(position).collect();
    all.unwrap_or_else(|| (0..freedoms.len()).map(|i| [i as f64, 0.0]).collect())
}

/// Seen from above at the right: x to the right, y backwards, z upwards.
fn projected([x, y, z]: [f64; 3]) -> [f64; 2] {
    [x + 0.35 * y, 0.3 * y + z]
}

/// The direction of a freedom; points without one move upwards.
fn axis(freedom: &Freedom) -> [f64; 3] {
    let sign = freedom.direction.sign();
    match freedom.direction.code().abs() {
        1 => [sign, 0.0, 0.0],
        2 => [0.0, sign, 0.0],
        _ => [0.0, 0.0, sign],
    }
}
