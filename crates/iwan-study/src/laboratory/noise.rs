//! Sensor noise that is the same at every run and on every machine.

use iwan_core::SplitMix64;

/// A stream of normal random numbers by the polar method (G. Marsaglia, T. A. Bray, SIAM Review 6:260, 1964), which makes two numbers from each point
/// that falls into the unit circle.
#[derive(Debug, Clone)]
pub(super) struct Noise {
    numbers: SplitMix64,
    spare: Option<f64>,
}

impl Noise {
    /// The stream that belongs to a seed.
    pub(super) const fn new(seed: u64) -> Self {
        Self { numbers: SplitMix64::new(seed), spare: None }
    }

    /// The next number, of mean 0 and variance 1.
    pub(super) fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        loop {
            let (x, y) = (self.numbers.next_symmetric(), self.numbers.next_symmetric());
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
    }
}
