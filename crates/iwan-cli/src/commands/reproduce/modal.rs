//! What the truth's records say about each bending mode: curves from impacts, curves from static loads, how far the modes
//! couple, and the parameters read off as in the paper's Sec. 2.5.

use std::f64::consts::TAU;

use iwan_fem::{ModalCurves, QuasiStatic};
use iwan_ident::curve_fit::beta_root;
use iwan_ident::curves::{Curves, ForceAxis, Quantity, straight_line};
use iwan_ident::signal::{Method, Options, envelope, spot};
use iwan_ident::static_fit::{StaticCurves, StaticFit, fit_static};
use serde::Serialize;

use super::truth::{DT, LEVELS, STEPS, Side};
use crate::failure::Failure;
use crate::linear::explain;

/// Levels up to this force, lbf, stay in micro-slip: slopes and ratios are taken there.
pub(crate) const MICRO_SLIP: f64 = 100.0;
/// Seconds cut off at either end of a record: the blow with its transients, and the end of the transform.
pub(super) const TRIM: f64 = 0.02;
/// Degrees of the polynomials in micro-slip, and where curves bend more.
const ORDERS: (usize, usize) = (3, 5);
/// Times at which amplitude, frequency and dissipation are read by demodulation, s.
const TIMES: [f64; 3] = [0.03, 0.1, 0.17];
/// Displacements of the static curves: smallest, largest, number.
const STATIC: (f64, f64, u32) = (1e-6, 0.1, 61);
/// Displacements of mode 1 at which an independent program computed the static curves.
const CHECKED: [f64; 4] = [1.989e-4, 1.983e-3, 9.949e-3, 4.981e-2];

/// A mode of one configuration.
#[derive(Debug)]
pub(crate) struct Study {
    pub(crate) configuration: &'static str,
    /// 0 for bending 1.
    pub(crate) index: usize,
    pub(crate) name: String,
    /// Hz.
    pub(crate) stuck: f64,
    pub(crate) slipping: f64,
    pub(crate) mac: f64,
    pub(crate) k_t: f64,
    /// Shape at the loaded edge.
    pub(crate) tip: f64,
    /// One per level, against modal force.
    pub(crate) curves: Vec<Curves>,
    /// By level, at the [`TIMES`].
    pub(crate) spots: Vec<Vec<Reading>>,
    pub(crate) static_curves: ModalCurves,
    pub(crate) checked: ModalCurves,
    pub(crate) static_fit: Option<StaticFit>,
    pub(crate) coupling: Vec<Coupling>,
    /// The same for a ring-down in this mode alone: the static curves are what it follows.
    pub(crate) alone: Option<Coupling>,
    pub(crate) slopes: Option<Slopes>,
}

/// The mode at one time of a record.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct Reading {
    pub(crate) t: f64,
    pub(crate) displacement: f64,
    pub(crate) frequency: f64,
    pub(crate) dissipation: f64,
}

/// Dissipation under an impact, which moves all modes, over that of the mode alone at the same amplitude.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct Coupling {
    pub(crate) level: f64,
    pub(crate) mean: f64,
    pub(crate) low: f64,
    pub(crate) high: f64,
}

/// Straight lines through ln D over micro-slip, and what they give for χ and β.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Slopes {
    /// Over ln q.
    pub(crate) over_displacement: f64,
    /// Over ln of the modal joint force (ω² - ω∞²) q, and the line's intercept ln C.
    pub(crate) over_joint_force: f64,
    pub(crate) intercept_joint_force: f64,
    /// Over ln of the modal force ω² q.
    pub(crate) over_modal_force: f64,
    pub(crate) intercept_modal_force: f64,
    /// χ = slope over joint force - 3, the paper's abscissa.
    pub(crate) chi: f64,
    /// Each F_S and K_x that was tried in Eq. 14.
    pub(crate) roots: Vec<Root>,
}

/// A root β of Eq. 14, or none.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Root {
    pub(crate) f_s: f64,
    /// `joint` with K_x = K_T, `modal` with K_x = ω0², `printed` with K_x = K_∞ on the joint axis; `uncoupled` is `modal` with
    /// what the other modes add to the dissipation taken off.
    pub(crate) axis: &'static str,
    pub(crate) beta: Option<f64>,
}

impl Study {
    /// Studies bending mode `index` of a configuration.
    pub(crate) fn new(side: &Side, index: usize) -> Result<Self, Failure> {
        let (linear, mode) = (&side.linear, &side.bending[index]);
        let (stuck, k_t) = (linear.frequency_stuck(mode), mode.pair.k_t);
        let said = |error: iwan_ident::Error| {
            Failure::Computation(format!("{}, {}: {error}", linear.source, mode.name))
        };
        let samples = |n: usize| side.responses[n].outputs[index].acceleration.as_slice();
        let each = 0..LEVELS.len();
        let curves: Result<Vec<_>, _> =
            each.clone().map(|n| self::curves(samples(n), stuck, LEVELS[n])).collect();
        let curves = curves.map_err(said)?;
        let spots: Result<Vec<_>, _> = each.map(|n| readings(samples(n), stuck)).collect();
        let ring_down = &side.alone[index].outputs[index].acceleration;
        let ring_down = self::curves(ring_down, stuck, MICRO_SLIP).map_err(said)?;
        let statics = Statics::new(side, index, (&curves, &ring_down));
        let statics = statics.map_err(|error| explain(&linear.source, &error))?;
        Ok(Self {
            configuration: side.name,
            index,
            alone: statics.alone,
            name: mode.name.clone(),
            stuck,
            slipping: linear.frequency_slipping(mode),
            mac: mode.pair.mac,
            k_t,
            tip: side.tip[index],
            coupling: statics.coupling,
            static_fit: static_fit(&statics.curves, stuck, k_t),
            slopes: slopes(&curves, stuck, k_t),
            spots: spots.map_err(said)?,
            curves,
            static_curves: statics.curves,
            checked: statics.checked,
        })
    }

