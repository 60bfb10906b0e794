//! What a fit itself casts doubt on: channels, modes that are missing, modes that are none.

use crate::analysis::ModalFit;
use crate::modes::{Mode, Sideband, Sidebands, mac, sidebands};
use crate::number::median;

/// Part of the modes whose drive point answers against its force from which a channel is doubted: a mode with a node there may do so by noise.
const DOUBTFUL: f64 = 0.34;

/// Modes are parts of one where they stand nearer than this many times the sum of their half widths, …
const WITHIN: f64 = 2.0;
/// … have one shape by this modal assurance criterion, …
const ONE_SHAPE: f64 = 0.95;
/// … and are so many at least: two modes next to each other occur, and one channel gives all of them one shape.
const PARTS: usize = 3;

/// A pole that was given moves by at most this part of its frequency where a mode stands there: who reads a frequency off a picture is off by less. A judgement.
const MOVED: f64 = 0.03;

/// A channel of which the fit leaves this part does not move with the modes of the others …
const STRANGER: f64 = 0.5;
/// … where of the others it leaves at most this part of that, by their median: modes that are missing are missing in all of them.
const OTHERS: f64 = 0.5;

impl ModalFit {
    /// A word where the response at the drive point goes against the force: a reversed direction, or swapped channels.
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

    /// Responses that do not move with the modes of the others: the fit leaves more than half of them, and at most half as much of most others.
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

    /// Modes that are probably none but sidebands of stronger ones, made by a modulation as that of a soft suspension: weaker modes of the same shape that stand at one distance
    /// from stronger ones, on both sides of two of them at least, and more often than chance would have it. None where there is no such distance.
    #[must_use]
    pub fn sidebands(&self) -> Option<Sidebands> {
        let place = |m: &Mode| self.fitted.poles.iter().position(|p| *p == m.pole);
        let chosen: Option<Vec<usize>> = self.modes.iter().map(place).collect();
        sidebands(&self.fitted, &chosen?)
    }

    /// What is said of sidebands: which modes they are, and of which.
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

    /// What is said where poles that were given at these frequencies (Hz) moved away from them: no mode stands there, or one that was not given is told by them.
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

    /// Modes that are probably parts of one: three and more of one shape that stand within their widths of one another, as linear modes tell a decay whose frequency changes with
    /// amplitude. Their indices, group by group.
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

    /// What is said of modes that are probably parts of one.
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
