//! Helpers for several tests.

#![allow(dead_code, reason = "not every test uses all of it")]

use iwan_core::Samples;

/// Buffers for displacement, velocity, acceleration and joint force of a response.
pub(crate) struct Buffers(pub(crate) [Vec<f64>; 4]);

impl Buffers {
    pub(crate) fn new(samples: usize) -> Self {
        Self(std::array::from_fn(|_| vec![0.0; samples]))
    }

    pub(crate) fn samples(&mut self) -> Samples<'_> {
        let [displacement, velocity, acceleration, joint_force] = &mut self.0;
        Samples { displacement, velocity, acceleration, joint_force }
    }
}

/// Largest difference of `a` and `b`, relative to the largest value of `b`.
pub(crate) fn worst(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let peak = b.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    a.iter().zip(b).fold(0.0_f64, |m, (x, y)| m.max((x - y).abs())) / peak
}
