//! Rules that every joint law obeys: Masing's rule, return-point memory, dissipation, exact moments, quadrature.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a failed test may panic and say why")]

use iwan_core::quadrature::Rule;
use iwan_core::{
    Backbone, Continuum, DensityPoint, Error, FourParameter, Grid, Hysteresis, Jenkins, Reversal, Run,
    Slider, Sliders, TabledFourParameter, Tabulated, Uniform,
};
use proptest::prelude::*;

fn four_parameter() -> impl Strategy<Value = FourParameter> {
    (1e2..1e7, 1e-1..1e4, -0.99..0.9, prop_oneof![Just(0.0), 0.0..4.0])
        .prop_map(|(k_t, f_s, chi, beta)| FourParameter::new(k_t, f_s, chi, beta).unwrap())
}

fn continuum_state<B: Backbone>(joint: &Continuum<B>) -> iwan_core::Reversals<Vec<Reversal>> {
    joint.virgin(vec![Reversal::default(); 64]).unwrap()
}

fn close(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance * b.abs().max(f64::MIN_POSITIVE)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

    /// Masing's rule: the branch after a reversal is the virgin curve enlarged by two in both directions.
    #[test]
    fn masing(joint in four_parameter(), amplitude in 0.01..3.0, share in 0.0..1.0) {
        let law = Continuum::new(joint);
        let mut state = continuum_state(&law);
        let a = amplitude * joint.phi_max();
        let top = law.advance(&mut state, a);
        let u = a * (1.0 - 2.0 * share);
        let found = law.advance(&mut state, u);
        prop_assert!((found - (top - 2.0 * joint.force(0.5 * (a - u)))).abs() <= 1e-12 * joint.f_s());
    }

    /// Return-point memory: an inner loop of any depth leaves no trace once it is closed.
    #[test]
    fn return_point_memory(joint in four_parameter(), turns in prop::collection::vec(0.05..0.95, 1..6)) {
        let law = Continuum::new(joint);
        let (mut plain, mut looped) = (continuum_state(&law), continuum_state(&law));
        let a = 0.8 * joint.phi_max();
        for state in [&mut plain, &mut looped] {
            law.advance(state, a);
            law.advance(state, -0.7 * a);
            law.advance(state, 0.2 * a);
        }
        // Loops of decreasing size, then straight on through the outer path.
        let (mut low, mut high) = (-0.7 * a, 0.2 * a);
        for (i, t) in turns.iter().enumerate() {
            let to = low + t * (high - low);
            if i % 2 == 0 { low = to } else { high = to }
            law.advance(&mut looped, to);
        }
        law.advance(&mut looped, 0.2 * a);
        for u in [0.3 * a, 0.9 * a, -0.5 * a] {
            let (x, y) = (law.advance(&mut plain, u), law.advance(&mut looped, u));
            prop_assert!((x - y).abs() <= 1e-12 * joint.f_s(), "{x} {y} at {u}");
        }
    }

    /// A closed loop dissipates D(u), never less than nothing, and returns the energy it stored; the force stays within F_S.
    #[test]
    fn closed_loops_dissipate_d(joint in four_parameter(), amplitude in 0.01..3.0) {
        let a = amplitude * joint.phi_max();
        let mut table = vec![Slider::default(); Sliders::table_len(300)];
        let sliders = Sliders::discretise(&joint, Grid::graded(300), 300, &mut table).unwrap();
        let mut state = sliders.virgin(vec![Run::default(); sliders.len()]).unwrap();
        sliders.advance(&mut state, a);
        let stored = sliders.stored_energy(&state);
        // The force is piecewise linear: the trapezoidal rule is exact with its breaks as nodes, and nearly so with many steps.
        let (mut work, mut last) = (0.0, (a, sliders.joint_force(&state)));
        for i in 1..=8000 {
            let u = a * (std::f64::consts::TAU * f64::from(i) / 8000.0).cos();
            let force = sliders.advance(&mut state, u);
            prop_assert!(force.abs() <= joint.f_s() * (1.0 + 1e-12));
            work += 0.5 * (force + last.1) * (u - last.0);
            last = (u, force);
        }
        prop_assert!(close(work, sliders.dissipation(a), 2e-3) || work.abs() < 1e-6 * joint.f_s() * a, "{work} {}", sliders.dissipation(a));
        prop_assert!(close(sliders.stored_energy(&state), stored, 1e-9));
        prop_assert!(joint.dissipation(a) >= 0.0);
    }

    /// log D over log u has the slope χ + 3 in micro-slip.
    #[test]
    fn slope_of_dissipation(joint in four_parameter(), amplitude in 1e-4..0.4) {
        let u = amplitude * joint.phi_max();
        let slope = (joint.dissipation(2.0 * u) / joint.dissipation(u)).log2();
        prop_assert!((slope - (joint.chi() + 3.0)).abs() < 1e-9);
    }

    /// Graded and uniform bins preserve K_T and F_S to rounding, and are in ascending order.
    #[test]
    fn discretisation_keeps_stiffness_and_slip_force(joint in four_parameter(), bins in 1_usize..400, graded in any::<bool>()) {
        let grid = if graded { Grid::graded(bins) } else { Grid::Uniform };
        let mut table = vec![Slider::default(); Sliders::table_len(bins)];
        let sliders = Sliders::discretise(&joint, grid, bins, &mut table).unwrap();
        prop_assert!(close(sliders.initial_stiffness(), joint.k_t(), 4e-15));
        prop_assert!(close(sliders.slip_force(), joint.f_s(), 4e-14));
        let strengths: Vec<f64> = sliders.elements().map(|e| e.0).collect();
        prop_assert!(strengths.windows(2).all(|w| w[0] <= w[1]));
        prop_assert!(*strengths.last().unwrap() <= joint.phi_max());
    }

    /// Parameters -> density -> parameters.
    #[test]
    fn density_round_trip(joint in four_parameter()) {
        let back = FourParameter::from_density(joint.r(), joint.chi(), joint.phi_max(), joint.s()).unwrap();
        prop_assert!(close(back.k_t(), joint.k_t(), 1e-12) && close(back.f_s(), joint.f_s(), 1e-12));
        prop_assert!((back.beta() - joint.beta()).abs() <= 1e-12 * (1.0 + joint.beta()));
    }
}

