//! The free-form density: it is recovered where the record determines it, and better than four parameters where these are too few.
#![allow(clippy::unwrap_used, clippy::print_stderr, reason = "a failed test may panic and say why")]

use std::f64::consts::TAU;

use iwan_core::{Backbone, Continuum, FourParameter, Grid, Newmark, Reversal, Samples, Slider, Sliders};
use iwan_ident::Parameters;
use iwan_ident::curve_fit::{fit_from, start};
use iwan_ident::curves::{Curves, ForceAxis, Quantity};
use iwan_ident::density::{Evidence, density};
use iwan_ident::signal::{Method, Options, envelope};

const MODE_1: Parameters =
    Parameters { frequency: 124.0, damping_ratio: 5e-4, k_t: 4.45e4, f_s: 239.4, chi: -0.183, beta: 0.3 };

/// Curves of a joint by averaging, with relative noise on D and noise in Hz on the frequency; `seed` sets the random numbers.
fn curves_of(law: &dyn Backbone, top: f64, zeta: f64, noise: (f64, f64), mut seed: u64) -> Curves {
    let mut normal = || -> f64 {
        let uniform = |seed: &mut u64| {
            *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (*seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform(&mut seed)).sum::<f64>() - 6.0
    };
    let omega0 = TAU * 124.0;
    let omega = |u: f64| (omega0 * omega0 - law.initial_stiffness() + law.harmonic_stiffness(u)).sqrt();
    let u: Vec<f64> = (0..150).map(|i| top * 0.97_f64.powi(i)).collect();
    // The curves' energy comes from the velocity amplitude, which falls more slowly than that of the displacement.
    let slower = |u: f64| 1.0 + (omega(1.01 * u) / omega(0.99 * u)).ln() / (1.01_f64 / 0.99).ln();
    let lost = |u: &f64| (law.dissipation(*u) + TAU * zeta * omega0 * omega(*u) * u * u) * slower(*u);
    Curves {
        t: (0..u.len()).map(|i| i as f64 * 8e-3).collect(),
        dissipation: u.iter().map(|u| lost(u) * (noise.0 * normal()).exp()).collect(),
        frequency: u.iter().map(|&u| omega(u) / TAU + noise.1 * normal()).collect(),
        damping_ratio: vec![1e-3; u.len()],
        force: u.iter().map(|&u| omega(u).powi(2) * u).collect(),
        axis: ForceAxis::Modal,
        log_dissipation_sd: vec![noise.0; u.len()],
        frequency_sd: vec![noise.1; u.len()],
        independent: u.len() as f64,
        displacement: u,
    }
}

/// R φ^χ of a four-parameter joint.
fn power_law(joint: &FourParameter, phi: f64) -> f64 {
    1_274_290.571_068_603 * phi.powf(-0.183) * f64::from(u8::from(phi < joint.phi_max()))
}

#[test]
fn a_four_parameter_density_is_recovered_from_a_simulated_record() {
    let (oscillator, joint) = MODE_1.model().unwrap();
    let law = Continuum::new(&joint);
    let mut memory = law.virgin(vec![Reversal::default(); 8192]).unwrap();
    iwan_core::Hysteresis::advance(&law, &mut memory, 0.8 * joint.phi_max());
    let (dt, fraction, samples) = (2e-4, 20, 8000);
    let mut out: [Vec<f64>; 4] = std::array::from_fn(|_| vec![0.0; (samples - 1) * fraction + 1]);
    let [displacement, velocity, acceleration, joint_force] = &mut out;
    let scheme = Newmark::prewarped(dt / fraction as f64, oscillator.omega0()).unwrap();
    let mut buffers = Samples { displacement, velocity, acceleration, joint_force };
    scheme.integrate(&oscillator, &law, &mut memory, 0.0, &[], &mut buffers).unwrap();
    let record: Vec<f64> = out[2].iter().copied().step_by(fraction).collect();
    let envelope = envelope(&record, dt, Method::Hilbert, &Options::default()).unwrap();
    let curves = Curves::new(&envelope, Quantity::Acceleration, ForceAxis::Modal).unwrap();
    let found = density(&[curves], Evidence::Both).unwrap();
    eprintln!(
        "{:?} {:e} {:e} {}",
        found.informed, found.mean_square, found.regularisation, found.damping_ratio
    );
    let (low, high) = found.informed;
    for i in 0..=20 {
        let phi = 2.0 * low * (0.5 * high / low).powf(f64::from(i) / 20.0);
        let ratio = found.at(phi) / power_law(&joint, phi);
        eprintln!("{:.3e} {ratio:.4}", phi / joint.phi_max());
        assert!(phi > 0.8 * high || (ratio - 1.0).abs() < 0.1, "{phi}: {ratio}");
    }
    // Sliders far weaker than the smallest amplitude never stick in the record: ω0 is an extrapolation.
    assert!((found.frequency / 124.0 - 1.0).abs() < 3e-4, "{}", found.frequency);
    assert!((found.damping_ratio / 5e-4 - 1.0).abs() < 0.2, "{}", found.damping_ratio);
    assert!(found.mean_square < 1.01);
}

/// A joint with two families of sliders, the sum of two four-parameter joints: a power law and a hump.
struct Two(FourParameter, FourParameter);

impl Backbone for Two {
    fn initial_stiffness(&self) -> f64 {
        self.0.initial_stiffness() + self.1.initial_stiffness()
    }
    fn slip_force(&self) -> f64 {
        self.0.slip_force() + self.1.slip_force()
    }
    fn strengths(&self) -> (f64, f64) {
        (0.0, self.0.strengths().1.max(self.1.strengths().1))
    }
    fn force(&self, u: f64) -> f64 {
        self.0.force(u) + self.1.force(u)
    }
    fn tangent(&self, u: f64) -> f64 {
        self.0.tangent(u) + self.1.tangent(u)
    }
    fn energy(&self, u: f64) -> f64 {
        self.0.energy(u) + self.1.energy(u)
    }
    fn dissipation(&self, u: f64) -> f64 {
        self.0.dissipation(u) + self.1.dissipation(u)
    }
    fn harmonic_stiffness(&self, u: f64) -> f64 {
        self.0.harmonic_stiffness(u) + self.1.harmonic_stiffness(u)
    }
    fn stiffness_below(&self, phi: f64) -> f64 {
        self.0.stiffness_below(phi) + self.1.stiffness_below(phi)
    }
    fn force_below(&self, phi: f64) -> f64 {
        self.0.force_below(phi) + self.1.force_below(phi)
    }
    fn is_smooth(&self) -> bool {
        false
    }
}

/// The joint of mode 1, and a weak joint that slips completely at a twentieth of the former's φ_max.
fn two() -> Two {
    let strong = FourParameter::new(4.45e4, 239.4, -0.183, 0.3).unwrap();
    let k_t = 0.2 * 4.45e4;
    let weak = FourParameter::new(k_t, 0.03 * k_t * strong.phi_max(), 0.2, 0.0).unwrap();
    Two(strong, weak)
}

#[test]
fn two_families_are_seen_where_four_parameters_miss_them() {
    let joint = two();
    let curves = [curves_of(&joint, 0.8 * joint.0.phi_max(), 5e-4, (5e-3, 1e-3), 7)];
    let found = density(&curves, Evidence::Both).unwrap();
    let first = start(&curves[0]).unwrap().parameters;
    let starts = [first, MODE_1, Parameters { k_t: 6e4, f_s: 200.0, chi: -0.6, ..MODE_1 }];
    let four = fit_from(&curves, &starts, &[]).unwrap();
    eprintln!("{}\n{}", four.verdict.misfit, found.words(&four.verdict));
    let edge = joint.1.phi_max();
    // Below the upper edge of the weak family there are more sliders than above it; the law states how many more.
    let true_step = |phi: f64| {
        let weak = joint.1.stiffness_below(1.01 * phi) - joint.1.stiffness_below(0.99 * phi);
        power_law(&joint.0, phi) + weak / (0.02 * phi)
    };
    for phi in [0.3 * edge, 0.6 * edge, 3.0 * edge, 6.0 * edge] {
        let ratio = found.at(phi) / true_step(phi);
        eprintln!("{:.3} of the edge: {ratio:.3}", phi / edge);
        assert!((ratio - 1.0).abs() < 0.25, "{phi}: {ratio}");
    }
    assert!(found.at(0.6 * edge) > 1.8 * found.at(3.0 * edge));
    assert!(found.mean_square < 1.1, "{}", found.mean_square);
    assert!(!four.verdict.adequate || four.verdict.dissipation_misfit > 3.0 * found.dissipation_misfit);
}

#[test]
fn noise_does_not_make_densities_of_its_own() {
    let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3).unwrap();
    for seed in 1..=5 {
        let curves = [curves_of(&joint, 0.5 * joint.phi_max(), 5e-4, (0.05, 5e-3), seed)];
        let found = density(&curves, Evidence::Both).unwrap();
        assert!((found.mean_square - 1.0).abs() < 0.3, "{}", found.mean_square);
        let (low, high) = found.informed;
        for i in 0..=10 {
            let phi = 3.0 * low * (0.25 * high / low).powf(f64::from(i) / 10.0);
            let ratio = found.at(phi) / power_law(&joint, phi);
            assert!((ratio - 1.0).abs() < 0.3, "seed {seed}, {:.3}: {ratio}", phi / high);
        }
        assert!(found.density.iter().all(|d| *d >= 0.0));
    }
}

