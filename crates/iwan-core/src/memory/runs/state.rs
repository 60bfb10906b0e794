//! The list of runs: how a motion changes it, and the force that it represents.

use super::straight::{Segment, Straight};
use crate::error::{Error, check_length};
use crate::law::check_masing;
use crate::memory::hysteresis::Hysteresis;
use crate::memory::sliders::{Slider, Sliders};

/// A run: sliders that last slipped together, from the frontier (or from the end of the run above it on the list) to `end`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Run {
    /// Index one past the run's last slider.
    pub(super) end: usize,
    /// Direction in which the sliders slipped last, ±1; 0 if they never slipped.
    pub(super) sign: f64,
    /// Displacement at which they stopped slipping and stuck.
    pub(super) anchor: f64,
    /// Force of all older runs at `anchor`.
    pub(super) carried: f64,
}

/// The state of a population under run-length memory.
///
/// `S` holds the runs: an array makes the state `Copy`, a slice or vector lends the caller's memory. One entry per slider always suffices,
/// because the runs' ranges are disjoint and not empty.
///
/// ```
/// use iwan_core::{Hysteresis, Run, Slider, Sliders};
/// let mut table = [Slider::default(); 3];
/// let sliders = Sliders::from_elements(&[0.1, 0.3], &[2.0, 1.0], &mut table)?;
/// let mut state = sliders.virgin([Run::default(); 2])?;
/// assert!((sliders.advance(&mut state, 0.2) - 0.4).abs() < 1e-15); // the first slips, the second holds
/// let snapshot = state;
/// assert!((sliders.advance(&mut state, 5.0) - 0.5).abs() < 1e-15); // both slip
/// assert!((sliders.joint_force(&snapshot) - 0.4).abs() < 1e-15);
/// # Ok::<(), iwan_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Runs<S> {
    pub(super) u: f64,
    pub(super) direction: f64,
    pub(super) frontier: usize,
    /// Index of the topmost run.
    pub(super) top: usize,
    /// Number of sliders that the last search passed. The next search looks there first, because motions are smooth; what it finds does not
    /// depend on it.
    pub(super) passed: usize,
    pub(super) list: S,
}

impl Sliders<'_> {
    /// The virgin state. `runs` has at least one entry per slider.
    ///
    /// # Errors
    /// [`Error::Length`]; [`Error::Unsupported`] where friction drops once a slider slips.
    pub fn virgin<S: AsMut<[Run]>>(&self, mut runs: S) -> Result<Runs<S>, Error> {
        check_masing(self)?;
        let slice = runs.as_mut();
        if slice.len() < self.len() {
            check_length("runs", slice.len(), self.len())?;
        }
        slice[0] = self.untouched();
        Ok(Runs { u: 0.0, direction: 1.0, frontier: 0, top: 0, passed: 1, list: runs })
    }

    /// The straight piece of F(u) on which the next motion of `state` begins.
    ///
    /// ```
    /// use iwan_core::{Hysteresis, Run, Slider, Sliders};
    /// let mut table = [Slider::default(); 3];
    /// let sliders = Sliders::from_elements(&[0.1, 0.3], &[2.0, 1.0], &mut table)?;
    /// let mut state = sliders.virgin([Run::default(); 2])?;
    /// sliders.advance(&mut state, 0.2);
    /// let piece = sliders.straight(&state);
    /// assert_eq!((piece.stiffness, piece.direction, piece.end), (1.0, 1.0, 0.3));
    /// # Ok::<(), iwan_core::Error>(())
    /// ```
    #[must_use]
    pub fn straight<S: AsRef<[Run]> + AsMut<[Run]>>(&self, state: &Runs<S>) -> Straight {
        state.segment(self.table()).towards(state.direction, state.u)
    }

    fn untouched(&self) -> Run {
        Run { end: self.len(), ..Run::default() }
    }
}

