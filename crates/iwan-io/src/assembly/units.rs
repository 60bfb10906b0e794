//! Quantities and time factors from unit labels and names.

use crate::quantity::Quantity;

// Labels as `plain` leaves them: lower case, without brackets, blanks and powers. `mn` is a meganewton here, although it
// may have been a millinewton: both are forces.
const ACCELERATION: [&str; 12] =
    ["m/s2", "mm/s2", "cm/s2", "um/s2", "in/s2", "ft/s2", "m/s/s", "ms-2", "m/sec2", "g", "gn", "mg"];
const VELOCITY: [&str; 8] = ["m/s", "mm/s", "cm/s", "um/s", "in/s", "ft/s", "m/sec", "ms-1"];
const DISPLACEMENT: [&str; 7] = ["m", "mm", "cm", "um", "nm", "in", "ft"];
const FORCE: [&str; 5] = ["n", "kn", "mn", "lb", "lbf"];

/// Quantity that a unit label stands for: `m/s^2`, `(mm/s²)`, `g`, `N`, ...
pub(crate) fn quantity_of_unit(unit: &str) -> Quantity {
    let plain = plain(unit);
    let is = |list: &[&str]| list.contains(&plain.as_str());
    if is(&ACCELERATION) {
        Quantity::Acceleration
    } else if is(&VELOCITY) {
        Quantity::Velocity
    } else if is(&DISPLACEMENT) {
        Quantity::Displacement
    } else if is(&FORCE) {
        Quantity::Force
    } else {
        Quantity::Unknown
    }
}

/// Quantity that the last part of a name stands for: `HIdata.acc1`, `tip.velocity`, ...
pub(crate) fn quantity_of_name(name: &str) -> Quantity {
    let base = base(name);
    let is = |start: &str, whole: &str| base.starts_with(start) || base.contains(whole);
    if is("force", "force") {
        Quantity::Force
    } else if is("acc", "acceleration") {
        Quantity::Acceleration
    } else if is("vel", "velocity") {
        Quantity::Velocity
    } else if is("disp", "displacement") {
        Quantity::Displacement
    } else {
        Quantity::Unknown
    }
}

/// Last part of a dotted name in lower case, without an index such as `[2]`.
pub(crate) fn base(name: &str) -> String {
    let last = name.rsplit('.').next().unwrap_or(name);
    last.split('[').next().unwrap_or(last).trim().to_lowercase()
}

/// Factor from a unit of time to seconds; an empty label means seconds.
pub(crate) fn time_factor(unit: &str) -> Option<f64> {
    match plain(unit).as_str() {
        "" | "s" | "sec" | "secs" | "second" | "seconds" => Some(1.0),
        "ms" | "msec" | "milliseconds" => Some(1e-3),
        "us" | "usec" | "microseconds" => Some(1e-6),
        "ns" => Some(1e-9),
        "min" => Some(60.0),
        "h" => Some(3600.0),
        _ => None,
    }
}

/// What stands above a column.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Label {
    pub(crate) name: String,
    /// Empty where there is none.
    pub(crate) unit: String,
}

impl Label {
    fn new(name: &str, unit: &str) -> Self {
        Self { name: name.into(), unit: unit.into() }
    }
}

/// Splits `Time [ms]`, `Time (ms)` or `time_ms` into name and unit.
pub(crate) fn split_unit(header: &str) -> Label {
    let header = header.trim();
    for (open, close) in [('[', ']'), ('(', ')')] {
        let Some(inner) = header.strip_suffix(close) else { continue };
        let Some((name, unit)) = inner.split_once(open) else { continue };
        let index = unit.chars().all(|c| c.is_ascii_digit());
        if !name.trim().is_empty() && !index {
            return Label::new(name.trim(), unit.trim());
        }
    }
    for unit in ["_s", "_ms", "_us"] {
        if let Some(name) = header.strip_suffix(unit).filter(|name| is_time_name(name)) {
            return Label::new(name, &unit[1..]);
        }
    }
    Label::new(header, "")
}

/// Whether a variable or column of this name is the time.
pub(crate) fn is_time_name(name: &str) -> bool {
    const NAMES: [&str; 9] = ["t", "time", "times", "timestamp", "seconds", "sec", "zeit", "temps", "tid"];
    NAMES.contains(&base(name).as_str())
}

fn plain(unit: &str) -> String {
    let unit = unit.trim().trim_matches(['[', ']']).to_lowercase();
    let unit = unit.strip_prefix('(').and_then(|u| u.strip_suffix(')')).unwrap_or(&unit).to_string();
    unit.chars()
        .filter(|c| !c.is_whitespace() && *c != '^' && *c != '*')
        .map(|c| match c {
            '\u{b2}' => '2',
            '\u{b5}' | '\u{3bc}' => 'u',
            c => c,
        })
        .collect()
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
        assert_eq!(quantity_of_unit("Pa"), Quantity::Unknown);
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
        assert_eq!(time_factor("ms"), Some(1e-3));
        assert_eq!(time_factor("furlong"), None);
    }
}
