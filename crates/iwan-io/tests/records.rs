//! The record itself, and the kinds under which the catalogue of errors lists what is refused.
#![allow(clippy::unwrap_used)]

use crate::common::instruments::lvm;
use crate::common::{csv, uff_ascii};
use iwan_io::atomic::{Folder, WriteError, write_file};
use iwan_io::{NumberType, Order, ReadOptions, Record, RecordError, Table, read_bytes};
use iwan_machine::Kind;
use std::fs;
use std::io::Write;
use std::path::Path;

/// Squares at 0.1 s from -0.3 s on, and their negatives.
fn record() -> Record {
    let squares: Vec<f64> = (0..11).map(|n| f64::from(n * n)).collect();
    let negatives = squares.iter().map(|v| -v).collect();
    let names = vec!["tip".into(), "base".into()];
    Record::new(0.1, vec![squares, negatives], names).unwrap().with_start(-0.3).unwrap()
}

/// -0.3 + 3 x 0.1 is not zero to the last bit, and 0 means that sample all the same.
#[test]
fn a_stretch_begins_and_ends_with_the_samples_that_it_names() {
    let cut = record().between(Some(0.0), Some(0.5)).unwrap();
    assert_eq!(cut.channel(0), [9.0, 16.0, 25.0, 36.0, 49.0, 64.0]);
    assert_eq!(cut.channel_named("base").unwrap()[0], -9.0);
    assert!(cut.start().abs() < 1e-15 && cut.dt() == 0.1, "{}", cut.start());
    // Between samples it begins with the next and ends with the one before.
    assert_eq!(record().between(Some(0.01), Some(0.29)).unwrap().channel(0), [16.0, 25.0]);
    // Beyond the ends it is the whole record.
    assert_eq!(record().between(Some(-9.0), Some(9.0)).unwrap(), record());
    assert_eq!(record().between(None, None).unwrap(), record());
}

#[test]
fn a_stretch_of_less_than_two_samples_is_refused_with_what_there_is() {
    let refused = |from, to| match record().between(Some(from), Some(to)).unwrap_err() {
        RecordError::Stretch { samples, start, end, .. } => {
            assert!((start + 0.3).abs() < 1e-15 && (end - 0.7).abs() < 1e-15, "{start} {end}");
            samples
        }
        other => panic!("{other}"),
    };
    assert_eq!((refused(0.0, 0.05), refused(0.01, 0.02), refused(0.4, 0.1), refused(2.0, 3.0)), (1, 0, 0, 0));
    assert_eq!((refused(f64::NAN, 0.5), refused(0.0, f64::NAN)), (0, 0));
    let text = record().between(Some(0.0), Some(0.05)).unwrap_err().to_string();
    assert!(text.starts_with("from 0 to 0.05 s there are 1 samples, at least 2 are needed"), "{text}");
}

#[test]
fn channels_are_found_by_name_and_given_away_whole() {
    let record = record();
    assert_eq!((record.channels(), record.len(), record.is_empty()), (2, 11, false));
    assert_eq!(record.channel_named("base"), Some(record.channel(1)));
    assert_eq!(record.channel_named("foot"), None);
    let [tip, base] = &record.clone().into_samples()[..] else { panic!("two channels") };
    assert_eq!((&tip[..], &base[..]), (record.channel(0), record.channel(1)));
}

/// The name, the clock and the unit of a copy may differ; its samples do not.
#[test]
fn a_copy_is_known_by_its_samples() {
    let (one, copy) = (record(), record().with_start(5.0).unwrap());
    assert!(one.is_copy_of(&copy));
    let mut samples = one.clone().into_samples();
    samples[1][4] += 1e-9;
    assert!(!one.is_copy_of(&Record::new(0.1, samples, one.names().to_vec()).unwrap()));
}

