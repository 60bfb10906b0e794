//! Demodulation at the spectral peak with a moving Hann window.
//!
//! Z(t) = ∫ w(τ) x(t+τ) e^(-iω_c (t+τ)) dτ: modulus and argument are amplitude and phase, averaged over the window. For
//! a constant decay rate the average is the amplitude times a constant, so that rates are exact.

use std::f64::consts::{PI, TAU};

use rustfft::num_complex::Complex64;

use super::envelope::Traces;
use super::isolate::Isolated;
use crate::error::{Error, check, check_dt, check_samples};

/// Whole cycles in the window; it passes ±4 f/CYCLES around the peak.
const CYCLES: f64 = 8.0;
/// Windows per window length.
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
        let last = traces.phase.1.last().copied().unwrap_or(0.0);
        let phase = z.arg() - TAU * ((z.arg() - last) / TAU).round();
        traces.amplitude.0.push(t);
        traces.amplitude.1.push((2.0 * z.norm() / sum).max(f64::MIN_POSITIVE).ln());
        traces.phase.0.push(t);
        traces.phase.1.push(phase);
    }
    traces
}

/// Whole cycles in the window of a [`spot`].
const SPOT_CYCLES: f64 = 6.0;

/// A mode at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// Amplitude, in the unit of the record.
    pub amplitude: f64,
    /// Frequency, Hz.
    pub frequency: f64,
    /// Decay rate -A'/A of the amplitude, 1/s.
    pub decay_rate: f64,
}

/// Amplitude, frequency and decay of the record's component near `near` Hz around the time `t` (s), from two Hann-windowed
/// demodulations over six cycles half a cycle before and behind it: nothing is smoothed over longer times.
///
/// # Errors
/// [`Error::OutOfRange`] when the windows reach beyond the record.
///
/// ```
/// let wave = |n: usize| (-3e-3 * n as f64).exp() * (0.8 * n as f64).cos();
/// let x: Vec<f64> = (0..1000).map(wave).collect();
/// let spot = iwan_ident::signal::spot(&x, 1e-3, 127.0, 0.4)?;
/// assert!((spot.frequency - 800.0 / std::f64::consts::TAU).abs() < 1e-3);
/// assert!((spot.decay_rate - 3.0).abs() < 1e-2);
/// # Ok::<(), iwan_ident::Error>(())
/// ```
pub fn spot(x: &[f64], dt: f64, near: f64, t: f64) -> Result<Spot, Error> {
    check_dt(dt)?;
    check_samples("record", x, 16, "record longer")?;
    check("frequency", near, near > 0.0 && near < 0.5 / dt, "between 0 and the Nyquist frequency", "in Hz")?;
    let half = (0.5 * SPOT_CYCLES / (near * dt)).round();
    let lag = (0.5 / (near * dt)).round();
    let (low, high) = ((half + lag) * dt, (x.len() as f64 - 1.0 - half - lag) * dt);
    let allowed = format!("{low:.6} to {high:.6} s");
    check("time", t, (low..=high).contains(&t), &allowed, "choose a time further from the ends")?;
    let (centre, lag, half) = ((t / dt).round() as usize, lag as usize, half as usize);
    let [early, late] = [centre - lag, centre + lag].map(|c| hann_at(x, c, half, TAU * near * dt));
    let span = 2.0 * lag as f64 * dt;
    let turn = (late.arg() - early.arg()) / TAU;
    Ok(Spot {
        amplitude: (early.norm() * late.norm()).sqrt(),
        frequency: near + (turn - turn.round()) / span,
        decay_rate: (early.norm() / late.norm()).ln() / span,
    })
}

/// Complex amplitude about a sample.
fn hann_at(x: &[f64], centre: usize, half: usize, omega: f64) -> Complex64 {
    let (from, to) = (centre.saturating_sub(half), (centre + half).min(x.len() - 1));
    let term = |n: usize| {
        let hann = (0.5 * PI * (n as f64 - centre as f64) / half as f64).cos().powi(2);
        hann * x[n] * Complex64::cis(-omega * n as f64)
    };
    (from..=to).map(term).sum::<Complex64>() * (2.0 / half as f64)
}
