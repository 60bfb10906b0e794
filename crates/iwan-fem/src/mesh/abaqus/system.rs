//! `*SYSTEM` and the parameter SYSTEM of `*NODE`: positions of nodes in local coordinates.

use super::super::axes::{Axes, Coordinates};
use super::super::error::MeshError;
use super::fields::number;
use super::keyword::Keyword;
use super::lines::{Line, Lines};

/// Type of coordinates that the parameter SYSTEM of `*NODE` selects.
pub(super) fn coordinates(lines: &Lines, keyword: &Keyword) -> Result<Coordinates, MeshError> {
    match keyword.value("SYSTEM").map(str::to_ascii_uppercase).as_deref() {
        None if !keyword.has("SYSTEM") => Ok(Coordinates::Rectangular),
        Some("R") => Ok(Coordinates::Rectangular),
        Some("C") => Ok(Coordinates::Cylindrical),
        Some("S") => Ok(Coordinates::Spherical),
        other => {
            let found = format!("SYSTEM={} of *NODE", other.unwrap_or_default());
            Err(keyword.refused(lines.source, &found, "give R, C or S"))
        }
    }
}

/// Numbers of a line; none for an omitted number.
fn numbers<const N: usize>(lines: &Lines, line: &Line) -> Result<[Option<f64>; N], MeshError> {
    let mut out = [None; N];
    for (value, field) in out.iter_mut().zip(line.fields()) {
        if !field.is_empty() {
            *value = Some(number(lines.source, line, field, "a coordinate of *SYSTEM")?);
        }
    }
    Ok(out)
}

/// Reads `*SYSTEM`: point a is the origin, b lies on the local x-axis, c in the local xy-plane on the side of positive y. Without c the
/// z-axis stays global and the x-axis is projected into the global xy-plane; with a alone the axes are only moved; without any data the
/// axes are the global ones again (Abaqus Keywords Guide, *SYSTEM).
pub(super) fn read(lines: &mut Lines, keyword: &Keyword) -> Result<Axes, MeshError> {
    keyword.only(lines.source, &[])?;
    let Some(first) = lines.next_data() else { return Ok(Axes::default()) };
    let values: [Option<f64>; 6] = numbers(lines, &first)?;
    let point = |at: usize| -> [f64; 3] { std::array::from_fn(|a| values[at + a].unwrap_or(0.0)) };
    let origin = point(0);
    let second = lines.next_data();
    let flat = || {
        let expected = "points a, b and c that are not on one line";
        lines.source.malformed(keyword.place(lines.source), "*SYSTEM whose points span no plane", expected)
    };
    if values[3..].iter().all(Option::is_none) {
        return match second {
            None => Ok(Axes { origin, ..Axes::default() }),
            Some(_) => Err(flat()),
        };
    }
    let from_origin = |p: [f64; 3]| -> [f64; 3] { std::array::from_fn(|a| p[a] - origin[a]) };
    let along = from_origin(point(3));
    let axes = match second {
        Some(line) => {
            let third: [Option<f64>; 3] = numbers(lines, &line)?;
            Axes::spanned(origin, along, from_origin(third.map(|x| x.unwrap_or(0.0))))
        }
        None => Axes::spanned(origin, [along[0], along[1], 0.0], [-along[1], along[0], 0.0]),
    };
    axes.ok_or_else(flat)
}
