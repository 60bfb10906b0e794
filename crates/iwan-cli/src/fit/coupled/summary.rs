//! The summary of a fit of modes that share joints.

use std::collections::BTreeMap;
use std::fmt::Write;

use iwan_ident::coupled::{CoupledEstimate, CoupledFit, FittedSharing, Misfit, Sharing, Unknown};
use iwan_study::update::Estimated;
use serde::Serialize;

use crate::page::numbers::{interval, long};
use crate::session::{Summary, Warnings};

/// A mode as linear oscillator, with its shape values at force and sensor where these were sought.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct CoupledModeSummary {
    pub(crate) name: String,
    pub(crate) frequency: Estimated,
    pub(crate) damping_ratio: Estimated,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) shape_at_force: Option<Estimated>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) shape_at_sensor: Option<Estimated>,
}

/// A joint.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct CoupledJointSummary {
    pub(crate) name: String,
    pub(crate) k_t: Estimated,
    pub(crate) f_s: Estimated,
    pub(crate) chi: Estimated,
    pub(crate) beta: Estimated,
    /// Slip per unit displacement of each mode that moves the joint, by name of the mode.
    pub(crate) participation: BTreeMap<String, Estimated>,
    /// Static compliance that the modes left out of the model give the joint, times K_T; dimensionless.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) compliance_k_t: Option<Estimated>,
    /// Slip under a unit load through the modes left out of the model; length over force.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) slip_at_force: Option<Estimated>,
}

/// Misfit of one mode of one record.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct MisfitSummary {
    pub(crate) record: String,
    pub(crate) mode: String,
    pub(crate) relative: f64,
}

/// One of the models compared.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct ModelSummary {
    pub(crate) name: String,
    pub(crate) joints: usize,
    pub(crate) unknowns: usize,
    pub(crate) criterion: f64,
    pub(crate) misfit: f64,
    pub(crate) held_out_misfit: Option<f64>,
    pub(crate) misfits: Vec<MisfitSummary>,
    pub(crate) held_out: Vec<MisfitSummary>,
    pub(crate) converged: bool,
}

/// A combination of unknowns and its standard deviation; null where the records do not determine it.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct CombinationSummary {
    pub(crate) deviation: Option<f64>,
    pub(crate) combination: String,
}

/// The whole summary.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct CoupledSummary {
    pub(crate) title: String,
    pub(crate) records: Vec<String>,
    pub(crate) held_out: Vec<String>,
    pub(crate) chosen: String,
    pub(crate) in_words: Vec<String>,
    pub(crate) modes: Vec<CoupledModeSummary>,
    pub(crate) joints: Vec<CoupledJointSummary>,
    pub(crate) models: Vec<ModelSummary>,
    pub(crate) told: Vec<CombinationSummary>,
    pub(crate) warnings: Warnings,
}

/// Unknowns whose share of a combination is below this are not named in it.
const NAMED: f64 = 0.2;

