//! Fourier transforms whose plans serve again: a plan costs as much as a few transforms, and the records of a test have one length.

use std::collections::HashSet;
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

use rustfft::{Fft, FftDirection, FftPlanner};

/// Largest sum of the lengths of the plans that are kept. A plan takes some twenty bytes a sample, and a hundred where the length has a large prime factor. Before the sum is exceeded all plans
/// are forgotten, and made again when they are asked for.
const MOST: usize = 1 << 20;

/// Plans, and the lengths and directions for which there are some.
struct Plans {
    planner: FftPlanner<f64>,
    made: HashSet<(usize, bool)>,
    most: usize,
}

static PLANS: LazyLock<Mutex<Plans>> = LazyLock::new(|| Mutex::new(Plans::keeping(MOST)));

impl Plans {
    fn keeping(most: usize) -> Self {
        Self { planner: FftPlanner::new(), made: HashSet::new(), most }
    }

    fn of(&mut self, samples: usize, direction: FftDirection) -> Arc<dyn Fft<f64>> {
        let new = (samples, direction == FftDirection::Forward);
        let kept: usize = self.made.iter().map(|(samples, _)| samples).sum();
        if !self.made.contains(&new) && kept + samples > self.most {
            *self = Self::keeping(self.most);
        }
        self.made.insert(new);
        self.planner.plan_fft(samples, direction)
    }
}

/// The transform Σ x_n e^(-2πikn/N) of so many samples.
pub(crate) fn forward(samples: usize) -> Arc<dyn Fft<f64>> {
    PLANS.lock().unwrap_or_else(PoisonError::into_inner).of(samples, FftDirection::Forward)
}

/// The sum Σ X_k e^(2πikn/N) of so many lines.
pub(crate) fn inverse(samples: usize) -> Arc<dyn Fft<f64>> {
    PLANS.lock().unwrap_or_else(PoisonError::into_inner).of(samples, FftDirection::Inverse)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plans_serve_again_until_they_are_too_many() {
        let mut plans = Plans::keeping(2500);
        let first = plans.of(1000, FftDirection::Forward);
        assert!(Arc::ptr_eq(&first, &plans.of(1000, FftDirection::Forward)));
        let back = plans.of(1000, FftDirection::Inverse);
        assert_eq!((back.len(), back.fft_direction(), plans.made.len()), (1000, FftDirection::Inverse, 2));
        // A length that has no room beside these, and one that has none at all.
        for samples in [501, 5000] {
            assert_eq!((plans.of(samples, FftDirection::Forward).len(), plans.made.len()), (samples, 1));
        }
        assert!(!Arc::ptr_eq(&first, &plans.of(1000, FftDirection::Forward)));
    }
}
