//! The joints of a structure in motion: laws, memories, forces.

use iwan_core::{
    Backbone, Continuum, Grid, Hysteresis, Reversal, Reversals, Run, Runs, Slider, Sliders, Straight, Trial,
};

use crate::error::Error;
use crate::structure::Law;

/// How the joints' laws are evaluated in time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Population {
    /// Cut into Jenkins elements on a grid; K_T and F_S stay exact.
    Sliders {
        /// Number of bins.
        bins: usize,
        /// The grid.
        grid: Grid,
    },
    /// The law itself by Masing's rule.
    Continuum,
}

impl Population {
    /// Sliders in `bins` geometric bins from 1e-6 φ_max: resolves joints that slip little beside others that slip much.
    #[must_use]
    pub fn graded(bins: usize) -> Self {
        let steps = bins.saturating_sub(1).max(1) as f64;
        Self::Sliders { bins, grid: Grid::Geometric { ratio: 1e6_f64.powf(1.0 / steps) } }
    }
}

impl Default for Population {
    /// 100 graded sliders.
    fn default() -> Self {
        Self::graded(100)
    }
}

/// Reversals that a joint in the continuum remembers before it begins to forget the smallest loops.
const REVERSALS: usize = 4096;

type SharedLaw = dyn Backbone + Send + Sync;

/// One joint law and its state.
enum Kernel<'t> {
    /// No law: the displacement alone.
    Free(f64),
    Sliders(Sliders<'t>, Runs<Vec<Run>>),
    Continuum(Continuum<&'t SharedLaw>, Box<Reversals<Vec<Reversal>>>),
}

/// Runs `$body` with the law and the state of a kernel that has one.
macro_rules! with_kernel {
    ($kernel:expr, free $u:ident => $free:expr, $law:ident, $state:ident => $body:expr) => {
        match $kernel {
            Kernel::Free($u) => $free,
            Kernel::Sliders($law, $state) => $body,
            Kernel::Continuum($law, $state) => $body,
        }
    };
}

/// A joint: law and state, where it stands, and the straight piece it moves on. The state itself is moved only
/// where that piece ends.
struct Joint<'t> {
    kernel: Kernel<'t>,
    slip: f64,
    piece: Straight,
}

/// A piece on which nothing lies.
const NO_PIECE: Straight =
    Straight { anchor: f64::NAN, base: f64::NAN, stiffness: f64::NAN, direction: f64::NAN, end: f64::NAN };

impl Joint<'_> {
    /// Whether motion from where the joint stands to `s` stays on the straight piece.
    #[inline]
    fn is_straight(&self, s: f64) -> bool {
        let Straight { direction, end, .. } = self.piece;
        direction * (s - self.slip) >= 0.0 && direction * (end - s) >= 0.0
    }

    #[inline]
    fn on_piece(&self, s: f64) -> f64 {
        self.piece.base + self.piece.stiffness * (s - self.piece.anchor)
    }

    /// Lets the state catch up with the slip.
    fn catch_up(&mut self) {
        let slip = self.slip;
        with_kernel!(&mut self.kernel, free u => *u = slip, law, state => { law.advance(state, slip); });
    }

    /// Moves the state to `s`; returns the force there.
    fn find_force(&mut self, s: f64) -> f64 {
        let force =
            with_kernel!(&mut self.kernel, free u => { *u = s; 0.0 }, law, state => law.advance(state, s));
        self.find_piece();
        force
    }

    fn find_piece(&mut self) {
        self.piece = match &self.kernel {
            Kernel::Sliders(law, state) => law.straight(state),
            _ => NO_PIECE,
        };
    }
}

/// The joints of a structure, one per slip.
pub(crate) struct Joints<'t> {
    joints: Vec<Joint<'t>>,
}

/// Memory for the sliders' tables, which the joints borrow.
pub(crate) fn tables(slips: usize, population: Population) -> Vec<Vec<Slider>> {
    let room = match population {
        Population::Sliders { bins, .. } => Sliders::table_len(bins),
        Population::Continuum => 0,
    };
    vec![vec![Slider::default(); room]; slips]
}

impl<'t> Joints<'t> {
    /// Virgin joints with the given laws; `tables` come from [`tables`].
    pub(crate) fn new(
        laws: impl Iterator<Item = Option<&'t Law>>,
        population: Population,
        tables: &'t mut [Vec<Slider>],
    ) -> Result<Self, Error> {
        let kernel = |(law, table): (Option<&'t Law>, &'t mut Vec<Slider>)| -> Result<_, Error> {
            let Some(law) = law else { return Ok(Kernel::Free(0.0)) };
            let law: &'t SharedLaw = law.as_ref();
            Ok(match population {
                Population::Sliders { bins, grid } => {
                    let sliders = Sliders::discretise(law, grid, bins, table)?;
                    let state = sliders.virgin(vec![Run::default(); sliders.len()])?;
                    Kernel::Sliders(sliders, state)
                }
                Population::Continuum => {
                    let continuum = Continuum::new(law);
                    let state = continuum.virgin(vec![Reversal::default(); REVERSALS])?;
                    Kernel::Continuum(continuum, Box::new(state))
                }
            })
        };
        let joint = |given| -> Result<_, Error> {
            let mut joint = Joint { kernel: kernel(given)?, slip: 0.0, piece: NO_PIECE };
            joint.find_piece();
            Ok(joint)
        };
        Ok(Self { joints: laws.zip(tables).map(joint).collect::<Result<_, _>>()? })
    }

    /// Number of joints.
    pub(crate) fn len(&self) -> usize {
        self.joints.len()
    }

    /// Force and tangent of joint `i` at the slip `s`, which stays a trial.
    #[inline]
    pub(crate) fn trial(&mut self, i: usize, s: f64) -> (f64, f64) {
        let joint = &mut self.joints[i];
        if joint.is_straight(s) {
            return (joint.on_piece(s), joint.piece.stiffness);
        }
        joint.catch_up();
        with_kernel!(&joint.kernel, free _u => (0.0, 0.0), law, state => law.trial(state, s))
    }

    /// Moves joint `i` to the slip `s`; returns its force.
    #[inline]
    pub(crate) fn advance(&mut self, i: usize, s: f64) -> f64 {
        let joint = &mut self.joints[i];
        if joint.is_straight(s) {
            joint.slip = s;
            return joint.on_piece(s);
        }
        joint.catch_up();
        joint.slip = s;
        joint.find_force(s)
    }

    /// Elastic energy in the springs of all joints.
    pub(crate) fn stored_energy(&mut self) -> f64 {
        let energy = |joint: &mut Joint<'_>| {
            joint.catch_up();
            with_kernel!(&joint.kernel, free _u => 0.0, law, state => law.stored_energy(state))
        };
        self.joints.iter_mut().map(energy).sum()
    }

    /// Largest bound on a joint's force error from forgotten loops; 0 = exact.
    pub(crate) fn forgotten(&self) -> f64 {
        let forgotten = |joint: &Joint<'_>| match &joint.kernel {
            Kernel::Continuum(_, state) => state.forgotten(),
            _ => 0.0,
        };
        self.joints.iter().map(forgotten).fold(0.0, f64::max)
    }
}
