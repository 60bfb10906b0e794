//! Modes with other laws than one Iwan joint, and modes by their curves, as a comparison of laws finds them.

use iwan_core::{Error, Motion};
use iwan_ident::laws::{Backbone, Joint, LawMode};
use iwan_sim::{Curves, JointLaw, Mode};

/// A mode of a law, released from rest at a displacement.
///
/// ```
/// use iwan_ident::laws::LawMode;
/// let law = LawMode { frequency: 10.0, damping_ratio: 1e-3, joint: None, parts: vec![] };
/// let mode = iwan_study::identified::mode_of_law("first", &law, 0.2);
/// assert!((mode.frequency_at(0.1).unwrap() - 10.0).abs() < 1e-12 && mode.initial.displacement == 0.2);
/// ```
#[must_use]
pub fn mode_of_law(name: &str, law: &LawMode, displacement: f64) -> Mode {
    let joint = law.joint.map(|joint| match joint {
        Joint::FourParameter(joint) => JointLaw::FourParameter(joint),
        Joint::Jenkins(joint) => JointLaw::Jenkins(joint),
    });
    Mode {
        damping_ratio: law.damping_ratio,
        parts: law.parts.clone(),
        initial: Motion::held_at(displacement),
        ..Mode::new(name, law.frequency, joint)
    }
}

/// A mode by smooth curves, released from rest at a displacement, or at the largest amplitude of the curves where that is smaller. A damping ratio
/// below zero, which noise may leave at small amplitudes, is set to zero.
///
/// # Errors
/// As [`Curves::new`].
pub fn mode_of_curves(name: &str, backbone: &Backbone, displacement: f64) -> Result<Mode, Error> {
    let damping = backbone.damping_ratio.iter().map(|z| z.clamp(0.0, MOST_DAMPING)).collect();
    let curves = Curves::new(backbone.amplitude.clone(), backbone.frequency.clone(), damping)?;
    let largest = backbone.amplitude.last().copied().unwrap_or(0.0);
    Ok(Mode { initial: Motion::held_at(displacement.min(largest)), ..Mode::by_curves(name, curves) })
}

/// Largest damping ratio of curves: [`Curves`] accepts only ratios below 1, and larger ones are set to this.
const MOST_DAMPING: f64 = 0.99;
