//! Modal joint curves without a transient, from static loads that bend the structure into the shape of a mode.
//!
//! K_∞ x + E F(s) = α M φ on the virgin curves (H. Festjens et al., Int. J. Mech. Sci. 75:170, 2013, doi:10.1016/j.ijmecsci.2013.06.010; M.
//! S. Allen et al., IMAC 2016). With z = K_0⁺ e the displacement of the stuck structure under a unit force on each slip, s = φ_s α/ω0² - G
//! N(s) with N = F - K_T s and G = Eᵀ K_0⁺ E: a system for the slips alone. The modal displacement q = α/ω0² - φ_sᵀ N/ω0² gives the secant
//! frequency ω² = α/q. By Masing's rule each joint closes a loop of amplitude |s|, so the dissipation per cycle is the sum over the joints.

use std::f64::consts::PI;

use crate::algebra::{Cholesky, add_scaled, dot, scale, search_line};
use crate::error::{Error, check};
use crate::matrices::{Assembled, inverse_of};
use crate::modes::{Limit, Modes};

/// Curves of one mode over amplitude; all vectors have one entry per modal displacement.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ModalCurves {
    /// Modal displacement q, mass^½·length.
    pub displacement: Vec<f64>,
    /// Modal load α = ω² q, mass^½·length/s².
    pub force: Vec<f64>,
    /// Secant frequency, Hz.
    pub frequency: Vec<f64>,
    /// Dissipation per cycle of amplitude q.
    pub dissipation: Vec<f64>,
    /// Modal joint force: the contribution of the joints to α beyond the slipping structure, α - ω∞² q.
    pub joint_force: Vec<f64>,
    /// Slip of each joint at each amplitude: `slips[slip][amplitude]`.
    pub slips: Vec<Vec<f64>>,
}

/// The quasi-static analysis of one stuck mode.
#[derive(Debug, Clone)]
pub struct QuasiStatic<'a> {
    assembled: &'a Assembled,
    eigenvalue: f64,
    /// Squared frequency of the slipping mode, 1/s².
    slipping: f64,
    /// φ_s: the mode shape at the slips.
    shape: Vec<f64>,
    /// G⁻¹, row by row.
    stiffness: Vec<f64>,
}

/// Largest number of rounds, both in the search for the load that reaches an amplitude and in the search for the equilibrium of the slips
/// under a load. Where there is a solution, up to 8 rounds find it. The rounds do not suffice where the joints slide freely and no static
/// load holds them, which is an error.
const MOST_ROUNDS: usize = 200;
/// Tolerance of the equilibrium of the slips, relative to the forces, and of the amplitude, relative to itself. 1e-15 is beyond rounding:
/// the curves of the paper's beam then end early. With 1e-8 its curve of torsion goes on for two decades in which parts slide.
const SETTLED: f64 = 1e-12;
/// Part of the diagonal that is added to the diagonal of Newton's matrix. With all joints in macro-slip parts may slide freely, which makes
/// the matrix singular. The addition does not change the equilibrium. Without it the curves of the paper's beam end at about the onset of
/// macro-slip; 1e-4 gives the same curves to 12 digits.
const SLIDING: f64 = 1e-8;
/// Iterations that turn (K_0 + σM)⁻¹ into K_0⁺; each reduces the error along a mode by the factor σ/(ω² + σ). The first elastic mode of the
/// paper's beam has ω² = 0.76 σ: after 60 iterations its error is rounding, after 20 the curves are good to seven digits. A limitation
/// without a message: in a free bar more than about 100 times as long as thick, or a clamped one more than about 20 times, the first mode
/// lies so far below σ that its part of the flexibility is not complete after 60 iterations (by these formulas 1e-3 of it is missing at 190
/// and at 30 times).
const REFINEMENTS: usize = 60;

