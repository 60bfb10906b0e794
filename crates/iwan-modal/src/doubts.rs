//! What a fit itself casts doubt on: channels, missing modes, and modes that are probably not modes.

use crate::analysis::ModalFit;
use crate::modes::{Mode, Sideband, Sidebands, mac, sidebands};
use crate::number::median;

/// A channel is doubted from this fraction of modes on whose drive point moves against its force: single modes with a node there may do so by noise.
const DOUBTFUL: f64 = 0.34;

/// Neighbouring modes are parts of one where they are nearer than this many times the sum of their half widths.
const WITHIN: f64 = 2.0;
/// They must also have one shape, with at least this modal assurance criterion.
const ONE_SHAPE: f64 = 0.95;
/// Least number of such modes in a row: two modes next to each other do occur, and with one channel all modes have one shape.
const PARTS: usize = 3;

/// Largest relative distance of a pole from the frequency at which it was given: whoever reads a frequency off a picture is off by less. Beyond it the fit has no mode there.
/// A judgement.
const MOVED: f64 = 0.03;

/// A channel does not move with the modes of the others where the fit leaves more than this fraction of it (root mean square).
const STRANGER: f64 = 0.5;
/// Of the other channels the fit must then leave, by their median, less than this fraction of what it leaves of the one: modes that are missing are missing in all of them.
const OTHERS: f64 = 0.5;

impl ModalFit {
    /// A sentence where the response at the drive point moves against the force, because a direction is reversed or channels are swapped; else none.
    #[must_use]
    pub fn drive_point_doubt(&self) -> Option<String> {
        let phases: Vec<f64> = self.modes.iter().filter_map(|m| m.drive_phase).collect();
        let against = phases.iter().filter(|c| **c < 0.0).count();
        let doubtful = against > 0 && against as f64 >= DOUBTFUL * phases.len() as f64;
        doubtful.then(|| {
            format!(
                "the response where the hammer hits goes against the force in {against} of {} modes: a direction is reversed, or channels are swapped",
                phases.len()
            )
        })
    }

    /// Indices of responses that do not move with the modes of the others: the fit leaves more than half of them, and at most half as much of most others.
    #[must_use]
    pub fn strangers(&self) -> Vec<usize> {
        let left = &self.fitted.left;
        let is_stranger = |k: &usize| {
            let others: Vec<f64> = [&left[..*k], &left[k + 1..]].concat();
            left[*k] > STRANGER && !others.is_empty() && median(&others) < OTHERS * left[*k]
        };
        (0..left.len()).filter(is_stranger).collect()
    }

    /// Whether the modes leave more than half of most responses.
    #[must_use]
    pub fn leaves_most(&self) -> bool {
        median(&self.fitted.left) > STRANGER
    }

    /// Modes that are probably not modes but sidebands of stronger ones, made by a modulation such as that of a soft suspension: weaker modes of the same shape that stand at
    /// one distance from stronger ones, on both sides of at least two of them, and more often than chance would have it. None where there is no such distance.
    #[must_use]
    pub fn sidebands(&self) -> Option<Sidebands> {
        let place = |m: &Mode| self.fitted.poles.iter().position(|p| *p == m.pole);
        let chosen: Option<Vec<usize>> = self.modes.iter().map(place).collect();
        sidebands(&self.fitted, &chosen?)
    }

    /// A sentence on sidebands: which modes they are, and of which modes; none where there are none.
    #[must_use]
    pub fn sideband_doubt(&self) -> Option<String> {
        let found = self.sidebands()?;
        let list = |chosen: &dyn Fn(usize) -> bool| -> String {
            let own = self.modes.iter().enumerate().filter(|(n, _)| chosen(*n));
            own.map(|(_, m)| format!("{:.2}", m.frequency)).collect::<Vec<_>>().join(", ")
        };
        let is_farther = |s: &Sideband| {
            let [own, of] = [s.mode, s.of].map(|n| self.modes[n].frequency);
            (own - of).abs() > 1.5 * found.frequency
        };
        let farther = if found.all.iter().any(is_farther) { " or a multiple of it" } else { "" };
        Some(format!(
            "{} of {} modes are probably none, but sidebands of stronger modes: those at {} Hz stand {:.2} Hz{farther} from those at {} Hz and have their shapes; something modulates the structure at that frequency, as a soft suspension does on which it sways",
            found.all.len(),
            self.modes.len(),
            list(&|n| found.all.iter().any(|s| s.mode == n)),
            found.frequency,
            list(&|n| found.all.iter().any(|s| s.of == n)),
        ))
    }

    /// A sentence where poles given at these frequencies (Hz) moved away from them: there is no mode there, or the pole went to a mode that was not given.
    #[must_use]
    pub fn moved_doubt(&self, given: &[f64]) -> Option<String> {
        let off = |from: f64, mode: &Mode| (mode.frequency / from).ln().abs();
        let moved = |from: &f64| {
            let nearest = self.modes.iter().min_by(|a, b| off(*from, a).total_cmp(&off(*from, b)))?;
            let is_far = off(*from, nearest) > MOVED;
            is_far.then(|| format!("{from:.2} Hz (the nearest at {:.2} Hz)", nearest.frequency))
        };
        let list: Vec<String> = given.iter().filter_map(moved).collect();
        (!list.is_empty())
            .then(|| format!("the fit has no mode where a pole was given, at {}", list.join(", at ")))
    }

    /// Modes that are probably parts of one: three or more of one shape that stand within their widths of one another. Linear modes describe a decay whose frequency changes with
    /// amplitude in that way. Their indices, group by group.
    fn parts_of_one(&self) -> Vec<Vec<usize>> {
        let of_one = |a: &Mode, b: &Mode| {
            let half = |m: &Mode| m.frequency * m.damping_ratio;
            b.frequency - a.frequency < WITHIN * (half(a) + half(b)) && mac(&a.shape, &b.shape) > ONE_SHAPE
        };
        let groups = self.modes.chunk_by(of_one);
        let mut first = 0;
        let indices = groups.map(|group| {
            first += group.len();
            (first - group.len()..first).collect::<Vec<usize>>()
        });
        indices.filter(|group| group.len() >= PARTS).collect()
    }

    /// A sentence on modes that are probably parts of one; none where there are none.
    #[must_use]
    pub fn parts_doubt(&self) -> Option<String> {
        let list = |group: &Vec<usize>| {
            let all: Vec<String> = group.iter().map(|n| format!("{:.2}", self.modes[*n].frequency)).collect();
            all.join(", ")
        };
        let groups: Vec<String> = self.parts_of_one().iter().map(list).collect();
        (!groups.is_empty()).then(|| {
            format!(
                "modes within their widths of one another that have one shape are probably one mode each, whose frequency changes while it decays: those at {} Hz",
                groups.join(" Hz, and those at ")
            )
        })
    }
}
