//! Arrays of a level 5 file: numeric arrays, text, and structs and cells of arrays.

use super::element::{Cursor, Element, ElementType};
use super::stored::{StoredMatrix, StoredNumbers};
use crate::assembly::Variable;
use crate::bytes::{Order, to_f64, u32_at};
use crate::error::ReadError;
use crate::file_bytes::{FileBytes, decode};
use iwan_machine::shortened;

/// Structs inside structs are read to this depth; deeper ones are refused by name when the user asks for them. The limit bounds the
/// recursion on a damaged file; the records known to us have three levels at most.
pub(super) const DEEPEST: usize = 8;

/// Largest number of dimensions of a cell array; arrays of more are refused by name when the user asks for them. Those of records have two.
const MOST_SUBSCRIPTS: usize = 8;

/// Longest name of a field in bytes, with the zero that ends it, as in MATLAB itself (`namelengthmax` is 63). A file with longer names is
/// refused as malformed.
const LONGEST_NAME: usize = 64;

/// What a file holds; each item is named by its path.
#[derive(Default)]
pub(super) struct Found {
    pub(super) arrays: Vec<Variable>,
    pub(super) texts: Vec<Said>,
    /// Sparse and complex matrices, which cannot be channels.
    pub(super) matrices: Vec<StoredMatrix>,
    /// Other arrays that cannot be channels, with what they are in words.
    pub(super) refused: Vec<Said>,
}

/// A text of the file, or a description of an array, with its path.
pub(super) struct Said {
    pub(super) path: String,
    pub(super) text: String,
}

impl Said {
    /// Path of a matrix, and why it is no channel.
    pub(super) fn no_channel(matrix: &StoredMatrix) -> Self {
        let text = if matrix.complex { "a complex array" } else { "a sparse array" };
        Self { path: matrix.name.clone(), text: text.into() }
    }
}

pub(super) struct Reader<'s> {
    pub(super) source: &'s FileBytes<'s>,
    pub(super) order: Order,
}

struct Head {
    class: u8,
    complex: bool,
    dims: Vec<usize>,
    name: String,
}

