//! Golden facts about measured files that are not part of this repository.
//!
//! The expected values come from peers: UFF files read by pyuff 2.5.8, the MATLAB file by scipy.io 1.17.1
//! (`repr` of the float64 values, sums by NumPy 2.4.6). Set `IWAN_FIELD_DATA` to the folder with `field/` and `uff/`.
#![allow(clippy::unwrap_used, reason = "a failed test may panic")]

#[path = "../../../tests/support/field.rs"]
mod field;

use iwan_io::{Quantity, ReadError, ReadOptions, Record, Warning, read, read_bytes};
use std::path::Path;

fn default(path: &Path) -> Record {
    read(path, &ReadOptions::default()).unwrap()
}

/// First, last, sum, largest magnitude and its sample.
fn facts(values: &[f64]) -> (f64, f64, f64, f64, usize) {
    let largest = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let at = values.iter().position(|v| v.abs() == largest).unwrap();
    (values[0], values[values.len() - 1], values.iter().sum(), values[at].abs(), at)
}

fn assert_facts(values: &[f64], expected: (f64, f64, f64, f64, usize)) {
    let found = facts(values);
    assert_eq!((found.0, found.1, found.3, found.4), (expected.0, expected.1, expected.3, expected.4));
    assert!((found.2 - expected.2).abs() <= 1e-9 * expected.2.abs(), "{} {}", found.2, expected.2);
}

fn the_brake_reuss_record_is_found_without_options(path: &Path) {
    let record = default(path);
    assert_eq!(record.names(), ["HIdata.acc1", "HIdata.acc2", "HIdata.acc3"]);
    assert_eq!((record.len(), record.quantity(), record.unit()), (65_536, Quantity::Acceleration, "m/s^2"));
    assert!((record.dt() - 7.8125e-5).abs() < 1e-16 && record.start() == -0.01);
    assert!((record.rate() - 12_800.0).abs() < 1e-8);
    assert!(record.warnings().is_empty(), "{:?}", record.warnings());
    let acc1 = (-0.012_539_951_130_747_795, 0.322_671_502_828_598, -49.347_572_848_637_355);
    assert_facts(record.channel(0), (acc1.0, acc1.1, acc1.2, 415.212_982_177_734_4, 211));
    let acc3 = (0.008_003_539_405_763_15, -0.197_801_753_878_593_44, -82.187_989_494_152_13);
    assert_facts(record.channel(2), (acc3.0, acc3.1, acc3.2, 701.814_697_265_625, 129));
}

fn struct_fields_are_chosen_by_path(path: &Path) {
    let (time, channels) = (Some("HIdata.time".into()), vec!["HIdata.acc3".into(), "HIdata.acc1".into()]);
    let record = read(path, &ReadOptions { time, channels, ..Default::default() }).unwrap();
    assert_eq!(record.names(), ["HIdata.acc3", "HIdata.acc1"]);
    let channels = vec!["HIdata.acc9".into()];
    let error = read(path, &ReadOptions { channels, ..Default::default() }).unwrap_err().to_string();
    assert!(error.contains("'HIdata.acc9'") && error.contains("HIdata.acc1, HIdata.acc2"), "{error}");
}

fn ascii_and_binary_datasets_agree(path: &Path) {
    let (ascii, binary) = (default(path), default(&path.with_file_name("sample_58b_binary.uff")));
    assert_eq!((ascii.len(), ascii.dt(), ascii.names()), (79_292, 1.525_88e-5, binary.names()));
    assert_eq!((binary.len(), binary.dt(), binary.unit()), (79_292, 1.525_88e-5, "Pa"));
    assert_eq!(ascii.quantity(), Quantity::Pressure);
    for (a, b) in ascii.channel(0).iter().zip(binary.channel(0)) {
        assert!((a - b).abs() <= 6e-6 * b.abs(), "{a} {b}"); // six digits in the text
    }
    assert_facts(ascii.channel(0), (-0.014_755_3, -0.004_314_69, 5.715_039_728_042_096, 0.141_304, 42_706));
    let binary_facts = (-0.014_755_260_199_308_395, -0.004_314_688_965_678_215, 5.715_040_058_740_556);
    let largest = 0.141_303_941_607_475_28;
    assert_facts(binary.channel(0), (binary_facts.0, binary_facts.1, binary_facts.2, largest, 42_706));
}

