//! The linear structure at one harmonic: dynamic flexibility between slips, with one mode kept apart.
//!
//! The mode kept apart is the one nearest to resonance, whose flexibility would grow without bound. It is not part of the sum: its
//! amplitude stays an unknown with an equation of its own, so that nothing is divided by a small number.

use nalgebra::Complex;

use super::jointed::JointedModes;

pub(super) type C = Complex<f64>;

/// The flexibility of all modes except the one kept apart at a harmonic, with its derivatives with respect to frequency and negative
/// damping.
#[derive(Debug, Clone)]
pub(super) struct Receptance {
    /// Index of the mode kept apart.
    pub(super) apart: usize,
    /// Dynamic stiffness of that mode, and its two derivatives.
    pub(super) stiffness: [C; 3],
    /// Flexibility between slips at `i * joints + j`: value and two derivatives.
    pub(super) slips: [Vec<C>; 3],
    /// Flexibility from the excitation to each slip: value and two derivatives.
    pub(super) force: [Vec<C>; 3],
}

/// Dynamic stiffness D = ω_k² - (nω)² + i nω (c_k - ξ) of mode k, with its derivatives with respect to ω and ξ.
pub(super) fn dynamic_stiffness(system: &JointedModes, mode: usize, n: f64, omega: f64, xi: f64) -> [C; 3] {
    let own = &system.modes[mode];
    let viscous = 2.0 * own.damping_ratio * own.omega - xi;
    [
        // The product (ω_k - nω)(ω_k + nω) keeps its digits near resonance.
        C::new((own.omega - n * omega) * (own.omega + n * omega), n * omega * viscous),
        C::new(-2.0 * n * n * omega, n * viscous),
        C::new(0.0, -n * omega),
    ]
}

/// The elastic mode nearest in frequency to the harmonic, among the modes in which joints slip; among all elastic modes if joints slip in
/// none.
pub(super) fn nearest(system: &JointedModes, n: f64, omega: f64) -> usize {
    let gap = |mode: usize| {
        let idle = if system.slips_in(mode) { 0.0 } else { f64::MAX.sqrt() };
        idle + (system.modes[mode].omega - n * omega).abs()
    };
    let elastic = (0..system.modes.len()).filter(|&mode| system.modes[mode].omega > 0.0);
    elastic.min_by(|&a, &b| gap(a).total_cmp(&gap(b))).unwrap_or(0)
}

impl Receptance {
    /// The flexibility at the harmonic `n` of the circular frequency `omega` (rad/s), with the damping of all modes lowered by `xi` (1/s).
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