impl<S: AsRef<[Run]> + AsMut<[Run]>> Runs<S> {
    /// Passes every number of the state to `see`. A `see` that copies the numbers saves the state; a `see` that overwrites them restores a
    /// saved one. The order of the numbers depends only on numbers passed before. Indices are passed as whole numbers, and restored ones
    /// are limited to the length of the list.
    ///
    /// ```
    /// use iwan_core::{Hysteresis, Run, Slider, Sliders};
    /// let mut table = [Slider::default(); 3];
    /// let sliders = Sliders::from_elements(&[0.1, 0.3], &[2.0, 1.0], &mut table)?;
    /// let (mut state, mut other) = (sliders.virgin([Run::default(); 2])?, sliders.virgin([Run::default(); 2])?);
    /// [0.2, -0.05, 0.15].map(|u| sliders.advance(&mut state, u));
    /// let mut numbers = vec![];
    /// state.each_number(&mut |x| numbers.push(*x));
    /// let mut written = numbers.into_iter();
    /// other.each_number(&mut |x| *x = written.next().unwrap());
    /// assert_eq!(sliders.advance(&mut other, 0.4), sliders.advance(&mut state, 0.4));
    /// # Ok::<(), iwan_core::Error>(())
    /// ```
    pub fn each_number(&mut self, see: &mut dyn FnMut(&mut f64)) {
        let room = self.list.as_ref().len();
        let place = |at: &mut usize, most: usize, see: &mut dyn FnMut(&mut f64)| {
            let mut number = *at as f64;
            see(&mut number);
            *at = (number as usize).min(most);
        };
        see(&mut self.u);
        see(&mut self.direction);
        place(&mut self.frontier, room, see);
        place(&mut self.top, room.saturating_sub(1), see);
        place(&mut self.passed, room, see);
        for run in &mut self.list.as_mut()[..=self.top] {
            place(&mut run.end, room, see);
            [&mut run.sign, &mut run.anchor, &mut run.carried].into_iter().for_each(&mut *see);
        }
    }

    #[inline]
    pub(super) fn run(&self) -> &Run {
        &self.list.as_ref()[self.top]
    }

    /// Direction of motion, ±1.
    #[inline]
    pub(crate) fn direction(&self) -> f64 {
        self.direction
    }

    /// Sets the displacement, which must lie on the present straight piece.
    #[inline]
    pub(crate) fn rest_at(&mut self, u: f64) {
        self.u = u;
    }

    /// Distance, in units of its strength, that a slider of the topmost run moves from the run's anchor until it slips: 2 if the run last
    /// slipped in the other direction, 1 if it is virgin, 0 if it last slipped in this direction and only returns to its limit.
    #[inline]
    fn travel(&self) -> f64 {
        1.0 - self.run().sign * self.direction
    }

    #[inline]
    pub(crate) fn segment(&self, table: &[Slider]) -> Segment {
        self.segment_at(table, self.frontier)
    }

    /// The segment after `breaks` more sliders of the topmost run have slipped; none if fewer than that are left and one behind them.
    #[inline]
    pub(crate) fn segment_after(&self, table: &[Slider], breaks: usize) -> Option<Segment> {
        let j = self.frontier + breaks;
        (j < self.run().end && self.travel() > 0.0).then(|| self.segment_at(table, j))
    }

    /// Lets the next `breaks` sliders of the topmost run slip.
    #[inline]
    pub(crate) fn pass(&mut self, breaks: usize) {
        self.frontier += breaks;
    }

    /// The segment with the frontier at slider `j` of the topmost run.
    #[inline]
    fn segment_at(&self, table: &[Slider], j: usize) -> Segment {
        let run = self.run();
        let next = &table[j];
        let base = (self.direction - run.sign) * next.slip_force_below
            + (run.sign * table[run.end].slip_force_below + run.carried);
        let reach = self.travel() * next.strength;
        Segment { anchor: run.anchor, base, stiffness: next.stiffness_from, reach }
    }

    /// Reverses the direction of motion: the sliders that were slipping become a run.
    pub(crate) fn reverse(&mut self, table: &[Slider]) {
        let j = self.frontier;
        if j > 0 {
            let run = *self.run();
            let carried = run.sign * (table[run.end].slip_force_below - table[j].slip_force_below)
                + run.carried
                + (self.u - run.anchor) * table[j].stiffness_from;
            if run.end > j {
                self.top += 1;
            }
            self.list.as_mut()[self.top] = Run { end: j, sign: self.direction, anchor: self.u, carried };
            self.frontier = 0;
        }
        self.direction = -self.direction;
    }

    /// Moves the frontier past all sliders for which `slips` holds; `slips` is given the segment that ends where the slider breaks loose.
    #[inline]
    pub(crate) fn pass_breaks(&mut self, table: &[Slider], slips: impl Fn(&Segment) -> bool) {
        while self.frontier + 1 < table.len() && slips(&self.segment(table)) {
            let end = self.run().end;
            let stuck = if self.travel() == 0.0 {
                end
            } else {
                let stuck = self.first_stuck(table, end, &slips);
                self.passed = stuck - self.frontier;
                stuck
            };
            self.frontier = stuck;
            if stuck < end {
                break;
            }
            self.exhaust(table.len() - 1);
        }
    }

    /// The slider at the frontier begins to slip, or the whole run if it only returns to its limit.
    pub(crate) fn break_loose(&mut self, table: &[Slider]) {
        let end = self.run().end;
        self.frontier = if self.travel() == 0.0 { end } else { self.frontier + 1 };
        if self.frontier == end {
            self.exhaust(table.len() - 1);
        }
    }

