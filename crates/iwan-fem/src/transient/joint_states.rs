//! The joints of a moving structure: their laws, memories and forces.

use iwan_core::{
    Backbone, Continuum, Hysteresis, Reversal, Reversals, Run, Runs, Slider, Sliders, Straight, Trial,
};

use crate::error::Error;
use crate::structure::Law;
use iwan_core::Representation;

/// Number of reversals that a joint in the continuum remembers before it forgets its smallest loops. In a ring-down each half cycle lies
/// inside the one before, and both stay open, so this suffices for 2,000 cycles. `StructureResponse::forgotten_force` bounds the force
/// error of forgetting.
const REVERSALS: usize = 4096;

type SharedLaw = dyn Backbone + Send + Sync;

/// One joint law and its state.
enum Kernel<'t> {
    /// No law and therefore no force.
    Free,
    Sliders(Sliders<'t>, Runs<Vec<Run>>),
    Continuum(Continuum<&'t SharedLaw>, Box<Reversals<Vec<Reversal>>>),
}

/// A joint: its law and state, its slip, and two straight pieces of its force. `piece` is the one on which the joint moves, and it begins
/// at the joint's slip; `ahead` is the one on which the last trial ended. The state itself is moved only when a trial leaves both pieces.
struct JointState<'t> {
    kernel: Kernel<'t>,
    /// Slip of a joint on sliders; other states store their own slip.
    slip: f64,
    piece: Straight,
    ahead: Straight,
}

/// A piece that contains no slip.
const NO_PIECE: Straight = Straight {
    anchor: f64::NAN,
    base: f64::NAN,
    stiffness: f64::NAN,
    direction: f64::NAN,
    start: f64::NAN,
    end: f64::NAN,
};

impl<'t> JointState<'t> {
    fn new(kernel: Kernel<'t>) -> Self {
        let piece = match &kernel {
            Kernel::Sliders(law, state) => law.straight(state),
            _ => NO_PIECE,
        };
        Self { kernel, slip: 0.0, piece, ahead: NO_PIECE }
    }

    /// Moves the state of sliders to the joint's slip; other states are always up to date.
    fn catch_up(&mut self) {
        if let Kernel::Sliders(law, state) = &mut self.kernel {
            law.advance(state, self.slip);
        }
    }

    /// Force and tangent at the slip `s`, which lies on neither of the two pieces.
    fn look_ahead(&mut self, s: f64) -> (f64, f64) {
        self.catch_up();
        match &self.kernel {
            Kernel::Free => (0.0, 0.0),
            Kernel::Sliders(law, state) => {
                self.ahead = law.straight_ahead(state, s);
                (self.ahead.force(s), self.ahead.stiffness)
            }
            Kernel::Continuum(law, state) => law.trial(state, s),
        }
    }

    /// Moves the joint to the slip `s`, which lies off `piece`; returns the force at `s`.
    fn leave_piece(&mut self, s: f64) -> f64 {
        match &mut self.kernel {
            Kernel::Free => 0.0,
            Kernel::Continuum(law, state) => law.advance(state, s),
            Kernel::Sliders(..) => {
                if !self.ahead.holds(s) {
                    self.look_ahead(s);
                } else if self.ahead.direction != self.piece.direction {
                    // The motion turns round at the joint's slip, so the state must be moved there first.
                    self.catch_up();
                }
                self.slip = s;
                self.piece = Straight { start: s, ..std::mem::replace(&mut self.ahead, NO_PIECE) };
                self.piece.force(s)
            }
        }
    }
}

/// The joints of a structure, one for each slip.
pub(crate) struct Joints<'t> {
    joints: Vec<JointState<'t>>,
}

/// Memory for the sliders' tables, which the joints borrow.
pub(crate) fn tables(slips: usize, representation: Representation) -> Vec<Vec<Slider>> {
    let room = match representation {
        Representation::Sliders { bins, .. } => Sliders::table_len(bins),
        Representation::Continuum => 0,
    };
    vec![vec![Slider::default(); room]; slips]
}

impl<'t> Joints<'t> {
    /// Virgin joints with the given laws; `tables` must come from the function [`tables`].
    pub(crate) fn new(
        laws: impl Iterator<Item = Option<&'t Law>>,
        representation: Representation,
        tables: &'t mut [Vec<Slider>],
    ) -> Result<Self, Error> {
        let kernel = |(law, table): (Option<&'t Law>, &'t mut Vec<Slider>)| -> Result<_, Error> {
            let Some(law) = law else { return Ok(Kernel::Free) };
            let law: &'t SharedLaw = law.as_ref();
            Ok(match representation {
                Representation::Sliders { bins, grid } => {
                    let sliders = Sliders::discretise(law, grid, bins, table)?;
                    let state = sliders.virgin(vec![Run::default(); sliders.len()])?;
                    Kernel::Sliders(sliders, state)
                }
                Representation::Continuum => {
                    let continuum = Continuum::new(law);
                    let state = continuum.virgin(vec![Reversal::default(); REVERSALS])?;
                    Kernel::Continuum(continuum, Box::new(state))
                }
            })
        };
        let joints = laws.zip(tables).map(|given| kernel(given).map(JointState::new));
        Ok(Self { joints: joints.collect::<Result<_, _>>()? })
    }

