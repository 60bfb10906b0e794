//! Corrections of the linear stiffness that would explain the misfit of a structure.

use iwan_fem::{Adjustable, Correction, Reduced};
use iwan_ident::estimate::least;
use serde::Serialize;

use super::fitted::Fit;
use super::task::{Placed, UpdateTask, model, modes_of, starts};
use super::verdict::{Passing, departures};

/// A correction is named where it leaves less than this part of the sum of squares: it must explain most of the misfit.
const EXPLAINS: f64 = 0.5;

/// A part of the stiffness whose correction by a factor would explain the misfit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LinearCorrection {
    /// Name of the part.
    pub name: String,
    /// Factor on its stiffness.
    pub factor: f64,
    /// Sum of squares with the correction over that without.
    pub remaining: f64,
    /// Whether the corrected structure describes all curves.
    pub adequate: bool,
}

/// Finds the single corrections of the linear stiffness that would explain the misfit.
pub(super) fn explanations(
    task: &UpdateTask<'_>,
    fit: &Fit<'_>,
    reduced: &Reduced<'_>,
    measured: &[Placed<'_>],
) -> Vec<LinearCorrection> {
    let structure = task.named.assembled.structure();
    let mut all: Vec<(String, Correction)> = Vec::new();
    if structure.given.is_none() {
        all.push(("material".into(), Correction::GeneralMaterial));
        let sets = structure.materials.iter().enumerate();
        all.extend(sets.map(|(n, (set, _))| (format!("material of {set}"), Correction::Material(n))));
    }
    let springs =
        structure.lumps.iter().enumerate().filter(|(_, lump)| lump.stiffness.iter().any(|k| *k > 0.0));
    all.extend(springs.map(|(n, lump)| (format!("springs of {}", lump.name), Correction::Springs(n))));
    all.retain(|(_, c)| task.corrections.iter().all(|own| own.1 != *c));
    let mut found = Vec::new();
    for (name, correction) in all {
        let mut with = task.clone();
        with.corrections.push((name.clone(), correction, None));
        let chosen: Vec<Correction> = with.corrections.iter().map(|c| c.1).collect();
        let Ok(adjustable) = Adjustable::new(reduced, &chosen) else { continue };
        let modes = modes_of(measured);
        let mut model = model(&with, &adjustable, measured, &modes);
        for (curve, own) in model.curves.iter_mut().zip(&fit.model.curves) {
            (curve.frequency_sd, curve.damping_sd) = (own.frequency_sd, own.damping_sd);
        }
        let place = model.first_factor() + task.corrections.len();
        let mut starts = starts(&with, measured, modes.len());
        let mut own = fit.found.x.clone();
        own.insert(place, 0.0);
        starts.push(own);
        let free: Vec<usize> = (0..model.bounds.len()).collect();
        let Ok(better) = least(&model, &starts, &free) else { continue };
        let remaining = better.cost / fit.found.cost.max(f64::MIN_POSITIVE);
        if remaining < EXPLAINS {
            let said = model.said_of_all(&better.x).unwrap_or_default();
            let pairs = measured.iter().zip(&said);
            let left = pairs.flat_map(|(p, s)| departures(&p.curve.mode, &p.points, s, Passing::REPEATS));
            let adequate = left.count() == 0 && !said.is_empty();
            found.push(LinearCorrection { name, factor: better.x[place].exp(), remaining, adequate });
        }
    }
    found.sort_by(|a, b| a.remaining.total_cmp(&b.remaining));
    found
}
