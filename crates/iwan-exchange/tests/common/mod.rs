//! One symmetric matrix of seven rows, written in every format.

#![allow(clippy::cast_possible_wrap)] // orders and lengths here are below a hundred
#![allow(unreachable_pub, reason = "shared by test files")]
#![allow(dead_code, reason = "not every test file needs all writers")]
#![allow(clippy::unwrap_used)]
#![allow(clippy::format_collect, clippy::format_push_string, reason = "files of the tests are short")]

pub mod packed;

use iwan_exchange::{Component, Entry, Label};
use packed::{mat_7_3, netcdf};

pub const ORDER: usize = 7;

/// Its lower triangle, column by column; numbers that single precision holds exactly.
pub fn lower() -> Vec<Entry> {
    vec![
        (0, 0, 12.5),
        (1, 0, -3.25),
        (4, 0, 0.125),
        (1, 1, 9.0),
        (2, 1, -1.5),
        (2, 2, 1048576.0),
        (3, 3, 2.0),
        (4, 3, -0.5),
        (4, 4, 7.0),
        (5, 4, 1.0),
        (6, 4, -2.0),
        (5, 5, 4.0),
        (6, 6, 5.0),
    ]
}

/// Both triangles, column by column, rows ascending.
pub fn all() -> Vec<Entry> {
    let mut entries: Vec<Entry> = lower()
        .iter()
        .flat_map(|&(i, j, v)| if i == j { vec![(i, j, v)] } else { vec![(i, j, v), (j, i, v)] })
        .collect();
    entries.sort_by_key(|e| (e.1, e.0));
    entries
}

/// What the rows are: nodes 3, 10 and 21.
pub fn labels() -> Vec<Label> {
    let label = |node, number| Label { node, component: Component::numbered(number).unwrap() };
    vec![label(3, 1), label(3, 2), label(3, 3), label(10, 1), label(10, 2), label(10, 6), label(21, 0)]
}

/// Strings of a column: first row (from 1) and values without gaps.
fn strings(column: u32) -> Vec<(usize, Vec<f64>)> {
    let mut out: Vec<(usize, Vec<f64>)> = Vec::new();
    for (i, j, v) in all() {
        if j != column {
            continue;
        }
        match out.last_mut() {
            Some((first, values)) if *first + values.len() == i as usize + 1 => values.push(v),
            _ => out.push((i as usize + 1, vec![v])),
        }
    }
    out
}

/// A column from its first to its last entry.
fn dense(column: u32) -> (usize, Vec<f64>) {
    let parts = strings(column);
    let (first, last) = (parts[0].0, parts.last().map(|(row, v)| row + v.len()).unwrap());
    let mut values = vec![0.0; last - first];
    for (row, part) in parts {
        values[row - first..row - first + part.len()].copy_from_slice(&part);
    }
    (first, values)
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    Dense,
    BigMat,
    Packed,
}

pub const LAYOUTS: [Layout; 3] = [Layout::Dense, Layout::BigMat, Layout::Packed];

pub fn op4_text(layout: Layout, single: bool) -> String {
    let rows = if layout == Layout::BigMat { -(ORDER as i64) } else { ORDER as i64 };
    let kind = if single { 1 } else { 2 };
    let words = if single { 1 } else { 2 };
    let mut text = format!("{ORDER:8}{rows:8}{:8}{kind:8}{:8}1P,3E24.16\n", 6, "KAA");
    let lines = |values: &[f64]| -> String {
        values
            .chunks(3)
            .map(|three| three.iter().map(|v| format!("{:>24}", fortran(*v))).collect::<String>() + "\n")
            .collect()
    };
    for column in 0..ORDER as u32 {
        if layout == Layout::Dense {
            let (first, values) = dense(column);
            text += &format!("{:8}{first:8}{:8}\n{}", column + 1, values.len(), lines(&values));
            continue;
        }
        let parts = strings(column);
        let head = if layout == Layout::BigMat { 2 } else { 1 };
        let total: usize = parts.iter().map(|(_, v)| v.len() * words + head).sum();
        text += &format!("{:8}{:8}{total:8}\n", column + 1, 0);
        for (row, values) in parts {
            let length = values.len() * words + 1;
            text += &if layout == Layout::BigMat {
                format!("{length:8}{row:8}\n")
            } else {
                format!("{:8}\n", (length << 16) + row)
            };
            text += &lines(&values);
        }
    }
    text + &format!("{:8}{:8}{:8}\n{:>24}\n", ORDER + 1, 1, 1, fortran(1.0))
}

fn fortran(value: f64) -> String {
    with_exponent(&format!("{value:.16E}"))
}

