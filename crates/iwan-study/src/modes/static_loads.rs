//! Static loads on a mode: its curves, and by how much the mode dissipates more under an impact.

use iwan_fem::{ModalCurves, QuasiStatic};
use iwan_ident::curves::Curves;
use iwan_ident::static_fit::{StaticCurves, StaticFit, fit_static};
use serde::Serialize;

use crate::beam::BeamUnderBlows;
use crate::blows::LEVELS;

/// Levels up to this force, lbf, stay in micro-slip (the largest slip is 0.3 φ_max); slopes and ratios are taken from these levels.
pub const MICRO_SLIP: f64 = 100.0;
/// Levels up to this force, lbf, are compared with static loads. Beyond it, the curves of the impacts no longer belong to a single mode.
const COUPLED: f64 = 10.0 * MICRO_SLIP;
/// Smallest displacement of the static curves, √(lbf·in)·s: below the smallest in any record (2e-6, mode 3 at 1 lbf).
const SMALLEST: f64 = 1e-6;
/// Largest displacement of the static curves, √(lbf·in)·s: that of mode 1 after 5000 lbf. The curves end before it where parts begin to slide freely.
const LARGEST: f64 = 0.1;
/// Number of displacements: twelve per decade.
const POINTS: u32 = 61;
/// Displacements of mode 1 at which an independent program computed the static curves of configuration A, √(lbf·in)·s; `reproduce.json` holds our
/// values there, for comparison.
const CHECKED: [f64; 4] = [1.989e-4, 1.983e-3, 9.949e-3, 4.981e-2];
/// Number of points of a curve that are compared with static loads: each needs a static analysis of its own.
const COMPARED: usize = 8;

/// Dissipation under an impact, which moves all modes, over that of the mode alone at the same amplitude.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Coupling {
    /// Peak force of the impact, lbf.
    pub level: f64,
    /// Mean ratio over the compared points.
    pub mean: f64,
    /// Smallest ratio.
    pub low: f64,
    /// Largest ratio.
    pub high: f64,
}

/// Results of static loads on a mode.
pub(super) struct StaticLoads {
    pub(super) curves: ModalCurves,
    pub(super) checked: ModalCurves,
    pub(super) coupling: Vec<Coupling>,
    pub(super) alone: Option<Coupling>,
    pub(super) fit: Option<StaticFit>,
}

impl StaticLoads {
    /// Computes them for bending mode `index`; the curves of the impacts and of a ring-down in this mode alone are compared with the static ones.
    pub(super) fn new(
        truth: &BeamUnderBlows,
        index: usize,
        impacts: &[Curves],
        ring_down: &Curves,
    ) -> Result<Self, iwan_fem::Error> {
        let (modes, pair) = (&truth.beam.modes, &truth.beam.bending[index].pair);
        let slipping = modes.slipping.eigenvalue(pair.slipping);
        let analysis = modes.assembled.quasi_static(&modes.stuck, pair.stuck, slipping)?;
        let point = |i: u32| SMALLEST * (LARGEST / SMALLEST).powf(f64::from(i) / f64::from(POINTS - 1));
        let grid: Vec<f64> = (0..POINTS).map(point).collect();
        let compared = |level: f64, curves: &Curves| {
            if pair.k_t > 0.0 { coupling(&analysis, level, curves) } else { None }
        };
        let quiet = impacts.iter().zip(LEVELS).filter(|(_, level)| *level <= COUPLED);
        let curves = static_curves(&analysis, &grid)?;
        Ok(Self {
            checked: analysis.curves(if index == 0 { &CHECKED } else { &[] })?,
            coupling: quiet.filter_map(|(curves, level)| compared(level, curves)).collect(),
            alone: compared(MICRO_SLIP, ring_down),
            fit: static_fit(&curves, modes.stuck.frequency(pair.stuck), pair.k_t),
            curves,
        })
    }
}

/// Static curves, up to the displacement at which parts begin to slide freely.
fn static_curves(analysis: &QuasiStatic<'_>, displacements: &[f64]) -> Result<ModalCurves, iwan_fem::Error> {
    let reached = displacements.iter().take_while(|q| analysis.curves(&[**q]).is_ok()).count();
    analysis.curves(&displacements[..reached])
}

fn static_fit(curves: &ModalCurves, frequency: f64, k_t: f64) -> Option<StaticFit> {
    let parts = StaticCurves {
        displacement: &curves.displacement,
        frequency: &curves.frequency,
        dissipation: &curves.dissipation,
    };
    if k_t > 0.0 { fit_static(&parts, frequency, k_t).ok() } else { None }
}

fn coupling(analysis: &QuasiStatic<'_>, level: f64, curves: &Curves) -> Option<Coupling> {
    let stride = curves.t.len().div_ceil(COMPARED);
    let entries: Vec<usize> = (stride / 2..curves.t.len()).step_by(stride).collect();
    let displacements: Vec<f64> = entries.iter().map(|&i| curves.displacement[i]).collect();
    let alone = analysis.curves(&displacements).ok()?.dissipation;
    let ratios: Vec<f64> = entries.iter().zip(&alone).map(|(&i, d)| curves.dissipation[i] / d).collect();
    Some(Coupling {
        level,
        mean: ratios.iter().sum::<f64>() / ratios.len() as f64,
        low: ratios.iter().copied().fold(f64::INFINITY, f64::min),
        high: ratios.iter().copied().fold(f64::NEG_INFINITY, f64::max),
    })
}
