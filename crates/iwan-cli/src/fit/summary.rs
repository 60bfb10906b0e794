//! The summary of a fit: `fit.json`, `summary.json` and the text on the terminal.

use std::fmt::Write;

use iwan_ident::density::FreeForm;
use iwan_ident::{Grade, Verdict};
use serde::Serialize;

use super::joint::{Estimate, JointFit};
use super::laws::{self, BackboneSummary, IWAN, LawSummary};
use crate::envelope::{RecordSummary, agreement};
use crate::identified::Identified;
use crate::records::{Axis, Recording, Units};
use crate::session::{Summary, Warnings};

/// The fit of one or several modes.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct FitSummary {
    pub(crate) records: Vec<RecordSummary>,
    pub(crate) modes: Vec<ModeFit>,
    /// What the reader of the records noticed, which is told before anything is computed, and then the models that do not match.
    pub(crate) warnings: Warnings,
    /// How many of the warnings are the reader's.
    #[serde(skip)]
    noticed: usize,
}

/// The fit of one mode.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct ModeFit {
    #[serde(flatten)]
    pub(crate) joint: JointFit,
    /// Root mean square of all residuals over the root mean square of the records.
    pub(crate) relative_residual: f64,
    /// The fit of a linear mode with viscous damping.
    pub(crate) linear: LinearSummary,
    /// What the records determine and what they leave open, in sentences.
    pub(crate) in_words: Vec<String>,
    /// Name of the simplest law that is as good as the best, or of the law that `--law` asked for.
    pub(crate) law: Option<String>,
    /// The choice of the law in a sentence, or why no laws were compared.
    pub(crate) law_in_words: String,
    pub(crate) laws: Vec<LawSummary>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) backbone: Option<BackboneSummary>,
    pub(crate) force_axis: &'static str,
    pub(crate) band: (f64, f64),
    /// For each record the displacement from which the mode is released in the model, and the time of release on the record's axis, s.
    pub(crate) releases: Vec<(f64, f64)>,
    /// Frequency at small amplitude in each record, Hz; it may drift from one record to the next (another day), and the mode's frequency is the mean.
    pub(crate) frequencies_of_records: Vec<f64>,
    pub(crate) notes: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) free_form: Option<DensitySummary>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) curves: Option<CurveSummary>,
}

/// The linear mode, and whether it is enough to explain the records.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct LinearSummary {
    pub(crate) is_enough: bool,
    pub(crate) frequency: f64,
    pub(crate) damping_ratio: f64,
    pub(crate) relative_residual: f64,
    pub(crate) criterion: f64,
}

/// The free-form density of slider strengths.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct DensitySummary {
    pub(crate) strength: Vec<f64>,
    pub(crate) density: Vec<f64>,
    pub(crate) frequency: f64,
    pub(crate) damping_ratio: f64,
    /// Smallest and largest strength about which the records give information.
    pub(crate) informed: (f64, f64),
    pub(crate) dissipation_misfit: f64,
    pub(crate) frequency_misfit: f64,
}

/// Curves of all records, one below the other; all vectors have the same length.
#[derive(Debug, Clone, Default, Serialize)]
pub(crate) struct CurveSummary {
    /// Number of the record, from 1.
    pub(crate) record: Vec<usize>,
    pub(crate) t: Vec<f64>,
    /// Amplitude in the unit of the record.
    pub(crate) amplitude: Vec<f64>,
    pub(crate) displacement: Vec<f64>,
    pub(crate) frequency: Vec<f64>,
    pub(crate) damping_ratio: Vec<f64>,
    pub(crate) dissipation: Vec<f64>,
    pub(crate) force: Vec<f64>,
}

impl FitSummary {
    /// Makes the summary of all modes.
    pub(crate) fn new(
        recordings: &[Recording],
        identified: &[Identified],
        axis: Axis,
        units: &Units,
    ) -> Self {
        let warnings: Warnings = recordings.iter().flat_map(|r| r.warnings.clone()).collect();
        Self {
            records: recordings.iter().map(|r| RecordSummary::new(r, units)).collect(),
            modes: identified.iter().map(|i| ModeFit::new(i, axis)).collect(),
            noticed: warnings.len(),
            warnings,
        }
    }

    /// What the reader of the records noticed.
    pub(crate) fn noticed(&self) -> &[String] {
        &self.warnings[..self.noticed]
    }

    /// Adds the warnings about modes whose models do not match, once it is known by which law each mode is described.
    pub(crate) fn judge(&mut self) {
        self.warnings.extend(self.modes.iter().flat_map(ModeFit::doubts));
    }

    /// Title of the scenario and the page.
    pub(crate) fn title(&self) -> String {
        let files: Vec<&str> = self.records.iter().map(RecordSummary::name).collect();
        format!("Fit of {}", files.join(", "))
    }

    /// The same summary without the long lists (curves, free-form density, backbone).
    pub(crate) fn without_curves(&self) -> Self {
        let mut short = self.clone();
        for mode in &mut short.modes {
            (mode.curves, mode.free_form, mode.backbone) = (None, None, None);
        }
        short
    }
}

impl Summary for FitSummary {
    fn warnings(&self) -> &[String] {
        &self.warnings[self.noticed..]
    }

    fn text(&self) -> String {
        let mut text: String = self.records.iter().map(RecordSummary::text).collect();
        self.modes.iter().for_each(|m| m.write(&mut text));
        text
    }
}

