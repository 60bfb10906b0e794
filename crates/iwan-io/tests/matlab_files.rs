//! What MATLAB files hold beside plain arrays: sparse and complex matrices, texts, objects, structs of many elements.
#![allow(clippy::unwrap_used)]

use crate::common::instruments::behind_matlabs_header;
use crate::common::{element, mat_array, mat_file, mat_head, mat_struct, number, times, wave};
use hdf5_pure::{AttrValue, FileBuilder};
use iwan_io::{ReadError, ReadOptions, Record, StoredMatrix, StoredNumbers, mat_matrices, read_bytes};
use std::path::Path;

const FILE: &str = "a.mat";

fn read(bytes: &[u8]) -> Record {
    read_bytes(Path::new(FILE), bytes, &ReadOptions::default()).unwrap()
}

fn channel(bytes: &[u8], name: &str) -> Result<Record, ReadError> {
    let options = ReadOptions { channels: vec![name.into()], ..Default::default() };
    read_bytes(Path::new(FILE), bytes, &options)
}

/// What was noticed, as text.
fn noticed(record: &Record) -> Vec<String> {
    record.warnings().iter().map(ToString::to_string).collect()
}

fn doubles(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|v| number(*v, false, true)).collect()
}

/// A time `t` and a channel `a` of so many samples.
fn time_and_channel(n: usize) -> [Vec<u8>; 2] {
    [mat_array("t", 1, n, 9, &doubles(&times(n)), false), mat_array("a", n, 1, 9, &doubles(&wave(n)), false)]
}

/// An array of any class with no more than a head.
fn bare(class: u32, dims: &[usize], name: &str) -> Vec<u8> {
    element(14, &mat_head(class, dims, name, false), false)
}

/// The matrix [4 0 -1; 0 0 0; 0 2 0] as MATLAB stores it, with 32-bit indices.
fn sparse(name: &str) -> Vec<u8> {
    let indices = |values: &[i32]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    let parts = [
        mat_head(5, &[3, 3], name, false),
        element(5, &indices(&[0, 2, 0]), false),
        element(5, &indices(&[0, 1, 2, 3]), false),
        element(9, &doubles(&[4.0, 2.0, -1.0]), false),
    ];
    element(14, &parts.concat(), false)
}

/// The same matrix in a struct `model` of level 7.3; the attribute that says the rows has the type given.
fn sparse_7_3(rows: AttrValue) -> Vec<u8> {
    let mut file = FileBuilder::new();
    let mut model = file.create_group("model");
    let mut matrix = model.create_group("K");
    matrix.set_attr("MATLAB_sparse", rows);
    matrix.create_dataset("ir").with_u64_data(&[0, 2, 0]).with_shape(&[3]);
    matrix.create_dataset("jc").with_u64_data(&[0, 1, 2, 3]).with_shape(&[4]);
    matrix.create_dataset("data").with_f64_data(&[4.0, 2.0, -1.0]).with_shape(&[3]);
    model.add_group(matrix.finish());
    file.add_group(model.finish());
    behind_matlabs_header(file)
}

fn expected(name: &str) -> StoredMatrix {
    StoredMatrix {
        name: name.into(),
        rows: 3,
        columns: 3,
        numbers: StoredNumbers::Sparse {
            rows: vec![0.0, 2.0, 0.0],
            starts: vec![0.0, 1.0, 2.0, 3.0],
            values: vec![4.0, 2.0, -1.0],
        },
        complex: false,
    }
}

#[test]
fn a_sparse_matrix_is_the_same_in_both_levels() {
    let level_5 = mat_file(&[sparse("K")], false, false);
    assert_eq!(mat_matrices(Path::new(FILE), &level_5).unwrap(), [expected("K")]);
    for rows in [AttrValue::U64(3), AttrValue::I64(3), AttrValue::U32(3), AttrValue::I32(3)] {
        let level_7_3 = sparse_7_3(rows.clone());
        assert_eq!(mat_matrices(Path::new(FILE), &level_7_3).unwrap(), [expected("model.K")], "{rows:?}");
    }
}

/// MATLAB leaves row indices and values away where all entries are zero.
#[test]
fn a_sparse_matrix_of_zeros_has_columns_only() {
    let mut file = FileBuilder::new();
    let mut matrix = file.create_group("Z");
    matrix.set_attr("MATLAB_sparse", AttrValue::U64(5));
    matrix.create_dataset("jc").with_u64_data(&[0, 0, 0]).with_shape(&[3]);
    file.add_group(matrix.finish());
    let found = mat_matrices(Path::new(FILE), &behind_matlabs_header(file)).unwrap();
    let numbers = StoredNumbers::Sparse { rows: Vec::new(), starts: vec![0.0; 3], values: Vec::new() };
    assert_eq!(found, [StoredMatrix { name: "Z".into(), rows: 5, columns: 2, numbers, complex: false }]);
}