#[test]
fn what_makes_no_record_has_its_kind() {
    let names = |n: usize| vec!["a".to_string(); n];
    let kind = |made: Result<Record, RecordError>| made.unwrap_err().kind();
    assert_eq!(kind(Record::new(0.0, vec![vec![0.0; 2]], names(1))), Kind::Value);
    assert_eq!(kind(record().with_start(f64::INFINITY)), Kind::Value);
    assert_eq!(kind(Record::new(1.0, vec![vec![0.0; 2]], names(2))), Kind::Value);
    assert_eq!(kind(Record::new(1.0, Vec::new(), Vec::new())), Kind::Ambiguous);
    assert_eq!(kind(Record::new(1.0, vec![vec![0.0]], names(1))), Kind::TooShort);
    assert_eq!(kind(Record::new(1.0, vec![vec![0.0; 2], vec![0.0; 3]], names(2))), Kind::Mismatch);
    assert_eq!(kind(Record::new(1.0, vec![vec![0.0, f64::NAN]], names(1))), Kind::NotFinite);
    assert_eq!(kind(record().between(Some(5.0), None)), Kind::Stretch);
}

#[test]
fn every_refusal_of_a_file_has_the_kind_that_the_catalogue_lists() {
    let kind = |name: &str, bytes: &[u8], options: &ReadOptions| {
        read_bytes(Path::new(name), bytes, options).unwrap_err().kind()
    };
    let plain = ReadOptions::default();
    let of = |name: &str, bytes: &[u8]| kind(name, bytes, &plain);
    let table = |text: &str| kind("a.csv", text.as_bytes(), &plain);
    let asked = |options: ReadOptions| kind("a.csv", &csv(8), &options);
    assert_eq!(iwan_io::read("no/such.csv", &plain).unwrap_err().kind(), Kind::Unreadable);
    assert_eq!(of("a.doc", b"no such thing"), Kind::UnknownFormat);
    assert_eq!(of("a.tdms", b"TDSm\x0e\0\0\0"), Kind::Unsupported);
    assert_eq!(of("a.wav", b"RIFF....WAVE"), Kind::CutShort);
    assert_eq!(of("a.lvm", &lvm(40)[..60]), Kind::Damaged);
    assert_eq!(table("t,a\n0,1\n1,x\n"), Kind::Damaged);
    assert_eq!(table("a,b\n3,5\n1,7\n2,6\n"), Kind::NoTime);
    assert_eq!(table("t,u.displacement,u.velocity\n0,1,2\n1,3,4\n2,5,7\n"), Kind::Ambiguous);
    assert_eq!(table("t,a\n0,1\n2,1\n1,1\n"), Kind::TimeOrder);
    assert_eq!(table("t,a\n0,1\n1,1\n1,1\n2,1\n"), Kind::TimeRepeated);
    assert_eq!(table("t,a\n0,1\n1,1\n5,1\n6,1\n"), Kind::TimeUneven);
    assert_eq!(table("t [furlong],a\n0,1\n1,1\n2,1\n"), Kind::TimeUnit);
    assert_eq!(table("t_b [s],b,t_c [s],c\n0,1,0,7\n1,2,2,8\n2,3,4,9\n"), Kind::SeveralTimes);
    assert_eq!(table("t,a\n0,1\n1,NaN\n2,3\n"), Kind::NotFinite);
    assert_eq!(of("a.uff", &[uff_ascii(20, "a"), uff_ascii(21, "b")].concat()), Kind::Mismatch);
    assert_eq!(asked(ReadOptions { channels: vec!["b".into()], ..plain.clone() }), Kind::UnknownName);
    assert_eq!(asked(ReadOptions { unit: Some("stone".into()), ..plain.clone() }), Kind::Unit);
    assert_eq!(asked(ReadOptions { rate: Some(-1.0), ..plain.clone() }), Kind::Value);
}

#[test]
fn what_cannot_be_written_has_its_kind() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("a.csv");
    fs::write(&path, "old").unwrap();
    let written = |path: &Path, force| write_file(path, force, |w| w.write_all(b"new"));
    assert_eq!(written(&path, false).unwrap_err().kind(), Kind::Exists);
    let missing = written(&place.path().join("no/such.csv"), false).unwrap_err();
    assert_eq!(missing.kind(), Kind::Unwritable);
    assert!(missing.to_string().contains("cannot create a temporary file"), "{missing}");
    // A file never takes the place of a folder.
    let folder = written(place.path(), true).unwrap_err();
    assert_eq!(folder.kind(), Kind::Unwritable);
    assert!(folder.to_string().contains("cannot rename the temporary file"), "{folder}");
    assert_eq!(fs::read(&path).unwrap(), b"old");
    let first = Folder::stage(place.path(), false).unwrap();
    let second = Folder::stage(place.path(), false).unwrap_err();
    assert_eq!(second.kind(), Kind::Busy);
    drop(first);
}

