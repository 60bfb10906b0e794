//! One mode by itself: the window in which it can be trusted, its noise, and the transients that its start and end leave behind a filter.

use std::ops::Range;

use super::defects::clipped_until;
use super::first_peak::{behind_the_blow, first_of_the_largest};
use super::raw::{BEYOND, Raw, raw, widened};
use super::spectrum::{Band, is_alone};
use super::survey::Treatment;
use super::transients::{Ends, Gate, Known};
use crate::error::Error;
use crate::smooth::{Points, Polynomial};

/// Least number of cycles in the window: an envelope by polynomials then has some thirty values for three or more coefficients.
/// A window with fewer is refused.
pub(super) const CYCLES: usize = 8;
/// Least number of values of amplitude and phase in the window: four a cycle, less those of the three cycles that are trimmed.
const VALUES: usize = 4 * CYCLES - 12;
/// Largest number of times that the window is cut where the mode sinks into noise, each time with the noise estimated anew; one, two and
/// eight cuts give the same windows on the records tried.
const CUTS: usize = 4;
/// Largest number of rounds in which the mode is continued and its transients are subtracted, each from a better knowledge of the mode; a round that
/// leaves more than the one before ends them. Other numbers were not tried.
const PASSES: usize = 3;
/// Number of blocks in which a tail of noise is looked for, and least number of phase values in a block: five cycles of four.
const PHASE_BLOCKS: usize = 40;
const LEAST_BLOCK: usize = 20;
/// A block is noise alone where the root mean square of the phase's second differences exceeds this, in rad at four values a cycle. An estimate for a
/// mode about as loud as the noise in its band; not varied.
const WANDERING: f64 = 0.6;
/// An amplitude that falls by less than this fraction over the window is noted as that of a driven tone, or of a record too short to tell its damping. A judgement.
pub(crate) const HARDLY: f64 = 0.02;
/// Least relative scatter of an amplitude: that of rounding.
const LEAST_SCATTER: f64 = 1e-12;
/// The window ends where the amplitude falls to this many standard deviations of the noise in the band: there one value of
/// ln A scatters by 20 %. Half and twice this value change nothing on the records tried down to 20 dB, which end before that point.
const ABOVE_NOISE: f64 = 5.0;
/// Highest degree of polynomials in time. On the Brake-Reuss record degree six leaves an error of 6 % of the damping at the start, degree twelve
/// leaves 3 %, and where 24 are allowed, twelve or thirteen are taken.
pub(crate) const MAX_ORDER: usize = 12;

/// Remedy where a line that does not decay stands in the band.
const BEFORE: &str =
    "end the record where the mode is still much louder than that line (--to), or record without it";

/// A mode by itself.
#[derive(Debug, Clone)]
pub struct Isolated {
    /// The band-passed record, all of it.
    pub samples: Vec<f64>,
    /// Sampling interval, s.
    pub dt: f64,
    /// Band and spectral peak, Hz.
    pub band: Band,
    /// Range of samples in which amplitude and frequency can be trusted.
    pub window: Range<usize>,
    /// Standard deviation of the noise in the band, in the unit of the record (0 when it is not seen).
    pub noise: f64,
    /// What was found and done, in words.
    pub notes: Vec<String>,
    /// What was done to the record before it was given here: none where nothing is seen of it.
    pub treatment: Option<Treatment>,
    /// Independent values a second behind the filter.
    pub(crate) bandwidth: f64,
    /// Relative scatter of the amplitude apart from noise.
    pub(crate) scatter: f64,
    pub(crate) raw: Raw,
    /// The sample at which the mode's decay starts; 0 without a filter.
    pub(crate) begin: usize,
    /// Contribution of other modes to each sample of the filtered record before they were subtracted; none where no mode was.
    pub(crate) beside: Option<Vec<f64>>,
    /// Lines in the band or next to it that do not decay, in words.
    pub(super) steady: Vec<String>,
}

/// A stretch of a mode's samples.
pub(crate) struct Stretch<'a> {
    /// Index of the first.
    pub(crate) first: usize,
    pub(crate) samples: &'a [f64],
}

/// Squared deviation of one value of the log amplitude from the smooth curve, and the amplitude there.
struct Scatter {
    amplitude: f64,
    square: f64,
}

impl Isolated {
    /// Time of the sample `n`, s from the first.
    #[must_use]
    pub fn time(&self, n: usize) -> f64 {
        n as f64 * self.dt
    }

    /// Start and end of the trusted window, s from the first sample.
    #[must_use]
    pub fn trusted(&self) -> (f64, f64) {
        (self.time(self.window.start), self.time(self.window.end - 1))
    }

    /// Whether the mode can have been isolated from the record `x` with samples every `dt` seconds.
    pub(crate) fn is_of(&self, x: &[f64], dt: f64) -> bool {
        self.samples.len() <= x.len() && self.dt == dt
    }

