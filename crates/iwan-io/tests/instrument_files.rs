//! Files of sound recorders, LabVIEW, and cells and HDF5 of MATLAB.
#![allow(clippy::unwrap_used)]

use crate::common::instruments::{lvm, mat_7_3, mat_7_3_circle, mat_cells, wav, wav_wave};
use crate::common::wave;
use iwan_io::{Quantity, ReadError, ReadOptions, Record, Warning, mat_matrices, read_bytes};
use std::path::Path;

fn read(name: &str, bytes: &[u8]) -> Result<Record, ReadError> {
    read_bytes(Path::new(name), bytes, &ReadOptions::default())
}

fn refused(name: &str, bytes: &[u8]) -> String {
    read(name, bytes).unwrap_err().to_string()
}

#[test]
fn sound_of_every_width_is_part_of_full_scale() {
    for (format, bits, data) in [
        (1, 8, vec![0, 128, 192]),
        (1, 16, [-32_768_i16, 0, 16_384].iter().flat_map(|v| v.to_le_bytes()).collect()),
        (1, 24, vec![0, 0, 0x80, 0, 0, 0, 0, 0, 0x40]),
        (1, 32, [i32::MIN, 0, 1 << 30].iter().flat_map(|v| v.to_le_bytes()).collect()),
        (3, 32, [-1.0_f32, 0.0, 0.5].iter().flat_map(|v| v.to_le_bytes()).collect()),
        (3, 64, [-1.0_f64, 0.0, 0.5].iter().flat_map(|v| v.to_le_bytes()).collect()),
    ] {
        let record = read("a.wav", &wav(format, bits, 1, 8000, &data)).unwrap();
        assert_eq!((record.channel(0), record.dt()), (&[-1.0, 0.0, 0.5][..], 1.25e-4), "{bits}");
        assert_eq!((record.unit(), record.quantity()), ("full scale", Quantity::Unknown));
    }
    let two: Vec<u8> = [1_i16, 2, 3, -4].iter().flat_map(|v| (v * 8192).to_le_bytes()).collect();
    let record = read("a.wav", &wav(1, 16, 2, 8000, &two)).unwrap();
    assert_eq!((record.channels(), record.channel(1)), (2, &[0.5, -1.0][..]));
}

#[test]
fn broken_sound_is_named() {
    let whole = wav_wave(20);
    let record = read("a.wav", &whole[..whole.len() - 10]).unwrap();
    assert_eq!(record.len(), 15);
    assert!(matches!(record.warnings(), [Warning::Count { promised: 20, found: 15, .. }]));
    assert!(refused("a.wav", &wav(2, 16, 1, 8000, &[0; 8])).contains("format 2"));
    assert!(refused("a.wav", &wav(1, 12, 1, 8000, &[0; 8])).contains("12 bits"));
    assert!(refused("a.wav", &wav(1, 16, 0, 8000, &[0; 8])).contains("0 channels"));
    assert!(refused("a.wav", &wav(1, 16, 1, 8000, &[0; 2])).contains("cut short"));
    assert!(refused("a.wav", &whole[..30]).contains("cut short"));
    assert!(refused("a.wav", b"RIFF....WAVE").contains("cut short"));
}

/// Recorders of more than two channels or 16 bits name the format in an extension, and its first two bytes are the number.
#[test]
fn sound_whose_format_stands_in_an_extension_is_read() {
    let data: Vec<u8> = [-1.0_f32, 0.0, 0.5].iter().flat_map(|v| v.to_le_bytes()).collect();
    let mut file = wav(0xfffe, 32, 1, 8000, &data);
    // 22 bytes more: valid bits, positions of loudspeakers, and the identifier that begins with the format.
    let extension = [&[22, 0, 32, 0, 0, 0, 0, 0, 3, 0][..], &[0; 14]].concat();
    file.splice(36..36, extension);
    file[16] = 40;
    assert_eq!(read("a.wav", &file).unwrap().channel(0), [-1.0, 0.0, 0.5]);
    file[44] = 1;
    assert_eq!(
        read("a.wav", &file).unwrap().channel(0)[0],
        f64::from((-1.0_f32).to_bits().cast_signed()) / 2.0_f64.powi(31)
    );
    file[44] = 2;
    assert!(refused("a.wav", &file).contains("samples of format 2"), "{}", refused("a.wav", &file));
}

