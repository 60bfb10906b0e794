//! What a unit label means: quantity, and factor to the unit of the International System.

use crate::quantity::Quantity;

/// A unit of samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scale {
    pub(crate) quantity: Quantity,
    /// Kind of quantity: units of the same kind can be converted into each other.
    pub(crate) kind: &'static str,
    /// Factor from this unit to `si`; none where the label has two meanings.
    pub(crate) factor: Option<f64>,
    /// Label of the unit in the International System.
    pub(crate) si: &'static str,
}

/// Standard acceleration of gravity, m/s^2: exact (3rd General Conference on Weights and Measures, 1901).
const GRAVITY: f64 = 9.806_65;
/// One inch in m: exact (international yard and pound agreement, 1959), as is one foot.
const INCH: f64 = 0.0254;
/// One pound-force in N: 0.45359237 kg times [`GRAVITY`].
const POUND_FORCE: f64 = 0.453_592_37 * GRAVITY;

/// The unit of a label: `m/s^2`, `(mm/s²)`, `g`, `deg`, `kN`, ...; none where it is not known.
pub(crate) fn scale(label: &str) -> Option<Scale> {
    let text = plain(label);
    length_or_angle(&text).or_else(|| others(&text)).or_else(|| others(&text.to_lowercase()))
}

/// The label without brackets, blanks and signs of powers and products; the case of its letters stays.
fn plain(label: &str) -> String {
    let inside = label.trim().trim_matches(['[', ']', '(', ')', '{', '}', '<', '>']);
    let letters =
        inside.chars().filter(|c| !c.is_whitespace() && !matches!(c, '^' | '*' | '\u{b7}' | '.' | '(' | ')'));
    let plain: String = letters
        .map(|c| match c {
            '\u{b2}' => '2',
            '\u{b5}' | '\u{3bc}' => 'u',
            '\u{2212}' | '\u{207b}' => '-',
            '\u{b9}' => '1',
            c => c,
        })
        .collect();
    plain.replace('\u{b0}', "deg")
}

/// Displacement, velocity or acceleration, of a point or of an angle.
fn length_or_angle(text: &str) -> Option<Scale> {
    const RATES: [(&str, u8); 9] = [
        ("/s2", 2),
        ("/s/s", 2),
        ("/sec2", 2),
        ("/sec/sec", 2),
        ("s-2", 2),
        ("/s", 1),
        ("/sec", 1),
        ("s-1", 1),
        ("", 0),
    ];
    let text = text.to_lowercase();
    let rate = |(suffix, order): (&str, u8)| Some((base(text.strip_suffix(suffix)?)?, order));
    let ((factor, angle), order) = RATES.into_iter().find_map(rate)?;
    let (quantity, kind, si) = match (order, angle) {
        (0, false) => (Quantity::Displacement, "displacement", "m"),
        (1, false) => (Quantity::Velocity, "velocity", "m/s"),
        (_, false) => (Quantity::Acceleration, "acceleration", "m/s^2"),
        (0, true) => (Quantity::Displacement, "angle", "rad"),
        (1, true) => (Quantity::Velocity, "angular velocity", "rad/s"),
        (_, true) => (Quantity::Acceleration, "angular acceleration", "rad/s^2"),
    };
    Some(Scale { quantity, kind, factor: Some(factor), si })
}

/// Factor of a unit of length or angle, and whether it is an angle.
fn base(text: &str) -> Option<(f64, bool)> {
    let factor = match text {
        "m" | "meter" | "metre" | "meters" | "metres" => 1.0,
        "mm" => 1e-3,
        "cm" => 1e-2,
        "um" | "micron" | "microns" => 1e-6,
        "nm" => 1e-9,
        "km" => 1e3,
        "in" | "inch" | "inches" => INCH,
        "ft" | "foot" | "feet" => 12.0 * INCH,
        _ => {
            return match text {
                "rad" | "radian" | "radians" => Some((1.0, true)),
                "mrad" => Some((1e-3, true)),
                "deg" | "degree" | "degrees" => Some((std::f64::consts::PI / 180.0, true)),
                _ => None,
            };
        }
    };
    Some((factor, false))
}

