//! Axes: from data to places on the page, and where the ticks go.

/// How values are spread along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Spread {
    /// Evenly.
    Linear,
    /// By their logarithm; values <= 0 have no place.
    Log,
}

/// An axis between two values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scale {
    spread: Spread,
    low: f64,
    high: f64,
}

/// A tick with its label; a small one has none.
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

/// Room left around the data, as a share of their extent.
const ROOM: f64 = 0.04;

impl Scale {
    /// A scale that shows all `values` with a little room around; `room` false leaves none.
    pub(crate) fn around(spread: Spread, values: impl Iterator<Item = f64>, room: bool) -> Self {
        let fits = |x: &f64| x.is_finite() && (spread == Spread::Linear || *x > 0.0);
        let (low, high) = values
            .filter(fits)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        let (low, high) = match (low.is_finite(), spread) {
            (false, _) => (1.0, 10.0),
            (true, Spread::Log) if high < 1.05 * low => (low / 2.0, high * 2.0),
            // Differences that rounding alone makes would fill the figure with noise.
            (true, Spread::Linear) if high - low <= 1e-9 * high.abs().max(low.abs()) => {
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

    /// Place of a value: 0 at the low end, 1 at the high end.
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
            Spread::Log if self.high / self.low > 1.8 => self.decades(),
            _ => self.even(count),
        }
    }

    fn even(&self, count: f64) -> Ticks {
        let rough = (self.high - self.low) / count;
        let power = 10f64.powf(rough.log10().floor());
        let round = [(1.0, 0), (2.0, 0), (2.5, 1), (5.0, 0), (10.0, 0)];
        let fits = |(m, _): &&(f64, i32)| m * power >= 0.999 * rough;
        let (step, extra) = round.iter().find(fits).map_or((rough, 1), |(m, extra)| (m * power, *extra));
        let largest = self.low.abs().max(self.high.abs());
        let magnitude = largest.log10().floor() as i32;
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
        // Not more labels than fit.
        let every = ((last - first) / 8 + 1).max(1);
        let ratio = self.high / self.low;
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

/// m·10^n as text: plain where that is short.
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
