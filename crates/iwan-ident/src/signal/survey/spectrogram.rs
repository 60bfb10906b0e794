//! A record's spectrum over time, small enough to be drawn.

use std::f64::consts::PI;

use rustfft::FftPlanner;
use rustfft::num_complex::Complex64;

use crate::error::{Error, check, check_dt, check_samples};

/// Number of windows that lie one behind the other in a record; it sets their length. Longer windows blur the decay, shorter ones the
/// frequencies; for a ring-down of some hundred cycles a thirtieth of the record shows both.
const WINDOWS: f64 = 30.0;
/// Least number of samples of a window.
const LEAST: usize = 32;
/// Appended zeros make a window at most this many times longer: more lines between two of the window's own show nothing new.
const MOST_PADDED: usize = 16;
/// Level at which the scale ends, in decibels relative to the highest cell: four decades of amplitude, about what sensors have.
const FLOOR: f64 = -80.0;

/// Magnitudes of short-time spectra.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrogram {
    /// Middles of the windows, s from the first sample.
    pub times: Vec<f64>,
    /// Edges of the cells in frequency, Hz: one more than there are cells.
    pub edges: Vec<f64>,
    /// Magnitudes in decibels relative to the highest, from -80 to 0: `decibels[time][cell]`.
    pub decibels: Vec<Vec<f64>>,
    /// Length of each window, s.
    pub window: f64,
}

