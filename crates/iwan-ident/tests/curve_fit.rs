//! From records to curves to parameters: which parameters curves determine, and which they do not.
#![allow(clippy::unwrap_used, clippy::print_stderr, reason = "a failed test may panic and say why")]

use iwan_core::{Backbone, Continuum, Newmark, Reversal, Samples};
use iwan_ident::curve_fit::{fit, start};
use iwan_ident::curves::straight_line;
use iwan_ident::curves::{Curves, ForceAxis, Quantity};
use iwan_ident::levels::compare_levels;
use iwan_ident::signal::{Method, Options, envelope, spot};
use iwan_ident::static_fit::{StaticCurves, fit_static};
use iwan_ident::{Error, Parameter, Parameters};
use iwan_machine::Kind;

const MODE_1: Parameters =
    Parameters { frequency: 124.0, damping_ratio: 0.0, k_t: 4.45e4, f_s: 239.4, chi: -0.183, beta: 0.3 };

/// Acceleration after release at `ratio` φ_max, by 200 time steps of the continuum for each sample.
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
    // The modal force ω² q grows a little more slowly than q, so the slope over force is a little steeper.
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
    // Sec. 4.5, Table 4: with the damper held at zero the exponent depends on the level; with a free damper it does not.
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

/// Secant frequency and dissipation of a joint from deep micro-slip to three times φ_max.
fn static_curves(mode: &Parameters) -> [Vec<f64>; 3] {
    let (oscillator, joint) = mode.model().unwrap();
    let q: Vec<f64> = (0..24).map(|i| joint.phi_max() * 3.0 * 10.0_f64.powf(-f64::from(i) / 8.0)).collect();
    let frequency =
        q.iter().map(|q| (oscillator.k_inf() + joint.force(*q) / q).sqrt() / std::f64::consts::TAU).collect();
    let dissipation = q.iter().map(|q| joint.dissipation(*q)).collect();
    [q, frequency, dissipation]
}

#[test]
fn static_curves_give_the_parameters_back() {
    let [q, frequency, dissipation] = static_curves(&MODE_1);
    let curves = StaticCurves { displacement: &q, frequency: &frequency, dissipation: &dissipation };
    let found = fit_static(&curves, MODE_1.frequency, MODE_1.k_t).unwrap();
    assert!((found.parameters.f_s / MODE_1.f_s - 1.0).abs() < 1e-4, "{found:?}");
    assert!((found.parameters.chi - MODE_1.chi).abs() < 1e-4, "{found:?}");
    assert!((found.parameters.beta / MODE_1.beta - 1.0).abs() < 1e-3, "{found:?}");
    assert!(found.dissipation_misfit < 1e-4 && found.frequency_misfit < 1e-4, "{found:?}");
    assert!((found.parameters.frequency / MODE_1.frequency - 1.0).abs() < 1e-14, "{found:?}");
    assert!((found.parameters.k_t / MODE_1.k_t - 1.0).abs() < 1e-14, "{found:?}");
    // A dissipation that is 10 % too large at one place only cannot be fitted, and the misfit shows this.
    let mut off = dissipation.clone();
    off[12] *= 1.1;
    let curves = StaticCurves { dissipation: &off, ..curves };
    let misfit = fit_static(&curves, MODE_1.frequency, MODE_1.k_t).unwrap().dissipation_misfit;
    assert!((0.05..0.1).contains(&misfit), "{misfit}");
}

#[test]
fn static_curves_that_tell_nothing_are_refused() {
    let [q, frequency, dissipation] = static_curves(&MODE_1);
    let of = |n: usize, m: usize, k_t: f64| {
        let curves = StaticCurves {
            displacement: &q[..n],
            frequency: &frequency[..n],
            dissipation: &dissipation[..m],
        };
        fit_static(&curves, MODE_1.frequency, k_t).unwrap_err()
    };
    let linear = of(24, 24, 0.1);
    assert_eq!(linear.kind(), Kind::Refused);
    assert!(
        linear.to_string().contains("K_T = 1.000e-1 is not positive: slipping does not soften"),
        "{linear}"
    );
    let short = of(7, 7, MODE_1.k_t);
    assert_eq!(short.kind(), Kind::TooShort);
    assert!(short.to_string().contains("entries of the curves: 7 found, at least 8 needed"), "{short}");
    let uneven = of(24, 23, MODE_1.k_t);
    assert_eq!(
        (uneven.kind(), uneven.to_string()),
        (Kind::Value, "dissipation has 23 entries, 24 are needed".into())
    );
}

/// Curves of a mode with the viscous damping ratio 5e-4 and friction of the power 2.6 over force.
fn level(blow: f64) -> Curves {
    let omega = std::f64::consts::TAU * 80.0;
    let t: Vec<f64> = (0..60).map(|i| 0.01 * f64::from(i)).collect();
    let q: Vec<f64> = t.iter().map(|t| 1e-3 * blow * (-2.0 * t).exp()).collect();
    let force: Vec<f64> = q.iter().map(|q| omega * omega * q).collect();
    let viscous = |q: &f64| std::f64::consts::TAU * 5e-4 * (omega * q).powi(2);
    let dissipation = q.iter().zip(&force).map(|(q, f)| viscous(q) + 2e-9 * f.powf(2.6)).collect();
    let (zeros, frequency) = (vec![0.0; 60], vec![80.0; 60]);
    Curves {
        t,
        displacement: q,
        frequency,
        damping_ratio: zeros.clone(),
        dissipation,
        force,
        axis: ForceAxis::Modal,
        log_dissipation_sd: zeros.clone(),
        frequency_sd: zeros,
        independent: 5.0,
    }
}