impl Assembled {
    /// Prepares quasi-static curves of stuck mode `index`. `slipping_eigenvalue` is ω∞² of its slipping counterpart
    /// ([`joint_modes`](Self::joint_modes)), from which the joint force is measured.
    ///
    /// # Errors
    /// [`Error::Analysis`] for modes that are not stuck or for a zero mode; otherwise the errors of [`modes`](Self::modes).
    ///
    /// ```
    /// use iwan_fem::{Limit, mesh::beam::Configuration, paper};
    /// let assembled = paper::structure(Configuration::A, 1)?.assemble()?;
    /// let stuck = assembled.modes(Limit::Stuck, 8)?;
    /// let curves = assembled.quasi_static(&stuck, 6, 6.4445e5)?.curves(&[1.989e-4])?;
    /// assert!((curves.frequency[0] - 132.2419).abs() < 0.01);
    /// assert!((curves.dissipation[0] / 4.726e-5 - 1.0).abs() < 0.01);
    /// # Ok::<(), iwan_fem::Error>(())
    /// ```
    pub fn quasi_static(
        &self,
        stuck: &Modes,
        index: usize,
        slipping_eigenvalue: f64,
    ) -> Result<QuasiStatic<'_>, Error> {
        let elastic = (stuck.zero_modes()..stuck.len()).contains(&index);
        if stuck.limit() != Limit::Stuck || !elastic {
            let finding = format!("mode {index} is not an elastic mode with all joints stuck");
            let remedy = "compute modes with Limit::Stuck and choose one behind the zero modes";
            return Err(Error::Analysis { analysis: "quasi-static analysis", finding, remedy });
        }
        let slipping = check("slipping_eigenvalue", slipping_eigenvalue, true, "must be finite")?;
        let factor = self.shifted_factor(Limit::Stuck)?;
        let columns = static_flexibility(self, stuck, &factor, self.shift()?);
        let unknowns: Vec<usize> = self.slips().iter().map(|slip| slip.unknown).collect();
        let stiffness = inverse_of(unknowns.len(), |i, j| columns[j][unknowns[i]])?;
        let shape = unknowns.iter().map(|&j| stuck.shape(index)[j]).collect();
        Ok(QuasiStatic { assembled: self, eigenvalue: stuck.eigenvalue(index), slipping, shape, stiffness })
    }
}

/// K_0⁺ e of each slip: displacements under a unit force on the slip, without the motion of the structure as a whole.
pub(super) fn static_flexibility(
    assembled: &Assembled,
    stuck: &Modes,
    factor: &Cholesky,
    shift: f64,
) -> Vec<Vec<f64>> {
    let free: Vec<Vec<f64>> = (0..stuck.zero_modes()).map(|i| stuck.shape(i).to_vec()).collect();
    let column = |unknown: usize| {
        let mut z = vec![0.0; assembled.unknowns()];
        for _ in 0..REFINEMENTS {
            let mut right = assembled.mass().times(&z);
            scale(&mut right, shift);
            right[unknown] += 1.0;
            factor.solve(&mut right);
            assembled.remove(&mut right, &free);
            let mut change = right.clone();
            add_scaled(&mut change, -1.0, &z);
            z = right;
            if dot(&change, &change) <= (f64::EPSILON * f64::EPSILON) * dot(&z, &z) {
                break;
            }
        }
        z
    };
    assembled.slips().iter().map(|slip| column(slip.unknown)).collect()
}

