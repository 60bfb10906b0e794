//! One NumPy array, format versions 1 to 3 (NumPy Enhancement Proposal 1, `numpy.lib.format`).
//!
//! The reader is our own because it is short: the published readers allocate what a header promises and parse its dictionary with a
//! general Python parser that needs a C tool chain; a damaged header must neither exhaust memory nor panic here.

use std::path::Path;

use crate::bytes::{NumberType, Order, to_f64};
use crate::error::ReadError;
use crate::file_bytes::{FileBytes, decode};
use iwan_machine::shortened;

/// Start of every NPY file.
pub const NPY_MAGIC: &[u8] = b"\x93NUMPY";

/// Most dimensions of an array, NumPy's own limit up to version 1; records and matrices have at most two. One size more is kept, so that
/// readers refuse the array.
const MOST_DIMENSIONS: usize = 32;
/// Longest text of an array, in characters; labels and names of formats are shorter. Arrays of longer texts are refused.
const LONGEST_TEXT: usize = 64;

/// An array of an NPY file or of an archive of such files. Its numbers stay as stored until they are asked for.
#[derive(Debug, Clone)]
pub struct NumpyArray<'a> {
    /// Size of each dimension; the product of the sizes is the number of elements.
    pub shape: Vec<usize>,
    /// Whether the first index runs fastest (Fortran order); else the last index does.
    pub fortran: bool,
    /// Type of the elements as NumPy names it.
    descr: String,
    elements: Elements,
    data: &'a [u8],
}

/// Type of the elements of an array.
#[derive(Debug, Clone, Copy)]
enum Elements {
    Numbers(NumberType, Order),
    /// Texts, with the size of each in bytes.
    Text(usize),
}

impl Elements {
    fn size(self) -> usize {
        match self {
            Self::Numbers(kind, _) => kind.size(),
            Self::Text(size) => size,
        }
    }
}

impl<'a> NumpyArray<'a> {
    /// The array in `bytes`; `file` and `name` serve the messages.
    ///
    /// ```
    /// let mut bytes = b"\x93NUMPY\x01\x00\x39\x00{'descr': '<i2', 'fortran_order': False, 'shape': (2,)} \n".to_vec();
    /// bytes.extend([7, 0, 255, 255]);
    /// let array = iwan_io::NumpyArray::read("k.npy".as_ref(), &bytes, "k")?;
    /// assert_eq!((array.len(), array.at(0), array.at(1)), (2, Some(7.0), Some(-1.0)));
    /// # Ok::<(), iwan_io::ReadError>(())
    /// ```
    ///
    /// # Errors
    /// [`ReadError`] where the header is damaged, bytes are missing, or the elements are neither real numbers nor short texts.
    pub fn read(file: &Path, bytes: &'a [u8], name: &str) -> Result<Self, ReadError> {
        let source = FileBytes { file, bytes };
        let (text, data) = split(bytes).ok_or_else(|| {
            let found = "no complete NPY header".to_string();
            source.malformed(
                format!("array '{name}'"),
                found,
                "the magic string, version 1 to 3, and the header",
            )
        })?;
        let text = decode(text);
        let place = |key: &str| format!("array '{name}', key '{key}'");
        let bad =
            |key: &str, expected: &str| source.malformed(place(key), shortened(text.trim(), 120), expected);
        let descr = value(&text, "descr").ok_or_else(|| bad("descr", "a type such as '<f8'"))?;
        let descr = quoted(descr).unwrap_or(descr.trim_start());
        let elements = elements(descr).ok_or_else(|| not_numbers(&source, name, descr))?;
        let fortran = match value(&text, "fortran_order").map(str::trim_start) {
            Some(v) if v.starts_with("True") => true,
            Some(v) if v.starts_with("False") => false,
            _ => return Err(bad("fortran_order", "True or False")),
        };
        let shape = value(&text, "shape").and_then(shape).ok_or_else(|| bad("shape", "a tuple of sizes"))?;
        let count = if shape.contains(&0) {
            Some(0)
        } else {
            shape.iter().try_fold(elements.size(), |product, n| product.checked_mul(*n))
        };
        let Some(data) = count.and_then(|n| data.get(..n)) else {
            let promised = count.map_or(u64::MAX, |p| p as u64);
            return Err(source.cut_short(format!("array '{name}'"), "bytes", promised, data.len() as u64));
        };
        Ok(Self { shape, fortran, descr: descr.into(), elements, data })
    }