impl CoupledSummary {
    /// Makes the summary of a fit; `names` are the names of the modes, `records` and `held_out` those of the files.
    pub(super) fn new(
        fit: &CoupledFit,
        names: &[String],
        [records, held_out]: [Vec<String>; 2],
        mut warnings: Vec<String>,
    ) -> Self {
        let best = fit.best();
        let held = |value: f64| Estimated { value, low: Some(value), high: Some(value), identifiable: true };
        let of = |unknown: Unknown, value: f64| find(&fit.estimates, unknown).unwrap_or_else(|| held(value));
        let v = &best.values;
        let mode = |(r, name): (usize, &String)| CoupledModeSummary {
            name: name.clone(),
            frequency: of(Unknown::Frequency(r), v.frequency[r]),
            damping_ratio: of(Unknown::DampingRatio(r), v.damping_ratio[r]),
            shape_at_force: find(&fit.estimates, Unknown::ShapeAtForce(r)),
            shape_at_sensor: find(&fit.estimates, Unknown::ShapeAtSensor(r)),
        };
        let joint = |(j, law): (usize, &iwan_core::FourParameter)| {
            use iwan_core::Backbone;
            let moves = |r: &usize| v.participation[j][*r] != 0.0;
            let b = |r: usize| (names[r].clone(), of(Unknown::Participation(j, r), v.participation[j][r]));
            CoupledJointSummary {
                name: joint_name(best.sharing, j, names),
                k_t: of(Unknown::KT(j), law.initial_stiffness()),
                f_s: of(Unknown::FS(j), law.slip_force()),
                chi: of(Unknown::Chi(j), law.chi()),
                beta: of(Unknown::Beta(j), law.beta()),
                participation: (0..names.len()).filter(moves).map(b).collect(),
                compliance_k_t: find(&fit.estimates, Unknown::Compliance(j)),
                slip_at_force: find(&fit.estimates, Unknown::SlipAtForce(j)),
            }
        };
        warnings.extend(fit.warnings.clone());
        let open: Vec<String> = fit
            .estimates
            .iter()
            .filter(|e| !e.identifiable())
            .map(|e| unknown_name(e.unknown, best.sharing, names))
            .collect();
        if !open.is_empty() {
            warnings.push(format!("the records do not bound {}", open.join(", ")));
        }
        Self {
            title: format!("Coupled fit of {}", records.join(", ")),
            chosen: best.sharing.name(),
            in_words: fit.in_words(),
            modes: names.iter().enumerate().map(mode).collect(),
            joints: v.laws.iter().enumerate().map(joint).collect(),
            models: fit.models.iter().map(|m| model(m, names)).collect(),
            told: told(fit, names),
            records,
            held_out,
            warnings: warnings.into_iter().collect(),
        }
    }

    /// The summary without its long lists.
    pub(super) fn short(&self) -> Self {
        Self { told: Vec::new(), ..self.clone() }
    }
}

fn find(estimates: &[CoupledEstimate], unknown: Unknown) -> Option<Estimated> {
    let found = estimates.iter().find(|e| e.unknown == unknown)?;
    let (value, low, high) = (found.value, found.low, found.high);
    Some(Estimated { value, low, high, identifiable: found.identifiable() })
}

/// Name of joint number `j`.
pub(super) fn joint_name(sharing: Sharing, j: usize, names: &[String]) -> String {
    match sharing {
        Sharing::Uncoupled => format!("joint of {}", names[j]),
        Sharing::Shared(1) => "joint".into(),
        _ => format!("joint {}", j + 1),
    }
}

fn unknown_name(unknown: Unknown, sharing: Sharing, names: &[String]) -> String {
    let joint = |j: usize| joint_name(sharing, j, names);
    match unknown {
        Unknown::Frequency(r) => format!("frequency of {}", names[r]),
        Unknown::DampingRatio(r) => format!("damping_ratio of {}", names[r]),
        Unknown::KT(j) => format!("k_t of {}", joint(j)),
        Unknown::FS(j) => format!("f_s of {}", joint(j)),
        Unknown::Chi(j) => format!("chi of {}", joint(j)),
        Unknown::Beta(j) => format!("beta of {}", joint(j)),
        Unknown::Participation(j, r) => format!("participation of {} in {}", names[r], joint(j)),
        Unknown::Compliance(j) => format!("compliance of {}", joint(j)),
        Unknown::SlipAtForce(j) => format!("slip_at_force of {}", joint(j)),
        Unknown::ShapeAtSensor(r) => format!("shape_at_sensor of {}", names[r]),
        Unknown::ShapeAtForce(r) => format!("shape_at_force of {}", names[r]),
        Unknown::Displacement(..) | Unknown::Velocity(..) => "the begin of a record".into(),
    }
}

