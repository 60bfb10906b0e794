//! The Brake-Reuss record, mode 1, by all methods. Reference: 3rd-order Butterworth 60-105 Hz, Hilbert, degree-7
//! polynomials with SciPy. Set `IWAN_FIELD_DATA` to the folder with `field/`.
#![allow(clippy::unwrap_used, clippy::print_stderr, reason = "a failed test may panic and say why")]

use iwan_ident::signal::{Method, Options, Spread, isolate};
use iwan_io::{ReadOptions, Record, read};

/// t (s), frequency (Hz), damping ratio (%).
const REFERENCE: [(f64, f64, f64); 6] = [
    (0.1, 80.33, 0.273),
    (0.5, 80.43, 0.213),
    (1.0, 80.45, 0.187),
    (2.0, 80.50, 0.163),
    (3.0, 80.54, 0.149),
    (4.0, 80.58, 0.141),
];

fn record() -> Option<Record> {
    let Some(folder) = std::env::var_os("IWAN_FIELD_DATA") else {
        eprintln!("skipped: IWAN_FIELD_DATA not set");
        return None;
    };
    let path = std::path::PathBuf::from(folder).join("field/brb_hammer_impact.mat");
    Some(read(&path, &ReadOptions::default()).unwrap())
}

#[test]
fn mode_1_of_the_brake_reuss_beam() {
    let Some(record) = record() else { return };
    for (channel, band) in [(0, Some((60.0, 105.0))), (2, Some((60.0, 105.0))), (0, None), (2, None)] {
        let options = Options { band, ..Options::default() };
        let mode = isolate(record.channel(channel), record.dt(), &options).unwrap();
        eprintln!("channel {channel} {:?} window {:?} noise {:e}", mode.notes, mode.trusted(), mode.noise);
        let mut all = Vec::new();
        for method in Method::ALL {
            let envelope = mode.envelope(method, None).unwrap();
            for (t, frequency, damping) in REFERENCE {
                // Times of the reference count from the trigger, 0.01 s behind the first sample.
                let Some((a, f, z)) = envelope.at(t - record.start()) else {
                    assert!(method == Method::Demodulation && t < 0.2, "{method:?} {t}");
                    continue;
                };
                eprintln!(
                    "{:13} order {:2} t {t}: {a:7.3} {f:.3} ({:+.3}) {:.4} ({:+.2} %)",
                    method.name(),
                    envelope.order,
                    f - frequency,
                    100.0 * z,
                    100.0 * (100.0 * z / damping - 1.0)
                );
                assert!((f - frequency).abs() < 0.05, "channel {channel} {method:?} {t} s: {f} Hz");
                assert!((100.0 * z / damping - 1.0).abs() < 0.05, "channel {channel} {method:?} {t} s: {z}");
            }
            all.push(envelope);
        }
        let spread = Spread::of(&all).unwrap();
        eprintln!("{spread:?}");
        assert!(spread.frequency < 0.1 && spread.median_damping_ratio < 0.05, "{spread:?}");
    }
}
