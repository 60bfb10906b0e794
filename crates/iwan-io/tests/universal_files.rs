//! Universal files of modal tests: shapes, geometry, functions of all kinds.
#![allow(clippy::unwrap_used)]

use crate::common::{number, uff_ascii, uff_header, wave};
use iwan_io::write_uff::{self, ModalScale, NodalMode};
use iwan_io::{
    NodalDirection, Quantity, ReadError, ReadOptions, Record, UffFunction, UffModel, read_bytes,
    read_modal_test, uff_functions, uff_model,
};
use std::f64::consts::TAU;
use std::path::Path;

fn read(bytes: &[u8]) -> Result<Record, ReadError> {
    read_bytes(Path::new("a.uff"), bytes, &ReadOptions::default())
}

fn model(text: &str) -> UffModel {
    uff_model(Path::new("a.uff"), text.as_bytes()).unwrap()
}

fn functions(bytes: &[u8]) -> (Vec<UffFunction>, Vec<String>) {
    let (functions, warnings) = uff_functions(Path::new("a.uff"), bytes).unwrap();
    (functions, warnings.iter().map(ToString::to_string).collect())
}

/// Values that the thirteen digits of the format hold whole.
fn eighths(n: usize) -> Vec<f64> {
    (0..n).map(|i| 0.125 * i as f64 - 0.25).collect()
}

/// A function of the kind at node 7, +z, with so many values.
fn function(kind: i64, quantity: Quantity, n: usize) -> UffFunction {
    let im = if kind == 4 { eighths(n).iter().map(|v| -2.0 * v).collect() } else { Vec::new() };
    UffFunction {
        name: format!("{quantity}"),
        kind,
        response: NodalDirection { node: 7, direction: 3 },
        reference: NodalDirection { node: 1, direction: 3 },
        quantity,
        unit: String::new(),
        start: 0.0,
        step: 0.25,
        re: eighths(n),
        im,
    }
}

/// A mode of a decay of 2 1/s at 30 rad/s, by the pole that the file has.
fn shape(pole: [f64; 2], scale: ModalScale, value: [f64; 2]) -> NodalMode {
    let values = vec![(4, [value, [0.0; 2], [1.0, 0.0]])];
    NodalMode { frequency: 0.0, damping_ratio: 0.0, pole, scale, values }
}

/// Some programs write the lower pole of a pair of conjugates: all that belongs to it is conjugated with it.
#[test]
fn a_mode_of_the_lower_pole_is_that_of_the_upper_one() {
    let upper = shape([-2.0, 30.0], ModalScale::A([0.5, 60.0]), [0.25, -0.75]);
    let lower = shape([-2.0, -30.0], ModalScale::A([0.5, -60.0]), [0.25, 0.75]);
    let [upper, lower] = [upper, lower].map(|m| model(&write_uff::modes(&[m])).modes.swap_remove(0));
    assert_eq!(upper, lower);
    let size = 2.0_f64.hypot(30.0);
    assert!((lower.frequency * TAU / size - 1.0).abs() < 1e-12);
    assert!((lower.damping_ratio * size / 2.0 - 1.0).abs() < 1e-12);
    assert_eq!((lower.pole, lower.scale), ([-2.0, 30.0], ModalScale::A([0.5, 60.0])));
    assert_eq!(lower.values[0].1[0], [0.25, -0.75]);
    // Without a scale there is nothing to normalise by.
    let unscaled = shape([-2.0, -30.0], ModalScale::Unknown, [0.25, 0.75]);
    let unscaled = model(&write_uff::modes(&[unscaled])).modes.swap_remove(0);
    assert_eq!((unscaled.scale, unscaled.pole), (ModalScale::Unknown, [-2.0, 30.0]));
    assert_eq!(unscaled.mass_normalised(), None);
}

/// Modal A of a real shape ψ of mass m is 2i ω m: both give the mass-normalised shape ψ/√m.
#[test]
fn a_modal_mass_is_written_as_the_modal_a_that_it_means() {
    let mode = shape([0.0, 30.0], ModalScale::Mass(4.0), [3.0, 0.0]);
    let found = model(&write_uff::modes(std::slice::from_ref(&mode))).modes.swap_remove(0);
    assert_eq!(found.scale, ModalScale::A([0.0, 240.0]));
    let [own, read] = [mode, found].map(|m| m.mass_normalised().unwrap()[0].1[0]);
    assert_eq!(own, [1.5, 0.0]);
    assert!((read[0] - 1.5).abs() < 1e-14 && read[1].abs() < 1e-14, "{read:?}");
}

