//! Energy balance of coupled modes.

use super::lanes::{LANES, Lanes, groups};
use super::modes::CoupledModes;
use super::stepper::CoupledRows;
use crate::error::{Error, check_length};
use crate::step::{EnergyBalance, JointEnergy, force_at};

/// Works along a coupled motion, summed over its rows.
///
/// Each stuck mode holds ½ q'² + ½ ω² q². A joint holds the energy of its springs less the ½ K s² that is already part of the stuck modes.
/// The modes left out hold ½ Nᵀ ρ N - f aᵀ N. The load does work through φ q of all modes and through -aᵀ N.
#[derive(Debug, Clone)]
pub struct CoupledEnergy<S> {
    /// Works by mode: of the load, on the dampers (`viscous`), and on the joints (`handed`).
    input: S,
    viscous: S,
    handed: S,
    /// Work of the load through the modes left out, and work ∫ F ds on all joints.
    aside: f64,
    joint: f64,
    /// Kinetic and elastic energy by mode, and elastic energy of everything else (`rest`), each at the start and at the end.
    kinetic: [S; 2],
    elastic: [S; 2],
    rest: [f64; 2],
    begun: bool,
}

impl<S: AsRef<[Lanes]> + AsMut<[Lanes]>> CoupledEnergy<S> {
    /// The balance before any motion; `storage` must return room for the requested number of groups.
    ///
    /// # Errors
    /// [`Error::Length`] for too little room.
    pub fn new(modes: &CoupledModes<S>, storage: impl Fn(usize) -> S) -> Result<Self, Error> {
        let room = || -> Result<S, Error> {
            let (needed, mut room) = (groups(modes.modes()), storage(groups(modes.modes())));
            let found = room.as_ref().len();
            if found < needed {
                return Err(Error::Length { name: "storage", needed, found });
            }
            room.as_mut().as_flattened_mut().fill(0.0);
            Ok(room)
        };
        Ok(Self {
            input: room()?,
            viscous: room()?,
            handed: room()?,
            aside: 0.0,
            joint: 0.0,
            kinetic: [room()?, room()?],
            elastic: [room()?, room()?],
            rest: [0.0; 2],
            begun: false,
        })
    }

    /// Adds the works from the first to the last row of `rows`; `force[0]` is the load at the first row. If a motion is given in several
    /// stretches, each stretch begins with the last row of the one before.
    ///
    /// # Errors
    /// [`Error::Length`] when the rows disagree.
    pub fn add(
        &mut self,
        modes: &CoupledModes<S>,
        force: &[f64],
        rows: &CoupledRows<'_>,
    ) -> Result<(), Error> {
        let samples = rows.checked_len(modes)?;
        check_length("storage", self.input.as_ref().len(), modes.step.as_ref().len())?;
        if !self.begun {
            self.hold(modes, 0, (force_at(force, 0), 0, rows));
            self.begun = true;
        }
        for n in 1..samples {
            self.step(modes, [force_at(force, n - 1), force_at(force, n)], (n, rows));
        }
        self.hold(modes, 1, (force_at(force, samples - 1), samples - 1, rows));
        Ok(())
    }

