//! Start values of the searches.

use iwan_core::SplitMix64;

use super::unknowns::{Form, Sharing, Values};
use crate::parameters::Parameters;

/// Number of random starts for each mode, of which the likeliest join the others. What a mode by itself shows of a joint that others move as well can be off by a factor of
/// ten in K_T and ninety in F_S: then no start near it leads to the joint.
const DRAWN: usize = 1000;
/// Ranges of the random starts. Evenly in the logarithm: K_T over ω² of the first mode (this range); F_S over the force K_T s of a joint that sticks at the largest slip s;
/// participations over ω_r/ω_1. Evenly: χ, and compliance times K_T. Joints of structures take some hundredths of a mode's stiffness; ten times the force K_T s is far
/// from macro-slip, a hundredth of it far beyond.
const DRAWN_SHARE: (f64, f64) = (0.003, 0.5);
const DRAWN_FORCE: (f64, f64) = (0.01, 10.0);
const DRAWN_PARTICIPATION: (f64, f64) = (0.1, 10.0);
const DRAWN_CHI: (f64, f64) = (-0.8, 0.0);
const DRAWN_COMPLIANCE: (f64, f64) = (0.0, 0.4);
/// β of all random starts: no blow tells it before the other parameters are known.
const DRAWN_BETA: f64 = 0.1;
/// Seed of the random numbers: any seed gives joints all over the same ranges.
const SEED: u64 = 16;

/// Factors on K_T and F_S of a mode's own joint: a knee that the records did not reach can be mistaken by a factor of two either way.
const FACTORS: [[f64; 2]; 5] = [[1.0, 1.0], [1.0, 2.0], [2.0, 1.0], [0.5, 1.0], [1.0, 0.5]];
/// Factors on K_T and on F_S of a shared joint, in all combinations: what the modes show of it by themselves holds for the shared joint only as long as one of them
/// moves, and a knee that the records did not reach can be mistaken by a factor of four.
const SHARED_K_T: [f64; 5] = [0.5, 0.7, 1.0, 1.4, 2.0];
const SHARED_F_S: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];
/// Damping ratios from which searches of linear modes start.
const DAMPING: [f64; 3] = [5e-4, 2e-3, 8e-3];
/// Compliance times K_T at the start: three modes of the paper's beam have 0.29.
const COMPLIANCE: f64 = 0.2;
/// Up to this number of modes all combinations of signs are tried; with more, each sign is turned by itself.
const ALL_SIGNS: usize = 4;
/// Participation of the other modes in one of several joints, over that of its own mode: no search leaves 0, where both signs are alike.
const CROSS: f64 = 0.1;

/// Starts for linear modes, as coordinates.
pub(super) fn linear(form: &Form, modes: &[Parameters]) -> Vec<Vec<f64>> {
    let one = |damping: &f64| {
        let damped = modes.iter().map(|m| Parameters { damping_ratio: *damping, ..*m }).collect::<Vec<_>>();
        form.start(&damped, &[], &[], 0.0)
    };
    DAMPING.iter().map(one).collect()
}

/// Starts for modes with a joint each, as coordinates.
pub(super) fn uncoupled(form: &Form, modes: &[Parameters]) -> Vec<Vec<f64>> {
    let one = |[k, f]: &[f64; 2]| {
        let laws: Vec<[f64; 4]> = modes.iter().map(|m| [k * m.k_t, f * m.f_s, m.chi, m.beta]).collect();
        form.start(modes, &laws, &form.reference.participation, 0.0)
    };
    FACTORS.iter().map(one).collect()
}

/// Parameters of the modes with joints of their own, as the search found them.
pub(super) fn by_themselves(values: &Values) -> Vec<Parameters> {
    let one = |(r, law): (usize, &iwan_core::FourParameter)| Parameters {
        frequency: values.frequency[r],
        damping_ratio: values.damping_ratio[r],
        k_t: law.k_t(),
        f_s: law.f_s(),
        chi: law.chi(),
        beta: law.beta(),
    };
    values.laws.iter().enumerate().map(one).collect()
}

