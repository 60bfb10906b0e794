//! Coefficients of steady loops against the return-point memory, against each other, and their derivatives.

#![allow(clippy::unwrap_used, reason = "a failed test may panic and say why")]

use std::f64::consts::{PI, TAU};

use iwan_core::quadrature::Rule;
use iwan_core::{
    Backbone, Continuum, DensityPoint, FourParameter, Harmonics, Hysteresis, Jenkins, Reversal, SplitMix64,
    SteadyWork, TabledFourParameter, Tabulated, Uniform, one_harmonic, steady_force,
};

fn mode_1() -> FourParameter {
    FourParameter::new(4.45e4, 239.4, -0.183, 0.3).unwrap()
}

/// u(θ) from its coefficients over all harmonics.
fn at(x: &[f64], theta: f64) -> f64 {
    let pairs = x[1..].chunks(2).enumerate();
    x[0] + pairs
        .map(|(i, c)| {
            let n = (i + 1) as f64;
            c[0] * (n * theta).cos() + c[1] * (n * theta).sin()
        })
        .sum::<f64>()
}

/// Angles in (low, high), sampled densely, at which `f` changes its sign.
fn crossings(low: f64, high: f64, f: impl Fn(f64) -> f64) -> Vec<f64> {
    let count = 4000;
    let grid = |i: usize| low + (high - low) * i as f64 / f64::from(count);
    let mut found = Vec::new();
    for i in 0..count as usize {
        let (mut a, mut b) = (grid(i), grid(i + 1));
        if (f(a) > 0.0) == (f(b) > 0.0) {
            continue;
        }
        let rising = f(b) > f(a);
        for _ in 0..60 {
            let middle = 0.5 * (a + b);
            if (f(middle) > 0.0) == rising { b = middle } else { a = middle }
        }
        found.push(0.5 * (a + b));
    }
    found
}

/// Coefficients of the force by the direct way: the return-point memory is led through a period, over the nodes of Gauss rules between all
/// angles at which a loop might close or the law has a corner.
fn plain<B: Backbone>(law: &B, x: &[f64]) -> Vec<f64> {
    const RULE: Rule<16> = Rule::gauss_legendre();
    let slope = |theta: f64| (at(x, theta + 1e-6) - at(x, theta - 1e-6)) / 2e-6;
    let turns = crossings(0.0123, 0.0123 + TAU, slope);
    let heights: Vec<f64> = turns.iter().map(|&t| at(x, t)).collect();
    let first = (0..turns.len()).max_by(|&i, &j| heights[i].abs().total_cmp(&heights[j].abs())).unwrap();
    let (start, end) = (turns[first], turns[first] + TAU);
    let mut ends = vec![start, end];
    let (weakest, strongest) = law.strengths();
    for height in &heights {
        for shift in [0.0, 2.0 * weakest, 2.0 * strongest] {
            for sign in [-1.0, 1.0] {
                ends.extend(crossings(start, end, |t| at(x, t) - height - sign * shift));
            }
        }
    }
    ends.extend(turns.iter().map(|&t| if t < start { t + TAU } else { t }));
    ends.sort_by(f64::total_cmp);
    let joint = Continuum::new(law);
    let mut state = joint.virgin(vec![Reversal::default(); 256]).unwrap();
    joint.advance(&mut state, at(x, start));
    let mut force = vec![0.0; x.len()];
    for pair in ends.windows(2) {
        // Nodes are dense at both ends: s -> s^4 on the first half, mirrored on the second.
        let span = 0.5 * (pair[1] - pair[0]);
        for half in 0..2 {
            for panel in 0..12 {
                for (node, weight) in RULE.nodes.iter().zip(&RULE.weights) {
                    let s = (f64::from(panel) + 0.5 * (1.0 + node)) / 12.0;
                    let s = if half == 0 { s } else { 1.0 - s };
                    let way = span * s.powi(4);
                    let theta = if half == 0 { pair[0] + way } else { pair[1] - way };
                    let f = joint.advance(&mut state, at(x, theta));
                    let w = weight / 24.0 * span * 4.0 * s.powi(3) * f;
                    force[0] += w / TAU;
                    for (i, c) in force[1..].chunks_mut(2).enumerate() {
                        let angle = (i + 1) as f64 * theta;
                        c[0] += w * angle.cos() / PI;
                        c[1] += w * angle.sin() / PI;
                    }
                }
            }
        }
    }
    force
}

