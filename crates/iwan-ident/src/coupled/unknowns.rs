//! The unknowns of modes that share joints, and the models that are compared.

use iwan_core::FourParameter;

use super::records::Seen;
use crate::parameters::Parameters;

/// Relative change of a frequency when its coordinate changes by one: joints change frequencies by some per cent.
const FREQUENCY_UNIT: f64 = 0.01;
/// Damping ratio at which its coordinate is 1: 0.1 %.
const DAMPING_UNIT: f64 = 1e-3;
/// Largest damping ratio, in that unit: with more than a half there is no ring-down.
const MOST_DAMPING: f64 = 500.0;
/// Range in which χ is sought: the law needs -1 < χ < 1.
pub(super) const CHI_RANGE: (f64, f64) = (-0.98, 0.98);
/// Largest share β/(1+β) of K_T that the Dirac may have.
const MOST_DIRAC: f64 = 0.98;
/// Largest product of a joint's stiffness and the compliance of the modes left out: at 1 the time step has no unique solution.
const MOST_COMPLIANCE: f64 = 0.95;
/// Largest participation, and largest ratio of a shape to that of the first mode: modes with larger ones are in other units.
const MOST_SHAPE: f64 = 1e6;

/// Which modes share which joints.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sharing {
    /// No joint: linear modes with viscous damping.
    Linear,
    /// A joint for each mode, moved by that mode alone.
    Uncoupled,
    /// This many joints, each moved by all modes.
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

/// One unknown number; modes `r`, joints `j` and records `k` are counted from 0.
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
    /// Slip of a joint (first index) in a unit displacement of a mode (second index).
    Participation(usize, usize),
    /// Compliance of a joint through the modes that are left out, times the joint's K_T.
    Compliance(usize),
    /// Slip of a joint under a unit load, through the modes that are left out; length over force, with the slip of 1 in the joint's first mode as unit.
    SlipAtForce(usize),
    /// Shape of a mode at the sensor over that of the first mode.
    ShapeAtSensor(usize),
    /// Shape of a mode at the load.
    ShapeAtForce(usize),
    /// Displacement of a mode (second index) at the first sample of a record (first index).
    Displacement(usize, usize),
    /// Velocity of a mode there, with the same indices.
    Velocity(usize, usize),
}

/// Modes, joints and initial motions as numbers with units.
#[derive(Debug, Clone, PartialEq)]
pub struct Values {
    /// Stuck frequency of each mode, Hz.
    pub frequency: Vec<f64>,
    /// Viscous damping ratio of each mode.
    pub damping_ratio: Vec<f64>,
    /// Law of each joint.
    pub laws: Vec<FourParameter>,
    /// Slip of each joint in a unit displacement of each mode: `[joint][mode]`.
    pub participation: Vec<Vec<f64>>,
    /// Compliance ρ of each joint through the modes that are left out.
    pub compliance: Vec<f64>,
    /// Slip a of each joint under a unit load, through the modes left out; length over force.
    pub slip_at_force: Vec<f64>,
    /// Shape of each mode at the sensor.
    pub shape_at_sensor: Vec<f64>,
    /// Shape of each mode at the load.
    pub shape_at_force: Vec<f64>,
    /// Displacement and velocity of each mode at the start of each record: `[record][mode]`.
    pub initial: Vec<Vec<[f64; 2]>>,
}

/// A model: which numbers are unknown, and the values of the others.
#[derive(Debug, Clone)]
pub(super) struct Form {
    pub(super) sharing: Sharing,
    pub(super) unknowns: Vec<Unknown>,
    /// The known numbers, and the units of the unknown ones: frequencies near the stuck ones, shapes and initial motions.
    pub(super) reference: Values,
    /// Largest displacement of each mode in each record: `[record][mode]`.
    pub(super) sizes: Vec<Vec<f64>>,
}

