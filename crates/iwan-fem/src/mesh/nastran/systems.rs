//! `CORD2R`, `CORD2C` and `CORD2S`: coordinate systems, each defined in another one.

use std::collections::BTreeMap;

use super::super::axes::{Axes, Coordinates};
use super::super::error::MeshError;
use super::super::file::FileBytes;
use super::card::Card;

/// A coordinate system in global axes.
#[derive(Debug, Clone, Copy)]
pub(super) struct System {
    pub(super) axes: Axes,
    pub(super) kind: Coordinates,
}

/// Systems by number; 0 is the global system.
pub(super) type Systems = BTreeMap<i64, System>;

impl System {
    pub(super) fn global(&self, local: [f64; 3]) -> [f64; 3] {
        self.axes.global(self.kind.rectangular(local))
    }

    /// Directions of the system's components at a point: for cylindrical and spherical systems along the radius and along the angles or the
    /// axis.
    pub(super) fn directions(&self, at: [f64; 3]) -> [[f64; 3]; 3] {
        let [x, y, z] = self.axes.directions;
        let arm: [f64; 3] = std::array::from_fn(|i| at[i] - self.axes.origin[i]);
        let along = |d: [f64; 3]| arm.iter().zip(d).map(|(a, b)| a * b).sum::<f64>();
        let (p, q, r) = (along(x), along(y), along(z));
        let flat = p.hypot(q);
        // On the axis the radius has no direction; Nastran uses the direction of angle zero.
        let (cos, sin) = if flat > 0.0 { (p / flat, q / flat) } else { (1.0, 0.0) };
        let mix = |a: f64, b: f64, c: f64| std::array::from_fn(|i| a * x[i] + b * y[i] + c * z[i]);
        match self.kind {
            Coordinates::Rectangular => [x, y, z],
            Coordinates::Cylindrical => [mix(cos, sin, 0.0), mix(-sin, cos, 0.0), z],
            Coordinates::Spherical | Coordinates::Colatitude => {
                let length = flat.hypot(r);
                let (down, out) = if length > 0.0 { (r / length, flat / length) } else { (1.0, 0.0) };
                [mix(out * cos, out * sin, down), mix(down * cos, down * sin, -out), mix(-sin, cos, 0.0)]
            }
        }
    }
}

/// All systems, transformed to global axes.
pub(super) fn resolve(source: FileBytes, cards: &BTreeMap<i64, Card>) -> Result<Systems, MeshError> {
    let mut systems = Systems::new();
    systems.insert(0, System { axes: Axes::default(), kind: Coordinates::Rectangular });
    // Each round resolves the systems whose reference system is known.
    let mut open: Vec<(&i64, &Card)> = cards.iter().collect();
    while !open.is_empty() {
        let before = open.len();
        let mut later = Vec::new();
        for (number, card) in open {
            match systems.get(&card.integer(source, 1, Some(0))?).copied() {
                Some(base) => {
                    systems.insert(*number, read(source, card, base)?);
                }
                None => later.push((number, card)),
            }
        }
        open = later;
        if open.len() == before {
            let card = open[0].1;
            let found = format!("system {} in system {:?}", open[0].0, card.field(1));
            return Err(card.malformed(source, found, "a system that is defined, and not in a circle"));
        }
    }
    Ok(systems)
}

/// Reads a system by its origin A, a point B on the z-axis and a point C in the xz-plane.
fn read(source: FileBytes, card: &Card, base: System) -> Result<System, MeshError> {
    let kind = match card.name.as_str() {
        "CORD2R" => Coordinates::Rectangular,
        "CORD2C" => Coordinates::Cylindrical,
        _ => Coordinates::Colatitude,
    };
    let mut points = [[0.0; 3]; 3];
    for (k, point) in points.iter_mut().enumerate() {
        for (axis, value) in point.iter_mut().enumerate() {
            *value = card.real(source, 2 + 3 * k + axis, Some(0.0))?;
        }
        *point = base.global(*point);
    }
    let [a, b, c] = points;
    let minus = |p: [f64; 3]| -> [f64; 3] { std::array::from_fn(|i| p[i] - a[i]) };
    // Spanning with z first gives the directions (z, x, z × x = y); they are reordered to x, y, z.
    let spanned = Axes::spanned(a, minus(b), minus(c));
    let Some(Axes { origin, directions: [z, x, y] }) = spanned else {
        return Err(card.malformed(
            source,
            "three points on one line",
            "points A, B and C that span a plane",
        ));
    };
    Ok(System { axes: Axes { origin, directions: [x, y, z] }, kind })
}
