//! Axes: from data to positions on the page, and where the ticks stand.

/// How values are spread along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Spread {
    /// Linear.
    Linear,
    /// Logarithmic; values <= 0 cannot be drawn.
    Log,
}

/// An axis between two finite values, `low` below `high`. On a logarithmic axis both are positive and at most [`MOST_DECADES`] and a small margin
/// apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scale {
    spread: Spread,
    low: f64,
    high: f64,
}

/// A tick with its label; a minor tick has none.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tick {
    pub(crate) value: f64,
    pub(crate) label: Option<String>,
}

/// Ticks, and the power of ten that was taken out of their labels.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ticks {
    pub(crate) ticks: Vec<Tick>,
    pub(crate) exponent: i32,
}

/// Margin around the data, as a part of their extent, so that no point lies on the frame. From 0.02 to 0.08 do as well.
const ROOM: f64 = 0.04;

/// Values larger than this are ignored when the axis is laid out, and values below its inverse count as zero. Doubles end at 1e308; eight decades are
/// left for the margin and for the next round number. An ignored value is drawn on the frame.
const LARGEST: f64 = 1e300;

/// Most decades of a logarithmic axis. The dissipation of a ring-down that has decayed to the last bit of its first amplitude spans 48; a larger span
/// comes from uncertainties without bounds (the edge of a pale band is its curve times e^sd). The axis then shows this many decades around the median
/// of its values, and the rest is drawn on the frame.
const MOST_DECADES: i32 = 100;

/// Values on a logarithmic axis whose ratio is below this count as one value: the axis then runs from half of it to twice of it.
const SAME: f64 = 1.05;

/// Values on a linear axis that differ by less than this part of their size count as one value: such differences come from rounding, and a figure of
/// them would show noise. The axis then shows a tenth of the size on either side.
const ROUNDING: f64 = 1e-9;

/// A logarithmic axis up to this ratio gets evenly spaced ticks, some of which always have labels; the usual ticks, whole multiples of powers of ten,
/// may all lie outside (there is none between 1.05 and 1.85).
const HARDLY_LOG: f64 = 1.8;

/// An axis of this many decades or more labels every second decade, one of twice as many every third, so that the labels, at most eight, fit beside
/// each other.
const LABELLED: i32 = 8;

impl Scale {
    /// A scale that shows all `values`, with a margin around them where `room` is true.
    pub(crate) fn around(spread: Spread, values: impl Iterator<Item = f64>, room: bool) -> Self {
        let (low, high) = limits(spread, values);
        let (low, high) = match (low.is_finite(), spread) {
            (false, _) => (1.0, 10.0),
            (true, Spread::Log) if high < SAME * low => (low / 2.0, high * 2.0),
            (true, Spread::Linear) if high - low <= ROUNDING * high.abs().max(low.abs()) => {
                let half = if high == 0.0 { 1.0 } else { 0.1 * high.abs() };
                (low - half, high + half)
            }
            _ => (low, high),
        };
        let share = if room { ROOM } else { 0.0 };
        match spread {
            Spread::Linear => {
                let margin = share * (high - low);
                Self { spread, low: low - margin, high: high + margin }
            }
            Spread::Log => {
                let factor = (high / low).powf(share);
                Self { spread, low: low / factor, high: high * factor }
            }
        }
    }

    /// Position of a value: 0 at the low end, 1 at the high end.
    pub(crate) fn share(&self, value: f64) -> f64 {
        match self.spread {
            Spread::Linear => (value - self.low) / (self.high - self.low),
            Spread::Log => (value / self.low).ln() / (self.high / self.low).ln(),
        }
    }

