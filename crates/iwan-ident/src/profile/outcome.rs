//! The results of profiles.

use crate::parameters::Parameter;

/// What the records tell about one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// The parameter.
    pub parameter: Parameter,
    /// Its value at the best fit.
    pub value: f64,
    /// Lower end of the 95 % interval; none: open.
    pub low: Option<f64>,
    /// Upper end of the 95 % interval; none: open.
    pub high: Option<f64>,
    /// The points at which the profile was computed, by ascending value; the 95 % limit of their deviance is [`Profiles::limit`].
    pub points: Vec<ProfilePoint>,
    /// Whether the parameter was given and not sought.
    pub held: bool,
}

/// A value of a parameter, and the deviance of the best fit with that value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProfilePoint {
    /// The value.
    pub value: f64,
    /// Rise of the weighted sum of squares over its least value, in units of the residuals' variance.
    pub deviance: f64,
}

impl Profile {
    /// Whether the records bound the parameter on both sides.
    #[must_use]
    pub fn identifiable(&self) -> bool {
        !self.held && self.low.is_some() && self.high.is_some()
    }
}

/// The profiles of all six parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Profiles {
    /// In the order of [`Parameter::ALL`].
    pub parameters: Vec<Profile>,
    /// Deviance at the ends of the intervals: the square of Student's t.
    pub limit: f64,
    /// Variance of the whitened residuals that the deviances are in units of.
    pub(crate) variance: f64,
}

impl Profiles {
    /// The same profiles with the interval of a parameter widened to contain another interval: an end that is open in either of them is open.
    pub(crate) fn holding(mut self, parameter: Parameter, [low, high]: [Option<f64>; 2]) -> Self {
        let own = |profile: &&mut Profile| !profile.held && profile.parameter == parameter;
        for profile in self.parameters.iter_mut().filter(own) {
            // It tells nothing of a joint that its stiffness or slip force is above zero.
            let is_told = |low: &f64| *low > 0.0 || !matches!(parameter, Parameter::KT | Parameter::FS);
            profile.low = profile.low.zip(low).map(|(a, b)| a.min(b)).filter(is_told);
            profile.high = profile.high.zip(high).map(|(a, b)| a.max(b));
        }
        self
    }

    /// The same profiles where the records do not tell `parameters`: these intervals are open on both sides.
    pub(crate) fn without(mut self, parameters: &[Parameter]) -> Self {
        let open = |profile: &&mut Profile| !profile.held && parameters.contains(&profile.parameter);
        self.parameters
            .iter_mut()
            .filter(open)
            .for_each(|profile| (profile.low, profile.high) = (None, None));
        self
    }

    /// The same profiles where no value of `parameter` above a limit is told: an interval that reaches beyond the limit is open above.
    pub(crate) fn open_beyond(mut self, parameter: Parameter, limit: f64) -> Self {
        let beyond = |profile: &&mut Profile| {
            !profile.held && profile.parameter == parameter && profile.high.is_some_and(|high| high > limit)
        };
        self.parameters.iter_mut().filter(beyond).for_each(|profile| profile.high = None);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stiffness_above_zero_is_open_on_both_sides() {
        let one = |parameter| Profile {
            parameter,
            value: 2.0,
            low: Some(1.0),
            high: Some(3.0),
            points: vec![],
            held: false,
        };
        let parameters = vec![one(Parameter::KT), one(Parameter::DampingRatio)];
        let profiles = Profiles { parameters, limit: 4.0, variance: 1.0 };
        let profiles = profiles.holding(Parameter::KT, [Some(0.0), None]);
        let profiles = profiles.holding(Parameter::DampingRatio, [Some(0.0), Some(2.0)]);
        let ends: Vec<_> = profiles.parameters.iter().map(|p| (p.low, p.high)).collect();
        assert_eq!(ends, [(None, None), (Some(0.0), Some(3.0))]);
    }
}
