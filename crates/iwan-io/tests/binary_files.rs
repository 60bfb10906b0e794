//! NumPy, universal and MATLAB files in their variants.
#![allow(clippy::unwrap_used)]

use crate::common;
use crate::common::{
    element, mat_array, mat_file, mat_struct, times, uff_ascii, uff_binary, uff_header, wave,
};
use iwan_io::{NumpyArray, Quantity, ReadError, ReadOptions, Record, Warning, numpy_members, read_bytes};
use std::io::{Cursor, Write};
use std::path::Path;

fn read(name: &str, bytes: &[u8]) -> Result<Record, ReadError> {
    read_bytes(Path::new(name), bytes, &ReadOptions::default())
}

fn refused(name: &str, bytes: &[u8]) -> String {
    read(name, bytes).unwrap_err().to_string()
}

#[test]
fn npy_types_orders_and_shapes() {
    let rate = ReadOptions { rate: Some(10.0), ..Default::default() };
    let one = |descr, shape, data: &[u8]| {
        let bytes = common::npy(descr, false, shape, data);
        read_bytes(Path::new("acc.npy"), &bytes, &rate).unwrap().channel(0).to_vec()
    };
    let single: Vec<u8> = [3.0_f32, 1.5, 2.0].iter().flat_map(|v| v.to_be_bytes()).collect();
    assert_eq!(one(">f4", "(3,)", &single), [3.0, 1.5, 2.0]);
    assert_eq!(one("|i1", "(3,)", &[255, 4, 1]), [-1.0, 4.0, 1.0]);
    assert_eq!(one("<u2", "(1, 2)", &[9, 1, 2, 0]), [265.0, 2.0]);
    let table = read("a.npy", &common::npy_table(50)).unwrap();
    assert_eq!((table.dt(), table.channel(0)), (1.0 / 128.0, &wave(50)[..]));
    let columns: Vec<u8> = times(9).iter().chain(&wave(9)).flat_map(|v| v.to_le_bytes()).collect();
    let fortran = read("a.npy", &common::npy("<f8", true, "(9, 2)", &columns)).unwrap();
    let rows = read("a.npy", &common::npy("<f8", false, "(2, 9)", &columns)).unwrap();
    assert_eq!(fortran.samples(), rows.samples());
    assert!(refused("a.npy", &common::npy("<c16", false, "(1,)", &[0; 16])).contains("'<c16'"));
    let huge = common::npy("<f8", false, "(99999999999, 99999999999)", &[0; 16]);
    assert!(refused("a.npy", &huge).contains("cut short"));
}

#[test]
fn npz_finds_time_and_channels() {
    let record = read("a.npz", &common::npz(40)).unwrap();
    assert_eq!((record.names()[0].as_str(), record.quantity()), ("acc", Quantity::Acceleration));
    assert_eq!((record.dt(), record.channel(0)), (1.0 / 128.0, &wave(40)[..]));
}

/// Arrays as `numpy.savez` stores them.
fn archive(arrays: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let mut out = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in arrays {
        let plain =
            zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
        out.start_file(format!("{name}.npy"), plain).unwrap();
        out.write_all(bytes).unwrap();
    }
    out.finish().unwrap().into_inner()
}

fn vector(values: &[f64]) -> Vec<u8> {
    let data: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
    common::npy("<f8", false, &format!("({},)", values.len()), &data)
}

#[test]
fn arrays_that_are_no_channels_are_left_out_of_an_archive_unless_they_are_asked_for() {
    let cube = common::npy("<f8", false, "(2, 2, 2)", &[0; 64]);
    let labels = common::npy("<U3", false, "(2,)", &[0; 24]);
    let arrays = [("t", vector(&times(9))), ("a", vector(&wave(9))), ("cube", cube), ("labels", labels)];
    let file = archive(&arrays);
    let record = read("a.npz", &file).unwrap();
    assert_eq!((record.names(), record.channel(0)), (&["a".to_string()][..], &wave(9)[..]));
    let words: Vec<String> = record.warnings().iter().map(ToString::to_string).collect();
    assert_eq!(words, ["'cube' was left out: an array of 3 dimensions", "'labels' was left out: type '<U3'"]);
    let asked = |name: &str| {
        let options = ReadOptions { channels: vec![name.into()], ..Default::default() };
        read_bytes(Path::new("a.npz"), &file, &options)
    };
    let refused = asked("cube").unwrap_err().to_string();
    assert!(
        refused.contains("array 'cube', key 'shape': an array of 3 dimensions cannot be read"),
        "{refused}"
    );
    let refused = asked("labels").unwrap_err().to_string();
    assert!(
        refused.contains("array 'labels', key 'descr': type '<U3' cannot be read; save real"),
        "{refused}"
    );
    assert_eq!(asked("a").unwrap().channel(0), wave(9));
    let damaged = archive(&[("t", vector(&times(9))), ("a", b"\x93NUMPY\x04\x00".to_vec())]);
    assert!(
        refused_npz(&damaged).contains("array 'a': found no complete NPY header"),
        "{}",
        refused_npz(&damaged)
    );
}

