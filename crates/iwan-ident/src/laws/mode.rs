//! A mode whose damping and stiffness follow a law: linear part, joint and further parts, as a fit of laws finds them.

use iwan_core::{Backbone, FourParameter, Jenkins, ModalLaw, Oscillator, Part, ResidualStiffness};

use crate::error::Error;

/// A joint that a law may hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Joint {
    /// Segalman's four-parameter Iwan joint.
    FourParameter(FourParameter),
    /// One Jenkins element.
    Jenkins(Jenkins),
}

/// A mass-normalised mode with a law.
#[derive(Debug, Clone, PartialEq)]
pub struct LawMode {
    /// Frequency at small amplitude, Hz.
    pub frequency: f64,
    /// Viscous damping ratio.
    pub damping_ratio: f64,
    /// Its joint, if the law has one.
    pub joint: Option<Joint>,
    /// The further parts of the law.
    pub parts: Vec<Part>,
}

/// Slow motion at one amplitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rate {
    /// Decay rate -a'/a, 1/s.
    pub decay: f64,
    /// Circular frequency of the damped motion, rad/s.
    pub omega: f64,
}

impl LawMode {
    /// Decay rates and circular frequencies of free motions with the displacement `amplitudes` (mass-normalised), one per amplitude, by averaging.
    /// The viscous damper lowers the frequency to ω √(1-ζ²); what other parts do to the frequency at second order is left out.
    ///
    /// # Errors
    /// [`Error::Model`] when a value is out of range, or a softening spring leaves no stiffness.
    ///
    /// ```
    /// use iwan_core::{Coulomb, Part};
    /// use iwan_ident::laws::LawMode;
    /// let friction = Part::from(Coulomb::new(2.0)?);
    /// let mode = LawMode { frequency: 10.0, damping_ratio: 0.0, joint: None, parts: vec![friction] };
    /// // Dry friction takes 4F/k from the amplitude in a cycle: a' = -2F/(π ω), linear in time.
    /// let rates = mode.rates(&[0.1, 0.2])?;
    /// let slope = 2.0 * 2.0 / (std::f64::consts::PI * 20.0 * std::f64::consts::PI);
    /// assert!((rates[0].decay * 0.1 / slope - 1.0).abs() < 1e-12 && (rates[1].decay * 0.2 / slope - 1.0).abs() < 1e-12);
    /// # Ok::<(), iwan_ident::Error>(())
    /// ```
    pub fn rates(&self, amplitudes: &[f64]) -> Result<Vec<Rate>, Error> {
        let k_t = match &self.joint {
            Some(Joint::FourParameter(joint)) => joint.initial_stiffness(),
            Some(Joint::Jenkins(joint)) => joint.initial_stiffness(),
            None => 0.0,
        };
        let oscillator =
            Oscillator::new(self.frequency, self.damping_ratio, k_t, ResidualStiffness::Positive)?;
        let found = match &self.joint {
            Some(Joint::FourParameter(joint)) => {
                of_law(&ModalLaw::new(oscillator, Some(joint), &self.parts), amplitudes)
            }
            Some(Joint::Jenkins(joint)) => {
                of_law(&ModalLaw::new(oscillator, Some(joint), &self.parts), amplitudes)
            }
            None => of_law(&ModalLaw::<Jenkins>::new(oscillator, None, &self.parts), amplitudes),
        };
        found.ok_or(Error::Model(iwan_core::Error::OutOfRange {
            name: "amplitude",
            value: amplitudes.iter().copied().fold(0.0, f64::max),
            allowed: "must leave the mode a stiffness > 0: a spring that softens has taken all of it",
        }))
    }
}

fn of_law<B: Backbone>(law: &ModalLaw<'_, B>, amplitudes: &[f64]) -> Option<Vec<Rate>> {
    let viscous = 0.5 * law.oscillator().viscous();
    let rate = |a: &f64| {
        let (undamped, decay) = (law.frequency(*a), law.decay_rate(*a));
        let omega = ((undamped - viscous) * (undamped + viscous)).sqrt();
        (omega.is_finite() && decay.is_finite() && omega > 0.0).then_some(Rate { decay, omega })
    };
    amplitudes.iter().map(rate).collect()
}
