//! The peaks of a record's spectrum, and the band around the one that is meant.

use super::ring::{RingSpectrum, Window, decay_rate};
use crate::error::{Error, check};
use crate::signal::spectrum::{Band, Neighbour, STRONG, half_power_width};

/// A peak stands out of the noise when its amplitude is at least this many times the median noise around it: of a million lines of noise the highest
/// reaches 4.5 times, and a median of some tens of independent lines is a fifth off.
const ABOVE_NOISE: f64 = 7.0;
/// A peak stands out of the skirts of others when the valleys on both sides (the lowest lines on the way to higher ones) are lower by this factor. A judgement: half of this
/// value names ripples of skirts, twice this value leaves out modes 2 % beside others.
const PROMINENCE: f64 = 2.0;
/// A peak that only the second window (Blackman-Harris) shows stands above its valleys by at least this factor: noise that is not white has bumps of five.
const CLEAR: f64 = 10.0;
/// Largest number of lines in each of the blocks of which the median noise is taken: 128 independent lines.
const BLOCK: usize = 512;
/// Least number of blocks.
const BLOCKS: usize = 8;
/// Least number of cycles of a peak in the stretch: below lie offset and drift.
const CYCLES: f64 = 5.0;
/// Peaks of the two windows are one peak where they are nearer to each other than this many of their widths: a peak whose frequency falls with
/// amplitude stands at a higher frequency when its loud part is not seen.
const APART: f64 = 2.0;
/// Largest ratio of the frequency asked for and that of the mode taken; farther off, the request is refused.
const FAR: f64 = 1.2;
/// A peak within this distance of another one, relative to its frequency, may be a part of that one where a mode is asked for.
const BESIDE: f64 = 0.03;
/// It is a part of the other one where that is more than this many times higher.
const LOWER: f64 = 10.0;
/// The band ends at the geometric mean with a neighbour of at least this fraction of the peak's height, as the automatic band does.
const NEIGHBOUR: f64 = 0.03;

/// A peak of a ring-down's spectrum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpectralPeak {
    /// Hz.
    pub frequency: f64,
    /// Height over that of the highest peak, 0 to 1.
    pub height: f64,
    /// Width at half its power, Hz, the window's own included; none where a neighbour hides it.
    pub width: Option<f64>,
    /// Damping ratio of the linear mode with a peak of that width; none where the record is too short to tell. Where the frequency changes
    /// with amplitude, the peak is wider and this value too large.
    pub damping_ratio: Option<f64>,
    /// Height over that of the higher of the two valleys beside it.
    pub prominence: f64,
}

