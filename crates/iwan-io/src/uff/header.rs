//! Records 1 to 11 of a dataset 58.

use super::nodal::NodalDirection;
use super::sections::Section;
use crate::assembly::units;
use crate::error::ReadError;
use crate::file_bytes::{FileBytes, decode};
use crate::quantity::Quantity;
use iwan_machine::{plain, shortened};

/// What the header of a dataset 58 says.
#[derive(Debug)]
pub(super) struct Header {
    id: String,
    response: String,
    /// Node and direction of the response.
    pub(super) response_at: NodalDirection,
    /// Node and direction of the reference.
    pub(super) reference_at: NodalDirection,
    pub(super) function_type: i64,
    /// 2 real single, 4 real double, 5 complex single, 6 complex double.
    pub(super) data_type: i64,
    /// Number of points that the header promises.
    pub(super) points: u64,
    pub(super) even: bool,
    pub(super) start: f64,
    pub(super) step: f64,
    abscissa_type: i64,
    pub(super) abscissa_unit: String,
    ordinate_type: i64,
    pub(super) ordinate_unit: String,
}

impl Header {
    pub(super) fn parse(source: &FileBytes, section: &Section) -> Result<Self, ReadError> {
        let line = |i: usize| plain(&decode(section.header[i]));
        let (dof, abscissa, ordinate) = (line(5), line(7), line(8));
        let form = line(6);
        let form: Vec<&str> = form.split_whitespace().collect();
        let number = |i: usize, what: &str| field(source, section, &form, i, what);
        let even = number(2, "abscissa spacing (0 or 1)")? != 0.0;
        let (start, step) =
            if even { (number(3, "first abscissa")?, number(4, "abscissa increment")?) } else { (0.0, 0.0) };
        Ok(Self {
            id: line(0).trim().into(),
            response: response(&dof),
            response_at: nodal(&dof, 41),
            reference_at: nodal(&dof, 66),
            function_type: integer(&dof, 0, 5),
            data_type: integer_field(&form, 0),
            points: form.get(1).and_then(|f| f.parse().ok()).unwrap_or(0),
            even,
            start,
            step,
            abscissa_type: integer(&abscissa, 0, 10),
            abscissa_unit: label(&abscissa, 47, 67),
            ordinate_type: integer(&ordinate, 0, 10),
            ordinate_unit: label(&ordinate, 47, 67),
        })
    }

    /// Name of the channel: the first identification line, else the response node, else a number.
    pub(super) fn name(&self, index: usize) -> String {
        [&self.id, &self.response]
            .into_iter()
            .find(|n| !is_none(n))
            .cloned()
            .unwrap_or_else(|| format!("channel {index}"))
    }

    /// Why the dataset is no real time history; none where it is one.
    pub(super) fn refusal(&self) -> Option<String> {
        if matches!(self.data_type, 5 | 6) {
            return Some("a complex function (a spectrum or frequency response, not a time history)".into());
        }
        if !matches!(self.function_type, 0 | 1) || self.abscissa_type == 18 {
            let kind = self.function_type;
            return Some(format!("a function of type {kind}, not a time response (type 1) over time"));
        }
        None
    }

    /// Whether the dataset is a real function of time.
    pub(super) fn is_over_time(&self) -> bool {
        self.refusal().is_none()
    }

    /// Quantity from the ordinate's data type (record 9, field 1), else from its unit.
    pub(super) fn quantity(&self) -> Quantity {
        match self.ordinate_type {
            3 => Quantity::Strain,
            8 => Quantity::Displacement,
            9 | 13 => Quantity::Force,
            11 => Quantity::Velocity,
            12 => Quantity::Acceleration,
            15 => Quantity::Pressure,
            _ => units::quantity_of_unit(&self.ordinate_unit),
        }
    }
}

fn field(
    source: &FileBytes,
    section: &Section,
    form: &[&str],
    i: usize,
    what: &str,
) -> Result<f64, ReadError> {
    let text = form.get(i).copied().unwrap_or("");
    text.replace(['D', 'd'], "e").parse().map_err(|_| {
        let place = format!("{}, record 7, field {}", section.place(), i + 1);
        let found = if text.is_empty() { "nothing".into() } else { format!("'{}'", shortened(text, 40)) };
        source.malformed(place, found, what)
    })
}

/// Entity name, node and direction of the response: record 6, Format(2(I5,I10),2(1X,10A1,I10,I4)).
fn response(dof: &str) -> String {
    let entity = columns(dof, 31, 41);
    let (node, direction) = (integer(dof, 41, 51), integer(dof, 51, 55));
    match (is_none(&entity), node) {
        (true, 0) => String::new(),
        (true, _) => format!("node {node} direction {direction}"),
        (false, _) => format!("{entity} {node} {direction}"),
    }
}

/// Node and direction that begin at column `at`, Format(I10,I4).
fn nodal(dof: &str, at: usize) -> NodalDirection {
    NodalDirection { node: integer(dof, at, at + 10), direction: integer(dof, at + 10, at + 14) }
}

fn is_none(text: &str) -> bool {
    text.is_empty() || text.eq_ignore_ascii_case("none")
}

fn label(line: &str, from: usize, to: usize) -> String {
    let text = columns(line, from, to);
    if is_none(&text) { String::new() } else { text }
}

fn columns(line: &str, from: usize, to: usize) -> String {
    let text: String = line.chars().skip(from).take(to - from).collect();
    text.trim().into()
}

fn integer(line: &str, from: usize, to: usize) -> i64 {
    columns(line, from, to).parse().unwrap_or(0)
}

fn integer_field(form: &[&str], i: usize) -> i64 {
    form.get(i).and_then(|f| f.parse().ok()).unwrap_or(0)
}