impl ModeFit {
    fn new(i: &Identified, axis: Axis) -> Self {
        let (found, p) = (&i.found, &i.found.parameters);
        let estimate = |parameter| Estimate::new(found.profile(parameter));
        let top = found.curves.iter().flat_map(|c| c.displacement.iter().copied()).fold(0.0, f64::max);
        let band = i.extractions[0].isolated.band;
        let releases = i.extractions.iter().enumerate().map(|(n, x)| {
            let start = found.refined.starts[n];
            (start.displacement, x.start + found.first_samples[n] as f64 * x.isolated.dt + start.time)
        });
        Self {
            joint: JointFit::new(&i.name, p, estimate, &found.verdict, top),
            relative_residual: found.refined.relative_residual,
            linear: LinearSummary {
                is_enough: found.needs_no_joint(),
                frequency: found.linear.frequency,
                damping_ratio: found.linear.damping_ratio,
                relative_residual: found.linear.relative_residual,
                criterion: found.linear.criterion,
            },
            in_words: in_words(i),
            law: found.laws.as_ref().ok().map(|laws| laws.chosen().law.name.to_string()),
            law_in_words: match &found.laws {
                Ok(laws) => laws.in_words(),
                Err(error) => format!("laws were not compared: {error}"),
            },
            laws: found.laws.as_ref().map(LawSummary::all).unwrap_or_default(),
            backbone: found.laws.as_ref().ok().map(|laws| BackboneSummary::new(&laws.backbone)),
            force_axis: if axis == Axis::Modal { "modal" } else { "joint" },
            band: (band.low, band.high),
            releases: releases.collect(),
            frequencies_of_records: found.refined.starts.iter().map(|s| s.of_day(p).frequency).collect(),
            notes: notes(i),
            free_form: i.densities.first().map(DensitySummary::new),
            curves: Some(CurveSummary::new(i)),
        }
    }

    /// Warnings where the joint or the chosen law does not match the records.
    fn doubts(&self) -> impl Iterator<Item = String> {
        let is_chosen = |law: &&LawSummary| Some(law.name) == self.law.as_deref() && law.name != IWAN;
        let law = self.laws.iter().find(is_chosen).filter(|law| law.grade == Grade::No.name());
        let law =
            law.map(|law| format!("{}: the law {} does not match these records.", self.joint.name, law.name));
        self.joint.doubt("these records").into_iter().chain(law)
    }

    /// Appends the text on the mode. Writing to a string cannot fail.
    fn write(&self, text: &mut String) {
        let enough = self.linear.is_enough && self.joint.adequate;
        let verdict =
            if enough { "a linear mode is enough, the joint is not needed" } else { self.joint.verdict() };
        let _ = writeln!(text, "\n{}: {verdict}\n", self.joint.name);
        self.joint.write(text);
        laws::write(&self.laws, self.law.as_deref().unwrap_or_default(), text);
        let _ = writeln!(text, "\n  {}", self.law_in_words);
        for words in self.in_words.iter().chain(&self.notes) {
            let _ = writeln!(text, "  {words}");
        }
    }
}

/// What the records determine and what they leave open, in sentences.
fn in_words(i: &Identified) -> Vec<String> {
    // The verdict compared here is the one by averaging on the curves, because the densities' misfits are of the same kind. A mode that the fit to
    // the records themselves matches counts as matched, too.
    let curves = &i.found.fit.verdict;
    let four = Verdict { adequate: curves.adequate || i.found.verdict.adequate, ..curves.clone() };
    let densities = i.densities.iter().map(|d| d.words(&four));
    i.found.in_words().into_iter().chain(densities).collect()
}

/// Notes on what was done with each record.
fn notes(i: &Identified) -> Vec<String> {
    let several = i.extractions.len() > 1;
    let mut notes: Vec<String> = Vec::new();
    for (n, x) in i.extractions.iter().enumerate() {
        let prefix = if several { format!("record {}: ", n + 1) } else { String::new() };
        let words = x.opinions.spread.as_ref().map(agreement);
        let own = x.notes.iter().cloned().chain(words).map(|w| format!("{prefix}{w}"));
        notes.extend(own);
    }
    for note in &i.found.notes {
        if !notes.iter().any(|n| n.ends_with(note.as_str())) {
            notes.push(note.clone());
        }
    }
    notes
}

impl DensitySummary {
    fn new(d: &FreeForm) -> Self {
        Self {
            strength: d.strength.clone(),
            density: d.density.clone(),
            frequency: d.frequency,
            damping_ratio: d.damping_ratio,
            informed: d.informed,
            dissipation_misfit: d.dissipation_misfit,
            frequency_misfit: d.frequency_misfit,
        }
    }
}

impl CurveSummary {
    fn new(i: &Identified) -> Self {
        let mut all = Self::default();
        for (n, c) in i.curves.iter().enumerate() {
            all.record.extend(std::iter::repeat_n(n + 1, c.t.len()));
            all.t.extend(c.t.iter().map(|t| i.extractions[n].start + t));
            all.amplitude.extend(&i.found.envelopes[n].amplitude);
            all.displacement.extend(&c.displacement);
            all.frequency.extend(&c.frequency);
            all.damping_ratio.extend(&c.damping_ratio);
            all.dissipation.extend(&c.dissipation);
            all.force.extend(&c.force);
        }
        all
    }
}
