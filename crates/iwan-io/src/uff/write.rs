//! Writes universal files as text: points (datasets 15 and 2411), lines between them (82), elements (2412), mode shapes (55) and functions
//! (58).
//!
//! Layouts after the pages of the Structural Dynamics Research Laboratory, University of Cincinnati.

use std::fmt::Write;

use iwan_machine::threads::{at_once, in_parallel};

use super::functions::UffFunction;
use super::model::BEAMS;
pub use super::nodal::{ModalScale, NodalMode, NodalValues, Node};
use crate::quantity::Quantity;

const MARK: &str = "    -1\n";

/// Points as dataset 15.
///
/// ```
/// let text = iwan_io::write_uff::nodes(&[iwan_io::write_uff::Node { number: 7, position: [0.0, 0.5, 1.0] }]);
/// assert_eq!(text.lines().nth(2), Some("         7         0         0         8  0.00000E+00  5.00000E-01  1.00000E+00"));
/// ```
#[must_use]
pub fn nodes(nodes: &[Node]) -> String {
    let mut text = format!("{MARK}    15\n");
    for node in nodes {
        let [x, y, z] = node.position.map(|x| real(x, 13, 5));
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{:>10}{:>10}{:>10}{:>10}{x}{y}{z}", node.number, 0, 0, 8);
    }
    text + MARK
}

/// Points as dataset 2411, whose seventeen digits restore every bit of the coordinates.
///
/// ```
/// let text = iwan_io::write_uff::nodes_in_full(&[iwan_io::write_uff::Node { number: 7, position: [0.0, 0.1, 1.0] }]);
/// assert_eq!(text.lines().nth(3), Some("   0.0000000000000000D+00   1.0000000000000001D-01   1.0000000000000000D+00"));
/// ```
#[must_use]
pub fn nodes_in_full(nodes: &[Node]) -> String {
    let mut text = format!("{MARK}  2411\n");
    for node in nodes {
        let [x, y, z] = node.position.map(|x| real(x, 25, 16).replace('E', "D"));
        // Writing to a string cannot fail. Coordinate systems of position and displacement are the global one (0); the colour is 11 as in
        // other programs' files.
        let _ = writeln!(text, "{:>10}{:>10}{:>10}{:>10}\n{x}{y}{z}", node.number, 0, 0, 11);
    }
    text + MARK
}

/// Elements as dataset 2412; each is the code of its kind, such as [`ROD`](crate::ROD), and its nodes.
///
/// ```
/// let text = iwan_io::write_uff::elements(&[(44, vec![1, 2, 3, 4])]);
/// assert_eq!(text.lines().nth(3), Some("         1         2         3         4"));
/// ```
#[must_use]
pub fn elements(elements: &[(i64, Vec<i64>)]) -> String {
    let mut text = format!("{MARK}  2412\n");
    for (n, (kind, nodes)) in elements.iter().enumerate() {
        // Writing to a string cannot fail. The tables of properties and material have number 1, the colour is 7.
        let _ = writeln!(text, "{:>10}{kind:>10}{:>10}{:>10}{:>10}{:>10}", n + 1, 1, 1, 7, nodes.len());
        if BEAMS.contains(kind) {
            // No node of orientation; cross-section 1 at both ends.
            let _ = writeln!(text, "{:>10}{:>10}{:>10}", 0, 1, 1);
        }
        for nodes in nodes.chunks(8) {
            text.extend(nodes.iter().map(|node| format!("{node:>10}")));
            text += "\n";
        }
    }
    text + MARK
}

/// Lines from node to node as datasets 82; other programs draw these.
///
/// ```
/// let text = iwan_io::write_uff::lines(&[vec![1, 2, 3]]);
/// assert_eq!(text.lines().nth(4), Some("         1         2         3"));
/// ```
#[must_use]
pub fn lines(lines: &[Vec<i64>]) -> String {
    let mut text = String::new();
    for (n, line) in lines.iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{MARK}    82\n{:>10}{:>10}{:>10}\nline {}", n + 1, line.len(), 1, n + 1);
        for nodes in line.chunks(8) {
            for node in nodes {
                let _ = write!(text, "{node:>10}");
            }
            text += "\n";
        }
        text += MARK;
    }
    text
}

