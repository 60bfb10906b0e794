//! From a structure to a scenario of coupled modes: its stuck modes, and the joints that they share.

use iwan_core::{Backbone, Pulse, Representation};
use iwan_fem::{NamedMode, NamedModes, SlipGroup, SlipStatics};
use iwan_sim::{Method, Mode, Point, Settings, SharedJoint, SimulationError, check_coupled};

use crate::error::InputError;
use crate::scenario::{Force, Scenario, ScenarioJoint, ScenarioMode};
use crate::structure::StructureFile;
use crate::written_law::WrittenLaw;

/// Samples in a cycle of the fastest mode, number of cycles of the slowest mode in the response, and length of the blow over the slowest
/// period: about those of the paper's own figures.
const SAMPLES: f64 = 100.0;
const CYCLES: f64 = 25.0;
const BLOW: f64 = 0.2;
/// Share of macro-slip to which the blow brings the first mode, approximately.
const REACH: f64 = 0.3;

/// A scenario of coupled modes, and remarks on it for the user.
#[derive(Debug, Clone)]
pub struct CoupledScenario {
    /// The scenario.
    pub scenario: Scenario,
    /// Remarks in words: joints that stay stuck, modes that were added.
    pub notes: Vec<String>,
}

/// Slips that move alike, and the law of each.
struct Group {
    slips: SlipGroup,
    law: WrittenLaw,
}

impl StructureFile {
    /// The coupled modal model of these modes. The participations b come from the stuck modes, the residual compliance ρ from statics; slips with the same law that move
    /// alike become one joint. Where these modes are too few for a model that can be stepped, the next modes are added.
    ///
    /// The scenario is stepped as a structure is, by average acceleration without prewarping, so that both responses can
    /// be compared at the same time step. Its force is a blow on the loads of the file, hard enough to bring
    /// the first mode near macro-slip.
    ///
    /// # Errors
    /// [`InputError`] where no joint slips in these modes, where a law is not one of the file, and where no number of modes gives a model
    /// that can be stepped.
    ///
    /// ```
    /// use iwan_fem::NamedModes;
    /// use iwan_input::{StructureFile, built_in_structure};
    /// let file = StructureFile::read(&built_in_structure("paper-a")?)?;
    /// let named = NamedModes::new(&file.structure, 12)?;
    /// let scenario = file.coupled(&named, &named.first_bending())?.scenario;
    /// assert_eq!((scenario.modes.len(), scenario.joints.len()), (3, 1));
    /// let joint = &scenario.joints[0].joint;
    /// assert!((5.5e5 * joint.compliance[0] - 0.2875).abs() < 1e-3); // two ends: twice K_T
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn coupled(&self, named: &NamedModes, modes: &[NamedMode]) -> Result<CoupledScenario, InputError> {
        let load = if self.loads.is_empty() {
            vec![0.0; named.assembled.unknowns()]
        } else {
            self.forces(&named.assembled)?
        };
        let (mut chosen, mut added) = (modes.to_vec(), Vec::new());
        let mut others = named.elastic.iter().filter(|mode| modes.iter().all(|m| m.name != mode.name));
        let flexibility = named.slip_flexibility(load.clone()).map_err(|error| failed(&error.to_string()))?;
        loop {
            let statics = flexibility.beside(&chosen);
            let (groups, stuck) = self.grouped(named, &statics)?;
            let scenario = self.scenario(named, &chosen, (&statics, &groups), &load)?;
            let refused = check_coupled(&scenario.modes(), &scenario.joints(), &scenario.settings).err();
            let Some(error) = refused else {
                return Ok(CoupledScenario { scenario, notes: notes(&stuck, &added) });
            };
            let next = others.next().filter(|_| is_of_compliance(&error));
            let Some(next) = next else { return Err(failed(&error.to_string())) };
            added.push(next.name.clone());
            chosen.push(next.clone());
        }
    }