    /// First slider behind the frontier, up to `end`, that does not slip; the slider at the frontier does slip. The search begins where the last
    /// one ended and doubles its stride away from there, so that sliders are bracketed in a few tests whether few slip or hundreds.
    fn first_stuck(&self, table: &[Slider], end: usize, slips: &impl Fn(&Segment) -> bool) -> usize {
        let slips_at = |j: usize| slips(&self.segment_at(table, j));
        // Invariants: `low` slips; `high` does not, or is the end.
        let (mut low, mut high, mut step) = (self.frontier, end, 1);
        let guess = low + self.passed;
        if guess < end && !slips_at(guess) {
            high = guess;
            while low + step < high {
                let at = high - step;
                if slips_at(at) {
                    low = at;
                    break;
                }
                (high, step) = (at, 2 * step);
            }
        } else {
            if guess < end {
                low = guess;
            }
            while low + step < high {
                let at = low + step;
                if !slips_at(at) {
                    high = at;
                    break;
                }
                (low, step) = (at, 2 * step);
            }
        }
        while high - low > 1 {
            let middle = low + (high - low) / 2;
            if slips_at(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        high
    }

    /// Drops the topmost run after its last slider has slipped.
    fn exhaust(&mut self, sliders: usize) {
        if self.top > 0 {
            self.top -= 1;
        } else {
            // All sliders slip. An empty virgin run stands for the absence of stuck sliders.
            self.list.as_mut()[0] = Run { end: sliders, anchor: self.u, ..Run::default() };
        }
    }

    /// Prepares the implicit step with stiffness·(u' - u) + F(u') - F(u) = `load`: reverses the direction and passes breaks as needed, so
    /// that u' lies on the present segment. Returns F(u).
    ///
    /// The equation is monotone and piecewise linear, so the sign of `load` gives the direction before anything is solved, and no iteration
    /// is needed.
    #[inline]
    pub(crate) fn aim(&mut self, table: &[Slider], stiffness: f64, load: f64) -> f64 {
        if load * self.direction < 0.0 {
            self.reverse(table);
        }
        let (u, force, direction) = (self.u, self.force_in(table), self.direction);
        // A slider slips if `load` exceeds the load that brings the displacement to the end of its segment.
        self.pass_breaks(table, |s| {
            let x = direction * s.reach;
            let needed = stiffness * (x - (u - s.anchor)) + (s.base + s.stiffness * x - force);
            direction * load > direction * needed
        });
        force
    }

    /// Displacement at which the state stands.
    #[inline]
    pub(crate) fn displacement(&self) -> f64 {
        self.u
    }

    #[inline]
    fn force_in(&self, table: &[Slider]) -> f64 {
        let segment = self.segment(table);
        segment.base + (self.u - segment.anchor) * segment.stiffness
    }
}

impl<S: AsRef<[Run]> + AsMut<[Run]>> Hysteresis<Runs<S>> for Sliders<'_> {
    fn displacement(&self, state: &Runs<S>) -> f64 {
        state.u
    }

    #[inline]
    fn joint_force(&self, state: &Runs<S>) -> f64 {
        state.force_in(self.table())
    }

    #[inline]
    fn advance(&self, state: &mut Runs<S>, u: f64) -> f64 {
        let table = self.table();
        let du = u - state.u;
        if du * state.direction < 0.0 && du.is_finite() {
            state.reverse(table);
        }
        if du != 0.0 && du.is_finite() {
            let direction = state.direction;
            state.pass_breaks(table, |s| direction * (u - s.anchor) > s.reach);
            state.u = u;
        }
        state.force_in(table)
    }

    fn solve(&self, state: &mut Runs<S>, stiffness: f64, load: f64) -> f64 {
        if !load.is_finite() {
            return f64::NAN;
        }
        let table = self.table();
        let force = state.aim(table, stiffness, load);
        let s = state.segment(table);
        let du = (load - s.gap(state.u, force)) / (stiffness + s.stiffness);
        state.u += du;
        du
    }

    fn stored_energy(&self, state: &Runs<S>) -> f64 {
        let mut run = state.top;
        let runs = state.list.as_ref();
        let energy = |(i, (phi, k)): (usize, (f64, f64))| {
            let extension = if i < state.frontier {
                phi
            } else {
                while i >= runs[run].end {
                    run -= 1;
                }
                runs[run].sign * phi + (state.u - runs[run].anchor)
            };
            0.5 * k * extension * extension
        };
        self.elements().enumerate().map(energy).sum()
    }
}
