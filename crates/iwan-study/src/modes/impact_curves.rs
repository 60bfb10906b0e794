//! Curves and single readings of the record that a blow leaves in one mode.

use std::f64::consts::TAU;

use iwan_ident::Error;
use iwan_ident::curves::{Curves, ForceAxis, Quantity};
use iwan_ident::signal::{Method, Options, envelope, spot};
use serde::Serialize;

use crate::blows::{DT, STEPS};

/// Seconds cut off at either end of a record: the blow with its transients, and the end of the transform. Without that the
/// dissipation of mode 1 is wrong by 19 % at 10 lbf and by 109 % at 1 lbf.
const TRIM: f64 = 0.02;
/// Degree of the polynomials in an envelope of a record in micro-slip. Degrees of 3 to 5 agree within 0.6 % of the dissipation; from
/// 9 on polynomials run away at the ends.
const QUIET: usize = 3;
/// Degree where the joints slip as a whole and curves bend more: the highest of those that agree in micro-slip.
const HARD: usize = 5;
/// Times at which amplitude, frequency and dissipation are read by demodulation, s: early, in the middle, late. The window
/// is six cycles long, 45 ms of mode 1; the first and the last time are as near to the record's ends as it can go.
const TIMES: [f64; 3] = [0.03, 0.1, 0.17];

/// The mode at one time of a record.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Reading {
    /// Time, s.
    pub t: f64,
    /// Amplitude of the displacement, √(lbf·in)·s.
    pub displacement: f64,
    /// Frequency, Hz.
    pub frequency: f64,
    /// Energy lost in a cycle, lbf·in.
    pub dissipation: f64,
}

/// How a mode near a frequency is followed in a record: the modal filter has left one mode, so that nothing is filtered.
pub(super) fn options(near: f64, order: usize) -> Options {
    let window = Some((TRIM, STEPS as f64 * DT - TRIM));
    Options { near: Some(near), filter_order: 0, window, order: Some(order), ..Options::default() }
}

/// Curves over modal force of a record in micro-slip or beyond.
pub(super) fn impact_curves(samples: &[f64], near: f64, micro_slip: bool) -> Result<Curves, Error> {
    let options = options(near, if micro_slip { QUIET } else { HARD });
    Curves::new(&envelope(samples, DT, Method::Hilbert, &options)?, Quantity::Acceleration, ForceAxis::Modal)
}

/// The mode near a frequency at the [`TIMES`].
pub(super) fn readings(samples: &[f64], near: f64) -> Result<Vec<Reading>, Error> {
    let one = |&t: &f64| {
        // Once more where the frequency was found: far from it a window weakens the amplitude.
        let first = spot(samples, DT, near, t)?;
        let found = spot(samples, DT, first.frequency, t)?;
        let omega = TAU * found.frequency;
        let displacement = found.amplitude / (omega * omega);
        let dissipation = TAU * found.decay_rate / omega * (omega * displacement).powi(2);
        Ok(Reading { t, displacement, frequency: found.frequency, dissipation })
    };
    TIMES.iter().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A linear mode of 130 Hz with 0.1 % of damping: D = 2π ζ ω0 ω q², whatever reads it.
    #[test]
    fn curves_and_readings_of_a_linear_decay_are_its_own() {
        let (omega, zeta) = (TAU * 130.0, 1e-3_f64);
        let damped = omega * (1.0 - zeta * zeta).sqrt();
        let at = |t: f64| (-zeta * omega * t).exp() * (damped * t).cos();
        let samples: Vec<f64> = (0..=STEPS).map(|n| at(n as f64 * DT)).collect();
        let near = |found: f64, wanted: f64| (found / wanted - 1.0).abs() < 0.01;
        let lost = |q: f64| TAU * zeta * (omega * q).powi(2);
        for reading in readings(&samples, 130.0).unwrap() {
            assert!((reading.frequency - 130.0).abs() < 0.01, "{reading:?}");
            assert!(near(reading.dissipation, lost(reading.displacement)), "{reading:?}");
            assert!(near(reading.displacement, (-zeta * omega * reading.t).exp() / (omega * omega)));
        }
        for micro_slip in [true, false] {
            let curves = impact_curves(&samples, 130.0, micro_slip).unwrap();
            let middle = curves.t.len() / 2;
            assert!(near(curves.dissipation[middle], lost(curves.displacement[middle])), "{curves:?}");
        }
    }
}