    /// Whether a value lies on the axis.
    pub(crate) fn contains(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// About `count` ticks at round values.
    pub(crate) fn ticks(&self, count: f64) -> Ticks {
        match self.spread {
            Spread::Log if self.high / self.low > HARDLY_LOG => self.decades(),
            _ => self.even(count),
        }
    }

    fn even(&self, count: f64) -> Ticks {
        let rough = (self.high - self.low) / count;
        let power = 10f64.powf(rough.log10().floor());
        // Round steps, each with the number of digits that its multiples need beyond those of the power of ten.
        let round = [(1.0, 0), (2.0, 0), (2.5, 1), (5.0, 0), (10.0, 0)];
        // A step that is too short by rounding alone is accepted.
        let fits = |(m, _): &&(f64, i32)| m * power >= 0.999 * rough;
        let (step, extra) = round.iter().find(fits).map_or((rough, 1), |(m, extra)| (m * power, *extra));
        let largest = self.low.abs().max(self.high.abs());
        let magnitude = largest.log10().floor() as i32;
        // Labels of more than five digits are divided by a power of a thousand, which the title of the axis names.
        let exponent = if (-2..=4).contains(&magnitude) { 0 } else { magnitude.div_euclid(3) * 3 };
        let unit = 10f64.powi(exponent);
        let digits = (-(step / unit * (1.0 + 1e-9)).log10().floor() as i32 + extra).clamp(0, 12) as usize;
        let first = (self.low / step).ceil() as i64;
        let last = (self.high / step).floor() as i64;
        let tick = |i: i64| {
            let value = i as f64 * step;
            let text = format!("{:.digits$}", value / unit);
            Tick { value, label: Some(text.replace('-', "\u{2212}")) }
        };
        Ticks { ticks: (first..=last).map(tick).collect(), exponent }
    }

    fn decades(&self) -> Ticks {
        let (first, last) = (self.low.log10().floor() as i32, self.high.log10().ceil() as i32);
        let every = (last - first) / LABELLED + 1;
        let ratio = self.high / self.low;
        // The fewer decades the axis has, the more multiples between them have a label: four to six labels on average.
        let few = |m: u8| match ratio {
            r if r < 3.0 => m < 8,
            r if r < 8.0 => matches!(m, 2 | 3 | 4 | 5 | 7),
            r if r < 30.0 => matches!(m, 2 | 3 | 5),
            r => r < 300.0 && matches!(m, 2 | 5),
        };
        let mut ticks = Vec::new();
        for decade in first..=last {
            let power = 10f64.powi(decade);
            for m in 1..10 {
                let value = f64::from(m) * power;
                let labelled = (m == 1 && decade % every == 0) || few(m);
                if self.contains(value) {
                    ticks.push(Tick { value, label: labelled.then(|| power_of_ten(m, decade)) });
                }
            }
        }
        Ticks { ticks, exponent: 0 }
    }
}

/// The smallest and the largest value that are not ignored; infinite where there is none.
fn limits(spread: Spread, values: impl Iterator<Item = f64>) -> (f64, f64) {
    let counted = |x: f64| match spread {
        Spread::Linear if x.abs() < LARGEST.recip() => Some(0.0),
        Spread::Linear => Some(x).filter(|x| x.abs() <= LARGEST),
        Spread::Log => Some(x).filter(|x| (LARGEST.recip()..=LARGEST).contains(x)),
    };
    let mut values: Vec<f64> = values.filter_map(counted).collect();
    let ends = |(low, high): (f64, f64), x: &f64| (low.min(*x), high.max(*x));
    let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), ends);
    if spread == Spread::Linear || values.is_empty() || high / low <= 10f64.powi(MOST_DECADES) {
        return (low, high);
    }
    let middle = values.len() / 2;
    let median = *values.select_nth_unstable_by(middle, f64::total_cmp).1;
    let half = 10f64.powi(MOST_DECADES / 2);
    (low.max(median / half), high.min(median * half))
}

