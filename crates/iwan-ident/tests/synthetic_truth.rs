//! Noise-free ring-downs through macro-slip: the fit recovers the parameters.
//!
//! The records come from references that share nothing with the fit's forward model (the half-cycle map): the
//! event-driven solution of a population of 20,000 sliders, and time steps of the continuum.
#![allow(clippy::unwrap_used, clippy::print_stderr, reason = "a failed test may panic and say why")]

use iwan_core::{
    Continuum, EventDriven, Grid, Hysteresis, Newmark, Pulse, Reversal, Run, Samples, Slider, Sliders,
};
use iwan_ident::curves::Quantity;
use iwan_ident::refine::{RingDown, refine};
use iwan_ident::{Parameter, Parameters};

const SETS: [(&str, Parameters); 3] = [
    ("Table 1", parameters(124.0, 2.75e5, 300.0, -0.3, 0.02)),
    ("mode 1", parameters(124.0, 4.45e4, 239.4, -0.183, 0.3)),
    ("mode 3", parameters(500.0, 8.73e5, 534.6, -0.048, 0.38)),
];

const fn parameters(frequency: f64, k_t: f64, f_s: f64, chi: f64, beta: f64) -> Parameters {
    Parameters { frequency, damping_ratio: 0.0, k_t, f_s, chi, beta }
}

struct Buffers([Vec<f64>; 4]);

impl Buffers {
    fn new(samples: usize) -> Self {
        Self(std::array::from_fn(|_| vec![0.0; samples]))
    }

    fn samples(&mut self) -> Samples<'_> {
        let [displacement, velocity, acceleration, joint_force] = &mut self.0;
        Samples { displacement, velocity, acceleration, joint_force }
    }
}

/// Acceleration after release from rest at `ratio` φ_max, 20,000 sliders from event to event.
fn by_events(mode: &Parameters, ratio: f64, dt: f64, samples: usize) -> Vec<f64> {
    let (oscillator, joint) = mode.model().unwrap();
    let bins = 20_000;
    let grid = Grid::Geometric { ratio: 1e4_f64.powf(1.0 / bins as f64) };
    let mut table = vec![Slider::default(); Sliders::table_len(bins)];
    let sliders = Sliders::discretise(&joint, grid, bins, &mut table).unwrap();
    let mut state = sliders.virgin(vec![Run::default(); sliders.len()]).unwrap();
    sliders.advance(&mut state, ratio * joint.phi_max());
    let mut out = Buffers::new(samples);
    let solver = EventDriven::new(&oscillator, sliders, Pulse::None, 1.0).unwrap();
    solver.integrate(&mut state, 0.0, dt, &mut out.samples()).unwrap();
    out.0[2].clone()
}

/// The same acceleration by time steps of the continuum, each `dt` over `fraction`.
fn by_steps(mode: &Parameters, ratio: f64, dt: f64, samples: usize, fraction: usize) -> Vec<f64> {
    let (oscillator, joint) = mode.model().unwrap();
    let law = Continuum::new(&joint);
    let mut memory = law.virgin(vec![Reversal::default(); 4096]).unwrap();
    law.advance(&mut memory, ratio * joint.phi_max());
    let mut out = Buffers::new((samples - 1) * fraction + 1);
    let scheme = Newmark::prewarped(dt / fraction as f64, oscillator.omega0()).unwrap();
    scheme.integrate(&oscillator, &law, &mut memory, 0.0, &[], &mut out.samples()).unwrap();
    out.0[2].iter().copied().step_by(fraction).collect()
}

/// Asserts the relative errors against the truth: K_T, F_S, χ, β within 1 %, the frequency within 1e-5, ζ_v within 1 %.
fn assert_found(name: &str, found: &Parameters, truth: &Parameters) {
    for p in Parameter::ALL {
        let (found, truth) = (found.get(p), truth.get(p));
        let error = if truth == 0.0 { found } else { found / truth - 1.0 };
        let limit = match p {
            Parameter::Frequency => 1e-5,
            Parameter::DampingRatio if truth == 0.0 => 1e-6,
            _ => 0.01,
        };
        eprintln!("{name:8} {:13} {truth:.6e} error {error:+.1e}", p.name());
        assert!(error.abs() < limit, "{name} {}: {found} {truth}", p.name());
    }
}

/// Start values that are off by a third.
fn off(truth: &Parameters) -> Parameters {
    Parameters {
        frequency: 1.002 * truth.frequency,
        damping_ratio: 5e-4,
        k_t: 1.3 * truth.k_t,
        f_s: 0.75 * truth.f_s,
        chi: -0.4,
        beta: 0.15,
    }
}

#[test]
fn parameters_come_back_from_event_driven_records() {
    for (name, truth) in SETS {
        for damping_ratio in [0.0, 1e-3] {
            let truth = Parameters { damping_ratio, ..truth };
            let dt = 0.005 / truth.frequency;
            let samples = by_events(&truth, 2.0, dt, 5000);
            let record = RingDown {
                samples: &samples,
                dt,
                quantity: Quantity::Acceleration,
                band: None,
                beside: None,
            };
            let refined = refine(&[record], &off(&truth), &[]).unwrap();
            eprintln!("{name} {damping_ratio}: left {:e}", refined.relative_residual);
            assert_found(name, &refined.parameters, &truth);
        }
    }
}

#[test]
fn parameters_come_back_from_time_steps_of_the_continuum_at_two_levels() {
    let truth = Parameters { damping_ratio: 1e-3, ..SETS[1].1 };
    let dt = 0.02 / truth.frequency;
    let (low, high) = (by_steps(&truth, 0.3, dt, 1250, 100), by_steps(&truth, 1.5, dt, 1250, 100));
    let record =
        |samples| RingDown { samples, dt, quantity: Quantity::Acceleration, band: None, beside: None };
    let refined = refine(&[record(&low), record(&high)], &off(&truth), &[]).unwrap();
    assert_eq!(refined.starts.len(), 2);
    assert_found("mode 1", &refined.parameters, &truth);
}