#[test]
fn shapes_that_are_no_modes_are_left_out_with_the_reason() {
    let real = |analysis: u8, data: u8, values: u8, numbers: &str| {
        format!(
            "    -1\n    55\na\nb\nc\nd\ne\n         1{analysis:>10}{data:>10}         8         2{values:>10}\n         2         4         1         1\n{numbers}\n         7\n  1.00000E+00  0.00000E+00  0.00000E+00\n    -1\n"
        )
    };
    let fine = "  1.00000E+01  4.00000E+00  2.00000E-02  0.00000E+00";
    assert_eq!(model(&real(2, 2, 3, fine)).modes.len(), 1);
    for (text, reason) in [
        (real(1, 2, 3, fine), "analysis type 1 is no mode (2, 3 or 7)"),
        (real(2, 4, 6, fine), "6 values of characteristic 4 a node are no translations"),
        (
            real(2, 2, 3, "  0.00000E+00  4.00000E+00  2.00000E-02  0.00000E+00"),
            "frequency 0 Hz and damping ratio 0.02 are no mode's",
        ),
        (
            real(2, 2, 3, "  1.00000E+01  4.00000E+00  1.00000E+00  0.00000E+00"),
            "frequency 10 Hz and damping ratio 1 are no mode's",
        ),
        (
            real(3, 2, 3, "  5.00000E-01  3.00000E+01  0.00000E+00  1.00000E+00"),
            "0.5 + 30i is no pole of a vibration that decays",
        ),
    ] {
        let found = model(&text);
        assert!(found.modes.is_empty(), "{reason}");
        let word = found.warnings[0].to_string();
        assert!(word.starts_with("'dataset 55 at byte 7' was left out: ") && word.contains(reason), "{word}");
    }
}

/// More whole numbers than a row of eight takes stand in several rows, and the real ones come after them.
#[test]
fn whole_numbers_of_a_shape_may_take_several_rows() {
    let text = "    -1\n    55\na\nb\nc\nd\ne\n         1         2         2         8         2         3\n         8         4         1         1         0         0         0         0\n         0         0\n  1.00000E+01  4.00000E+00  2.00000E-02  0.00000E+00\n         7\n  1.00000E+00  0.00000E+00  0.00000E+00\n    -1\n";
    let found = model(text);
    assert_eq!((found.modes[0].frequency, found.modes[0].values[0].0), (10.0, 7));
}

/// A tetrahedron has 6 edges, a wedge 9, a brick 12, and two that share a face share its edges.
#[test]
fn solids_are_drawn_by_their_edges() {
    let of = |elements: &[(i64, Vec<i64>)]| model(&write_uff::elements(elements)).edges();
    assert_eq!(of(&[(111, vec![1, 2, 3, 4])]), [[1, 2], [1, 3], [1, 4], [2, 3], [2, 4], [3, 4]]);
    let wedge = of(&[(112, (1..=6).collect())]);
    assert_eq!(wedge, [[1, 2], [1, 3], [1, 4], [2, 3], [2, 5], [3, 6], [4, 5], [4, 6], [5, 6]]);
    let brick = (115, (1..=8).collect());
    assert_eq!(of(std::slice::from_ref(&brick)).len(), 12);
    // On top of it a second one.
    assert_eq!(of(&[brick, (115, (5..=12).collect())]).len(), 20);
    // A mass is at one node.
    assert_eq!(of(&[(161, vec![3])]), [[0; 2]; 0]);
}

#[test]
fn empty_rows_between_nodes_are_passed_over() {
    let text = "    -1\n    15\n         7         0         0         8  0.00000E+00  5.00000E-01  1.00000E+00\n\n         8         0         0         8-1.00000E+100-5.00000E-101-2.00000E+100\n    -1\n";
    let nodes = model(text).nodes;
    assert_eq!((nodes[0].number, nodes[0].position), (7, [0.0, 0.5, 1.0]));
    assert_eq!((nodes[1].number, nodes[1].position), (8, [-1e100, -5e-101, -2e100]));
}