impl Reader<'_> {
    /// Reads a variable of the file; other elements (such as the file's own workspace data) are passed over.
    pub(super) fn top(&self, element: &Element, found: &mut Found) -> Result<(), ReadError> {
        if element.kind == ElementType::Matrix { self.matrix(element, None, 0, found) } else { Ok(()) }
    }

    fn matrix(
        &self,
        element: &Element,
        path: Option<&str>,
        depth: usize,
        found: &mut Found,
    ) -> Result<(), ReadError> {
        if element.data.is_empty() {
            return Ok(());
        }
        let mut cursor = Cursor::new(self.source, element.data, self.order, element.offset + 8);
        let Some(head) = self.head(&mut cursor, element)? else { return Ok(()) };
        let path = path.unwrap_or(&head.name);
        match head.class {
            1 if depth < DEEPEST && head.dims.len() <= MOST_SUBSCRIPTS => {
                self.cells(&mut cursor, &head, path, depth, found)
            }
            2 if depth < DEEPEST => self.fields(&mut cursor, &head, path, depth, found),
            4 => {
                let data = cursor.expect("text")?;
                found.texts.push(Said { path: path.into(), text: text(&data, self.order) });
                Ok(())
            }
            5 if head.dims.len() == 2 => {
                found.matrices.push(self.sparse(&mut cursor, &head, path)?);
                Ok(())
            }
            6..=15 if head.dims.len() == 2 => {
                let array = self.numeric(&mut cursor, &head, path)?;
                if head.complex {
                    let Variable { name, rows, columns, values, .. } = array;
                    let numbers = StoredNumbers::Full(values);
                    found.matrices.push(StoredMatrix { name, rows, columns, numbers, complex: true });
                } else {
                    found.arrays.push(array);
                }
                Ok(())
            }
            class => {
                found.refused.push(Said { path: path.into(), text: describe(class, &head) });
                Ok(())
            }
        }
    }

    /// Flags, dimensions and name of an array; none for an opaque object, which has a layout of its own.
    fn head(&self, cursor: &mut Cursor, element: &Element) -> Result<Option<Head>, ReadError> {
        let place = format!("array at byte {}", element.offset);
        let flags = cursor.expect("array flags")?;
        let Some(flags) = u32_at(flags.data, 0, self.order) else {
            return Err(self.source.malformed(place, "short array flags", "8 bytes"));
        };
        let [class, bits, ..] = flags.to_le_bytes();
        if class == 17 {
            return Ok(None);
        }
        let dims = cursor.expect("dimensions")?;
        let dims = dims.data.chunks_exact(4).map(|c| u32_at(c, 0, self.order));
        let dims = dims.map(|d| d.and_then(|d| usize::try_from(d).ok()).unwrap_or(0)).collect();
        let name = decode(cursor.expect("name")?.data);
        Ok(Some(Head { class, complex: bits & 8 != 0, dims, name }))
    }

    fn numeric(&self, cursor: &mut Cursor, head: &Head, path: &str) -> Result<Variable, ReadError> {
        let (rows, columns) = (head.dims[0], head.dims[1]);
        let values = self.numbers(cursor, "numbers", path)?;
        if rows.checked_mul(columns) != Some(values.len()) {
            let found = format!("{} values for {rows} x {columns}", values.len());
            let place = format!("variable '{}'", shortened(path, 80));
            return Err(self.source.malformed(place, found, "as many values as the dimensions say"));
        }
        Ok(Variable { name: path.into(), unit: String::new(), rows, columns, values })
    }

    /// The numbers of the next element.
    fn numbers(&self, cursor: &mut Cursor, what: &str, path: &str) -> Result<Vec<f64>, ReadError> {
        let data = cursor.expect(what)?;
        let ElementType::Number(kind) = data.kind else {
            let place = format!("variable '{}'", shortened(path, 80));
            return Err(self.source.malformed(place, format!("{:?} data", data.kind), what));
        };
        Ok(to_f64(data.data, kind, self.order))
    }

    /// A sparse matrix: row indices, starts of columns and values.
    fn sparse(&self, cursor: &mut Cursor, head: &Head, path: &str) -> Result<StoredMatrix, ReadError> {
        let numbers = StoredNumbers::Sparse {
            rows: self.numbers(cursor, "row indices", path)?,
            starts: self.numbers(cursor, "column starts", path)?,
            values: self.numbers(cursor, "values", path)?,
        };
        let (rows, columns, complex) = (head.dims[0], head.dims[1], head.complex);
        Ok(StoredMatrix { name: path.into(), rows, columns, numbers, complex })
    }

    fn fields(
        &self,
        cursor: &mut Cursor,
        head: &Head,
        path: &str,
        depth: usize,
        found: &mut Found,
    ) -> Result<(), ReadError> {
        let width = cursor.expect("length of field names")?;
        let width = u32_at(width.data, 0, self.order).and_then(|w| usize::try_from(w).ok()).unwrap_or(0);
        if width == 0 || width > LONGEST_NAME {
            let place = format!("struct '{}'", shortened(path, 80));
            let found = format!("field names of {width} bytes");
            return Err(self.source.malformed(place, found, format!("1 to {LONGEST_NAME}")));
        }
        let names: Vec<String> = cursor.expect("field names")?.data.chunks_exact(width).map(name).collect();
        let single = head.dims.iter().all(|d| *d == 1);
        // The number of elements in the file bounds this loop, whatever the dimensions say.
        let mut number = 0;
        while !names.is_empty() {
            number += 1;
            for field in &names {
                let Some(element) = cursor.next()? else { return Ok(()) };
                let owner = if single { path.to_string() } else { format!("{path}({number})") };
                if element.kind == ElementType::Matrix {
                    self.matrix(&element, Some(&format!("{owner}.{field}")), depth + 1, found)?;
                }
            }
        }
        Ok(())
    }

    /// Reads the cells of a cell array; their paths are as in MATLAB: `x{2,1}`.
    fn cells(
        &self,
        cursor: &mut Cursor,
        head: &Head,
        path: &str,
        depth: usize,
        found: &mut Found,
    ) -> Result<(), ReadError> {
        // The number of elements in the file bounds this loop, whatever the dimensions say.
        let mut number = 0_usize;
        while let Some(element) = cursor.next()? {
            let mut left = number;
            let mut subscripts = Vec::with_capacity(head.dims.len());
            for size in head.dims.iter().map(|d| (*d).max(1)) {
                subscripts.push((left % size + 1).to_string());
                left /= size;
            }
            if element.kind == ElementType::Matrix {
                self.matrix(
                    &element,
                    Some(&format!("{path}{{{}}}", subscripts.join(","))),
                    depth + 1,
                    found,
                )?;
            }
            number += 1;
        }
        Ok(())
    }
}

fn name(bytes: &[u8]) -> String {
    decode(bytes.split(|b| *b == 0).next().unwrap_or_default())
}

fn text(data: &Element, order: Order) -> String {
    let unit = match data.kind {
        ElementType::Text(n) => n,
        ElementType::Number(kind) => kind.size(),
        _ => 1,
    };
    if unit == 1 {
        return decode(data.data);
    }
    let low = if order == Order::Little { 0 } else { unit - 1 };
    let high = if order == Order::Little { 1 } else { unit - 2 };
    let units = data.data.chunks_exact(unit).map(|c| u16::from_le_bytes([c[low], c[high]]));
    char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
}

fn describe(class: u8, head: &Head) -> String {
    match class {
        1 => format!(
            "a cell array more than {DEEPEST} levels deep or of more than {MOST_SUBSCRIPTS} dimensions"
        ),
        2 => format!("a struct more than {DEEPEST} levels deep"),
        3 => "an object".into(),
        5 => format!("a sparse array of {} dimensions", head.dims.len()),
        6..=15 => format!("an array of {} dimensions", head.dims.len()),
        other => format!("an array of class {other}"),
    }
}
