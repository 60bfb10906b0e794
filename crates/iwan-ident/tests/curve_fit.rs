//! From records to curves to parameters: what curves can tell and what they cannot.
#![allow(clippy::unwrap_used, clippy::print_stderr, reason = "a failed test may panic and say why")]

use iwan_core::{Backbone, Continuum, Newmark, Reversal, Samples};
use iwan_ident::curve_fit::{fit, start};
use iwan_ident::curves::{Curves, ForceAxis, Quantity};
use iwan_ident::signal::{Method, Options, envelope};
use iwan_ident::{Parameter, Parameters};

const MODE_1: Parameters =
    Parameters { frequency: 124.0, damping_ratio: 0.0, k_t: 4.45e4, f_s: 239.4, chi: -0.183, beta: 0.3 };

/// Acceleration after release at `ratio` φ_max, by 200 time steps a sample of the continuum.
fn record(mode: &Parameters, ratio: f64, dt: f64, samples: usize) -> Vec<f64> {
    let (oscillator, joint) = mode.model().unwrap();
    let law = Continuum::new(&joint);
    let mut memory = law.virgin(vec![Reversal::default(); 8192]).unwrap();
    iwan_core::Hysteresis::advance(&law, &mut memory, ratio * joint.phi_max());
    let fraction = 20;
    let mut out: [Vec<f64>; 4] = std::array::from_fn(|_| vec![0.0; (samples - 1) * fraction + 1]);
    let [displacement, velocity, acceleration, joint_force] = &mut out;
    let scheme = Newmark::prewarped(dt / fraction as f64, oscillator.omega0()).unwrap();
    let mut buffers = Samples { displacement, velocity, acceleration, joint_force };
    scheme.integrate(&oscillator, &law, &mut memory, 0.0, &[], &mut buffers).unwrap();
    out[2].iter().copied().step_by(fraction).collect()
}

fn curves(x: &[f64], dt: f64) -> Curves {
    let envelope = envelope(x, dt, Method::Hilbert, &Options::default()).unwrap();
    Curves::new(&envelope, Quantity::Acceleration, ForceAxis::Modal).unwrap()
}

#[test]
fn micro_slip_gives_slope_and_dissipation_level() {
    let dt = 2e-4;
    let curves = curves(&record(&MODE_1, 0.3, dt, 20_000), dt);
    let joint = MODE_1.model().unwrap().1;
    for i in curves.t.len() / 10..9 * curves.t.len() / 10 {
        let ratio = curves.dissipation[i] / joint.dissipation(curves.displacement[i]);
        assert!((ratio - 1.0).abs() < 0.02, "{}: {ratio}", curves.t[i]);
    }
    let slope = curves.slope((0.0, f64::INFINITY)).unwrap().slope;
    // The modal force ω² q grows a little slower than q, the slope over it is a little steeper.
    assert!((slope - 2.817).abs() < 0.02, "{slope}");
    let first = start(&curves).unwrap();
    eprintln!("{first:?}");
    let fit = fit(&[curves], &first.parameters, &[]).unwrap();
    eprintln!("{fit:?}");
    assert!(fit.verdict.adequate, "{}", fit.verdict.misfit);
    assert!((fit.parameters.chi / -0.183 - 1.0).abs() < 0.02, "{:?}", fit.parameters);
    assert!((fit.parameters.frequency / 124.0 - 1.0).abs() < 1e-4);
}

#[test]
fn a_damper_that_is_ignored_makes_the_slope_drift_with_the_level() {
    // Sec. 4.5, Table 4: with the damper held at zero the exponent depends on the level, with the damper free it does not.
    let truth = Parameters { damping_ratio: 2.5e-4, ..MODE_1 };
    let dt = 2e-4;
    let exponents = |held: &[Parameter]| -> Vec<f64> {
        [0.3, 0.1, 0.03]
            .iter()
            .map(|ratio| {
                let curves = curves(&record(&truth, *ratio, dt, 12_000), dt);
                let zeta = if held.is_empty() { 1e-4 } else { 0.0 };
                let first = Parameters { damping_ratio: zeta, chi: -0.4, ..truth };
                fit(&[curves], &first, held).unwrap().parameters.chi + 3.0
            })
            .collect()
    };
    let fixed = exponents(&[Parameter::DampingRatio, Parameter::KT, Parameter::Beta]);
    let free = exponents(&[Parameter::KT, Parameter::Beta]);
    eprintln!("held at 0: {fixed:?}, free: {free:?}");
    assert!(fixed[0] > fixed[1] + 0.05 && fixed[1] > fixed[2] + 0.05, "{fixed:?}");
    assert!(free.iter().all(|s| (s - 2.817).abs() < 0.04), "{free:?}");
}
