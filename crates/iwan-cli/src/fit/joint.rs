//! A joint with a viscous damper as a fit found it, from ring-downs or from a shaker's test.

use std::fmt::Write;

use iwan_ident::profile::Profile;
use iwan_ident::{Grade, Parameter, Parameters, Verdict};
use maud::{Markup, html};
use serde::Serialize;

use crate::page::numbers::{self, long, short};

/// A parameter with its 95 % interval; null is an open end.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct Estimate {
    pub(crate) value: f64,
    pub(crate) low: Option<f64>,
    pub(crate) high: Option<f64>,
    pub(crate) identifiable: bool,
    pub(crate) held: bool,
}

/// The parameters of a mode, and how well a model with one joint agrees with the measurements.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct JointFit {
    pub(crate) name: String,
    pub(crate) frequency: Estimate,
    pub(crate) damping_ratio: Estimate,
    pub(crate) k_t: Estimate,
    pub(crate) f_s: Estimate,
    pub(crate) chi: Estimate,
    pub(crate) beta: Estimate,
    /// Displacement amplitude φ_max at the onset of macro-slip by these parameters.
    pub(crate) phi_max: f64,
    /// Largest measured amplitude over φ_max.
    pub(crate) slip_ratio: f64,
    pub(crate) adequate: bool,
    /// `matches`, `usable` or `no`.
    pub(crate) grade: &'static str,
    pub(crate) misfit: String,
    /// Root-mean-square misfits of ln D (D: dissipation per cycle) and of the frequency in Hz; beside them the measured frequency shift, Hz.
    pub(crate) dissipation_misfit: f64,
    pub(crate) frequency_misfit: f64,
    pub(crate) frequency_shift: f64,
}

impl Estimate {
    pub(super) fn new(profile: &Profile) -> Self {
        Self {
            value: profile.value,
            low: profile.low,
            high: profile.high,
            identifiable: profile.identifiable(),
            held: profile.held,
        }
    }
}

/// An interval as text, unless the value was held.
pub(crate) fn interval(e: &Estimate) -> String {
    if e.held { "held".into() } else { numbers::interval(e.low, e.high) }
}

impl JointFit {
    /// Makes the summary from the best parameters; `largest` is the largest measured amplitude.
    pub(crate) fn new(
        name: &str,
        parameters: &Parameters,
        estimate: impl Fn(Parameter) -> Estimate,
        verdict: &Verdict,
        largest: f64,
    ) -> Self {
        let phi_max = parameters.model().map_or(f64::NAN, |(_, joint)| joint.phi_max());
        Self {
            name: name.into(),
            frequency: estimate(Parameter::Frequency),
            damping_ratio: estimate(Parameter::DampingRatio),
            k_t: estimate(Parameter::KT),
            f_s: estimate(Parameter::FS),
            chi: estimate(Parameter::Chi),
            beta: estimate(Parameter::Beta),
            phi_max,
            slip_ratio: largest / phi_max,
            adequate: verdict.adequate,
            grade: verdict.grade.name(),
            misfit: verdict.misfit.clone(),
            dissipation_misfit: verdict.dissipation_misfit,
            frequency_misfit: verdict.frequency_misfit,
            frequency_shift: verdict.frequency_shift,
        }
    }

    /// The parameters with their names in tables, in the order of the tables.
    pub(crate) fn rows(&self) -> [(&'static str, &Estimate); 6] {
        [
            ("frequency, Hz", &self.frequency),
            ("viscous damping ratio", &self.damping_ratio),
            ("K_T", &self.k_t),
            ("F_S", &self.f_s),
            ("chi", &self.chi),
            ("beta", &self.beta),
        ]
    }

    /// The grade in words: whether the model matches, is usable or does not match.
    pub(crate) fn verdict(&self) -> &'static str {
        match self.grade {
            "matches" => "the model matches",
            "usable" => "the model is usable, but does not match",
            _ => "THE MODEL DOES NOT MATCH",
        }
    }

    /// The grade as a sentence about the data, which `measured` names, such as `these records`.
    pub(crate) fn sentence(&self, measured: &str) -> String {
        let says = match self.grade {
            "matches" => format!("matches {measured}"),
            "usable" => format!("is usable for {measured}, but does not match them"),
            _ => format!("does not match {measured}"),
        };
        format!("One four-parameter Iwan joint with a viscous damper {says}.")
    }

    /// The warning about a model that does not match what `measured` names; none for one that does, or is usable.
    pub(crate) fn doubt(&self, measured: &str) -> Option<String> {
        let sentence = || format!("{}: {} {}", self.name, self.sentence(measured), self.misfit);
        (self.grade == Grade::No.name()).then(sentence)
    }

    /// Appends the table for the terminal. Writing to a string cannot fail.
    pub(crate) fn write(&self, text: &mut String) {
        let _ = writeln!(text, "{:<24}{:>14}   95 % interval", "parameter", "value");
        for (label, e) in self.rows() {
            let _ = writeln!(text, "{label:<24}{:>14}   {}", long(e.value), interval(e));
        }
        let (phi_max, ratio) = (short(self.phi_max), short(self.slip_ratio));
        let _ = writeln!(text, "{:<24}{phi_max:>14}   largest amplitude / phi_max = {ratio}", "phi_max");
    }

    /// The table for a page, followed by the `further` rows.
    pub(crate) fn table(&self, further: &[(&str, String)]) -> Markup {
        html! {
            div.wide { table {
                thead { tr { th { "parameter" } th { "value" } th { "95 % interval" } } }
                tbody {
                    @for (label, e) in self.rows() { tr { th { (label) } td { (long(e.value)) } td { (interval(e)) } } }
                    tr { th { "\u{3c6}_max" } td { (short(self.phi_max)) } td {} }
                    tr { th { "largest amplitude / \u{3c6}_max" } td { (short(self.slip_ratio)) } td {} }
                    @for (label, value) in further { tr { th { (label) } td { (value) } td {} } }
                }
            } }
        }
    }
}