fn refused_npz(bytes: &[u8]) -> String {
    refused("a.npz", bytes)
}

/// Readers of archives show the last of two entries alone: half of such a file would be missing without a word.
#[test]
fn two_arrays_of_one_name_are_refused() {
    let file = archive(&[("t", vector(&times(9))), ("a", vector(&wave(9))), ("b", vector(&wave(9)))]);
    assert_eq!(numpy_members(Path::new("a.npz"), &file).unwrap()["b"], vector(&wave(9)));
    let mut twice = file;
    for at in 0..twice.len() - 5 {
        if &twice[at..at + 5] == b"b.npy" {
            twice[at] = b'a';
        }
    }
    let message = refused_npz(&twice);
    assert!(
        message.contains("zip directory: found two entries 'a.npy', expected names that differ"),
        "{message}"
    );
    let message = numpy_members(Path::new("k.npz"), &twice).unwrap_err().to_string();
    assert!(message.starts_with("k.npz: zip directory: found two entries 'a.npy'"), "{message}");
}

#[test]
fn arrays_are_looked_into_element_by_element() {
    let of = |bytes: &[u8]| -> (usize, Option<f64>, Option<f64>, Option<String>) {
        let array = NumpyArray::read(Path::new("k.npy"), bytes, "k").unwrap();
        (array.len(), array.at(1), array.at(2), array.letters())
    };
    let two: Vec<u8> = [7_i64, -3].iter().flat_map(|v| v.to_be_bytes()).collect();
    assert_eq!(of(&common::npy(">i8", false, "(2,)", &two)), (2, Some(-3.0), None, None));
    let texts: Vec<u8> = "abcxyz".chars().flat_map(|c| u32::from(c).to_le_bytes()).collect();
    let texts = common::npy("<U3", false, "(2,)", &texts);
    assert_eq!(of(&texts), (2, None, None, Some("abcxyz".into())));
    assert_eq!(of(&common::npy("|S4", false, "(1,)", b"csr\0")), (1, None, None, Some("csr".into())));
    let nothing = common::npy("<f8", false, "(0, 3)", &[]);
    assert_eq!(of(&nothing), (0, None, None, None));
    assert!(NumpyArray::read(Path::new("k.npy"), &nothing, "k").unwrap().is_empty());
    assert!(!NumpyArray::read(Path::new("k.npy"), &texts, "k").unwrap().is_empty());
    // Version 2 has four bytes for the length of the header.
    let mut second = common::npy(">i8", false, "(2,)", &two);
    second[6] = 2;
    second.splice(10..10, [0, 0]);
    assert_eq!(of(&second), (2, Some(-3.0), None, None));
    let error = NumpyArray::read(Path::new("k.npy"), b"\x93NUMPY\x05\x00", "k").unwrap_err().to_string();
    assert!(error.starts_with("k.npy: array 'k': found no complete NPY header"), "{error}");
}

#[test]
fn an_array_of_three_dimensions_is_refused_with_what_to_do() {
    let message = refused("a.npy", &common::npy("<f8", false, "(2, 2, 2)", &[0; 64]));
    assert!(
        message.contains("an array of 3 dimensions cannot be read; save arrays of one or two dimensions: of several hits each in a file of its own"),
        "{message}"
    );
}

#[test]
fn universal_files_in_all_number_types() {
    for (big, double) in [(false, false), (false, true), (true, false), (true, true)] {
        let record = read("a.uff", &uff_binary(&wave(30), big, double, "tip")).unwrap();
        assert_eq!((record.names()[0].as_str(), record.unit()), ("tip", "m/s2"));
        let close = |(a, b): (&f64, &f64)| (a - b).abs() < if double { 1e-300 } else { 1e-7 };
        assert!(record.channel(0).iter().zip(&wave(30)).all(close));
        assert!(record.warnings().is_empty());
    }
}

