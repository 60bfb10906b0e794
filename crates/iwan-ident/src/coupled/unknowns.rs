//! The unknowns of modes that share joints, and the models that are compared.

use iwan_core::FourParameter;

use super::records::Seen;
use crate::parameters::Parameters;

/// A frequency moves by this share of itself when its coordinate moves by one: joints are worth some per cent.
const FREQUENCY_UNIT: f64 = 0.01;
/// A damping ratio of 0.1 % has the coordinate 1.
const DAMPING_UNIT: f64 = 1e-3;
/// Largest damping ratio, in that unit: above a half there is no ring-down.
const MOST_DAMPING: f64 = 500.0;
/// Range of χ: the law needs -1 < χ < 1.
pub(super) const CHI_RANGE: (f64, f64) = (-0.98, 0.98);
/// Most of K_T that can be the Dirac's, β/(1+β).
const MOST_DIRAC: f64 = 0.98;
/// Most of the joint's stiffness times the compliance of the modes left out: at 1 the step has no unique solution.
const MOST_COMPLIANCE: f64 = 0.95;
/// Modes with larger shapes or slips than this many times the first are in other units.
const MOST_SHAPE: f64 = 1e6;

/// Which modes share which joints.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sharing {
    /// No joint: linear modes with viscous damping.
    Linear,
    /// A joint for each mode, moved by it alone.
    Uncoupled,
    /// So many joints, each moved by all modes.
    Shared(usize),
}

impl Sharing {
    /// Name in results: `linear`, `uncoupled`, `shared 1`.
    #[must_use]
    pub fn name(self) -> String {
        match self {
            Self::Linear => "linear".into(),
            Self::Uncoupled => "uncoupled".into(),
            Self::Shared(joints) => format!("shared {joints}"),
        }
    }
}

/// One unknown number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unknown {
    /// Stuck frequency of a mode.
    Frequency(usize),
    /// Viscous damping ratio of a mode.
    DampingRatio(usize),
    /// K_T of a joint.
    KT(usize),
    /// F_S of a joint.
    FS(usize),
    /// χ of a joint.
    Chi(usize),
    /// β of a joint.
    Beta(usize),
    /// Slip of a joint in a unit displacement of a mode.
    Participation(usize, usize),
    /// Compliance of a joint through the modes left out, times its K_T.
    Compliance(usize),
    /// Shape of a mode at the sensor, over that of the first.
    ShapeAtSensor(usize),
    /// Shape of a mode at the load.
    ShapeAtForce(usize),
    /// Displacement of a mode at the first sample of a record.
    Displacement(usize, usize),
    /// Velocity of a mode there.
    Velocity(usize, usize),
}

/// Modes, joints and beginnings as numbers with units.
#[derive(Debug, Clone, PartialEq)]
pub struct Values {
    /// Stuck frequency of each mode, Hz.
    pub frequency: Vec<f64>,
    /// Viscous damping ratio of each mode.
    pub damping_ratio: Vec<f64>,
    /// Law of each joint.
    pub laws: Vec<FourParameter>,
    /// Slip of each joint in a unit displacement of each mode.
    pub participation: Vec<Vec<f64>>,
    /// Compliance ρ of each joint through the modes left out.
    pub compliance: Vec<f64>,
    /// Shape of each mode at the sensor.
    pub shape_at_sensor: Vec<f64>,
    /// Shape of each mode at the load.
    pub shape_at_force: Vec<f64>,
    /// Displacement and velocity of each mode at the begin of each record.
    pub initial: Vec<Vec<[f64; 2]>>,
}

/// A model: which numbers are unknown, and those that are not.
#[derive(Debug, Clone)]
pub(super) struct Form {
    pub(super) sharing: Sharing,
    pub(super) unknowns: Vec<Unknown>,
    /// Known numbers, and units of the unknown ones: a frequency near the stuck one, sizes of displacements by record and mode.
    pub(super) reference: Values,
    /// Largest displacement of each mode in each record.
    pub(super) sizes: Vec<Vec<f64>>,
}

