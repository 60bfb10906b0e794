//! Files of a shaker's test as measurements of one mode.

use iwan_machine::listed;
use std::f64::consts::{PI, TAU};

use iwan_ident::sweeps::{BackbonePoint, ResponsePoint, SteadyData};
use iwan_io::{Quantity, UffFunction};
use iwan_sim::Control;

use super::columns::Content;
use crate::failure::Failure;

/// A quantity counts as held where its relative standard deviation over a level is below this. Controllers keep a level within some per cent, and a
/// quantity that is not held varies by tens of per cent through a resonance.
const HELD: f64 = 0.1;

/// One file.
#[derive(Debug, Clone)]
pub(crate) struct Measurement {
    pub(super) file: String,
    /// Points in mass-normalised modal coordinates.
    pub(crate) data: SteadyData,
    /// Levels of a response, in the order of the file.
    pub(super) levels: Vec<Level>,
}

/// Points of a response that were measured at one level.
#[derive(Debug, Clone)]
pub(super) struct Level {
    /// The quantity that was held and its value in the modal coordinate; none where nothing was held.
    pub(super) held: Option<(Control, f64)>,
    /// Indices of the level's points among those of the file.
    pub(super) points: Vec<usize>,
}

/// How the motions and forces of a file become modal ones.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scaling<'a> {
    /// Modal mass: modal displacement q = √mass x, modal force = force/√mass.
    pub(crate) mass: f64,
    /// Force levels of the functions of a universal file, in the order of the file.
    pub(crate) levels: &'a [f64],
}

/// Names of columns that hold a motion, each with the number of times the displacement was differentiated.
const MOTIONS: [(&str, i32); 4] =
    [("amplitude", 0), ("displacement", 0), ("velocity", 1), ("acceleration", 2)];

impl Measurement {
    /// Reads responses: columns frequency, a motion, phase, excitation (or force) and optionally level; or functions of a universal file.
    pub(crate) fn response(file: String, content: Content, scaling: Scaling<'_>) -> Result<Self, Failure> {
        let (points, numbers) = match content {
            Content::Columns(columns) => of_columns(&file, &columns)?,
            Content::Responses(functions) => of_functions(&file, &functions, scaling.levels)?,
        };
        let root = scaling.mass.sqrt();
        let modal =
            |p: ResponsePoint| ResponsePoint { amplitude: p.amplitude * root, force: p.force / root, ..p };
        let points: Vec<ResponsePoint> = points.into_iter().map(modal).collect();
        let mut known: Vec<f64> = Vec::new();
        for n in &numbers {
            if !known.contains(n) {
                known.push(*n);
            }
        }
        let level = |number: &f64| {
            let own: Vec<usize> = (0..points.len()).filter(|&i| numbers[i] == *number).collect();
            Level { held: held(&own.iter().map(|&i| &points[i]).collect::<Vec<_>>()), points: own }
        };
        let levels = known.iter().map(level).collect();
        Ok(Self { file, levels, data: SteadyData::Response(points) })
    }

    /// Reads a backbone: columns frequency, damping_ratio and a motion.
    pub(crate) fn backbone(file: String, content: Content, scaling: Scaling<'_>) -> Result<Self, Failure> {
        let Content::Columns(columns) = content else {
            let message =
                format!("{file}: a universal file holds no table of frequency, damping and amplitude");
            return Err(Failure::input(message, "give the functions themselves as --sweep"));
        };
        let table = Table { file: &file, columns: &columns };
        table.one_mode()?;
        let (frequency, damping) = (table.needed(&["frequency"])?, table.needed(&["damping_ratio"])?);
        let (motion, power) = table.motion()?;
        let root = scaling.mass.sqrt();
        let point = |i: usize| BackbonePoint {
            amplitude: root * motion[i] / (TAU * frequency[i]).powi(power),
            frequency: frequency[i],
            damping_ratio: damping[i],
        };
        let data = SteadyData::Backbone((0..frequency.len()).map(point).collect());
        Ok(Self { file, data, levels: Vec::new() })
    }
}

