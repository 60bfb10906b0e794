//! A mode whose joint consists of few sliders, under a hammer blow. The fit's law is the continuum, which does not describe such a record
//! exactly.

use iwan_core::{
    Error, FourParameter, Grid, Newmark, Oscillator, Pulse, ResidualStiffness, Run, Samples, Slider, Sliders,
};
use iwan_ident::Parameters;

/// The mode of the README.
pub(crate) const README: Parameters =
    Parameters { frequency: 124.0, damping_ratio: 2.5e-4, k_t: 4.45e4, f_s: 239.4, chi: -0.183, beta: 0.3 };
/// The mode's shape at the hammer.
const SHAPE: f64 = 23.5;
/// Time step, s.
pub(crate) const STEP: f64 = 1e-5;

/// Acceleration over `seconds` from the begin of a haversine blow of this amplitude, on a joint of this number of sliders.
///
/// # Errors
/// Errors of the time stepper.
pub(crate) fn blow(sliders: usize, amplitude: f64, seconds: f64) -> Result<Vec<f64>, Error> {
    let joint = FourParameter::new(README.k_t, README.f_s, README.chi, README.beta)?;
    let (frequency, zeta) = (README.frequency, README.damping_ratio);
    let mode = Oscillator::new(frequency, zeta, README.k_t, ResidualStiffness::Positive)?;
    let mut table = vec![Slider::default(); Sliders::table_len(sliders)];
    let law = Sliders::discretise(&joint, Grid::graded(sliders), sliders, &mut table)?;
    let mut state = law.virgin(vec![Run::default(); law.len()])?;
    let count = (seconds / STEP).round() as usize + 1;
    let mut force = vec![0.0; count];
    let used = Pulse::Haversine { amplitude: SHAPE * amplitude, duration: 1.6e-3 }.sample(STEP, &mut force);
    force.truncate(used);
    let mut out: [Vec<f64>; 4] = std::array::from_fn(|_| vec![0.0; count]);
    let [displacement, velocity, acceleration, joint_force] = &mut out;
    let mut samples = Samples { displacement, velocity, acceleration, joint_force };
    Newmark::prewarped(STEP, mode.omega0())?.integrate_sliders(
        &mode,
        &law,
        &mut state,
        0.0,
        &force,
        &mut samples,
    )?;
    let [_, _, acceleration, _] = out;
    Ok(acceleration)
}
