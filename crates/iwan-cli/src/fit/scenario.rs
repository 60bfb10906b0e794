//! A fit as a scenario that `iwan simulate` runs.

use iwan_core::Pulse;
use iwan_input::WrittenLaw;
use iwan_input::scenario::{Force, Scenario, ScenarioMode};
use iwan_sim::{Method, Settings};
use iwan_study::identified::time_step;

use crate::identified::Identified;

/// The fit as a scenario: each mode is released where the loudest record begins.
pub(crate) fn as_scenario(identified: &[Identified], title: &str) -> Result<Scenario, iwan_core::Error> {
    let mut modes = Vec::new();
    let (mut shortest, mut longest) = (f64::INFINITY, 0.0_f64);
    for i in identified {
        let (p, record) = (i.found.parameters, i.loudest());
        let joint = WrittenLaw::FourParameter { k_t: p.k_t, f_s: p.f_s, chi: p.chi, beta: p.beta };
        modes.push(ScenarioMode { mode: i.mode(record)?, joint: Some(joint) });
        let c = &i.comparisons[record];
        shortest = shortest.min(time_step(c.dt, p.frequency));
        longest = longest.max(c.record.len() as f64 * c.dt);
    }
    let settings = Settings { method: Method::HalfCycle, ..Settings::new(shortest, longest) };
    Ok(Scenario {
        title: Some(title.into()),
        modes,
        structure: None,
        force: Force::Formula("none", Pulse::None),
        settings,
        sweep: None,
    })
}
