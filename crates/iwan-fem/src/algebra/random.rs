//! Random numbers that are the same on every machine: probes of factors, directions of a search.

/// Numbers in [-1, 1) from a seed, the same everywhere (SplitMix64; G. L. Steele et al., OOPSLA 2014,
/// doi:10.1145/2660193.2660195).
pub(crate) fn random(count: usize, seed: u64) -> Vec<f64> {
    let mut state = seed;
    let next = |()| {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 * (2.0 / (1_u64 << 53) as f64) - 1.0
    };
    std::iter::repeat_n((), count).map(next).collect()
}