/// Mode shapes as datasets 55, complex, three translations a node.
///
/// ```
/// let mode = iwan_io::write_uff::NodalMode {
///     frequency: 120.0, damping_ratio: 0.01, pole: [-7.5, 754.0], scale: iwan_io::write_uff::ModalScale::Unknown, values: vec![(3, [[0.0; 2], [0.0; 2], [1.0, 0.5]])],
/// };
/// let text = iwan_io::write_uff::modes(&[mode]);
/// assert!(text.lines().nth(1) == Some("    55") && text.contains("  1.00000E+00  5.00000E-01"));
/// ```
#[must_use]
pub fn modes(modes: &[NodalMode]) -> String {
    let mut text = String::new();
    for (n, mode) in modes.iter().enumerate() {
        let _ = write!(text, "{MARK}    55\nmode {}\nNONE\nNONE\nNONE\nNONE\n", n + 1);
        // Structural, complex eigenvalue of first order, three translations, displacement, complex, three values a node.
        let _ = writeln!(text, "{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}", 1, 3, 2, 8, 5, 3);
        let _ = writeln!(text, "{:>10}{:>10}{:>10}{:>10}", 2, 6, 1, n + 1);
        let [re, im] = mode.pole;
        let a = match mode.scale {
            ModalScale::Unknown => [0.0; 2],
            // Modal A of a real mode with this modal mass.
            ModalScale::Mass(mass) => [0.0, 2.0 * mass * im],
            ModalScale::A(a) => a,
        };
        // Modal B is -λ A.
        let b = [im * a[1] - re * a[0], -(re * a[1] + im * a[0])];
        let line: String = [mode.pole, a, b].iter().flatten().map(|x| real(*x, 13, 5)).collect();
        let _ = writeln!(text, "{line}");
        for (node, values) in &mode.values {
            let line: String = values.iter().flatten().map(|x| real(*x, 13, 5)).collect();
            let _ = writeln!(text, "{node:>10}\n{line}");
        }
        text += MARK;
    }
    text
}

/// Functions as datasets 58 in double precision, over an even abscissa.
#[must_use]
pub fn functions(functions: &[UffFunction]) -> String {
    // Most of the time goes into the digits of tens of thousands of values a function.
    in_parallel(functions, at_once(), &function).concat()
}

/// A function as a dataset 58.
fn function(f: &UffFunction) -> String {
    let mut text = String::new();
    let complex = !f.im.is_empty();
    let time = f.kind == 1;
    let _ = write!(text, "{MARK}    58\n{}\nNONE\nNONE\nNONE\nNONE\n", f.name);
    let (a, b) = (f.response, f.reference);
    let _ = writeln!(
        text,
        "{:>5}{:>10}{:>5}{:>10} {:<10}{:>10}{:>4} {:<10}{:>10}{:>4}",
        f.kind, 0, 1, 0, "NONE", a.node, a.direction, "NONE", b.node, b.direction
    );
    let _ = writeln!(
        text,
        "{:>10}{:>10}{:>10}{}{}{}",
        if complex { 6 } else { 4 },
        f.re.len(),
        1,
        real(f.start, 13, 5),
        real(f.step, 13, 5),
        real(0.0, 13, 5)
    );
    let axis = |kind: i32, label: &str, unit: &str| {
        format!("{kind:>10}{:>5}{:>5}{:>5} {label:<20} {unit:<20}\n", 0, 0, 0)
    };
    text += &if time { axis(17, "Time", "s") } else { axis(18, "Frequency", "Hz") };
    text += &axis(code(f.quantity), "NONE", if f.unit.is_empty() { "NONE" } else { &f.unit });
    text += &if time { axis(0, "NONE", "NONE") } else { axis(13, "NONE", "NONE") };
    text += &axis(0, "NONE", "NONE");
    let values: Vec<f64> =
        if complex { f.re.iter().zip(&f.im).flat_map(|(a, b)| [*a, *b]).collect() } else { f.re.clone() };
    // Twenty characters for each value, and a line end for each four values.
    text.reserve(21 * values.len() + 100);
    for line in values.chunks(4) {
        for x in line {
            add_real(&mut text, *x, 20, 12);
        }
        text.push('\n');
    }
    text += MARK;
    text
}