    /// Whether joints soften the mode at all.
    pub(crate) fn has_joint(&self) -> bool {
        self.k_t > 0.0
    }

    /// The axis of modal joint force; the modal force for a mode without joint.
    pub(crate) fn axis(&self) -> ForceAxis {
        if self.has_joint() {
            ForceAxis::Joint { frequency: self.stuck, k_t: self.k_t }
        } else {
            ForceAxis::Modal
        }
    }

    /// Factor by which the mode loses more under an impact than alone, mean over micro-slip.
    pub(crate) fn coupled(&self) -> f64 {
        let quiet = self.coupling.iter().filter(|c| c.level <= MICRO_SLIP);
        let (sum, count) = quiet.fold((0.0, 0.0), |(sum, n), c| (sum + c.mean, n + 1.0));
        if count > 0.0 { sum / count } else { 1.0 }
    }

    /// Tries Eq. 14 with a slip force.
    pub(crate) fn try_eq_14(&mut self, f_s: f64) {
        let (k_t, omega_squared, coupled) = (self.k_t, (TAU * self.stuck).powi(2), self.coupled());
        let Some(slopes) = &mut self.slopes else { return };
        let (joint, modal) = (slopes.over_joint_force - 3.0, slopes.over_modal_force - 3.0);
        let tries = [
            ("joint", slopes.intercept_joint_force, k_t, joint),
            ("modal", slopes.intercept_modal_force, omega_squared, modal),
            ("printed", slopes.intercept_joint_force, omega_squared - k_t, joint),
            ("uncoupled", slopes.intercept_modal_force - coupled.ln(), omega_squared, modal),
        ];
        let root =
            |(axis, intercept, k_x, chi)| Root { f_s, axis, beta: beta_root(intercept, k_x, k_t, f_s, chi) };
        slopes.roots.extend(tries.map(root));
    }
}

/// Curves of one record. The modal filter has left one mode, so that nothing is filtered here.
fn curves(samples: &[f64], near: f64, level: f64) -> Result<Curves, iwan_ident::Error> {
    let order = if level <= MICRO_SLIP { ORDERS.0 } else { ORDERS.1 };
    let window = Some((TRIM, STEPS as f64 * DT - TRIM));
    let options =
        Options { near: Some(near), filter_order: 0, window, order: Some(order), ..Options::default() };
    Curves::new(&envelope(samples, DT, Method::Hilbert, &options)?, Quantity::Acceleration, ForceAxis::Modal)
}

fn readings(samples: &[f64], near: f64) -> Result<Vec<Reading>, iwan_ident::Error> {
    let one = |&t: &f64| {
        // Once more where the frequency was found: far from it a window weakens the amplitude.
        let first = spot(samples, DT, near, t)?;
        let found = spot(samples, DT, first.frequency, t)?;
        let omega = TAU * found.frequency;
        let displacement = found.amplitude / (omega * omega);
        let dissipation = TAU * found.decay_rate / omega * (omega * displacement).powi(2);
        Ok(Reading { t, displacement, frequency: found.frequency, dissipation })
    };
    TIMES.iter().map(one).collect()
}

/// What static loads say about a mode.
struct Statics {
    curves: ModalCurves,
    checked: ModalCurves,
    coupling: Vec<Coupling>,
    alone: Option<Coupling>,
}

impl Statics {
    /// With the curves of the impacts and of a ring-down in this mode alone to compare.
    fn new(
        side: &Side,
        index: usize,
        (impacts, ring_down): (&[Curves], &Curves),
    ) -> Result<Self, iwan_fem::Error> {
        let (linear, pair) = (&side.linear, &side.bending[index].pair);
        let slipping = linear.slipping.eigenvalue(pair.slipping);
        let analysis = linear.assembled.quasi_static(&linear.stuck, pair.stuck, slipping)?;
        let grid = |i: u32| STATIC.0 * (STATIC.1 / STATIC.0).powf(f64::from(i) / f64::from(STATIC.2 - 1));
        let grid: Vec<f64> = (0..STATIC.2).map(grid).collect();
        let compared = |level: f64, curves: &Curves| {
            if pair.k_t > 0.0 { coupling(&analysis, level, curves) } else { None }
        };
        let quiet = impacts.iter().zip(LEVELS).filter(|(_, level)| *level <= 10.0 * MICRO_SLIP);
        Ok(Self {
            curves: static_curves(&analysis, &grid)?,
            checked: analysis.curves(if index == 0 { &CHECKED } else { &[] })?,
            coupling: quiet.filter_map(|(curves, level)| compared(level, curves)).collect(),
            alone: compared(MICRO_SLIP, ring_down),
        })
    }
}

/// Static curves up to where parts begin to slide freely.
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

/// Entries of the curve that are compared with static loads.
const COMPARED: usize = 8;

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

fn slopes(curves: &[Curves], frequency: f64, k_t: f64) -> Option<Slopes> {
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
    let [displacement, joint, modal] =
        [&over_q, &over_joint, &over_modal].map(|points| straight_line(points));
    let (joint, modal) = (joint?, modal?);
    Some(Slopes {
        over_displacement: displacement?.slope,
        over_joint_force: joint.slope,
        intercept_joint_force: joint.intercept,
        over_modal_force: modal.slope,
        intercept_modal_force: modal.intercept,
        chi: joint.slope - 3.0,
        roots: Vec::new(),
    })
}