fn force<B: Backbone>(law: &B, harmonics: Harmonics, x: &[f64]) -> Vec<f64> {
    let (mut force, mut work) = (vec![0.0; x.len()], Box::new(SteadyWork::new()));
    steady_force(law, harmonics, x, &mut force, None, &mut work).unwrap();
    force
}

fn jacobian<B: Backbone>(law: &B, harmonics: Harmonics, x: &[f64]) -> Vec<f64> {
    let (mut force, mut work) = (vec![0.0; x.len()], Box::new(SteadyWork::new()));
    let mut jacobian = vec![0.0; x.len() * x.len()];
    steady_force(law, harmonics, x, &mut force, Some(&mut jacobian), &mut work).unwrap();
    jacobian
}

/// Motions of seven harmonics, with (size of the fundamental, size of the others) in units of φ_max. The last motions turn round up to
/// eight times in a period.
fn motions(phi: f64, odd: bool) -> Vec<Vec<f64>> {
    let mut random = SplitMix64::new(20_260_101);
    let sizes = [(0.3, 0.01), (0.6, 0.1), (1.7, 0.2), (0.5, 0.15), (1.2, 0.5), (6.0, 0.3), (0.2, 0.2)];
    let mut motion = |(first, rest): (f64, f64)| {
        let mut x = vec![0.0; 15];
        for n in 0..=7 {
            let size = if n == 1 { first } else { rest / (1.0 + n as f64) };
            for part in 0..=usize::from(n > 0) {
                let value = size * phi * random.next_symmetric();
                if !(odd && n % 2 == 0) {
                    x[if n == 0 { 0 } else { 2 * n - 1 + part }] = value;
                }
            }
        }
        x[1] += first * phi;
        x
    };
    sizes.iter().flat_map(|&size| [motion(size), motion(size)]).collect()
}

fn odd_part(x: &[f64]) -> Vec<f64> {
    (1..=7).step_by(2).flat_map(|n| [x[2 * n - 1], x[2 * n]]).collect()
}

fn check<B: Backbone>(law: &B, tolerance: f64) {
    let phi = law.strengths().1;
    let all = Harmonics::all(7).unwrap();
    for (index, x) in motions(phi, false).iter().enumerate() {
        let (found, exact) = (force(law, all, x), plain(law, x));
        for (i, (a, b)) in found.iter().zip(&exact).enumerate() {
            let error = (a - b).abs() / law.slip_force();
            assert!(error < tolerance, "motion {index}, coefficient {i}: {a} {b}, {error:e}");
        }
    }
}

#[test]
fn several_harmonics_are_what_the_memory_does() {
    for (chi, beta) in [(-0.95, 0.0), (-0.5, 0.02), (-0.183, 0.3), (-0.02, 5.0), (0.7, 0.5)] {
        check(&FourParameter::new(4.45e4, 239.4, chi, beta).unwrap(), 1e-10);
    }
    check(&TabledFourParameter::new(mode_1()), 1e-10);
    check(&Jenkins::new(4.45e4, 239.4).unwrap(), 1e-10);
    check(&Uniform::new(1e3, 5.0, 0.4).unwrap(), 1e-10);
    // Corners inside the table's density are found by halving intervals.
    let points = vec![DensityPoint::default(); 3];
    let table = Tabulated::new(&[0.0, 0.002, 0.01], &[1e5, 3e5, 2e5], 70.0, points).unwrap();
    check(&table, 1e-8);
}

