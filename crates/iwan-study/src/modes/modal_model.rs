//! The modal Iwan model of a mode, under the blows.

use iwan_core::FourParameter;
use iwan_ident::Parameters;
use iwan_sim::{JointLaw, Method, Mode, Representation, Settings, SimulationError, simulate};

use super::bending_mode::BendingMode;
use crate::blows::{DT, LEVELS, STEPS, blow};

/// Accelerations of the modal model under the blows of all levels, by the paper's scheme: average acceleration without
/// prewarping, as the truth is integrated.
pub(super) fn accelerations(
    mode: &BendingMode,
    parameters: &Parameters,
) -> Result<Vec<Vec<f64>>, SimulationError> {
    let law = FourParameter::new(parameters.k_t, parameters.f_s, parameters.chi, parameters.beta)?;
    let model = Mode {
        shape_at_force: mode.tip,
        ..Mode::new(mode.name.clone(), parameters.frequency, Some(JointLaw::FourParameter(law)))
    };
    let joint = Representation::default_sliders();
    let method = Method::Newmark { beta: 0.25, gamma: 0.5, prewarp: false, joint };
    let settings = Settings { dt: DT, duration: STEPS as f64 * DT, method, quality: false };
    let run = |level: &f64| simulate(&model, &blow(*level), &settings).map(|response| response.acceleration);
    LEVELS.iter().map(run).collect()
}