    /// Adds the lines that do not decay to the reason why a mode could not be followed.
    pub(crate) fn refused(&self, error: Error) -> Error {
        let lines = self.steady.join(", and ");
        match error {
            Error::TooShort { what, found, needed, .. } if !lines.is_empty() => Error::Refused {
                finding: format!(
                    "{what}: {found} found, at least {needed} needed. What stands in its way: {lines}"
                ),
                remedy: BEFORE,
            },
            Error::Refused { finding, .. } if !lines.is_empty() => Error::Refused {
                finding: format!("{finding}. What stands in its way: {lines}"),
                remedy: BEFORE,
            },
            error => error,
        }
    }

    /// Whether the mode is the only one that stands out of the spectrum of the record `x` it was taken from.
    pub(crate) fn is_alone(&self, x: &[f64]) -> bool {
        is_alone(&x[..self.samples.len()], self.dt, &self.band)
    }

    /// Range of samples of the record `x` in free decay: from its first peak, or from behind the last clipped sample, to the end of the
    /// trusted window; not before the start of `window` (s) if given.
    pub(crate) fn free_decay(&self, x: &[f64], window: Option<(f64, f64)>) -> Range<usize> {
        let x = &x[..self.samples.len()];
        let start = self.first_peak(x).max(clipped_until(x).unwrap_or(0));
        let wanted = window.map_or(0, |w| (w.0 / self.dt).ceil() as usize);
        start.max(wanted).min(self.window.start)..self.window.end
    }

    /// The sample at which the mode starts, and whether the record itself shows the start there. It is the record's first peak in free decay. Where that lies behind the
    /// mode's own largest amplitude, or `trim` samples and more before it, it belongs to another mode, an offset or a drift, and the sample of the mode's own largest
    /// amplitude is taken.
    pub(super) fn begin(&self, x: &[f64], trim: usize) -> (usize, bool) {
        let inside = self.samples.len().saturating_sub(trim).max(1);
        let largest = first_of_the_largest(self.samples[..inside].iter().map(|y| y.abs()));
        let own = self.first_peak(x);
        if own <= largest && own + trim > largest { (own, true) } else { (largest, false) }
    }

    /// Index of the first peak of the record `x` in free decay.
    fn first_peak(&self, x: &[f64]) -> usize {
        let mean = x.iter().sum::<f64>() / x.len() as f64;
        let largest = first_of_the_largest(x.iter().map(|x| (x - mean).abs()));
        behind_the_blow(x, mean, largest, 1.0 / (self.band.peak * self.dt))
    }

