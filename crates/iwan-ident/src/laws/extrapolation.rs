//! How far the frequency at rest (at small amplitude) lies above all frequencies that were seen, and which parameters a fit does not tell then.

use crate::curves::Curves;
use crate::parameters::Parameter;

/// Distance of the frequency at rest above those seen, in ranges of the frequencies seen, from which on a sentence says so. A joint goes on to
/// stiffen below the quietest cycle: of forty random ring-downs of 60 to 300 cycles thirty go beyond this, half beyond 0.85, one beyond 10.
const EXTRAPOLATED: f64 = 0.5;
/// Distance, in ranges of the frequencies seen, from which on frequency and damping at rest and χ have no interval. Of 43 random joints of 150
/// sliders in noise, and of short records through macro-slip, those from 13 ranges on missed χ by up to 25 widths of its interval; below 3 ranges
/// none missed χ by more than 0.4 widths. Of 40 joints in noise of 20 dB six were beyond this limit, of which four missed the damping ratio.
const FAR: f64 = 5.0;
/// Part of the frequency below which that distance is never too far: linear modes have no range to compare it with.
const LITTLE: f64 = 1e-3;

/// The frequency at rest, and the lowest and highest frequency seen, all in Hz.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Extrapolation {
    at_rest: f64,
    low: f64,
    high: f64,
}

impl Extrapolation {
    pub(crate) fn of<'a>(curves: impl IntoIterator<Item = &'a Curves>, at_rest: f64) -> Self {
        let all = curves.into_iter().flat_map(|c| c.frequency.iter().copied());
        let (low, high) = all.fold((f64::INFINITY, 0.0_f64), |(low, high), f| (low.min(f), high.max(f)));
        Self { at_rest, low, high }
    }

    /// Whether the frequency at rest lies above those seen by more than `times` their range.
    fn is_beyond(self, times: f64) -> bool {
        self.high > 0.0 && self.at_rest - self.high > times * (self.high - self.low)
    }

    /// The parameters that the fit does not tell. A mode that is in macro-slip throughout has its frequency at rest and χ by the form of the law
    /// alone, and with them the viscous part of its damping: friction of χ near -1 damps like a viscous damper.
    pub(crate) fn untold(self) -> &'static [Parameter] {
        if self.is_far() { &[Parameter::Frequency, Parameter::DampingRatio, Parameter::Chi] } else { &[] }
    }

    /// Whether the frequency at rest lies too far above or below those seen for an interval. A spring whose exponent is next to 1 bends the frequency by the logarithm of
    /// the amplitude, and tells nothing of its value at rest.
    pub(crate) fn is_far(self) -> bool {
        self.high > 0.0 && (self.at_rest > self.limit() || self.at_rest < self.low - self.reach())
    }

    /// Frequency (Hz) above which no interval has an upper end: as far above those seen as where no interval is left.
    pub(crate) fn limit(self) -> f64 {
        self.high + self.reach()
    }

    /// Distance (Hz) from the frequencies seen up to which the frequency at rest has an interval.
    fn reach(self) -> f64 {
        (FAR * (self.high - self.low)).max(LITTLE * self.high)
    }

    /// The extrapolation in words; none where the frequency at rest is not extrapolated.
    pub(crate) fn in_words(self) -> Option<String> {
        let untold = match self.untold() {
            [] => "",
            _ => ", and that is too far from it for an interval of frequency, viscous damping or chi",
        };
        let Self { at_rest, high, .. } = self;
        self.is_beyond(EXTRAPOLATED).then(|| {
            format!(
                "the frequency at rest, {at_rest:.4} Hz, is extrapolated: the highest seen is {high:.4} Hz{untold}"
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curves::ForceAxis;

    /// A case that was seen: a joint that slipped as a whole in all 40 cycles was said to have χ between -0.951 and -0.935 where it had -0.538.
    #[test]
    fn a_mode_that_is_never_seen_near_its_rest_is_not_told() {
        let of = |frequency: [f64; 2]| Curves {
            t: vec![],
            displacement: vec![],
            frequency: frequency.to_vec(),
            damping_ratio: vec![],
            dissipation: vec![],
            force: vec![],
            axis: ForceAxis::Modal,
            log_dissipation_sd: vec![],
            frequency_sd: vec![],
            independent: 0.0,
        };
        let seen = [of([63.82, 63.85]), of([63.81, 63.88])];
        let far = Extrapolation::of(&seen, 65.18);
        assert_eq!(far.untold(), [Parameter::Frequency, Parameter::DampingRatio, Parameter::Chi]);
        assert!(far.in_words().unwrap().contains("the highest seen is 63.8800 Hz, and that is too far"));
        let near = Extrapolation::of(&seen, 63.95);
        assert_eq!(near.untold(), []);
        assert!(near.in_words().unwrap().ends_with("63.8800 Hz"));
        assert_eq!(Extrapolation::of(&seen, 63.9).in_words(), None);
        // A linear mode has no shift of the frequency, and its frequency is told.
        assert_eq!(Extrapolation::of(&[of([120.0, 120.0])], 120.01).untold(), []);
        assert_eq!(Extrapolation::of([], 120.0).in_words(), None);
        // A spring that hardens: 5 Hz at rest for a mode that was seen at 38 Hz.
        assert!(Extrapolation::of(&[of([37.9, 38.4])], 5.4).is_far());
        assert!(!Extrapolation::of(&[of([37.9, 38.4])], 37.0).is_far());
        assert!((far.limit() - (63.88 + 5.0 * 0.07)).abs() < 1e-9);
    }
}
