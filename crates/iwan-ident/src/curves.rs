//! Frequency, damping, dissipation per cycle and force against amplitude.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use crate::error::{Error, check, check_length};
use crate::signal::Envelope;

/// The quantity that a record measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Quantity {
    /// Acceleration q''.
    #[default]
    Acceleration,
    /// Velocity q'.
    Velocity,
    /// Displacement q.
    Displacement,
}

impl Quantity {
    /// Number of time derivatives of the displacement that the quantity is: 2, 1 or 0.
    pub(crate) const fn power(self) -> i32 {
        match self {
            Self::Acceleration => 2,
            Self::Velocity => 1,
            Self::Displacement => 0,
        }
    }
}

/// Which force stands on the abscissa of dissipation against force.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum ForceAxis {
    /// Total modal force ω² q, equal to ω0² q at small amplitude; 1/s² times the displacement.
    #[default]
    Modal,
    /// Joint force |F_J| = (ω² - K_∞) q from Eq. 5, with K_∞ = ω0² - K_T: it needs ω0 (as a frequency in Hz) and K_T.
    Joint {
        /// Small-amplitude frequency, Hz.
        frequency: f64,
        /// Joint stiffness K_T, 1/s².
        k_t: f64,
    },
}

/// Curves against amplitude, one entry per cycle, in the order of time: amplitudes mostly fall.
#[derive(Debug, Clone, PartialEq)]
pub struct Curves {
    /// Time, s.
    pub t: Vec<f64>,
    /// Amplitude of the displacement q: A, A/ω or A/ω² for records of displacement, velocity or acceleration.
    pub displacement: Vec<f64>,
    /// Frequency, Hz.
    pub frequency: Vec<f64>,
    /// Damping ratio -v'/(ω v) of the velocity amplitude v = ω q.
    pub damping_ratio: Vec<f64>,
    /// Energy dissipated per cycle, D = (4π/ω) |P'| KE with P = ln v and KE = v²/2 (Eq. 7 and 8 with the sign mended);
    /// mass-normalised: force times length.
    pub dissipation: Vec<f64>,
    /// Force on the named axis.
    pub force: Vec<f64>,
    /// The force that stands in `force`.
    pub axis: ForceAxis,
    /// Standard deviation of ln D: that of the damping ratio and of the amplitude.
    pub log_dissipation_sd: Vec<f64>,
    /// Standard deviation of the frequency, Hz.
    pub frequency_sd: Vec<f64>,
    /// Number of independent values in the curves, for criteria and intervals: at most one per entry.
    pub independent: f64,
}

impl Curves {
    /// From the envelope of a mass-normalised modal record.
    ///
    /// For records that are not mass-normalised scale the envelope's amplitude first (by 1/φ of the channel, or by the
    /// root of the modal mass).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for the axis; [`Error::Length`] when vectors of the envelope disagree.
    ///
    /// ```
    /// use iwan_ident::curves::{Curves, ForceAxis, Quantity};
    /// use iwan_ident::signal::{Method, Options, envelope};
    /// let (omega, zeta) = (500.0, 0.002);
    /// let x: Vec<f64> = (0..8192).map(|n| n as f64 / 4096.0).map(|t| (-zeta * omega * t).exp() * (omega * t).cos()).collect();
    /// let envelope = envelope(&x, 1.0 / 4096.0, Method::Hilbert, &Options::default())?;
    /// let curves = Curves::new(&envelope, Quantity::Displacement, ForceAxis::Modal)?;
    /// // Linear: D = 2π ζ ω² q², and the modal force is ω² q.
    /// let (q, d) = (curves.displacement[30], curves.dissipation[30]);
    /// assert!((d / (std::f64::consts::TAU * zeta * (omega * q).powi(2)) - 1.0).abs() < 0.01);
    /// assert!((curves.force[30] / (omega * omega * q) - 1.0).abs() < 1e-4);
    /// # Ok::<(), iwan_ident::Error>(())
    /// ```
    pub fn new(envelope: &Envelope, quantity: Quantity, axis: ForceAxis) -> Result<Self, Error> {
        let n = envelope.t.len();
        check_length("envelope.amplitude", envelope.amplitude.len(), n)?;
        check_length("envelope.frequency", envelope.frequency.len(), n)?;
        check_length("envelope.damping_ratio", envelope.damping_ratio.len(), n)?;
        let k_inf = residual(axis)?;
        let power = quantity.power();
        let rates = slopes(&envelope.t, &envelope.frequency);
        let mut curves = Self::empty(envelope, axis);
        for (i, rate) in rates.into_iter().enumerate() {
            let (omega, ratio) = (TAU * envelope.frequency[i], envelope.damping_ratio[i]);
            let q = envelope.amplitude[i] / omega.powi(power);
            // The decay rate -A'/A follows from the damping ratio's definition, then that of the velocity amplitude v = A ω^(1-power).
            let decay = omega * ratio / (1.0 - ratio * ratio).sqrt();
            let decay = decay - (1.0 - f64::from(power)) * rate / envelope.frequency[i];
            let v = omega * q;
            curves.displacement.push(q);
            curves.damping_ratio.push(decay / decay.hypot(omega));
            curves.dissipation.push(TAU * decay / omega * v * v);
            curves.force.push((omega * omega - k_inf) * q);
            let relative = envelope.damping_ratio_sd[i] / ratio.abs().max(f64::MIN_POSITIVE);
            curves.log_dissipation_sd.push(relative.hypot(2.0 * envelope.log_amplitude_sd[i]));
        }
        Ok(curves)
    }