impl QuasiStatic<'_> {
    /// The curves at the given modal displacements, > 0.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a displacement that is not a finite number > 0; [`Error::Analysis`] when no static load
    /// reaches it.
    pub fn curves(&self, displacements: &[f64]) -> Result<ModalCurves, Error> {
        let mut curves = ModalCurves { slips: vec![Vec::new(); self.shape.len()], ..ModalCurves::default() };
        for &q in displacements {
            check("modal displacement", q, q > 0.0, "must be a finite number > 0")?;
            let (alpha, slips) = self.load_for(q)?;
            curves.displacement.push(q);
            curves.force.push(alpha);
            curves.frequency.push((alpha / q).sqrt() / (2.0 * PI));
            curves.joint_force.push(alpha - self.slipping * q);
            let laws = self.assembled.slips().iter().map(|slip| slip.law.as_ref());
            let loss = laws.zip(&slips).map(|(law, s)| law.map_or(0.0, |law| law.dissipation(*s)));
            curves.dissipation.push(loss.sum());
            curves.slips.iter_mut().zip(&slips).for_each(|(history, s)| history.push(*s));
        }
        Ok(curves)
    }

    /// The load that bends the structure to the modal displacement `q`, and the slips under it.
    ///
    /// q grows with the load, and the secant frequency lies between those of the stuck and the slipping structure. The search for α is a
    /// bisection, accelerated by secants.
    fn load_for(&self, q: f64) -> Result<(f64, Vec<f64>), Error> {
        let (mut slips, mut low, mut high) = (vec![0.0; self.shape.len()], 0.0, self.eigenvalue * q);
        let mut excess = |alpha: f64| -> Result<(f64, Vec<f64>), Error> {
            self.equilibrium(alpha, &mut slips)?;
            Ok((self.displacement(alpha, &slips) - q, slips.clone()))
        };
        let (mut at_low, mut top) = (-q, excess(high)?);
        // A mode whose joints add inertia rather than stiffness may need a load above that of the stuck structure.
        while top.0 < 0.0 {
            (low, at_low) = (high, top.0);
            // The factor only affects how soon the load is bracketed.
            high *= 1.5;
            top = excess(high)?;
            // No structure is a million times as stiff as with all joints stuck; the search below then reports that no load was found.
            if high > 1e6 * self.eigenvalue * q {
                break;
            }
        }
        let mut at_high = top.0;
        for round in 0..MOST_ROUNDS {
            let secant = low - at_low * (high - low) / (at_high - at_low);
            let middle = 0.5 * (low + high);
            let alpha = if round % 3 == 2 || !(secant > low && secant < high) { middle } else { secant };
            let (error, slips) = excess(alpha)?;
            if error.abs() <= SETTLED * q || high - low <= f64::EPSILON * high {
                return Ok((alpha, slips));
            }
            if error < 0.0 { (low, at_low) = (alpha, error) } else { (high, at_high) = (alpha, error) }
        }
        let finding = format!("no static load reaches the modal displacement {q:.3e}");
        let remedy = "choose smaller displacements: the joints slide freely before";
        Err(Error::Analysis { analysis: "quasi-static analysis", finding, remedy })
    }

    /// N_i = F - K_T s on the virgin curve, and its derivative with respect to s.
    fn missing_force(&self, i: usize, s: f64) -> (f64, f64) {
        self.assembled.slips()[i].law.as_ref().map_or((0.0, 0.0), |law| {
            let (force, tangent) = (law.force(s), law.tangent(s));
            let k_t = law.initial_stiffness();
            (force - k_t * s, tangent - k_t)
        })
    }

    fn displacement(&self, alpha: f64, slips: &[f64]) -> f64 {
        let joints: f64 =
            self.shape.iter().enumerate().map(|(i, phi)| phi * self.missing_force(i, slips[i]).0).sum();
        (alpha - joints) / self.eigenvalue
    }

    /// Solves G⁻¹ s + N(s) = G⁻¹ φ_s α/ω0² by Newton's method with a line search, from the given slips. The left side is the gradient of a
    /// convex function.
    fn equilibrium(&self, alpha: f64, slips: &mut [f64]) -> Result<(), Error> {
        let n = slips.len();
        let goal: Vec<f64> = self.shape.iter().map(|phi| phi * alpha / self.eigenvalue).collect();
        let row = |i: usize| &self.stiffness[i * n..(i + 1) * n];
        let residual = |s: &[f64]| -> Vec<f64> {
            let way: Vec<f64> = goal.iter().zip(s).map(|(g, s)| g - s).collect();
            (0..n).map(|i| dot(row(i), &way) - self.missing_force(i, s[i]).0).collect()
        };
        let sizes: Vec<f64> =
            (0..n).map(|i| row(i).iter().zip(&goal).map(|(k, g)| (k * g).abs()).sum::<f64>()).collect();
        for _ in 0..MOST_ROUNDS {
            let r = residual(slips);
            if r.iter().zip(&sizes).all(|(r, size)| r.abs() <= SETTLED * size) {
                return Ok(());
            }
            let inverse = inverse_of(n, |i, j| {
                let joint =
                    |i: usize| self.missing_force(i, slips[i]).1 + SLIDING * self.stiffness[i * n + i];
                self.stiffness[i * n + j] + if i == j { joint(i) } else { 0.0 }
            })?;
            let step: Vec<f64> = (0..n).map(|i| dot(&inverse[i * n..(i + 1) * n], &r)).collect();
            let slope = dot(&step, &r);
            let start = slips.to_vec();
            search_line(slope, |length| {
                let moved = start.iter().zip(&step).map(|(s, d)| s + length * d);
                slips.iter_mut().zip(moved).for_each(|(s, moved)| *s = moved);
                Some(dot(&step, &residual(slips)))
            });
        }
        let finding = format!("the slips find no equilibrium under the modal load {alpha:.3e}");
        let remedy = "choose smaller displacements: the joints slide freely before";
        Err(Error::Analysis { analysis: "quasi-static analysis", finding, remedy })
    }
}