#[test]
fn quantities_are_read_as_they_were_written() {
    use Quantity::{Acceleration, Displacement, Force, Pressure, Strain, Unknown, Velocity, Voltage};
    let all = [Acceleration, Velocity, Displacement, Force, Pressure, Strain, Unknown];
    let written: Vec<UffFunction> = all.iter().map(|q| function(1, *q, 8)).collect();
    let (found, warnings) = functions(write_uff::functions(&written).as_bytes());
    assert_eq!(found.iter().map(|f| f.quantity).collect::<Vec<_>>(), all);
    assert_eq!((found.as_slice(), warnings.len()), (written.as_slice(), 0));
    // The format has no number for a voltage: its unit tells.
    let voltage = UffFunction { unit: "V".into(), ..function(1, Voltage, 8) };
    let text = write_uff::functions(std::slice::from_ref(&voltage));
    assert_eq!(functions(text.as_bytes()).0, [voltage]);
}

/// Complex functions in binary: real and imaginary parts in turn, in single or double precision.
#[test]
fn binary_frequency_responses_have_real_and_imaginary_parts() {
    for (data_type, double) in [(5, false), (6, true)] {
        for big in [false, true] {
            let bytes = (if double { 16 } else { 8 }) * 30;
            let order = if big { 2 } else { 1 };
            let first =
                format!("    58b{order:>6}     2          11{bytes:>12}     0     0           0           0");
            let mut file = uff_header(&first, data_type, 30, true, "H");
            for v in wave(30) {
                file.extend([number(v, big, double), number(-2.0 * v, big, double)].concat());
            }
            file.extend(b"\n    -1\n");
            let (found, warnings) = functions(&file);
            assert!(warnings.is_empty(), "{warnings:?}");
            let within = if double { 0.0 } else { 1e-7 };
            assert_eq!((found[0].re.len(), found[0].im.len()), (30, 30));
            for ((re, im), v) in found[0].re.iter().zip(&found[0].im).zip(wave(30)) {
                assert!((re - v).abs() <= within && (im + 2.0 * v).abs() <= 2.0 * within, "{re} {im} {v}");
            }
            let refused = read(&file).unwrap_err().to_string();
            assert!(refused.contains("a complex function"), "{refused}");
        }
    }
}

/// A dataset of five uneven values at a quarter of the unit each, as text.
fn uneven(name: &str, unit: &str, interval: f64) -> Vec<u8> {
    let mut file = uff_header("    58", 2, 5, false, name);
    for i in 0..5 {
        file.extend(format!("{:>13.5e}{:>13.5e}\n", f64::from(i) * interval, f64::from(i * i)).bytes());
    }
    file.extend(b"    -1\n");
    let text = String::from_utf8(file).unwrap();
    text.replacen("Time                 s                   ", &format!("Time                 {unit:<20}"), 1)
        .into_bytes()
}

#[test]
fn times_in_other_units_become_seconds() {
    let record = read(&uneven("a", "ms", 0.25)).unwrap();
    assert!((record.dt() - 2.5e-4).abs() < 1e-18, "{}", record.dt());
    assert_eq!(record.channel(0), [0.0, 1.0, 4.0, 9.0, 16.0]);
    let words = record.warnings()[0].to_string();
    assert_eq!(words, "times in ms were multiplied by 1e-3 to give seconds");
}

#[test]
fn abscissas_that_do_not_go_together_are_refused() {
    let [a, b] = [uneven("a", "s", 0.25), uneven("b", "s", 0.25)];
    assert_eq!(read(&[&a[..], &b].concat()).unwrap().channels(), 2);
    let other = read(&[&a[..], &uneven("b", "s", 0.5)].concat()).unwrap_err().to_string();
    assert!(other.contains("'b' has other times, expected the same times as 'a' has"), "{other}");
    let kinds = read(&[a, uff_ascii(5, "b")].concat()).unwrap_err().to_string();
    assert!(kinds.contains("'b' has another kind of abscissa, expected the same kind as 'a' has"), "{kinds}");
}

/// Some programs write both abscissa and ordinate in double precision: the number of bytes tells.
#[test]
fn uneven_binary_data_may_have_wide_abscissas() {
    let first = "    58b     1     2          11          80     0     0           0           0";
    let mut file = uff_header(first, 4, 5, false, "a");
    for i in 0..5_u8 {
        file.extend((f64::from(i) * 0.25).to_le_bytes());
        file.extend(f64::from(i).to_le_bytes());
    }
    file.extend(b"\n    -1\n");
    let record = read(&file).unwrap();
    assert_eq!((record.dt(), record.channel(0)), (0.25, &[0.0, 1.0, 2.0, 3.0, 4.0][..]));
    let (found, warnings) = functions(&[file, uff_ascii(20, "b")].concat());
    assert_eq!((found.len(), found[0].name.as_str()), (1, "b"));
    assert_eq!(warnings, ["'a' was left out: its abscissa is uneven"]);
}

