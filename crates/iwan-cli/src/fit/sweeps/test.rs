//! A shaker's test of one mode, with or without ring-downs, and its fit.

use iwan_ident::likelihood::Likelihood;
use iwan_ident::sweeps::{SteadyData, SteadyFit, fit_steady};
use iwan_ident::{Error, Parameter};

use super::measurement::Measurement;

/// Name of the mode where no ring-down gives one.
const NAME: &str = "mode 1";

/// The measurements of a test.
#[derive(Debug, Clone)]
pub(crate) struct ShakerTest {
    /// Responses first, then backbones, each in the given order.
    pub(crate) measurements: Vec<Measurement>,
    pub(crate) ring_downs: Option<RingDowns>,
    /// Modal mass at the measured point; none where the measurements are modal quantities already.
    pub(crate) mass: Option<f64>,
}

/// Ring-downs that are fitted together with the sweeps.
#[derive(Debug, Clone)]
pub(crate) struct RingDowns {
    /// Names of their files.
    pub(crate) files: Vec<String>,
    /// The mode's name.
    pub(crate) mode: String,
    pub(crate) likelihood: Likelihood,
    /// Smallest and largest amplitude of the modal displacement in the ring-downs.
    pub(crate) informed: Option<[f64; 2]>,
}

impl ShakerTest {
    /// Name of the mode.
    pub(super) fn mode(&self) -> &str {
        self.ring_downs.as_ref().map_or(NAME, |r| &r.mode)
    }

    /// Files of the ring-downs.
    pub(super) fn records(&self) -> Vec<String> {
        self.ring_downs.as_ref().map_or_else(Vec::new, |r| r.files.clone())
    }

    /// Fits one mode to all measurements; parameters of `hold` keep their values. The range of informed amplitudes includes that of the ring-downs.
    pub(crate) fn fit(&self, hold: &[(Parameter, f64)]) -> Result<SteadyFit, Error> {
        let data: Vec<SteadyData> = self.measurements.iter().map(|m| m.data.clone()).collect();
        let mut fit = fit_steady(&data, self.ring_downs.as_ref().map(|r| &r.likelihood), hold)?;
        if let Some([low, high]) = self.ring_downs.as_ref().and_then(|r| r.informed) {
            fit.informed = [fit.informed[0].min(low), fit.informed[1].max(high)];
        }
        Ok(fit)
    }
}
