//! Text files as instruments, spreadsheets and programs write them.
#![allow(clippy::unwrap_used)]

use iwan_io::{Quantity, ReadError, ReadOptions, Record, TimeUnit, Warning, parse_table, read_bytes};
use std::fmt::Write;
use std::path::Path;

fn read_with(text: &[u8], options: &ReadOptions) -> Result<Record, ReadError> {
    read_bytes(Path::new("a.csv"), text, options)
}

fn accepted(text: &str) -> Record {
    read_with(text.as_bytes(), &ReadOptions::default()).unwrap()
}

fn refused(text: &str) -> String {
    read_with(text.as_bytes(), &ReadOptions::default()).unwrap_err().to_string()
}

#[test]
fn the_same_record_in_many_layouts() {
    for text in [
        "t,acc\n0,1\n0.5,2\n1,4\n",
        "t;acc\n0;1\n0,5;2\n1;4\n",
        "t\tacc\r\n0\t1\r\n0,5\t2\r\n1\t4\r\n",
        "  t   acc\n 0.0  1\n 0.5 2 \n 1.0\t4\n",
        "\u{feff}t,acc\n0,1\n0.5,2\n1,4",
        "# t,acc\n0,1\n0.5,2\n% remark\n1,4\n\n",
        "t,acc,\n0,1,\n0.5,2,\n1,4,\n",
        "\"t\",\"acc\"\n\"0\",\"1\"\n0.5,2\n1,4\n",
        "Instrument 7\nSerial: 12\nt,acc\n0,1\n0.5,2\n1,4\n",
        "t,acc\n0,1.0D+00\n5.0D-01,2\n1,4\n",
    ] {
        let record = accepted(text);
        assert_eq!((record.dt(), record.start()), (0.5, 0.0), "{text}");
        assert_eq!(record.channel(0), [1.0, 2.0, 4.0], "{text}");
        assert_eq!(record.names(), ["acc"], "{text}");
        assert_eq!(record.quantity(), Quantity::Acceleration, "{text}");
    }
}

#[test]
fn units_come_from_the_header_or_a_second_one() {
    for text in ["Time [ms],a [g]\n0,1\n1,2\n2,3\n", "Time,a\nms,g\n0,1\n1,2\n2,3\n"] {
        let record = accepted(text);
        assert!((record.dt() - 1e-3).abs() < 1e-15, "{text}");
        assert_eq!((record.unit(), record.quantity()), ("g", Quantity::Acceleration), "{text}");
        assert!(matches!(record.warnings(), [Warning::TimeScaled { .. }]), "{text}");
    }
}

#[test]
fn a_first_column_that_increases_uniformly_is_the_time() {
    let record = accepted("0,5\n0.1,7\n0.2,6\n");
    assert_eq!(record.names(), ["column 2"]);
    assert!(matches!(record.warnings(), [Warning::TimeAssumed { .. }]));
}

#[test]
fn without_a_time_the_rate_is_asked_for() {
    let text = "a,b\n3,5\n1,7\n2,6\n";
    assert!(refused(text).contains("--rate HZ"), "{}", refused(text));
    let record = read_with(text.as_bytes(), &ReadOptions { rate: Some(4.0), ..Default::default() }).unwrap();
    assert_eq!((record.dt(), record.channels()), (0.25, 2));
    let zero = ReadOptions { rate: Some(0.0), ..Default::default() };
    assert!(matches!(read_with(text.as_bytes(), &zero), Err(ReadError::Rate { value: 0.0, .. })));
}

#[test]
fn damaged_rows_are_named_by_line_and_column() {
    assert!(refused("t,a\n0,1\n1,x\n2,3\n").contains("line 3, column 2: found 'x'"));
    assert!(refused("t,a\n0,abc\n1,2\n2,3\n").contains("line 2, column 2: found 'abc'"));
    assert!(refused("t,a\n0,1\n1\n2,3\n").contains("line 3: found 1 fields"));
    assert!(refused("t,a\n0,1\n1,\n2,3\n").contains("line 3"));
    assert!(refused("t,a\n0,1\n1,NaN\n2,3\n").contains("'a', sample 1"));
    assert!(refused("").contains("an empty file"));
    assert!(refused("just words\n").contains("rows of numbers"));
}

