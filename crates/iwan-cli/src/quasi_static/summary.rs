//! The summary of `iwan quasi-static`: `summary.json` and the table on the terminal.

use std::fmt::Write;

use serde::Serialize;

use super::analysis::Analysed;
use crate::page::numbers::{or_dash, short};
use crate::session::{Summary, Warnings};
use crate::structures::{Linear, Size};

/// A misfit above this gets a warning. The limit is a judgement: modes 1 and 3 of the paper's beam, whose links and washers slip at different forces,
/// have misfits of 0.21 and 0.25 over the default range and are warned about.
const LARGE_MISFIT: f64 = 0.1;

/// The summary of the modal curves of a structure.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct QuasiStaticSummary {
    /// The structure's title, or its name.
    pub(crate) structure: String,
    /// Numbers of nodes, elements, unknowns and joints.
    pub(crate) size: Size,
    /// One entry per mode.
    pub(crate) modes: Vec<ModeCurves>,
    /// What the user should look at.
    pub(crate) warnings: Warnings,
    /// Wall-clock time of assembly, modes, curves and fits, s.
    pub(crate) seconds: f64,
}

/// Curves and parameters of one mode; a linear mode has no parameters.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct ModeCurves {
    pub(crate) name: String,
    pub(crate) class: &'static str,
    /// Frequency with all joints stuck, Hz.
    pub(crate) frequency_stuck: f64,
    /// Frequency with all joints slipping, Hz.
    pub(crate) frequency_slipping: f64,
    pub(crate) mac: f64,
    /// Modal displacements, mass^½·length.
    pub(crate) displacement: Vec<f64>,
    /// Secant frequency, Hz.
    pub(crate) frequency: Vec<f64>,
    /// Energy dissipated per cycle.
    pub(crate) dissipation: Vec<f64>,
    /// Modal joint force: modal load α minus ω∞² q.
    pub(crate) joint_force: Vec<f64>,
    pub(crate) k_t: Option<f64>,
    pub(crate) f_s: Option<f64>,
    pub(crate) chi: Option<f64>,
    pub(crate) beta: Option<f64>,
    /// Largest relative difference of dissipation between the fitted joint and the structure.
    pub(crate) dissipation_misfit: Option<f64>,
    /// Largest difference of frequency between fit and structure, over the difference between the stuck and the slipping frequency.
    pub(crate) frequency_misfit: Option<f64>,
    /// Why there are no parameters, as a sentence.
    pub(crate) remark: Option<String>,
}

impl ModeCurves {
    fn new(linear: &Linear, analysed: &Analysed) -> Self {
        let fit = analysed.fit.as_ref().ok();
        let parameter = |get: fn(&iwan_ident::Parameters) -> f64| fit.map(|fit| get(&fit.parameters));
        let curves = &analysed.curves;
        Self {
            name: analysed.mode.name.clone(),
            class: analysed.mode.class.word(),
            frequency_stuck: linear.frequency_stuck(&analysed.mode),
            frequency_slipping: linear.frequency_slipping(&analysed.mode),
            mac: analysed.mode.pair.mac,
            displacement: curves.displacement.clone(),
            frequency: curves.frequency.clone(),
            dissipation: curves.dissipation.clone(),
            joint_force: curves.joint_force.clone(),
            k_t: parameter(|p| p.k_t),
            f_s: parameter(|p| p.f_s),
            chi: parameter(|p| p.chi),
            beta: parameter(|p| p.beta),
            dissipation_misfit: fit.map(|fit| fit.dissipation_misfit),
            frequency_misfit: fit.map(|fit| fit.frequency_misfit),
            remark: analysed.fit.as_ref().err().cloned(),
        }
    }

    fn warning(&self) -> Option<String> {
        if let Some(remark) = &self.remark {
            return Some(format!("{}: {remark}", self.name));
        }
        let (loss, frequency) = (self.dissipation_misfit?, self.frequency_misfit?);
        (loss > LARGE_MISFIT || frequency > LARGE_MISFIT).then(|| {
            format!(
                "{}: one four-parameter joint follows the curves to {:.0} % in dissipation and {:.0} % of the loss of \
                 frequency only: the structure's modal curve is not of that family",
                self.name,
                100.0 * loss,
                100.0 * frequency
            )
        })
    }
}

/// A note that names the displacement at which curves end before the largest one; none where they reach it.
fn end(analysed: &Analysed) -> Option<String> {
    let last = analysed.curves.displacement.last().filter(|_| !analysed.whole)?;
    let name = &analysed.mode.name;
    Some(format!(
        "{name}: the curves end at q = {last:.3e}: no static load holds the parts beyond, they slide freely"
    ))
}

impl QuasiStaticSummary {
    /// Makes the summary of a structure and its curves.
    pub(crate) fn new(linear: &Linear, analysed: &[Analysed], seconds: f64) -> Self {
        let modes: Vec<ModeCurves> = analysed.iter().map(|a| ModeCurves::new(linear, a)).collect();
        let chosen =
            |warning: &String| analysed.iter().any(|a| warning.starts_with(&format!("{}:", a.mode.name)));
        let of_modes = linear.warnings().into_iter().filter(|w| chosen(w) || w.contains("zero modes"));
        Self {
            structure: linear.file.title.clone().unwrap_or_else(|| linear.source.clone()),
            size: Size::of(linear),
            warnings: of_modes
                .chain(analysed.iter().filter_map(end))
                .chain(modes.iter().filter_map(ModeCurves::warning))
                .collect(),
            modes,
            seconds,
        }
    }
}

impl Summary for QuasiStaticSummary {
    fn warnings(&self) -> &[String] {
        &self.warnings
    }

    fn text(&self) -> String {
        let mut text = format!(
            "{:<14}{:>11}{:>14}{:>12}{:>12}{:>9}{:>9}{:>14}\n",
            "mode", "stuck, Hz", "slipping, Hz", "K_T, 1/s^2", "F_S", "chi", "beta", "misfit of D"
        );
        for mode in &self.modes {
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "{:<14}{:>11.4}{:>14.4}{:>12}{:>12}{:>9}{:>9}{:>14}",
                mode.name,
                mode.frequency_stuck,
                mode.frequency_slipping,
                or_dash(mode.k_t, short),
                or_dash(mode.f_s, short),
                or_dash(mode.chi, short),
                or_dash(mode.beta, short),
                or_dash(mode.dissipation_misfit, |m| format!("{:.1} %", 100.0 * m))
            );
        }
        text
    }
}