/// The columns of a file.
struct Table<'a> {
    file: &'a str,
    columns: &'a [(String, Vec<f64>)],
}

impl<'a> Table<'a> {
    fn named(&self, names: &[&str]) -> Option<&'a [f64]> {
        let found = names.iter().find_map(|name| self.columns.iter().find(|(n, _)| n == name));
        found.map(|(_, values)| values.as_slice())
    }

    fn needed(&self, names: &[&str]) -> Result<&'a [f64], Failure> {
        let values = self.named(names).ok_or_else(|| {
            let there: Vec<&str> = self.columns.iter().map(|(name, _)| name.as_str()).collect();
            let message = format!("{}: there is no column {}", self.file, names.join(" or "));
            Failure::input(message, format!("name the column so; there are {}", listed(there)))
        })?;
        match values.iter().position(|v| !v.is_finite()) {
            Some(i) => {
                let (file, name, entry) = (self.file, names.join(" or "), i + 1);
                let message =
                    format!("{file}: entry {entry} of the column {name} is {}, no finite number", values[i]);
                Err(Failure::input(message, "leave the row out, or repair it"))
            }
            None => Ok(values),
        }
    }

    fn motion(&self) -> Result<(&'a [f64], i32), Failure> {
        match MOTIONS.iter().find(|(name, _)| self.named(&[name]).is_some()) {
            Some((name, power)) => self.needed(&[name]).map(|values| (values, *power)),
            None => self.needed(&MOTIONS.map(|(name, _)| name)).map(|values| (values, 0)),
        }
    }

    /// Refuses tables of several modes, as `iwan frf` and `iwan backbone` write them.
    fn one_mode(&self) -> Result<(), Failure> {
        let several = self.named(&["mode"]).is_some_and(|mode| mode.iter().any(|m| *m != mode[0]));
        if !several {
            return Ok(());
        }
        let message = format!("{}: the column mode tells several modes apart", self.file);
        Err(Failure::input(message, "give a file with the rows of one mode"))
    }
}

/// Response points of a table, and the number of the level of each point.
fn of_columns(file: &str, columns: &[(String, Vec<f64>)]) -> Result<(Vec<ResponsePoint>, Vec<f64>), Failure> {
    let table = Table { file, columns };
    table.one_mode()?;
    let frequency = table.needed(&["frequency"])?;
    let (motion, power) = table.motion()?;
    let (phase, force) = (table.needed(&["phase"])?, table.needed(&["excitation", "force"])?);
    let point = |i: usize| {
        let rate = (TAU * frequency[i]).powi(power);
        // Each time derivative leads the displacement by a quarter of a cycle.
        let phase = phase[i] - 0.5 * PI * f64::from(power);
        ResponsePoint { frequency: frequency[i], amplitude: motion[i] / rate, phase, force: force[i] }
    };
    let points: Vec<ResponsePoint> = (0..frequency.len()).map(point).collect();
    let numbers = table.named(&["level"]).map_or_else(|| vec![0.0; points.len()], <[f64]>::to_vec);
    Ok((points, numbers))
}

/// Response points of frequency responses; `levels` are their force amplitudes, which a universal file does not hold.
fn of_functions(
    file: &str,
    functions: &[UffFunction],
    levels: &[f64],
) -> Result<(Vec<ResponsePoint>, Vec<f64>), Failure> {
    if functions.is_empty() {
        let message = format!("{file}: there is no complex frequency response (dataset 58 of type 4)");
        return Err(Failure::input(message, "export response over force as complex functions of type 4"));
    }
    if functions.len() != levels.len() {
        let message = format!("{file}: {} frequency responses, but {} levels", functions.len(), levels.len());
        let remedy = "give the force of each function in its order, as in --level 1 --level 10: a ratio does not say it";
        return Err(Failure::input(message, remedy));
    }
    let (mut points, mut numbers) = (Vec::new(), Vec::new());
    for ((n, function), force) in functions.iter().enumerate().zip(levels) {
        let power = match function.quantity {
            Quantity::Displacement => 0,
            Quantity::Velocity => 1,
            Quantity::Acceleration | Quantity::Unknown => 2,
            other => {
                let message = format!("{file}: \"{}\" measures {other}, not a motion", function.name);
                return Err(Failure::input(message, "leave the function out"));
            }
        };
        for (i, (re, im)) in function.re.iter().zip(&function.im).enumerate() {
            let frequency = function.start + i as f64 * function.step;
            // At 0 Hz nothing moves, and a response of exactly 0 was not measured.
            if frequency > 0.0 && re.hypot(*im) > 0.0 {
                let amplitude = force * re.hypot(*im) / (TAU * frequency).powi(power);
                let phase = im.atan2(*re) - 0.5 * PI * f64::from(power);
                points.push(ResponsePoint { frequency, amplitude, phase, force: *force });
                numbers.push(n as f64);
            }
        }
    }
    Ok((points, numbers))
}