impl Form {
    /// A model of as many modes as `reference` has; `reference` holds start frequencies, shapes and initial motions.
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
                    if given.forced {
                        unknowns.push(Unknown::SlipAtForce(j));
                    }
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
            slip_at_force: vec![0.0; joints],
            ..reference.clone()
        };
        Self { sharing, unknowns, reference, sizes: sizes.to_vec() }
    }

    /// A model in which all numbers are known (`values`) except the initial motions of records, which start from `initial`; nothing is unknown where loads are known (`forced`).
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

    /// Bounds of the coordinates, one pair for each unknown.
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

    /// The numbers at these coordinates; none where a joint has no valid law there.
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
                Unknown::SlipAtForce(j) => v.slip_at_force[j] = value,
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
        // Initial motions are sought as what the sensor saw: the same motion for any shape there.
        for r in 0..v.frequency.len() {
            let scale = v.shape_at_sensor[r];
            v.initial.iter_mut().for_each(|modes| modes[r] = modes[r].map(|x| x / scale));
        }
        Some(v)
    }

    /// The number that belongs to a coordinate; for a compliance its product with K_T.
    pub(super) fn value(&self, unknown: Unknown, x: f64) -> f64 {
        let reference = &self.reference;
        match unknown {
            Unknown::Frequency(r) => reference.frequency[r] * (1.0 + FREQUENCY_UNIT * x),
            Unknown::DampingRatio(_) => DAMPING_UNIT * x,
            Unknown::KT(_) | Unknown::FS(_) | Unknown::ShapeAtSensor(_) => x.exp(),
            Unknown::Chi(_) | Unknown::Participation(..) | Unknown::Compliance(_) => x,
            Unknown::Beta(_) => x / (1.0 - x),
            Unknown::SlipAtForce(_) => x * self.static_displacement(),
            Unknown::ShapeAtForce(r) => x * reference.shape_at_force[r],
            Unknown::Displacement(k, r) => x * self.sizes[k][r],
            Unknown::Velocity(k, r) => x * self.speed(k, r),
        }
    }

    /// Largest static displacement of a mode under a unit load: what the slips of modes left out are measured by. The load may stand where a mode has a
    /// node.
    fn static_displacement(&self) -> f64 {
        let of = |(frequency, shape): (&f64, &f64)| shape.abs() / (std::f64::consts::TAU * frequency).powi(2);
        self.reference.frequency.iter().zip(&self.reference.shape_at_force).map(of).fold(0.0, f64::max)
    }

    fn speed(&self, k: usize, r: usize) -> f64 {
        std::f64::consts::TAU * self.reference.frequency[r] * self.sizes[k][r]
    }

    /// Coordinates of a start: modes with their damping ratios, laws {K_T, F_S, χ, β} of the joints, participation `[joint][mode]`, and compliance times K_T (`share`).
    pub(super) fn start(
        &self,
        modes: &[Parameters],
        laws: &[[f64; 4]],
        participation: &[Vec<f64>],
        share: f64,
    ) -> Vec<f64> {
        let of = |unknown: &Unknown| match *unknown {
            Unknown::Frequency(_) | Unknown::ShapeAtSensor(_) | Unknown::SlipAtForce(_) => 0.0,
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
    /// Number of joints where there are `modes` modes.
    #[must_use]
    pub const fn joints(self, modes: usize) -> usize {
        match self {
            Self::Linear => 0,
            Self::Uncoupled => modes,
            Self::Shared(joints) => joints,
        }
    }
}

/// What is known and need not be sought.
#[derive(Debug, Clone, Copy)]
pub(super) struct Given {
    pub(super) seen: Seen,
    /// Whether the load is known.
    pub(super) forced: bool,
    /// Whether the shapes of the modes at the load are known.
    pub(super) shape_at_force: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_at_a_load_on_a_node_of_the_first_mode_have_a_unit() {
        let reference = Values {
            frequency: vec![20.0, 52.0],
            damping_ratio: vec![0.0; 2],
            laws: Vec::new(),
            participation: Vec::new(),
            compliance: Vec::new(),
            slip_at_force: Vec::new(),
            shape_at_sensor: vec![1.0; 2],
            shape_at_force: vec![0.0, -3.0],
            initial: Vec::new(),
        };
        let given = Given { seen: Seen::Modes, forced: true, shape_at_force: true };
        let form = Form::new(Sharing::Shared(1), &reference, &[vec![1.0; 2]], given);
        assert!(form.unknowns.contains(&Unknown::SlipAtForce(0)));
        let expected = 3.0 / (std::f64::consts::TAU * 52.0).powi(2);
        assert!((form.value(Unknown::SlipAtForce(0), 1.0) / expected - 1.0).abs() < 1e-12);
    }
}