/// The units that are neither a length or an angle nor a time derivative of one.
fn others(text: &str) -> Option<Scale> {
    let (quantity, si, factor) = match text {
        "g" | "gn" | "G" | "gs" | "g's" => (Quantity::Acceleration, "m/s^2", Some(GRAVITY)),
        "mg" => (Quantity::Acceleration, "m/s^2", Some(1e-3 * GRAVITY)),
        "gal" | "Gal" => (Quantity::Acceleration, "m/s^2", Some(1e-2)),
        "N" | "n" | "newton" | "newtons" => (Quantity::Force, "N", Some(1.0)),
        "kN" | "kn" => (Quantity::Force, "N", Some(1e3)),
        "mN" => (Quantity::Force, "N", Some(1e-3)),
        "MN" => (Quantity::Force, "N", Some(1e6)),
        // The label may mean millinewton or meganewton, written in small letters: no factor.
        "mn" => (Quantity::Force, "N", None),
        "lb" | "lbf" | "lbs" | "pound" | "pounds" | "Pound" | "Pounds" => {
            (Quantity::Force, "N", Some(POUND_FORCE))
        }
        "kgf" => (Quantity::Force, "N", Some(GRAVITY)),
        "Pa" | "pa" | "pascal" => (Quantity::Pressure, "Pa", Some(1.0)),
        "hPa" | "hpa" | "mbar" => (Quantity::Pressure, "Pa", Some(1e2)),
        "kPa" | "kpa" => (Quantity::Pressure, "Pa", Some(1e3)),
        "uPa" | "upa" => (Quantity::Pressure, "Pa", Some(1e-6)),
        "mPa" => (Quantity::Pressure, "Pa", Some(1e-3)),
        "MPa" => (Quantity::Pressure, "Pa", Some(1e6)),
        "mpa" => (Quantity::Pressure, "Pa", None),
        "bar" => (Quantity::Pressure, "Pa", Some(1e5)),
        "psi" => (Quantity::Pressure, "Pa", Some(POUND_FORCE / (INCH * INCH))),
        "V" | "v" | "volt" | "volts" => (Quantity::Voltage, "V", Some(1.0)),
        "mV" | "mv" => (Quantity::Voltage, "V", Some(1e-3)),
        "uV" | "uv" => (Quantity::Voltage, "V", Some(1e-6)),
        "kV" | "kv" => (Quantity::Voltage, "V", Some(1e3)),
        "strain" | "m/m" | "mm/mm" | "in/in" => (Quantity::Strain, "m/m", Some(1.0)),
        "ustrain" | "microstrain" | "um/m" | "u\u{3b5}" => (Quantity::Strain, "m/m", Some(1e-6)),
        _ => return None,
    };
    let kind = match quantity {
        Quantity::Acceleration => "acceleration",
        Quantity::Force => "force",
        Quantity::Pressure => "pressure",
        Quantity::Voltage => "voltage",
        _ => "strain",
    };
    Some(Scale { quantity, kind, factor, si })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_tell_quantity_and_factor() {
        let factor = |label: &str| scale(label).and_then(|s| s.factor).unwrap();
        for label in ["m/s^2", "m/s2", "m/s\u{b2}", "m/s**2", "[m/s/s]", "m s^-2", "m\u{b7}s\u{207b}\u{b2}"] {
            let found = scale(label).unwrap();
            assert_eq!((found.quantity, found.factor), (Quantity::Acceleration, Some(1.0)), "{label}");
        }
        assert_eq!((factor("mm/s^2"), factor("um"), factor("\u{b5}m/s")), (1e-3, 1e-6, 1e-6));
        assert!((factor("g") - 9.806_65).abs() < 1e-12 && (factor("mg") - 9.806_65e-3).abs() < 1e-12);
        assert!((factor("deg") - 0.017_453_292_519_943_295).abs() < 1e-16 && factor("in") == 0.0254);
        assert!((factor("lbf") - 4.448_221_615_260_5).abs() < 1e-12 && factor("MN") == 1e6);
        assert!((factor("psi") - 6_894.757_293_168).abs() < 1e-8);
        assert_eq!(scale("mn").unwrap().factor, None);
    }

    #[test]
    fn quantities_that_are_no_motion_are_told() {
        for (label, quantity) in [
            ("Pa", Quantity::Pressure),
            ("kPa", Quantity::Pressure),
            ("V", Quantity::Voltage),
            ("mV", Quantity::Voltage),
            ("\u{b5}m/m", Quantity::Strain),
            ("N", Quantity::Force),
        ] {
            assert_eq!(scale(label).map(|s| s.quantity), Some(quantity), "{label}");
        }
        assert_eq!(scale("deg/s").map(|s| (s.quantity, s.si)), Some((Quantity::Velocity, "rad/s")));
        assert_eq!(scale("\u{b0}").map(|s| s.kind), Some("angle"));
        for label in ["", "furlong", "counts", "dB", "mol"] {
            assert_eq!(scale(label), None, "{label}");
        }
    }
}