fn model(m: &FittedSharing, names: &[String]) -> ModelSummary {
    let of = |all: &[Misfit]| -> Vec<MisfitSummary> {
        all.iter()
            .map(|x| MisfitSummary {
                record: x.record.clone(),
                mode: names[x.mode].clone(),
                relative: x.relative,
            })
            .collect()
    };
    ModelSummary {
        name: m.sharing.name(),
        joints: m.values.laws.len(),
        unknowns: m.unknowns,
        criterion: m.criterion,
        misfit: m.misfit,
        held_out_misfit: m.held_out_misfit,
        misfits: of(&m.misfits),
        held_out: of(&m.held_out),
        converged: m.converged,
    }
}

fn told(fit: &CoupledFit, names: &[String]) -> Vec<CombinationSummary> {
    let one = |c: &iwan_ident::coupled::CoupledCombination| {
        let parts = c.direction.iter().zip(&fit.estimates).filter(|(share, _)| share.abs() >= NAMED);
        let words = parts
            .map(|(share, e)| format!("{share:+.2} {}", unknown_name(e.unknown, fit.best().sharing, names)));
        CombinationSummary {
            deviation: c.deviation.is_finite().then_some(c.deviation),
            combination: words.collect::<Vec<_>>().join(" "),
        }
    };
    // A combination of initial displacements and velocities alone names nothing that the user asked for, and is left out.
    fit.combinations.iter().map(one).filter(|c| !c.combination.is_empty()).collect()
}

impl Summary for CoupledSummary {
    fn warnings(&self) -> &[String] {
        &self.warnings
    }

    fn text(&self) -> String {
        let mut text = String::new();
        // Writing to a string cannot fail.
        for words in &self.in_words {
            let _ = writeln!(text, "{words}");
        }
        let _ = writeln!(text, "\n{:<24}{:<28}{:>14}  95 % interval", "of", "parameter", "value");
        for (of, name, e) in self.rows() {
            let _ = writeln!(text, "{of:<24}{name:<28}{:>14}  {}", long(e.value), interval(e.low, e.high));
        }
        let (a, b, c, d) = ("model", "misfit, %", "kept out, %", "criterion");
        let _ = writeln!(text, "\n{a:<14}{b:>12}{c:>14}{d:>12}");
        for m in &self.models {
            let held = m.held_out_misfit.map_or_else(|| "-".into(), |x| format!("{:.3}", 100.0 * x));
            let _ = writeln!(text, "{:<14}{:>12.3}{held:>14}{:>12.0}", m.name, 100.0 * m.misfit, m.criterion);
        }
        text
    }
}

impl CoupledSummary {
    /// Every estimate as a row: the mode or joint, the quantity, and the value with its interval.
    pub(super) fn rows(&self) -> Vec<(&str, String, Estimated)> {
        let mut rows = Vec::new();
        for mode in &self.modes {
            let name = mode.name.as_str();
            rows.push((name, "frequency, Hz".to_string(), mode.frequency));
            rows.push((name, "damping ratio".into(), mode.damping_ratio));
            rows.extend(mode.shape_at_force.map(|e| (name, "shape at the force".into(), e)));
            rows.extend(mode.shape_at_sensor.map(|e| (name, "shape at the sensor".into(), e)));
        }
        for joint in &self.joints {
            let name = joint.name.as_str();
            let four = [("K_T", joint.k_t), ("F_S", joint.f_s), ("chi", joint.chi), ("beta", joint.beta)];
            rows.extend(four.into_iter().map(|(label, e)| (name, label.to_string(), e)));
            // The first participation is 1 by the choice of units and is no estimate.
            let sought = joint.participation.iter().filter(|(_, e)| e.low != e.high || e.low.is_none());
            rows.extend(sought.map(|(mode, e)| (name, format!("slip in {mode}"), *e)));
            rows.extend(joint.compliance_k_t.map(|e| (name, "compliance times K_T".into(), e)));
            rows.extend(joint.slip_at_force.map(|e| (name, "slip at a unit force".into(), e)));
        }
        rows
    }
}