    /// Groups of slips that these modes move, joined where they move alike; and the names of the slips that stay stuck.
    fn grouped(
        &self,
        named: &NamedModes,
        statics: &SlipStatics,
    ) -> Result<(Vec<Group>, Vec<String>), InputError> {
        let slips = named.assembled.slips();
        let mut laws: Vec<Option<&WrittenLaw>> = Vec::new();
        for slip in slips {
            let known = slip.law.as_ref().map(|law| {
                let written = self.laws.iter().find(|known| std::sync::Arc::ptr_eq(&known.law, law));
                written
                    .map(|known| &known.written)
                    .ok_or_else(|| failed(&format!("the law of {} is not one of this file", slip.name)))
            });
            laws.push(known.transpose()?);
        }
        let wanted: Vec<usize> = (0..slips.len()).filter(|i| laws[*i].is_some()).collect();
        let (groups, stuck) = statics.groups(&wanted, &|a, b| laws[a] == laws[b]);
        let group = |slips: SlipGroup| {
            let law = laws[slips.members[0].0].cloned()?;
            Some(Group { slips, law })
        };
        let groups: Vec<Group> = groups.into_iter().filter_map(group).collect();
        let stuck: Vec<String> = stuck.into_iter().map(|i| slips[i].name.clone()).collect();
        if groups.is_empty() {
            return Err(failed("no joint with a law slips in these modes"));
        }
        Ok((groups, stuck))
    }

    fn scenario(
        &self,
        named: &NamedModes,
        chosen: &[NamedMode],
        (statics, groups): (&SlipStatics, &[Group]),
        load: &[f64],
    ) -> Result<Scenario, InputError> {
        let dot = |shape: &[f64], f: &[f64]| shape.iter().zip(f).map(|(a, b)| a * b).sum::<f64>();
        let outputs = self.recorded(named, chosen)?.split_off(chosen.len());
        let modes: Vec<ScenarioMode> = chosen
            .iter()
            .map(|mode| {
                let shape = named.stuck.shape(mode.pair.stuck);
                let point =
                    |o: &iwan_fem::Output| Point { name: o.name.clone(), shape: dot(shape, &o.coefficients) };
                let mode = Mode {
                    shape_at_force: if self.loads.is_empty() { 1.0 } else { dot(shape, load) },
                    outputs: outputs.iter().map(point).collect(),
                    ..Mode::new(mode.name.clone(), named.frequency_stuck(mode), None)
                };
                ScenarioMode { mode, joint: None, informed: None }
            })
            .collect();
        let members: Vec<SlipGroup> = groups.iter().map(|group| group.slips.clone()).collect();
        let of_groups = statics.of_groups(&members);
        let joints = (0..groups.len())
            .map(|g| joint(named, &of_groups, g, &groups[g]))
            .collect::<Result<Vec<_>, _>>()?;
        let frequencies = || modes.iter().map(|m| m.mode.frequency);
        let (slowest, fastest) =
            (frequencies().fold(f64::INFINITY, f64::min), frequencies().fold(0.0, f64::max));
        let method =
            Method::Newmark { beta: 0.25, gamma: 0.5, prewarp: false, joint: Representation::Continuum };
        let settings = Settings {
            method,
            ..Settings::new(rounded(1.0 / (SAMPLES * fastest), false), rounded(CYCLES / slowest, true))
        };
        let title = self.title.clone().unwrap_or_else(|| "Structure".into());
        Ok(Scenario {
            title: Some(format!("{title}: coupled modes")),
            force: self.blow(&modes, &joints),
            modes,
            joints,
            structure: None,
            settings,
            sweep: None,
        })
    }

