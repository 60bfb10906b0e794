//! Hann-windowed spectrum, its peak, and the automatic band around it.

use std::f64::consts::PI;

use rustfft::FftPlanner;
use rustfft::num_complex::Complex64;

use crate::error::{Error, check, check_dt, check_samples};

/// The automatic band reaches from 0.75 to 1.3 times the peak's frequency: wide enough that the filter's memory is two cycles, narrow
/// enough that harmonics from 2 on stay outside. A judgement; `--band` overrules it.
const REACH: (f64, f64) = (0.75, 1.3);
/// The band ends at the geometric mean with a neighbouring peak of at least this fraction of the peak's height. A tenth of this value narrows
/// the band of a mode beside a line of 3 %; ten times as much leaves a second mode of 20 % in the band, which is refused.
const NEIGHBOUR: f64 = 0.03;
/// Such a neighbour is also at least this many times the median line, which noise alone does not reach.
const ABOVE_MEDIAN: f64 = 5.0;
/// Limits of the band on the side away from a strong neighbour, in distances from the peak to the band's edge on the neighbour's side: a filter's skirts are as wide as its
/// band, and let a neighbour through that is nearer than that. The first factor is for neighbours 5 % away and changes nothing there; for nearer ones the factor falls in
/// proportion to the distance, down to the second. With a factor of twenty-five modes 1 % apart were not separated, with twelve the smaller of them was not, with 2.5 both
/// are.
const ASIDE: (f64, f64) = (12.5, 2.0);
/// Distance from the peak to the geometric mean with a neighbour 5 % away, relative to the peak's frequency.
const FIVE_PER_CENT: f64 = 0.0247;
/// A neighbour is strong, and limits the band on both sides, from this fraction of the peak's height on: friction that stops a mode makes ripples of some per cent beside its
/// peak.
pub(super) const STRONG: f64 = 0.1;
/// The band reaches at most to this fraction of the Nyquist frequency, at which the bilinear transformation has no edge.
const NYQUIST_PART: f64 = 0.95;
/// A line outside the band of at least this fraction of the peak's height is another mode, and the record is then compared in the band and not as it is: a mode of
/// 2e-4 moves the amplitudes by as much, which is of the size of errors that fits of clean records leave. A judgement.
const OTHER_MODE: f64 = 2e-4;
/// A line is not another mode where it lies within this fraction of a multiple of the peak's frequency: the harmonics of a mode whose frequency
/// falls with amplitude are as wide as that.
const HARMONIC: f64 = 0.03;
/// The line of a decay is looked for within this fraction of its frequency on either side.
const OWN: f64 = 0.01;
/// The line stands this many times above the median of the lines around it, which noise does not reach.
const ABOVE_NOISE: f64 = 7.0;
/// The median is that of the lines within this fraction of the frequency on either side.
const NOISE: f64 = 0.1;
/// A decay goes on where its line in the second half of the samples is below this fraction of that in the first; a line that falls less is one that somebody drives.
/// Judgements, not varied, as are the three values above.
const FALLS: f64 = 0.9;
/// Largest difference of a driven tone's height between the two halves, as a natural logarithm: a mode that differs by less tells next to nothing of its damping.
const STEADY: f64 = 0.03;
/// Least number of cycles of a peak in the record: below lie offset and drift.
const CYCLES: f64 = 5.0;

/// A band in Hz and the spectral peak in it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Lower edge, Hz.
    pub low: f64,
    /// Upper edge, Hz.
    pub high: f64,
    /// Frequency of the highest spectral line within, Hz.
    pub peak: f64,
}

/// A peak beside another one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Neighbour {
    /// Hz.
    pub(super) frequency: f64,
    /// Whether the peak is too high to be a ripple of the other one.
    pub(super) is_strong: bool,
}

/// A line of an amplitude spectrum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpectralLine {
    /// Hz.
    pub frequency: f64,
    /// In the unit of the record.
    pub amplitude: f64,
}

/// Hann-windowed spectrum of a record from which its straight line (offset and drift) was subtracted.
struct Spectrum {
    /// Spacing of the lines, Hz.
    step: f64,
    lines: Vec<f64>,
}