impl Form {
    /// A model of so many modes; `reference` holds start frequencies, shapes and beginnings.
    pub(super) fn new(sharing: Sharing, reference: &Values, sizes: &[Vec<f64>], given: Given) -> Self {
        let n = reference.frequency.len();
        let mut unknowns: Vec<Unknown> = (0..n).map(Unknown::Frequency).collect();
        unknowns.extend((0..n).map(Unknown::DampingRatio));
        let joints = sharing.joints(n);
        for j in 0..joints {
            unknowns.extend([Unknown::KT(j), Unknown::FS(j), Unknown::Chi(j), Unknown::Beta(j)]);
            if let Sharing::Shared(_) = sharing {
                unknowns.extend((0..n).filter(|r| *r != j).map(|r| Unknown::Participation(j, r)));
                if joints == 1 {
                    unknowns.push(Unknown::Compliance(j));
                }
            }
        }
        if given.seen == Seen::Sum && matches!(sharing, Sharing::Shared(_)) {
            unknowns.extend((1..n).map(Unknown::ShapeAtSensor));
        }
        if given.forced && !given.shape_at_force {
            unknowns.extend((0..n).map(Unknown::ShapeAtForce));
        }
        if !given.forced {
            for k in 0..sizes.len() {
                unknowns.extend((0..n).flat_map(|r| [Unknown::Displacement(k, r), Unknown::Velocity(k, r)]));
            }
        }
        let one = FourParameter::new(1.0, 1.0, -0.5, 0.1).ok();
        let reference = Values {
            laws: one.map_or_else(Vec::new, |law| vec![law; joints]),
            participation: (0..joints)
                .map(|j| (0..n).map(|r| if r == j { 1.0 } else { 0.0 }).collect())
                .collect(),
            compliance: vec![0.0; joints],
            ..reference.clone()
        };
        Self { sharing, unknowns, reference, sizes: sizes.to_vec() }
    }

    /// These numbers, of which the beginnings of records alone are unknown.
    pub(super) fn of_beginnings(
        sharing: Sharing,
        values: &Values,
        initial: &[Vec<[f64; 2]>],
        sizes: &[Vec<f64>],
        forced: bool,
    ) -> Self {
        let n = values.frequency.len();
        let of = |k: usize| (0..n).flat_map(move |r| [Unknown::Displacement(k, r), Unknown::Velocity(k, r)]);
        let unknowns = if forced { Vec::new() } else { (0..sizes.len()).flat_map(of).collect() };
        let of_joint = |(rho, law): (&f64, &FourParameter)| rho * law.k_t();
        let reference = Values {
            compliance: values.compliance.iter().zip(&values.laws).map(of_joint).collect(),
            initial: initial.to_vec(),
            ..values.clone()
        };
        Self { sharing, unknowns, reference, sizes: sizes.to_vec() }
    }

    /// Bounds of the coordinates.
    pub(super) fn bounds(&self) -> Vec<(f64, f64)> {
        let of = |unknown: &Unknown| match unknown {
            Unknown::Frequency(_) => (-50.0, 50.0),
            Unknown::DampingRatio(_) => (0.0, MOST_DAMPING),
            Unknown::Chi(_) => CHI_RANGE,
            Unknown::Beta(_) => (0.0, MOST_DIRAC),
            Unknown::Compliance(_) => (0.0, MOST_COMPLIANCE),
            Unknown::Participation(..) => (-MOST_SHAPE, MOST_SHAPE),
            Unknown::ShapeAtSensor(_) => (-MOST_SHAPE.ln(), MOST_SHAPE.ln()),
            _ => (f64::NEG_INFINITY, f64::INFINITY),
        };
        self.unknowns.iter().map(of).collect()
    }