/// A dataset 1858 that names a window.
fn window(kind: u8) -> String {
    let zeros = |n: usize| format!("{:>15}", "0.0000000E+00").repeat(n);
    format!(
        "    -1\n  1858\n{}\n     0{kind:>6}{}\n{}\n{}{:>15}\n{}\nNONE  NONE\nNONE\n    -1\n",
        format!("{:>12}", 0).repeat(6),
        format!("{:>6}", 0).repeat(10),
        zeros(5),
        zeros(4),
        "2.5000000E+00",
        zeros(5),
    )
}

#[test]
fn a_window_that_the_file_names_is_obeyed() {
    let [a, b] = ["a", "b"].map(|name| uff_ascii(20, name));
    let file = |parts: &[&[u8]]| parts.concat();
    let [none, hanning, exponential, impact] = [0, 1, 4, 5].map(|kind| window(kind).into_bytes());
    // Behind its function, and before it.
    for file in [file(&[&a, &hanning, &b, &none]), file(&[&hanning, &a, &none, &b])] {
        let record = read("a.uff", &file).unwrap();
        assert_eq!(record.names(), ["b"]);
        let left = record.warnings()[0].to_string();
        assert!(left.starts_with("'a' was left out: a Hanning window lies over it"), "{left}");
    }
    let alone = refused("a.uff", &file(&[&hanning, &a]));
    assert!(alone.contains("Hanning") && alone.contains("export the time histories without"), "{alone}");
    let record = read("a.uff", &file(&[&a, &exponential, &b, &impact])).unwrap();
    let words: Vec<String> = record.warnings().iter().map(ToString::to_string).collect();
    assert_eq!((record.names().len(), words.len()), (2, 2));
    assert!(words[0].contains("damping factor 2.5") && words[0].contains("'a'"), "{words:?}");
    assert!(words[1].contains("an impact window lies over 'b'"), "{words:?}");
    let (functions, warnings) =
        iwan_io::uff_functions("a.uff".as_ref(), &file(&[&hanning, &a, &exponential, &b])).unwrap();
    assert_eq!((functions.len(), functions[0].name.as_str(), warnings.len()), (1, "b", 2));
    // What is no dataset 1858 says nothing.
    let broken = String::from_utf8(hanning).unwrap().replace("     0     1", "     0     x").into_bytes();
    assert!(read("a.uff", &file(&[&a, &broken])).unwrap().warnings().is_empty());
}

#[test]
fn uff_histories_of_one_name_are_told_apart_and_can_be_chosen() {
    let file: Vec<u8> =
        ["a", "a (2)", "b", "a", "a"].iter().zip(20..).flat_map(|(name, _)| uff_ascii(20, name)).collect();
    let names = ["a", "a (2)", "b", "a (3)", "a (4)"];
    assert_eq!(read("a.uff", &file).unwrap().names(), names);
    let options = |name: &str| ReadOptions { channels: vec![name.into()], ..Default::default() };
    for name in names {
        let one = read_bytes("a.uff".as_ref(), &file, &options(name)).unwrap();
        assert_eq!(one.names(), [name]);
    }
    let unknown = read_bytes("a.uff".as_ref(), &file, &options("a (5)")).unwrap_err().to_string();
    assert!(unknown.contains("a, a (2), b, a (3), a (4)"), "{unknown}");
}

#[test]
fn other_datasets_are_skipped_and_channels_joined() {
    let other = b"    -1\n    15\n         1         0         0        11  0.0  0.0  0.0\n    -1\n";
    let file =
        [&other[..], &uff_ascii(20, "a"), other, &uff_binary(&wave(20), false, true, "b"), other].concat();
    let record = read("a.unv", &file).unwrap();
    assert_eq!((record.names(), record.len()), (&["a".to_string(), "b".to_string()][..], 20));
    let options = ReadOptions { channels: vec!["b".into()], ..Default::default() };
    assert_eq!(read_bytes(Path::new("a.unv"), &file, &options).unwrap().names(), ["b"]);
    let uneven = [uff_ascii(20, "a"), uff_ascii(21, "b")].concat();
    assert!(refused("a.unv", &uneven).contains("'b' has 21 samples"));
    assert!(refused("a.unv", other).contains("without dataset 58"));
}

#[test]
fn data_that_look_like_a_closing_line_are_data() {
    let mut values = wave(30);
    values[7] = f64::from_le_bytes(*b"\n    -1\n");
    let record = read("a.uff", &uff_binary(&values, false, true, "a")).unwrap();
    assert_eq!(record.channel(0), values);
}

