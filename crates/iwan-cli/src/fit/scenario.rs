//! A fit as scenarios that `iwan simulate` runs.

use iwan_core::Pulse;
use iwan_ident::laws::{Joint, LawMode};
use iwan_input::WrittenLaw;
use iwan_input::scenario::{Force, Scenario, ScenarioMode};
use iwan_sim::{Method, Settings};
use iwan_study::identified::{mode_of_curves, mode_of_law, time_step};

use super::laws::BY_CURVES;
use crate::failure::Failure;
use crate::identified::Identified;

/// The fit as a scenario in which each mode is released where its loudest record begins. `law` gives for each mode the name of its law, the name of
/// the curves, or none for the fitted Iwan joint.
pub(crate) fn as_scenario(
    identified: &[Identified],
    title: &str,
    law: impl Fn(&Identified) -> Option<String>,
) -> Result<Scenario, Failure> {
    let mut modes = Vec::new();
    let (mut shortest, mut longest) = (f64::INFINITY, 0.0_f64);
    let mut plain = true;
    for i in identified {
        let record = i.loudest();
        let mode = match law(i) {
            None => iwan(i, record)?,
            Some(law) => {
                plain = false;
                by_law(i, &law, record)?
            }
        };
        modes.push(mode);
        let c = &i.comparisons[record];
        shortest = shortest.min(time_step(c.dt, i.found.parameters.frequency));
        longest = longest.max(c.record.len() as f64 * c.dt);
    }
    let settings = Settings::new(shortest, longest);
    // The half-cycle map is exact for an Iwan joint and handles no other parts of a modal law.
    let method = if plain { Method::HalfCycle } else { settings.method };
    Ok(Scenario {
        title: Some(title.into()),
        modes,
        joints: Vec::new(),
        structure: None,
        force: Force::Formula("none", Pulse::None),
        settings: Settings { method, ..settings },
        sweep: None,
    })
}

fn failed(error: &iwan_core::Error) -> Failure {
    Failure::computation(error.to_string())
}

fn iwan(i: &Identified, record: usize) -> Result<ScenarioMode, Failure> {
    let p = i.found.parameters;
    let joint = WrittenLaw::FourParameter { k_t: p.k_t, f_s: p.f_s, chi: p.chi, beta: p.beta };
    let mode = i.mode(record).map_err(|e| failed(&e))?;
    Ok(ScenarioMode { mode, joint: Some(joint), informed: i.found.informed() })
}

fn by_law(i: &Identified, law: &str, record: usize) -> Result<ScenarioMode, Failure> {
    let missing = |why: &str| {
        let message = format!("{}: the law {law} could not be fitted: {why}", i.name);
        Failure::input(message, "leave --law out, or take a longer or louder record")
    };
    let found = i.found.laws.as_ref().map_err(|error| missing(&error.to_string()))?;
    let displacement = found.released[record];
    if law == BY_CURVES {
        if !found.backbone.is_curve() {
            return Err(missing(
                "the record tells frequency and damping at a single amplitude, or a frequency that jumps from one to the next, which is no curve of a mode",
            ));
        }
        let mode = mode_of_curves(&i.name, &found.backbone, displacement).map_err(|e| failed(&e))?;
        return Ok(ScenarioMode { mode, joint: None, informed: i.found.informed() });
    }
    let fitted = found.named(law).ok_or_else(|| missing("no parameters describe these records"))?;
    let mode = mode_of_law(&i.name, &fitted.mode, displacement);
    Ok(ScenarioMode { mode, joint: written(&fitted.mode), informed: i.found.informed() })
}

fn written(law: &LawMode) -> Option<WrittenLaw> {
    use iwan_core::Backbone;
    law.joint.map(|joint| match joint {
        Joint::FourParameter(j) => WrittenLaw::FourParameter {
            k_t: j.initial_stiffness(),
            f_s: j.slip_force(),
            chi: j.chi(),
            beta: j.beta(),
        },
        Joint::Jenkins(j) => WrittenLaw::Jenkins { k_t: j.initial_stiffness(), f_s: j.slip_force() },
    })
}