fn four_channels_of_an_analyser(path: &Path) {
    let record = default(path);
    assert_eq!((record.channels(), record.len(), record.dt()), (4, 222_400, 3.125e-4));
    assert_eq!((record.quantity(), record.unit()), (Quantity::Acceleration, "m/s2"));
    assert_eq!(record.names()[3], "MPS set1 Dof4");
    let first = (0.080_148_339_271_545_41, 0.137_897_148_728_370_67, 16_068.767_305_360_794);
    assert_facts(record.channel(0), (first.0, first.1, first.2, 0.345_068_424_940_109_25, 136_631));
    let fourth = (0.153_463_900_089_263_92, 28_644.612_831_758_8);
    let found = facts(record.channel(3));
    assert_eq!((found.0, found.3, found.4), (fourth.0, 0.273_485_034_704_208_4, 196_111));
    assert!((found.2 - fourth.1).abs() < 1e-6);
    // The counts of this copy agree with its data (222,400 points, 889,600 bytes each): nothing to warn of.
    assert!(record.warnings().is_empty(), "{:?}", record.warnings());
}

fn wrong_counts_in_the_same_file_are_warned_of(path: &Path) {
    let (bytes, whole) = (std::fs::read(path).unwrap(), default(path));
    for (good, bad) in [("889600", "889610"), ("222400", "222407"), ("889600", "     0")] {
        let broken = replace(&bytes, good.as_bytes(), bad.as_bytes());
        let record = read_bytes(path, &broken, &ReadOptions::default()).unwrap();
        assert!(record.samples() == whole.samples(), "{bad}");
        assert_eq!(record.warnings().len(), 4, "{bad}: {:?}", record.warnings());
        let is_count = |w: &Warning| matches!(w, Warning::Count { .. } | Warning::Bytes { .. });
        assert!(record.warnings().iter().all(is_count));
    }
}

/// All occurrences in the text of the headers; the data hold none.
fn replace(bytes: &[u8], from: &[u8], to: &[u8]) -> Vec<u8> {
    let mut out = bytes.to_vec();
    for at in 0..=bytes.len() - from.len() {
        if bytes[at..].starts_with(from) {
            out[at..at + to.len()].copy_from_slice(to);
        }
    }
    out
}

fn eight_byte_binary_and_a_last_line_not_full(path: &Path) {
    let record = default(path);
    assert_eq!((record.len(), record.dt(), record.unit()), (250, 0.01, "g"));
    assert_facts(record.channel(0), (0.0, 0.309_019_356_966_018_7, 6.313_748_425_276_373, 1.0, 5));
    let record = default(&path.with_file_name("time_history_partial_columns.uff"));
    assert_eq!((record.len(), record.dt(), record.unit()), (13, 5e-5, "m/s\u{b2}"));
    assert_eq!((record.quantity(), record.names()[0].as_str()), (Quantity::Acceleration, "1x : m/s\u{b2}"));
    assert_facts(record.channel(0), (-3.81956, -5.84096, -47.70823, 5.84096, 12));
}

fn a_file_cut_short_and_a_spectrum_are_named_as_such(path: &Path) {
    let error = read(path, &ReadOptions::default()).unwrap_err();
    assert!(matches!(error, ReadError::CutShort { promised: 2_508_876, found: 42, .. }), "{error}");
    assert!(error.to_string().contains("cut short"));
    let spectrum = path.with_file_name("non_ascii_header.uff");
    let error = read(&spectrum, &ReadOptions::default()).unwrap_err();
    assert!(
        matches!(error, ReadError::Unsupported { .. }) && error.to_string().contains("complex"),
        "{error}"
    );
}

field::field_tests! {
    the_brake_reuss_record_is_found_without_options on "field/brb_hammer_impact.mat",
    struct_fields_are_chosen_by_path on "field/brb_hammer_impact.mat",
    ascii_and_binary_datasets_agree on "uff/sample_58_ascii.uff",
    four_channels_of_an_analyser on "uff/four_channels_58b_broken_count.uff",
    wrong_counts_in_the_same_file_are_warned_of on "uff/four_channels_58b_broken_count.uff",
    eight_byte_binary_and_a_last_line_not_full on "uff/binary_8byte.uff",
    a_file_cut_short_and_a_spectrum_are_named_as_such on "uff/milestone_in_header.uff",
}