#[test]
fn uneven_times_are_refused_or_resampled() {
    let mut text = "t,a\n".to_string();
    for i in 0..40 {
        writeln!(text, "{},{}", i * i, 2 * i * i).unwrap();
    }
    assert!(refused(&text).contains("--resample"), "{}", refused(&text));
    let options = ReadOptions { resample: true, ..Default::default() };
    let record = read_with(text.as_bytes(), &options).unwrap();
    assert_eq!((record.len(), record.dt()), (40, 39.0));
    for (i, v) in record.channel(0).iter().enumerate() {
        assert!((v - 78.0 * i as f64).abs() < 1e-9);
    }
    assert!(matches!(record.warnings(), [Warning::Resampled { .. }]));
    assert!(refused("t,a\n0,1\n2,1\n1,1\n").contains("runs backwards in row 3 of the numbers (sample 2"));
}

#[test]
fn units_of_time_are_known_asked_for_or_told() {
    for (header, dt) in [
        ("Time [minutes]", 60.0),
        ("Time (min)", 60.0),
        ("time / h", 3600.0),
        ("TIME [MS]", 1e-3),
        ("t [\u{b5}s]", 1e-6),
        ("time_us", 1e-6),
        ("Time {ns}", 1e-9),
        ("t/ms", 1e-3),
    ] {
        let record = accepted(&format!("{header},a [g]\n0,1\n1,2\n2,3\n"));
        assert!((record.dt() / dt - 1.0).abs() < 1e-12, "{header}: {}", record.dt());
    }
    let furlong = "Time [furlong],a [g]\n0,1\n1,2\n2,3\n";
    let message = refused(furlong);
    assert!(message.contains("'furlong'") && message.contains("--time-unit"), "{message}");
    let message = refused("Time [samples],a [g]\n0,1\n1,2\n2,3\n");
    assert!(message.contains("it counts samples") && message.contains("--rate HZ"), "{message}");
    let told = ReadOptions { time_unit: Some(TimeUnit::Millisecond), ..Default::default() };
    assert!((read_with(furlong.as_bytes(), &told).unwrap().dt() - 1e-3).abs() < 1e-15);
    let rated = ReadOptions { rate: Some(4.0), ..Default::default() };
    assert_eq!(read_with(furlong.as_bytes(), &rated).unwrap().dt(), 0.25);
}

/// The rule: without a unit, 64 samples or more that would be fewer than 20 a second or last longer than 600 s are doubted.
#[test]
fn times_without_a_unit_that_are_unlike_seconds_are_doubted() {
    let text = |header: &str, step: f64, n: i32| {
        let rows: String =
            (0..n).fold(String::new(), |text, i| text + &format!("{},{}\n", f64::from(i) * step, i % 7));
        format!("{header},a [g]\n{rows}")
    };
    let doubted = |header: &str, step: f64, n: i32| {
        let record = accepted(&text(header, step, n));
        record.warnings().iter().any(|w| matches!(w, Warning::TimeUnitDoubtful { .. }))
    };
    assert!(doubted("t", 0.1, 100) && doubted("t", 0.02, 40_000));
    assert!(!doubted("t", 0.01, 1000) && !doubted("t", 0.1, 60));
    assert!(!doubted("t [ms]", 0.1, 100) && !doubted("t [s]", 0.1, 100));
    let told = ReadOptions { time_unit: Some(TimeUnit::Second), ..Default::default() };
    assert!(read_with(text("t", 0.1, 100).as_bytes(), &told).unwrap().warnings().is_empty());
}

#[test]
fn a_clock_that_stutters_is_named_with_its_row_and_what_helps() {
    let rows: String =
        (0..200).fold(String::new(), |text, i| text + &format!("{:.3},{}\n", 0.0006 * f64::from(i), i % 5));
    let text = format!("time [s],angle [deg]\n{rows}");
    let message = refused(&text);
    assert!(
        message.contains("in row") && message.contains("stutters") && message.contains("--resample"),
        "{message}"
    );
    assert!(message.contains("on average 1672"), "{message}");
    let record = read_with(text.as_bytes(), &ReadOptions { resample: true, ..Default::default() }).unwrap();
    assert_eq!((record.len(), record.quantity()), (200, Quantity::Displacement));
    let [Warning::Resampled { jitter, merged, .. }] = record.warnings() else {
        panic!("{:?}", record.warnings())
    };
    assert!(*merged > 50 && *jitter < 1e-3);
}

