//! Tables 1 and 2 of the paper: printed and computed values.

use iwan_core::Backbone;
use iwan_ident::Parameters;
use serde::Serialize;

use crate::beam::letter;
use crate::error::Error;
use crate::modes::{Interval, StudiedMode};
use crate::printed::{PrintedJoint, TABLE_2};

/// The discrete joint as printed, and quantities that follow from it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Table1 {
    /// K_T, lbf/in.
    pub k_t: f64,
    /// F_S, lbf.
    pub f_s: f64,
    /// χ.
    pub chi: f64,
    /// β.
    pub beta: f64,
    /// Displacement φ_max at which macro-slip begins, in.
    pub phi_max: f64,
    /// Coefficient R of the density of slider strengths, lbf/in^(χ+2).
    pub r: f64,
    /// Stiffness S of the strongest sliders (the Dirac part of the density), lbf/in.
    pub s: f64,
    /// Energy dissipated per cycle at the onset of macro-slip, lbf·in.
    pub dissipation_at_phi_max: f64,
}

impl Table1 {
    /// Computes the table from [`iwan_fem::paper::joint`].
    ///
    /// # Errors
    /// None in fact: the printed joint is valid.
    ///
    /// ```
    /// let table = iwan_study::summary::Table1::new()?;
    /// assert_eq!((table.k_t, table.f_s, table.chi, table.beta), (2.75e5, 300.0, -0.3, 0.02));
    /// assert!((table.dissipation_at_phi_max / 1.092348096186569 - 1.0).abs() < 1e-12);
    /// # Ok::<(), iwan_study::Error>(())
    /// ```
    pub fn new() -> Result<Self, Error> {
        let law = iwan_fem::paper::joint().map_err(Error::structure("Table 1"))?;
        Ok(Self {
            k_t: law.k_t(),
            f_s: law.f_s(),
            chi: law.chi(),
            beta: law.beta(),
            phi_max: law.phi_max(),
            r: law.r(),
            s: law.s(),
            dissipation_at_phi_max: law.dissipation(law.phi_max()),
        })
    }
}

/// The four parameters of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct JointParameters {
    /// K_T.
    pub k_t: f64,
    /// F_S.
    pub f_s: f64,
    /// χ.
    pub chi: f64,
    /// β.
    pub beta: f64,
}

impl From<PrintedJoint> for JointParameters {
    fn from(PrintedJoint { k_t, f_s, chi, beta }: PrintedJoint) -> Self {
        Self { k_t, f_s, chi, beta }
    }
}

impl From<Parameters> for JointParameters {
    fn from(Parameters { k_t, f_s, chi, beta, .. }: Parameters) -> Self {
        Self { k_t, f_s, chi, beta }
    }
}

/// A mode's parameters: printed, fitted, and with intervals.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Table2Row {
    /// The beam's configuration.
    pub configuration: &'static str,
    /// Name, such as `bending 1`.
    pub mode: String,
    /// Parameters as the paper prints them.
    pub printed: JointParameters,
    /// Parameters as fitted here; none for a mode without joint.
    pub identified: Option<JointParameters>,
    /// χ read off the slope of the dissipation, as in Sec. 2.5.
    pub graphical_chi: Option<f64>,
    /// F_S as the plateau of the static joint force.
    pub static_f_s: Option<f64>,
    /// 95 % intervals from the records.
    pub intervals: Vec<Interval>,
    /// Whether the fit follows the curves.
    pub adequate: Option<bool>,
    /// How well the fit follows the curves, in words.
    pub verdict: String,
}

impl Table2Row {
    /// Makes the row of a mode.
    pub(super) fn new(studied: &StudiedMode) -> Self {
        let StudiedMode { mode, counterpart } = studied;
        let counterpart = counterpart.as_ref();
        let linear = || {
            format!(
                "K_T = {:.3e} is negative: slipping frees inertia and does not soften this mode; it is linear, and nothing is fitted",
                mode.k_t
            )
        };
        Self {
            configuration: letter(mode.configuration),
            mode: mode.name.clone(),
            printed: TABLE_2[mode.index].into(),
            identified: counterpart.map(|c| c.parameters.into()),
            graphical_chi: mode.slopes.as_ref().filter(|_| mode.has_joint()).map(|s| s.chi),
            static_f_s: mode.static_fit.map(|fit| fit.parameters.f_s),
            intervals: counterpart.map(|c| c.intervals.clone()).unwrap_or_default(),
            adequate: counterpart.map(|c| c.adequate),
            verdict: counterpart.map_or_else(linear, |c| c.misfit.clone()),
        }
    }
}