/// The closed forms against the definition F = ∫ρ min(φ, u) dφ + …, by adaptive quadrature of the density.
#[test]
fn closed_forms_agree_with_quadrature_of_the_density() {
    const RULE: Rule<24> = Rule::gauss_legendre();
    for (chi, beta) in [(-0.3, 0.02), (-0.183, 0.3), (0.5, 1.0), (-0.9, 0.0)] {
        let joint = FourParameter::new(2.0e5, 300.0, chi, beta).unwrap();
        let (end, r, s) = (joint.phi_max(), joint.r(), joint.s());
        // φ = end·t^m with m (χ+1) = 4 removes the singularity of ρ dφ at zero.
        let m = 4.0 / (chi + 1.0);
        let density = |f: &dyn Fn(f64) -> f64, to: f64| {
            let value = |t: f64| r * end.powf(chi + 1.0) * m * t.powi(3) * f(end * t.powf(m));
            let top = (to / end).powf(1.0 / m);
            (0..8)
                .map(|i| RULE.integrate(top * f64::from(i) / 8.0, top * f64::from(i + 1) / 8.0, value))
                .sum::<f64>()
        };
        for ratio in [0.01, 0.3, 0.99, 1.5, 4.0] {
            let u: f64 = ratio * end;
            let slipping = u.min(end);
            let all = density(&|_| 1.0, end) + s;
            let stuck = all - density(&|_| 1.0, slipping) - if u >= end { s } else { 0.0 };
            let dirac = |x: f64| if u >= end { s * x } else { 0.0 };
            let force = density(&|phi| phi, slipping) + dirac(end) + stuck * u;
            let dissipation = 4.0 * (density(&|phi| phi * (u - phi), slipping) + dirac(end * (u - end)));
            let energy = density(&|phi| phi * (u - 0.5 * phi), slipping)
                + dirac(end * (u - 0.5 * end))
                + 0.5 * stuck * u * u;
            assert!(close(joint.force(u), force, 1e-11), "F {chi} {ratio}: {} {force}", joint.force(u));
            assert!(
                close(joint.dissipation(u), dissipation, 1e-10),
                "D {chi} {ratio}: {} {dissipation}",
                joint.dissipation(u)
            );
            assert!(close(joint.energy(u), energy, 1e-11), "G {chi} {ratio}");
            // First harmonic of a closed cycle from the descending branch, in pieces on both sides of the corner at φ_max.
            let corner = if u > end { (1.0 - 2.0 * end / u).acos() } else { std::f64::consts::PI };
            let branch = |theta: f64| {
                (joint.force(u) - 2.0 * joint.force(0.5 * u * (1.0 - theta.cos()))) * theta.cos()
            };
            let piece = |a: f64, b: f64| {
                (0..64)
                    .map(|i| {
                        let (w, i) = ((b - a) / 64.0, f64::from(i));
                        RULE.integrate(a + w * i, a + w * (i + 1.0), branch)
                    })
                    .sum::<f64>()
            };
            let harmonic =
                2.0 / (std::f64::consts::PI * u) * (piece(0.0, corner) + piece(corner, std::f64::consts::PI));
            assert!(
                close(joint.harmonic_stiffness(u), harmonic, 1e-8),
                "K_1 {chi} {ratio}: {} {harmonic}",
                joint.harmonic_stiffness(u)
            );
        }
    }
}