#[test]
fn samples_are_converted_on_request_and_never_otherwise() {
    let text = b"t [s],a [g]\n0,1\n1,2\n2,3\n";
    assert_eq!(read_with(text, &ReadOptions::default()).unwrap().channel(0), [1.0, 2.0, 3.0]);
    let to = |unit: &str| ReadOptions { unit: Some(unit.into()), ..Default::default() };
    let record = read_with(text, &to("SI")).unwrap();
    assert_eq!((record.channel(0)[2], record.unit()), (3.0 * 9.806_65, "m/s^2"));
    assert!(matches!(record.warnings(), [Warning::Converted { .. }]));
    let record = read_with(b"t [s],a [m/s^2]\n0,1\n1,2\n2,3\n", &to("mm/s^2")).unwrap();
    assert_eq!((record.channel(0)[0], record.unit()), (1000.0, "mm/s^2"));
    for (text, unit, word) in [
        (&b"t [s],a [g]\n0,1\n1,2\n2,3\n"[..], "mm", "different things"),
        (b"t [s],a\n0,1\n1,2\n2,3\n", "SI", "not known"),
        (b"t [s],a [g]\n0,1\n1,2\n2,3\n", "stone", "not known"),
        (b"t [s],a [mn]\n0,1\n1,2\n2,3\n", "SI", "two meanings"),
    ] {
        let message = read_with(text, &to(unit)).unwrap_err().to_string();
        assert!(message.contains(word) && message.contains("--unit"), "{message}");
    }
}

#[test]
fn records_of_two_clocks_are_refused_unless_one_is_named() {
    let text = b"t_steel [s],steel [g],t_alu [s],alu [g]\n0,1,0,7\n1,2,2,8\n2,3,4,9\n";
    let message = read_with(text, &ReadOptions::default()).unwrap_err().to_string();
    assert!(message.contains("t_steel, t_alu") && message.contains("--time NAME"), "{message}");
    let time = ReadOptions { time: Some("t_alu".into()), ..Default::default() };
    let record = read_with(text, &time).unwrap();
    assert_eq!((record.names(), record.dt()), (&["alu".to_string()][..], 2.0));
    let channel = ReadOptions { channels: vec!["steel".into()], ..Default::default() };
    assert_eq!(read_with(text, &channel).unwrap().dt(), 1.0);
}

#[test]
fn columns_of_several_quantities_need_a_choice() {
    let text = "t,tip.displacement,tip.velocity\n0,1,2\n1,3,4\n2,5,7\n";
    assert!(refused(text).contains("--quantity"), "{}", refused(text));
    let options = ReadOptions { quantity: Some(Quantity::Velocity), ..Default::default() };
    let record = read_with(text.as_bytes(), &options).unwrap();
    assert_eq!(
        (record.names(), record.channel(0)),
        (&["tip.velocity".to_string()][..], &[2.0, 4.0, 7.0][..])
    );
    let hammer = accepted("t,force [N],a1 [m/s^2],a2 [m/s^2]\n0,1,2,3\n1,1,2,3\n2,1,2,3\n");
    assert_eq!((hammer.channels(), hammer.quantity()), (2, Quantity::Acceleration));
    assert!(matches!(hammer.warnings(), [Warning::LeftOut { .. }]));
}

#[test]
fn a_rate_given_goes_before_the_times() {
    let options = ReadOptions { rate: Some(10.0), ..Default::default() };
    let record = read_with(b"t,a\n5,1\n6,2\n8,3\n", &options).unwrap();
    assert_eq!((record.dt(), record.start()), (0.1, 5.0));
    assert!(matches!(record.warnings(), [Warning::RateReplaced { .. }]));
}

fn chosen(text: &str, channels: &[&str]) -> Result<Record, ReadError> {
    let channels = channels.iter().map(|c| (*c).to_string()).collect();
    read_with(text.as_bytes(), &ReadOptions { channels, ..Default::default() })
}