/// Short-time spectra of a record (every `dt` seconds) under Hann windows, between two frequencies (Hz) and in at most
/// `most` = (times, cells) cells. A cell shows the highest line in it, so that a narrow mode is not lost.
///
/// # Errors
/// [`Error::OutOfRange`] unless 0 <= low < high <= Nyquist frequency, for `dt`, or for `most` below (1, 1);
/// [`Error::NotFinite`]; [`Error::TooShort`] below 64 samples.
///
/// ```
/// let x: Vec<f64> = (0..4000).map(|n| (-1e-3 * n as f64).exp() * (0.5 * n as f64).sin()).collect();
/// let shown = iwan_ident::signal::spectrogram(&x, 1e-3, (0.0, 200.0), (50, 40))?;
/// assert_eq!((shown.times.len(), shown.decibels[0].len(), shown.edges.len()), (50, 40, 41));
/// // 500/(2π) = 79.6 Hz lies at the upper edge of the cell from 75 to 80 Hz.
/// let first = &shown.decibels[0];
/// let highest = (0..40).max_by(|&i, &j| first[i].total_cmp(&first[j])).unwrap();
/// assert!((15..=16).contains(&highest));
/// # Ok::<(), iwan_ident::Error>(())
/// ```
pub fn spectrogram(
    x: &[f64],
    dt: f64,
    range: (f64, f64),
    most: (usize, usize),
) -> Result<Spectrogram, Error> {
    check_dt(dt)?;
    check_samples("record", x, 2 * LEAST, "record longer")?;
    let (low, high) = range;
    let nyquist = 0.5 / dt;
    let allowed = format!("0 <= low < high <= {nyquist} Hz (Nyquist)");
    check("low frequency", low, low >= 0.0 && low < high, &allowed, "give the range as low:high")?;
    check("high frequency", high, high <= nyquist * (1.0 + 1e-9), &allowed, "give the range as low:high")?;
    let cells_wanted = most.0.min(most.1) as f64;
    check("cells", cells_wanted, cells_wanted >= 1.0, "at least 1", "give a number of cells")?;
    let length = ((x.len() as f64 / WINDOWS) as usize).max(LEAST);
    // Two lines to a cell, as far as the limit of the padding allows.
    let wanted = (2.0 * most.1 as f64 / ((high - low) * dt)) as usize;
    let padded = wanted.clamp(length, MOST_PADDED * length).next_power_of_two();
    let step = 1.0 / (padded as f64 * dt);
    let cells = most.1;
    let edges: Vec<f64> = (0..=cells).map(|c| low + (high - low) * c as f64 / cells as f64).collect();
    let times = most.0.min(x.len() - length + 1);
    let fft = FftPlanner::new().plan_fft_forward(padded);
    let starts: Vec<usize> =
        (0..times).map(|i| i * (x.len() - length) / times.saturating_sub(1).max(1)).collect();
    let mut decibels: Vec<Vec<f64>> = Vec::with_capacity(times);
    for start in &starts {
        let part = &x[*start..start + length];
        let mean = part.iter().sum::<f64>() / length as f64;
        let hann = |i: usize| (PI * (i as f64 + 0.5) / length as f64).sin().powi(2);
        let mut z: Vec<Complex64> =
            part.iter().enumerate().map(|(i, x)| Complex64::new(hann(i) * (x - mean), 0.0)).collect();
        z.resize(padded, Complex64::default());
        fft.process(&mut z);
        let highest = |c: usize| {
            let (from, to) = ((edges[c] / step).ceil() as usize, (edges[c + 1] / step).ceil() as usize);
            // A cell between two lines shows the line above it.
            let from = from.min(padded / 2);
            let lines = from..to.clamp(from + 1, padded / 2 + 1);
            z[lines].iter().map(Complex64::norm_sqr).fold(0.0, f64::max)
        };
        decibels.push((0..cells).map(highest).collect());
    }
    let top = decibels.iter().flatten().copied().fold(f64::MIN_POSITIVE, f64::max);
    decibels.iter_mut().flatten().for_each(|v| *v = (10.0 * (*v / top).max(1e-300).log10()).max(FLOOR));
    let times = starts.iter().map(|start| (*start as f64 + 0.5 * length as f64) * dt).collect();
    Ok(Spectrogram { times, edges, decibels, window: length as f64 * dt })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A Hann-windowed decay e^(-r t) loses 8.686 r dB a second, whatever the window.
    #[test]
    fn a_decay_falls_by_its_rate_and_a_sweep_moves() {
        let (rate, dt) = (3.0, 1e-3);
        let x: Vec<f64> =
            (0..4000).map(|n| (-rate * dt * f64::from(n)).exp() * (0.7 * f64::from(n)).sin()).collect();
        let shown = spectrogram(&x, dt, (0.0, 500.0), (60, 100)).unwrap();
        let top = |row: &Vec<f64>| row.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let fall = (top(&shown.decibels[5]) - top(&shown.decibels[25])) / (shown.times[25] - shown.times[5]);
        assert!((fall / (8.685_889_638 * rate) - 1.0).abs() < 0.02, "{fall}");
        assert!(shown.decibels.iter().flatten().all(|d| (FLOOR..=0.0).contains(d)));
        let sweep: Vec<f64> =
            (0..4000).map(|n| f64::from(n) * dt).map(|t| (600.0 * t + 150.0 * t * t).sin()).collect();
        let shown = spectrogram(&sweep, dt, (0.0, 500.0), (60, 100)).unwrap();
        let peak = |row: &Vec<f64>| (0..100).max_by(|&i, &j| row[i].total_cmp(&row[j])).unwrap();
        assert!(peak(&shown.decibels[50]) > peak(&shown.decibels[10]) + 10);
    }

    /// Cells narrower than the lines of the longest transform had nothing in them, and were drawn as silence.
    #[test]
    fn narrow_ranges_have_no_empty_cells() {
        let x: Vec<f64> = (0..2000).map(|n| (0.7 * f64::from(n)).sin()).collect();
        let shown = spectrogram(&x, 1e-3, (111.0, 112.0), (10, 200)).unwrap();
        assert!(shown.decibels.iter().flatten().all(|d| *d > -20.0), "{:?}", shown.decibels[5]);
    }

    #[test]
    fn ranges_that_cannot_be_are_refused() {
        let x = vec![0.0; 100];
        for range in [(-1.0, 10.0), (10.0, 10.0), (0.0, 501.0), (f64::NAN, 1.0)] {
            assert!(spectrogram(&x, 1e-3, range, (10, 10)).is_err(), "{range:?}");
        }
        assert!(spectrogram(&x, 1e-3, (0.0, 500.0), (0, 10)).is_err());
        assert!(spectrogram(&x, 1e-3, (0.0, 500.0), (1, 1)).is_ok());
    }
}