#[test]
fn uneven_abscissas_are_times() {
    for (wide, data_type) in [(false, 2), (true, 4)] {
        let mut file = uff_header("    58", data_type, 5, false, "a");
        for i in 0..5 {
            let t = f64::from(i) * 0.25;
            let ordinate = if wide { format!("{t:>20.12e}") } else { format!("{t:>13.5e}") };
            file.extend(format!("{t:>13.5e}{ordinate}\n").bytes());
        }
        file.extend(b"    -1\n");
        let record = read("a.uff", &file).unwrap();
        assert_eq!((record.dt(), record.channel(0)), (0.25, &[0.0, 0.25, 0.5, 0.75, 1.0][..]));
    }
    let first = "    58b     1     2          11          60     0     0           0           0";
    let mut file = uff_header(first, 4, 5, false, "a");
    for i in 0..5_u8 {
        file.extend((f32::from(i) * 0.25).to_le_bytes());
        file.extend(f64::from(i).to_le_bytes());
    }
    file.extend(b"    -1\n");
    let record = read("a.uff", &file).unwrap();
    assert_eq!((record.dt(), record.channel(0)), (0.25, &[0.0, 1.0, 2.0, 3.0, 4.0][..]));
}

#[test]
fn values_that_touch_are_read_by_column() {
    let mut file = uff_header("    58", 2, 3, true, "a");
    file.extend(b"-1.00000E+100-2.00000E+000-3.00000E-001\n    -1\n");
    assert_eq!(read("a.uff", &file).unwrap().channel(0), [-1e100, -2.0, -0.3]);
}

#[test]
fn files_cut_or_miscounted() {
    let whole = uff_binary(&wave(100), false, false, "a");
    let cut = &whole[..whole.len() - 200];
    assert!(matches!(read("a.uff", cut), Err(ReadError::CutShort { promised: 100, .. })));
    let nearly = read("a.uff", &whole[..whole.len() - 16]).unwrap();
    assert!(nearly.warnings().iter().any(|w| matches!(w, Warning::Unclosed { .. })));
    assert!(nearly.warnings().iter().any(|w| matches!(w, Warning::Count { promised: 100, .. })));
}

#[test]
fn matlab_structs_plain_and_compressed_in_both_orders() {
    for (compressed, big) in [(false, false), (true, false), (false, true), (true, true)] {
        let record = read("a.mat", &common::mat(40, compressed, big)).unwrap();
        assert_eq!(record.names(), ["d.s.acc"]);
        assert_eq!((record.dt(), record.channel(0)), (1.0 / 128.0, &wave(40)[..]));
    }
}

#[test]
fn matlab_stores_small_numbers_in_small_types() {
    let fs = mat_array("fs", 1, 1, 2, &[50], false);
    let a = mat_array("a", 1, 4, 1, &[1, 255, 3, 4], false);
    let record = read("a.mat", &mat_file(&[fs, a], false, false)).unwrap();
    assert_eq!((record.dt(), record.channel(0)), (0.02, &[1.0, -1.0, 3.0, 4.0][..]));
}

#[test]
fn other_matlab_levels_get_a_remedy() {
    let mut v73 = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".to_vec();
    v73.resize(124, b' ');
    v73.extend(b"\x00\x02IM\x00\x00");
    assert!(refused("a.mat", &v73).contains("without the HDF5 part"));
    let v4: Vec<u8> = [0_u32, 3, 1, 0, 2].iter().flat_map(|w| w.to_le_bytes()).chain(*b"a\0").collect();
    assert!(refused("a.mat", &v4).contains("v4"));
    assert!(refused("a.mat", b"no").contains("128 bytes"));
}

#[test]
fn deep_structs_and_bombs_end_early() {
    let mut inner = mat_array("", 1, 2, 2, &[1, 2], false);
    for _ in 0..60 {
        inner = mat_struct("s", &[("f", inner)], false);
    }
    assert!(read("a.mat", &mat_file(&[inner], false, false)).is_err());
    let claims = [&element(9, &[0; 8], false)[..4], &[0xff; 4][..]].concat();
    assert!(refused("a.mat", &mat_file(&[claims], false, false)).contains("cut short"));
}

#[test]
fn unknown_content_is_named_with_the_formats_that_are_known() {
    assert!(refused("a.doc", b"no such thing").contains("uff"));
    assert!(matches!(iwan_io::read("no/such.csv", &ReadOptions::default()), Err(ReadError::Io { .. })));
}
