//! Units in which times are written.

use std::fmt;
use std::str::FromStr;

/// A unit of time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum TimeUnit {
    /// 1 s.
    Second,
    /// 1e-3 s.
    Millisecond,
    /// 1e-6 s.
    Microsecond,
    /// 1e-9 s.
    Nanosecond,
    /// 60 s.
    Minute,
    /// 3600 s.
    Hour,
}

impl TimeUnit {
    /// The symbols that the user may write, as a list for messages.
    pub(crate) const KNOWN: &'static str = "s, ms, us, ns, min, h";

    /// All units.
    pub const ALL: [Self; 6] =
        [Self::Second, Self::Millisecond, Self::Microsecond, Self::Nanosecond, Self::Minute, Self::Hour];

    /// Number of seconds in one unit.
    ///
    /// ```
    /// let unit: iwan_io::TimeUnit = "Minutes".parse()?;
    /// assert_eq!((unit.seconds(), unit.to_string()), (60.0, "min".to_string()));
    /// assert!("furlong".parse::<iwan_io::TimeUnit>().is_err());
    /// # Ok::<(), iwan_io::UnknownTimeUnit>(())
    /// ```
    #[must_use]
    pub fn seconds(self) -> f64 {
        match self {
            Self::Second => 1.0,
            Self::Millisecond => 1e-3,
            Self::Microsecond => 1e-6,
            Self::Nanosecond => 1e-9,
            Self::Minute => 60.0,
            Self::Hour => 3600.0,
        }
    }

    fn symbol(self) -> &'static str {
        match self {
            Self::Second => "s",
            Self::Millisecond => "ms",
            Self::Microsecond => "us",
            Self::Nanosecond => "ns",
            Self::Minute => "min",
            Self::Hour => "h",
        }
    }
}

impl fmt::Display for TimeUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.symbol())
    }
}

/// The error of a text that is no unit of time.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("'{text}' is no unit of time; known are {}", TimeUnit::KNOWN)]
pub struct UnknownTimeUnit {
    /// The text that was written.
    pub text: String,
}

impl FromStr for TimeUnit {
    type Err = UnknownTimeUnit;

    /// Reads a unit in any case: its symbol (`us` and `µs` alike) or its English name.
    fn from_str(text: &str) -> Result<Self, UnknownTimeUnit> {
        let plain: String = text.trim().to_lowercase().replace(['\u{b5}', '\u{3bc}'], "u");
        match plain.as_str() {
            "s" | "sec" | "secs" | "sec." | "second" | "seconds" => Ok(Self::Second),
            "ms" | "msec" | "msecs" | "millisec" | "millisecond" | "milliseconds" => Ok(Self::Millisecond),
            "us" | "usec" | "usecs" | "mus" | "microsec" | "microsecond" | "microseconds" => {
                Ok(Self::Microsecond)
            }
            "ns" | "nsec" | "nanosecond" | "nanoseconds" => Ok(Self::Nanosecond),
            "min" | "mins" | "min." | "minute" | "minutes" => Ok(Self::Minute),
            "h" | "hr" | "hrs" | "hour" | "hours" => Ok(Self::Hour),
            _ => Err(UnknownTimeUnit { text: text.trim().into() }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_read_in_any_case_and_spelling() {
        for (texts, unit) in [
            (["s", "Sec", " SECONDS "], TimeUnit::Second),
            (["ms", "MSEC", "Milliseconds"], TimeUnit::Millisecond),
            (["us", "\u{b5}s", "\u{3bc}s"], TimeUnit::Microsecond),
            (["min", "Minutes", "MINS"], TimeUnit::Minute),
            (["h", "Hours", "hrs"], TimeUnit::Hour),
        ] {
            assert!(texts.iter().all(|t| t.parse() == Ok(unit)), "{texts:?}");
        }
        for text in ["", "samples", "m", "furlong", "days", "ps"] {
            assert!(text.parse::<TimeUnit>().is_err(), "{text}");
        }
        assert!(TimeUnit::ALL.iter().all(|u| u.to_string().parse() == Ok(*u)));
    }
}
