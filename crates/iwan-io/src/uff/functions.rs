//! Datasets 58 with the points they belong to: time histories and frequency responses of a modal test.

use super::data;
use super::header::Header;
use super::nodal::NodalDirection;
use super::qualifiers::{self, Window};
use crate::error::ReadError;
use crate::file_bytes::FileBytes;
use crate::quantity::Quantity;
use crate::warning::Warning;
use std::path::Path;

/// A dataset 58 with an even abscissa.
#[derive(Debug, Clone, PartialEq)]
pub struct UffFunction {
    /// First identification line, else the node of the response.
    pub name: String,
    /// 1 time response, 2 auto spectrum, 3 cross spectrum, 4 frequency response, 6 coherence, …
    pub kind: i64,
    /// Where the response was measured.
    pub response: NodalDirection,
    /// Where the force acted, or where the reference was measured.
    pub reference: NodalDirection,
    /// Quantity of the ordinate (of its numerator where it is a ratio).
    pub quantity: Quantity,
    /// Unit of the ordinate.
    pub unit: String,
    /// First value of the abscissa, s or Hz.
    pub start: f64,
    /// Interval of the abscissa, s or Hz.
    pub step: f64,
    /// Real parts.
    pub re: Vec<f64>,
    /// Imaginary parts; empty for a real function.
    pub im: Vec<f64>,
}

/// All datasets 58 and 58b of a universal file that have an even abscissa, real or complex; `name` serves messages only.
///
/// # Errors
/// [`ReadError`] with the file and the place in it.
///
/// ```
/// use iwan_io::{NodalDirection, UffFunction, uff_functions, write_uff};
/// let at = |node| NodalDirection { node, direction: 3 };
/// let function = UffFunction {
///     name: "H".into(), kind: 4, response: at(12), reference: at(1), quantity: iwan_io::Quantity::Acceleration,
///     unit: "m/s^2".into(), start: 0.0, step: 0.5, re: vec![1.0, 2.0], im: vec![0.0, -3.5],
/// };
/// let text = write_uff::functions(std::slice::from_ref(&function));
/// assert_eq!(uff_functions("frf.uff".as_ref(), text.as_bytes())?.0, [function]);
/// # Ok::<(), iwan_io::ReadError>(())
/// ```
pub fn functions(name: &Path, bytes: &[u8]) -> Result<(Vec<UffFunction>, Vec<Warning>), ReadError> {
    let source = FileBytes { file: name, bytes };
    let (mut warnings, mut functions) = (Vec::new(), Vec::new());
    for (section, window) in qualifiers::split(&source, &mut warnings)? {
        let header = Header::parse(&source, &section)?;
        let name = header.name(section.index);
        if !header.even {
            let reason = "its abscissa is uneven".into();
            warnings.push(Warning::LeftOut { name, reason });
            continue;
        }
        if let Some(reason) = Window::refusal(window, &header) {
            let reason = format!("{reason}: {}", qualifiers::REMEDY);
            warnings.push(Warning::LeftOut { name, reason });
            continue;
        }
        warnings.extend(Window::remark(window, &header, &name));
        let (re, im) = data::read_any(&source, &section, &header, &mut warnings)?;
        functions.push(UffFunction {
            name,
            kind: header.function_type,
            response: header.response_at,
            reference: header.reference_at,
            quantity: header.quantity(),
            unit: header.ordinate_unit.clone(),
            start: header.start,
            step: header.step,
            re,
            im,
        });
    }
    Ok((functions, warnings))
}