/// The format's number for a quantity.
const fn code(quantity: Quantity) -> i32 {
    match quantity {
        Quantity::Strain => 3,
        Quantity::Displacement => 8,
        Quantity::Force => 13,
        Quantity::Velocity => 11,
        Quantity::Acceleration => 12,
        Quantity::Pressure => 15,
        Quantity::Voltage | Quantity::Unknown => 0,
    }
}

/// A number in Fortran's E format: sign, digits, and an exponent of at least two digits.
fn real(value: f64, width: usize, digits: usize) -> String {
    let mut text = String::with_capacity(width);
    add_real(&mut text, value, width, digits);
    text
}

/// Appends a number in Fortran's E format to a text.
fn add_real(text: &mut String, value: f64, width: usize, digits: usize) {
    let begin = text.len();
    // The exponent that Rust writes has neither a plus nor a leading zero, and at most three digits. Writing to a string cannot fail.
    let _ = write!(text, "{value:>width$.digits$E}");
    let written = &text.as_bytes()[begin..];
    let Some(e) = written.iter().rposition(|b| *b == b'E') else { return };
    let negative = written.get(e + 1) == Some(&b'-');
    let size = written.len() - e - 1 - usize::from(negative);
    let missing = usize::from(!negative) + usize::from(size < 2);
    // The plus and the zero that are inserted replace leading blanks.
    let blanks = written.iter().take_while(|b| **b == b' ').count().min(missing);
    if !negative {
        text.insert(begin + e + 1, '+');
    }
    if size < 2 {
        text.insert(begin + e + 2, '0');
    }
    text.replace_range(begin..begin + blanks, "");
}

#[cfg(test)]
mod tests {
    use super::super::functions::functions as read;
    use super::super::nodal::NodalDirection;
    use super::*;

    #[test]
    fn reals_are_as_fortran_writes_them() {
        for (value, text) in [
            (0.0, "  0.00000E+00"),
            (-1.5, " -1.50000E+00"),
            (2e-7, "  2.00000E-07"),
            (-3e12, " -3.00000E+12"),
            (9.999999e99, " 1.00000E+100"),
            (-2e-300, "-2.00000E-300"),
            (f64::INFINITY, "          inf"),
        ] {
            assert_eq!(real(value, 13, 5), text);
        }
        assert_eq!(real(-1e-300, 5, 5), "-1.00000E-300");
        let mut text = "before".to_string();
        add_real(&mut text, 0.25, 20, 12);
        assert_eq!(text, "before  2.500000000000E-01");
    }

    #[test]
    fn what_is_written_is_read_again() {
        let at = |node, direction| NodalDirection { node, direction };
        let function = |kind, im: Vec<f64>| UffFunction {
            name: "point 3".into(),
            kind,
            response: at(3, -2),
            reference: at(11, 3),
            quantity: Quantity::Velocity,
            unit: "m/s".into(),
            start: 0.0,
            step: 0.25,
            re: vec![1.5, -2e-7, 3e12, 0.0, 1.0],
            im,
        };
        let all = [function(1, Vec::new()), function(4, vec![0.1, 2e-300, -3.0, 4.0, 5.0])];
        let (found, warnings) = read("x.uff".as_ref(), functions(&all).as_bytes()).unwrap();
        assert_eq!((found.as_slice(), warnings.len()), (all.as_slice(), 0));
    }

    #[test]
    fn numbers_fill_their_columns() {
        assert_eq!(real(-1.0, 13, 5), " -1.00000E+00");
        assert_eq!(real(2.5e-120, 13, 5), " 2.50000E-120");
        assert_eq!(real(0.0, 20, 12).len(), 20);
    }
}
