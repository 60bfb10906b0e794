//! Data of a shaker's test on one mode: steady responses, and backbones by phase resonance.

use crate::error::{Error, check};

/// One point of a stepped-sine response of one mode, as first harmonics; mass-normalised.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResponsePoint {
    /// Frequency of the excitation, Hz.
    pub frequency: f64,
    /// Amplitude of the modal displacement.
    pub amplitude: f64,
    /// Phase of the displacement against the force, rad: -π/2 in resonance.
    pub phase: f64,
    /// Amplitude of the modal force.
    pub force: f64,
}

/// One point of a backbone, from phase resonance or free decay; mass-normalised.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BackbonePoint {
    /// Amplitude of the modal displacement.
    pub amplitude: f64,
    /// Frequency, Hz.
    pub frequency: f64,
    /// Damping ratio.
    pub damping_ratio: f64,
}

/// One measurement of one day: all its points share one drift of the frequency.
#[derive(Debug, Clone, PartialEq)]
pub enum SteadyData {
    /// Responses under controlled force or controlled motion, at any number of levels.
    Response(Vec<ResponsePoint>),
    /// Frequency and damping against amplitude.
    Backbone(Vec<BackbonePoint>),
}

impl SteadyData {
    /// Number of points.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Response(points) => points.len(),
            Self::Backbone(points) => points.len(),
        }
    }

    /// Whether there is no point.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Amplitudes of the modal displacement.
    pub(super) fn amplitudes(&self) -> Vec<f64> {
        match self {
            Self::Response(points) => points.iter().map(|p| p.amplitude).collect(),
            Self::Backbone(points) => points.iter().map(|p| p.amplitude).collect(),
        }
    }

    /// Refuses points that cannot be computed with.
    pub(super) fn checked(&self) -> Result<(), Error> {
        let positive =
            |name, value: f64| check(name, value, value > 0.0, "must be > 0", "leave the point out");
        match self {
            Self::Response(points) => points.iter().try_for_each(|p| {
                positive("frequency", p.frequency)?;
                positive("amplitude", p.amplitude)?;
                positive("force", p.force)?;
                check("phase", p.phase, true, "must be a finite number of radians", "leave the point out")?;
                Ok(())
            }),
            Self::Backbone(points) => points.iter().try_for_each(|p| {
                positive("frequency", p.frequency)?;
                positive("amplitude", p.amplitude)?;
                positive("damping_ratio", p.damping_ratio)?;
                Ok(())
            }),
        }
    }
}
