//! The curves of one record, with all that is known about their errors.
//!
//! The unknowns are decay rate and frequency at the amplitudes of a grid, and the beginning of the decay; given are complex amplitudes in windows.
//! The curves are found by Gauss-Newton steps, with smooth curves as the prior, whose roughness the record itself decides (empirical Bayes). What is
//! handed on is the record's own information, without that prior.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::flow::{Beginning, Rates, decay};
use super::grid::Grid;
use super::linear::{Information, without_last};
use super::process::{Covariances, Likeliest};
use super::windowed::{Source, Windowed};
use crate::curves::Curves;
use crate::error::Error;

/// Most Gauss-Newton steps; six to ten are usual. Where they are spent the last curves count.
const ROUNDS: usize = 20;
/// Change of the curves, in their standard deviations, below which they count as found.
const SETTLED: f64 = 0.02;
/// Standard deviation of the prior of ln amplitude and phase (rad) at the beginning: wide enough to say nothing.
const BEGINNING_WIDTH: f64 = 10.0;
/// Noise that is put down to the windows and to averaging itself, relative to the amplitudes: as in `refine`.
const NOISE_FLOOR: f64 = 1e-6;
/// Least decay rate of a first guess, over the mean: the logarithm of a smaller rate has no meaning.
const LEAST_RATE: f64 = 0.05;
/// Standard deviation of ln D from which on an envelope's damping is no guess. Envelopes bend where they end in noise; priors are relative to the guess, and one of a twentieth made the
/// lowest point of smooth curves certain to 1 % and wrong by half.
const TOLD: f64 = 0.3;
/// Times that windows are left out where the mode sinks into noise; each time the noise is estimated anew.
const CUTS: usize = 3;
/// Step of the differences, in units of the unknowns: a tenth of a per cent of the mean decay rate for the curves.
const STEP: f64 = 1e-3;

/// The curves of one record.
#[derive(Debug, Clone)]
pub(crate) struct Measured {
    pub(crate) information: Information,
    /// Standard deviation of a whitened value.
    pub(crate) noise: f64,
    /// The same by the later half of the windows alone. Where smooth curves do not follow the loud cycles, what they miss there is no noise: a clean record was cut after a sixteenth
    /// of its length.
    at_end: f64,
    /// Root mean square of the whitened values.
    pub(crate) level: f64,
    /// ln of the smallest and of the largest displacement amplitude seen.
    pub(crate) span: (f64, f64),
    /// Displacement amplitude at the first sample.
    pub(crate) released: f64,
}

/// The record, and units and prior of the unknowns.
struct Frame<'a> {
    grid: &'a Grid,
    windowed: &'a Windowed,
    /// First guess of decay rates and frequencies, to which the prior's covariances are relative.
    guess: Rates,
    mean: DVector<f64>,
    /// Range of the circular frequency, 1/s.
    shift: f64,
    rate: f64,
}

/// The linearised equations at a point: rows and target in eigen-directions, in units of the unknowns; matrix and gradient of the normal equations.
struct Linearised {
    rows: DMatrix<f64>,
    target: DVector<f64>,
    matrix: DMatrix<f64>,
    gradient: DVector<f64>,
}

/// A Gauss-Newton step with the prior.
struct Step {
    to: DVector<f64>,
    /// Number of degrees of freedom that the unknowns take from the record.
    effective: f64,
}

/// First guesses of decay rate and frequency on the grid, from the envelopes' curves where these tell the damping; beyond, the nearest that they tell is held.
pub(crate) fn guess(grid: &Grid, curves: &[&Curves]) -> Rates {
    let told = curves.iter().flat_map(|c| &c.log_dissipation_sd).any(|sd| *sd < TOLD);
    let mut points: Vec<(f64, f64, f64)> = curves
        .iter()
        .flat_map(|c| {
            let counts = |i: &usize| !told || c.log_dissipation_sd[*i] < TOLD;
            (0..c.t.len()).filter(counts).map(|i| {
                let omega = std::f64::consts::TAU * c.frequency[i];
                (c.displacement[i].ln(), c.damping_ratio[i] * omega, omega)
            })
        })
        .filter(|(u, rate, omega)| u.is_finite() && rate.is_finite() && omega.is_finite())
        .collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mean = points.iter().map(|p| p.1).sum::<f64>() / points.len().max(1) as f64;
    let at = |u: f64| {
        // The mean of the points next to the amplitude: one envelope is smooth already, several hits together are not.
        let near = |p: &&(f64, f64, f64)| (p.0 - u).abs() < 0.1;
        let (n, sum) =
            points.iter().filter(near).fold((0.0, (0.0, 0.0)), |(n, s), p| (n + 1.0, (s.0 + p.1, s.1 + p.2)));
        if n > 0.0 {
            return (sum.0 / n, sum.1 / n);
        }
        let next = points.partition_point(|p| p.0 < u).min(points.len() - 1);
        (points[next].1, points[next].2)
    };
    let (decay, omega) = (0..grid.count()).map(|i| at(grid.log(i))).unzip();
    let mut rates = Rates { decay, omega };
    rates.decay.iter_mut().for_each(|rate| *rate = rate.max(LEAST_RATE * mean.abs()));
    rates
}

