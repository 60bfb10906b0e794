//! `curves` of a mode: frequency and damping ratio against amplitude, in the scenario itself or in a file.

use std::path::Path;

use iwan_sim::Curves;

use crate::error::InputError;
use crate::section::Section;
use crate::text::InputText;

/// Keys of the table.
pub(crate) const KEYS: &[&str] = &["amplitude", "frequency", "damping_ratio", "path", "extrapolate"];

/// Names of the three columns.
const COLUMNS: [&str; 3] = ["amplitude", "frequency", "damping_ratio"];

/// Reads and checks the curves of a mode.
pub(super) fn read(source: &InputText, mode: &Section<'_>) -> Result<Curves, InputError> {
    if mode.is_text("curves") {
        let path = source.folder.join(mode.text("curves")?);
        let [a, f, z] =
            columns(&path).map_err(|(message, remedy)| mode.failure("curves", &message, &remedy))?;
        return Curves::new(a, f, z).map_err(|error| {
            mode.failure("curves", &format!("{}: {error}", path.display()), "correct this row of the file")
        });
    }
    let Some(place) = mode.optional_table("curves")? else {
        return Err(mode.failure("curves", "the key `curves` is missing", "add curves = \"FILE.csv\""));
    };
    let section = Section::new(source, format!("curves of {}", mode.title()), place, KEYS)?;
    let table = if section.has("path") {
        if let Some(both) = COLUMNS.into_iter().find(|key| section.has(key)) {
            let message = format!("`path` and `{both}` exclude each other");
            return Err(section.failure(both, &message, "give the points here, or the file that holds them"));
        }
        let path = source.folder.join(section.text("path")?);
        columns(&path).map_err(|(message, remedy)| section.failure("path", &message, &remedy))?
    } else {
        [section.numbers("amplitude")?, section.numbers("frequency")?, section.numbers("damping_ratio")?]
    };
    let [a, f, z] = table;
    let curves = Curves::new(a, f, z).map_err(|error| {
        let in_file = section.has("path");
        section.out_of_range(error, |name| if in_file { "path".into() } else { name.to_string() })
    })?;
    let extrapolate = section.optional_flag("extrapolate")?.unwrap_or(false);
    Ok(curves.extrapolating(extrapolate))
}

/// The three columns of a text file; the error is a message and a remedy.
fn columns(path: &Path) -> Result<[Vec<f64>; 3], (String, String)> {
    let remedy = "give a text file of three columns: modal amplitude, frequency in Hz, damping ratio";
    let shown = path.display();
    let bytes = iwan_machine::read_file(path).map_err(|error| {
        let remedy = "check the path: it is relative to the scenario file";
        (format!("{shown}: cannot be read: {error}"), remedy.to_string())
    })?;
    let table =
        iwan_io::parse_table(path, &bytes).map_err(|error| (error.to_string(), remedy.to_string()))?;
    let [a, f, z] = table.columns() else {
        let message = format!("{shown}: has {} columns, not 3", table.columns().len());
        return Err((message, remedy.to_string()));
    };
    Ok([a.clone(), f.clone(), z.clone()])
}