/// m·10^n as text, written out where that is short.
fn power_of_ten(m: u8, n: i32) -> String {
    match n {
        0..=3 => (u32::from(m) * 10u32.pow(n.unsigned_abs())).to_string(),
        -3..=-1 => format!("{:.*}", n.unsigned_abs() as usize, f64::from(m) * 10f64.powi(n)),
        _ if m == 1 => format!("10{}", superscript(n)),
        _ => format!("{m}\u{b7}10{}", superscript(n)),
    }
}

/// A whole number in superscript digits.
pub(crate) fn superscript(n: i32) -> String {
    let digit = |c: char| match c {
        '-' => '\u{207b}',
        '1' => '\u{b9}',
        '2' => '\u{b2}',
        '3' => '\u{b3}',
        c => char::from_u32(0x2070 + c.to_digit(10).unwrap_or(0)).unwrap_or(c),
    };
    n.to_string().chars().map(digit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: &Scale) -> Vec<String> {
        scale.ticks(7.0).ticks.into_iter().filter_map(|t| t.label).collect()
    }

    #[test]
    fn linear_ticks_are_round_and_short() {
        let scale = Scale::around(Spread::Linear, [-0.0071, 0.0069].into_iter(), false);
        assert_eq!(scale.ticks(5.0).exponent, -3);
        assert_eq!(labels(&scale), ["\u{2212}6", "\u{2212}4", "\u{2212}2", "0", "2", "4", "6"]);
        let scale = Scale::around(Spread::Linear, [123.2, 124.1].into_iter(), false);
        assert_eq!(labels(&scale), ["123.2", "123.4", "123.6", "123.8", "124.0"]);
    }

    #[test]
    fn decades_are_labelled() {
        let scale = Scale::around(Spread::Log, [2e-6, 3e-2].into_iter(), false);
        assert_eq!(labels(&scale), ["10\u{207b}\u{2075}", "10\u{207b}\u{2074}", "0.001", "0.01"]);
    }

    /// The margin around 1e-320 and 1e300 once reached 0 and infinity; the decades between them, as whole numbers from -2147483648 to 2147483647,
    /// then filled the memory. One record in thirty ended so.
    #[test]
    fn limits_that_are_not_finite_do_not_fill_the_memory() {
        let (least, most) = (f64::from_bits(1), f64::MAX);
        let middle = || (0..50).map(|n| 1e-3 * 1.1_f64.powi(n));
        for (low, high) in
            [(1e-320, 1e300), (1e-200, 1e200), (least, most), (0.0, f64::INFINITY), (f64::NAN, 1e250)]
        {
            for room in [false, true] {
                let scale = Scale::around(Spread::Log, [low, high].into_iter().chain(middle()), room);
                assert!(0.0 < scale.low && scale.low < scale.high && scale.high < f64::INFINITY, "{scale:?}");
                assert!(scale.ticks(6.0).ticks.len() <= 10 * (MOST_DECADES as usize + 10), "{scale:?}");
                assert!(middle().all(|x| scale.contains(x)), "{scale:?}");
            }
        }
        for values in [[-most, most], [least, 2.0 * least], [-1e300, 1e300], [0.0, f64::INFINITY]] {
            let scale = Scale::around(Spread::Linear, values.into_iter(), true);
            let ticks = scale.ticks(6.0).ticks;
            assert!((2..20).contains(&ticks.len()) && ticks.iter().all(|t| t.value.is_finite()), "{scale:?}");
            assert!(
                ticks.iter().flat_map(|t| &t.label).all(|l| !l.contains("NaN") && !l.contains("inf")),
                "{ticks:?}"
            );
        }
    }

    #[test]
    fn nothing_and_constants_still_make_an_axis() {
        for spread in [Spread::Linear, Spread::Log] {
            for values in [&[][..], &[0.0], &[3.0, 3.0], &[f64::NAN]] {
                let scale = Scale::around(spread, values.iter().copied(), true);
                assert!(scale.high > scale.low && scale.ticks(5.0).ticks.len() >= 2, "{spread:?} {values:?}");
            }
        }
    }
}