/// The quantity that varies least over the points of a level, with its value; none where even this quantity varies by [`HELD`] or more.
fn held(points: &[&ResponsePoint]) -> Option<(Control, f64)> {
    let of = |control: Control, value: fn(&ResponsePoint) -> f64| {
        let logs = || points.iter().map(move |p| value(p).ln());
        let count = points.len() as f64;
        let mean = logs().sum::<f64>() / count;
        let scatter = (logs().map(|log| (log - mean).powi(2)).sum::<f64>() / count).sqrt();
        (scatter, control, mean.exp())
    };
    let all = [
        of(Control::Force, |p| p.force),
        of(Control::Displacement, |p| p.amplitude),
        of(Control::Velocity, |p| p.amplitude * TAU * p.frequency),
        of(Control::Acceleration, |p| p.amplitude * (TAU * p.frequency).powi(2)),
    ];
    let least = all.into_iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
    (least.0 < HELD).then_some((least.1, least.2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_of_universal_files_need_their_forces() {
        let at = |node| iwan_io::NodalDirection { node, direction: 3 };
        // One mass of 1 on a spring of 4π²·25, undamped, in acceleration over force.
        let h = |f: f64| -(TAU * f).powi(2) / ((TAU * 5.0).powi(2) - (TAU * f).powi(2));
        let function = UffFunction {
            name: "H".into(),
            kind: 4,
            response: at(2),
            reference: at(1),
            quantity: Quantity::Acceleration,
            unit: "m/s^2".into(),
            start: 0.0,
            step: 2.0,
            re: (0..4).map(|i| h(2.0 * f64::from(i))).collect(),
            im: vec![0.0; 4],
        };
        assert!(of_functions("frf.uff", std::slice::from_ref(&function), &[]).is_err());
        let (points, _) = of_functions("frf.uff", &[function], &[3.0]).unwrap();
        // The point at 0 Hz is left out; below resonance the displacement is in phase with the force, above in opposition to it.
        assert_eq!(points.len(), 3);
        assert!((points[0].amplitude - 3.0 / (TAU * TAU * (25.0 - 4.0))).abs() < 1e-12);
        assert!(points[0].phase.sin().abs() < 1e-12 && points[0].phase.cos() > 0.0);
        assert!(points[2].phase.cos() < 0.0 && points[2].force == 3.0);
    }

    #[test]
    fn what_is_held_is_what_varies_least() {
        let point = |i: i32| {
            let frequency = 100.0 + f64::from(i);
            let amplitude = 2.0 / (TAU * frequency).powi(2);
            ResponsePoint { frequency, amplitude, phase: -0.1, force: f64::from(1 + i) }
        };
        let points: Vec<ResponsePoint> = (0..20).map(point).collect();
        let (control, level) = held(&points.iter().collect::<Vec<_>>()).unwrap();
        assert!(control == Control::Acceleration && (level - 2.0).abs() < 1e-12);
        let free: Vec<ResponsePoint> =
            points.iter().map(|p| ResponsePoint { amplitude: p.force * p.force, ..*p }).collect();
        assert!(held(&free.iter().collect::<Vec<_>>()).is_none());
    }
}