/// With an exponent of two digits and its sign.
fn with_exponent(text: &str) -> String {
    let (digits, exponent) = text.split_once('E').unwrap();
    let exponent: i32 = exponent.parse().unwrap();
    format!("{digits}E{}{:02}", if exponent < 0 { '-' } else { '+' }, exponent.abs())
}

pub fn op4_binary(layout: Layout, single: bool, big: bool, word: usize) -> Vec<u8> {
    let int = |n: i64| -> Vec<u8> {
        match (word, big) {
            (8, true) => n.to_be_bytes().into(),
            (8, false) => n.to_le_bytes().into(),
            (_, true) => (n as i32).to_be_bytes().into(),
            (_, false) => (n as i32).to_le_bytes().into(),
        }
    };
    let float = |v: f64| -> Vec<u8> {
        match (single && word == 4, big) {
            (true, true) => (v as f32).to_be_bytes().into(),
            (true, false) => (v as f32).to_le_bytes().into(),
            (false, true) => v.to_be_bytes().into(),
            (false, false) => v.to_le_bytes().into(),
        }
    };
    let words = if single || word == 8 { 1 } else { 2 };
    let mut out = Vec::new();
    let mut record = |parts: Vec<u8>| {
        let length =
            if big { (parts.len() as u32).to_be_bytes() } else { (parts.len() as u32).to_le_bytes() };
        out.extend(length);
        out.extend(parts);
        out.extend(length);
    };
    let rows = if layout == Layout::BigMat { -(ORDER as i64) } else { ORDER as i64 };
    let mut head: Vec<u8> =
        [ORDER as i64, rows, 6, if single { 1 } else { 2 }].into_iter().flat_map(int).collect();
    head.extend(format!("{:1$}", "KAA", 2 * word).bytes());
    record(head);
    for column in 0..ORDER as u32 {
        let mut body = Vec::new();
        let mut row_of = 0;
        if layout == Layout::Dense {
            let (first, values) = dense(column);
            row_of = first as i64;
            body.extend(values.into_iter().flat_map(float));
        } else {
            for (row, values) in strings(column) {
                let length = (values.len() * words + 1) as i64;
                match layout {
                    Layout::BigMat => body.extend([length, row as i64].into_iter().flat_map(int)),
                    _ => body.extend(int((length << 16) + row as i64)),
                }
                body.extend(values.into_iter().flat_map(float));
            }
        }
        let count = (body.len() / word) as i64;
        let mut parts: Vec<u8> = [i64::from(column) + 1, row_of, count].into_iter().flat_map(int).collect();
        parts.extend(body);
        record(parts);
    }
    let mut last: Vec<u8> = [ORDER as i64 + 1, 1, words as i64].into_iter().flat_map(int).collect();
    last.extend(float(1.0));
    record(last);
    out
}

/// DMIG, symmetric, with large fields as a punch file has them, or with small or free ones.
pub fn dmig(kind: &str) -> String {
    let mut text = String::from("$ written by a test\nDMIG    KAAX           0       6       2       0\n");
    for column in 0..ORDER as u32 {
        let own = labels()[column as usize];
        let cells: Vec<(Label, f64)> =
            lower().iter().filter(|e| e.1 == column).map(|e| (labels()[e.0 as usize], e.2)).collect();
        let (g, c) = (own.node, own.component.number());
        match kind {
            "large" => {
                text += &format!("DMIG*   {:16}{g:16}{c:16}\n", "KAAX");
                for (row, value) in cells {
                    let value = with_exponent(&format!("{value:.9E}")).replacen('E', "D", 1);
                    text += &format!("*       {:16}{:16}{value:>16.16}\n", row.node, row.component.number());
                }
            }
            "small" => {
                text += &format!("DMIG    {:8}{g:8}{c:8}{:8}", "KAAX", "");
                for (k, (row, value)) in cells.iter().enumerate() {
                    let start = if k == 1 || k == 3 { "+       " } else { "" };
                    let end = if k == 0 || k == 2 { "\n" } else { "" };
                    text +=
                        &format!("{start}{:8}{:8}{value:>8}{:8}{end}", row.node, row.component.number(), "");
                }
                text += "\n";
            }
            _ => {
                for (row, value) in cells {
                    text += &format!("DMIG,KAAX,{g},{c},,{},{},{value}\n", row.node, row.component.number());
                }
            }
        }
    }
    text
}

/// Matrix Market; `general` writes both triangles.
pub fn matrix_market(general: bool) -> String {
    let (word, entries) = if general { ("general", all()) } else { ("symmetric", lower()) };
    let mut text = format!(
        "%%MatrixMarket matrix coordinate real {word}\n% of a test\n{ORDER} {ORDER} {}\n",
        entries.len()
    );
    for (i, j, v) in entries {
        text += &format!("{} {} {v:e}\n", i + 1, j + 1);
    }
    text
}