impl Frame<'_> {
    fn count(&self) -> usize {
        self.grid.count()
    }

    fn rates(&self, x: &DVector<f64>) -> (Rates, Beginning) {
        let n = self.count();
        let rates =
            Rates { decay: x.rows(0, n).as_slice().to_vec(), omega: x.rows(n, n).as_slice().to_vec() };
        (rates, Beginning { log: x[2 * n], phase: x[2 * n + 1] })
    }

    fn residuals(&self, x: &DVector<f64>) -> DVector<f64> {
        let (rates, beginning) = self.rates(x);
        let model = self.windowed.of_motion(&decay(self.grid, &rates, beginning, self.windowed).slow);
        DVector::from_iterator(model.len(), self.windowed.values.iter().zip(&model).map(|(a, b)| a - b))
    }

    fn linearised(&self, x: &DVector<f64>, residuals: &DVector<f64>) -> Linearised {
        let n = self.count();
        let mut jacobian = DMatrix::zeros(residuals.len(), x.len());
        for j in 0..x.len() {
            let step = if j < 2 * n { STEP * self.rate } else { STEP };
            let mut moved = x.clone();
            moved[j] += step;
            let above = self.residuals(&moved);
            moved[j] = x[j] - step;
            jacobian.set_column(j, &((self.residuals(&moved) - above) / (2.0 * step)));
        }
        let matrix = jacobian.transpose() * &jacobian;
        let gradient = jacobian.transpose() * residuals;
        let eigen = SymmetricEigen::new(self.in_units(&matrix));
        let scaled = self.units().component_mul(&gradient);
        let most = eigen.eigenvalues.max();
        let known: Vec<usize> = (0..x.len()).filter(|&i| eigen.eigenvalues[i] > 1e-13 * most).collect();
        let mut rows = DMatrix::zeros(known.len(), x.len());
        let mut target = DVector::zeros(known.len());
        for (row, &i) in known.iter().enumerate() {
            let (root, vector) = (eigen.eigenvalues[i].sqrt(), eigen.eigenvectors.column(i));
            rows.row_mut(row).copy_from(&(vector.transpose() * root));
            target[row] = vector.dot(&scaled) / root;
        }
        Linearised { rows, target, matrix, gradient }
    }

    /// Units in which all unknowns are of order one.
    fn units(&self) -> DVector<f64> {
        let n = self.count();
        DVector::from_fn(2 * n + 2, |i, _| if i < 2 * n { self.rate } else { 1.0 })
    }

    fn in_units(&self, matrix: &DMatrix<f64>) -> DMatrix<f64> {
        let units = self.units();
        DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |i, j| matrix[(i, j)] * units[i] * units[j])
    }

    /// Prior covariances of the unknowns, in their units.
    fn prior(&self) -> Covariances {
        let n = self.count();
        let curves = Covariances::new(self.grid, &self.guess, self.shift);
        let mut prior = curves.each(|m| (m / self.rate.powi(2)).resize(2 * n + 2, 2 * n + 2, 0.0));
        (2 * n..2 * n + 2).for_each(|i| prior.line[(i, i)] = BEGINNING_WIDTH.powi(2));
        prior
    }

    /// The step from `x` with noise of variance `noise` and the likeliest roughness of the curves.
    fn step(&self, x: &DVector<f64>, at: &Linearised, prior: &Covariances, noise: f64) -> Option<Step> {
        let units = self.units();
        let away = (&self.mean - x).component_div(&units);
        let surprise = &at.target - &at.rows * &away;
        let seen = prior.each(|m| &at.rows * m * at.rows.transpose());
        let Likeliest { decay, omega, factor, .. } = seen.likeliest(&surprise, noise)?;
        let change = prior.whole(decay, omega) * (at.rows.transpose() * factor.solve(&surprise));
        let effective = at.target.len() as f64 - noise * factor.inverse().trace();
        Some(Step { to: x + units.component_mul(&(away + change)), effective })
    }
}

/// The curves of a record on a grid, from the windows in which the mode is louder than the noise.
pub(crate) fn measure(grid: &Grid, source: &Source<'_>) -> Result<Measured, Error> {
    let mut windowed = Windowed::new(source)?;
    for _ in 0..CUTS {
        let found = in_windows(grid, source, &windowed)?;
        if !windowed.cut_at_noise(found.at_end) {
            return Ok(found);
        }
    }
    in_windows(grid, source, &windowed)
}

fn in_windows(grid: &Grid, source: &Source<'_>, windowed: &Windowed) -> Result<Measured, Error> {
    let guess = guess(grid, &[source.curves]);
    let n = grid.count();
    let range =
        |y: &[f64]| y.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |r, y| (r.0.min(*y), r.1.max(*y)));
    let (low, high) = range(&guess.omega);
    let rate = guess.decay.iter().sum::<f64>() / n as f64;
    let beginning = beginning(source, windowed, grid, &guess);
    let mean = DVector::from_iterator(
        2 * n + 2,
        guess.decay.iter().chain(&guess.omega).copied().chain([beginning.log, beginning.phase]),
    );
    let frame =
        Frame { grid, windowed, shift: (high - low).max(0.1 * rate), mean: mean.clone(), guess, rate };
    settle(&frame, mean)
}