#[test]
fn motions_of_the_test_turn_round_often() {
    let most = motions(1.0, false)
        .iter()
        .map(|x| crossings(0.0123, 0.0123 + TAU, |t| at(x, t + 1e-6) - at(x, t - 1e-6)).len())
        .max();
    assert!(most >= Some(8), "{most:?}");
}

#[test]
fn odd_harmonics_alone_are_the_same_at_half_the_work() {
    let joint = mode_1();
    for x in motions(joint.phi_max(), true) {
        let odd = odd_part(&x);
        let whole = force(&joint, Harmonics::all(7).unwrap(), &x);
        let half = force(&joint, Harmonics::odd(7).unwrap(), &odd);
        for (a, b) in odd_part(&whole).iter().zip(&half) {
            assert!((a - b).abs() < 1e-11 * 239.4, "{a} {b}");
        }
        assert!(whole[0].abs() < 1e-11 * 239.4 && whole[3].abs() < 1e-11 * 239.4, "{whole:?}");
    }
}

#[test]
fn one_harmonic_is_the_limit_of_several() {
    for (chi, beta) in [(-0.95, 0.0), (-0.183, 0.3), (0.5, 1.0)] {
        let joint = FourParameter::new(4.45e4, 239.4, chi, beta).unwrap();
        for ratio in [1e-6, 1e-3, 0.1, 0.6, 0.999, 1.0, 1.001, 1.5, 10.0, 1e4] {
            let a = ratio * joint.phi_max();
            let (mut cosine, mut sine) = ([0.0; 4], [0.0; 4]);
            one_harmonic(&joint, a, &mut cosine, &mut sine).unwrap();
            let mut x = [0.0; 8];
            x[0] = a;
            let found = force(&joint, Harmonics::odd(7).unwrap(), &x);
            let scale = joint.force(a);
            for i in 0..4 {
                assert!(
                    (found[2 * i] - cosine[i]).abs() < 1e-12 * scale.max(1e-3 * joint.k_t() * a),
                    "{chi} {ratio} {i}"
                );
                assert!(
                    (found[2 * i + 1] - sine[i]).abs() < 1e-12 * scale,
                    "{chi} {ratio} {i} {} {}",
                    found[2 * i + 1],
                    sine[i]
                );
            }
            let stiffness = joint.harmonic_stiffness(a);
            assert!(
                (cosine[0] / a / stiffness - 1.0).abs() < 1e-11,
                "{chi} {ratio} {} {stiffness}",
                cosine[0] / a
            );
            let lost = joint.dissipation(a);
            assert!(
                (-PI * a * sine[0] / lost - 1.0).abs() < 1e-12,
                "{chi} {ratio} {} {lost}",
                -PI * a * sine[0]
            );
        }
    }
}

/// Compares the derivatives with central differences, which are good to about 1e-9 of K_T.
fn check_jacobian<B: Backbone>(law: &B, harmonics: Harmonics, x: &[f64]) {
    let (count, k_t) = (x.len(), law.initial_stiffness());
    let found = jacobian(law, harmonics, x);
    let size = x.iter().fold(0.0, |most: f64, c| most.max(c.abs()));
    let h = 1e-6 * size;
    for j in 0..count {
        let shifted = |h: f64| {
            let mut y = x.to_vec();
            y[j] += h;
            force(law, harmonics, &y)
        };
        let (up, down) = (shifted(h), shifted(-h));
        for i in 0..count {
            let difference = (up[i] - down[i]) / (2.0 * h);
            let error = (found[i * count + j] - difference).abs() / k_t;
            assert!(error < 1e-7, "entry {i}, {j}: {} {difference}, {error:e}", found[i * count + j]);
        }
    }
}