    fn empty(envelope: &Envelope, axis: ForceAxis) -> Self {
        Self {
            t: envelope.t.clone(),
            displacement: vec![],
            frequency: envelope.frequency.clone(),
            damping_ratio: vec![],
            dissipation: vec![],
            force: vec![],
            axis,
            log_dissipation_sd: vec![],
            frequency_sd: envelope.frequency_sd.clone(),
            independent: (envelope.order as f64 + 1.0).min(envelope.t.len() as f64),
        }
    }

    /// The same curves against another force.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when ω0 or K_T is out of range.
    pub fn on_axis(mut self, axis: ForceAxis) -> Result<Self, Error> {
        let k_inf = residual(axis)?;
        let force = |(q, f): (&f64, &f64)| ((TAU * f).powi(2) - k_inf) * q;
        self.force = self.displacement.iter().zip(&self.frequency).map(force).collect();
        self.axis = axis;
        Ok(self)
    }

    /// The same curves, linearly interpolated at those of the `times` (s) that they cover.
    #[must_use]
    pub(crate) fn at(&self, times: &[f64]) -> Self {
        let own = &self.t;
        let covered = |t: &f64| own.first().is_some_and(|a| a <= t) && own.last().is_some_and(|b| t <= b);
        let t: Vec<f64> = times.iter().copied().filter(covered).collect();
        let places: Vec<(usize, f64)> = t
            .iter()
            .map(|t| {
                let i = own.partition_point(|s| s <= t).clamp(1, own.len() - 1);
                (i, (t - own[i - 1]) / (own[i] - own[i - 1]))
            })
            .collect();
        let between = |v: &[f64]| places.iter().map(|&(i, s)| v[i - 1] + s * (v[i] - v[i - 1])).collect();
        Self {
            displacement: between(&self.displacement),
            frequency: between(&self.frequency),
            damping_ratio: between(&self.damping_ratio),
            dissipation: between(&self.dissipation),
            force: between(&self.force),
            axis: self.axis,
            log_dissipation_sd: between(&self.log_dissipation_sd),
            frequency_sd: between(&self.frequency_sd),
            independent: self.independent,
            t,
        }
    }

    /// The least-squares line of ln D over ln force, through the entries with D > 0 and a force between the two ends of
    /// `range`: its slope is χ + 3 in micro-slip. None with fewer than three such entries.
    #[must_use]
    pub fn slope(&self, range: (f64, f64)) -> Option<Line> {
        let inside = |i: &usize| (range.0..=range.1).contains(&self.force[*i]) && self.dissipation[*i] > 0.0;
        let points: Vec<(f64, f64)> = (0..self.t.len())
            .filter(inside)
            .map(|i| (self.force[i].ln(), self.dissipation[i].ln()))
            .collect();
        straight_line(&points)
    }
}

/// Stiffness K_∞ (1/s²) that is subtracted from ω² on an axis: 0 for the modal force.
fn residual(axis: ForceAxis) -> Result<f64, Error> {
    let ForceAxis::Joint { frequency, k_t } = axis else { return Ok(0.0) };
    let remedy = "give the small-amplitude frequency in Hz and the joint stiffness in 1/s^2";
    check("frequency", frequency, frequency > 0.0, "> 0 Hz", remedy)?;
    check("k_t", k_t, k_t > 0.0, "> 0", remedy)?;
    Ok((TAU * frequency).powi(2) - k_t)
}

/// A straight line y = slope · x + intercept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// dy/dx.
    pub slope: f64,
    /// y at x = 0.
    pub intercept: f64,
}

/// The least-squares line through points (x, y); none for fewer than three, or for equal x.
///
/// ```
/// let line = iwan_ident::curves::straight_line(&[(0.0, 1.0), (1.0, 3.0), (2.0, 5.0)]).unwrap();
/// assert!((line.slope - 2.0).abs() < 1e-15 && (line.intercept - 1.0).abs() < 1e-15);
/// ```
#[must_use]
pub fn straight_line(points: &[(f64, f64)]) -> Option<Line> {
    let n = points.len() as f64;
    let mean = points.iter().fold((0.0, 0.0), |s, p| (s.0 + p.0 / n, s.1 + p.1 / n));
    let (square, product) = points
        .iter()
        .fold((0.0, 0.0), |s, p| (s.0 + (p.0 - mean.0).powi(2), s.1 + (p.0 - mean.0) * (p.1 - mean.1)));
    (points.len() >= 3 && square > 0.0)
        .then(|| Line { slope: product / square, intercept: mean.1 - product / square * mean.0 })
}

/// Central differences, one-sided at the ends.
fn slopes(t: &[f64], y: &[f64]) -> Vec<f64> {
    let last = t.len().saturating_sub(1);
    let slope = |i: usize| {
        let (a, b) = (i.saturating_sub(1), (i + 1).min(last));
        if a == b { 0.0 } else { (y[b] - y[a]) / (t[b] - t[a]) }
    };
    (0..t.len()).map(slope).collect()
}

/// Part of the largest amplitude of displacement by which the curves go down from it, all together.
pub(crate) fn amplitude_drop<'a>(curves: impl IntoIterator<Item = &'a Curves>) -> f64 {
    let seen = curves.into_iter().flat_map(|c| &c.displacement);
    let (least, most) = seen.fold((f64::INFINITY, 0.0_f64), |(a, b), x| (a.min(*x), b.max(*x)));
    1.0 - least / most
}