    /// The window and one cycle to either side, so that peaks and crossings cover the whole window.
    pub(crate) fn stretch(&self) -> Stretch<'_> {
        let range = widened(&self.window, self.samples.len(), 1.0 / (self.band.peak * self.dt));
        Stretch { first: range.start, samples: &self.samples[range] }
    }

    /// Weight of a value of ln A or of the phase at this amplitude, from scatter and noise together: 1 where there is no noise, less where noise exceeds the scatter.
    pub(crate) fn weight(&self, amplitude: f64) -> f64 {
        if self.noise == 0.0 { 1.0 } else { 1.0 / (1.0 + (self.noise / (self.scatter * amplitude)).powi(2)) }
    }

    /// Number of independent values among `count` over the window.
    pub(crate) fn effective(&self, count: usize) -> f64 {
        (self.window.len() as f64 * self.dt * self.bandwidth).min(count as f64).max(2.0)
    }

    pub(crate) fn points<'a>(&self, t: &'a [f64], y: &'a [f64], weight: &'a [f64]) -> Points<'a> {
        Points { t, y, weight, effective: self.effective(t.len()) }
    }

    /// Subtracts the transients that the filter makes of start and end of the mode. Where no other mode starts there, the window is then widened back to the start.
    pub(super) fn without_transients(
        &mut self,
        x: &[f64],
        ends: &Ends<'_>,
        may_widen: bool,
    ) -> Result<(), Error> {
        self.take_off(ends)?;
        let first = ends.decay.start + (BEYOND / (self.band.peak * self.dt)).ceil() as usize;
        if may_widen && first < self.window.start && self.is_alone(x) {
            self.window.start = first;
            self.raw = raw(&self.samples, &self.window, self.dt, self.band.peak);
            self.take_off(ends)?;
        }
        self.estimate_noise();
        Ok(())
    }

    /// The mode at all samples, continued from its window to both ends of its decay.
    pub(super) fn continued(&self, gate: &Gate) -> Option<Vec<f64>> {
        let decay = gate.begin..self.samples.len();
        self.known().continued(self.samples.len(), &decay, gate.reach, MAX_ORDER)
    }

    fn known(&self) -> Known<'_> {
        let Self { raw, window, dt, band, .. } = self;
        Known { raw, effective: self.effective(raw.t.len()), window, dt: *dt, centre: band.peak }
    }

    fn take_off(&mut self, ends: &Ends<'_>) -> Result<(), Error> {
        let mut most = f64::INFINITY;
        for _ in 0..PASSES {
            let known = self.known();
            let Some(filtered) = ends.filtered(&known, MAX_ORDER)?.filter(|f| f.left < most) else { break };
            most = filtered.left;
            self.samples[ends.decay.start..].copy_from_slice(&filtered.samples);
            self.raw = raw(&self.samples, &self.window, self.dt, self.band.peak);
        }
        Ok(())
    }

    /// Cuts the window where the mode sinks into the noise, which is estimated from the scatter of the amplitude. With `must_decay` a mode that does not decay is refused.
    pub(super) fn end_at_noise(&mut self, must_decay: bool) -> Result<(), Error> {
        self.cut_noise_alone();
        let mut cut = None;
        for _ in 0..CUTS {
            self.enough_cycles()?;
            let fit = self.estimate_noise();
            let limit = ABOVE_NOISE * self.noise;
            let sunk = self.raw.t.iter().position(|&t| fit.value(t).exp() < limit);
            let Some(at) = sunk else { break };
            let t = self.raw.t[at];
            cut = Some(format!("the mode sinks into noise (amplitude {limit:.6}) at {t:.6} s: cut there"));
            self.window.end = (t / self.dt) as usize;
            if self.window.end > self.window.start {
                self.raw = raw(&self.samples, &self.window, self.dt, self.band.peak);
            }
        }
        self.notes.extend(cut);
        self.enough_cycles()?;
        let fit = self.estimate_noise();
        let ends = [0, self.raw.t.len() - 1].map(|i| fit.value(self.raw.t[i]));
        if must_decay && ends[1] >= ends[0] {
            return Err(Error::Refused {
                finding: format!(
                    "the amplitude does not decay: {:.6} to {:.6}",
                    ends[0].exp(),
                    ends[1].exp()
                ),
                remedy: "choose a window in free decay, or another band",
            });
        }
        let lost = 1.0 - (ends[1] - ends[0]).exp();
        if must_decay && lost < HARDLY {
            self.notes.push(format!(
                "the amplitude falls by {:.2} % in all: a tone that is driven, or a record too short to tell its damping",
                100.0 * lost
            ));
        }
        Ok(())
    }

    /// Cuts off a tail in which there is nothing but noise: there the phase wanders from value to value, while that of a mode advances
    /// evenly. A curve through the amplitudes of the whole record would bend to such a tail.
    fn cut_noise_alone(&mut self) {
        let phase = &self.raw.phase;
        let wanders: Vec<f64> = phase.windows(3).map(|p| (p[2] - 2.0 * p[1] + p[0]).powi(2)).collect();
        let length = (wanders.len() / PHASE_BLOCKS).max(LEAST_BLOCK);
        let is_noise = |block: &[f64]| block.iter().sum::<f64>() / block.len() as f64 > WANDERING * WANDERING;
        let quiet = wanders.rchunks(length).take_while(|block| is_noise(block)).count();
        let kept = wanders.len().saturating_sub(quiet * length);
        if quiet == 0 || kept < VALUES {
            return;
        }
        let t = self.raw.t[kept];
        self.notes.push(format!("from {t:.6} s on there is nothing but noise in the band: cut there"));
        self.window.end = (t / self.dt) as usize;
        self.raw = raw(&self.samples, &self.window, self.dt, self.band.peak);
    }

    fn enough_cycles(&self) -> Result<(), Error> {
        let length = self.window.end.saturating_sub(self.window.start) as f64 * self.dt;
        let found = (length * self.band.peak) as usize;
        if found >= CYCLES && self.raw.t.len() >= VALUES {
            return Ok(());
        }
        let remedy =
            "record longer or louder, or choose a wider band (--band) where other modes leave room for it";
        Err(Error::TooShort {
            what: "cycles of the mode in the trusted window",
            found,
            needed: CYCLES,
            remedy,
        })
    }

    /// Estimates scatter and noise from the deviations of the log amplitude from its smooth curve, which is returned: the relative `scatter` from the loudest quarter of the
    /// values, the `noise` from the quietest.
    fn estimate_noise(&mut self) -> Polynomial {
        let count = self.raw.t.len();
        let weight = vec![1.0; count];
        let fit =
            Polynomial::fit(&self.points(&self.raw.t, &self.raw.log_amplitude, &weight), None, MAX_ORDER);
        let scatter = |i: usize| {
            let log = fit.value(self.raw.t[i]);
            Scatter { amplitude: log.exp(), square: (self.raw.log_amplitude[i] - log).powi(2) }
        };
        let mut all: Vec<Scatter> = (0..count).map(scatter).collect();
        all.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
        let quarter = count.div_ceil(4);
        let mean = |part: &[Scatter], f: &dyn Fn(&Scatter) -> f64| {
            part.iter().map(f).sum::<f64>() / part.len() as f64
        };
        self.scatter = mean(&all[..quarter], &|s| s.square).sqrt().max(LEAST_SCATTER);
        self.noise = mean(&all[count - quarter..], &|s| s.square * s.amplitude * s.amplitude).sqrt();
        fit
    }
}