#[test]
fn derivatives_are_those_of_the_force() {
    for (chi, beta) in [(-0.95, 0.0), (-0.5, 0.02), (-0.183, 0.3), (-0.02, 5.0)] {
        let joint = FourParameter::new(4.45e4, 239.4, chi, beta).unwrap();
        for x in motions(joint.phi_max(), false) {
            check_jacobian(&joint, Harmonics::all(7).unwrap(), &x);
        }
        for x in motions(joint.phi_max(), true) {
            check_jacobian(&joint, Harmonics::odd(7).unwrap(), &odd_part(&x));
        }
    }
}

#[test]
fn a_loop_is_born_at_zero_size() {
    // From c = 1/9 on, u = cos θ + c cos 3θ turns round twice more in each period; force and derivatives do not jump there.
    let joint = mode_1();
    let motion = |c: f64| {
        let mut x = vec![0.0; 8];
        (x[0], x[2]) = (0.5 * joint.phi_max(), 0.5 * joint.phi_max() * c);
        x
    };
    let odd = Harmonics::odd(7).unwrap();
    let (before, after) = (motion(-1.0 / 9.0 + 1e-9), motion(-1.0 / 9.0 - 1e-9));
    for (a, b) in force(&joint, odd, &before).iter().zip(force(&joint, odd, &after)) {
        assert!((a - b).abs() < 1e-6, "{a} {b}");
    }
    for (a, b) in jacobian(&joint, odd, &before).iter().zip(jacobian(&joint, odd, &after)) {
        assert!((a - b).abs() < 1e-3 * joint.k_t(), "{a} {b}");
    }
}

#[test]
fn phase_does_not_matter() {
    // A shift of the origin of θ turns each coefficient by its own angle, also where a loop crosses the end of the period or changes its
    // sign.
    let joint = mode_1();
    let odd = Harmonics::odd(3).unwrap();
    let a = 0.8 * joint.phi_max();
    let straight = force(&joint, odd, &[a, 0.0, 0.2 * a, 0.1 * a]);
    for i in 0..32 {
        let shift = f64::from(i) * TAU / 32.0;
        let turn = |c: &[f64]| -> Vec<f64> {
            let turned = |n: f64, re: f64, im: f64| {
                let (s, c) = (n * shift).sin_cos();
                [re * c - im * s, re * s + im * c]
            };
            [turned(1.0, c[0], c[1]), turned(3.0, c[2], c[3])].concat()
        };
        let found = force(&joint, odd, &turn(&[a, 0.0, 0.2 * a, 0.1 * a]));
        for (a, b) in found.iter().zip(turn(&straight)) {
            assert!((a - b).abs() < 1e-11, "{i}: {a} {b}");
        }
    }
}

#[test]
fn rest_and_bad_input() {
    let joint = mode_1();
    let odd = Harmonics::odd(3).unwrap();
    assert_eq!(force(&joint, odd, &[0.0; 4]), [0.0; 4]);
    let tangent = jacobian(&joint, odd, &[0.0; 4]);
    assert!((0..16).all(|i| tangent[i] == if i % 5 == 0 { 4.45e4 } else { 0.0 }));
    let mean = force(&joint, Harmonics::all(1).unwrap(), &[1e-3, 0.0, 0.0]);
    assert_eq!(mean, [joint.force(1e-3), 0.0, 0.0]);
    let (mut out, mut work) = ([0.0; 4], Box::new(SteadyWork::new()));
    let error = steady_force(&joint, odd, &[0.0, f64::NAN, 0.0, 0.0], &mut out, None, &mut work).unwrap_err();
    assert!(error.to_string().contains("displacement[1]"), "{error}");
    assert!(steady_force(&joint, odd, &[0.0; 3], &mut out, None, &mut work).is_err());
    assert!(Harmonics::odd(4).is_err() && Harmonics::odd(33).is_err() && Harmonics::all(0).is_err());
    let error = one_harmonic(&joint, f64::NAN, &mut [0.0], &mut [0.0]).unwrap_err();
    assert!(error.to_string().contains("amplitude"), "{error}");
}
