//! The linear structure at one harmonic: dynamic flexibility between slips, one mode kept apart.
//!
//! Near a resonance the flexibility of that mode grows without bound, so it is not summed: its amplitude stays an unknown with an
//! equation of its own, and nothing is ever divided by a small number.

use nalgebra::Complex;

use super::jointed::JointedModes;

pub(super) type C = Complex<f64>;

/// The flexibility of all modes but one at a harmonic, with its derivatives by frequency and by negative damping.
#[derive(Debug, Clone)]
pub(super) struct Receptance {
    /// The mode kept apart.
    pub(super) apart: usize,
    /// Dynamic stiffness of that mode, and its derivatives.
    pub(super) stiffness: [C; 3],
    /// Between slips: value and derivatives at `i * joints + j`.
    pub(super) slips: [Vec<C>; 3],
    /// From the excitation to slips.
    pub(super) force: [Vec<C>; 3],
}

/// D = ω_k² - (nω)² + i nω (c_k - ξ) with its derivatives by ω and by ξ.
pub(super) fn dynamic_stiffness(system: &JointedModes, mode: usize, n: f64, omega: f64, xi: f64) -> [C; 3] {
    let own = &system.modes[mode];
    let viscous = 2.0 * own.damping_ratio * own.omega - xi;
    [
        // (ω_k - nω)(ω_k + nω) keeps its digits near resonance.
        C::new((own.omega - n * omega) * (own.omega + n * omega), n * omega * viscous),
        C::new(-2.0 * n * n * omega, n * viscous),
        C::new(0.0, -n * omega),
    ]
}

/// The elastic mode in which joints slip whose frequency is nearest to the harmonic; where joints slip in none, any.
pub(super) fn nearest(system: &JointedModes, n: f64, omega: f64) -> usize {
    let gap = |mode: usize| {
        let idle = if system.slips_in(mode) { 0.0 } else { f64::MAX.sqrt() };
        idle + (system.modes[mode].omega - n * omega).abs()
    };
    let elastic = (0..system.modes.len()).filter(|&mode| system.modes[mode].omega > 0.0);
    elastic.min_by(|&a, &b| gap(a).total_cmp(&gap(b))).unwrap_or(0)
}

impl Receptance {
    /// At the harmonic `n` of the frequency `omega`, with the damping of all modes lowered by `xi` (1/s).
    pub(super) fn at(system: &JointedModes, apart: usize, n: f64, omega: f64, xi: f64) -> Self {
        let count = system.joints.len();
        let zero = C::new(0.0, 0.0);
        let mut slips = [vec![zero; count * count], vec![zero; count * count], vec![zero; count * count]];
        let mut force = [vec![zero; count], vec![zero; count], vec![zero; count]];
        for (entry, residual) in slips[0].iter_mut().zip(&system.residual.slips) {
            *entry = C::new(*residual, 0.0);
        }
        for (entry, residual) in force[0].iter_mut().zip(&system.residual.force) {
            *entry = C::new(*residual, 0.0);
        }
        for (mode, own) in system.modes.iter().enumerate().filter(|(mode, _)| *mode != apart) {
            let [d, by_omega, by_xi] = dynamic_stiffness(system, mode, n, omega, xi);
            let inverse = d.inv();
            let parts = [inverse, -by_omega * inverse * inverse, -by_xi * inverse * inverse];
            for (i, row) in system.joints.iter().enumerate() {
                let b = row.participation[mode];
                if b == 0.0 {
                    continue;
                }
                for (which, part) in parts.iter().enumerate() {
                    let part = part * b;
                    force[which][i] += part * own.at_force;
                    for (j, column) in system.joints.iter().enumerate() {
                        slips[which][i * count + j] += part * column.participation[mode];
                    }
                }
            }
        }
        Self { apart, stiffness: dynamic_stiffness(system, apart, n, omega, xi), slips, force }
    }
}
