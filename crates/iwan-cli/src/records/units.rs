//! Units of the quantities derived from a record, as text for axes and tables.

use iwan_ident::curves::Quantity;

/// Units derived from the unit of the record; empty texts where the file names none.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Units {
    /// Unit of the samples.
    pub(crate) samples: String,
    /// Unit of the displacement amplitude.
    pub(crate) displacement: String,
    /// Unit of forces.
    pub(crate) force: String,
    /// Unit of energies.
    pub(crate) energy: String,
    /// Name of the measured quantity.
    pub(crate) quantity: &'static str,
}

impl Units {
    /// Units for samples in `unit` of a quantity. `root` says whether a mass or mode shapes were given: modal quantities carry the root of a mass.
    pub(crate) fn new(unit: &str, quantity: Quantity, root: bool) -> Self {
        let (quantity, rates) = match quantity {
            Quantity::Acceleration => ("acceleration", 2),
            Quantity::Velocity => ("velocity", 1),
            Quantity::Displacement => ("displacement", 0),
        };
        let unit = pretty(unit);
        if unit.is_empty() {
            let none = String::new;
            return Self { samples: none(), displacement: none(), force: none(), energy: none(), quantity };
        }
        let length = length(&unit, rates);
        let (once, twice) = if root { ("\u{221a}mass\u{b7}", "mass\u{b7}") } else { ("", "") };
        Self {
            samples: format!("{once}{unit}"),
            force: format!("{once}{length}/s\u{b2}"),
            energy: format!("{twice}{length}\u{b2}/s\u{b2}"),
            displacement: format!("{once}{length}"),
            quantity,
        }
    }
}

/// Typesets a unit: `m/s^2` becomes m/s².
fn pretty(unit: &str) -> String {
    let unit = unit.trim().trim_matches(['[', ']', '(', ')']);
    ["s^2", "s**2", "s2"].iter().fold(unit.to_string(), |u, old| match u.strip_suffix(old) {
        Some(start) if start.ends_with('/') => format!("{start}s\u{b2}"),
        _ => u,
    })
}

/// Unit of length in the unit of a quantity that was differentiated `rates` times with respect to time.
fn length(unit: &str, rates: usize) -> String {
    let (suffix, factor) = [("", ""), ("/s", "\u{b7}s"), ("/s\u{b2}", "\u{b7}s\u{b2}")][rates];
    match unit.strip_suffix(suffix) {
        Some(length) if !length.is_empty() && !length.contains('/') => length.into(),
        _ => format!("({unit}{factor})"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_follow_from_the_record() {
        let units = Units::new("m/s^2", Quantity::Acceleration, false);
        assert_eq!((units.displacement.as_str(), units.energy.as_str()), ("m", "m\u{b2}/s\u{b2}"));
        let units = Units::new("g", Quantity::Acceleration, true);
        assert_eq!(units.displacement, "\u{221a}mass\u{b7}(g\u{b7}s\u{b2})");
        assert_eq!(Units::new("", Quantity::Velocity, true).force, "");
        assert_eq!(Units::new("mm/s", Quantity::Velocity, false).force, "mm/s\u{b2}");
    }
}