/// The hysteretic force of the continuum against that of 10^5 sliders, on a history with nested loops and macro-slip.
#[test]
fn continuum_agrees_with_a_hundred_thousand_sliders() {
    let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3).unwrap();
    let bins = 100_000;
    let mut table = vec![Slider::default(); Sliders::table_len(bins)];
    let grid = Grid::Geometric { ratio: 1e7_f64.powf(1.0 / bins as f64) };
    let sliders = Sliders::discretise(&joint, grid, bins, &mut table).unwrap();
    let law = Continuum::new(TabledFourParameter::new(joint));
    let mut fast = sliders.virgin(vec![Run::default(); sliders.len()]).unwrap();
    let mut exact = continuum_state(&law);
    let mut worst = 0.0_f64;
    for n in 0..4000 {
        let t = f64::from(n) * 0.01;
        let u = joint.phi_max() * (1.6 * (-0.05 * t).exp() * (3.0 * t).sin() + 0.3 * (11.3 * t).sin());
        worst = worst.max((sliders.advance(&mut fast, u) - law.advance(&mut exact, u)).abs());
    }
    println!("worst {:e} of F_S", worst / joint.f_s());
    assert!(worst < 2e-8 * joint.f_s(), "{:e}", worst / joint.f_s());
}

/// The statements in the documentation of `Grid` on the errors of D with the default grids: that of a mode stays within 0.5 % from 0.001 to 0.3 φ_max,
/// that of a structure within 1.1 % from 1e-5 φ_max on, where the former has lost all dissipation. A ratio of 1.08 is not good enough: 100
/// bins begin at 1.08^-99 = 4.9e-4 φ_max, and all strengths below are one slider. Equal bins are worse: no dissipation at all
/// below the first strength.
#[test]
fn graded_bins_hold_the_dissipation() {
    for chi in [-0.5, -0.3, -0.183, -0.048] {
        let joint = FourParameter::new(2.75e5, 300.0, chi, 0.02).unwrap();
        let error = |grid: Grid, bins: usize, ratio: f64| {
            let mut table = vec![Slider::default(); Sliders::table_len(bins)];
            let sliders = Sliders::discretise(&joint, grid, bins, &mut table).unwrap();
            let u = ratio * joint.phi_max();
            (sliders.dissipation(u) / joint.dissipation(u) - 1.0).abs()
        };
        let worst_from = |low: f64, grid: Grid, bins: usize| {
            (0..400)
                .map(|i| error(grid, bins, low * (0.3 / low).powf(f64::from(i) / 399.0)))
                .fold(0.0, f64::max)
        };
        let worst = |grid: Grid, bins: usize| worst_from(1e-3, grid, bins);
        let (coarse, fine) = (worst(Grid::graded(100), 100), worst(Grid::graded(400), 400));
        let structure = worst_from(1e-5, Grid::IN_STRUCTURES, 100);
        println!("chi {chi}: {coarse:e}, {fine:e}, structure {structure:e}");
        assert!(coarse < 5e-3, "chi {chi}: {coarse:e}");
        assert!(fine < coarse / 8.0, "chi {chi}: {coarse:e} {fine:e}");
        assert!(structure < 1.15e-2, "chi {chi}: {structure:e}");
        assert!(error(Grid::graded(100), 100, 2e-5) > 0.99);
        assert!(worst(Grid::Geometric { ratio: 1.08 }, 100) > 0.05);
        assert_eq!(error(Grid::Uniform, 100, 0.002), 1.0);
        assert!(error(Grid::Uniform, 100, 0.01) > 0.3);
    }
}