/// Runs side by side were refused for the first empty cell behind the shortest of them, whatever channel was chosen.
#[test]
fn runs_of_unequal_length_are_read_each_to_its_end() {
    for [empty, two] in [["", ";;"], ["NA", "NA;NA;"]] {
        let rows =
            format!("0;1;0;5;9\n0,5;2;0,5;6;{empty}\n1;3;1;7;4\n1,5;4;{two}{empty}\n{two}{two}{empty}\n");
        let text = format!("Time (s) Run #1;Angle Run #1;Time (s) Run #2;Angle Run #2;late\n{rows}");
        for (name, samples) in
            [("Angle Run #1", &[1.0, 2.0, 3.0, 4.0][..]), ("Angle Run #2", &[5.0, 6.0, 7.0])]
        {
            let record = chosen(&text, &[name]).unwrap();
            assert_eq!((record.channel(0), record.dt()), (samples, 0.5), "{empty}");
        }
        let message = refused(&text.replace("1;3;1;7;4", &format!("1;3;1;7;{empty}")));
        assert!(
            message.contains("Angle Run #1 4, Time (s) Run #2 3") && message.contains("--channel"),
            "{message}"
        );
        let time = ReadOptions {
            channels: vec!["Angle Run #1".into(), "Angle Run #2".into()],
            time: Some("Time (s) Run #1".into()),
            ..Default::default()
        };
        let message = read_with(text.as_bytes(), &time).unwrap_err().to_string();
        assert!(
            message.contains("'Angle Run #2' has 3 samples, expected 4 samples as 'Angle Run #1' has"),
            "{message}"
        );
        // A hole before the end of a column is an error where the column is read.
        let late = ReadOptions { channels: vec!["late".into()], ..time };
        let message = read_with(text.as_bytes(), &late).unwrap_err().to_string();
        assert!(message.contains(&format!("line 3, column 5: found '{empty}'")), "{message}");
        assert!(parse_table(Path::new("a.csv"), text.as_bytes()).is_err());
    }
}

/// One time for several channels, as R exports them: the shorter channel ends where its first `NA` stands.
#[test]
fn a_time_goes_no_further_than_the_channel_that_is_chosen() {
    let text = "Time,Angle 1,Angle 2\n0,1,5\n0.5,2,6\n1,3,7\n1.5,4,NA\nNA,5,NA\n";
    let record = chosen(text, &["Angle 2"]).unwrap();
    assert_eq!((record.channel(0), record.dt()), (&[5.0, 6.0, 7.0][..], 0.5));
    let message = chosen(text, &["Angle 1"]).unwrap_err().to_string();
    assert!(message.contains("'Angle 1' has 5 samples, expected 4 samples as 'Time' has"), "{message}");
    let holes = chosen(&text.replace("1,3,7", "1,NA,7"), &["Angle 1"]).unwrap_err().to_string();
    assert!(holes.contains("line 4, column 2: found 'NA'"), "{holes}");
}

/// The message said that no time is stored, beside a column of times that are not quite even.
#[test]
fn a_first_column_that_rises_unevenly_is_asked_about() {
    let text = "0,5\n0.1,7\n0.25,6\n0.3,6\n";
    assert!(
        refused(text).contains("'column 1' rises from row to row, unevenly, by 1.0000e-1 on average"),
        "{}",
        refused(text)
    );
    assert!(
        refused(text).contains("name the time with --time NAME (there are: column 1"),
        "{}",
        refused(text)
    );
    assert!(refused("0,5\n0.2,7\n0.1,6\n0.3,6\n").contains("no time is stored"));
    let rated = ReadOptions { rate: Some(10.0), ..Default::default() };
    assert_eq!(read_with(text.as_bytes(), &rated).unwrap().channels(), 2);
}

/// Oscilloscopes write settings into the first columns of the first rows, beside the samples.
#[test]
fn samples_beside_the_settings_of_an_oscilloscope() {
    let text = "Record Length,2.5e+03,,  -0.50,  -6.0,\nUnits,V,,  0.00,  4.0,\n,,,  0.50,  5.0,\n,,,00.75,6.0,\n,,,01.00,x,\n";
    let message = refused(text);
    assert!(message.contains("line 5, column 5: found 'x'"), "{message}");
    assert!(refused(&text.replace(",,,01.00,x,", "Pt,Y")).contains("line 5: found 2 fields, expected 5"));
    let record = accepted(&text.replace('x', "6.0").replace(",,,00.75,6.0,\n", ""));
    assert_eq!(
        (record.names(), record.channel(0)),
        (&["column 5".to_string()][..], &[-6.0, 4.0, 5.0, 6.0][..])
    );
    assert_eq!((record.dt(), record.start()), (0.5, -0.5));
    assert!(matches!(record.warnings(), [Warning::TimeAssumed { name }] if name == "column 4"));
}

