//! The results of the truth model for one bending mode: curves from impacts, curves from static loads, the coupling with other modes, and the
//! parameters read off as in the paper's Sec. 2.5.

use std::f64::consts::TAU;

use iwan_fem::ModalCurves;
use iwan_fem::mesh::beam::Configuration;
use iwan_ident::curves::{Curves, ForceAxis};
use iwan_ident::static_fit::StaticFit;

use super::impact_curves::{Reading, impact_curves, readings};
use super::slopes::{Slopes, Stiffnesses};
use super::static_loads::{Coupling, MICRO_SLIP, StaticLoads};
use crate::beam::BeamUnderBlows;
use crate::blows::LEVELS;
use crate::error::Error;

/// A bending mode of one configuration.
#[derive(Debug, Clone)]
pub struct BendingMode {
    /// The beam's configuration.
    pub configuration: Configuration,
    /// Index of the bending mode, 0 for bending 1.
    pub index: usize,
    /// Name, such as `bending 1`.
    pub name: String,
    /// Frequency with all joints stuck, ω0/2π in Hz.
    pub stuck: f64,
    /// Frequency with all joints slipping, ω∞/2π in Hz.
    pub slipping: f64,
    /// Modal assurance criterion between the stuck and the slipping shape.
    pub mac: f64,
    /// K_T = ω0² - ω∞², 1/s².
    pub k_t: f64,
    /// Mass-normalised shape at the loaded edge.
    pub tip: f64,
    /// Curves over modal force, one for each of the [`LEVELS`].
    pub curves: Vec<Curves>,
    /// Readings at each level, early, in the middle and late in the record.
    pub readings: Vec<Vec<Reading>>,
    /// Curves from static loads.
    pub static_curves: ModalCurves,
    /// Static curves at the displacements for which an independent program has computed them, too; mode 1 only.
    pub checked: ModalCurves,
    /// An Iwan joint fitted to the static curves; none for a mode without a joint.
    pub static_fit: Option<StaticFit>,
    /// Dissipation under an impact over that of the mode alone, for each level up to 1000 lbf.
    pub coupling: Vec<Coupling>,
    /// The same ratio for a ring-down in this mode alone, which should follow the static curves.
    pub alone: Option<Coupling>,
    /// Straight lines fitted to the dissipation in micro-slip.
    pub slopes: Option<Slopes>,
}

impl BendingMode {
    /// Bending mode `index` of a configuration.
    ///
    /// # Errors
    /// [`Error::Identification`] where a record has no envelope, [`Error::Structure`] where a static analysis fails.
    pub fn new(truth: &BeamUnderBlows, index: usize) -> Result<Self, Error> {
        let (modes, mode) = (&truth.beam.modes, &truth.beam.bending[index]);
        let (stuck, k_t) = (modes.frequency_stuck(mode), mode.pair.k_t);
        let place = format!("{}, {}", truth.beam.title(), mode.name);
        let said = Error::identification(&place);
        let samples = |n: usize| truth.responses[n].outputs[index].acceleration.as_slice();
        let each = 0..LEVELS.len();
        let curves: Result<Vec<_>, _> =
            each.clone().map(|n| impact_curves(samples(n), stuck, LEVELS[n] <= MICRO_SLIP)).collect();
        let curves = curves.map_err(&said)?;
        let readings: Result<Vec<_>, _> = each.map(|n| readings(samples(n), stuck)).collect();
        let readings = readings.map_err(&said)?;
        let ring_down = &truth.alone[index].outputs[index].acceleration;
        let ring_down = impact_curves(ring_down, stuck, true).map_err(&said)?;
        let loads = StaticLoads::new(truth, index, &curves, &ring_down);
        let loads = loads.map_err(Error::structure(&place))?;
        Ok(Self {
            configuration: truth.beam.configuration,
            index,
            name: mode.name.clone(),
            stuck,
            slipping: modes.frequency_slipping(mode),
            mac: mode.pair.mac,
            k_t,
            tip: truth.tip[index],
            slopes: Slopes::new(&curves, stuck, k_t),
            curves,
            readings,
            static_curves: loads.curves,
            checked: loads.checked,
            static_fit: loads.fit,
            coupling: loads.coupling,
            alone: loads.alone,
        })
    }

    /// Whether slipping joints soften the mode.
    #[must_use]
    pub fn has_joint(&self) -> bool {
        self.k_t > 0.0
    }

    /// The axis of modal joint force; the axis of modal force for a mode without joint.
    #[must_use]
    pub fn axis(&self) -> ForceAxis {
        if self.has_joint() {
            ForceAxis::Joint { frequency: self.stuck, k_t: self.k_t }
        } else {
            ForceAxis::Modal
        }
    }

    /// Factor by which the mode dissipates more under an impact than alone, averaged over the levels in micro-slip; 1 for a mode without joint.
    #[must_use]
    pub fn coupled(&self) -> f64 {
        let quiet = self.coupling.iter().filter(|c| c.level <= MICRO_SLIP);
        let (sum, count) = quiet.fold((0.0, 0.0), |(sum, n), c| (sum + c.mean, n + 1.0));
        if count > 0.0 { sum / count } else { 1.0 }
    }

    /// Solves Eq. 14 for β with a given slip force.
    pub(super) fn try_eq_14(&mut self, f_s: f64) {
        let omega_squared = (TAU * self.stuck).powi(2);
        let mode = Stiffnesses { k_t: self.k_t, omega_squared, coupled: self.coupled() };
        if let Some(slopes) = &mut self.slopes {
            slopes.try_eq_14(f_s, mode);
        }
    }
}
