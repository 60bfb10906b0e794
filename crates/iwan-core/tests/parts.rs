//! Parts of a modal law: force, energy, first harmonic and dissipation against quadrature.

#![allow(clippy::unwrap_used, reason = "a failed test may panic and say why")]

use std::f64::consts::{FRAC_PI_2, PI};

use iwan_core::quadrature::Rule;
use iwan_core::{
    Coulomb, FourParameter, ModalLaw, Oscillator, Part, Pinning, PowerDamping, PowerSpring,
    ResidualStiffness, sum_of_parts,
};
use proptest::prelude::*;

fn part() -> impl Strategy<Value = Part> {
    prop_oneof![
        (1e-3..1e3, 0.05..6.0).prop_map(|(c, n)| PowerDamping::new(c, n).unwrap().into()),
        (1e-3..1e3).prop_map(|force| Coulomb::new(force).unwrap().into()),
        (-1e3..1e3, 1.01..8.0).prop_map(|(k, m)| PowerSpring::new(k, m).unwrap().into()),
        (1e-3..1e3, 0.01..3.0).prop_map(|(k, gap)| Pinning::new(k, gap).unwrap().into()),
    ]
}

/// ∮ g(θ) dθ over one cycle of the displacement a cos θ. Each quarter cycle is cut at the `corner`, and nodes are dense at both ends of
/// each piece, where power laws have corners.
fn cycle(corner: f64, g: impl Fn(f64) -> f64) -> f64 {
    const RULE: Rule<64> = Rule::gauss_legendre();
    let piece = |from: f64, to: f64| {
        let way = to - from;
        // θ = from + way (10 s³ - 15 s⁴ + 6 s⁵), with zero slope at both ends.
        RULE.integrate(0.0, 1.0, |s| {
            let eased = s * s * s * (10.0 - s * (15.0 - 6.0 * s));
            30.0 * way * (s * (1.0 - s)).powi(2) * g(from + way * eased)
        })
    };
    (0..4)
        .map(|quarter| {
            let start = f64::from(quarter) * FRAC_PI_2;
            let at = start + if quarter % 2 == 0 { corner } else { FRAC_PI_2 - corner };
            piece(start, at) + piece(at, start + FRAC_PI_2)
        })
        .sum()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    /// K_1 = (1/πa) ∮ f cos θ dθ and D = ∮ f v dt, both by quadrature of the force itself.
    #[test]
    fn first_harmonic_and_dissipation_are_those_of_the_force(part in part(), a in 0.05..5.0_f64, w in 0.1..50.0_f64) {
        let corner = match part {
            Part::Pinning(stop) if stop.gap() < a => (stop.gap() / a).acos(),
            _ => 0.25 * PI,
        };
        let force = |theta: f64| part.force(a * theta.cos(), -w * a * theta.sin());
        let stiffness = cycle(corner, |theta| force(theta) * theta.cos()) / (PI * a);
        let lost = cycle(corner, |theta| -a * theta.sin() * force(theta));
        let scale = cycle(corner, |theta| force(theta).abs()) / a;
        let found = (part.harmonic_stiffness(a, w), part.dissipation(a, w));
        prop_assert!((found.0 - stiffness).abs() <= 1e-9 * scale, "{part:?} {a}: {} {stiffness}", found.0);
        prop_assert!((found.1 - lost).abs() <= 1e-9 * scale * a * a, "{part:?} {a}: {} {lost}", found.1);
    }

    /// The energy is the work of the force, and the slope of the force is the tangent.
    #[test]
    fn energy_is_the_work_of_the_force(part in part(), u in -4.0..4.0_f64) {
        let h = 1e-5 * u.abs().max(1e-2);
        let slope = |f: &dyn Fn(f64) -> f64| {
            (8.0 * (f(u + h) - f(u - h)) - (f(u + 2.0 * h) - f(u - 2.0 * h))) / (12.0 * h)
        };
        if let Part::Pinning(stop) = part {
            prop_assume!((u.abs() - stop.gap()).abs() > 4.0 * h);
        }
        prop_assume!(u.abs() > 4.0 * h);
        let scale = part.elastic_force(u).abs() + part.energy(u).abs() / h * 1e-9;
        let work = slope(&|u| part.energy(u));
        prop_assert!((work - part.elastic_force(u)).abs() <= 1e-6 * scale, "{part:?} {u}: {work}");
        let tangent = slope(&|u| part.elastic_force(u));
        let scale = part.tangent(u).abs() + part.elastic_force(u).abs() / h * 1e-9;
        prop_assert!((tangent - part.tangent(u)).abs() <= 1e-6 * scale, "{part:?} {u}: {tangent}");
    }
}

/// A mode with all kinds of parts: stiffness and loss of the parts add up, and frequency, decay rate and damping ratio follow from the
/// sums.
#[test]
fn the_law_of_a_mode_is_the_sum_of_its_parts() {
    use iwan_core::Backbone;
    let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3).unwrap();
    let oscillator = Oscillator::new(124.0, 2.5e-4, 4.45e4, ResidualStiffness::Positive).unwrap();
    let parts = [
        Part::from(PowerDamping::new(2e-3, 2.0).unwrap()),
        Part::from(Coulomb::new(0.3).unwrap()),
        Part::from(PowerSpring::new(-4e9, 3.0).unwrap()),
        Part::from(Pinning::new(2e4, 1e-3).unwrap()),
    ];
    let law = ModalLaw::new(oscillator, Some(&joint), &parts);
    let a = 0.2 * joint.phi_max();
    let w = law.frequency(a);
    let stiffness = oscillator.k_inf()
        + joint.harmonic_stiffness(a)
        + sum_of_parts(&parts, |part| part.harmonic_stiffness(a, w));
    assert!((w * w / stiffness - 1.0).abs() < 1e-15);
    let lost = PI * oscillator.viscous() * w * a * a
        + joint.dissipation(a)
        + sum_of_parts(&parts, |part| part.dissipation(a, w));
    assert!((law.dissipation(a, w) / lost - 1.0).abs() < 1e-15);
    assert!((law.damping_ratio(a) / (lost / (2.0 * PI * (w * a).powi(2))) - 1.0).abs() < 1e-14);
    assert!((law.decay_rate(a) / (w * law.damping_ratio(a)) - 1.0).abs() < 1e-14);
    // Without parts, the values are those of the joint's closed forms.
    let bare = ModalLaw::new(oscillator, Some(&joint), &[]);
    assert_eq!(bare.frequency(a), (oscillator.k_inf() + joint.harmonic_stiffness(a)).sqrt());
}

#[test]
fn parameters_out_of_range_are_named() {
    let said = |error: iwan_core::Error| error.to_string();
    assert!(said(PowerDamping::new(-1.0, 2.0).unwrap_err()).contains("c = -1"));
    assert!(said(PowerDamping::new(1.0, 0.0).unwrap_err()).contains("Coulomb"));
    assert!(said(PowerDamping::new(1.0, f64::NAN).unwrap_err()).contains("n = NaN"));
    assert!(said(Coulomb::new(f64::INFINITY).unwrap_err()).contains("force = inf"));
    assert!(said(PowerSpring::new(1.0, 1.0).unwrap_err()).contains("exponent = 1"));
    assert!(said(PowerSpring::new(f64::NAN, 3.0).unwrap_err()).contains("k = NaN"));
    assert!(said(Pinning::new(-1.0, 1.0).unwrap_err()).contains("k = -1"));
    assert!(said(Pinning::new(1.0, 0.0).unwrap_err()).contains("gap = 0"));
}
