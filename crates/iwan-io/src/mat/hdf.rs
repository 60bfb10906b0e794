//! MATLAB level 7.3: an HDF5 file in which groups are structs and references are the elements of cell and struct arrays.
//!
//! The crate `hdf5-pure` reads the HDF5 structure; this file interprets what MATLAB stores in it: dimensions in reversed order, the class
//! in an attribute, text as numbers, elements of cell arrays in a hidden group. Arrays that cannot be read are refused by name when the
//! user asks for them.

use hdf5_pure::{AttrValue, DType, Dataset, File, Group, Object};

use super::matrix::{DEEPEST, Found, Said};
use super::stored::{StoredMatrix, StoredNumbers};
use crate::assembly::Variable;
use crate::error::ReadError;
use crate::file_bytes::FileBytes;
use crate::inflate::most;
use iwan_machine::shortened;

/// Longest text that is kept, in characters: units have some characters, and the rest of a longer text is no part of a unit.
const LONGEST_TEXT: usize = 1000;

/// Bytes that each visit to a struct, an array or a cell takes off the budget. References may form circles, which would be followed without
/// end in a file of a few hundred bytes. Each struct, array or cell takes some hundred bytes of the file, for which the budget grants ten
/// thousand: any number up to that does as well.
const LOOK: u64 = 4096;

/// What a level 7.3 file holds.
pub(super) fn read(source: &FileBytes) -> Result<Found, ReadError> {
    let expected = "an HDF5 file as MATLAB writes it";
    let file = File::from_bytes(source.bytes.to_vec())
        .map_err(|e| source.malformed("HDF5 structure", e.to_string(), expected))?;
    let mut walk = Walk { source, found: Found::default(), budget: most(source.bytes.len()) };
    walk.group(&file.root(), "", 0)?;
    Ok(walk.found)
}

struct Walk<'s> {
    source: &'s FileBytes<'s>,
    found: Found,
    /// Bytes that may still be read: several references may name the same data.
    budget: u64,
}

