//! Demodulation at the spectral peak with a moving Hann window.
//!
//! Z(t) = ∫ w(τ) x(t+τ) e^(-iω_c (t+τ)) dτ: modulus and argument are amplitude and phase, averaged over the window. For
//! a constant decay rate the average is the amplitude times a constant, so that rates are exact.

use std::f64::consts::{PI, TAU};

use rustfft::num_complex::Complex64;

use super::super::isolated::Isolated;
use super::traces::Traces;

/// Whole cycles in the window, which passes ±4 f/CYCLES around the peak. Fewer cycles let neighbouring modes in, more average over a decay
/// that is fast. A judgement.
const CYCLES: f64 = 8.0;
/// Windows per window length: successive Hann windows overlap by 7/8, and nothing is lost between them. Four would do; more repeat what is known.
const OVERLAP: f64 = 8.0;

/// Log amplitude and phase at the middles of overlapping windows.
pub(crate) fn demodulated(mode: &Isolated) -> Traces {
    let x = &mode.samples[mode.window.clone()];
    let length = (CYCLES / (mode.band.peak * mode.dt)).round() as usize;
    let hop = ((length as f64 / OVERLAP) as usize).max(1);
    let mut traces = Traces::default();
    for from in (0..(x.len() + 1).saturating_sub(length)).step_by(hop) {
        let (mut z, mut sum) = (Complex64::default(), 0.0);
        for (i, x) in x[from..from + length].iter().enumerate() {
            let hann = (PI * (i as f64 + 0.5) / length as f64).sin().powi(2);
            let turns = (mode.window.start + from + i) as f64 * mode.dt * mode.band.peak;
            z += hann * x * Complex64::cis(-TAU * turns.fract());
            sum += hann;
        }
        let t = (mode.window.start as f64 + from as f64 + 0.5 * (length as f64 - 1.0)) * mode.dt;
        let last = traces.phase.y.last().copied().unwrap_or(0.0);
        let phase = z.arg() - TAU * ((z.arg() - last) / TAU).round();
        traces.amplitude.push(t, (2.0 * z.norm() / sum).max(f64::MIN_POSITIVE).ln());
        traces.phase.push(t, phase);
    }
    traces
}
