//! Random numbers that are the same on every machine and with every version.

/// SplitMix64: a stream of 64-bit numbers from a seed (G. L. Steele Jr., D. Lea, C. H. Flood, OOPSLA 2014,
/// doi:10.1145/2660193.2660195).
///
/// The state is a counter that grows by the odd 64-bit fraction of the golden ratio; each number is a mixture of the state's bits. The
/// generator is written here because a library's generator may change with the library's version, and with it the probes, start vectors and
/// synthetic noise.
///
/// ```
/// use iwan_core::SplitMix64;
/// // The first number of the stream of seed 0, as in the literature.
/// assert_eq!(SplitMix64::new(0).next_u64(), 0xe220_a839_7b1d_cdaf);
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SplitMix64 {
    state: u64,
}

impl SplitMix64 {
    /// The stream of a seed.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// The next number, all 64 bits of it random.
    pub const fn next_u64(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.state ^ (self.state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// The next number, uniform in [-1, 1): a multiple of 2⁻⁵² from the upper 53 bits.
    pub const fn next_symmetric(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}