impl Spectrum {
    fn new(x: &[f64], dt: f64) -> Self {
        let n = x.len();
        let middle = 0.5 * (n as f64 - 1.0);
        let mean = x.iter().sum::<f64>() / n as f64;
        let moment =
            |f: &dyn Fn(f64, f64) -> f64| -> f64 { (0..n).map(|i| f(i as f64 - middle, x[i])).sum() };
        let slope = moment(&|s, x| s * x) / moment(&|s, _| s * s);
        let mut z: Vec<Complex64> = (0..n)
            .map(|i| {
                let hann = (PI * (i as f64 + 0.5) / n as f64).sin().powi(2);
                Complex64::new(hann * (x[i] - mean - slope * (i as f64 - middle)), 0.0)
            })
            .collect();
        FftPlanner::new().plan_fft_forward(n).process(&mut z);
        Self { step: 1.0 / (n as f64 * dt), lines: z[..=n / 2].iter().map(|z| z.norm()).collect() }
    }

    /// The highest line between two frequencies that is a maximum among its neighbours.
    fn highest(&self, low: f64, high: f64) -> Option<usize> {
        let inside = |k: &usize| (low..=high).contains(&(*k as f64 * self.step)) && self.is_peak(*k);
        (1..self.lines.len().saturating_sub(1))
            .filter(inside)
            .max_by(|&i, &j| self.lines[i].total_cmp(&self.lines[j]))
    }

    fn is_peak(&self, k: usize) -> bool {
        is_peak(&self.lines, k)
    }

    /// Frequency of the peak at line `k`, by a parabola through the logarithms.
    fn frequency(&self, k: usize) -> f64 {
        vertex(&self.lines, k) * self.step
    }

    /// Nearest peak on one side of line `k` that stands by itself: high enough, and behind a valley of less than half its height. `lines` lead away from `k`.
    fn neighbour(&self, k: usize, lines: impl Iterator<Item = usize>) -> Option<Neighbour> {
        let least = (NEIGHBOUR * self.lines[k]).max(ABOVE_MEDIAN * median(self.lines.clone()));
        let mut valley = self.lines[k];
        for i in lines {
            valley = valley.min(self.lines[i]);
            if self.lines[i] >= least && self.is_peak(i) && valley < 0.5 * self.lines[i] {
                let is_strong = self.lines[i] >= STRONG * self.lines[k];
                return Some(Neighbour { frequency: self.frequency(i), is_strong });
            }
        }
        None
    }
}

/// Whether a line of a spectrum is higher than the one before it, and no lower than the one behind; `k` is neither the first nor the last.
#[must_use]
pub fn is_peak(lines: &[f64], k: usize) -> bool {
    lines[k] > lines[k - 1] && lines[k] >= lines[k + 1]
}

/// Place of the maximum about a peak at line `k`, in lines, by a parabola through the logarithms of three lines: the same for magnitudes and powers, and exact for a Gaussian.
///
/// ```
/// let lines: Vec<f64> = (0..9).map(|k| (-0.3 * (f64::from(k) - 4.2_f64).powi(2)).exp()).collect();
/// assert!(iwan_ident::signal::is_peak(&lines, 4));
/// assert!((iwan_ident::signal::vertex(&lines, 4) - 4.2).abs() < 1e-12);
/// ```
#[must_use]
pub fn vertex(lines: &[f64], k: usize) -> f64 {
    let [a, b, c] = [k - 1, k, k + 1].map(|k| lines[k].max(f64::MIN_POSITIVE).ln());
    let curvature = a - 2.0 * b + c;
    let shift = if curvature < 0.0 { (0.5 * (a - c) / curvature).clamp(-0.5, 0.5) } else { 0.0 };
    k as f64 + shift
}

/// Width of a peak at line `k` of a power spectrum between its half-power points, in lines, by straight lines between the lines. Where one side rises again before it
/// falls to a half, it is twice the other side. None where neither side falls to a half.
#[must_use]
pub fn half_power_width(power: &[f64], k: usize) -> Option<f64> {
    let half = 0.5 * power[k];
    let side = |lines: &mut dyn Iterator<Item = usize>| {
        let mut last = power[k];
        for (n, i) in lines.enumerate() {
            if power[i] <= half {
                return Some(n as f64 + (last - half) / (last - power[i]));
            }
            if power[i] > last {
                return None;
            }
            last = power[i];
        }
        None
    };
    match (side(&mut (0..k).rev()), side(&mut (k + 1..power.len()))) {
        (Some(a), Some(b)) => Some(a + b),
        (one, other) => one.or(other).map(|side| 2.0 * side),
    }
}

