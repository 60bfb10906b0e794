//! Amplitude, frequency and damping ratio against time: one result for all methods.

use super::hann::demodulated;
use super::isolate::{Isolated, MAX_ORDER, Options, isolate};
use super::peaks::{crossing_phases, peak_amplitudes};
use super::pff::{fitted_peaks, half_cycle_phases};
use crate::error::Error;
use crate::smooth::{LocalFit, Polynomial, Smooth, Spline};

/// How amplitude and phase are taken from the mode, and how they are smoothed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Method {
    /// Analytic signal; polynomials in time through log amplitude and phase. The paper's choice, and the default.
    #[default]
    Hilbert,
    /// Interpolated peaks and zero crossings; cubic splines through log |peaks| and phase (Eq. 6-8).
    Peaks,
    /// Peak finding and fitting: a sinusoid fitted around each peak, moving least squares (after M. Jin, W. Chen,
    /// M. R. W. Brake, H. Song, J. Vib. Acoust. 142, 051111, 2020, doi:10.1115/1.4047416).
    PeakFitting,
    /// Hann-windowed demodulation at the spectral peak, moving least squares: a cross-check, coarser at the ends.
    Demodulation,
}

impl Method {
    /// All methods, the default first.
    pub const ALL: [Self; 4] = [Self::Hilbert, Self::Peaks, Self::PeakFitting, Self::Demodulation];

    /// Its name in reports and options.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Hilbert => "hilbert",
            Self::Peaks => "peaks",
            Self::PeakFitting => "pff",
            Self::Demodulation => "demodulation",
        }
    }
}

/// Amplitude, frequency and damping ratio of one mode against time.
///
/// All vectors have one entry per cycle of the trusted window. Standard deviations hold what scatters about the smooth
/// curve (noise), not what the method gets wrong: for that compare the methods ([`Spread`](super::Spread)).
#[derive(Debug, Clone, PartialEq)]
pub struct Envelope {
    /// Time from the first sample of the record, s.
    pub t: Vec<f64>,
    /// Amplitude A of the mode, in the unit of the record.
    pub amplitude: Vec<f64>,
    /// Frequency θ'/2π of oscillation, Hz.
    pub frequency: Vec<f64>,
    /// Damping ratio ζ = λ/√(ω² + λ²) with the decay rate λ = -A'/A and ω = θ': exact for a linear mode.
    pub damping_ratio: Vec<f64>,
    /// Standard deviation of ln A.
    pub log_amplitude_sd: Vec<f64>,
    /// Standard deviation of the frequency, Hz.
    pub frequency_sd: Vec<f64>,
    /// Standard deviation of the damping ratio.
    pub damping_ratio_sd: Vec<f64>,
    /// Start and end of the window in which all this can be trusted, s.
    pub trusted: (f64, f64),
    /// How it was found.
    pub method: Method,
    /// Degree of the polynomial (Hilbert), number of spline intervals (peaks), cycles in a neighbourhood (the others).
    pub order: usize,
    /// Standard deviation of the noise in the band, in the unit of the record.
    pub noise: f64,
    /// What was found and done, in words.
    pub notes: Vec<String>,
}

/// Points of log amplitude and of phase (less that of the reference frequency), before smoothing.
#[derive(Debug, Clone, Default)]
pub(crate) struct Traces {
    pub(crate) amplitude: (Vec<f64>, Vec<f64>),
    pub(crate) phase: (Vec<f64>, Vec<f64>),
}

/// Envelope and frequency of one mode of a record `x`, sampled every `dt` seconds.
///
/// # Errors
/// As [`isolate`](super::isolate()); [`Error::OutOfRange`] when the sampling rate is too low for a method.
///
/// ```
/// use iwan_ident::signal::{Method, Options, envelope};
/// // A linear mode: 80 Hz, 0.2 % damping.
/// let (omega, zeta) = (std::f64::consts::TAU * 80.0, 0.002_f64);
/// let t = |n: usize| n as f64 / 4096.0;
/// let x: Vec<f64> = (0..8192).map(|n| (-zeta * omega * t(n)).exp() * (omega * (1.0 - zeta * zeta).sqrt() * t(n)).cos()).collect();
/// let envelope = envelope(&x, 1.0 / 4096.0, Method::Hilbert, &Options::default())?;
/// let (_, frequency, damping_ratio) = envelope.at(1.0).unwrap();
/// assert!((frequency - 80.0).abs() < 0.001 && (damping_ratio / zeta - 1.0).abs() < 0.002);
/// # Ok::<(), iwan_ident::Error>(())
/// ```
pub fn envelope(x: &[f64], dt: f64, method: Method, options: &Options) -> Result<Envelope, Error> {
    isolate(x, dt, options)?.envelope(method, options.order)
}

impl Isolated {
    /// Envelope and frequency by one method; `order` as in [`Options::order`].
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when the sampling rate is too low for the method; [`Error::TooShort`].
    pub fn envelope(&self, method: Method, order: Option<usize>) -> Result<Envelope, Error> {
        let traces = match method {
            Method::Hilbert => Traces {
                amplitude: (self.raw.t.clone(), self.raw.log_amplitude.clone()),
                phase: (self.raw.t.clone(), self.raw.phase.clone()),
            },
            Method::Peaks => Traces { amplitude: peak_amplitudes(self)?, phase: crossing_phases(self) },
            Method::PeakFitting => {
                let peaks = fitted_peaks(self)?;
                Traces { phase: half_cycle_phases(self, &peaks), amplitude: peaks }
            }
            Method::Demodulation => demodulated(self),
        };
        self.smooth(&traces, method, order)
    }