/// Starts for modes that share joints. What mode r shows of a joint by itself is K_T,r ≈ b_r² K_T/(1 - ρ_r K_T), so |b_r| = √(K_T,r/K_T,1);
/// the signs of b do not show in it.
pub(super) fn shared(form: &Form, modes: &[Parameters]) -> Vec<Vec<f64>> {
    if let Sharing::Shared(joints) = form.sharing
        && joints > 1
    {
        return several(form, modes, joints);
    }
    let first = modes[0];
    let size = |m: &Parameters| (m.k_t / first.k_t).sqrt();
    let mut starts = Vec::new();
    for signs in signs(modes.len()) {
        let b: Vec<f64> = modes.iter().zip(&signs).map(|(m, sign)| sign * size(m)).collect();
        for (k, f) in SHARED_K_T.iter().flat_map(|k| SHARED_F_S.map(|f| (k, f))) {
            let law = [k * first.k_t * (1.0 - COMPLIANCE), f * first.f_s, first.chi, first.beta.min(1.0)];
            starts.push(form.start(modes, &[law], std::slice::from_ref(&b), COMPLIANCE));
        }
    }
    starts
}

/// Random numbers between bounds, the same in every run.
struct Draws(SplitMix64);

impl Draws {
    fn evenly(&mut self, (low, high): (f64, f64)) -> f64 {
        low + (high - low) * 0.5 * (self.0.next_symmetric() + 1.0)
    }

    fn by_size(&mut self, (low, high): (f64, f64)) -> f64 {
        self.evenly((low.ln(), high.ln())).exp()
    }
}

/// Random joints from the whole plausible range: one that all modes share, or one for each mode; `largest` are the amplitudes of the modes.
pub(super) fn drawn(form: &Form, modes: &[Parameters], largest: &[f64]) -> Vec<Vec<f64>> {
    let mut draws = Draws(SplitMix64::new(SEED));
    let omega: Vec<f64> = modes.iter().map(|m| std::f64::consts::TAU * m.frequency).collect();
    let law = |omega: f64, slip: f64, draws: &mut Draws| {
        let k_t = draws.by_size(DRAWN_SHARE) * omega * omega;
        [k_t, draws.by_size(DRAWN_FORCE) * k_t * slip, draws.evenly(DRAWN_CHI), DRAWN_BETA]
    };
    let alone = |draws: &mut Draws| {
        let laws: Vec<[f64; 4]> =
            omega.iter().zip(largest).map(|(omega, q)| law(*omega, *q, draws)).collect();
        form.start(modes, &laws, &form.reference.participation, 0.0)
    };
    let together = |draws: &mut Draws| {
        let mut b = vec![1.0];
        for omega_r in &omega[1..] {
            let sign = draws.evenly((-1.0, 1.0)).signum();
            b.push(sign * draws.by_size(DRAWN_PARTICIPATION) * omega_r / omega[0]);
        }
        let slip = b.iter().zip(largest).map(|(b, q)| b.abs() * q).sum();
        let law = law(omega[0], slip, draws);
        form.start(modes, &[law], &[b], draws.evenly(DRAWN_COMPLIANCE))
    };
    let shared = matches!(form.sharing, Sharing::Shared(_));
    (0..DRAWN * modes.len()).map(|_| if shared { together(&mut draws) } else { alone(&mut draws) }).collect()
}

/// Starts for several joints, each of which belongs to one mode and is moved a little by the others.
fn several(form: &Form, modes: &[Parameters], joints: usize) -> Vec<Vec<f64>> {
    let laws: Vec<[f64; 4]> = modes[..joints].iter().map(|m| [m.k_t, m.f_s, m.chi, m.beta]).collect();
    let one = |sign: &f64| {
        let cross = |j: usize, r: usize| if r == j { 1.0 } else { sign * CROSS };
        let b: Vec<Vec<f64>> = (0..joints).map(|j| (0..modes.len()).map(|r| cross(j, r)).collect()).collect();
        form.start(modes, &laws, &b, 0.0)
    };
    [1.0, -1.0].iter().map(one).collect()
}

/// Combinations of signs of all modes, that of the first +1.
fn signs(modes: usize) -> Vec<Vec<f64>> {
    let others = modes - 1;
    let of = |bits: usize| {
        let bit = |r: usize| if (bits >> r) & 1 == 1 { -1.0 } else { 1.0 };
        std::iter::once(1.0).chain((0..others).map(bit)).collect()
    };
    if modes <= ALL_SIGNS {
        (0..1 << others).map(of).collect()
    } else {
        std::iter::once(0).chain((0..others).map(|r| 1 << r)).map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::signs;

    #[test]
    fn all_signs_are_tried_for_a_few_modes() {
        assert_eq!(signs(2), [[1.0, 1.0], [1.0, -1.0]]);
        assert_eq!((signs(4).len(), signs(5).len()), (8, 5));
        assert!(signs(7).iter().all(|s| s[0] == 1.0 && s.len() == 7));
    }
}