pub fn matrix_market_array() -> String {
    let mut text = format!("%%MatrixMarket matrix array real symmetric\n{ORDER} {ORDER}\n");
    for j in 0..ORDER as u32 {
        for i in j..ORDER as u32 {
            let value = lower().iter().find(|e| (e.0, e.1) == (i, j)).map_or(0.0, |e| e.2);
            text += &format!("{value}\n");
        }
    }
    text
}

/// Abaqus MATRIX INPUT, lower triangle or both.
pub fn abaqus_matrix_input(both: bool) -> String {
    let entries = if both { all() } else { lower() };
    let of = |row: u32| labels()[row as usize];
    let line = |&(i, j, v): &Entry| {
        let (a, b) = (of(i), of(j));
        format!("{},{}, {},{},  {}\n", a.node, a.component.number(), b.node, b.component.number(), fortran(v))
    };
    entries.iter().map(line).collect()
}

pub fn triplets(entries: &[Entry]) -> String {
    entries.iter().map(|(i, j, v)| format!("{} {}  {v}\n", i + 1, j + 1)).collect()
}

/// Abaqus's user element of a substructure; the first six rows only, as it has no generalised coordinates.
pub fn abaqus_substructure() -> String {
    let mut text = String::from(
        "** ELEMENT NODES\n** 3, 10\n*USER ELEMENT, NODES=2, LINEAR\n1, 2, 3\n2, 1, 2, 6\n*MATRIX, TYPE=STIFFNESS\n",
    );
    for i in 0..6_u32 {
        let row: Vec<String> = (0..=i)
            .map(|j| lower().iter().find(|e| (e.0, e.1) == (i, j)).map_or(0.0, |e| e.2).to_string())
            .collect();
        row.chunks(4).for_each(|four| text += &format!("{},\n", four.join(",")));
    }
    text
}

pub fn sierra() -> String {
    format!(
        "function a=Kaa()\nNumRows = {ORDER};\na=[\n{}];\na=sparse(a(:,1),a(:,2),a(:,3),{ORDER},{ORDER});\n\
         disp('This Matrix is in a Symmetric Sparse Format (Lower Triangular)')\n%% matrix\n",
        lower().iter().map(|(i, j, v)| format!("{} {} {v};\n", i + 1, j + 1)).collect::<String>()
    )
}

fn npy(descr: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let mut head = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}");
    while (10 + head.len() + 1) % 64 != 0 {
        head.push(' ');
    }
    head.push('\n');
    let mut out = b"\x93NUMPY\x01\x00".to_vec();
    out.extend((head.len() as u16).to_le_bytes());
    out.extend(head.bytes());
    out.extend(data);
    out
}

/// What `scipy.sparse.save_npz` writes: `csr`, `csc` or `coo`.
pub fn npz(format: &str) -> Vec<u8> {
    let ints = |values: Vec<u32>| -> Vec<u8> {
        values.into_iter().flat_map(|v| v.cast_signed().to_le_bytes()).collect()
    };
    let mut entries = all();
    if format == "csr" {
        entries.sort_by_key(|e| (e.0, e.1));
    }
    let n = entries.len();
    let data: Vec<u8> = entries.iter().flat_map(|e| e.2.to_le_bytes()).collect();
    let mut members = vec![
        ("format.npy", npy("|S3", "()", format.as_bytes())),
        ("shape.npy", npy("<i8", "(2,)", &[7_i64.to_le_bytes(), 7_i64.to_le_bytes()].concat())),
        ("data.npy", npy("<f8", &format!("({n},)"), &data)),
    ];
    let of = |which: fn(&Entry) -> u32| entries.iter().map(which).collect::<Vec<u32>>();
    if format == "coo" {
        members.push(("row.npy", npy("<i4", &format!("({n},)"), &ints(of(|e| e.0)))));
        members.push(("col.npy", npy("<i4", &format!("({n},)"), &ints(of(|e| e.1)))));
    } else {
        type Index = fn(&Entry) -> u32;
        let (outer, inner): (Index, Index) =
            if format == "csr" { (|e| e.0, |e| e.1) } else { (|e| e.1, |e| e.0) };
        let starts =
            (0..=ORDER as u32).map(|k| entries.iter().filter(|e| outer(e) < k).count() as u32).collect();
        members.push(("indices.npy", npy("<i4", &format!("({n},)"), &ints(of(inner)))));
        members.push(("indptr.npy", npy("<i4", "(8,)", &ints(starts))));
    }
    archive(&members)
}