/// What is written beside a folder's own files appears with them, and a name that is taken meanwhile is told.
#[test]
fn a_folder_is_filled_where_it_is_staged_and_refused_where_another_came_first() {
    let place = tempfile::tempdir().unwrap();
    let out = place.path().join("out");
    let mut folder = Folder::stage(&out, false).unwrap();
    folder.write("a", |w| w.write_all(b"1")).unwrap();
    assert_eq!(fs::read(folder.staged().join("a")).unwrap(), b"1");
    fs::create_dir(&out).unwrap();
    fs::write(out.join("a"), "another's").unwrap();
    assert!(matches!(folder.commit(), Err(WriteError::Exists { path }) if path == out.join("a")));
    assert_eq!(fs::read(out.join("a")).unwrap(), b"another's");
    // A place where nothing can stand is an error of the system and not a name that is taken.
    let mut folder = Folder::stage(place.path().join("next"), false).unwrap();
    folder.write("a", |w| w.write_all(b"1")).unwrap();
    fs::write(place.path().join("next"), "a file").unwrap();
    let nowhere = place.path().join("no/such/folder");
    let error = folder.commit_where_free(|| nowhere.clone()).unwrap_err();
    assert!(matches!(&error, WriteError::Io { path, action: "rename", .. } if *path == nowhere), "{error}");
}

#[test]
fn a_table_is_written_in_the_forms_that_it_is_read_from() {
    let place = tempfile::tempdir().unwrap();
    let (t, a) = ([0.0, 0.5, 1.0], [1.0, -1e-20, 0.1]);
    let table = Table::new(vec![("t".into(), &t[..]), ("acc".into(), &a[..])]).unwrap();
    assert_eq!((table.rows(), table.columns()[1].0.as_str(), table.columns()[1].1), (3, "acc", &a[..]));
    let path = place.path().join("a.npz");
    table.write_npz(&path, false).unwrap();
    let record = iwan_io::read(&path, &ReadOptions::default()).unwrap();
    assert_eq!((record.channel(0), record.dt()), (&a[..], 0.5));
    assert!(matches!(table.write_npz(&path, false), Err(WriteError::Exists { .. })));
}

#[test]
fn single_numbers_of_every_type_are_taken_out_of_bytes() {
    use NumberType::{F32, F64, I8, I16, I32, I64, U8, U16, U32, U64};
    // One bit in the lowest place of the second number, and all bits set in the third.
    for (kind, most) in [
        (I8, -1.0),
        (U8, 255.0),
        (I16, -1.0),
        (U16, 65_535.0),
        (I32, -1.0),
        (U32, 4_294_967_295.0),
        (I64, -1.0),
        (U64, 18_446_744_073_709_551_616.0),
    ] {
        let size = kind.size();
        let mut bytes = vec![0; size];
        bytes.extend([1].into_iter().chain(vec![0; size - 1]));
        bytes.extend(vec![255; size]);
        let all: Vec<Option<f64>> = (0..4).map(|at| kind.at(Order::Little, &bytes, at)).collect();
        assert_eq!(all, [Some(0.0), Some(1.0), Some(most), None], "{kind:?}");
        let high = 2.0_f64.powi(8 * (i32::try_from(size).unwrap() - 1));
        assert_eq!(kind.at(Order::Big, &bytes, 1), Some(high), "{kind:?}");
        assert!(!kind.is_real(), "{kind:?}");
    }
    assert_eq!(F32.at(Order::Big, &(-0.5_f32).to_be_bytes(), 0), Some(-0.5));
    assert_eq!(F64.at(Order::Little, &1e-300_f64.to_le_bytes(), 0), Some(1e-300));
    assert!(F32.is_real() && F64.is_real());
    assert_eq!(F64.at(Order::Little, &[0; 8], usize::MAX), None);
}
