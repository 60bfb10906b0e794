//! The force that a population under run-length memory would have at another displacement, without moving the state.

use super::state::{Run, Runs};
use super::straight::{Segment, Straight};
use crate::memory::hysteresis::Trial;
use crate::memory::sliders::{Slider, Sliders};

/// The state's runs as they would be after a motion: a topmost run, and the runs of the state's list below index `below`.
struct View {
    direction: f64,
    frontier: usize,
    run: Run,
    below: usize,
}

impl View {
    fn travel(&self) -> f64 {
        1.0 - self.run.sign * self.direction
    }

    fn segment(&self, table: &[Slider]) -> Segment {
        let (next, run) = (&table[self.frontier], &self.run);
        let base = (self.direction - run.sign) * next.slip_force_below
            + (run.sign * table[run.end].slip_force_below + run.carried);
        Segment {
            anchor: run.anchor,
            base,
            stiffness: next.stiffness_from,
            reach: self.travel() * next.strength,
        }
    }
}

impl<S: AsRef<[Run]> + AsMut<[Run]>> Runs<S> {
    /// The runs as they would be after a reversal if `reverse` holds, otherwise as they are.
    fn view(&self, table: &[Slider], reverse: bool) -> View {
        let (run, frontier) = (*self.run(), self.frontier);
        if !reverse {
            return View { direction: self.direction, frontier, run, below: self.top };
        }
        if frontier == 0 {
            return View { direction: -self.direction, frontier, run, below: self.top };
        }
        let segment = self.segment(table);
        let carried = segment.base + segment.stiffness * (self.u - segment.anchor)
            - self.direction * table[frontier].slip_force_below;
        let below = if run.end > frontier { self.top + 1 } else { self.top };
        let turned = Run { end: frontier, sign: self.direction, anchor: self.u, carried };
        View { direction: -self.direction, frontier: 0, run: turned, below }
    }
}

impl Sliders<'_> {
    /// The straight piece on which a monotone motion of `state` to the displacement `u` would end.
    ///
    /// ```
    /// use iwan_core::{Run, Slider, Sliders};
    /// let mut table = [Slider::default(); 3];
    /// let sliders = Sliders::from_elements(&[0.1, 0.3], &[2.0, 1.0], &mut table)?;
    /// let state = sliders.virgin([Run::default(); 2])?;
    /// let piece = sliders.straight_ahead(&state, 0.2);
    /// assert_eq!((piece.stiffness, piece.direction, piece.start, piece.end), (1.0, 1.0, 0.1, 0.3));
    /// assert_eq!(piece.force(0.2), 0.4);
    /// # Ok::<(), iwan_core::Error>(())
    /// ```
    #[must_use]
    pub fn straight_ahead<S: AsRef<[Run]> + AsMut<[Run]>>(&self, state: &Runs<S>, u: f64) -> Straight {
        let table = self.table();
        let mut view = state.view(table, (u - state.u) * state.direction < 0.0);
        let mut start = state.u;
        loop {
            let segment = view.segment(table);
            let end = view.run.end;
            let way = view.direction * (u - segment.anchor);
            if view.frontier == self.len() || way <= segment.reach {
                return segment.towards(view.direction, start);
            }
            let travel = view.travel();
            let slips = |slider: &Slider| way > travel * slider.strength;
            view.frontier += 1 + table[view.frontier + 1..end].iter().take_while(|s| slips(s)).count();
            start = segment.anchor + view.direction * travel * table[view.frontier - 1].strength;
            if view.frontier < end {
                continue;
            }
            view.frontier = end;
            if view.below == 0 {
                view.run = Run { end: self.len(), anchor: u, ..Run::default() };
            } else {
                view.below -= 1;
                view.run = state.list.as_ref()[view.below];
            }
        }
    }
}

impl<S: AsRef<[Run]> + AsMut<[Run]>> Trial<Runs<S>> for Sliders<'_> {
    fn trial(&self, state: &Runs<S>, u: f64) -> (f64, f64) {
        let piece = self.straight_ahead(state, u);
        (piece.force(u), piece.stiffness)
    }
}