#[test]
fn labview_times_in_other_units_become_seconds() {
    let text = "LabVIEW Measurement\t\nSeparator\tTab\nX_Columns\tOne\n***End_of_Header***\t\nChannels\t1\nX_Unit_Label\tms\nDelta_X\t0.5\n***End_of_Header***\nX_Value\ta\tComment\n0\t1\n0.5\t2\n1.0\t3\n";
    let record = read("a.lvm", text.as_bytes()).unwrap();
    assert!((record.dt() - 5e-4).abs() < 1e-18, "{}", record.dt());
    assert_eq!(record.warnings()[0].to_string(), "times in ms were multiplied by 1e-3 to give seconds");
}

#[test]
fn labview_without_times_and_interval_asks_for_the_rate() {
    let text = "LabVIEW Measurement\t\nSeparator\tTab\nX_Columns\tNo\n***End_of_Header***\t\nChannels\t1\n***End_of_Header***\nX_Value\ta\tComment\n\t1\n\t2\n\t3\n";
    let message = refused("a.lvm", text.as_bytes());
    assert!(message.contains("no time is stored; give the sampling rate with --rate HZ"), "{message}");
    let options = ReadOptions { rate: Some(4.0), ..Default::default() };
    let record = read_bytes(Path::new("a.lvm"), text.as_bytes(), &options).unwrap();
    assert_eq!((record.dt(), record.channel(0)), (0.25, &[1.0, 2.0, 3.0][..]));
}

#[test]
fn labview_segments_that_follow_each_other_are_one_record() {
    let record = read("a.lvm", &lvm(40)).unwrap();
    assert_eq!((record.names(), record.dt()), (&["acc".to_string(), "back".to_string()][..], 7.8125e-3));
    assert_eq!((record.unit(), record.quantity()), ("m/s^2", Quantity::Acceleration));
    assert_eq!(record.channel(0), &wave(40)[..]);
    assert!(record.channel(0).iter().zip(record.channel(1)).all(|(a, b)| a + b == 0.0));
    let text = String::from_utf8(lvm(40)).unwrap();
    let gap = text.replacen("X0\t1.5625E-1\t1.5625E-1", "X0\t3E-1\t3E-1", 1);
    assert!(
        refused("a.lvm", gap.as_bytes()).contains("do not follow each other"),
        "{}",
        refused("a.lvm", gap.as_bytes())
    );
    let word = text.replacen("\t0\t-0", "\tx\t-0", 1);
    assert!(refused("a.lvm", word.as_bytes()).contains("found 'x'"));
    assert!(refused("a.lvm", &lvm(40)[..60]).contains("End_of_Header"));
}

/// No columns of X, a comma for the decimal sign, and the start and the interval in the header only.
#[test]
fn labview_without_x_and_with_a_decimal_comma() {
    let text = "LabVIEW Measurement\t\nSeparator\tTab\nDecimal_Separator\t,\nX_Columns\tNo\n***End_of_Header***\t\nChannels\t1\nX0\t0,5\nDelta_X\t0,25\n***End_of_Header***\nX_Value\tUntitled\tComment\n\t1,5\n\t2,5\n\t-1E-1\n";
    let record = read("a.lvm", text.as_bytes()).unwrap();
    assert_eq!((record.channel(0), record.dt(), record.start()), (&[1.5, 2.5, -0.1][..], 0.25, 0.5));
    assert_eq!(record.names(), ["Untitled"]);
}

/// LabVIEW writes such files without any header on request: a table as others are.
#[test]
fn labview_without_a_header_is_a_table() {
    let text = "0,000000\t1,5\t5\n0,500000\t2,5\t6\n1,000000\t3,5\t7\n";
    let record = read("a.lvm", text.as_bytes()).unwrap();
    assert_eq!(record.dt(), 0.5);
    assert_eq!((record.channel(0), record.channel(1)), (&[1.5, 2.5, 3.5][..], &[5.0, 6.0, 7.0][..]));
}

#[test]
fn the_binary_format_of_labview_is_named() {
    let message = refused("a.tdms", b"TDSm\x0e\0\0\0\x69\x12\0\0");
    assert!(message.contains("TDMS of LabVIEW") && message.contains(".lvm, CSV or .mat"), "{message}");
}