fn archive(members: &[(&str, Vec<u8>)]) -> Vec<u8> {
    use std::io::Write;
    let mut writer = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, bytes) in members {
        let options = zip::write::SimpleFileOptions::default();
        writer.start_file(*name, options).unwrap();
        writer.write_all(bytes).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

pub fn npy_dense() -> Vec<u8> {
    let mut data = vec![0.0; ORDER * ORDER];
    for (i, j, v) in all() {
        data[i as usize * ORDER + j as usize] = v;
    }
    npy("<f8", "(7, 7)", &data.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>())
}

/// A MATLAB level 5 file with the matrix as the variable K, sparse or full.
pub fn mat(sparse: bool, compressed: bool, big: bool) -> Vec<u8> {
    let word = |n: u32| if big { n.to_be_bytes() } else { n.to_le_bytes() };
    let element = |kind: u32, data: Vec<u8>| -> Vec<u8> {
        let mut out = [word(kind), word(data.len() as u32)].concat();
        out.extend(&data);
        out.resize(out.len().div_ceil(8) * 8, 0);
        out
    };
    let doubles = |values: Vec<f64>| -> Vec<u8> {
        values.into_iter().flat_map(|v| if big { v.to_be_bytes() } else { v.to_le_bytes() }).collect()
    };
    let ints = |values: Vec<u32>| -> Vec<u8> { values.into_iter().flat_map(word).collect() };
    let mut body = element(6, ints(vec![if sparse { 5 } else { 6 }, 0]));
    body.extend(element(5, ints(vec![7, 7])));
    // A name of up to four letters stands in the tag.
    body.extend(if big { [0, 1, 0, 1] } else { [1, 0, 1, 0] });
    body.extend(b"K\0\0\0");
    if sparse {
        let starts = (0..=ORDER as u32).map(|k| all().iter().filter(|e| e.1 < k).count() as u32).collect();
        body.extend(element(5, ints(all().iter().map(|e| e.0).collect())));
        body.extend(element(5, ints(starts)));
        body.extend(element(9, doubles(all().iter().map(|e| e.2).collect())));
    } else {
        let mut data = vec![0.0; ORDER * ORDER];
        for (i, j, v) in all() {
            data[j as usize * ORDER + i as usize] = v;
        }
        body.extend(element(9, doubles(data)));
    }
    let variable = [word(14).to_vec(), word(body.len() as u32).to_vec(), body].concat();
    let mut out = vec![b' '; 124];
    out[..10].copy_from_slice(b"MATLAB 5.0");
    out.extend(if big { *b"\x01\x00MI" } else { *b"\x00\x01IM" });
    if compressed {
        use std::io::Write;
        let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
        encoder.write_all(&variable).unwrap();
        let packed = encoder.finish().unwrap();
        out.extend([word(15), word(packed.len() as u32)].concat());
        out.extend(packed);
    } else {
        out.extend(variable);
    }
    out
}

/// All files of the tests with the names that tell their formats.
pub fn files() -> Vec<(String, Vec<u8>)> {
    let mut files: Vec<(String, Vec<u8>)> = Vec::new();
    for layout in LAYOUTS {
        for single in [false, true] {
            files.push((format!("text-{layout:?}-{single}.op4"), op4_text(layout, single).into_bytes()));
            for (big, word) in [(false, 4), (true, 4), (false, 8), (true, 8)] {
                let name = format!("binary-{layout:?}-{single}-{big}-{word}.op4");
                files.push((name, op4_binary(layout, single, big, word)));
            }
        }
    }
    for kind in ["large", "small", "free"] {
        files.push((format!("{kind}.pch"), dmig(kind).into_bytes()));
    }
    files.push(("symmetric.mtx".into(), matrix_market(false).into_bytes()));
    files.push(("general.mtx".into(), matrix_market(true).into_bytes()));
    files.push(("array.mtx".into(), matrix_market_array().into_bytes()));
    files.push(("input-lower.mtx".into(), abaqus_matrix_input(false).into_bytes()));
    files.push(("input-all.mtx".into(), abaqus_matrix_input(true).into_bytes()));
    files.push(("coordinate.mtx".into(), triplets(&all()).into_bytes()));
    files.push(("k.sti".into(), triplets(&lower()).into_bytes()));
    files.push(("Kaa.m".into(), sierra().into_bytes()));
    for format in ["csr", "csc", "coo"] {
        files.push((format!("{format}.npz"), npz(format)));
    }
    files.push(("dense.npy".into(), npy_dense()));
    for (sparse, compressed, big) in [
        (true, false, false),
        (true, true, false),
        (false, false, false),
        (false, true, true),
        (true, false, true),
    ] {
        files.push((format!("{sparse}-{compressed}-{big}.mat"), mat(sparse, compressed, big)));
    }
    for sparse in [true, false] {
        files.push((format!("{sparse}-7.3.mat"), mat_7_3(sparse, None)));
    }
    for version in [1, 2, 5] {
        files.push((format!("version-{version}.nc"), netcdf(version)));
    }
    files
}
