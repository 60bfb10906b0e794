//! Closed forms against arithmetic of 40 digits.
//!
//! Source of the numbers: mpmath with mp.dps = 40, rounded to 16 digits, for Table 1 and the three modes of Table 2
//! of Deaner et al. With c = (χ+1)/(χ+2) and x = min(u, φ_max), φ_max = F_S (1+β)/(K_T (β+c)), R = F_S
//! (χ+1)/(φ_max^(χ+2) (β+c)), S = F_S β/(φ_max (β+c)), F = x [K_T - R x^(χ+1)/((χ+1)(χ+2))] below φ_max and F_S
//! beyond, D = 4 R x^(χ+3)/((χ+2)(χ+3)) below φ_max and 4 F_S u - 4 [R φ_max^(χ+3)/(χ+3) + S φ_max²] beyond.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a failed test may panic and say why")]

use iwan_core::{Backbone, FourParameter};

const TABLE_1: [f64; 4] = [2.75e5, 300.0, -0.3, 0.02];
const MODE_1: [f64; 4] = [4.45e4, 239.4, -0.183, 0.3];
const MODE_2: [f64; 4] = [2.0e4, 1.0e5, -0.999, 3.0];
const MODE_3: [f64; 4] = [8.73e5, 534.6, -0.048, 0.38];

fn joint([k_t, f_s, chi, beta]: [f64; 4]) -> FourParameter {
    FourParameter::new(k_t, f_s, chi, beta).unwrap()
}

fn close(found: f64, exact: f64) {
    assert!((found / exact - 1.0).abs() < 1e-12, "{found} is not {exact}");
}

#[test]
fn density_parameters() {
    // φ_max, R, S and D(φ_max).
    let golden = [
        (TABLE_1, 0.002577161258360168, 12247048.73944549, 5392.156862745098, 1.092348096186569),
        (MODE_1, 0.009329393723670242, 1274290.571068603, 10269.23076923077, 1.902233281315488),
        (MODE_2, 6.664447403462051, 4.990525053618572, 15000.0, 443.4831454753349),
        (MODE_3, 0.0009739165324363437, 443301714.5175033, 240391.3043478261, 0.3965330649073753),
    ];
    for (set, phi_max, r, s, dissipation) in golden {
        let joint = joint(set);
        close(joint.phi_max(), phi_max);
        close(joint.r(), r);
        close(joint.s(), s);
        close(joint.dissipation(phi_max * (1.0 - 1e-16)), dissipation);
        close(joint.dissipation(joint.phi_max()), dissipation);
        let back = FourParameter::from_density(r, set[2], phi_max, s).unwrap();
        close(back.k_t(), set[0]);
        close(back.f_s(), set[1]);
        close(back.beta(), set[3]);
    }
}

#[test]
fn force_and_dissipation() {
    // u/φ_max, F and D.
    let golden = [
        (TABLE_1, 0.01, 6.924479358084402, 4.348716098323343e-6),
        (TABLE_1, 0.5, 228.5615381459554, 0.1681047820060061),
        (TABLE_1, 2.0, 300.0, 4.184941606218771),
        (TABLE_1, 10.0, 300.0, 28.92568968647639),
        (MODE_1, 0.01, 4.110756244839007, 4.418387237766604e-6),
        (MODE_1, 0.5, 157.6970341285941, 0.2699369136316001),
        (MODE_1, 2.0, 239.4, 10.83606071110211),
        (MODE_1, 10.0, 239.4, 82.3066801493951),
        (MODE_2, 0.01, 1001.529488231849, 0.04414455255102437),
        (MODE_2, 0.5, 50011.53307272882, 110.7939632238047),
        (MODE_2, 2.0, 100000.0, 2666222.444530296),
        (MODE_2, 10.0, 100000.0, 23992454.13560886),
        (MODE_3, 0.01, 8.462920270480217, 4.946288080176868e-7),
        (MODE_3, 0.5, 343.5377917181062, 0.0512435088049817),
        (MODE_3, 2.0, 534.6, 2.479156177869253),
        (MODE_3, 10.0, 534.6, 19.14014108156427),
    ];
    for (set, ratio, force, dissipation) in golden {
        let joint = joint(set);
        let u = ratio * joint.phi_max();
        close(joint.force(u), force);
        close(joint.force(-u), -force);
        close(joint.dissipation(u), dissipation);
        close(joint.dissipation(-u), dissipation);
    }
}

#[test]
fn first_harmonic_factor() {
    // g of K_1 = K_T - g R u^(χ+1) / ((χ+1)(χ+2)), that is (4/π) [2 I(2χ+6) - I(2χ+4)] with I(a) = √π Γ((a+1)/2) /
    // Γ(a/2 + 1), to six decimals: exactly 1 at χ = 0 and in the limit χ = -1.
    for (chi, g, digits) in
        [(0.0, 1.0, 1e-12), (-0.5, 1.018592, 5e-7), (-0.183, 1.008898, 5e-7), (-1.0 + 1e-9, 1.0, 1e-8)]
    {
        let joint = FourParameter::new(2.0, 3.0, chi, 0.4).unwrap();
        let u = 0.3 * joint.phi_max();
        let softening = joint.k_t() - joint.secant(u);
        assert!(((joint.k_t() - joint.harmonic_stiffness(u)) / softening - g).abs() < digits, "chi {chi}");
    }
}

#[test]
fn printed_eq_17_is_an_asymptote() {
    // Its overshoot 4 u F_S / D(u) at the onset of macro-slip and at 10 φ_max, with D from the tests above: for Table 1 it is
    // 4 · 0.0025771613 · 300 / 1.0923481 = 2.831 and 10 · 4 · 0.0025771613 · 300 / 28.925690 = 1.069.
    for (set, onset, far) in [(TABLE_1, 2.83, 0.069), (MODE_1, 4.70, 0.085), (MODE_3, 5.25, 0.088)] {
        let joint = joint(set);
        let overshoot = |u| joint.dissipation_printed_eq17(u) / joint.dissipation(u);
        assert!(
            (overshoot(joint.phi_max()) - onset).abs() < 0.005,
            "{set:?}: {}",
            overshoot(joint.phi_max())
        );
        assert!(
            (overshoot(10.0 * joint.phi_max()) - 1.0 - far).abs() < 0.005,
            "{set:?}: {}",
            overshoot(10.0 * joint.phi_max())
        );
    }
}
