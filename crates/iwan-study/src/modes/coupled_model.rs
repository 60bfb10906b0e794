//! A model in place of modes that couple: linear modes with their joints stuck, which share the link's joint. Frequencies, slips and compliance are
//! those of the structure, the law is that of Table 1, and nothing is fitted.

use iwan_core::FourParameter;
use iwan_core::progress::UNWATCHED;
use iwan_fem::SlipStatics;
use iwan_sim::{
    JointLaw, Method, Mode, Representation, Settings, SharedJoint, SimulationError, simulate_coupled,
};

use super::counterpart::{Distance, SHOWN, distances};
use super::impact_curves::{Reading, readings};
use crate::beam::BeamUnderBlows;
use crate::blows::{DT, LEVELS, STEPS, blow};
use crate::error::Error;

/// A bending mode of the coupled model, compared with the truth.
#[derive(Debug, Clone)]
pub struct CoupledMode {
    /// Difference from the truth at each level.
    pub errors: Vec<Distance>,
    /// Modal accelerations at the levels [`SHOWN`].
    pub shown: Vec<Vec<f64>>,
    /// Readings at each level, early, in the middle and late in the record.
    pub readings: Vec<Vec<Reading>>,
}

/// The coupled model of a configuration.
#[derive(Debug, Clone)]
pub struct CoupledModel {
    /// The joint that all modes share.
    pub joint: SharedJoint,
    /// Bending modes 1 to 3.
    pub modes: Vec<CoupledMode>,
}

impl CoupledModel {
    /// Computes the coupled model of a configuration under all blows; none where its joints make no model of three modes that can be integrated.
    ///
    /// # Errors
    /// [`Error::Structure`] where statics fail, [`Error::Identification`] where a response cannot be read.
    pub fn new(truth: &BeamUnderBlows) -> Result<Option<Self>, Error> {
        let place = format!("{}, coupled modes", truth.beam.title());
        let (named, bending) = (&truth.beam.modes, &truth.beam.bending);
        let failed = Error::structure(&place);
        let load = named.assembled.load("tip", [0.0, 0.0, 1.0]).map_err(&failed)?;
        let statics = named.slip_flexibility(load).map_err(&failed)?.beside(bending);
        let law = iwan_fem::paper::joint().map_err(&failed)?;
        let Some(joint) = link(&statics, &law) else { return Ok(None) };
        let modes: Vec<Mode> = bending
            .iter()
            .zip(&truth.tip)
            .map(|(mode, tip)| Mode {
                shape_at_force: *tip,
                ..Mode::new(mode.name.clone(), named.frequency_stuck(mode), None)
            })
            .collect();
        let accelerations = match accelerations(&modes, &joint) {
            Ok(accelerations) => accelerations,
            // With too few modes for the compliance, a time step would not have one unique solution.
            Err(SimulationError::Joint { .. } | SimulationError::Parameter(_)) => return Ok(None),
            Err(error) => return Err(Error::simulation(&place)(error)),
        };
        let mode = |(index, levels): (usize, &Vec<Vec<f64>>)| {
            let stuck = modes[index].frequency;
            let readings = levels.iter().map(|samples| readings(samples, stuck)).collect::<Result<_, _>>();
            Ok(CoupledMode {
                errors: distances(truth, index, levels),
                shown: SHOWN.map(|n| levels[n].clone()).to_vec(),
                readings: readings.map_err(Error::identification(&place))?,
            })
        };
        let modes = accelerations.iter().enumerate().map(mode).collect::<Result<_, Error>>()?;
        Ok(Some(Self { joint, modes }))
    }
}

/// Combines slips that all move alike, as those at the link's two ends do, into one joint: the law times the number of slips, and the mean slip; none
/// where the slips do not move alike.
fn link(statics: &SlipStatics, law: &FourParameter) -> Option<SharedJoint> {
    let all: Vec<usize> = (0..statics.participation.len()).collect();
    let (groups, _) = statics.groups(&all, &|_, _| true);
    let [group] = &groups[..] else { return None };
    let count = group.members.len() as f64;
    let mut of_group = statics.of_groups(&groups);
    let law = FourParameter::new(count * law.k_t(), count * law.f_s(), law.chi(), law.beta()).ok()?;
    Some(SharedJoint {
        name: "link".into(),
        law: JointLaw::FourParameter(law),
        participation: of_group.participation.remove(0),
        compliance: of_group.compliance.remove(0),
        slip_at_force: of_group.at_force[0],
    })
}

/// Accelerations by mode and level, by the scheme of the truth: average acceleration without prewarping.
fn accelerations(modes: &[Mode], joint: &SharedJoint) -> Result<Vec<Vec<Vec<f64>>>, SimulationError> {
    let representation = Representation::default_sliders();
    let method = Method::Newmark { beta: 0.25, gamma: 0.5, prewarp: false, joint: representation };
    let settings = Settings { dt: DT, duration: STEPS as f64 * DT, method, quality: false };
    let joints = std::slice::from_ref(joint);
    let mut all = vec![Vec::new(); modes.len()];
    for level in LEVELS {
        let response = simulate_coupled(modes, joints, &blow(level), &settings, 1, UNWATCHED)?;
        for (own, mode) in all.iter_mut().zip(response.modes) {
            own.push(mode.acceleration);
        }
    }
    Ok(all)
}
