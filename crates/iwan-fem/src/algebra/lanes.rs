//! Values handled side by side, with sums in a fixed order for any width of the vector registers.
#![expect(clippy::inline_always, reason = "what is not inlined does not get the wide registers")]

/// Number of values in a group: one register of AVX-512, two of AVX2, four of SSE2. The number is fixed so that sums have one order, and
/// therefore the same bits, on every machine; another number would change the last digits of all results.
pub(crate) const LANES: usize = 8;

/// One value for each lane.
pub(crate) type Group = [f64; LANES];

/// Values in groups, the last one filled up with zeros.
pub(crate) fn grouped(values: &[f64]) -> Vec<Group> {
    let group = |part: &[f64]| std::array::from_fn(|lane| part.get(lane).copied().unwrap_or(0.0));
    values.chunks(LANES).map(group).collect()
}

/// Sum of a group.
#[inline(always)]
pub(crate) fn total(x: &Group) -> f64 {
    ((x[0] + x[4]) + (x[1] + x[5])) + ((x[2] + x[6]) + (x[3] + x[7]))
}
