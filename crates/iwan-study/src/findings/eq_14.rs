//! Equation 14 of the paper: the search, on the truth's own curves, for the root β that the paper promises.

use iwan_core::{Backbone, FourParameter};
use iwan_fem::mesh::beam::Configuration;

use super::finding::{Finding, FindingKind, FindingNumber, number};
use crate::modes::{BendingMode, Eq14Axis, Eq14Root, StudiedMode};
use crate::printed::TABLE_2;
use crate::reproduction::Reproduction;
use iwan_sim::numbers::short;

/// Amplitude, as a multiple of φ_max, at which the coefficient of a law in micro-slip is computed. In micro-slip D/u^(χ+3) is the same at every
/// amplitude.
const DEEP: f64 = 1e-3;

/// Relative change of the micro-slip coefficient D/u^(χ+3), to which C is proportional, from β = 0 to the printed β of mode 1.
fn change_by_beta(mode: &BendingMode, f_s: f64, chi: f64) -> Option<f64> {
    let at = |beta: f64| {
        let law = FourParameter::new(mode.k_t, f_s, chi, beta).ok()?;
        let u = DEEP * law.phi_max();
        Some(law.dissipation(u) / u.powf(chi + 3.0))
    };
    Some(at(TABLE_2[0].beta)? / at(0.0)? - 1.0)
}

/// The finding on Eq. 14 with the truth's own curves; none where mode 1 of configuration A has no modal model.
pub(super) fn eq_14(found: &Reproduction) -> Option<Finding> {
    let first =
        |studied: &&StudiedMode| studied.mode.configuration == Configuration::A && studied.mode.index == 0;
    let StudiedMode { mode, counterpart } = found.modes().find(first)?;
    let slopes = mode.slopes.as_ref()?;
    let change = change_by_beta(mode, counterpart.as_ref()?.parameters.f_s, slopes.chi)?;
    let on = |axis: Eq14Axis| slopes.roots.iter().filter(move |root| root.axis == axis);
    let none = |axis: Eq14Axis| on(axis).all(|root: &Eq14Root| root.beta.is_none());
    let forces: Vec<String> = on(Eq14Axis::Joint).map(|root| short(root.f_s)).collect();
    let said = match (none(Eq14Axis::Joint), none(Eq14Axis::Modal)) {
        (true, true) => "has no root beta >= 0 on either axis, so that beta was sought by least squares",
        (true, false) => "has a root on the axis of modal force only",
        (false, true) => "has a root on the axis of joint force only",
        (false, false) => "has roots on both axes",
    };
    let uncoupled: Vec<String> =
        on(Eq14Axis::Uncoupled).map(|root| root.beta.map_or_else(|| "none".into(), short)).collect();
    let entry = |root: &Eq14Root| FindingNumber {
        name: format!("beta_{}_f_s_{}", root.axis.word(), short(root.f_s)),
        value: root.beta,
    };
    let mut numbers: Vec<FindingNumber> = slopes.roots.iter().map(entry).collect();
    numbers.push(number("coupling", mode.coupled()));
    numbers.push(number("intercept_joint_force", slopes.intercept_joint_force));
    numbers.push(number("intercept_modal_force", slopes.intercept_modal_force));
    numbers.push(number("change_of_c_for_beta_0_to_0_3", change));
    Some(Finding {
        id: "eq-14",
        kind: FindingKind::Corrected,
        title: "Eq. 14: K_x is the stiffness behind the force on the abscissa, and there may be no root",
        text: format!(
            "K_x turns a displacement into the force that is drawn: K_T for joint force, \u{3c9}\u{2080}\u{b2} for modal force; K\u{221e}, as \
             printed, belongs to neither. With the level C of mode 1 in configuration A and F_S = {} (fitted, static plateau, printed) Eq. 14 \
             {said}. The truth loses more than such a joint, because the modes couple: with the factor {:.2} of the coupling taken off, beta on \
             the axis of modal force is {}. From beta = 0 to 0.3 the level C changes by {:.1} % only: a fit on curves says little about (F_S, beta).",
            forces.join(", "),
            mode.coupled(),
            uncoupled.join(", "),
            100.0 * change.abs()
        ),
        numbers,
    })
}
