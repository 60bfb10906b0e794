//! Times of day and dates, as loggers write them.

use chrono::{DateTime, Datelike, NaiveDateTime, NaiveTime, Timelike};

/// Seconds of a day, leap seconds left out.
const DAY: f64 = 86_400.0;
/// Forms of a date before a time of day that are read: ISO 8601, and German. Other forms do not show which number is the day and which the
/// month.
const DATES: [&str; 4] =
    ["%Y-%m-%d %H:%M:%S%.f", "%Y-%m-%dT%H:%M:%S%.f", "%Y/%m/%d %H:%M:%S%.f", "%d.%m.%Y %H:%M:%S%.f"];

/// A cell that holds a time of day, with a date or without.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Clock {
    /// Days since 31 December of the year 0, so that 1 January of the year 1 is day 1; none without a date.
    day: Option<i32>,
    /// Seconds since midnight.
    seconds: f64,
}

impl Clock {
    /// The time in a cell whose decimal sign is a point.
    pub(super) fn in_cell(text: &str) -> Option<Self> {
        // A quick test rejects what is no time of day, because every word of a file is passed to this function.
        if text.bytes().filter(|b| *b == b':').count() < 2 {
            return None;
        }
        let since_midnight =
            |t: NaiveTime| f64::from(t.num_seconds_from_midnight()) + 1e-9 * f64::from(t.nanosecond());
        if let Ok(time) = NaiveTime::parse_from_str(text, "%H:%M:%S%.f") {
            return Some(Self { day: None, seconds: since_midnight(time) });
        }
        let local = || DATES.iter().find_map(|form| NaiveDateTime::parse_from_str(text, form).ok());
        let with_zone = DateTime::parse_from_rfc3339(text).map(|t| t.naive_utc()).ok();
        let time = with_zone.or_else(local)?;
        Some(Self { day: Some(time.num_days_from_ce()), seconds: since_midnight(time.time()) })
    }
}

/// The times of a column of times of day, in seconds since the midnight before the first of them.
#[derive(Debug, Default)]
pub(super) struct Clocks {
    last: Option<Clock>,
    /// Days since the day of the first time.
    days: i32,
}

impl Clocks {
    /// Seconds of the next time. A time without a date that is more than half a day earlier than the last one counts as after midnight.
    /// None where some times have a date and others have none.
    pub(super) fn seconds(&mut self, clock: Clock) -> Option<f64> {
        self.days += match self.last.map(|last| (last, last.day, clock.day)) {
            None => 0,
            Some((_, Some(last), Some(day))) => day - last,
            Some((last, None, None)) => i32::from(clock.seconds < last.seconds - 0.5 * DAY),
            Some(_) => return None,
        };
        self.last = Some(clock);
        Some(DAY * f64::from(self.days) + clock.seconds)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seconds(cells: &[&str]) -> Option<Vec<f64>> {
        let mut clocks = Clocks::default();
        cells.iter().map(|cell| clocks.seconds(Clock::in_cell(cell)?)).collect()
    }

    #[test]
    fn times_of_day_go_on_beyond_midnight() {
        assert_eq!(
            seconds(&["23:59:59.500", "00:00:00", "0:00:00.25"]),
            Some(vec![86399.5, 86400.0, 86400.25])
        );
        assert_eq!(seconds(&["10:00:01", "10:00:00"]), Some(vec![36001.0, 36000.0]));
    }

    #[test]
    fn dates_count_from_the_first_midnight() {
        for [a, b] in [
            ["2024-02-29 23:59:59.75", "2024-03-01 00:00:00.25"],
            ["2024-02-29T23:59:59.75", "2024-03-01T00:00:00.25"],
            ["2024-02-29T23:59:59.75Z", "2024-03-01T01:00:00.25+01:00"],
            ["29.02.2024 23:59:59.75", "01.03.2024 00:00:00.25"],
        ] {
            assert_eq!(seconds(&[a, b]), Some(vec![86399.75, 86400.25]), "{a}");
        }
    }

    #[test]
    fn words_and_ratios_are_no_clocks() {
        for cell in ["", "time", "12:30", "1:2:3:4", "25:00:00", "2024-02-30 10:00:00", "10:00:00 A", "::"] {
            assert_eq!(Clock::in_cell(cell), None, "{cell}");
        }
        assert_eq!(seconds(&["10:00:00", "2024-02-29 10:00:01"]), None);
    }
}
