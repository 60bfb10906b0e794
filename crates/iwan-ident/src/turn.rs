//! e^(-ix) by a table of angles and short series: a few times as fast as sine and cosine of the platform, and the same bits everywhere.

use std::f64::consts::TAU;

use rustfft::num_complex::Complex64;

/// Number of angles of the table in a whole turn: series of four terms for the rest of an angle, at most π/64, leave out less than 1e-16.
const PARTS: usize = 64;
/// Adding this number and subtracting it again rounds to the nearest whole number, because beyond 2^52 there are no fractions.
const ROUNDING: f64 = 6_755_399_441_055_744.0;
/// The angle between entries of the table, and the same in two parts. The first part has 30 binary digits, so that its product with the number of entries is exact for records
/// of 100,000 turns, and right to 1e-8 for millions; the second part also holds what 2π has beyond the digits of a double.
const STEP: f64 = TAU / PARTS as f64;
const STEP_FIRST: f64 = f64::from_bits(STEP.to_bits() & !((1 << 23) - 1));
const STEP_REST: f64 = (STEP - STEP_FIRST) + BEYOND_TAU / PARTS as f64;
/// 2π less the double nearest to it.
const BEYOND_TAU: f64 = 2.449293598294706e-16;

/// Cosine and sine of the angles of the table.
const TABLE: [[f64; 2]; PARTS] = {
    let mut table = [[0.0; 2]; PARTS];
    let mut k = 0;
    while k < PARTS {
        // Every angle is taken from the nearest axis, at most an eighth of a turn away, where the series are short.
        let quarter = (k + PARTS / 8) / (PARTS / 4) % 4;
        let over = k as f64 - ((k + PARTS / 8) / (PARTS / 4) * (PARTS / 4)) as f64;
        let x = over * STEP;
        let (mut cosine, mut sine, mut term, mut n) = (0.0, 0.0, 1.0, 1.0);
        while n < 30.0 {
            cosine += term;
            term *= x / n;
            sine += term;
            term *= -x / (n + 1.0);
            n += 2.0;
        }
        table[k] = match quarter {
            0 => [cosine, sine],
            1 => [-sine, cosine],
            2 => [-cosine, -sine],
            _ => [sine, -cosine],
        };
        k += 1;
    }
    table
};

/// Cosine and sine of an angle.
#[inline]
pub(crate) fn cosine_and_sine(angle: f64) -> [f64; 2] {
    let shifted = angle * (1.0 / STEP) + ROUNDING;
    let whole = shifted - ROUNDING;
    let x = (angle - whole * STEP_FIRST) - whole * STEP_REST;
    // The last binary digits of the shifted number are those of the whole number.
    let [c, s] = TABLE[shifted.to_bits() as usize % PARTS];
    let square = x * x;
    let sine = x * (1.0 - square * (1.0 / 6.0 - square * (1.0 / 120.0 - square * (1.0 / 5040.0))));
    let fall = square * (0.5 - square * (1.0 / 24.0 - square * (1.0 / 720.0 - square * (1.0 / 40320.0))));
    [c - (c * fall + s * sine), s - (s * fall - c * sine)]
}

/// e^(-ix).
#[inline]
pub(crate) fn turn(angle: f64) -> Complex64 {
    let [cosine, sine] = cosine_and_sine(angle);
    Complex64::new(cosine, -sine)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_those_of_the_platform() {
        for k in -200_000..200_000 {
            let angle = 0.0123 * f64::from(k);
            let error = (turn(angle) - Complex64::cis(-angle)).norm();
            assert!(error < 5e-16, "{angle}: {error:e}");
        }
        for (angle, least) in [(0.0, 1e-16), (1e-300, 1e-16), (-1e-9, 1e-16), (1e6, 1e-15), (-3e7, 1e-8)] {
            let error = (turn(angle) - Complex64::cis(-angle)).norm();
            assert!(error < least, "{angle}: {error:e}");
        }
        assert!(turn(f64::NAN).re.is_nan() && turn(f64::INFINITY).re.is_nan());
    }
}