/// A graded grid is the geometric grid that begins at its smallest strength, and a number out of range is named.
#[test]
fn grids_of_one_family_agree() {
    let joint = FourParameter::new(2.75e5, 300.0, -0.3, 0.02).unwrap();
    let strengths = |grid: Grid, bins: usize| -> Vec<f64> {
        let mut table = vec![Slider::default(); Sliders::table_len(bins)];
        let sliders = Sliders::discretise(&joint, grid, bins, &mut table).unwrap();
        sliders.elements().map(|element| element.0).collect()
    };
    for (bins, smallest) in [(50, 2e-4_f64), (100, 1e-6), (7, 0.5)] {
        let ratio = smallest.powf(-1.0 / (bins as f64 - 1.0));
        let pairs = strengths(Grid::Graded { smallest }, bins);
        for (a, b) in pairs.into_iter().zip(strengths(Grid::Geometric { ratio }, bins)) {
            assert!(close(a, b, 1e-12), "{bins} bins: {a} {b}");
        }
    }
    let mut table = [Slider::default(); 7];
    for smallest in [0.0, 1.0, -1e-3, f64::NAN] {
        let refused = Sliders::discretise(&joint, Grid::Graded { smallest }, 5, &mut table);
        assert!(matches!(refused, Err(Error::OutOfRange { name: "smallest", .. })), "{smallest}");
    }
}

/// Families of laws agree in common limits: a uniform band from zero is χ = 0, β = 0; a narrow band and a tabulated density have such
/// limits, too.
#[test]
fn families_agree_at_their_limits() {
    let four = FourParameter::new(4e4, 60.0, 0.0, 0.0).unwrap();
    let uniform = Uniform::new(4e4, 60.0, 1.0).unwrap();
    let rho = 4e4 / four.phi_max();
    let tabulated =
        Tabulated::new(&[0.0, four.phi_max()], &[rho, rho], 0.0, [DensityPoint::default(); 2]).unwrap();
    let jenkins = Jenkins::new(4e4, 60.0).unwrap();
    let narrow = Uniform::new(4e4, 60.0, 1e-7).unwrap();
    for ratio in [0.01, 0.5, 0.999, 1.7, 6.0] {
        let u = ratio * four.phi_max();
        for law in [&uniform as &dyn Backbone, &tabulated] {
            for (a, b) in [
                (law.force(u), four.force(u)),
                (law.energy(u), four.energy(u)),
                (law.dissipation(u), four.dissipation(u)),
                (law.secant(u), four.secant(u)),
                (law.harmonic_stiffness(u), four.harmonic_stiffness(u)),
            ] {
                assert!(close(a, b, 1e-9), "{ratio}: {a} {b}");
            }
        }
        assert!((narrow.force(u) - jenkins.force(u)).abs() < 1e-5 * 60.0);
        assert!((narrow.dissipation(u) - jenkins.dissipation(u)).abs() < 1e-5 * 60.0 * u);
        assert!((narrow.harmonic_stiffness(u) - jenkins.harmonic_stiffness(u)).abs() < 1e-5 * 4e4);
    }
}