#[test]
fn latin_1_headers_and_utf_16_files() {
    let record = read_with(b"t;a [m/s\xb2]\n0;1\n1;2\n2;3\n", &ReadOptions::default()).unwrap();
    assert_eq!((record.unit(), record.quantity()), ("m/s\u{b2}", Quantity::Acceleration));
    let wide: Vec<u8> = "\u{feff}t,a\n0,1\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
    let error = read_with(&wide, &ReadOptions::default()).unwrap_err().to_string();
    assert!(error.contains("UTF-8"), "{error}");
}

#[test]
fn a_force_history_is_a_table() {
    let table = parse_table(Path::new("f.txt"), b"# haversine\nt force\n0 0\n1e-3 10\n5e-3 0\n").unwrap();
    assert_eq!(table.names(), ["t", "force"]);
    assert_eq!((table.rows(), table.column("t").unwrap()), (3, &[0.0, 1e-3, 5e-3][..]));
}

#[test]
fn columns_of_a_table_have_units_and_what_was_noticed() {
    let table = parse_table(Path::new("f.csv"), b"made by hand\nt [s];force [N]\n0;0\n1;10\n").unwrap();
    assert_eq!(table.units(), ["s", "N"]);
    assert!(matches!(table.warnings(), [Warning::Preamble { lines: 1 }]), "{:?}", table.warnings());
}

/// Times of three digits at 300 Hz: the intervals are 3 and 4 ms, and the rate is known all the same.
#[test]
fn times_rounded_to_their_digits_are_even() {
    let rows: String =
        (0..200).fold(String::new(), |text, i| text + &format!("{:.3},{}\n", f64::from(i) / 300.0, i % 5));
    let record = accepted(&format!("t [s],a [g]\n{rows}"));
    assert!((record.dt() * 300.0 - 1.0).abs() < 1e-4, "{}", record.dt());
    let [Warning::RoundedTime { quantum, .. }] = record.warnings() else { panic!("{:?}", record.warnings()) };
    assert!((quantum * 1e3 - 1.0).abs() < 1e-9, "{quantum}");
}

#[test]
fn the_users_word_on_the_quantity_goes_before_the_files() {
    let options = ReadOptions { quantity: Some(Quantity::Velocity), ..Default::default() };
    let record = read_with(b"t,a [m/s^2]\n0,1\n1,2\n2,3\n", &options).unwrap();
    assert_eq!((record.quantity(), record.channel(0)), (Quantity::Velocity, &[1.0, 2.0, 3.0][..]));
    assert_eq!(record.warnings()[0].to_string(), "the file says acceleration, velocity was used as told");
}

#[test]
fn beside_a_force_what_is_not_known_may_be_the_motion() {
    let record = accepted("t,force [N],x\n0,1,2\n1,1,3\n2,1,4\n");
    assert_eq!((record.names(), record.quantity()), (&["x".to_string()][..], Quantity::Unknown));
    assert_eq!(record.warnings()[0].to_string(), "'force' was left out: it measures force, not a motion");
    // Pressure, voltage and strain are known by their units and names, and are no motions.
    for (header, quantity) in [("p [Pa]", "pressure"), ("u [V]", "voltage"), ("strain 1", "strain")] {
        let record = accepted(&format!("t,{header},acc\n0,1,2\n1,1,3\n2,1,4\n"));
        let left = record.warnings()[0].to_string();
        assert!(left.ends_with(&format!("was left out: it measures {quantity}, not acceleration")), "{left}");
    }
}

