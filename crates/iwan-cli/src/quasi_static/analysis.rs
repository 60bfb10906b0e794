//! The modal curves of a structure under static loads, and the modal joint that fits each.

use iwan_fem::{ModalCurves, NamedMode};
use iwan_ident::static_fit::{StaticCurves, StaticFit, fit_static};

use super::args::QuasiStaticArgs;
use crate::failure::Failure;
use crate::progress::Bar;
use crate::structures::Linear;

/// A mode with its curves and the joint fitted to them.
#[derive(Debug)]
pub(crate) struct Analysed {
    pub(crate) mode: NamedMode,
    pub(crate) curves: ModalCurves,
    /// Whether the curves reach the largest displacement that was asked for.
    pub(crate) whole: bool,
    /// The fitted modal Iwan joint, or why there is none.
    pub(crate) fit: Result<StaticFit, String>,
}

/// The curves of the modes that the options name, with the fitted joints.
pub(super) fn analyse(linear: &Linear, args: &QuasiStaticArgs, bar: &Bar) -> Result<Vec<Analysed>, Failure> {
    if linear.assembled.slips().iter().all(|slip| slip.law.is_none()) {
        let message =
            format!("{}: the structure has no joint with a law: its modes are linear", linear.source);
        return Err(Failure::input(
            message,
            "add [[joint]] with slip = [{ direction = ..., law = { ... } }]",
        ));
    }
    let modes = linear.chosen(&args.modes).map_err(|error| linear.failed(&error))?;
    let mut analysed = Vec::new();
    for (n, mode) in modes.iter().enumerate() {
        if bar.report(n as f64 / modes.len() as f64).is_break() {
            return Err(Failure::Interrupted);
        }
        let displacements = displacements(linear, mode, args)?;
        // Curves end where the parts begin to slide freely. That is an error only where the user asked for larger displacements.
        let (own, one, given, all) = (linear.clone(), mode.clone(), displacements.clone(), args.to.is_some());
        let curves = bar.wait(move || own.static_curves(&one, &given, all))?;
        let curves = curves.map_err(|error| linear.failed(&error))?;
        let fit = fit(linear, mode, &curves);
        let whole = curves.displacement.len() == displacements.len();
        analysed.push(Analysed { mode: mode.clone(), curves, whole, fit });
    }
    Ok(analysed)
}

/// Modal displacements evenly spaced on a logarithmic scale.
fn displacements(linear: &Linear, mode: &NamedMode, args: &QuasiStaticArgs) -> Result<Vec<f64>, Failure> {
    let missing = linear.onset(mode).is_none() && (args.from.is_none() || args.to.is_none());
    if missing {
        let message = format!("{}: no joint slips in {}", linear.source, mode.name);
        return Err(Failure::input(message, "give --from and --to, or choose other modes with --mode"));
    }
    linear.amplitudes(mode, (args.from, args.to), args.points as usize).map_err(|error| {
        let message = format!("{}: {}: {error}", linear.source, mode.name);
        Failure::input(message, "give --from smaller than --to")
    })
}

/// The modal Iwan joint fitted to the curves, or why there is none.
fn fit(linear: &Linear, mode: &NamedMode, curves: &ModalCurves) -> Result<StaticFit, String> {
    let parts = StaticCurves {
        displacement: &curves.displacement,
        frequency: &curves.frequency,
        dissipation: &curves.dissipation,
    };
    fit_static(&parts, linear.frequency_stuck(mode), mode.pair.k_t).map_err(|error| error.to_string())
}
