//! Curves of modes, read from files.

use iwan_machine::listed;
use std::path::Path;

use iwan_fem::Stiffness;
use iwan_study::update::MeasuredCurve;
use serde_json::Value;

use crate::failure::Failure;
use crate::shown;

/// Remedy where a file holds no curves.
const REMEDY: &str = "give fit.json of `iwan fit`, envelope.csv of `iwan envelope`, curves.csv of `iwan quasi-static`, or a table with the columns \
                      displacement, frequency and damping_ratio or dissipation";

/// One curve as it stands in a file.
#[derive(Debug, Clone, Default)]
struct Read {
    name: Option<String>,
    displacement: Vec<f64>,
    frequency: Vec<f64>,
    damping_ratio: Vec<f64>,
    stiffness: Stiffness,
}

/// Reads the curves of one option `MODE[,MODE...]=FILE`.
pub(super) fn read(given: &str) -> Result<Vec<MeasuredCurve>, Failure> {
    let (names, file) = match given.split_once('=') {
        Some((names, file)) => (names.split(',').map(|name| name.trim().to_owned()).collect(), file),
        None => (Vec::new(), given),
    };
    let path = Path::new(file);
    let is_json = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("json"));
    let curves = if is_json { of_json(path)? } else { of_table(path)? };
    if !names.is_empty() && names.len() != curves.len() {
        let message = format!("{file}: {} modes are named, the file has {}", names.len(), curves.len());
        return Err(Failure::input(
            message,
            "name each mode of the file, in its order: --curves bending-1,bending-2=FILE",
        ));
    }
    let named = curves.into_iter().enumerate().map(|(n, read)| {
        let mode = names.get(n).cloned().or(read.name).ok_or_else(|| {
            let message = format!("{file}: it does not say which modes of the structure these are");
            Failure::input(message, format!("name them: --curves bending-1={file}"))
        })?;
        Ok(MeasuredCurve {
            mode,
            source: file.to_owned(),
            displacement: read.displacement,
            frequency: read.frequency,
            damping_ratio: read.damping_ratio,
            stiffness: read.stiffness,
        })
    });
    named.collect()
}

/// Curves of the modes in a fit.json.
fn of_json(path: &Path) -> Result<Vec<Read>, Failure> {
    let place = shown::path(path);
    let refused = |what: &str| Failure::input(format!("{place}: {what}"), REMEDY);
    let bytes = iwan_machine::read_file(path).map_err(|e| refused(&format!("cannot be read: {e}")))?;
    let whole: Value = serde_json::from_slice(&bytes).map_err(|e| refused(&format!("is no JSON: {e}")))?;
    let modes = whole["modes"].as_array().ok_or_else(|| refused("has no list `modes`"))?;
    let column = |mode: &Value, key: &str| -> Result<Vec<f64>, Failure> {
        let values = mode["curves"][key].as_array();
        let values = values.ok_or_else(|| refused(&format!("has no list `curves.{key}` of a mode")))?;
        let number = |(i, v): (usize, &Value)| {
            v.as_f64().ok_or_else(|| refused(&format!("`curves.{key}[{i}]` of a mode is {v}, no number")))
        };
        values.iter().enumerate().map(number).collect()
    };
    let one = |mode: &Value| {
        Ok(Read {
            name: mode["name"].as_str().map(str::to_owned),
            displacement: column(mode, "displacement")?,
            frequency: column(mode, "frequency")?,
            damping_ratio: column(mode, "damping_ratio")?,
            stiffness: Stiffness::FirstHarmonic,
        })
    };
    modes.iter().map(one).collect()
}

/// Curves of the modes in a table, told apart by the column `mode` where there is one.
fn of_table(path: &Path) -> Result<Vec<Read>, Failure> {
    let place = shown::path(path);
    let table = iwan_io::read_table(path).map_err(|error| Failure::said(&place, &error))?;
    let missing = |name: &str| {
        let message = format!("{place}: there is no column `{name}`; it has {}", listed(table.names()));
        Failure::input(message, REMEDY)
    };
    let displacement = table.column("displacement").ok_or_else(|| missing("displacement"))?;
    let frequency = table.column("frequency").ok_or_else(|| missing("frequency"))?;
    let (damping, stiffness) = match (table.column("damping_ratio"), table.column("dissipation")) {
        (Some(ratio), _) => (ratio.to_vec(), Stiffness::FirstHarmonic),
        (None, Some(loss)) => {
            // A table of `iwan quasi-static` holds the modal joint force, and its frequency is that of the secant stiffness.
            let of_statics = table.column("joint_force").is_some();
            let stiffness = if of_statics { Stiffness::Secant } else { Stiffness::FirstHarmonic };
            (MeasuredCurve::damping_of(displacement, frequency, loss), stiffness)
        }
        (None, None) => return Err(missing("damping_ratio")),
    };
    for (n, (name, values)) in table.names().iter().zip(table.columns()).enumerate() {
        let is_used =
            ["displacement", "frequency", "damping_ratio", "dissipation", "mode"].contains(&name.as_str());
        let Some(row) = values.iter().position(|value| !value.is_finite()).filter(|_| is_used) else {
            continue;
        };
        let (line, column) = (table.line(row).unwrap_or(0), n + 1);
        let message =
            format!("{place}, line {line}, column {column} (`{name}`): {} is no finite number", values[row]);
        return Err(Failure::input(message, "leave the row out, or write what was measured"));
    }
    let number = |i: usize| table.column("mode").map_or(1.0, |mode| mode[i]);
    let mut numbers: Vec<f64> = (0..table.rows()).map(number).collect();
    numbers.dedup();
    let one = |of: f64| {
        let rows: Vec<usize> = (0..table.rows()).filter(|i| number(*i) == of).collect();
        let take = |values: &[f64]| rows.iter().map(|i| values[*i]).collect();
        Read {
            name: None,
            displacement: take(displacement),
            frequency: take(frequency),
            damping_ratio: take(&damping),
            stiffness,
        }
    };
    Ok(numbers.into_iter().map(one).collect())
}
