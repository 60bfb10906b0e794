//! Where searches begin.

use iwan_core::SplitMix64;

use super::unknowns::{Form, Sharing, Values};
use crate::parameters::Parameters;

/// Joints drawn at random for each mode, of which the likeliest join the starts. What a mode shows by itself of a joint that others move too can be off by
/// ten in K_T and ninety in F_S: then no start next to it leads to the joint.
const DRAWN: usize = 1000;
/// Where they are drawn from, evenly in the logarithm: K_T over ω² of the first mode, F_S over the force K_T s of a joint that sticks in the largest slip s,
/// participations over ω_r/ω_1; and evenly, χ and compliance times K_T. Joints of structures take some hundredths of a mode's stiffness; ten times the force is far
/// from macro-slip, a hundredth of it far beyond.
const DRAWN_SHARE: (f64, f64) = (0.003, 0.5);
const DRAWN_FORCE: (f64, f64) = (0.01, 10.0);
const DRAWN_PARTICIPATION: (f64, f64) = (0.1, 10.0);
const DRAWN_CHI: (f64, f64) = (-0.8, 0.0);
const DRAWN_COMPLIANCE: (f64, f64) = (0.0, 0.4);
/// β of all of them: no blow tells it before the rest is told.
const DRAWN_BETA: f64 = 0.1;
/// Seed of the draws: any gives joints all over the same ranges.
const SEED: u64 = 16;

/// Factors on K_T and F_S: a knee that was not seen can be mistaken by two either way.
const FACTORS: [[f64; 2]; 5] = [[1.0, 1.0], [1.0, 2.0], [2.0, 1.0], [0.5, 1.0], [1.0, 0.5]];
/// Factors on K_T and on F_S of a shared joint, all with all: what the modes show of it by themselves is the shared joint's only as long as one of them
/// moves, and a knee that was not seen can be mistaken by four.
const SHARED_K_T: [f64; 5] = [0.5, 0.7, 1.0, 1.4, 2.0];
const SHARED_F_S: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];
/// Damping ratios of linear modes beside the one given.
const DAMPING: [f64; 3] = [5e-4, 2e-3, 8e-3];
/// Compliance times K_T to start with: three modes of the paper's beam have 0.29.
const COMPLIANCE: f64 = 0.2;
/// More modes than this do not have all combinations of signs tried, but each sign by itself.
const ALL_SIGNS: usize = 4;
/// Participation of the other modes in a joint of several, over that of its own: no search leaves 0, where signs are alike.
const CROSS: f64 = 0.1;

/// Starts of linear modes.
pub(super) fn linear(form: &Form, modes: &[Parameters]) -> Vec<Vec<f64>> {
    let one = |damping: &f64| {
        let damped = modes.iter().map(|m| Parameters { damping_ratio: *damping, ..*m }).collect::<Vec<_>>();
        form.start(&damped, &[], &[], 0.0)
    };
    DAMPING.iter().map(one).collect()
}

/// Starts of modes with a joint each.
pub(super) fn uncoupled(form: &Form, modes: &[Parameters]) -> Vec<Vec<f64>> {
    let one = |[k, f]: &[f64; 2]| {
        let laws: Vec<[f64; 4]> = modes.iter().map(|m| [k * m.k_t, f * m.f_s, m.chi, m.beta]).collect();
        form.start(modes, &laws, &form.reference.participation, 0.0)
    };
    FACTORS.iter().map(one).collect()
}

/// Parameters of the modes by themselves, as found.
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

/// Starts of modes that share joints. What a mode shows of a joint by itself is K_T,r ≈ b_r² K_T/(1 - ρ_r K_T), so |b_r| = √(K_T,r/K_T,1);
/// signs do not show.
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

/// Numbers between bounds, from a stream that is the same in every run.
struct Draws(SplitMix64);

impl Draws {
    fn evenly(&mut self, (low, high): (f64, f64)) -> f64 {
        low + (high - low) * 0.5 * (self.0.next_symmetric() + 1.0)
    }

    fn by_size(&mut self, (low, high): (f64, f64)) -> f64 {
        self.evenly((low.ln(), high.ln())).exp()
    }
}

/// Joints from all over what is plausible: of modes that share one joint, or of modes with a joint each; `largest` are the amplitudes of the modes.
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

/// Starts of as many joints as modes, each with a mode of its own and some of the others.
fn several(form: &Form, modes: &[Parameters], joints: usize) -> Vec<Vec<f64>> {
    let laws: Vec<[f64; 4]> = modes[..joints].iter().map(|m| [m.k_t, m.f_s, m.chi, m.beta]).collect();
    let one = |sign: &f64| {
        let cross = |j: usize, r: usize| if r == j { 1.0 } else { sign * CROSS };
        let b: Vec<Vec<f64>> = (0..joints).map(|j| (0..modes.len()).map(|r| cross(j, r)).collect()).collect();
        form.start(modes, &laws, &b, 0.0)
    };
    [1.0, -1.0].iter().map(one).collect()
}

/// Signs of all modes, that of the first +1.
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
