//! Amplitude, frequency and decay rate of a mode at one time, from two short windows.

use std::f64::consts::{PI, TAU};

use rustfft::num_complex::Complex64;

use crate::error::{Error, check, check_dt, check_samples};

/// Whole cycles in the window of a [`spot`]: a longer window keeps neighbouring modes out better, but averages amplitude and frequency over
/// more time.
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

/// Amplitude, frequency and decay rate of the record's component near `near` Hz around the time `t` (s), from two Hann-windowed
/// demodulations over six cycles each, half a cycle before and half a cycle behind `t`: nothing is smoothed over longer times.
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

/// Complex amplitude in a Hann window of `half` samples on either side of the sample `centre`; `omega` in radian per sample.
fn hann_at(x: &[f64], centre: usize, half: usize, omega: f64) -> Complex64 {
    let (from, to) = (centre.saturating_sub(half), (centre + half).min(x.len() - 1));
    let term = |n: usize| {
        let hann = (0.5 * PI * (n as f64 - centre as f64) / half as f64).cos().powi(2);
        hann * x[n] * Complex64::cis(-omega * n as f64)
    };
    (from..=to).map(term).sum::<Complex64>() * (2.0 / half as f64)
}