fn settle(frame: &Frame<'_>, start: DVector<f64>) -> Result<Measured, Error> {
    let lost = || Error::Refused {
        finding: "no smooth curves of frequency and damping follow this record".into(),
        remedy: "check the band and the window",
    };
    let values = frame.windowed.values.len() as f64;
    let level = (frame.windowed.values.iter().map(|v| v * v).sum::<f64>() / values).sqrt();
    let floor = (NOISE_FLOOR * level).powi(2);
    let prior = frame.prior();
    let mut x = start;
    let mut residuals = frame.residuals(&x);
    let mut noise = (residuals.norm_squared() / values).max(floor);
    for _ in 0..ROUNDS {
        let at = frame.linearised(&x, &residuals);
        let step = frame.step(&x, &at, &prior, noise).ok_or_else(lost)?;
        let (mut part, mut next) = (1.0, step.to.clone());
        let mut after = frame.residuals(&next);
        let most = residuals.norm_squared() * (1.0 + 1e-3) + values * noise;
        let fits = |r: f64| r.is_finite() && r <= most;
        while part > 0.05 && !fits(after.norm_squared()) {
            part *= 0.5;
            next = &x + (&step.to - &x) * part;
            after = frame.residuals(&next);
        }
        let moved = (&at.rows * (&next - &x).component_div(&frame.units())).norm() / noise.sqrt();
        let fewer = (after.norm_squared() / (values - step.effective).max(1.0)).max(floor);
        let quiet = (fewer / noise).ln().abs() < SETTLED;
        (x, residuals, noise) = (next, after, fewer);
        if quiet && part == 1.0 && moved < SETTLED * values.sqrt() {
            break;
        }
    }
    if !residuals.norm_squared().is_finite() {
        return Err(lost());
    }
    let at = frame.linearised(&x, &residuals);
    let (later, inflation) = (residuals.len() / 2, inflation(&residuals));
    let at_end = residuals.rows_range(later..).norm_squared() / (residuals.len() - later) as f64;
    let noise = noise * inflation;
    let n = frame.count();
    let (matrix, gradient) =
        without_last(&(at.matrix / noise), &(at.gradient / noise), 2).ok_or_else(lost)?;
    let (rates, beginning) = frame.rates(&x);
    let end = decay(frame.grid, &rates, beginning, frame.windowed).end;
    let span = (end.min(beginning.log), end.max(beginning.log));
    // Curves that ran away from all amplitudes of the envelope are refused.
    if !(span.0 <= frame.grid.log(n - 1) && span.1 >= frame.grid.log(0)) {
        return Err(lost());
    }
    Ok(Measured {
        information: Information::new(matrix, &gradient, &x.rows(0, 2 * n).into_owned()),
        noise: noise.sqrt(),
        at_end: noise.min(at_end.max(floor) * inflation).sqrt(),
        level,
        span,
        released: beginning.log.exp(),
    })
}

/// Factor by which the variance of a mean of neighbouring values exceeds that of independent ones: (1+ρ)/(1-ρ) for a correlation ρ from one value to
/// the next (G. E. P. Box and G. M. Jenkins), at most 10; 1 where noise explains ρ.
fn inflation(residuals: &DVector<f64>) -> f64 {
    let r = residuals.as_slice();
    let product: f64 = r.iter().zip(r.iter().skip(2)).map(|(a, b)| a * b).sum();
    let rho = (product / r.iter().map(|r| r * r).sum::<f64>()).abs();
    let noise = 2.0 / (r.len() as f64).sqrt();
    if rho > noise { ((1.0 + rho) / (1.0 - rho)).min(10.0) } else { 1.0 }
}

/// ln amplitude and phase at the first sample, from the first window.
fn beginning(source: &Source<'_>, windowed: &Windowed, grid: &Grid, guess: &Rates) -> Beginning {
    let curves = source.curves;
    let next = curves.t.partition_point(|t| *t < source.first).min(curves.t.len() - 1);
    // From the envelope's first value back to the first sample, by the decay rate at the largest amplitude.
    let back = (curves.t[next] - source.first).max(0.0) * guess.decay[grid.count() - 1];
    let log = curves.displacement[next].ln() + back.min(1.0);
    let model = windowed.of_motion(&decay(grid, guess, Beginning { log, phase: 0.0 }, windowed).slow);
    // Complex ratio of record to model in the first window.
    let pair = |y: &[f64]| rustfft::num_complex::Complex64::new(y[0], y[1]);
    let ratio = pair(&windowed.values) / pair(&model);
    Beginning { log: log + ratio.norm().ln().clamp(-2.0, 2.0), phase: ratio.arg() }
}
