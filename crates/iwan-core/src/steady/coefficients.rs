//! Fourier coefficients of the joint's force in a steady motion, with their derivatives.

use super::harmonics::{Course, Harmonics};
use super::turns::{farthest, from_turn};
use super::walk::{SteadyWork, Walk, tolerance};
use crate::error::{Error, check_length};
use crate::law::{Backbone, check_masing};

/// The force of a joint in steady motion, as Fourier coefficients.
///
/// The motion u(θ) has the coefficients `displacement`, in the order of [`Harmonics`]; the coefficients of the force are written to `force`
/// in the same order. `jacobian`, if given, receives their derivatives row by row: entry (i, j) at `i * len + j` is the derivative of
/// `force[i]` with respect to `displacement[j]`.
///
/// The law is evaluated as a continuum, without sliders and without samples. A steady loop consists of pieces of the virgin curve between
/// turning points (Masing, 1926), each integrated by Gauss-Legendre rules; by return-point memory the time before has no effect. The joint
/// is taken to be loaded from its virgin state to the farthest excursion; this matters only for the mean force of motions with even
/// harmonics. The function allocates no memory.
///
/// ```
/// use iwan_core::{FourParameter, Harmonics, SteadyWork, steady_force};
/// // Mode 1 of Table 2 at 0.6 φ_max.
/// let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3)?;
/// let (mut motion, mut force, mut work) = ([0.0; 6], [0.0; 6], SteadyWork::new());
/// motion[0] = 0.6 * joint.phi_max();
/// steady_force(&joint, Harmonics::odd(5)?, &motion, &mut force, None, &mut work)?;
/// assert!((force[0] - 179.00368718787860).abs() < 1e-11);
/// assert!((force[3] - 4.969772836512).abs() < 1e-11); // 3rd harmonic, sine
/// # Ok::<(), iwan_core::Error>(())
/// ```
///
/// # Errors
/// [`Error::Length`] where a slice does not fit the harmonics, [`Error::Entry`] where a coefficient is not finite;
/// [`Error::Unsupported`] for a law that does not obey Masing's rule.
pub fn steady_force<B: Backbone>(
    law: &B,
    harmonics: Harmonics,
    displacement: &[f64],
    force: &mut [f64],
    jacobian: Option<&mut [f64]>,
    work: &mut SteadyWork,
) -> Result<(), Error> {
    check_masing(law)?;
    let count = harmonics.len();
    let course = Course::new(harmonics, displacement)?;
    check_length("force", force.len(), count)?;
    if let Some(jacobian) = &jacobian {
        check_length("jacobian", jacobian.len(), count * count)?;
    }
    let still = course.third == 0.0;
    let range = if still { None } else { order_turns(&course, work) };
    let Some(reach) = range else {
        at_rest(law, &course, force, jacobian);
        return Ok(());
    };
    let with_tangent = jacobian.is_some();
    let walk = Walk { law, course, tolerance: tolerance(law, reach), with_tangent };
    let jacobian = jacobian.unwrap_or_default();
    jacobian.fill(0.0);
    walk.go(work, jacobian);
    project_force(harmonics, work, force);
    if with_tangent {
        project_tangent(harmonics, work, jacobian);
    }
    Ok(())
}

/// Finds the turning points and orders them so that the farthest comes first. Returns half the range of the motion, or none if the motion
/// is no larger than rounding.
fn order_turns(course: &Course<'_>, work: &mut SteadyWork) -> Option<f64> {
    work.turns.find(course);
    if work.turns.count == 0 {
        return None;
    }
    let (index, value) = farthest(course, work.turns.found());
    from_turn(course, &mut work.turns, index);
    if course.harmonics.is_odd() {
        return Some(value.abs());
    }
    let others = work.turns.found().iter().map(|&angle| course.at(angle).value);
    Some(others.fold(0.0, |most: f64, other| most.max(0.5 * (value - other).abs())))
}

/// The joint at rest: a constant displacement on the virgin curve, with all sliders stuck.
fn at_rest<B: Backbone>(law: &B, course: &Course<'_>, force: &mut [f64], jacobian: Option<&mut [f64]>) {
    let mean = if course.harmonics.is_odd() { 0.0 } else { course.coefficients[0] };
    force.fill(0.0);
    let (at, tangent) = law.force_and_tangent(mean.abs());
    if !course.harmonics.is_odd() {
        force[0] = at.copysign(mean);
    }
    if let Some(jacobian) = jacobian {
        jacobian.fill(0.0);
        for (i, entry) in jacobian.iter_mut().step_by(course.harmonics.len() + 1).enumerate() {
            let mean = i == 0 && !course.harmonics.is_odd();
            *entry = if mean { tangent } else { law.initial_stiffness() };
        }
    }
}

/// Normalisation of a Fourier coefficient: 1 over the integral of the square of the harmonic's shape over the period.
fn norm(harmonics: Harmonics, n: usize) -> f64 {
    if n == 0 { 1.0 / harmonics.period() } else { 2.0 / harmonics.period() }
}

fn project_force(harmonics: Harmonics, work: &SteadyWork, force: &mut [f64]) {
    for n in harmonics.orders() {
        let (at, norm) = (harmonics.index(n), norm(harmonics, n));
        force[at] = norm * work.sums.force[n][0];
        if n > 0 {
            force[at + 1] = norm * work.sums.force[n][1];
        }
    }
}

/// Adds ∫ K φ_j φ_k, from the integrals of K times e^(i(j±k)θ), to the products of the branches in `jacobian`, and normalises the sum.
fn project_tangent(harmonics: Harmonics, work: &SteadyWork, jacobian: &mut [f64]) {
    let (count, moments) = (harmonics.len(), &work.sums.tangent);
    for j in harmonics.orders() {
        let (row, norm) = (harmonics.index(j), norm(harmonics, j));
        for k in harmonics.orders() {
            let column = harmonics.index(k);
            let [sum_c, sum_s] = moments[j + k].map(|part| 0.5 * part);
            let [c, s] = moments[j.abs_diff(k)].map(|part| 0.5 * part);
            // sin((k - j)θ) changes its sign with k - j.
            let s = if k >= j { s } else { -s };
            let products = [[c + sum_c, sum_s + s], [sum_s - s, c - sum_c]];
            for (a, line) in products.iter().enumerate().take(1 + usize::from(j > 0)) {
                for (b, product) in line.iter().enumerate().take(1 + usize::from(k > 0)) {
                    let entry = &mut jacobian[(row + a) * count + column + b];
                    *entry = norm * (*entry + product);
                }
            }
        }
    }
}