    /// Adds the works of the step that ends at sample `n`; each work is a mean force times an increment.
    fn step(&mut self, modes: &CoupledModes<S>, [before, p]: [f64; 2], (n, rows): (usize, &CoupledRows<'_>)) {
        let (width, j, mean) = (groups(modes.modes()), modes.joints(), 0.5 * (before + p));
        let missing = |n: usize, i: usize, k: f64| rows.joint_force[n * j + i] - k * rows.slip[n * j + i];
        for (i, (k, a)) in modes.joint_stiffness().iter().zip(modes.slip_at_force()).enumerate() {
            let (from, to) = ((n - 1) * j + i, n * j + i);
            let way = rows.slip[to] - rows.slip[from];
            self.joint += 0.5 * (rows.joint_force[from] + rows.joint_force[to]) * way;
            self.aside -= mean * a * (missing(n, i, *k) - missing(n - 1, i, *k));
        }
        for g in 0..width {
            let (from, to) = ((n - 1) * width + g, n * width + g);
            let mut held = [0.0; LANES];
            for (i, k) in modes.joint_stiffness().iter().enumerate() {
                let (b, force) = (
                    modes.participation.as_ref()[i * width + g],
                    0.5 * (missing(n - 1, i, *k) + missing(n, i, *k)),
                );
                (0..LANES).for_each(|l| held[l] += b[l] * force);
            }
            let (drive, viscous) = (modes.drive.as_ref()[g], modes.viscous.as_ref()[g]);
            for l in 0..LANES {
                let way = rows.displacement[to][l] - rows.displacement[from][l];
                let rate = 0.5 * (rows.velocity[from][l] + rows.velocity[to][l]);
                self.input.as_mut()[g][l] += drive[l] * mean * way;
                self.viscous.as_mut()[g][l] += viscous[l] * rate * way;
                self.handed.as_mut()[g][l] += held[l] * way;
            }
        }
    }

    /// Records the energies at sample `n` as those of the start (`end` = 0) or of the end (`end` = 1).
    fn hold(&mut self, modes: &CoupledModes<S>, end: usize, (p, n, rows): (f64, usize, &CoupledRows<'_>)) {
        let (width, j) = (groups(modes.modes()), modes.joints());
        for g in 0..width {
            let (q, v) = (rows.displacement[n * width + g], rows.velocity[n * width + g]);
            for l in 0..LANES {
                self.kinetic[end].as_mut()[g][l] = 0.5 * v[l] * v[l];
                self.elastic[end].as_mut()[g][l] = 0.5 * modes.stiffness.as_ref()[g][l] * q[l] * q[l];
            }
        }
        let (slips, forces) = (&rows.slip[n * j..(n + 1) * j], &rows.joint_force[n * j..(n + 1) * j]);
        let stiffness = modes.joint_stiffness();
        let missing = |i: usize| forces[i] - stiffness[i] * slips[i];
        self.rest[end] = (0..j)
            .map(|i| {
                let row = &modes.compliance()[i * j..(i + 1) * j];
                let aside: f64 = row.iter().enumerate().map(|(l, rho)| rho * missing(l)).sum();
                let of_modes_left_out = missing(i) * (0.5 * aside - p * modes.slip_at_force()[i]);
                of_modes_left_out - 0.5 * stiffness[i] * slips[i] * slips[i]
            })
            .sum();
    }

    /// The balance of all modes and joints together; `stored` is the energy of the joints' springs at the start and at the end.
    #[must_use]
    pub fn balance(&self, stored: JointEnergy) -> EnergyBalance {
        let sum = |row: &S| row.as_ref().as_flattened().iter().sum::<f64>();
        let kinetic = [sum(&self.kinetic[0]), sum(&self.kinetic[1])];
        let elastic = [sum(&self.elastic[0]) + self.rest[0], sum(&self.elastic[1]) + self.rest[1]];
        let works = [sum(&self.input) + self.aside, sum(&self.viscous), self.joint];
        closed(kinetic, elastic, stored, works)
    }

    /// The balance of one mode. Its `friction` is the work of the mode on the joints, which pass part of that work on to other modes.
    #[must_use]
    pub fn of_mode(&self, index: usize) -> EnergyBalance {
        let at = |row: &S| row.as_ref().as_flattened()[index];
        let kinetic = [at(&self.kinetic[0]), at(&self.kinetic[1])];
        let elastic = [at(&self.elastic[0]), at(&self.elastic[1])];
        let works = [at(&self.input), at(&self.viscous), at(&self.handed)];
        closed(kinetic, elastic, JointEnergy::default(), works)
    }
}

fn closed(
    kinetic: [f64; 2],
    elastic: [f64; 2],
    stored: JointEnergy,
    [input, viscous, joint]: [f64; 3],
) -> EnergyBalance {
    let initial = kinetic[0] + elastic[0] + stored.start;
    let gained = (kinetic[1] - kinetic[0]) + (elastic[1] - elastic[0]);
    EnergyBalance {
        initial,
        input,
        kinetic: kinetic[1],
        elastic: elastic[1],
        stored: stored.end,
        viscous,
        friction: joint - (stored.end - stored.start),
        residual: input - gained - viscous - joint,
        scale: initial.abs().max(input.abs()).max(kinetic[1]),
    }
}
