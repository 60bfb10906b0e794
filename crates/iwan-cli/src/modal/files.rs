//! The files of `iwan modal`: `frf.csv`, `shapes.csv`, `shapes.uff` and `geometry.unv`.

use std::collections::BTreeMap;

use iwan_io::write_uff::{
    ModalScale, NodalMode, Node, elements, functions, lines, modes, nodes, nodes_in_full,
};
use iwan_io::{NodalDirection, Quantity, UffFunction};
use iwan_machine::threads::in_parallel;
use iwan_modal::ModalFit;
use iwan_modal::measure::{Freedom, Motion};
use iwan_modal::modes::Scale;

use super::analysis::Level;
use super::geometry::Element;
use super::hits::{COLUMNS, Test};

/// Columns of the frequency responses in the band: the frequency (Hz), then for each function the real and imaginary part, those of the fit, and the
/// coherence.
pub(super) fn frf_columns(level: &Level) -> Vec<(String, Vec<f64>)> {
    let responses = &level.responses;
    let fitted = &level.fit.fitted;
    let lines = fitted.first..fitted.first + fitted.curves.first().map_or(0, Vec::len);
    let mut columns =
        vec![("frequency".to_string(), lines.clone().map(|k| responses.frequency(k)).collect())];
    for (n, f) in responses.functions.iter().enumerate() {
        let name = format!("{}/{}", f.response, f.force);
        columns.push((format!("{name} re"), f.values[lines.clone()].iter().map(|v| v.re).collect()));
        columns.push((format!("{name} im"), f.values[lines.clone()].iter().map(|v| v.im).collect()));
        let fitted = &fitted.curves[n];
        columns.push((format!("{name} fit re"), fitted.iter().map(|v| v.re).collect()));
        columns.push((format!("{name} fit im"), fitted.iter().map(|v| v.im).collect()));
        if !f.coherence.is_empty() {
            columns.push((format!("{name} coherence"), f.coherence[lines.clone()].to_vec()));
        }
    }
    columns
}

/// Columns of the shapes, as `--shapes` reads them: one row for each mode.
pub(super) fn shape_columns(fit: &ModalFit) -> Vec<(String, Vec<f64>)> {
    let own = [
        fit.modes.iter().map(|m| m.frequency).collect(),
        fit.modes.iter().map(|m| m.damping_ratio).collect(),
    ];
    let mut columns: Vec<(String, Vec<f64>)> = COLUMNS.map(String::from).into_iter().zip(own).collect();
    for (i, name) in fit.names.iter().enumerate() {
        columns.push((name.clone(), fit.modes.iter().map(|m| m.real_shape[i]).collect()));
    }
    columns
}

/// Universal file with points, shapes and frequency responses for other programs.
pub(super) fn universal(test: &Test, level: &Level, threads: usize) -> String {
    let numbers = Numbers::new(&level.fit);
    let positions = positions(test, &numbers);
    let mut text = if positions.is_empty() { String::new() } else { nodes(&positions) };
    let drawn = |[a, b]: &[String; 2]| Some(vec![numbers.get(a)?, numbers.get(b)?]);
    text += &lines(&test.geometry.edges.iter().filter_map(drawn).collect::<Vec<_>>());
    let scaled = level.fit.scale == Scale::DrivePoint;
    let mode = |m: &iwan_modal::modes::Mode| {
        let mut values: BTreeMap<i64, [[f64; 2]; 3]> = BTreeMap::new();
        for (freedom, value) in level.fit.freedoms.iter().zip(&m.shape) {
            let (Some(node), axis) =
                (numbers.get(&freedom.point), usize::from(freedom.direction.code().unsigned_abs()))
            else {
                continue;
            };
            // A point without a direction is written in the column of z; rotations have no column here.
            let column = if axis == 0 { 2 } else { axis - 1 };
            if let Some(entry) = values.entry(node).or_insert([[0.0; 2]; 3]).get_mut(column) {
                *entry = [value.re, value.im].map(|x| x * freedom.direction.sign());
            }
        }
        let (frequency, damping_ratio, pole) = (m.frequency, m.damping_ratio, [m.pole.re, m.pole.im]);
        // Modal a that fits the scale of these shapes, in which receptances are φ φᵀ/(2i ω_d (s - λ)).
        let scale = if scaled { ModalScale::A([0.0, 2.0 * m.pole.im]) } else { ModalScale::Unknown };
        NodalMode { frequency, damping_ratio, pole, scale, values: values.into_iter().collect() }
    };
    text += &modes(&level.fit.modes.iter().map(mode).collect::<Vec<_>>());
    // Each function becomes a text of its own, made in parallel: writing the digits takes most of the time here.
    let one = |function: &UffFunction| functions(std::slice::from_ref(function));
    text + &in_parallel(&responses(level, &numbers), threads, &one).concat()
}

/// Universal file of the points, in all their digits, and the elements between them: for programs that draw shapes, and for `--points`.
pub(super) fn geometry(test: &Test, level: &Level) -> String {
    let numbers = Numbers::new(&level.fit);
    let of = |element: &Element| {
        let nodes = element.points.iter().map(|p| numbers.get(p)).collect::<Option<Vec<i64>>>()?;
        Some((element.kind, nodes))
    };
    let elements_measured: Vec<_> = test.geometry.elements.iter().filter_map(of).collect();
    let text = nodes_in_full(&positions(test, &numbers));
    if elements_measured.is_empty() { text } else { text + &elements(&elements_measured) }
}

/// Points that were measured and whose positions are known.
fn positions(test: &Test, numbers: &Numbers) -> Vec<Node> {
    let points = test.geometry.points.iter();
    points.filter_map(|p| Some(Node { number: numbers.get(&p.name)?, position: p.position })).collect()
}

fn responses(level: &Level, numbers: &Numbers) -> Vec<UffFunction> {
    let at = |f: &Freedom| NodalDirection {
        node: numbers.get(&f.point).unwrap_or(0),
        direction: i64::from(f.direction.code()),
    };
    let quantity = match level.responses.motion {
        Motion::Displacement => Quantity::Displacement,
        Motion::Velocity => Quantity::Velocity,
        Motion::Acceleration => Quantity::Acceleration,
    };
    let function = |f: &iwan_modal::responses::Function| UffFunction {
        name: f.name.clone(),
        kind: 4,
        response: at(&f.response),
        reference: at(&f.force),
        quantity,
        unit: String::new(),
        start: 0.0,
        step: level.responses.step,
        re: f.values.iter().map(|v| v.re).collect(),
        im: f.values.iter().map(|v| v.im).collect(),
    };
    level.responses.functions.iter().map(function).collect()
}

/// Node numbers of points: the points' own names where all are whole numbers > 0, else 1, 2, … in the order of the shapes.
struct Numbers(BTreeMap<String, i64>);

impl Numbers {
    fn new(fit: &ModalFit) -> Self {
        let mut points: Vec<&String> = Vec::new();
        for point in fit.freedoms.iter().map(|f| &f.point) {
            if !points.contains(&point) {
                points.push(point);
            }
        }
        let own: Option<Vec<i64>> = points.iter().map(|p| p.parse().ok().filter(|n| *n > 0)).collect();
        let numbers = own.unwrap_or_else(|| (1_i64..).take(points.len()).collect());
        Self(points.into_iter().cloned().zip(numbers).collect())
    }

    fn get(&self, point: &str) -> Option<i64> {
        self.0.get(point).copied()
    }
}