#[test]
fn what_is_no_channel_is_left_out_and_refused_by_name_when_it_is_asked_for() {
    let complex = [
        mat_head(6 | 0x800, &[2, 1], "C", false),
        element(9, &doubles(&[1.0, -2.0]), false),
        element(9, &doubles(&[0.5, 0.25]), false),
    ];
    let [time, samples] = time_and_channel(20);
    let others = [
        sparse("K"),
        element(14, &complex.concat(), false),
        bare(3, &[1, 1], "O"),
        bare(6, &[2, 2, 2], "N"),
        bare(5, &[2, 2, 2], "S"),
        bare(16, &[1, 1], "F"),
        // An opaque object: classes that users define have a layout of their own, and no name where others have it.
        bare(17, &[1, 1], "table"),
    ];
    let file = mat_file(&[&[time, samples][..], &others[..]].concat(), false, false);
    let record = read(&file);
    assert_eq!((record.names(), record.channel(0)), (&["a".to_string()][..], &wave(20)[..]));
    let words = [
        ("K", "a sparse array"),
        ("C", "a complex array"),
        ("O", "an object"),
        ("N", "an array of 3 dimensions"),
        ("S", "a sparse array of 3 dimensions"),
        ("F", "an array of class 16"),
    ];
    let noticed = noticed(&record);
    assert_eq!(noticed.len(), words.len(), "{noticed:?}");
    for (name, what) in words {
        let left = format!("'{name}' was left out: it is {what}");
        assert!(noticed.contains(&left), "{left}: {noticed:?}");
        let refused = channel(&file, name).unwrap_err().to_string();
        let said = format!("a.mat: {name}: {what} cannot be read; save real numeric arrays");
        assert!(refused.starts_with(&said), "{refused}");
    }
    let complex = &mat_matrices(Path::new(FILE), &file).unwrap();
    let complex = complex.iter().find(|m| m.complex).unwrap();
    assert_eq!((complex.name.as_str(), &complex.numbers), ("C", &StoredNumbers::Full(vec![1.0, -2.0])));
}

#[test]
fn numbers_of_every_stored_type_keep_their_values() {
    let two = |code: u32, bytes: Vec<u8>| {
        let file = mat_file(&[mat_array("a", 1, 2, code, &bytes, false)], false, false);
        match mat_matrices(Path::new(FILE), &file).unwrap().swap_remove(0).numbers {
            StoredNumbers::Full(values) => values,
            StoredNumbers::Sparse { .. } => panic!("a full matrix"),
        }
    };
    assert_eq!(two(1, vec![0x80, 127]), [-128.0, 127.0]);
    assert_eq!(two(2, vec![0x80, 255]), [128.0, 255.0]);
    assert_eq!(two(3, [-300_i16, 7].iter().flat_map(|v| v.to_le_bytes()).collect()), [-300.0, 7.0]);
    assert_eq!(two(4, [65_535_u16, 7].iter().flat_map(|v| v.to_le_bytes()).collect()), [65_535.0, 7.0]);
    assert_eq!(two(5, [-70_000_i32, 7].iter().flat_map(|v| v.to_le_bytes()).collect()), [-70_000.0, 7.0]);
    assert_eq!(two(6, [u32::MAX, 7].iter().flat_map(|v| v.to_le_bytes()).collect()), [4_294_967_295.0, 7.0]);
    assert_eq!(two(7, [-0.5_f32, 1e10].iter().flat_map(|v| v.to_le_bytes()).collect()), [-0.5, 1e10]);
    assert_eq!(two(9, doubles(&[0.1, -1e-300])), [0.1, -1e-300]);
    let large = 1_i64 << 53;
    assert_eq!(
        two(12, [-large, 7].iter().flat_map(|v| v.to_le_bytes()).collect()),
        [-9_007_199_254_740_992.0, 7.0]
    );
    assert_eq!(
        two(13, [u64::MAX, 7].iter().flat_map(|v| v.to_le_bytes()).collect()),
        [18_446_744_073_709_551_616.0, 7.0]
    );
    // Values that are as many as another array's, and text where numbers belong.
    let wrong = |rows, code| {
        let file = mat_file(&[mat_array("a", rows, 2, code, &[1, 2], false)], false, false);
        mat_matrices(Path::new(FILE), &file).unwrap_err().to_string()
    };
    assert!(wrong(3, 2).contains("variable 'a': found 2 values for 3 x 2"), "{}", wrong(3, 2));
    assert!(wrong(1, 16).contains("variable 'a': found Text(1) data, expected numbers"), "{}", wrong(1, 16));
}

