//! Straight lines fitted to the logarithm of the dissipation in micro-slip, and the parameters that the paper's Sec. 2.5 reads off them.

use iwan_ident::curve_fit::beta_root;
use iwan_ident::curves::{Curves, ForceAxis, straight_line};
use serde::Serialize;

use super::static_loads::MICRO_SLIP;
use crate::blows::LEVELS;

/// Straight lines through ln D in micro-slip, and the values of χ and β from them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Slopes {
    /// Slope of ln D over ln q.
    pub over_displacement: f64,
    /// Slope of ln D over the logarithm of the modal joint force (ω² - ω∞²) q.
    pub over_joint_force: f64,
    /// Intercept ln C of that line.
    pub intercept_joint_force: f64,
    /// Slope of ln D over the logarithm of the modal force ω² q.
    pub over_modal_force: f64,
    /// Intercept ln C of that line.
    pub intercept_modal_force: f64,
    /// χ = slope over joint force - 3; the joint force is the paper's abscissa.
    pub chi: f64,
    /// The roots of Eq. 14 with each F_S on each axis that was tried.
    pub roots: Vec<Eq14Root>,
}

/// Which force is the abscissa of the line whose intercept enters Eq. 14. The choice also fixes K_x, the stiffness that turns a displacement into
/// that force.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Eq14Axis {
    /// Joint force, with K_x = K_T.
    Joint,
    /// Modal force, with K_x = ω0².
    Modal,
    /// Joint force with K_x = K_∞, as the paper prints it.
    Printed,
    /// Modal force, with the dissipation divided by the factor that the coupling with other modes adds.
    Uncoupled,
}

impl Eq14Axis {
    /// The axis as one word, used in names of numbers.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Joint => "joint",
            Self::Modal => "modal",
            Self::Printed => "printed",
            Self::Uncoupled => "uncoupled",
        }
    }
}

/// A root β of Eq. 14, or that there is none.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Eq14Root {
    /// The slip force that was tried.
    pub f_s: f64,
    /// The axis that was tried.
    pub axis: Eq14Axis,
    /// The root; none where no β >= 0 solves the equation.
    pub beta: Option<f64>,
}

/// Quantities of a mode that enter Eq. 14.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stiffnesses {
    /// K_T, 1/s².
    pub(super) k_t: f64,
    /// ω0², 1/s².
    pub(super) omega_squared: f64,
    /// Factor by which the mode dissipates more under an impact than alone.
    pub(super) coupled: f64,
}

impl Slopes {
    /// Fits the lines to the curves of the levels in micro-slip; `frequency` is ω0/2π in Hz.
    pub(super) fn new(curves: &[Curves], frequency: f64, k_t: f64) -> Option<Self> {
        let joint = ForceAxis::Joint { frequency, k_t };
        let quiet = curves.iter().zip(LEVELS).filter(|(_, level)| *level <= MICRO_SLIP);
        let (mut over_q, mut over_joint, mut over_modal) = (vec![], vec![], vec![]);
        for (curves, _) in quiet {
            let on_joint = curves.clone().on_axis(joint).ok()?;
            for i in (0..curves.t.len()).filter(|&i| curves.dissipation[i] > 0.0) {
                let d = curves.dissipation[i].ln();
                over_q.push((curves.displacement[i].ln(), d));
                over_modal.push((curves.force[i].ln(), d));
                over_joint.push((on_joint.force[i].ln(), d));
            }
        }
        let displacement = straight_line(&over_q)?;
        let (joint, modal) = (straight_line(&over_joint)?, straight_line(&over_modal)?);
        Some(Self {
            over_displacement: displacement.slope,
            over_joint_force: joint.slope,
            intercept_joint_force: joint.intercept,
            over_modal_force: modal.slope,
            intercept_modal_force: modal.intercept,
            chi: joint.slope - 3.0,
            roots: Vec::new(),
        })
    }

    /// Solves Eq. 14 for β with a given slip force on all axes.
    pub(super) fn try_eq_14(&mut self, f_s: f64, mode: Stiffnesses) {
        let Stiffnesses { k_t, omega_squared, coupled } = mode;
        let (joint, modal) = (self.over_joint_force - 3.0, self.over_modal_force - 3.0);
        let uncoupled = self.intercept_modal_force - coupled.ln();
        let tries = [
            (Eq14Axis::Joint, self.intercept_joint_force, k_t, joint),
            (Eq14Axis::Modal, self.intercept_modal_force, omega_squared, modal),
            (Eq14Axis::Printed, self.intercept_joint_force, omega_squared - k_t, joint),
            (Eq14Axis::Uncoupled, uncoupled, omega_squared, modal),
        ];
        let root = |(axis, intercept, k_x, chi)| {
            let beta = beta_root(intercept, k_x, k_t, f_s, chi);
            Eq14Root { f_s, axis, beta }
        };
        self.roots.extend(tries.map(root));
    }
}