#[test]
fn a_single_uneven_time_is_no_record() {
    let mut file = uff_header("    58", 2, 1, false, "a");
    file.extend(b"  0.00000E+00  1.00000E+00\n    -1\n");
    let message = read(&file).unwrap_err().to_string();
    assert!(message.contains("'abscissa of a': found 1 times, expected at least 2"), "{message}");
}

/// A file of a modal test in a folder of its own.
fn modal_test(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<iwan_io::ModalTest, ReadError> {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    read_modal_test(&path, options)
}

#[test]
fn a_modal_test_keeps_time_and_frequency_responses_and_names_the_rest() {
    let force = function(1, Quantity::Force, 12);
    let motion = function(1, Quantity::Acceleration, 12);
    let (frf, coherence) = (function(4, Quantity::Acceleration, 12), function(6, Quantity::Unknown, 12));
    let all = [force, motion, frf.clone(), coherence.clone()];
    let text = write_uff::functions(&all);
    let test = modal_test("hits.unv", text.as_bytes(), &ReadOptions::default()).unwrap();
    let channels: Vec<Quantity> = test.measurements[0].channels.iter().map(|c| c.quantity).collect();
    assert_eq!((test.measurements.len(), channels), (1, vec![Quantity::Force, Quantity::Acceleration]));
    assert_eq!((test.measurements[0].dt, &test.measurements[0].channels[1].samples), (0.25, &eighths(12)));
    assert_eq!(test.responses, [frf]);
    let left = test.warnings[0].to_string();
    assert!(
        left.contains("a function of type 6, neither a time response (1) nor a frequency response (4)"),
        "{left}"
    );
    let alone = write_uff::functions(&[coherence]);
    let refused = modal_test("hits.unv", alone.as_bytes(), &ReadOptions::default()).unwrap_err().to_string();
    assert!(refused.contains("a file without either cannot be read; export time responses"), "{refused}");
}

/// Unlike a record of one mode, a modal test has channels that measure different things.
#[test]
fn a_table_of_a_modal_test_keeps_all_its_channels() {
    let text = b"t [s],force [N],tip [m/s^2]\n0,1,2\n0.5,3,4\n1,5,6\n";
    let test = modal_test("hits.csv", text, &ReadOptions::default()).unwrap();
    let [measurement] = &test.measurements[..] else { panic!("one measurement") };
    let found: Vec<(&str, &str, Quantity, &[f64])> = measurement
        .channels
        .iter()
        .map(|c| (c.name.as_str(), c.unit.as_str(), c.quantity, &c.samples[..]))
        .collect();
    let expected = [
        ("force", "N", Quantity::Force, &[1.0, 3.0, 5.0][..]),
        ("tip", "m/s^2", Quantity::Acceleration, &[2.0, 4.0, 6.0][..]),
    ];
    assert_eq!((found.as_slice(), measurement.dt), (&expected[..], 0.5));
    assert!(test.responses.is_empty() && test.measurements[0].channels.iter().all(|c| c.at.is_none()));
    let rate = |rate| modal_test("hits.csv", text, &ReadOptions { rate: Some(rate), ..Default::default() });
    assert_eq!(rate(4.0).unwrap().measurements[0].dt, 0.25);
    let refused = rate(f64::NAN).unwrap_err().to_string();
    assert!(refused.contains("the rate is NaN Hz; it must lie between 1e-9 and 1e15 Hz"), "{refused}");
    let hole = modal_test("hits.csv", b"t,f [N]\n0,1\n1,NaN\n2,1\n", &ReadOptions::default()).unwrap_err();
    assert!(hole.to_string().contains("'f', sample 1"), "{hole}");
    let missing = read_modal_test(Path::new("no/such.csv"), &ReadOptions::default()).unwrap_err().to_string();
    assert!(missing.contains("no/such.csv: cannot be read"), "{missing}");
}

#[test]
fn directions_are_written_with_sign_and_axis() {
    for (direction, text) in
        [(0, "12"), (1, "12:+x"), (-3, "12:-z"), (4, "12:+rx"), (-6, "12:-rz"), (9, "12")]
    {
        assert_eq!(NodalDirection { node: 12, direction }.to_string(), text);
    }
}