/// A text beside the numbers, in letters of one, two and four bytes and either order.
#[test]
fn units_are_read_from_texts_of_every_width() {
    let n = 40;
    let bytes = |values: &[f64], big| values.iter().flat_map(|v| number(*v, big, true)).collect::<Vec<u8>>();
    for big in [false, true] {
        let wide = |v: u16| if big { v.to_be_bytes() } else { v.to_le_bytes() };
        let wider = |v: u16| if big { u32::from(v).to_be_bytes() } else { u32::from(v).to_le_bytes() };
        let units: Vec<u16> = "ms, mm/s\u{b2}".encode_utf16().collect();
        let texts = [
            (16, "ms, mm/s\u{b2}".as_bytes().to_vec()),
            (17, units.iter().flat_map(|v| wide(*v)).collect()),
            (4, units.iter().flat_map(|v| wide(*v)).collect()),
            (18, units.iter().flat_map(|v| wider(*v)).collect()),
        ];
        for (code, text) in texts {
            let field = |class, code, data: &[u8]| {
                element(14, &[mat_head(class, &[1, n], "", big), element(code, data, big)].concat(), big)
            };
            let fields = [
                ("time", field(6, 9, &bytes(&times(n), big))),
                ("acc", field(6, 9, &bytes(&wave(n), big))),
                ("units", field(4, code, &text)),
                ("operator", field(4, 16, b"anybody")),
            ];
            let record = read(&mat_file(&[mat_struct("d", &fields, big)], false, big));
            assert_eq!(record.unit(), "mm/s\u{b2}", "{code} {big}");
            assert!((record.dt() * 128e3 - 1.0).abs() < 1e-12, "{code} {big}: {}", record.dt());
        }
    }
}

/// A unit beside the variables of the whole file is theirs, and not that of fields of a struct.
#[test]
fn a_unit_belongs_to_what_stands_beside_it() {
    let [time, samples] = time_and_channel(20);
    let unit = element(14, &[mat_head(4, &[1, 1], "unit", false), element(16, b"g", false)].concat(), false);
    let record = read(&mat_file(&[time, samples, unit.clone()], false, false));
    assert_eq!(record.unit(), "g");
    let fields = [
        ("t", mat_array("", 1, 20, 9, &doubles(&times(20)), false)),
        ("a", mat_array("", 1, 20, 9, &doubles(&wave(20)), false)),
    ];
    let record = read(&mat_file(&[mat_struct("d", &fields, false), unit], false, false));
    assert_eq!((record.names(), record.unit()), (&["d.a".to_string()][..], ""));
}

#[test]
fn texts_empty_arrays_and_arrays_of_any_shape_of_level_7_3_are_told_apart() {
    let n = 40;
    let mut file = FileBuilder::new();
    let mut group = file.create_group("d");
    // One dimension, as programs other than MATLAB write vectors.
    group.create_dataset("time").with_f64_data(&times(n)).with_shape(&[n as u64]);
    group.create_dataset("acc").with_f32_data(&vec![0.5; n]).with_shape(&[1, n as u64]);
    let units: Vec<u16> = "s, m/s\u{b2}".encode_utf16().collect();
    let text = group.create_dataset("units").with_u16_data(&units).with_shape(&[units.len() as u64, 1]);
    text.set_attr("MATLAB_class", AttrValue::AsciiString("char".into()));
    // An empty array is stored as its two dimensions.
    let empty = group.create_dataset("notes").with_u64_data(&[0, 0]).with_shape(&[2]);
    empty.set_attr("MATLAB_empty", AttrValue::U8(1));
    group.create_dataset("cube").with_f64_data(&[0.0; 8]).with_shape(&[2, 2, 2]);
    group.create_dataset("spectrum").with_complex64_data(&[(1.0, 2.0), (3.0, 4.0)]).with_shape(&[1, 2]);
    file.add_group(group.finish());
    let bytes = behind_matlabs_header(file);
    let record = read(&bytes);
    assert_eq!((record.names(), record.unit()), (&["d.acc".to_string()][..], "m/s\u{b2}"));
    assert_eq!((record.channel(0), record.dt()), (&[0.5; 40][..], 1.0 / 128.0));
    let noticed = noticed(&record);
    assert_eq!(noticed.len(), 2, "{noticed:?}");
    assert!(
        noticed.contains(&"'d.cube' was left out: it is an array of 3 dimensions".to_string()),
        "{noticed:?}"
    );
    assert!(
        noticed.iter().any(|w| w.starts_with("'d.spectrum' was left out: it is an array of type")),
        "{noticed:?}"
    );
    let refused = channel(&bytes, "d.cube").unwrap_err().to_string();
    assert!(refused.contains("d.cube: an array of 3 dimensions cannot be read"), "{refused}");
}

