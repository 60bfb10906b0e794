//! Sensor noise that is the same every time and everywhere.
//!
//! SplitMix64 (G. L. Steele Jr., D. Lea, C. H. Flood, OOPSLA 2014, doi:10.1145/2660193.2660195) and the polar method of
//! Marsaglia and Bray (SIAM Review 6:260, 1964). A library's generator may change with its version; reports would with it.

/// A stream of random numbers.
#[derive(Debug, Clone)]
pub(crate) struct Noise {
    state: u64,
    spare: Option<f64>,
}

impl Noise {
    /// The stream of a seed.
    pub(crate) const fn new(seed: u64) -> Self {
        Self { state: seed, spare: None }
    }

    fn next(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.state ^ (self.state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in (-1, 1).
    fn uniform(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Normal with mean 0 and variance 1.
    pub(crate) fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        loop {
            let (x, y) = (self.uniform(), self.uniform());
            let square = x * x + y * y;
            if square > 0.0 && square < 1.0 {
                let factor = (-2.0 * square.ln() / square).sqrt();
                self.spare = Some(y * factor);
                return x * factor;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_normal_and_white() {
        let mut noise = Noise::new(1);
        let x: Vec<f64> = (0..100_000).map(|_| noise.normal()).collect();
        let mean = |f: &dyn Fn(usize) -> f64| (1..x.len()).map(f).sum::<f64>() / x.len() as f64;
        assert!(mean(&|i| x[i]).abs() < 0.01);
        assert!((mean(&|i| x[i] * x[i]) - 1.0).abs() < 0.02);
        assert!((mean(&|i| x[i].powi(4)) - 3.0).abs() < 0.1);
        assert!(mean(&|i| x[i] * x[i - 1]).abs() < 0.01);
        // The first number of the stream of seed 0, as in the literature.
        assert_eq!(Noise::new(0).next(), 0xe220_a839_7b1d_cdaf);
    }
}