/// When the stack of reversals is full, the smallest loop is forgotten; the stated cost of this bounds the error.
#[test]
fn full_stack_reports_what_it_forgets() {
    let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3).unwrap();
    let law = Continuum::new(joint);
    let mut short = law.virgin([Reversal::default(); 6]).unwrap();
    let mut long = law.virgin([Reversal::default(); 200]).unwrap();
    for n in 0..100 {
        let a = 0.9 * joint.phi_max() * 0.97_f64.powi(n) * if n % 2 == 0 { 1.0 } else { -1.0 };
        let gap = (law.advance(&mut short, a) - law.advance(&mut long, a)).abs();
        assert!(
            gap <= short.forgotten() * (1.0 + 1e-9) + 1e-12 * joint.f_s(),
            "{n}: {gap} {}",
            short.forgotten()
        );
    }
    assert!(short.forgotten() > 0.0);
    assert_eq!(long.forgotten(), 0.0);
    for step in 0..50 {
        let u = joint.phi_max() * 0.02 * f64::from(step);
        let gap = (law.advance(&mut short, u) - law.advance(&mut long, u)).abs();
        assert!(gap <= short.forgotten() * (1.0 + 1e-9) + 1e-12 * joint.f_s());
    }
}

#[test]
fn bad_parameters_are_named() {
    let name = |result: Result<FourParameter, Error>| match result {
        Err(Error::OutOfRange { name, .. }) => name,
        other => panic!("{other:?}"),
    };
    assert_eq!(name(FourParameter::new(-1.0, 1.0, 0.0, 0.0)), "k_t");
    assert_eq!(name(FourParameter::new(f64::NAN, 1.0, 0.0, 0.0)), "k_t");
    assert_eq!(name(FourParameter::new(1.0, 0.0, 0.0, 0.0)), "f_s");
    assert_eq!(name(FourParameter::new(1.0, f64::INFINITY, 0.0, 0.0)), "f_s");
    assert_eq!(name(FourParameter::new(1.0, 1.0, -1.0, 0.0)), "chi");
    assert_eq!(name(FourParameter::new(1.0, 1.0, 1.5, 0.0)), "chi");
    assert_eq!(name(FourParameter::new(1.0, 1.0, 0.0, -0.1)), "beta");
    assert_eq!(name(FourParameter::new(1e-300, 1e300, 0.0, 0.1)), "phi_max");
    assert!(matches!(Uniform::new(1.0, 1.0, 0.0), Err(Error::OutOfRange { name: "width", .. })));
    let mut table = [Slider::default(); 3];
    assert!(matches!(
        Sliders::from_elements(&[1.0, 0.5], &[1.0, 1.0], &mut table),
        Err(Error::Entry { name: "strength", index: 1, .. })
    ));
    assert!(matches!(
        Sliders::from_elements(&[1.0, 2.0], &[1.0, -1.0], &mut table),
        Err(Error::Entry { name: "stiffness", index: 1, .. })
    ));
    assert!(matches!(
        Sliders::from_elements(&[1.0], &[1.0], &mut table),
        Err(Error::Length { name: "table", .. })
    ));
    let joint = Jenkins::new(1.0, 1.0).unwrap();
    assert!(matches!(
        Sliders::discretise(&joint, Grid::graded(5), 5, &mut table),
        Err(Error::Length { name: "table", needed: 7, .. })
    ));
    assert!(Continuum::new(joint).virgin([Reversal::default(); 1]).is_err());
}
