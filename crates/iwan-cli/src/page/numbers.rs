//! Numbers as text, for tables on the terminal and on pages alike.

pub(crate) use iwan_sim::numbers::short;
use iwan_sim::numbers::significant;

/// A number with seven significant digits, as exactly as frequencies of ring-downs are known.
pub(crate) fn long(value: f64) -> String {
    significant(value, 7, 1e7)
}

/// An estimated error with two digits: only its order of magnitude matters.
pub(crate) fn error(value: f64) -> String {
    if value == 0.0 { "0".into() } else { format!("{value:.1e}") }
}

/// A number as the function `text` writes it, or a dash where there is none.
pub(crate) fn or_dash(value: Option<f64>, text: fn(f64) -> String) -> String {
    value.map_or_else(|| "-".into(), text)
}

/// An end of an interval may lie beyond the value shown by this part of the last digit: less than a thousandth of a tenth of the interval, and far
/// more than binary rounding.
const ROUNDING: f64 = 1e-3;

/// An interval as text; an open end is named as open. Closed ends are rounded outwards, so that the best value never lies outside the interval shown.
pub(crate) fn interval(low: Option<f64>, high: Option<f64>) -> String {
    match (low, high) {
        (Some(low), Some(high)) if low * high > 0.0 && is_wide(low / high) => {
            format!("{} to {}", short(low), short(high))
        }
        (Some(low), Some(high)) => {
            let exponent = exponent(low.abs().max(high.abs()));
            let size = 10_f64.powi(exponent);
            let (low, high) = (low / size, high / size);
            let decimals = decimals(high - low);
            let unit = 10_f64.powf(decimals as f64).round();
            // The rounding error of binary fractions must not move an end by a whole unit of the last digit.
            let (low, high) =
                ((low * unit + ROUNDING).floor() / unit, (high * unit - ROUNDING).ceil() / unit);
            let power = if exponent == 0 { String::new() } else { format!("e{exponent}") };
            format!("{low:.decimals$}{power} to {high:.decimals$}{power}")
        }
        (Some(low), None) => format!("> {}, open above", short(low)),
        (None, Some(high)) => format!("< {}, open below", short(high)),
        (None, None) => "open on both sides".into(),
    }
}

/// Whether ends of this ratio have no power of ten in common: the smaller one would be shown by a digit or none.
fn is_wide(ratio: f64) -> bool {
    !(1e-3..=1e3).contains(&ratio)
}

/// The power of ten that both ends of an interval share, chosen as [`short`] chooses it for a number of this size.
fn exponent(size: f64) -> i32 {
    let is_plain = size == 0.0 || (1e-3..1e5).contains(&size);
    if is_plain || !size.is_finite() { 0 } else { size.log10().floor() as i32 }
}

/// Number of decimals that shows both ends of an interval of this width to a tenth of the width or better: two digits of the width. At most 14, as
/// many as a number of size 1 has; 6 where the width is zero.
fn decimals(width: f64) -> usize {
    if width > 0.0 { (1 - width.log10().floor() as i32).clamp(0, 14) as usize } else { 6 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_ends_are_rounded_outwards_and_round_ends_stay() {
        assert_eq!(interval(Some(143.26), Some(149.74)), "143.2 to 149.8");
        assert_eq!(interval(Some(0.3), Some(0.35)), "0.300 to 0.350");
        assert_eq!(interval(Some(-0.2968), Some(-0.2711)), "-0.297 to -0.271");
        assert_eq!(interval(Some(124.0), Some(124.0)), "124.000000 to 124.000000");
        assert_eq!(interval(Some(-347_000.0), Some(-306_000.0)), "-3.47e5 to -3.06e5");
        assert_eq!(interval(Some(1.229_86e12), Some(1.271_79e12)), "1.229e12 to 1.272e12");
        assert_eq!(interval(Some(0.0), Some(2.5e-6)), "0.0e-6 to 2.5e-6");
        assert_eq!(interval(Some(-1.7e28), Some(-3.4e19)), "-1.700e28 to -3.400e19");
        assert_eq!(interval(None, Some(2.0)), "< 2.000, open below");
    }

    #[test]
    fn digits_are_significant_and_large_or_small_numbers_have_exponents() {
        let numbers =
            [0.0, -0.0, 1e-3, 0.0012345, 12.345, -123.456, 99_999.0, 1e5, 9.99e-4, f64::NAN, f64::INFINITY];
        let shown = numbers.map(short);
        assert_eq!(
            shown,
            [
                "0", "0", "0.001000", "0.001234", "12.35", "-123.5", "99999", "1.000e5", "9.990e-4", "NaN",
                "inf"
            ]
        );
        assert_eq!(long(80.123_456_78), "80.12346");
        assert_eq!((error(0.0), error(0.0123)), ("0".into(), "1.2e-2".into()));
    }
}
