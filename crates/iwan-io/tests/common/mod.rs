//! Small valid files of every format, built byte by byte.
#![allow(dead_code, unreachable_pub, clippy::unwrap_used)]

pub mod instruments;

use iwan_io::Table;
use std::io::{Cursor, Write};

/// `n` values of a decaying wave.
pub fn wave(n: usize) -> Vec<f64> {
    (0..n).map(|i| (0.3 * i as f64).sin() * (-0.01 * i as f64).exp()).collect()
}

/// `n` times of 1/128 s.
pub fn times(n: usize) -> Vec<f64> {
    (0..n).map(|i| i as f64 / 128.0).collect()
}

pub fn csv(n: usize) -> Vec<u8> {
    let (t, a) = (times(n), wave(n));
    let mut out = Vec::new();
    Table::new(vec![("t".into(), &t[..]), ("acc [m/s^2]".into(), &a[..])]).unwrap().csv_to(&mut out).unwrap();
    out
}

pub fn npz(n: usize) -> Vec<u8> {
    let (t, a) = (times(n), wave(n));
    let mut out = Cursor::new(Vec::new());
    Table::new(vec![("t".into(), &t[..]), ("acc".into(), &a[..])]).unwrap().npz_to(&mut out).unwrap();
    out.into_inner()
}

pub fn npy(descr: &str, fortran: bool, shape: &str, data: &[u8]) -> Vec<u8> {
    let fortran = if fortran { "True" } else { "False" };
    let text = format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}\n");
    let mut out = b"\x93NUMPY\x01\x00".to_vec();
    out.extend(u16::try_from(text.len()).unwrap().to_le_bytes());
    out.extend(text.bytes());
    out.extend(data);
    out
}

/// Two columns, time and channel, in C order.
pub fn npy_table(n: usize) -> Vec<u8> {
    let (t, a) = (times(n), wave(n));
    let data: Vec<u8> =
        t.iter().zip(&a).flat_map(|(t, a)| [t.to_le_bytes(), a.to_le_bytes()].concat()).collect();
    npy("<f8", false, &format!("({n}, 2)"), &data)
}

/// Header of a dataset 58 of `n` points: first line, ten identification and form lines, then data.
pub fn uff_header(first: &str, data_type: u8, n: usize, even: bool, name: &str) -> Vec<u8> {
    let (even, step) = if even { (1, "7.81250E-03") } else { (0, "0.00000E+00") };
    let axis =
        |code: u8, label: &str, unit: &str| format!("{code:>10}    0    0    0 {label:<20} {unit:<20}\n");
    let none = axis(0, "NONE", "NONE");
    format!(
        "    -1\n{first}\n{name}\nNONE\n01-Jan-26 00:00:00\nNONE\nNONE\n    1         0    0         0 NONE               1   3 NONE               0   0\n{data_type:>10}{n:>10}{even:>10}  0.00000E+00  {step}  0.00000E+00\n{}{}{none}{none}",
        axis(17, "Time", "s"),
        axis(12, "Acceleration", "m/s2"),
    )
    .into_bytes()
}

pub fn uff_ascii(n: usize, name: &str) -> Vec<u8> {
    let mut out = uff_header("    58", 2, n, true, name);
    for line in wave(n).chunks(6) {
        for v in line {
            write!(out, "{v:>13.5e}").unwrap();
        }
        out.push(b'\n');
    }
    out.extend(b"    -1\n");
    out
}

pub fn uff_binary(values: &[f64], big: bool, double: bool, name: &str) -> Vec<u8> {
    let size = if double { 8 } else { 4 };
    let order = if big { 2 } else { 1 };
    let bytes = size * values.len();
    let first = format!("    58b{order:>6}     2          11{bytes:>12}     0     0           0           0");
    let mut out = uff_header(&first, if double { 4 } else { 2 }, values.len(), true, name);
    for v in values {
        out.extend(number(*v, big, double));
    }
    out.extend(b"\n    -1\n");
    out
}

#[allow(clippy::cast_possible_truncation)] // single precision is meant
pub fn number(v: f64, big: bool, double: bool) -> Vec<u8> {
    match (big, double) {
        (false, true) => v.to_le_bytes().to_vec(),
        (true, true) => v.to_be_bytes().to_vec(),
        (false, false) => (v as f32).to_le_bytes().to_vec(),
        (true, false) => (v as f32).to_be_bytes().to_vec(),
    }
}

/// A level-5 data element in little or big endian.
pub fn element(code: u32, data: &[u8], big: bool) -> Vec<u8> {
    let mut out = [word(code, big), word(u32::try_from(data.len()).unwrap(), big)].concat();
    out.extend(data);
    if code != 15 {
        out.resize(out.len().next_multiple_of(8), 0);
    }
    out
}

pub fn word(v: u32, big: bool) -> Vec<u8> {
    if big { v.to_be_bytes().to_vec() } else { v.to_le_bytes().to_vec() }
}

fn head(class: u32, rows: usize, columns: usize, name: &str, big: bool) -> Vec<u8> {
    mat_head(class, &[rows, columns], name, big)
}

/// What an array of any class and dimensions begins with.
pub fn mat_head(class: u32, dims: &[usize], name: &str, big: bool) -> Vec<u8> {
    let dims: Vec<u8> = dims.iter().flat_map(|d| word(u32::try_from(*d).unwrap(), big)).collect();
    let flags = [word(class, big), word(0, big)].concat();
    [element(6, &flags, big), element(5, &dims, big), element(1, name.as_bytes(), big)].concat()
}

/// A double array (class 6) whose values are stored as type `code` in the bytes `data`.
pub fn mat_array(name: &str, rows: usize, columns: usize, code: u32, data: &[u8], big: bool) -> Vec<u8> {
    element(14, &[head(6, rows, columns, name, big), element(code, data, big)].concat(), big)
}

/// A struct of one element.
pub fn mat_struct(name: &str, fields: &[(&str, Vec<u8>)], big: bool) -> Vec<u8> {
    let mut out = head(2, 1, 1, name, big);
    let small = word((4 << 16) | 5, big);
    out.extend([small, word(32, big)].concat());
    let names: Vec<u8> = fields
        .iter()
        .flat_map(|(n, _)| {
            let mut padded = n.as_bytes().to_vec();
            padded.resize(32, 0);
            padded
        })
        .collect();
    out.extend(element(1, &names, big));
    for (_, field) in fields {
        out.extend(field);
    }
    element(14, &out, big)
}

pub fn mat_file(elements: &[Vec<u8>], compressed: bool, big: bool) -> Vec<u8> {
    let mut out = b"MATLAB 5.0 MAT-file".to_vec();
    out.resize(124, b' ');
    out.extend(if big { *b"\x01\x00MI" } else { *b"\x00\x01IM" });
    for e in elements {
        if compressed {
            let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
            encoder.write_all(e).unwrap();
            out.extend(element(15, &encoder.finish().unwrap(), big));
        } else {
            out.extend(e);
        }
    }
    out
}

/// A struct `d` with `time` and the nested `s.acc`.
pub fn mat(n: usize, compressed: bool, big: bool) -> Vec<u8> {
    let bytes = |v: &[f64]| -> Vec<u8> { v.iter().flat_map(|v| number(*v, big, true)).collect() };
    let time = mat_array("", 1, n, 9, &bytes(&times(n)), big);
    let acc = mat_array("", n, 1, 9, &bytes(&wave(n)), big);
    let inner = mat_struct("", &[("acc", acc)], big);
    mat_file(&[mat_struct("d", &[("time", time), ("s", inner)], big)], compressed, big)
}