/// A program that thins samples out left the header as it was: 51,200 Hz were read for 1,600.
#[test]
fn labview_times_that_contradict_the_header_are_named() {
    let text = |x: &str| {
        format!(
            "LabVIEW Measurement\t\nSeparator\tTab\nX_Columns\tOne\n***End_of_Header***\t\nChannels\t1\nDelta_X\t1.953125E-5\n***End_of_Header***\nX_Value\ta\tComment\n{x}"
        )
    };
    let thinned = text("0.000000\t1\n0.000625\t2\n0.001250\t3\n");
    let message = refused("a.lvm", thinned.as_bytes());
    assert!(
        message.contains("steps of 6.250000e-4 in the column X_Value where Delta_X is 1.953125e-5"),
        "{message}"
    );
    assert!(message.contains("--rate"), "{message}");
    let options = ReadOptions { rate: Some(1600.0), ..ReadOptions::default() };
    assert_eq!(read_bytes(Path::new("a.lvm"), thinned.as_bytes(), &options).unwrap().dt(), 6.25e-4);
    // Rounded to more than the interval, as those are who write three digits.
    let row = |n: u32| format!("{:.3}\t1", f64::from(n) * 1.953_125e-5);
    let coarse = text(&(0..200).map(row).collect::<Vec<_>>().join("\n"));
    assert_eq!(read("a.lvm", coarse.as_bytes()).unwrap().dt(), 1.953125e-5);
    // Rounded to the microsecond, as LabVIEW writes them.
    assert_eq!(
        read("a.lvm", text("0.000000\t1\n0.000020\t2\n0.000039\t3\n").as_bytes()).unwrap().dt(),
        1.953125e-5
    );
}

/// A file of LabVIEW whose parts are given.
fn labview(x_columns: &str, header: &str, names: &str, rows: &str) -> String {
    format!(
        "LabVIEW Measurement,\nSeparator,Comma\nX_Columns,{x_columns}\n***End_of_Header***,\n{header}***End_of_Header***,\n{names}\n{rows}"
    )
}

/// Rows of one channel with X to six decimals, as LabVIEW writes them.
fn rows_every(dt: f64, n: u32) -> String {
    let row = |i: u32| format!("{:.6},{i}", dt * f64::from(i));
    (0..n).map(row).collect::<Vec<_>>().join("\n")
}

/// `Delta_X` 0.000156 beside a column at 6400 Hz was read as 6410 Hz.
#[test]
fn labview_intervals_rounded_in_the_header_come_from_the_column() {
    let text = |dt: f64| {
        labview("One", "Channels,1\nDelta_X,0.000156\n", "X_Value,a,Comment", &rows_every(dt, 2000))
    };
    let record = read("a.lvm", text(1.0 / 6400.0).as_bytes()).unwrap();
    assert!((record.rate() - 6400.0).abs() < 0.02, "{}", record.rate());
    assert!(
        matches!(record.warnings(), [Warning::RoundedTime { quantum, .. }] if (quantum - 1e-6).abs() < 1e-12)
    );
    // Half a unit of the last digit is 0.32 % here: 1 % off is another interval.
    let message = refused("a.lvm", text(0.000_157_6).as_bytes());
    assert!(
        message.contains("steps of 1.57") && message.contains("name X_Value with --time NAME"),
        "{message}"
    );
    // Four samples tell less than the header does.
    let short = labview("One", "Channels,1\nDelta_X,0.00015625\n", "X_Value,a", &rows_every(0.000_156_1, 4));
    assert_eq!(read("a.lvm", short.as_bytes()).unwrap().dt(), 1.562_5e-4);
    let obeyed = ReadOptions { time: Some("X_Value".into()), ..Default::default() };
    let record = read_bytes(Path::new("a.lvm"), text(0.000_157_6).as_bytes(), &obeyed).unwrap();
    assert!((record.dt() - 1.576e-4).abs() < 1e-9, "{}", record.dt());
}

/// The interval of the first channel, which holds the times, was taken for all: 1 Hz.
#[test]
fn labview_channels_have_intervals_of_their_own() {
    let header = "Channels,3\nY_Unit_Label,s,g,g\nDelta_X,1.0,0.0006,0.0005\n";
    let text = labview("No", header, ",time,shock,board", ",0.0000,1,4\n,0.0006,2,5\n,0.0012,3,\n");
    let read = |channels: &[&str], time: Option<&str>| {
        let channels = channels.iter().map(|c| (*c).to_string()).collect();
        let options = ReadOptions { channels, time: time.map(String::from), ..Default::default() };
        read_bytes(Path::new("a.lvm"), text.as_bytes(), &options)
    };
    for (name, dt, samples) in [("shock", 6e-4, &[1.0, 2.0, 3.0][..]), ("board", 5e-4, &[4.0, 5.0])] {
        let record = read(&[name], None).unwrap();
        assert_eq!((record.dt(), record.channel(0), record.unit()), (dt, samples, "g"));
    }
    let message = read(&["shock", "board"], None).unwrap_err().to_string();
    assert!(
        message.contains("'board' has interval 5e-4 s") && message.contains("'shock' has; choose"),
        "{message}"
    );
    for (name, samples) in [("shock", 3), ("board", 2)] {
        let record = read(&[name], Some("time")).unwrap();
        assert!((record.dt() - 6e-4).abs() < 1e-15 && record.len() == samples, "{name}");
    }
    let message = read(&["shock", "board"], Some("time")).unwrap_err().to_string();
    assert!(message.contains("'board' has 2 samples, expected 3 samples as 'shock' has"), "{message}");
    let message = read(&["shock"], Some("X_Value")).unwrap_err().to_string();
    assert!(message.contains("no time 'X_Value'; there are: time, shock, board"), "{message}");
    let multi = labview(
        "Multi",
        "Channels,2\nDelta_X,0.5,0.25\n",
        "X_Value,a,X_Value,b,Comment",
        "0,1,0,5\n0.5,2,0.25,6\n1,3,0.5,7\n",
    );
    let options = ReadOptions { channels: vec!["b".into()], ..Default::default() };
    assert_eq!(read_bytes(Path::new("a.lvm"), multi.as_bytes(), &options).unwrap().dt(), 0.25);
}