    /// The numbers at these coordinates; none where there is no such law.
    pub(super) fn values(&self, x: &[f64]) -> Option<Values> {
        let mut v = self.reference.clone();
        let mut laws: Vec<[f64; 4]> =
            v.laws.iter().map(|law| [law.k_t(), law.f_s(), law.chi(), law.beta()]).collect();
        for (unknown, x) in self.unknowns.iter().zip(x) {
            let value = self.value(*unknown, *x);
            match *unknown {
                Unknown::Frequency(r) => v.frequency[r] = value,
                Unknown::DampingRatio(r) => v.damping_ratio[r] = value,
                Unknown::KT(j) => laws[j][0] = value,
                Unknown::FS(j) => laws[j][1] = value,
                Unknown::Chi(j) => laws[j][2] = value,
                Unknown::Beta(j) => laws[j][3] = value,
                Unknown::Participation(j, r) => v.participation[j][r] = value,
                Unknown::Compliance(j) => v.compliance[j] = value,
                Unknown::ShapeAtSensor(r) => v.shape_at_sensor[r] = value,
                Unknown::ShapeAtForce(r) => v.shape_at_force[r] = value,
                Unknown::Displacement(k, r) => v.initial[k][r][0] = value,
                Unknown::Velocity(k, r) => v.initial[k][r][1] = value,
            }
        }
        for (law, [k_t, f_s, chi, beta]) in v.laws.iter_mut().zip(laws) {
            *law = FourParameter::new(k_t, f_s, chi, beta).ok()?;
        }
        for (compliance, law) in v.compliance.iter_mut().zip(&v.laws) {
            *compliance /= law.k_t();
        }
        // Beginnings are what the sensor saw: the same motion for any shape there.
        for r in 0..v.frequency.len() {
            let scale = v.shape_at_sensor[r];
            v.initial.iter_mut().for_each(|modes| modes[r] = modes[r].map(|x| x / scale));
        }
        Some(v)
    }

    /// The number behind a coordinate; of a compliance its product with K_T.
    pub(super) fn value(&self, unknown: Unknown, x: f64) -> f64 {
        let reference = &self.reference;
        match unknown {
            Unknown::Frequency(r) => reference.frequency[r] * (1.0 + FREQUENCY_UNIT * x),
            Unknown::DampingRatio(_) => DAMPING_UNIT * x,
            Unknown::KT(_) | Unknown::FS(_) | Unknown::ShapeAtSensor(_) => x.exp(),
            Unknown::Chi(_) | Unknown::Participation(..) | Unknown::Compliance(_) => x,
            Unknown::Beta(_) => x / (1.0 - x),
            Unknown::ShapeAtForce(r) => x * reference.shape_at_force[r],
            Unknown::Displacement(k, r) => x * self.sizes[k][r],
            Unknown::Velocity(k, r) => x * self.speed(k, r),
        }
    }

    fn speed(&self, k: usize, r: usize) -> f64 {
        std::f64::consts::TAU * self.reference.frequency[r] * self.sizes[k][r]
    }

    /// Coordinates of a start: modes with their damping ratios, laws, participation of each joint, compliance times K_T.
    pub(super) fn start(
        &self,
        modes: &[Parameters],
        laws: &[[f64; 4]],
        participation: &[Vec<f64>],
        share: f64,
    ) -> Vec<f64> {
        let of = |unknown: &Unknown| match *unknown {
            Unknown::Frequency(_) | Unknown::ShapeAtSensor(_) => 0.0,
            Unknown::DampingRatio(r) => modes[r].damping_ratio / DAMPING_UNIT,
            Unknown::KT(j) => laws[j][0].ln(),
            Unknown::FS(j) => laws[j][1].ln(),
            Unknown::Chi(j) => laws[j][2].clamp(CHI_RANGE.0, CHI_RANGE.1),
            Unknown::Beta(j) => (laws[j][3] / (1.0 + laws[j][3])).min(MOST_DIRAC),
            Unknown::Participation(j, r) => participation[j][r],
            Unknown::Compliance(_) => share,
            Unknown::ShapeAtForce(_) => 1.0,
            Unknown::Displacement(k, r) => self.reference.initial[k][r][0] / self.sizes[k][r],
            Unknown::Velocity(k, r) => self.reference.initial[k][r][1] / self.speed(k, r),
        };
        self.unknowns.iter().map(of).collect()
    }
}

impl Sharing {
    /// Number of joints of so many modes.
    #[must_use]
    pub const fn joints(self, modes: usize) -> usize {
        match self {
            Self::Linear => 0,
            Self::Uncoupled => modes,
            Self::Shared(joints) => joints,
        }
    }
}

/// What need not be sought.
#[derive(Debug, Clone, Copy)]
pub(super) struct Given {
    pub(super) seen: Seen,
    /// Whether the load is known.
    pub(super) forced: bool,
    /// Whether the shapes at it are.
    pub(super) shape_at_force: bool,
}