    /// Number of joints.
    pub(crate) fn len(&self) -> usize {
        self.joints.len()
    }

    /// Force and tangent of joint `i` at the slip `s`, without moving the joint.
    #[inline]
    pub(crate) fn trial(&mut self, i: usize, s: f64) -> (f64, f64) {
        let joint = &mut self.joints[i];
        for piece in [&joint.piece, &joint.ahead] {
            if piece.holds(s) {
                return (piece.force(s), piece.stiffness);
            }
        }
        joint.look_ahead(s)
    }

    /// Moves joint `i` to the slip `s`; returns its force.
    #[inline]
    pub(crate) fn advance(&mut self, i: usize, s: f64) -> f64 {
        let joint = &mut self.joints[i];
        if !joint.piece.holds(s) {
            return joint.leave_piece(s);
        }
        if joint.ahead.direction != joint.piece.direction && s != joint.slip {
            // A trial from before this motion that turned round no longer lies ahead.
            joint.ahead = NO_PIECE;
        }
        (joint.slip, joint.piece.start) = (s, s);
        joint.piece.force(s)
    }

    /// Passes every number of the joints' states to `see`.
    pub(crate) fn each_number(&mut self, see: &mut dyn FnMut(&mut f64)) {
        for joint in &mut self.joints {
            match &mut joint.kernel {
                Kernel::Free => {}
                Kernel::Sliders(_, state) => state.each_number(see),
                Kernel::Continuum(_, state) => state.each_number(see),
            }
            see(&mut joint.slip);
            joint.piece.each_number(see);
            joint.ahead.each_number(see);
        }
    }

    /// Elastic energy in the springs of all joints.
    pub(crate) fn stored_energy(&mut self) -> f64 {
        let energy = |joint: &mut JointState<'_>| {
            joint.catch_up();
            match &joint.kernel {
                Kernel::Free => 0.0,
                Kernel::Sliders(law, state) => law.stored_energy(state),
                Kernel::Continuum(law, state) => law.stored_energy(state),
            }
        };
        self.joints.iter_mut().map(energy).sum()
    }

    /// Largest bound on a joint's force error from forgotten loops; 0 means exact.
    pub(crate) fn forgotten(&self) -> f64 {
        let forgotten = |joint: &JointState<'_>| match &joint.kernel {
            Kernel::Continuum(_, state) => state.forgotten(),
            _ => 0.0,
        };
        self.joints.iter().map(forgotten).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use iwan_core::FourParameter;

    use super::*;
    use crate::algebra::random;

    /// With stored pieces, states that lag behind and trials that turn round, the force must equal that of the plain state.
    #[test]
    fn forces_do_not_depend_on_the_trials_before() {
        let law: Law = Arc::new(FourParameter::new(2.75e5, 300.0, -0.3, 0.02).unwrap());
        let phi_max = law.strengths().1;
        for representation in [
            Representation::DEFAULT_IN_A_STRUCTURE,
            Representation::in_a_structure(7),
            Representation::Continuum,
        ] {
            let (mut memory, mut plain_memory) = (tables(1, representation), tables(1, representation));
            let mut joints = Joints::new([Some(&law)].into_iter(), representation, &mut memory).unwrap();
            let mut plain = Joints::new([Some(&law)].into_iter(), representation, &mut plain_memory).unwrap();
            let mut slip = 0.0;
            for seed in 0..4000 {
                let r = random(8, seed);
                // Steps range from far below the weakest slider's strength to beyond the strongest.
                let size = |x: f64| phi_max * 10.0_f64.powf(3.5 * x - 3.0);
                for trial in 0..3 {
                    let at = slip + r[2 * trial] * size(r[2 * trial + 1]);
                    let (force, tangent) = joints.trial(0, at);
                    // Evaluates anew from a state that is always up to date.
                    plain.joints[0].ahead = NO_PIECE;
                    plain.joints[0].piece = NO_PIECE;
                    let (expected, slope) = plain.trial(0, at);
                    assert!(
                        (force - expected).abs() < 1e-11 * 300.0,
                        "{representation:?} {seed}: {force} {expected}"
                    );
                    assert!(
                        (tangent - slope).abs() <= 1e-11 * 2.75e5,
                        "{representation:?} {seed}: {tangent} {slope}"
                    );
                    if r[7] > 0.5 && trial == 2 {
                        slip = at;
                    }
                }
                if r[7] <= 0.5 {
                    slip += r[6] * size(r[7]);
                }
                plain.joints[0].piece = NO_PIECE;
                plain.joints[0].ahead = NO_PIECE;
                let (force, expected) = (joints.advance(0, slip), plain.advance(0, slip));
                plain.joints[0].catch_up();
                assert!(
                    (force - expected).abs() < 1e-11 * 300.0,
                    "{representation:?} {seed}: {force} {expected}"
                );
            }
            let (stored, expected) = (joints.stored_energy(), plain.stored_energy());
            assert!(
                (stored - expected).abs() < 1e-11 * 300.0 * phi_max,
                "{representation:?}: {stored} {expected}"
            );
        }
    }
}
