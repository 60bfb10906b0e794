//! Values of all modes in groups of four, which a processor handles in one instruction.

/// Number of values in a group.
pub const LANES: usize = 4;

/// Values of four modes.
pub type Lanes = [f64; LANES];

/// Number of groups that hold `count` values.
///
/// ```
/// assert_eq!([1, 4, 5].map(iwan_core::groups), [1, 1, 2]);
/// ```
#[must_use]
pub const fn groups(count: usize) -> usize {
    count.div_ceil(LANES)
}

/// Sum of the products of two rows of groups, lane by lane and then over the lanes.
#[inline]
pub(super) fn dot(a: &[Lanes], b: &[Lanes]) -> f64 {
    let mut sums = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        for l in 0..LANES {
            sums[l] += a[l] * b[l];
        }
    }
    (sums[0] + sums[2]) + (sums[1] + sums[3])
}
