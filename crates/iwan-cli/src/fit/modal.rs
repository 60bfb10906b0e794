//! What `iwan modal` found goes over to the fit: records, channels, shapes and what the sensors measure.

use std::path::{Path, PathBuf};

use serde_json::Value;

use super::args::FitArgs;
use crate::failure::Failure;
use crate::modal::{MODAL, SHAPES};
use crate::records::Motion;

/// Fills in what the user left open.
pub(super) fn over_from_modal(args: &mut FitArgs, folder: &Path) -> Result<(), Failure> {
    let path = folder.join(MODAL);
    let name = path.display().to_string();
    let wrong =
        |what: &str| Failure::input(format!("{name}: {what}"), "give the folder that `iwan modal` wrote");
    let text = std::fs::read_to_string(&path).map_err(|e| wrong(&format!("cannot be read: {e}")))?;
    let summary: Value = serde_json::from_str(&text).map_err(|e| wrong(&format!("is no summary: {e}")))?;
    let texts = |key: &str| -> Result<Vec<String>, Failure> {
        let list = summary[key].as_array().ok_or_else(|| wrong(&format!("has no list `{key}`")))?;
        let text = |v: &Value| {
            v.as_str().map(str::to_owned).ok_or_else(|| wrong(&format!("`{key}` holds no texts")))
        };
        list.iter().map(text).collect()
    };
    if summary["mass_normalised"] != Value::Bool(true) {
        let message = format!("{name}: its shapes are not mass-normalised");
        let remedy = "say where the hammer hits with `iwan modal --at POINT`, a point with a sensor";
        return Err(Failure::input(message, remedy));
    }
    if args.fit.is_empty() {
        args.fit = texts("sources")?.into_iter().map(PathBuf::from).collect();
    }
    if args.records.channels.is_empty() {
        args.records.channels = texts("channels")?;
    }
    args.records.shapes = Some(folder.join(SHAPES));
    if args.records.quantity.is_none() {
        args.records.quantity = match summary["quantity"].as_str() {
            Some("displacement") => Some(Motion::Displacement),
            Some("velocity") => Some(Motion::Velocity),
            _ => Some(Motion::Acceleration),
        };
    }
    Ok(())
}