/// The median of some lines, of which there is one at least.
pub(super) fn median(mut lines: Vec<f64>) -> f64 {
    let middle = lines.len() / 2;
    *lines.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Hann-windowed amplitude spectrum of a record less its straight line, with every line up to the Nyquist frequency: a steady sinusoid of amplitude A shows as a peak of
/// height A.
///
/// # Errors
/// [`Error::OutOfRange`] for `dt`, [`Error::NotFinite`], [`Error::TooShort`] below 16 samples.
///
/// ```
/// let x: Vec<f64> = (0..1000).map(|n| 3.0 + 0.5 * (std::f64::consts::TAU * 0.1 * n as f64).cos()).collect();
/// let spectrum = iwan_ident::signal::amplitude_spectrum(&x, 1e-2)?;
/// let line = spectrum[100];
/// assert!((line.frequency - 10.0).abs() < 1e-12 && (line.amplitude - 0.5).abs() < 1e-3);
/// assert!(spectrum[0].amplitude < 1e-3);
/// # Ok::<(), iwan_ident::Error>(())
/// ```
pub fn amplitude_spectrum(x: &[f64], dt: f64) -> Result<Vec<SpectralLine>, Error> {
    check_dt(dt)?;
    check_samples("record", x, 16, "record longer")?;
    let spectrum = Spectrum::new(x, dt);
    // The mean of the window is 1/2, and half of the amplitude stands at the negative frequency.
    let scale = 4.0 / x.len() as f64;
    let line = |(k, height): (usize, &f64)| SpectralLine {
        frequency: k as f64 * spectrum.step,
        amplitude: scale * height,
    };
    Ok(spectrum.lines.iter().enumerate().map(line).collect())
}

/// The automatic band around the highest spectral peak, or around the highest within 20 % of `near` (Hz).
///
/// Rule: 0.75 to 1.3 times the peak's frequency, cut at the geometric mean with the next peak on either side that has
/// 3 % of its height, stands out of the noise and has a valley before it, and at 95 % of the Nyquist frequency. Beside a neighbour of a tenth of the peak's height that is nearer
/// than 5 %, the band is narrower on the other side as well, because the filter's skirt would let that neighbour through.
///
/// # Errors
/// [`Error::Refused`] when there is no peak that lasts five cycles; [`Error::NotFinite`], [`Error::TooShort`],
/// [`Error::OutOfRange`] for `dt` and `near`.
///
/// ```
/// let wave = |f: f64, n: usize| (std::f64::consts::TAU * f * n as f64 / 1000.0).sin();
/// let x: Vec<f64> = (0..4000).map(|n| 7.0 + wave(80.0, n) + 0.3 * wave(125.0, n)).collect();
/// let band = iwan_ident::signal::automatic_band(&x, 1e-3, None)?;
/// assert!((band.peak - 80.0).abs() < 0.01 && (band.low - 60.0).abs() < 0.01);
/// assert!((band.high - 100.0).abs() < 0.01); // the square root of 80·125
/// # Ok::<(), iwan_ident::Error>(())
/// ```
pub fn automatic_band(x: &[f64], dt: f64, near: Option<f64>) -> Result<Band, Error> {
    let nyquist = 0.5 / check_dt(dt)?;
    check_samples("record", x, 16, "record longer")?;
    let spectrum = Spectrum::new(x, dt);
    let mut range = (CYCLES * spectrum.step, nyquist);
    if let Some(near) = near {
        let allowed = format!("between 0 and the Nyquist frequency {nyquist} Hz");
        check("near", near, near > 0.0 && near < nyquist, &allowed, "give a frequency in Hz")?;
        range = (0.8 * near, 1.25 * near);
    }
    let k = spectrum.highest(range.0, range.1).ok_or_else(|| Error::Refused {
        finding: format!("no spectral peak between {:.6} and {:.6} Hz", range.0, range.1),
        remedy: "name the band, or check that the record holds a ring-down of more than five cycles",
    })?;
    let peak = spectrum.frequency(k);
    // A Hann-windowed line is four lines wide.
    let above = spectrum.neighbour(k, k + 2..spectrum.lines.len() - 1);
    let below = spectrum.neighbour(k, (1..k.saturating_sub(1)).rev());
    Ok(Band::between((below, above), peak, nyquist))
}

impl Band {
    /// The automatic band about a peak (Hz) with neighbours below and above it. On each side it reaches no farther than a strong, near neighbour on the other side allows.
    pub(super) fn between(
        (below, above): (Option<Neighbour>, Option<Neighbour>),
        peak: f64,
        nyquist: f64,
    ) -> Self {
        let middle = |n: Neighbour| (n.frequency * peak).sqrt();
        let low = below.map_or(0.0, middle).max(REACH.0 * peak);
        let high = above.map_or(f64::INFINITY, middle).min(REACH.1 * peak).min(NYQUIST_PART * nyquist);
        let reach = |neighbour: Option<Neighbour>, near: f64| {
            let aside = ASIDE.0 * (near / (FIVE_PER_CENT * peak)).min(1.0);
            neighbour.filter(|n| n.is_strong).map_or(f64::INFINITY, |_| aside.max(ASIDE.1) * near)
        };
        Self {
            low: low.max(peak - reach(above, high - peak)),
            high: high.min(peak + reach(below, peak - low)),
            peak,
        }
    }
}

/// Whether no other line than the band's peak and its harmonics stands out of a record's spectrum.
pub(super) fn is_alone(x: &[f64], dt: f64, band: &Band) -> bool {
    let spectrum = Spectrum::new(x, dt);
    let line = |f: f64| ((f / spectrum.step) as usize).clamp(2, spectrum.lines.len() - 2);
    let top = spectrum.highest(band.low, band.high).map_or(0.0, |k| spectrum.lines[k]);
    let least = (OTHER_MODE * top).max(ABOVE_MEDIAN * median(spectrum.lines.clone()));
    let harmonic = |f: f64| {
        let order = (f / band.peak).round();
        order >= 2.0 && (f / (order * band.peak) - 1.0).abs() < HARMONIC
    };
    let stands_out = |k: usize| {
        // A line stands out where it is three times as high as the lowest lines within 3 % on both sides; the skirt of another peak is not.
        let around = (
            line(0.97 * k as f64 * spectrum.step).min(k - 2),
            line(1.03 * k as f64 * spectrum.step).max(k + 2),
        );
        let lowest =
            |from: usize, to: usize| spectrum.lines[from..to].iter().copied().fold(f64::INFINITY, f64::min);
        let edge = around.1.min(spectrum.lines.len() - 1);
        spectrum.is_peak(k)
            && spectrum.lines[k] >= least
            && spectrum.lines[k] > 3.0 * lowest(around.0, k).max(lowest(k + 1, edge + 1))
    };
    let lowest = line(CYCLES * spectrum.step).max(line(0.2 * band.peak));
    (lowest..line(band.low))
        .chain(line(band.high)..spectrum.lines.len() - 2)
        .all(|k| harmonic(k as f64 * spectrum.step) || !stands_out(k))
}

/// The peak within a band that the user names.
pub(super) fn given_band(x: &[f64], dt: f64, low: f64, high: f64) -> Result<Band, Error> {
    let spectrum = Spectrum::new(x, dt);
    let k = spectrum.highest(low, high).ok_or_else(|| Error::Refused {
        finding: format!("no spectral peak between {low} and {high} Hz"),
        remedy: "move or widen the band, or leave it out: then the highest peak is taken",
    })?;
    let peak = spectrum.frequency(k);
    if peak - low < spectrum.step || high - peak < spectrum.step {
        return Err(Error::Refused {
            finding: format!(
                "between {low} and {high} Hz the spectrum is highest at the band's edge, {peak:.4} Hz: that is the skirt of a peak \
                 outside"
            ),
            remedy: "move the band to a peak, or leave it out: then the highest peak is taken",
        });
    }
    Ok(Band { low, high, peak })
}

/// Whether a line at this frequency (Hz) stands out of the noise in the first half of some samples, and is lower in the second half: a decay that goes on.
pub(super) fn goes_on(x: &[f64], dt: f64, frequency: f64) -> bool {
    if x.len() < 32 {
        return true;
    }
    let [first, second] = in_halves(x, dt, frequency);
    first.height > ABOVE_NOISE * first.noise && second.height < FALLS * first.height
}

/// Whether a line at this frequency (Hz) stands out of the noise in both halves of some samples and is as high in one as in the other: a tone that is driven.
pub(super) fn is_steady(x: &[f64], dt: f64, frequency: f64) -> bool {
    if x.len() < 32 {
        return false;
    }
    let halves = in_halves(x, dt, frequency);
    let [first, second] = &halves;
    halves.iter().all(|h| h.height > ABOVE_NOISE * h.noise)
        && (second.height / first.height).ln().abs() < STEADY
}

/// Height of a line in a part of a record, and the median of the lines around it.
struct Around {
    height: f64,
    noise: f64,
}

/// The line at a frequency (Hz) in both halves of some samples.
fn in_halves(x: &[f64], dt: f64, frequency: f64) -> [Around; 2] {
    [&x[..x.len() / 2], &x[x.len() / 2..]].map(|half| {
        let spectrum = Spectrum::new(half, dt);
        let around = |part: f64, least: usize| {
            let (at, reach) =
                (frequency / spectrum.step, (part * frequency / spectrum.step).max(least as f64));
            let last = spectrum.lines.len() - 1;
            spectrum.lines[((at - reach).max(0.0) as usize).min(last)..=((at + reach) as usize).min(last)]
                .to_vec()
        };
        Around { height: around(OWN, 3).into_iter().fold(0.0, f64::max), noise: median(around(NOISE, 20)) }
    })
}

/// The line that has most of the power of a complex residual.
pub(super) struct Strongest {
    /// Distance from the reference frequency, Hz, with its sign.
    pub(super) offset: f64,
    /// Amplitude of the line over that of the mode.
    pub(super) relative: f64,
    /// Part of the residual's power that the line has.
    pub(super) share: f64,
}

/// The strongest line of a residual `z`, which is relative to the mode and sampled every `dt` seconds.
pub(super) fn strongest_line(z: &[Complex64], dt: f64) -> Strongest {
    let n = z.len();
    let hann = |i: usize| (PI * (i as f64 + 0.5) / n as f64).sin().powi(2);
    let mut lines: Vec<Complex64> = z.iter().enumerate().map(|(i, z)| z * hann(i)).collect();
    FftPlanner::new().plan_fft_forward(n).process(&mut lines);
    let power: Vec<f64> = lines.iter().map(Complex64::norm_sqr).collect();
    let total: f64 = power.iter().sum();
    let k = (0..n).max_by(|&i, &j| power[i].total_cmp(&power[j])).unwrap_or(0);
    let near: f64 = (0..7).map(|j| power[(k + n + j - 3) % n]).sum();
    let signed = if 2 * k > n { k as f64 - n as f64 } else { k as f64 };
    Strongest {
        offset: signed / (n as f64 * dt),
        relative: 2.0 * power[k].sqrt() / n as f64,
        share: near / total.max(f64::MIN_POSITIVE),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offset_and_drift_are_not_peaks() {
        let x: Vec<f64> =
            (0..4000).map(|n| 50.0 + 0.01 * f64::from(n) + (0.5 * f64::from(n)).sin()).collect();
        let band = automatic_band(&x, 1e-3, None).unwrap();
        assert!((band.peak - 500.0 / std::f64::consts::TAU).abs() < 0.02, "{band:?}");
        assert!(automatic_band(&[1.0; 100], 1e-3, None).is_err());
    }

    #[test]
    fn near_chooses_a_weaker_mode() {
        let wave = |f: f64, n: i32| (std::f64::consts::TAU * f * f64::from(n) / 1000.0).sin();
        let x: Vec<f64> = (0..4000).map(|n| wave(80.0, n) + 0.01 * wave(222.0, n)).collect();
        let band = automatic_band(&x, 1e-3, Some(220.0)).unwrap();
        assert!((band.peak - 222.0).abs() < 0.01 && band.low > 160.0, "{band:?}");
        assert!(automatic_band(&x, 1e-3, Some(600.0)).is_err());
    }
}
