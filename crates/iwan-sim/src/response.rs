//! The result of a simulation.

use std::collections::HashMap;

use iwan_core::{EnergyBalance, Samples};

use crate::mode::Mode;

/// How far a response can be trusted. All errors are relative to the peak displacement.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Quality {
    /// Estimated error of the time step, or, for methods without a time step, of the method. None if the estimate was not requested or the
    /// response is too short for it.
    pub time_step_error: Option<f64>,
    /// Estimated error from cutting the density into sliders; 0 for the continuum.
    pub discretisation_error: Option<f64>,
    /// Bound on the force error from reversals forgotten because the memory was full; 0 means exact.
    pub forgotten_force: f64,
    /// Times at which the amplitude of a mode given by curves is outside the curves.
    pub outside_curves: OutsideCurves,
}

/// Times at which the amplitude of a mode given by curves is outside the curves. There the values of the nearest point hold.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OutsideCurves {
    /// Time from which the amplitude stays below the smallest of the curves, s; none if the response ends inside the curves.
    pub below_from: Option<f64>,
    /// Time at which the amplitude first exceeds the largest of the curves, s; possible only where extrapolation is allowed.
    pub above_from: Option<f64>,
    /// Largest amplitude beyond the curves; 0 if the curves are not exceeded.
    pub largest_amplitude: f64,
}

/// Response of one mode: one sample per `dt`, the initial state first.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Response {
    /// Time between samples, s.
    pub dt: f64,
    /// Modal displacement q (mass^½·length).
    pub displacement: Vec<f64>,
    /// Modal velocity q'.
    pub velocity: Vec<f64>,
    /// Modal acceleration q''.
    pub acceleration: Vec<f64>,
    /// Modal joint force F_J with that of the parts. For a mode given by curves, its restoring force less that of the undamped linear mode
    /// at the smallest amplitude.
    pub joint_force: Vec<f64>,
    /// Energy balance over the whole response; with the half-cycle map, up to the last turning point in the response.
    pub energy: EnergyBalance,
    /// Error estimates.
    pub quality: Quality,
    /// Strength φ_max of the strongest slider; infinite for a linear mode.
    pub strongest: f64,
    /// Wall-clock time of the integration itself, s.
    pub seconds: f64,
}

impl Response {
    /// A response with room for `samples` samples, all zero.
    pub(crate) fn zeros(dt: f64, samples: usize) -> Self {
        Self::default().cleared(dt, samples)
    }

    /// A response with room for `samples` samples in the buffers of one that is no longer needed; the buffers may hold old values, which
    /// the caller overwrites.
    pub(crate) fn cleared(mut self, dt: f64, samples: usize) -> Self {
        for buffer in
            [&mut self.displacement, &mut self.velocity, &mut self.acceleration, &mut self.joint_force]
        {
            if buffer.capacity() < samples {
                // New zeroed memory comes from the system without being written.
                *buffer = vec![0.0; samples];
            } else {
                buffer.resize(samples, 0.0);
            }
        }
        let Self { displacement, velocity, acceleration, joint_force, .. } = self;
        let strongest = f64::INFINITY;
        Self { dt, displacement, velocity, acceleration, joint_force, strongest, ..Self::default() }
    }

    /// The buffers, borrowed for the core.
    pub(crate) fn samples(&mut self) -> Samples<'_> {
        Samples {
            displacement: &mut self.displacement,
            velocity: &mut self.velocity,
            acceleration: &mut self.acceleration,
            joint_force: &mut self.joint_force,
        }
    }

    /// Times of the samples, s.
    #[must_use]
    pub fn times(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        (0..self.displacement.len()).map(|n| n as f64 * self.dt)
    }

    /// Number of time steps.
    #[must_use]
    pub fn steps(&self) -> usize {
        self.displacement.len().saturating_sub(1)
    }

    /// Largest |q|.
    #[must_use]
    pub fn peak_displacement(&self) -> f64 {
        // Eight running maxima side by side, for speed alone: with a single one each sample would wait for the one before.
        let mut peaks = [0.0_f64; 8];
        let chunks = self.displacement.chunks_exact(peaks.len());
        let rest = chunks.remainder().iter().fold(0.0_f64, |peak, q| peak.max(q.abs()));
        for chunk in chunks {
            for (peak, q) in peaks.iter_mut().zip(chunk) {
                *peak = peak.max(q.abs());
            }
        }
        peaks.into_iter().fold(rest, f64::max)
    }

    /// Largest |q| in units of φ_max: macro-slip above 1.
    #[must_use]
    pub fn slip_ratio(&self) -> f64 {
        self.peak_displacement() / self.strongest
    }

    /// The figures that are kept of a response when its samples are not.
    #[must_use]
    pub fn totals(&self) -> Totals {
        Totals {
            dt: self.dt,
            steps: self.steps(),
            peak_displacement: self.peak_displacement(),
            peak_acceleration: self.acceleration.iter().fold(0.0, |most, a| most.max(a.abs())),
            final_displacement: self.displacement.last().copied().unwrap_or(0.0),
            energy: self.energy,
            quality: self.quality,
            strongest: self.strongest,
            seconds: self.seconds,
        }
    }
}

/// Figures of a mode's response, of constant size for any length of response.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Totals {
    /// Time between samples, s.
    pub dt: f64,
    /// Number of time steps.
    pub steps: usize,
    /// Largest |q|.
    pub peak_displacement: f64,
    /// Largest |q''|.
    pub peak_acceleration: f64,
    /// Displacement at the last sample.
    pub final_displacement: f64,
    /// Energy balance over the whole response.
    pub energy: EnergyBalance,
    /// Error estimates.
    pub quality: Quality,
    /// Strength φ_max of the strongest slider; infinite for a linear mode.
    pub strongest: f64,
    /// Wall-clock time of the integration itself, s.
    pub seconds: f64,
}

impl Totals {
    /// Largest |q| in units of φ_max: macro-slip above 1.
    #[must_use]
    pub fn slip_ratio(&self) -> f64 {
        self.peak_displacement / self.strongest
    }
}

/// Physical responses Σ φ_r q_r at the points named in the modes' outputs, as displacement, velocity and acceleration. Points are listed in
/// the order in which the modes first name them.
#[must_use]
pub fn superpose(modes: &[Mode], responses: &[Response]) -> Vec<(String, [Vec<f64>; 3])> {
    let mut points: Vec<(String, [Vec<f64>; 3])> = Vec::new();
    let mut places = HashMap::new();
    for (mode, response) in modes.iter().zip(responses) {
        let modal = [&response.displacement, &response.velocity, &response.acceleration];
        for point in &mode.outputs {
            let index = *places.entry(point.name.as_str()).or_insert_with(|| {
                points.push((point.name.clone(), modal.map(|samples| vec![0.0; samples.len()])));
                points.len() - 1
            });
            for (sum, samples) in points[index].1.iter_mut().zip(modal) {
                sum.iter_mut().zip(samples).for_each(|(s, q)| *s += point.shape * q);
            }
        }
    }
    points
}
