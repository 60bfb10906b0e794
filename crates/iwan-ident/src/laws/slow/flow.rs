//! The slow flow: amplitude and phase of a free decay, given decay rate and frequency against amplitude.
//!
//! Averaging ([`Averaging`](iwan_core::Averaging)) gives u' = -λ(u) for u = ln a, and θ' = ω(u); λ and ω are curves through values on a [`Grid`].
//! Neither needs to be positive: where noise hides the damping, its estimate may pass through zero.

use rustfft::num_complex::Complex64;

use super::grid::Grid;
use super::windowed::Windowed;

/// Decay rate and circular frequency at the amplitudes of a grid, 1/s.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Rates {
    pub(crate) decay: Vec<f64>,
    pub(crate) omega: Vec<f64>,
}

/// The beginning of a decay at the first sample: ln of the displacement amplitude, and phase against the reference in rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Beginning {
    pub(crate) log: f64,
    pub(crate) phase: f64,
}

/// The motion in the course of a decay.
#[derive(Debug, Clone)]
pub(crate) struct Decay {
    /// Half the complex amplitude of the measured quantity, less the reference phase, at each moment.
    pub(crate) slow: Vec<Complex64>,
    /// Logarithm of the displacement amplitude at the last moment.
    pub(crate) end: f64,
}

/// The decay at the moments of a record's windows, by the classical Runge-Kutta method, one step from moment to moment.
pub(crate) fn decay(grid: &Grid, rates: &Rates, from: Beginning, windowed: &Windowed) -> Decay {
    let at = |u: f64| grid.at(u, &rates.decay, &rates.omega);
    let h = windowed.step;
    let (mut u, mut theta) = (from.log, from.phase);
    let mut slow = Vec::with_capacity(windowed.phase.len());
    let mut end = u;
    for (j, reference) in windowed.phase.iter().enumerate() {
        let (a, p) = at(u);
        // The k-th derivative of a e^(iθ) brings the factor (-λ + iω)^k.
        let rate = Complex64::new(-a, p);
        slow.push(rate.powi(windowed.power) * Complex64::from_polar(0.5 * u.exp(), theta));
        end = u;
        let Some(next) = windowed.phase.get(j + 1) else { break };
        let (b, q) = at(u - 0.5 * h * a);
        let (c, r) = at(u - 0.5 * h * b);
        let (d, s) = at(u - h * c);
        u -= h / 6.0 * (a + 2.0 * (b + c) + d);
        theta += h / 6.0 * (p + 2.0 * (q + r) + s) - (next - reference);
    }
    Decay { slow, end }
}
