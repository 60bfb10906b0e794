//! Curves and single readings from the record that a blow leaves in one mode.

use std::f64::consts::TAU;

use iwan_ident::Error;
use iwan_ident::curves::{Curves, ForceAxis, Quantity};
use iwan_ident::signal::{Method, Options, envelope, spot};
use serde::Serialize;

use crate::blows::{DT, STEPS};

/// Time cut off at either end of a record, s: the blow with its transients, and the end effect of the Hilbert transform. Without the cut, the
/// dissipation of mode 1 is wrong by 19 % at 10 lbf and by 109 % at 1 lbf.
const TRIM: f64 = 0.02;
/// Degree of the polynomials in the envelope of a record in micro-slip. Degrees of 3 to 5 agree within 0.6 % of the dissipation; from 9 on the
/// polynomials diverge at the ends.
const QUIET: usize = 3;
/// Degree where the joints reach macro-slip and the curves bend more: the highest of those that agree in micro-slip.
const HARD: usize = 5;
/// Times at which amplitude, frequency and dissipation are read by demodulation, s: early, in the middle, late. The demodulation window is six cycles
/// long, 45 ms of mode 1; the first and the last time are as near to the record's ends as the window allows.
const TIMES: [f64; 3] = [0.03, 0.1, 0.17];

/// Amplitude, frequency and dissipation of the mode at one time of a record.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Reading {
    /// Time, s.
    pub t: f64,
    /// Amplitude of the displacement, √(lbf·in)·s.
    pub displacement: f64,
    /// Frequency, Hz.
    pub frequency: f64,
    /// Energy dissipated per cycle, lbf·in.
    pub dissipation: f64,
}

/// Options with which a mode near the frequency `near` (Hz) is followed in a record. The modal filter has left one mode only, so that no band-pass is
/// applied.
pub(super) fn options(near: f64, order: usize) -> Options {
    let window = Some((TRIM, STEPS as f64 * DT - TRIM));
    Options { near: Some(near), filter_order: 0, window, order: Some(order), ..Options::default() }
}

/// Curves over modal force, from a record in micro-slip or beyond.
pub(super) fn impact_curves(samples: &[f64], near: f64, micro_slip: bool) -> Result<Curves, Error> {
    let options = options(near, if micro_slip { QUIET } else { HARD });
    Curves::new(&envelope(samples, DT, Method::Hilbert, &options)?, Quantity::Acceleration, ForceAxis::Modal)
}

/// Readings of the mode near a frequency at the [`TIMES`].
pub(super) fn readings(samples: &[f64], near: f64) -> Result<Vec<Reading>, Error> {
    let one = |&t: &f64| {
        // The reading is repeated at the frequency found, because the window weakens the amplitude of a mode far from its centre.
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

    /// For a linear mode of 130 Hz with 0.1 % of damping, both methods must give D = 2π ζ ω0 ω q².
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