#[test]
fn times_must_be_several_finite_numbers() {
    let named = ReadOptions { time: Some("t".into()), ..Default::default() };
    let refused = |text: &str| read_with(text.as_bytes(), &named).unwrap_err().to_string();
    let single = refused("t,a\n0,1\n");
    assert!(
        single.contains("time 't': found an array of 1 x 1 values, expected a vector of times"),
        "{single}"
    );
    let hole = refused("t,a\n0,1\nNaN,2\n2,3\n");
    assert!(
        hole.contains("'t', sample 1 (counted from 0): found NaN, expected a finite time in seconds"),
        "{hole}"
    );
}

/// A clock that stands still was said to stutter at infinitely many samples a second on average.
#[test]
fn a_clock_that_stands_still_is_named() {
    let text = "t,a\n1,1\n1,2\n1,3\n";
    for resample in [false, true] {
        let options = ReadOptions { resample, ..Default::default() };
        let message = read_with(text.as_bytes(), &options).unwrap_err().to_string();
        assert!(message.contains("'t': found 1 s at all 3 samples"), "{message}");
        assert!(message.contains("--rate HZ") && !message.contains("inf"), "{message}");
    }
    let rated = ReadOptions { rate: Some(4.0), ..Default::default() };
    assert_eq!(read_with(text.as_bytes(), &rated).unwrap().dt(), 0.25);
}

#[test]
fn two_samples_are_resampled_along_a_line() {
    let options = ReadOptions { resample: true, ..Default::default() };
    let record = read_with(b"t [s],a\n0,1\n0,3\n1,4\n", &options).unwrap();
    assert_eq!((record.dt(), record.channel(0)), (0.5, &[2.0, 3.0, 4.0][..]));
}

#[test]
fn a_table_of_more_columns_than_any_instrument_has_is_refused() {
    let row = vec!["1"; 10_001].join(",");
    let message = refused(&format!("{row}\n{row}\n"));
    assert!(
        message.contains("found 10001 columns, expected at most 10000"),
        "{}",
        &message[..200.min(message.len())]
    );
}

/// A force in pounds was combined with accelerations in g.
#[test]
fn what_is_no_motion_is_left_out_beside_one() {
    for unit in ["Pounds", "lbf", "Pferd"] {
        let record = accepted(&format!("t [s],force [{unit}],acc [g]\n0,1,2\n0.5,2,3\n1,4,5\n"));
        assert_eq!((record.names(), record.quantity()), (&["acc".to_owned()][..], Quantity::Acceleration));
        let [Warning::LeftOut { name, reason }] = record.warnings() else {
            panic!("{:?}", record.warnings())
        };
        assert!(name == "force" && (reason.contains(unit) || reason.contains("measures force")), "{reason}");
    }
    // Without a unit it may be a motion like the others.
    assert_eq!(accepted("t [s],x,acc [g]\n0,1,2\n0.5,2,3\n1,4,5\n").names().len(), 2);
}

/// Loggers write the time of day, with strokes below the header, and a date above the table.
#[test]
fn times_of_day_are_times() {
    let logger = "2024-03-01 10:00:00\nTimestamp, Angle(deg)\n-----------------\n23:59:59.998, 1.5\n23:59:59.999, 2\n00:00:00.000, 1\n";
    let record = accepted(logger);
    assert_eq!((record.names(), record.channel(0)), (&["Angle".to_owned()][..], &[1.5, 2.0, 1.0][..]));
    assert!((record.dt() - 1e-3).abs() < 1e-9 && (record.start() - 86399.998).abs() < 1e-9);
    let dated =
        "time;acc [m/s^2]\n01.03.2024 10:00:00,25;1,5\n01.03.2024 10:00:00,50;2\n01.03.2024 10:00:00,75;3\n";
    assert_eq!((accepted(dated).dt(), accepted(dated).start()), (0.25, 36000.25));
    // A number among them is a damaged cell, and a clock among numbers is one.
    let damaged = "time;acc [m/s^2]\n10:00:00;1\n10:00:01;2\n17;3\n10:00:03;4\n";
    assert!(
        refused(damaged).contains("line 4, column 1") && refused(damaged).contains("'17'"),
        "{}",
        refused(damaged)
    );
    let damaged = "time;acc [m/s^2]\n0;1\n1;2\n10:00:02;3\n3;4\n";
    assert!(refused(damaged).contains("'10:00:02'"), "{}", refused(damaged));
}