/// The peaks of the spectrum of a ring-down in one or several equally long channels (same unit, every `dt` seconds), by frequency.
///
/// The spectrum is that of the stretch behind the loudest sample, under the falling half of a Hann window. Peaks that the skirts of others
/// hide in it are taken from the spectrum under a whole Blackman-Harris window. A peak is a line that stands
/// seven times out of the noise around it, with valleys of half its height on both sides, and lasts for five cycles of the stretch.
///
/// # Errors
/// [`Error::OutOfRange`] for `dt`, [`Error::NotFinite`], [`Error::TooShort`] below 64 samples or for channels of different lengths.
///
/// ```
/// use std::f64::consts::TAU;
/// let wave = |t: f64, a: f64, f: f64, z: f64| a * (-TAU * f * z * t).exp() * (TAU * f * t).sin();
/// let x: Vec<f64> = (0..8000).map(|n| n as f64 / 4000.0).map(|t| wave(t, 1.0, 80.0, 0.004) + wave(t, 0.1, 610.0, 0.002)).collect();
/// let peaks = iwan_ident::signal::spectral_peaks(&[&x], 1.0 / 4000.0)?;
/// assert_eq!(peaks.len(), 2);
/// assert!((peaks[1].frequency - 610.0).abs() < 0.3 && (peaks[1].damping_ratio.unwrap() / 0.002 - 1.0).abs() < 0.1);
/// # Ok::<(), iwan_ident::Error>(())
/// ```
pub fn spectral_peaks(channels: &[&[f64]], dt: f64) -> Result<Vec<SpectralPeak>, Error> {
    let falling = Listed::new(channels, dt, Window::Falling)?;
    let whole = Listed::new(channels, dt, Window::Whole)?;
    let highest = falling.lines.iter().map(|l| falling.spectrum.power[l.at]).fold(0.0, f64::max);
    // A mode that the skirts of another one hide at the start is seen when that other one has died away.
    let hidden = |line: &&Line| {
        // A bump without half-power points is the ripple of a skirt.
        if line.prominence < CLEAR || line.width.is_none() {
            return false;
        }
        let apart = APART * (1.0 / (whole.spectrum.length * whole.spectrum.step) + line.width.unwrap_or(0.0));
        falling
            .lines
            .iter()
            .all(|other| (other.at.abs_diff(line.at) as f64) > apart + APART * other.width.unwrap_or(0.0))
    };
    let peak = |listed: &Listed, line: &Line| {
        let frequency = listed.spectrum.frequency(line.at);
        let width = line.width.map(|lines| lines * listed.spectrum.step);
        let rate = width.and_then(|w| decay_rate(listed.window, w, listed.spectrum.length));
        SpectralPeak {
            frequency,
            height: if highest > 0.0 { (falling.spectrum.power[line.at] / highest).sqrt() } else { 1.0 },
            width,
            damping_ratio: rate.map(|r| r / (std::f64::consts::TAU * frequency)),
            prominence: line.prominence,
        }
    };
    let mut peaks: Vec<SpectralPeak> = falling.lines.iter().map(|line| peak(&falling, line)).collect();
    peaks.extend(whole.lines.iter().filter(hidden).map(|line| peak(&whole, line)));
    peaks.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
    Ok(peaks)
}

/// A spectrum with its peaks.
struct Listed {
    window: Window,
    spectrum: RingSpectrum,
    lines: Vec<Line>,
}

/// A line that is a peak.
struct Line {
    at: usize,
    /// Width between its half-power points, in lines.
    width: Option<f64>,
    prominence: f64,
}

impl Listed {
    fn new(channels: &[&[f64]], dt: f64, window: Window) -> Result<Self, Error> {
        let spectrum = RingSpectrum::new(channels, dt, window)?;
        let floor = noise_around(&spectrum.noise);
        let (power, length) = (&spectrum.power, block_length(spectrum.power.len()));
        let first = ((CYCLES / spectrum.length / spectrum.step).ceil() as usize).max(1);
        let stands =
            |k: &usize| spectrum.is_peak(*k) && power[*k] > ABOVE_NOISE * ABOVE_NOISE * floor[*k / length];
        let saddles = saddles(power);
        let line = |k: usize| {
            let prominence = (power[k] / saddles[k].max(f64::MIN_POSITIVE)).sqrt();
            Line { at: k, width: half_power_width(power, k), prominence }
        };
        let lines = (first..power.len() - 1).filter(stands).map(line).filter(|l| l.prominence >= PROMINENCE);
        let lines = lines.collect();
        Ok(Self { window, spectrum, lines })
    }
}

