//! From an isolated mode to its envelope, by any method.

use super::super::in_band::Options;
use super::super::isolate::isolate;
use super::super::isolated::{Isolated, MAX_ORDER};
use super::demodulation::demodulated;
use super::instantaneous::{Envelope, Method};
use super::peak_fitting::{fitted_peaks, half_cycle_phases};
use super::peaks::{crossing_phases, peak_amplitudes};
use super::residuals::Residuals;
use super::traces::{Trace, Traces};
use crate::error::Error;
use crate::smooth::{LocalFit, Polynomial, Smooth, Spline};

/// Half length, in independent values, of the stretch whose scatter is compared with that of the whole window: some four memories of the automatic filter, the length of a
/// transient. Not varied.
const EIGHT: f64 = 8.0;

/// Envelope and frequency of one mode of a record `x`, sampled every `dt` seconds.
///
/// # Errors
/// As [`isolate`]; [`Error::OutOfRange`] when the sampling rate is too low for a method.
///
/// ```
/// use iwan_ident::signal::{Method, Options, envelope};
/// // A linear mode: 80 Hz, 0.2 % damping.
/// let (omega, zeta) = (std::f64::consts::TAU * 80.0, 0.002_f64);
/// let t = |n: usize| n as f64 / 4096.0;
/// let x: Vec<f64> = (0..8192).map(|n| (-zeta * omega * t(n)).exp() * (omega * (1.0 - zeta * zeta).sqrt() * t(n)).cos()).collect();
/// let envelope = envelope(&x, 1.0 / 4096.0, Method::Hilbert, &Options::default())?;
/// let at = envelope.at(1.0).unwrap();
/// assert!((at.frequency - 80.0).abs() < 0.001 && (at.damping_ratio / zeta - 1.0).abs() < 0.002);
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
            Method::Hilbert | Method::FreeVibration => Traces {
                amplitude: Trace { t: self.raw.t.clone(), y: self.raw.log_amplitude.clone() },
                phase: Trace { t: self.raw.t.clone(), y: self.raw.phase.clone() },
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
        let (start, end) = common(&traces.amplitude.t, &traces.phase.t)?;
        let (start, end) = (start.max(self.trusted().0), end.min(self.trusted().1));
        let even = vec![1.0; traces.amplitude.t.len()];
        let guide = self.curve(&traces.amplitude, &even, Method::Hilbert, None)?.curve;
        let weights =
            |t: &[f64]| -> Vec<f64> { t.iter().map(|&t| self.weight(guide.at(t).value.exp())).collect() };
        let Fitted { curve: amplitude, order } =
            self.curve(&traces.amplitude, &weights(&traces.amplitude.t), method, order)?;
        // The phase bends with the amplitude, so its curve gets at least the order of the amplitude's.
        let least = (method == Method::Hilbert || method == Method::Peaks).then_some(order);
        let mut phase = self.curve(&traces.phase, &weights(&traces.phase.t), method, None)?;
        if let Some(least) = least.filter(|least| phase.order < *least) {
            phase = self.curve(&traces.phase, &weights(&traces.phase.t), method, Some(least))?;
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
        let residuals =
            [(&traces.amplitude, &*amplitude), (&traces.phase, &*phase.curve)].map(|(trace, curve)| {
                Residuals::new(trace, &weights(&trace.t), curve, self.effective(trace.t.len()))
            });
        let reach = EIGHT / self.bandwidth;
        for i in 0..=count {
            let t = envelope.t[i];
            let by = residuals.each_ref().map(|r| r.inflation(t, reach));
            envelope.push(&*amplitude, &*phase.curve, t, self.band.peak, by);
        }
        if method == Method::FreeVibration {
            envelope.by_feldman(&*amplitude, &*phase.curve, self.band.peak);
        }
        Ok(envelope)
    }

    /// The smooth curve of a method through a trace.
    fn curve(
        &self,
        Trace { t, y }: &Trace,
        weight: &[f64],
        method: Method,
        order: Option<usize>,
    ) -> Result<Fitted, Error> {
        let points = self.points(t, y, weight);
        Ok(match method {
            Method::Hilbert => {
                let fit = Polynomial::fit(&points, order, MAX_ORDER);
                let order = fit.order();
                Fitted { curve: Box::new(fit), order }
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
                Fitted { curve: Box::new(spline), order: intervals }
            }
            Method::PeakFitting | Method::Demodulation | Method::FreeVibration => {
                let half = self.neighbourhood();
                let cycles = (2.0 * half * self.band.peak).round() as usize;
                Fitted { curve: Box::new(LocalFit::new(&points, half)), order: cycles }
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

/// A smooth curve through a trace.
struct Fitted {
    curve: Box<dyn Smooth>,
    /// As [`Envelope::order`].
    order: usize,
}

/// Range of times (s) that both traces cover.
fn common(a: &[f64], b: &[f64]) -> Result<(f64, f64), Error> {
    /// Least number of peaks or crossings: what a spline of one interval and its criterion need, with some to spare. Fewer are refused.
    const NEEDED: usize = 8;
    let found = a.len().min(b.len());
    if found < NEEDED {
        let remedy = "record longer, or choose another method";
        return Err(Error::TooShort { what: "peaks in the trusted window", found, needed: NEEDED, remedy });
    }
    Ok((a[0].max(b[0]), a[a.len() - 1].min(b[b.len() - 1])))
}

impl Envelope {
    /// Frequency and damping of an oscillator whose stiffness and damping move with the amplitude (Feldman 1994): with L = ln A
    /// and ω = θ' the natural frequency ω0² = ω² - L'' + L'² + L' ω'/ω and the damping coefficient h = -L' - ω'/(2ω). Frequency is
    /// √(ω0² - h²), as the other methods give it for a linear mode. Second derivatives are differences over a cycle.
    fn by_feldman(&mut self, amplitude: &dyn Smooth, phase: &dyn Smooth, centre: f64) {
        let turn = std::f64::consts::TAU;
        let step = 0.5 / centre;
        let (first, last) = self.trusted;
        for i in 0..self.t.len() {
            let (from, to) = ((self.t[i] - step).max(first), (self.t[i] + step).min(last));
            let rate = |curve: &dyn Smooth| (curve.at(to).slope - curve.at(from).slope) / (to - from);
            let (slope, omega) = (amplitude.at(self.t[i]).slope, turn * centre + phase.at(self.t[i]).slope);
            let (bend, drift) = (rate(amplitude), rate(phase));
            let natural = omega * omega - bend + slope * slope + slope * drift / omega;
            let damping = -slope - 0.5 * drift / omega;
            self.frequency[i] = (natural - damping * damping).max(0.0).sqrt() / turn;
            self.damping_ratio[i] = damping / natural.max(f64::MIN_POSITIVE).sqrt();
        }
    }

    fn push(&mut self, amplitude: &dyn Smooth, phase: &dyn Smooth, t: f64, centre: f64, by: [f64; 2]) {
        let (a, p) = (amplitude.at(t), phase.at(t));
        let turn = std::f64::consts::TAU;
        let omega = turn * centre + p.slope;
        self.amplitude.push(a.value.exp());
        self.frequency.push(omega / turn);
        self.damping_ratio.push(-a.slope / a.slope.hypot(omega));
        self.log_amplitude_sd.push(by[0] * a.value_sd);
        self.frequency_sd.push(by[1] * p.slope_sd / turn);
        self.damping_ratio_sd.push(by[0] * a.slope_sd / omega);
    }
}
