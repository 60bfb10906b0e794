//! Quantities from names and units, and name and unit from the header of a column.

use super::scales::scale;
use crate::quantity::Quantity;
use crate::time_unit::TimeUnit;

/// Quantity that the last part of a name stands for: `HIdata.acc1`, `tip.velocity`, ...
pub(crate) fn quantity_of_name(name: &str) -> Quantity {
    let base = base(name);
    let is = |start: &str, whole: &str| base.starts_with(start) || base.contains(whole);
    // `f` is the hammer's force beside a response `x` in records of modal tests.
    if is("force", "force") || base == "f" {
        Quantity::Force
    } else if is("pressure", "pressure") || base.starts_with("microphone") {
        Quantity::Pressure
    } else if is("volt", "voltage") {
        Quantity::Voltage
    } else if base.starts_with("strain") {
        Quantity::Strain
    } else if is("acc", "acceleration") {
        Quantity::Acceleration
    } else if is("vel", "velocity") {
        Quantity::Velocity
    } else if is("disp", "displacement") || base.starts_with("angle") {
        Quantity::Displacement
    } else {
        Quantity::Unknown
    }
}

/// Last part of a dotted name in lower case, without an index such as `[2]` or `{1,2}`.
pub(crate) fn base(name: &str) -> String {
    let last = name.rsplit('.').next().unwrap_or(name);
    last.split(['[', '{']).next().unwrap_or(last).trim().to_lowercase()
}

/// Quantity that a unit label stands for: `m/s^2`, `(mm/s²)`, `g`, `N`, ...; unknown where the unit is.
///
/// ```
/// use iwan_io::{Quantity, quantity_of_unit};
/// assert_eq!(quantity_of_unit("mm/s"), Quantity::Velocity);
/// assert_eq!(quantity_of_unit("counts"), Quantity::Unknown);
/// ```
#[must_use]
pub fn quantity_of_unit(unit: &str) -> Quantity {
    scale(unit).map_or(Quantity::Unknown, |s| s.quantity)
}

/// Whether a text is a unit of time or of samples.
pub(crate) fn is_unit(text: &str) -> bool {
    scale(text).is_some() || bare(text).parse::<TimeUnit>().is_ok()
}

/// A label without the brackets that enclose it.
pub(crate) fn bare(unit: &str) -> &str {
    unit.trim().trim_matches(['[', ']', '(', ')', '{', '}', '<', '>']).trim()
}

/// Name and unit from the header of a column.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Label {
    pub(crate) name: String,
    /// Empty where the header has no unit.
    pub(crate) unit: String,
}

impl Label {
    fn new(name: &str, unit: &str) -> Self {
        Self { name: name.into(), unit: unit.into() }
    }
}

/// Splits `Time [ms]`, `Time (ms)`, `Time {ms}`, `Time <ms>`, `acc / (m/s²)`, `t/ms`, `Time, ms`, `time in ms` or `time_ms` into
/// name and unit.
pub(crate) fn split_unit(header: &str) -> Label {
    let header = header.trim();
    bracketed(header)
        .or_else(|| divided(header))
        .or_else(|| attached(header))
        .unwrap_or_else(|| Label::new(header, ""))
}

/// The unit in the name of times, as in `Time [ms]`, by the rules for headers of columns; empty where the name states none. It need not be a
/// unit of time.
///
/// ```
/// use iwan_io::unit_of_times;
/// assert_eq!((unit_of_times("t_ms").as_str(), unit_of_times("Time [furlong]").as_str()), ("ms", "furlong"));
/// ```
#[must_use]
pub fn unit_of_times(name: &str) -> String {
    split_unit(name).unit
}

/// The known unit in brackets at the end of an array's name; empty where the name has none.
pub(crate) fn unit_in(name: &str) -> String {
    bracketed(name).map(|label| label.unit).filter(|unit| scale(unit).is_some()).unwrap_or_default()
}

