//! The fit as a scenario that `iwan simulate` runs.

use iwan_core::{Backbone, Motion, Pulse};
use iwan_ident::coupled::{CoupledFit, CoupledRecord, Seen};
use iwan_input::WrittenLaw;
use iwan_input::scenario::{Force, Scenario, ScenarioJoint, ScenarioMode};
use iwan_sim::{JointLaw, Mode, Point, Settings, SharedJoint};

use super::summary::joint_name;

/// Time steps per cycle of the fastest mode.
const STEPS: f64 = 100.0;
/// Name of the point at which the sensor measures the sum of the modes.
const SENSOR: &str = "sensor";

/// Modes and joints of the chosen model as a scenario. A free decay starts from the initial motion of the record with the largest motion; for records
/// of a blow the modes start with the velocities that the blow's impulse gives them.
pub(super) fn scenario(
    title: &str,
    fit: &CoupledFit,
    names: &[String],
    records: &[CoupledRecord],
    seen: Seen,
) -> Scenario {
    let (best, v) = (fit.best(), &fit.best().values);
    let size = |record: &CoupledRecord| record.motions.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
    let loudest = (0..records.len()).max_by(|a, b| size(&records[*a]).total_cmp(&size(&records[*b])));
    let loudest = loudest.unwrap_or(0);
    let record = &records[loudest];
    let impulse = record.force.as_ref().map(|force| force.iter().sum::<f64>() * record.dt);
    let mode = |(r, name): (usize, &String)| {
        let begin = impulse.map_or(v.initial[loudest][r], |impulse| [0.0, v.shape_at_force[r] * impulse]);
        let outputs = if seen == Seen::Sum {
            vec![Point { name: SENSOR.into(), shape: v.shape_at_sensor[r] }]
        } else {
            Vec::new()
        };
        let mode = Mode {
            damping_ratio: v.damping_ratio[r],
            shape_at_force: v.shape_at_force[r],
            outputs,
            initial: Motion { displacement: begin[0], velocity: begin[1] },
            ..Mode::new(name.clone(), v.frequency[r], None)
        };
        ScenarioMode { mode, joint: None, informed: None }
    };
    let count = v.laws.len();
    let joint = |(j, law): (usize, &iwan_core::FourParameter)| {
        let mut compliance = vec![0.0; count];
        compliance[j] = v.compliance[j];
        let (k_t, f_s, chi, beta) = (law.initial_stiffness(), law.slip_force(), law.chi(), law.beta());
        ScenarioJoint {
            joint: SharedJoint {
                compliance,
                slip_at_force: v.slip_at_force[j],
                ..SharedJoint::new(
                    joint_name(best.sharing, j, names),
                    JointLaw::FourParameter(*law),
                    v.participation[j].clone(),
                    count,
                )
            },
            law: WrittenLaw::FourParameter { k_t, f_s, chi, beta },
        }
    };
    let fastest = v.frequency.iter().copied().fold(0.0, f64::max);
    Scenario {
        title: Some(title.into()),
        modes: names.iter().enumerate().map(mode).collect(),
        joints: v.laws.iter().enumerate().map(joint).collect(),
        structure: None,
        force: Force::Formula("none", Pulse::None),
        settings: Settings::new(
            record.dt.min(1.0 / (STEPS * fastest)),
            record.dt * record.motions[0].len() as f64,
        ),
        sweep: None,
    }
}