    /// Number of elements.
    #[must_use]
    pub fn len(&self) -> usize {
        self.data.len() / self.elements.size().max(1)
    }

    /// Whether the array has no elements.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.data.is_empty()
    }

    /// Element `at` (from 0) in the order of the file; none beyond the end, and none where the elements are texts. 64-bit integers above
    /// 2^53 are rounded.
    #[must_use]
    pub fn at(&self, at: usize) -> Option<f64> {
        match self.elements {
            Elements::Numbers(kind, order) => kind.at(order, self.data, at),
            Elements::Text(_) => None,
        }
    }

    /// The ASCII letters of all texts, one text behind the other; none where the elements are numbers.
    #[must_use]
    pub fn letters(&self) -> Option<String> {
        let letters = self.data.iter().filter(|b| b.is_ascii_alphabetic()).map(|b| char::from(*b));
        matches!(self.elements, Elements::Text(_)).then(|| letters.collect())
    }

    /// All elements in the order of the file.
    pub(super) fn numbers(&self, source: &FileBytes, name: &str) -> Result<Vec<f64>, ReadError> {
        match self.elements {
            Elements::Numbers(kind, order) => Ok(to_f64(self.data, kind, order)),
            Elements::Text(_) => Err(not_numbers(source, name, &self.descr)),
        }
    }
}

fn not_numbers(source: &FileBytes, name: &str, descr: &str) -> ReadError {
    let found = format!("type '{}'", shortened(descr, 40));
    let remedy = "save real numbers: float32, float64 or integers of up to 64 bits";
    source.unsupported(format!("array '{name}', key 'descr'"), found, remedy)
}

/// The dictionary of the header, and the data behind it.
fn split(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let rest = bytes.strip_prefix(NPY_MAGIC)?;
    let (length, start) = match rest.first()? {
        1 => (usize::from(u16::from_le_bytes([*rest.get(2)?, *rest.get(3)?])), 4),
        2 | 3 => {
            let raw = [*rest.get(2)?, *rest.get(3)?, *rest.get(4)?, *rest.get(5)?];
            (usize::try_from(u32::from_le_bytes(raw)).ok()?, 6)
        }
        _ => return None,
    };
    let rest = &rest[start..];
    Some((rest.get(..length)?, &rest[length..]))
}

/// The text behind `'key':` in the dictionary.
fn value<'a>(text: &'a str, key: &str) -> Option<&'a str> {
    let at = [format!("'{key}'"), format!("\"{key}\"")].iter().find_map(|k| Some(text.find(k)? + k.len()))?;
    text[at..].trim_start().strip_prefix(':')
}

fn quoted(text: &str) -> Option<&str> {
    let text = text.trim_start();
    let quote = text.chars().next().filter(|c| matches!(c, '\'' | '"'))?;
    text[1..].split(quote).next()
}

fn shape(text: &str) -> Option<Vec<usize>> {
    let (inside, _) = text.trim_start().strip_prefix('(')?.split_once(')')?;
    let sizes = inside.split(',').map(|s| s.trim().trim_end_matches('L')).filter(|s| !s.is_empty());
    sizes.take(MOST_DIMENSIONS + 1).map(|s| s.parse().ok()).collect()
}

/// The elements that a type name of NumPy stands for; none where it is neither a number nor a short text.
fn elements(descr: &str) -> Option<Elements> {
    let (order, name) = match descr.as_bytes().first()? {
        b'>' => (Order::Big, &descr[1..]),
        b'<' | b'|' | b'=' => (Order::Little, &descr[1..]),
        _ => (Order::Little, descr),
    };
    let kind = match name {
        "f8" => NumberType::F64,
        "f4" => NumberType::F32,
        "i1" => NumberType::I8,
        "u1" | "b1" => NumberType::U8,
        "i2" => NumberType::I16,
        "u2" => NumberType::U16,
        "i4" => NumberType::I32,
        "u4" => NumberType::U32,
        "i8" => NumberType::I64,
        "u8" => NumberType::U64,
        _ => {
            let (class, characters) = name.split_at_checked(1)?;
            let characters = characters.parse().ok().filter(|n| (1..=LONGEST_TEXT).contains(n))?;
            return match class {
                "S" => Some(Elements::Text(characters)),
                "U" => Some(Elements::Text(4 * characters)),
                _ => None,
            };
        }
    };
    Some(Elements::Numbers(kind, order))
}