/// The column that LabVIEW leaves empty where there is no X was headed by nothing, and every name stood one channel too late.
#[test]
fn labview_names_stand_behind_a_heading_of_x_that_is_empty() {
    for names in [",a,b", "X_Value,a,b,Comment", ",a,b,Comment"] {
        let text = labview("No", "Channels,2\nDelta_X,0.5,0.5\n", names, ",1,5\n,2,6\n");
        let record = read("a.lvm", text.as_bytes()).unwrap();
        assert_eq!(
            (record.names(), record.channel(0)),
            (&["a".to_string(), "b".to_string()][..], &[1.0, 2.0][..])
        );
    }
}

/// Two channels of one name were both read as the first.
#[test]
fn labview_channels_of_one_name_are_each_their_own() {
    let text = "LabVIEW Measurement\t\nSeparator\tTab\nX_Columns\tNo\n***End_of_Header***\t\nChannels\t2\nDelta_X\t0.5\t0.5\nY_Unit_Label\tm/s^2\tm/s^2\n***End_of_Header***\nX_Value\tUntitled\tUntitled\tComment\n\t1\t5\n\t2\t6\n";
    let record = read("a.lvm", text.as_bytes()).unwrap();
    assert_eq!(record.names(), ["Untitled", "Untitled"]);
    assert_eq!((record.channel(0), record.channel(1)), (&[1.0, 2.0][..], &[5.0, 6.0][..]));
}

#[test]
fn labview_with_x_for_every_channel() {
    let text = "LabVIEW Measurement\t\nSeparator\tTab\nX_Columns\tMulti\n***End_of_Header***\t\nChannels\t2\n***End_of_Header***\nX_Value\ta\tX_Value\tb\tComment\n0\t1\t0\t5\n0.5\t2\t0.5\t6\n1\t3\t1\t7\n";
    let record = read("a.lvm", text.as_bytes()).unwrap();
    assert_eq!((record.names(), record.dt()), (&["a".to_string(), "b".to_string()][..], 0.5));
    assert_eq!((record.channel(0), record.channel(1)), (&[1.0, 2.0, 3.0][..], &[5.0, 6.0, 7.0][..]));
}

#[test]
fn cells_of_matlab_are_channels_by_their_subscripts() {
    let record = read("a.mat", &mat_cells(40)).unwrap();
    assert_eq!(record.names(), ["x{1,1}", "x{1,2}"]);
    assert_eq!(record.channel(0), &wave(40)[..]);
    let options = ReadOptions { channels: vec!["x{1,2}".into()], ..Default::default() };
    let record = read_bytes(Path::new("a.mat"), &mat_cells(40), &options).unwrap();
    assert_eq!(record.channel(0)[3], -wave(40)[3]);
}

#[test]
fn matlab_7_3_reads_as_level_5_does() {
    let record = read("a.mat", &mat_7_3(40)).unwrap();
    assert_eq!((record.names(), record.dt()), (&["d.acc".to_string()][..], 1.0 / 128.0));
    assert_eq!((record.channel(0), record.quantity()), (&wave(40)[..], Quantity::Acceleration));
    let bytes = mat_7_3(40);
    assert!(refused("a.mat", &bytes[..600]).contains("HDF5"));
}

/// Four cells that hold the struct in which they stand were followed to every depth, sixty-five thousand times.
#[test]
fn matlab_structs_that_hold_themselves_are_refused() {
    let error = mat_matrices(Path::new("a.mat"), &mat_7_3_circle(4)).unwrap_err().to_string();
    assert!(error.contains("more than a file of") && error.contains("nothing that holds itself"), "{error}");
    assert!(!mat_matrices(Path::new("a.mat"), &mat_7_3_circle(1)).unwrap().is_empty());
}