/// Name and unit of a header that ends in a unit in brackets; digits and commas in brackets are an index and no unit.
fn bracketed(header: &str) -> Option<Label> {
    [('[', ']'), ('(', ')'), ('{', '}'), ('<', '>')].into_iter().find_map(|(open, close)| {
        let (name, unit) = header.strip_suffix(close)?.split_once(open)?;
        let index = unit.chars().all(|c| c.is_ascii_digit() || c == ',');
        let name = name.trim().trim_end_matches('/').trim();
        (!name.is_empty() && !index).then(|| Label::new(name, unit.trim()))
    })
}

/// Name and unit of a header in which a stroke separates them, as in ISO 80000-1.
fn divided(header: &str) -> Option<Label> {
    let (name, unit) = header.split_once('/')?;
    let known = scale(unit).is_some() || is_time_name(name) && is_unit(unit);
    // A header that is a unit as a whole, such as m/s, is not split into a name and a unit.
    (known && scale(header).is_none() && !name.trim().is_empty()).then(|| Label::new(name.trim(), bare(unit)))
}

/// Name and unit of a header in which a unit of time follows a name that means time.
fn attached(header: &str) -> Option<Label> {
    ["_", ", ", " in ", " "].into_iter().find_map(|between| {
        let (name, unit) = header.rsplit_once(between)?;
        let known = is_time_name(name) && unit.trim().parse::<TimeUnit>().is_ok();
        known.then(|| Label::new(name.trim(), unit.trim()))
    })
}

/// Whether the name of a variable or column means time.
pub(crate) fn is_time_name(name: &str) -> bool {
    const NAMES: [&str; 9] = ["t", "time", "times", "timestamp", "seconds", "sec", "zeit", "temps", "tid"];
    NAMES.contains(&base(name).as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_tell_the_quantity() {
        for unit in ["m/s^2", "m/s2", "m/s\u{b2}", "(mm/s**2)", "g", "[m/s^2]"] {
            assert_eq!(quantity_of_unit(unit), Quantity::Acceleration, "{unit}");
        }
        assert_eq!(quantity_of_unit("m/s"), Quantity::Velocity);
        assert_eq!(quantity_of_unit("\u{b5}m"), Quantity::Displacement);
        assert_eq!(quantity_of_unit("kN"), Quantity::Force);
        assert_eq!(quantity_of_unit("Pa"), Quantity::Pressure);
        assert_eq!(quantity_of_unit("furlong"), Quantity::Unknown);
    }

    #[test]
    fn names_tell_the_quantity_and_the_time() {
        assert_eq!(quantity_of_name("HIdata.acc1"), Quantity::Acceleration);
        assert_eq!(quantity_of_name("bending 1.joint_force"), Quantity::Force);
        assert_eq!(quantity_of_name("tip.displacement"), Quantity::Displacement);
        assert!(is_time_name("HIdata.time") && is_time_name("T") && !is_time_name("tip"));
    }

    #[test]
    fn units_are_split_from_headers() {
        assert_eq!(split_unit(" Time [ms] "), Label::new("Time", "ms"));
        assert_eq!(split_unit("time_us"), Label::new("time", "us"));
        assert_eq!(split_unit("acc (m/s^2)"), Label::new("acc", "m/s^2"));
        assert_eq!(split_unit("pos_s"), Label::new("pos_s", ""));
        assert_eq!(split_unit("acc[0]"), Label::new("acc[0]", ""));
        for header in [
            "Time {ms}",
            "Time <ms>",
            "Time / ms",
            "t/ms",
            "Time, ms",
            "time in ms",
            "Time ms",
            "time / [ms]",
        ] {
            let label = split_unit(header);
            assert_eq!(
                (base(&label.name).chars().next(), label.unit.as_str()),
                (Some('t'), "ms"),
                "{header}"
            );
        }
        assert_eq!(split_unit("acc / (m/s\u{b2})"), Label::new("acc", "m/s\u{b2}"));
        for whole in ["in/out", "m/s", "x/h"] {
            assert_eq!(split_unit(whole), Label::new(whole, ""));
        }
        assert_eq!(split_unit("x{1,2}"), Label::new("x{1,2}", ""));
        assert!(is_unit("Minutes") && is_unit("g") && !is_unit("furlong"));
    }
}