/// The band around the spectral peak nearest to `near` Hz: 0.75 to 1.3 times its frequency, cut at the geometric mean with the next
/// peak on either side that has 3 % of its height, and at 95 % of the Nyquist frequency, and narrower beside a strong one nearer than 5 %, as by
/// [`automatic_band`](crate::signal::automatic_band). A peak within 3 % of one that is ten times higher is never taken.
///
/// # Errors
/// Those of [`spectral_peaks`]; [`Error::OutOfRange`] for `near`; [`Error::Refused`] when there is no peak within 20 % of it.
///
/// ```
/// use std::f64::consts::TAU;
/// let wave = |t: f64, f: f64| (-2.0 * t).exp() * (TAU * f * t).sin();
/// let x: Vec<f64> = (0..8000).map(|n| n as f64 / 2000.0).map(|t| wave(t, 100.0) + 0.1 * wave(t, 112.0)).collect();
/// let band = iwan_ident::signal::band_near(&[&x], 1.0 / 2000.0, 115.0)?;
/// assert!((band.peak - 112.0).abs() < 0.3 && (band.low - (100.0_f64 * 112.0).sqrt()).abs() < 0.3);
/// # Ok::<(), iwan_ident::Error>(())
/// ```
pub fn band_near(channels: &[&[f64]], dt: f64, near: f64) -> Result<Band, Error> {
    let nyquist = 0.5 / dt;
    let allowed = format!("between 0 and the Nyquist frequency {nyquist} Hz");
    check("mode", near, near > 0.0 && near < nyquist, &allowed, "give a frequency in Hz")?;
    let peaks = spectral_peaks(channels, dt)?;
    let shadowed = |p: &SpectralPeak| {
        let over = |q: &SpectralPeak| {
            (q.frequency / p.frequency - 1.0).abs() < BESIDE && q.height > LOWER * p.height
        };
        peaks.iter().any(over)
    };
    let distance = |p: &SpectralPeak| (p.frequency / near).ln().abs();
    let nearest = peaks.iter().filter(|p| !shadowed(p)).min_by(|a, b| distance(a).total_cmp(&distance(b)));
    let Some(mode) = nearest.filter(|p| distance(p) < FAR.ln()) else {
        let list: Vec<String> = peaks.iter().map(|p| format!("{:.5}", p.frequency)).collect();
        let shown = list[..list.len().min(20)].join(", ");
        return Err(Error::Refused {
            finding: format!("no spectral peak within 20 % of {near} Hz (there are: {shown} Hz)"),
            remedy: "choose one of the peaks, or name a band",
        });
    };
    let others: Vec<SpectralPeak> = peaks.iter().filter(|p| !shadowed(p)).copied().collect();
    Ok(band_among(&others, mode, true, nyquist))
}

/// The band around `mode`, one of some `peaks`; where it `yields`, a strong near neighbour makes it narrower.
pub(in crate::signal) fn band_among(
    peaks: &[SpectralPeak],
    mode: &SpectralPeak,
    yields: bool,
    nyquist: f64,
) -> Band {
    let high_enough = |p: &&SpectralPeak| p.height >= NEIGHBOUR * mode.height;
    let nearest = |a: &&SpectralPeak, b: &&SpectralPeak| a.frequency.total_cmp(&b.frequency);
    let above = peaks.iter().filter(high_enough).filter(|p| p.frequency > mode.frequency).min_by(nearest);
    let below = peaks.iter().filter(high_enough).filter(|p| p.frequency < mode.frequency).max_by(nearest);
    let next = [below, above].map(|p| {
        let is_strong = |p: &SpectralPeak| yields && p.height >= STRONG * mode.height;
        p.map(|p| Neighbour { frequency: p.frequency, is_strong: is_strong(p) })
    });
    Band::between((next[0], next[1]), mode.frequency, nyquist)
}

fn block_length(lines: usize) -> usize {
    (lines / BLOCKS).clamp(1, BLOCK)
}

/// For each block of lines the median noise in it, or in a block beside it where that is less: a mode that fills a block is no noise.
fn noise_around(noise: &[f64]) -> Vec<f64> {
    let median = |block: &[f64]| {
        let mut sorted = block.to_vec();
        let middle = sorted.len() / 2;
        *sorted.select_nth_unstable_by(middle, f64::total_cmp).1
    };
    let length = block_length(noise.len());
    let mut medians: Vec<f64> = noise.chunks_exact(length).map(median).collect();
    medians.resize(noise.len().div_ceil(length), medians.last().copied().unwrap_or(0.0));
    let least = |block: usize| {
        medians[block.saturating_sub(1)..(block + 2).min(medians.len())]
            .iter()
            .copied()
            .fold(f64::INFINITY, f64::min)
    };
    (0..medians.len()).map(least).collect()
}

/// For each line the higher of two valleys: the lowest powers on the ways to the next higher line on either side. An end of the spectrum counts as a higher line.
fn saddles(power: &[f64]) -> Vec<f64> {
    let below = lowest_on_the_way(power.iter());
    let above = lowest_on_the_way(power.iter().rev());
    below.iter().zip(above.iter().rev()).map(|(a, b)| a.max(*b)).collect()
}

