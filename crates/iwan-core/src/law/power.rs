//! x^p at a fixed exponent, several times faster than a general `pow`.

/// Number of mantissa cells, 2^7. With it |δ| stays below 2^-8, and the first term that the series of six leaves out is below 2e-19 of the
/// value; the table takes 2 kB. With 64 cells that term would be 3e-17, still below rounding; with 32 cells 4e-15.
const CELLS: usize = 128;
/// Bits of the mantissa that number the cell: [`CELLS`] = 2^7.
const CELL_BITS: u32 = 7;
/// Number of binary exponents in the table, which reaches down to x = 2^-63 = 1e-19: no smaller displacement can be told from zero beside a
/// motion of φ_max. For smaller x `libm::pow` takes over, which is slower and as exact.
const OCTAVES: usize = 64;

/// The function x -> x^p, with p fixed at construction; made for 0 <= x <= 1.
///
/// x = 2^-e c (1 + δ) with c the middle of one of 128 mantissa cells, so
/// x^p = (2^-e)^p · c^p · (1 + δ)^p: two table entries and a binomial series of
/// six terms (the next is below 2^-56). Within 3 units in the last place of the exact
/// value; outside 2^-63 <= x < 2 it falls back to `libm::pow`.
///
/// ```
/// let root = iwan_core::FixedPower::new(0.5);
/// assert!((root.at(0.0625) - 0.25).abs() < 1e-15);
/// ```
#[derive(Debug, Clone)]
pub struct FixedPower {
    exponent: f64,
    series: [f64; 6],
    cells: [Cell; CELLS],
    octaves: [f64; OCTAVES],
}

/// One cell of the mantissa.
#[derive(Debug, Clone, Copy)]
struct Cell {
    /// 1/c of its middle.
    inverse: f64,
    /// c^p.
    power: f64,
}

impl FixedPower {
    /// Tables for the exponent `p` (0 < p <= 4 is what the joint laws need).
    #[must_use]
    pub fn new(exponent: f64) -> Self {
        let mut series = [exponent; 6];
        for k in 1..6 {
            series[k] = series[k - 1] * (exponent - k as f64) / (k as f64 + 1.0);
        }
        let mut cells = [Cell { inverse: 1.0, power: 1.0 }; CELLS];
        for (i, cell) in cells.iter_mut().enumerate() {
            let centre = 1.0 + (i as f64 + 0.5) / CELLS as f64;
            *cell = Cell { inverse: 1.0 / centre, power: libm::pow(centre, exponent) };
        }
        let mut octaves = [1.0; OCTAVES];
        for (e, octave) in (0_i32..).zip(octaves.iter_mut()) {
            *octave = libm::pow(libm::ldexp(1.0, -e), exponent);
        }
        Self { exponent, series, cells, octaves }
    }

    /// x^p.
    #[inline]
    #[must_use]
    pub fn at(&self, x: f64) -> f64 {
        /// Number of bits of the fraction of an IEEE 754 double.
        const FRACTION_BITS: u32 = f64::MANTISSA_DIGITS - 1;
        /// The exponent field of 1.0.
        const ONE: u64 = 1023;
        /// A mask with all bits of the fraction set.
        const FRACTION: u64 = (1 << FRACTION_BITS) - 1;
        /// Number of bits of the fraction below the cell's number.
        const BELOW_CELL: u32 = FRACTION_BITS - CELL_BITS;
        /// The bit that moves the start of a cell to its middle.
        const HALF_CELL: u64 = 1 << (BELOW_CELL - 1);
        let bits = x.to_bits();
        // For a negative x or x >= 2 the subtraction wraps round to a huge number, and `libm::pow` answers.
        let octave = ONE.wrapping_sub(bits >> FRACTION_BITS) as usize;
        if octave >= OCTAVES {
            return libm::pow(x, self.exponent);
        }
        let fraction = bits & FRACTION;
        let cell = self.cells[(fraction >> BELOW_CELL) as usize];
        let mantissa = f64::from_bits(fraction | ONE << FRACTION_BITS);
        let centre =
            f64::from_bits((fraction >> BELOW_CELL << BELOW_CELL) | HALF_CELL | ONE << FRACTION_BITS);
        let d = (mantissa - centre) * cell.inverse;
        let c = &self.series;
        let d2 = d * d;
        let tail = (c[0] + c[1] * d) + d2 * ((c[2] + c[3] * d) + d2 * (c[4] + c[5] * d));
        let head = self.octaves[octave] * cell.power;
        head + (head * d) * tail
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_pow_to_three_units_in_the_last_place() {
        for exponent in [0.001, 0.5, 0.7, 0.817, 0.952, 1.0, 1.7, 2.0] {
            let power = FixedPower::new(exponent);
            for i in 1..200_000_u32 {
                let x = libm::exp2(-f64::from(i) * 3.1e-4);
                let (found, exact) = (power.at(x), libm::pow(x, exponent));
                assert!(
                    (found - exact).abs() <= 3.0 * f64::EPSILON * exact,
                    "{x}^{exponent}: {found} {exact}"
                );
            }
        }
    }

    #[test]
    fn ends_of_the_table_fall_back_to_pow() {
        let power = FixedPower::new(0.7);
        assert_eq!(power.at(0.0), 0.0);
        assert!((power.at(1.0) - 1.0).abs() <= f64::EPSILON);
        assert_eq!(power.at(1e-300), libm::pow(1e-300, 0.7));
        assert_eq!(power.at(2.5), libm::pow(2.5, 0.7));
        assert!(power.at(f64::NAN).is_nan());
    }
}