#[test]
fn the_kernel_runs_the_density_as_it_is() {
    let joint = two();
    let top = 0.8 * joint.0.phi_max();
    let curves = [curves_of(&joint, top, 0.0, (5e-3, 1e-4), 3)];
    let found = density(&curves, Evidence::Both).unwrap();
    let law = found.law().unwrap();
    for u in [0.05 * top, 0.3 * top, 0.9 * top] {
        assert!((found.predict(u).unwrap().dissipation / joint.dissipation(u) - 1.0).abs() < 0.03, "{u}");
        assert!((law.dissipation(u) / joint.dissipation(u) - 1.0).abs() < 0.1, "{u}");
    }
    let mut table = vec![Slider::default(); Sliders::table_len(200)];
    let sliders = Sliders::discretise(&law, Grid::graded(200), 200, &mut table).unwrap();
    assert!((sliders.initial_stiffness() / law.initial_stiffness() - 1.0).abs() < 1e-12);
    let memory = Continuum::new(&law).virgin(vec![Reversal::default(); 16]);
    assert!(memory.is_ok() && found.model().is_ok());
}

#[test]
fn nothing_to_go_by_is_refused() {
    let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3).unwrap();
    let mut curves = curves_of(&joint, 1e-3, 0.0, (0.01, 1e-3), 1);
    curves.displacement.fill(1e-3);
    assert!(density(&[curves.clone()], Evidence::Both).unwrap_err().to_string().contains("hardly differ"));
    curves.dissipation.fill(-1.0);
    assert!(density(&[curves], Evidence::Both).is_err() && density(&[], Evidence::Both).is_err());
}