/// The class of a text was known only where the file left no room behind its name, and the text was taken for numbers.
#[test]
fn classes_of_level_7_3_are_known_whatever_room_is_left_for_them() {
    for room in [4, 5, 32] {
        let mut file = FileBuilder::new();
        file.create_dataset("t").with_f64_data(&times(20)).with_shape(&[1, 20]);
        file.create_dataset("a").with_f64_data(&wave(20)).with_shape(&[1, 20]);
        let unit = file.create_dataset("unit").with_u16_data(&[u16::from(b'm'), u16::from(b'm')]);
        let class = AttrValue::ascii_string_sized("char", room).unwrap();
        unit.with_shape(&[2, 1]).set_attr("MATLAB_class", class);
        let record = read(&behind_matlabs_header(file));
        assert_eq!((record.names(), record.unit()), (&["a".to_string()][..], "mm"), "{room}");
    }
}

/// Level 7.3 keeps each field of a struct array as references to the elements.
#[test]
fn elements_of_structs_and_cells_of_level_7_3_are_called_as_in_matlab() {
    let mut file = FileBuilder::new();
    let mut hidden = file.create_group("#refs#");
    for (name, value) in [("a", 1.0), ("b", 2.0), ("c", 3.0), ("d", 4.0)] {
        hidden.create_dataset(name).with_f64_data(&[value, -value]).with_shape(&[1, 2]);
    }
    file.add_group(hidden.finish());
    let mut hits = file.create_group("hits");
    hits.create_dataset("acc").with_path_references(&["#refs#/a", "#refs#/b"]).with_shape(&[2, 1]);
    file.add_group(hits.finish());
    // MATLAB's two rows and two columns, columns first.
    let all = ["#refs#/a", "#refs#/b", "#refs#/c", "#refs#/d"];
    let cells = file.create_dataset("x").with_path_references(&all).with_shape(&[2, 2]);
    cells.set_attr("MATLAB_class", AttrValue::AsciiString("cell".into()));
    file.create_dataset("loose").with_path_references(&["#refs#/d"]).with_shape(&[1, 1]);
    let found = mat_matrices(Path::new(FILE), &behind_matlabs_header(file)).unwrap();
    let mut found: Vec<(&str, f64)> = found
        .iter()
        .map(|m| match &m.numbers {
            StoredNumbers::Full(values) => (m.name.as_str(), values[0]),
            StoredNumbers::Sparse { .. } => panic!("full matrices"),
        })
        .collect();
    found.sort_by(|a, b| a.0.cmp(b.0));
    let expected = [
        ("hits(1).acc", 1.0),
        ("hits(2).acc", 2.0),
        ("loose(1)", 4.0),
        ("x{1,1}", 1.0),
        ("x{1,2}", 3.0),
        ("x{2,1}", 2.0),
        ("x{2,2}", 4.0),
    ];
    assert_eq!(found, expected);
}

#[test]
fn cells_in_cells_of_level_7_3_end_at_a_depth() {
    let mut file = FileBuilder::new();
    let mut hidden = file.create_group("#refs#");
    hidden.create_dataset("c0").with_f64_data(&[1.0, 2.0]).with_shape(&[1, 2]);
    for depth in 1..12 {
        let inner = format!("#refs#/c{}", depth - 1);
        let cell = hidden.create_dataset(&format!("c{depth}")).with_path_references(&[inner.as_str()]);
        cell.with_shape(&[1, 1]).set_attr("MATLAB_class", AttrValue::AsciiString("cell".into()));
    }
    file.add_group(hidden.finish());
    for (name, inner) in [("deep", "#refs#/c11"), ("shallow", "#refs#/c2")] {
        let cell = file.create_dataset(name).with_path_references(&[inner]).with_shape(&[1, 1]);
        cell.set_attr("MATLAB_class", AttrValue::AsciiString("cell".into()));
    }
    let bytes = behind_matlabs_header(file);
    let names: Vec<String> =
        mat_matrices(Path::new(FILE), &bytes).unwrap().into_iter().map(|m| m.name).collect();
    assert_eq!(names, ["shallow{1,1}{1,1}{1,1}"]);
    let deepest = format!("deep{}", "{1,1}".repeat(9));
    let refused = channel(&bytes, &deepest).unwrap_err().to_string();
    assert!(refused.contains("a cell array more than 8 levels deep cannot be read"), "{refused}");
}