/// The lowest power between each line and the last one before it that is higher, or the first line where none is. Lines that are not higher than a later one are never asked for
/// again and are dropped, so that one pass over the spectrum does all.
fn lowest_on_the_way<'a>(power: impl Iterator<Item = &'a f64>) -> Vec<f64> {
    let mut higher: Vec<(f64, f64)> = Vec::new();
    let way = |p: &f64| {
        let mut lowest = f64::INFINITY;
        while let Some((height, before)) = higher.pop_if(|(height, _)| *height <= *p) {
            lowest = lowest.min(height).min(before);
        }
        higher.push((*p, lowest));
        lowest
    };
    power.map(way).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn decays(modes: &[(f64, f64, f64)], rate: f64, n: usize, noise: f64) -> Vec<f64> {
        let mut state = 1_u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut gauss = || (-2.0 * uniform().max(1e-300).ln()).sqrt() * (TAU * uniform()).cos();
        let wave = |t: f64| -> f64 {
            modes.iter().map(|(a, f, z)| a * (-TAU * f * z * t).exp() * (TAU * f * t + a).sin()).sum()
        };
        (0..n).map(|i| wave(i as f64 / rate) + noise * gauss()).collect()
    }

    #[test]
    fn modes_of_very_different_damping_and_height_are_listed_with_their_damping() {
        let modes = [(1.0, 80.5, 1.5e-3), (0.3, 221.7, 2e-3), (0.02, 297.7, 1e-3), (0.5, 1527.0, 3e-3)];
        let x = decays(&modes, 12_800.0, 65_536, 1e-4);
        let peaks = spectral_peaks(&[&x], 1.0 / 12_800.0).unwrap();
        assert_eq!(peaks.len(), modes.len(), "{peaks:?}");
        for (peak, (_, f, z)) in peaks.iter().zip(modes) {
            // Skirts of the others pull a weak peak by a tenth of its width.
            assert!((peak.frequency / f - 1.0).abs() < 5e-4, "{peak:?}");
            assert!((peak.damping_ratio.unwrap() / z - 1.0).abs() < 0.1, "{peak:?} {z}");
        }
    }

    #[test]
    fn saddles_are_the_valleys_on_the_way_to_higher_lines() {
        assert_eq!(saddles(&[3.0, 1.0, 2.0, 0.5, 4.0, 4.0, 2.0])[2], 1.0);
        let mut state = 7_u64;
        let mut line = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 60) as f64
        };
        let power: Vec<f64> = (0..300).map(|_| line()).collect();
        for (k, found) in saddles(&power).into_iter().enumerate() {
            let way = |lines: &mut dyn Iterator<Item = usize>| {
                lines.map(|i| power[i]).take_while(|p| *p <= power[k]).fold(f64::INFINITY, f64::min)
            };
            let expected = way(&mut (0..k).rev()).max(way(&mut (k + 1..power.len())));
            assert_eq!(found, expected, "{k}");
        }
    }

    #[test]
    fn noise_has_no_peaks_and_a_steady_line_no_damping() {
        assert!(spectral_peaks(&[&decays(&[], 1000.0, 100_000, 1.0)], 1e-3).unwrap().is_empty());
        let peaks = spectral_peaks(&[&decays(&[(1.0, 50.0, 0.0)], 1000.0, 8000, 1e-3)], 1e-3).unwrap();
        assert_eq!(peaks.len(), 1, "{peaks:?}");
        assert_eq!(peaks[0].damping_ratio, None);
    }

    #[test]
    fn a_mode_is_the_nearest_peak_and_not_the_highest() {
        let x = decays(&[(1.0, 100.0, 1e-3), (0.05, 112.0, 1e-3)], 1000.0, 20_000, 0.0);
        let band = |near| band_near(&[&x], 1e-3, near);
        assert!((band(110.0).unwrap().peak - 112.0).abs() < 0.05);
        assert!((band(103.0).unwrap().peak - 100.0).abs() < 0.05);
        let refused = band(160.0).unwrap_err().to_string();
        assert!(refused.contains("160 Hz") && refused.contains("112.0"), "{refused}");
        assert!(band(f64::NAN).is_err() && band(700.0).is_err());
    }
}