    /// A blow that brings the first mode on which it acts near macro-slip; none where it acts on none.
    fn blow(&self, modes: &[ScenarioMode], joints: &[ScenarioJoint]) -> Force {
        let none = Force::Formula("none", Pulse::None);
        if self.loads.is_empty() {
            return none;
        }
        let of_mode = |(r, mode): (usize, &ScenarioMode)| {
            let reach = |j: &ScenarioJoint| j.joint.law.strengths().1 / j.joint.participation[r].abs();
            let onset = joints.iter().map(reach).fold(f64::INFINITY, f64::min);
            let (shape, f) = (mode.mode.shape_at_force.abs(), mode.mode.frequency);
            // The impulse I of a haversine is half its amplitude times its duration, and moves a mode by φ I/ω.
            let amplitude = 2.0 * REACH * onset * std::f64::consts::TAU * f / (shape * BLOW / f);
            (amplitude > 0.0 && amplitude.is_finite())
                .then(|| (rounded(amplitude, false), rounded(BLOW / f, true)))
        };
        match modes.iter().enumerate().find_map(of_mode) {
            Some((amplitude, duration)) => {
                Force::Formula("haversine", Pulse::Haversine { amplitude, duration })
            }
            None => none,
        }
    }
}

/// Group `g` of slips as one joint: m times the law, the mean of the slips, and ρ of the mean slip under a force that all share equally.
fn joint(
    named: &NamedModes,
    of_groups: &SlipStatics,
    g: usize,
    group: &Group,
) -> Result<ScenarioJoint, InputError> {
    let members = &group.slips.members;
    let law = group.law.times(members.len() as f64);
    let names: Vec<&str> = members.iter().map(|(i, _)| named.assembled.slips()[*i].name.as_str()).collect();
    let joint = SharedJoint {
        name: names.join(" + "),
        law: law.law().map_err(|error| failed(&error.to_string()))?,
        participation: of_groups.participation[g].clone(),
        compliance: of_groups.compliance[g].clone(),
        slip_at_force: of_groups.at_force[g],
    };
    Ok(ScenarioJoint { joint, law })
}

/// The next value below or above of the form 1, 2 or 5 times a power of ten.
fn rounded(value: f64, up: bool) -> f64 {
    let power = value.log10().floor() as i32;
    let steps = [1.0, 2.0, 5.0, 10.0].map(|m| {
        // Parsing the decimal text gives the f64 nearest to the value as it is written out.
        format!("{m}e{power}").parse::<f64>().unwrap_or(m * 10.0_f64.powi(power))
    });
    let fits = |x: &&f64| if up { **x >= value } else { **x <= value };
    let found = if up { steps.iter().find(fits) } else { steps.iter().rev().find(fits) };
    found.copied().unwrap_or(value)
}

/// Whether the error is about compliance, so that more modes, which replace compliance, would help.
fn is_of_compliance(error: &SimulationError) -> bool {
    let inner = match error {
        SimulationError::Joint { source, .. } => source,
        other => other,
    };
    matches!(inner, SimulationError::Parameter(iwan_core::Error::OutOfRange { .. }))
}

fn notes(stuck: &[String], added: &[String]) -> Vec<String> {
    let mut notes = Vec::new();
    if !stuck.is_empty() {
        notes.push(format!(
            "coupled.toml: these joints hardly slip in these modes and stay stuck: {}",
            stuck.join(", ")
        ));
    }
    if !added.is_empty() {
        let added = added.join(", ");
        notes.push(format!(
            "coupled.toml: further modes take part, without which no step has one solution: {added}"
        ));
    }
    notes
}

fn failed(message: &str) -> InputError {
    let remedy = "choose other modes with --mode, or simulate the structure itself";
    InputError::new(format!("no coupled modal model: {message}"), remedy)
}

#[cfg(test)]
mod tests {
    use super::rounded;

    #[test]
    fn numbers_are_rounded_to_one_digit() {
        assert_eq!(rounded(1.43e-5, false), 1e-5);
        assert_eq!([rounded(0.189, true), rounded(0.2, true), rounded(0.51, true)], [0.2, 0.2, 1.0]);
        assert_eq!([rounded(731.0, false), rounded(1.6e-3, true)], [500.0, 2e-3]);
    }
}