#[test]
fn levels_tell_a_damper_from_friction_or_are_refused() {
    let levels = [1.0, 2.0, 7.0].map(level);
    let found = compare_levels(&levels, 80.0).unwrap();
    assert!((found.damping_ratio / 5e-4 - 1.0).abs() < 1e-2 && (found.slope - 2.6).abs() < 1e-2, "{found:?}");
    assert!(found.misfit < 1e-3 && found.steps.len() == 2, "{found:?}");
    // The uncorrected dissipation has a slope between those of damper and friction.
    assert!(found.steps.iter().all(|s| s.total > 2.0 && s.total < 2.6 && (s.friction - 2.6).abs() < 1e-2));
    let mut growing = levels.clone();
    growing[1].dissipation[20..40].iter_mut().for_each(|d| *d = -*d);
    let error = compare_levels(&growing, 80.0).unwrap_err().to_string();
    assert!(error.contains("a dissipation is not positive; leave out levels"), "{error}");
    let error = compare_levels(&[1.0; 3].map(level), 80.0).unwrap_err().to_string();
    assert!(error.contains("the levels do not differ in force"), "{error}");
    let mut short = levels;
    short[0].dissipation.pop();
    let error = compare_levels(&short, 80.0).unwrap_err();
    assert_eq!(error, Error::Length { name: "dissipation", needed: 60, found: 59 });
}

/// |F_J| = (ω² - ω0² + K_T) q, which at the small-amplitude frequency is K_T q.
#[test]
fn curves_are_drawn_over_the_joints_force() {
    let modal = level(3.0);
    let axis = ForceAxis::Joint { frequency: 80.0, k_t: 3e4 };
    let joint = modal.clone().on_axis(axis).unwrap();
    for (force, q) in joint.force.iter().zip(&joint.displacement) {
        assert!((force / (3e4 * q) - 1.0).abs() < 1e-9);
    }
    assert_eq!((joint.axis, &joint.dissipation), (axis, &modal.dissipation));
    assert_eq!(joint.on_axis(ForceAxis::Modal).unwrap().force, modal.force);
    for (axis, name) in [
        (ForceAxis::Joint { frequency: 0.0, k_t: 3e4 }, "frequency"),
        (ForceAxis::Joint { frequency: 80.0, k_t: f64::NAN }, "k_t"),
    ] {
        let error = modal.clone().on_axis(axis).unwrap_err();
        assert!(matches!(&error, Error::OutOfRange { name: found, .. } if *found == name), "{error}");
    }
    // Friction alone has a slope of its own; two points have none, nor do points at one and the same force.
    let mut friction = modal;
    friction.dissipation = friction.force.iter().map(|f| 2e-9 * f.powf(2.6)).collect();
    assert!((friction.slope((0.0, f64::INFINITY)).unwrap().slope - 2.6).abs() < 1e-9);
    assert_eq!(friction.slope((friction.force[1], friction.force[0])), None);
    assert_eq!(straight_line(&[(1.0, 0.0), (1.0, 1.0), (1.0, 2.0)]), None);
    let line = straight_line(&[(0.0, 1.0), (1.0, 3.0), (2.0, 5.0)]).unwrap();
    assert!((line.slope - 2.0).abs() < 1e-14 && (line.intercept - 1.0).abs() < 1e-14);
}

#[test]
fn a_spot_is_the_mode_at_that_time() {
    let (dt, omega, rate) = (1e-3, 300.0, 4.0);
    let x: Vec<f64> =
        (0..2000).map(|n| dt * f64::from(n)).map(|t| 2.5 * (-rate * t).exp() * (omega * t).cos()).collect();
    for t in [0.3, 1.1] {
        let found = spot(&x, dt, 48.0, t).unwrap();
        assert!((found.frequency * std::f64::consts::TAU / omega - 1.0).abs() < 1e-4, "{found:?}");
        assert!((found.decay_rate / rate - 1.0).abs() < 0.01, "{found:?}");
        assert!((found.amplitude / (2.5 * (-rate * t).exp()) - 1.0).abs() < 0.01, "{found:?}");
    }
    let refused = |x: &[f64], dt, near, t| spot(x, dt, near, t).unwrap_err();
    assert!(refused(&x, dt, 48.0, 0.01).to_string().contains("time = 0.01 is out of range: 0.07"));
    assert!(refused(&x, dt, 501.0, 1.0).to_string().contains("between 0 and the Nyquist frequency"));
    assert!(refused(&x, 0.0, 48.0, 1.0).to_string().contains("a sampling interval > 0 s"));
    assert_eq!(refused(&x[..15], dt, 48.0, 1.0).kind(), Kind::TooShort);
    let hole = [vec![0.0; 20], vec![f64::NAN]].concat();
    let error = refused(&hole, dt, 48.0, 1.0);
    assert_eq!(error.kind(), Kind::NotFinite);
    assert!(error.to_string().starts_with("record[20] = NaN is not a finite number"), "{error}");
    let model = Parameters { chi: 2.0, ..MODE_1 }.model().unwrap_err();
    assert_eq!((model.kind(), Error::Stopped.kind()), (Kind::Value, Kind::Interrupted));
}

#[test]
fn parameters_are_called_by_name() {
    let mut mode = MODE_1;
    let values = [124.0, 0.0, 4.45e4, 239.4, -0.183, 0.3];
    let names = ["frequency", "damping_ratio", "k_t", "f_s", "chi", "beta"];
    for ((parameter, value), name) in Parameter::ALL.into_iter().zip(values).zip(names) {
        assert_eq!((parameter.name(), mode.get(parameter)), (name, value));
        *mode.get_mut(parameter) += 1.0;
        assert_eq!(mode.get(parameter), value + 1.0);
    }
}
