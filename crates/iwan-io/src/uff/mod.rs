//! Universal file format, dataset 58 (ASCII) and 58b (binary): functions at nodal degrees of freedom; geometry and mode shapes.
//!
//! Layout after the "Universal Dataset Number 58" page of the Structural Dynamics Research Laboratory, University of
//! Cincinnati. Every dataset with a real time history is a channel; other datasets are skipped, spectra and complex
//! functions with a warning.

mod nodal;
mod sections;
mod rows;
mod header;
mod data;
mod qualifiers;
mod functions;
mod shape;
mod model;
pub mod write;

pub use functions::{UffFunction, functions};
pub use model::{ROD, UffModel, model};
pub use nodal::NodalDirection;

use std::collections::HashMap;

use crate::assembly::{Axis, Channel, Raw, unlike};
use crate::error::ReadError;
use crate::file_bytes::FileBytes;
use crate::options::ReadOptions;
use crate::warning::Warning;
use data::Points;
use header::Header;
use iwan_machine::listed;
use qualifiers::Window;
use sections::Section;

/// Advice for a file without time histories.
const HISTORIES: &str = "export time histories (function type 1, real) as dataset 58 or 58b";

/// A time history, with start and interval or with times of its own.
struct Function {
    channel: Channel,
    axis: Axis,
}

/// Time and channels of a UFF file.
pub(crate) fn parse(source: FileBytes, options: &ReadOptions) -> Result<Raw, ReadError> {
    let mut warnings = Vec::new();
    let mut functions: Vec<Function> = Vec::new();
    let (mut refused, mut names) = (None, Names::default());
    for (section, window) in qualifiers::split(&source, &mut warnings)? {
        let header = Header::parse(&source, &section)?;
        let name = header.name(section.index);
        let windowed = Window::refusal(window, &header).map(|reason| (reason, qualifiers::REMEDY));
        if let Some((reason, remedy)) = header.refusal().map(|r| (r, HISTORIES)).or(windowed) {
            if wanted(&name, options) {
                warnings.push(Warning::LeftOut { name, reason: reason.clone() });
                refused.get_or_insert((section.place(), reason, remedy));
            }
            continue;
        }
        let name = names.tell_apart(&name);
        if !wanted(&name, options) {
            continue;
        }
        warnings.extend(Window::remark(window, &header, &name));
        functions.push(function(&source, &section, &header, name, options, &mut warnings)?);
    }
    if functions.is_empty() && options.channels.is_empty() {
        let none = || ("the whole file".into(), "a file without dataset 58".into(), HISTORIES);
        let (place, reason, remedy) = refused.unwrap_or_else(none);
        return Err(source.unsupported(place, reason, remedy));
    }
    join(&source, order(&source, functions, options, &names)?, options, warnings)
}

/// Names of time histories, in the order of the file.
#[derive(Default)]
struct Names {
    all: Vec<String>,
    /// For each name, how many functions were called so far.
    asked: HashMap<String, usize>,
}

impl Names {
    /// A unique name for a time history: the second history of the same name gets (2) behind it, and so on.
    fn tell_apart(&mut self, name: &str) -> String {
        let mut own = name.to_owned();
        while self.asked.contains_key(&own) {
            let asked = self.asked.entry(name.to_owned()).or_default();
            *asked += 1;
            own = format!("{name} ({asked})");
        }
        self.asked.insert(own.clone(), 1);
        self.all.push(own.clone());
        own
    }
}

fn wanted(name: &str, options: &ReadOptions) -> bool {
    options.channels.is_empty() || options.channels.iter().any(|c| c == name)
}

fn function(
    source: &FileBytes,
    section: &Section,
    header: &Header,
    name: String,
    options: &ReadOptions,
    warnings: &mut Vec<Warning>,
) -> Result<Function, ReadError> {
    let Points { mut times, values } = data::read(source, section, header, warnings)?;
    let (factor, unit_known) =
        source.seconds(&format!("abscissa of {name}"), &header.abscissa_unit, options)?;
    if factor != 1.0 {
        warnings.push(Warning::TimeScaled { unit: header.abscissa_unit.clone(), factor });
        for t in &mut times {
            *t *= factor;
        }
    }
    let axis = if header.even {
        Axis::Even { start: header.start * factor, step: header.step * factor }
    } else {
        Axis::Times { name: format!("abscissa of {name}"), values: times, unit_known }
    };
    let (unit, quantity) = (header.ordinate_unit.clone(), header.quantity());
    Ok(Function { channel: Channel { name, unit, quantity, values }, axis })
}

/// The functions in the order of the names given by the user.
fn order(
    source: &FileBytes,
    functions: Vec<Function>,
    options: &ReadOptions,
    names: &Names,
) -> Result<Vec<Function>, ReadError> {
    if options.channels.is_empty() {
        return Ok(functions);
    }
    let mut functions: Vec<Option<Function>> = functions.into_iter().map(Some).collect();
    let mut ordered = Vec::new();
    for name in &options.channels {
        let slot = functions.iter_mut().find(|f| f.as_ref().is_some_and(|f| f.channel.name == *name));
        let found = slot.and_then(Option::take).ok_or_else(|| {
            let names = listed(&names.all);
            let (file, name) = (source.file.into(), name.clone());
            ReadError::UnknownName { file, role: "channel", name, names }
        });
        ordered.push(found?);
    }
    Ok(ordered)
}

/// Puts all channels on one time axis; an error where their times differ.
fn join(
    source: &FileBytes,
    functions: Vec<Function>,
    options: &ReadOptions,
    warnings: Vec<Warning>,
) -> Result<Raw, ReadError> {
    let (mut axis, mut channels): (Option<Axis>, Vec<Channel>) = (None, Vec::new());
    for function in functions {
        let differs = axis.as_ref().and_then(|a| unlike(a, &function.axis)).zip(channels.first());
        if let Some((unlike, first)) = differs {
            return Err(unlike.refusal(source, function.channel.name, first.name.clone()));
        }
        axis.get_or_insert(function.axis);
        channels.push(function.channel);
    }
    let axis = axis.unwrap_or(Axis::None);
    Ok(Raw { axis, channels, chosen: !options.channels.is_empty(), warnings })
}