impl Walk<'_> {
    /// Reads the fields of a struct, or the variables of the file.
    fn group(&mut self, group: &Group, path: &str, depth: usize) -> Result<(), ReadError> {
        self.spend(path, 0, || "structs in structs".into())?;
        if depth > DEEPEST {
            let text = format!("a struct more than {DEEPEST} levels deep");
            self.found.refused.push(Said { path: path.into(), text });
            return Ok(());
        }
        let broken = |e: hdf5_pure::Error| {
            let place =
                if path.is_empty() { "the list of variables".into() } else { format!("struct '{path}'") };
            self.source.malformed(place, e.to_string(), "a group of HDF5")
        };
        let (sets, groups) = (group.datasets().map_err(broken)?, group.groups().map_err(broken)?);
        let named = |name: &str| if path.is_empty() { name.to_string() } else { format!("{path}.{name}") };
        for name in sets.iter().filter(|n| !n.starts_with('#')) {
            match group.dataset(name) {
                Ok(set) => self.dataset(&set, &named(name), depth)?,
                Err(e) => self.refuse(&named(name), &e),
            }
        }
        for name in groups.iter().filter(|n| !n.starts_with('#')) {
            match group.group(name) {
                Ok(inner) => match sparse_rows(&inner) {
                    Some(rows) => self.sparse(&inner, &named(name), rows)?,
                    None => self.group(&inner, &named(name), depth + 1)?,
                },
                Err(e) => self.refuse(&named(name), &e),
            }
        }
        Ok(())
    }

    /// Reads a sparse matrix: a group of `ir`, `jc` and `data`, where `ir` and `data` are missing if all entries are zero.
    fn sparse(&mut self, group: &Group, path: &str, rows: usize) -> Result<(), ReadError> {
        let mut read = |name: &str| -> Result<Option<Vec<f64>>, ReadError> {
            let Ok(set) = group.dataset(name) else { return Ok(Some(Vec::new())) };
            let shape = set.shape().unwrap_or_default();
            let count = shape.iter().try_fold(1_u64, |n, d| n.checked_mul(*d)).unwrap_or(u64::MAX);
            self.spend(&format!("{path}.{name}"), count, || format!("{count} values"))?;
            match set.read_f64() {
                Ok(values) => Ok(Some(values)),
                Err(e) => {
                    self.refuse(path, &e);
                    Ok(None)
                }
            }
        };
        let (Some(row_indices), Some(starts), Some(values)) = (read("ir")?, read("jc")?, read("data")?)
        else {
            return Ok(());
        };
        let columns = starts.len().saturating_sub(1);
        let numbers = StoredNumbers::Sparse { rows: row_indices, starts, values };
        self.found.matrices.push(StoredMatrix { name: path.into(), rows, columns, numbers, complex: false });
        Ok(())
    }

    /// Takes one visit and the memory of `count` numbers off the budget; an error where the budget is too small. `what` describes the data
    /// in the message.
    fn spend(&mut self, path: &str, count: u64, what: impl Fn() -> String) -> Result<(), ReadError> {
        let needed = count.saturating_mul(8).saturating_add(LOOK);
        if needed > self.budget {
            let place = format!("variable '{}'", shortened(path, 80));
            let found = format!("{}, more than a file of {} bytes can hold", what(), self.source.bytes.len());
            return Err(self.source.malformed(
                place,
                found,
                "sizes that fit the file, and nothing that holds itself",
            ));
        }
        self.budget -= needed;
        Ok(())
    }

    fn refuse(&mut self, path: &str, error: &hdf5_pure::Error) {
        self.found
            .refused
            .push(Said { path: path.into(), text: format!("stored in a way that is not read ({error})") });
    }

    /// Reads an array, a text, or the elements that references name.
    fn dataset(&mut self, set: &Dataset, path: &str, depth: usize) -> Result<(), ReadError> {
        let attributes = set.attrs().unwrap_or_default();
        if attributes.contains_key("MATLAB_empty") {
            return Ok(());
        }
        // The attribute's room for the name does not matter: programs in C count the zero that ends it, others do not.
        let class = attributes.get("MATLAB_class").and_then(AttrValue::as_str).unwrap_or_default();
        let (shape, kind) = match (set.shape(), set.dtype()) {
            (Ok(shape), Ok(kind)) => (shape, kind),
            (Err(e), _) | (_, Err(e)) => {
                self.refuse(path, &e);
                return Ok(());
            }
        };
        let count = shape.iter().try_fold(1_u64, |n, d| n.checked_mul(*d)).unwrap_or(u64::MAX);
        self.spend(path, count, || format!("{count} values"))?;
        match kind {
            DType::ObjectReference => self.elements(set, path, class == "cell", &shape, depth),
            DType::F32
            | DType::F64
            | DType::I8
            | DType::I16
            | DType::I32
            | DType::I64
            | DType::U8
            | DType::U16
            | DType::U32
            | DType::U64 => {
                self.numbers(set, path, class == "char", &shape);
                Ok(())
            }
            other => {
                let text = format!("an array of type {other}");
                self.found.refused.push(Said { path: path.into(), text });
                Ok(())
            }
        }
    }

    /// Reads numbers, or the characters of a text; MATLAB's rows are the last dimension of HDF5.
    fn numbers(&mut self, set: &Dataset, path: &str, text: bool, shape: &[u64]) {
        let size = |d: u64| usize::try_from(d).unwrap_or(usize::MAX);
        let (rows, columns) = match *shape {
            [] => (1, 1),
            [n] => (size(n), 1),
            [columns, rows] => (size(rows), size(columns)),
            _ => {
                let text = format!("an array of {} dimensions", shape.len());
                return self.found.refused.push(Said { path: path.into(), text });
            }
        };
        match set.read_f64() {
            Err(e) => self.refuse(path, &e),
            Ok(values) if text => {
                let units = values.iter().take(LONGEST_TEXT).map(|v| code_unit(*v));
                let text =
                    char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect();
                self.found.texts.push(Said { path: path.into(), text });
            }
            Ok(values) if rows.checked_mul(columns) == Some(values.len()) => {
                self.found.arrays.push(Variable {
                    name: path.into(),
                    unit: String::new(),
                    rows,
                    columns,
                    values,
                });
            }
            Ok(values) => {
                let text = format!("an array of {} values for {rows} x {columns}", values.len());
                self.found.refused.push(Said { path: path.into(), text });
            }
        }
    }

    /// Reads the elements of a cell array, `x{1,2}`, or one field of a struct array, `hits(2).acc`.
    fn elements(
        &mut self,
        set: &Dataset,
        path: &str,
        cell: bool,
        shape: &[u64],
        depth: usize,
    ) -> Result<(), ReadError> {
        if depth > DEEPEST {
            let text = format!("a cell array more than {DEEPEST} levels deep");
            self.found.refused.push(Said { path: path.into(), text });
            return Ok(());
        }
        let objects = match set.dereference() {
            Ok(objects) => objects,
            Err(e) => {
                self.refuse(path, &e);
                return Ok(());
            }
        };
        let rows = shape.last().copied().and_then(|d| usize::try_from(d).ok()).unwrap_or(1).max(1);
        for (n, object) in objects.iter().enumerate() {
            let name = match (cell, path.rsplit_once('.')) {
                (false, Some((owner, field))) => format!("{owner}({}).{field}", n + 1),
                (false, None) => format!("{path}({})", n + 1),
                (true, _) => format!("{path}{{{},{}}}", n % rows + 1, n / rows + 1),
            };
            match object {
                Object::Dataset(inner) => self.dataset(inner, &name, depth + 1)?,
                Object::Group(inner) => self.group(inner, &name, depth + 1)?,
                _ => {}
            }
        }
        Ok(())
    }
}

/// A code unit of UTF-16, as MATLAB stores characters; the replacement character where the value is no code unit.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // checked
fn code_unit(value: f64) -> u16 {
    if (0.0..=65_535.0).contains(&value) { value as u16 } else { 0xfffd }
}

/// Number of rows of a group that is a sparse matrix; none for other groups.
fn sparse_rows(group: &Group) -> Option<usize> {
    let rows = match group.attrs().ok()?.get("MATLAB_sparse")? {
        AttrValue::U64(rows) => *rows,
        AttrValue::I64(rows) => u64::try_from(*rows).ok()?,
        AttrValue::U32(rows) => u64::from(*rows),
        AttrValue::I32(rows) => u64::try_from(*rows).ok()?,
        _ => return None,
    };
    usize::try_from(rows).ok()
}
