//! The equation of steady vibration at one point. It is explicit in the amplitude, so that no response has to be solved for.

use std::f64::consts::{PI, TAU};

use iwan_core::{Backbone, FourParameter, Oscillator};
use rustfft::num_complex::Complex64;

use super::data::ResponsePoint;
use crate::error::Error;
use crate::parameters::Parameters;

/// Step in ln a of the derivative of stiffness and loss by ln a: both change by per cent a decade, and the weights need two digits.
const STEP: f64 = 1e-3;

/// A mode with the frequency of one day.
#[derive(Debug)]
pub(super) struct DayMode {
    joint: FourParameter,
    /// Stiffness without the joint, 1/s².
    k_inf: f64,
    /// Coefficient 2 ζ ω0 of the viscous damper, 1/s.
    viscous: f64,
    /// Static flexibility of all other modes at the measured point (modal displacement over modal force).
    others: f64,
}

impl DayMode {
    /// The mode of these parameters, with its frequency multiplied by e^`drift`.
    pub(super) fn new(p: &Parameters, others: f64, drift: f64) -> Result<Self, Error> {
        let (oscillator, joint) = p.model()?;
        let square = oscillator.omega0().powi(2);
        Ok(Self {
            k_inf: oscillator.k_inf() + square * (2.0 * drift).exp_m1(),
            viscous: viscous(&oscillator),
            joint,
            others,
        })
    }

    /// Complex stiffness of spring and joint at an amplitude `a`: harmonic stiffness and, as imaginary part, the loss D/(π a²); inertia and viscous damper are left out.
    fn complex_stiffness(&self, a: f64) -> Complex64 {
        let loss = self.joint.dissipation(a) / (PI * a * a);
        Complex64::new(self.k_inf + self.joint.harmonic_stiffness(a), loss)
    }

    /// Dynamic stiffness at an amplitude and a circular frequency: force over motion of the mode.
    fn dynamic_stiffness(&self, a: f64, omega: f64) -> Complex64 {
        self.complex_stiffness(a) + Complex64::new(-omega * omega, self.viscous * omega)
    }

    /// Force that is left unbalanced by the measured motion and force of a point.
    pub(super) fn unbalanced(&self, point: &ResponsePoint) -> Complex64 {
        let mode = self.of_mode(point);
        self.dynamic_stiffness(mode.norm(), TAU * point.frequency) * mode - point.force
    }

    /// The part of the measured motion that belongs to the mode, without the static flexibility of the others.
    fn of_mode(&self, point: &ResponsePoint) -> Complex64 {
        Complex64::from_polar(point.amplitude, point.phase) - self.others * point.force
    }

    /// Unbalanced force per relative error of the motion's amplitude, and per radian of its phase. (A relative error of the force leaves the force itself unbalanced.)
    pub(super) fn sensitivities(&self, point: &ResponsePoint) -> [Complex64; 2] {
        let (u, omega) = (Complex64::from_polar(point.amplitude, point.phase), TAU * point.frequency);
        let a = point.amplitude;
        let z = self.dynamic_stiffness(a, omega);
        let above = self.complex_stiffness(a * (1.0 + STEP));
        let slope = (above - self.complex_stiffness(a * (1.0 - STEP))) / (2.0 * STEP);
        [(z + slope) * u, z * u * Complex64::i()]
    }

    /// Frequency (Hz) and damping ratio of free vibration at an amplitude; none where no stiffness is left.
    pub(super) fn free(&self, a: f64) -> Option<[f64; 2]> {
        let k = self.complex_stiffness(a);
        (k.re > 0.0).then(|| {
            let omega = k.re.sqrt();
            [omega / TAU, 0.5 * (self.viscous / omega + k.im / k.re)]
        })
    }

    /// Stiffness and dissipation per cycle that a point of a response shows, with the frequency of free vibration; none where its stiffness or loss is not positive.
    pub(super) fn shown(&self, point: &ResponsePoint) -> Option<Shown> {
        let mode = self.of_mode(point);
        let omega = TAU * point.frequency;
        let z = point.force / mode;
        let stiffness = z.re + omega * omega;
        (stiffness > 0.0 && z.im > 0.0).then(|| Shown {
            amplitude: mode.norm(),
            frequency: stiffness.sqrt() / TAU,
            dissipation: PI * z.im * mode.norm_sqr(),
            size: z.norm(),
            loss: z.im,
        })
    }
}

/// What a point of a response shows of the mode whatever its law.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shown {
    pub(super) amplitude: f64,
    /// Frequency of free vibration, Hz.
    pub(super) frequency: f64,
    pub(super) dissipation: f64,
    /// Magnitude of the dynamic stiffness Z.
    pub(super) size: f64,
    /// Imaginary part of Z.
    pub(super) loss: f64,
}

fn viscous(oscillator: &Oscillator) -> f64 {
    2.0 * oscillator.damping_ratio() * oscillator.omega0()
}