    fn smooth(&self, traces: &Traces, method: Method, order: Option<usize>) -> Result<Envelope, Error> {
        let (start, end) = common(&traces.amplitude.0, &traces.phase.0)?;
        let (start, end) = (start.max(self.trusted().0), end.min(self.trusted().1));
        let guide =
            self.curve(&traces.amplitude, &vec![1.0; traces.amplitude.0.len()], Method::Hilbert, None)?.0;
        let weights =
            |t: &[f64]| -> Vec<f64> { t.iter().map(|&t| self.weight(guide.at(t).value.exp())).collect() };
        let (amplitude, order) =
            self.curve(&traces.amplitude, &weights(&traces.amplitude.0), method, order)?;
        // The phase bends with the amplitude: it gets the same freedom at least.
        let least = (method == Method::Hilbert || method == Method::Peaks).then_some(order);
        let (mut phase, found) = self.curve(&traces.phase, &weights(&traces.phase.0), method, None)?;
        if let Some(least) = least.filter(|least| found < *least) {
            phase = self.curve(&traces.phase, &weights(&traces.phase.0), method, Some(least))?.0;
        }
        let count = (((end - start) * self.band.peak) as usize).max(2);
        let mut envelope = Envelope {
            t: (0..=count).map(|i| start + (end - start) * i as f64 / count as f64).collect(),
            amplitude: vec![],
            frequency: vec![],
            damping_ratio: vec![],
            log_amplitude_sd: vec![],
            frequency_sd: vec![],
            damping_ratio_sd: vec![],
            trusted: (start, end),
            method,
            order,
            noise: self.noise,
            notes: self.notes.clone(),
        };
        for i in 0..=count {
            envelope.push(&*amplitude, &*phase, envelope.t[i], self.band.peak);
        }
        Ok(envelope)
    }

    /// The smooth curve of a method, and its order.
    fn curve(
        &self,
        (t, y): &(Vec<f64>, Vec<f64>),
        weight: &[f64],
        method: Method,
        order: Option<usize>,
    ) -> Result<(Box<dyn Smooth>, usize), Error> {
        let points = self.points(t, y, weight);
        Ok(match method {
            Method::Hilbert => {
                let fit = Polynomial::fit(&points, order, MAX_ORDER);
                let order = fit.order();
                (Box::new(fit), order)
            }
            Method::Peaks => {
                let needed = 2 * (order.unwrap_or(1) + 3);
                let remedy = "record longer, or choose another method";
                let spline = Spline::fit(&points, order).ok_or(Error::TooShort {
                    what: "peaks in the trusted window",
                    found: t.len(),
                    needed,
                    remedy,
                })?;
                let intervals = spline.intervals();
                (Box::new(spline), intervals)
            }
            Method::PeakFitting | Method::Demodulation => {
                let half = self.neighbourhood();
                (Box::new(LocalFit::new(&points, half)), (2.0 * half * self.band.peak).round() as usize)
            }
        })
    }

    /// Half length in seconds of the neighbourhood in moving least squares: an eighth of the window, but at least six
    /// cycles and twelve independent values.
    fn neighbourhood(&self) -> f64 {
        let length = self.window.len() as f64 * self.dt;
        (length / 8.0).max(6.0 / self.band.peak).max(6.0 / self.bandwidth).min(0.5 * length)
    }
}

/// Range of times that both traces cover.
fn common(a: &[f64], b: &[f64]) -> Result<(f64, f64), Error> {
    const NEEDED: usize = 8;
    let found = a.len().min(b.len());
    if found < NEEDED {
        let remedy = "record longer, or choose another method";
        return Err(Error::TooShort { what: "peaks in the trusted window", found, needed: NEEDED, remedy });
    }
    Ok((a[0].max(b[0]), a[a.len() - 1].min(b[b.len() - 1])))
}

impl Envelope {
    fn push(&mut self, amplitude: &dyn Smooth, phase: &dyn Smooth, t: f64, centre: f64) {
        let (a, p) = (amplitude.at(t), phase.at(t));
        let turn = std::f64::consts::TAU;
        let omega = turn * centre + p.slope;
        self.amplitude.push(a.value.exp());
        self.frequency.push(omega / turn);
        self.damping_ratio.push(-a.slope / a.slope.hypot(omega));
        self.log_amplitude_sd.push(a.value_sd);
        self.frequency_sd.push(p.slope_sd / turn);
        self.damping_ratio_sd.push(a.slope_sd / omega);
    }

    /// Amplitude, frequency (Hz) and damping ratio at a time of the trusted window, by straight lines between entries;
    /// none outside.
    #[must_use]
    pub fn at(&self, t: f64) -> Option<(f64, f64, f64)> {
        let (first, last) = self.trusted;
        if !(first..=last).contains(&t) {
            return None;
        }
        let i = self.t.partition_point(|s| *s <= t).clamp(1, self.t.len() - 1);
        let s = (t - self.t[i - 1]) / (self.t[i] - self.t[i - 1]);
        let between = |v: &[f64]| v[i - 1] + s * (v[i] - v[i - 1]);
        Some((between(&self.amplitude), between(&self.frequency), between(&self.damping_ratio)))
    }
}
