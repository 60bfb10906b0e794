//! netCDF classic (CDF-1, CDF-2, CDF-5; "NetCDF Classic Format Specification", Unidata): matrices are variables of two dimensions.
//! Sierra/SD writes Craig-Bampton models in this form (`CBMODEL ... format = netcdf`): `Kr`, `Mr`, `Cr`, and the meaning of their rows in
//! `cbmap`.
//!
//! The reader, of a header and of contiguous arrays, is our own: the published crate reads from paths only and trusts the sizes in the
//! header.

use iwan_io::{NumberType, Order};

use crate::error::ExchangeError;
use crate::matrix::{Component, Label, Matrix, Stored};
use crate::source::{MOST_ROWS, Source};

/// Tags of the lists in a header: dimensions, variables, attributes.
const DIMENSIONS: u64 = 10;
const VARIABLES: u64 = 11;
const ATTRIBUTES: u64 = 12;

/// Whether bytes begin as a netCDF classic file does.
pub(crate) fn is_one(bytes: &[u8]) -> bool {
    matches!(bytes, [b'C', b'D', b'F', 1 | 2 | 5, ..])
}

/// A variable without the dimension of records (the dimension that can grow).
struct Variable<'a> {
    name: String,
    shape: Vec<usize>,
    kind: NumberType,
    data: &'a [u8],
}

impl Variable<'_> {
    fn at(&self, at: usize) -> f64 {
        self.kind.at(Order::Big, self.data, at).unwrap_or(f64::NAN)
    }

    fn count(&self) -> usize {
        self.data.len() / self.kind.size()
    }
}

/// Reads the header piece by piece.
struct Header<'s, 'a> {
    source: &'s Source<'a>,
    at: usize,
    /// Bytes of a count and bytes of an offset, 4 or 8.
    count: usize,
    offset: usize,
}

impl<'a> Header<'_, 'a> {
    fn bytes(&mut self, length: usize) -> Result<&'a [u8], ExchangeError> {
        let piece = self.source.bytes.get(self.at..).and_then(|rest| rest.get(..length));
        let piece = piece.ok_or_else(|| {
            let found = format!("a header that needs {length} bytes behind byte {}", self.at);
            self.source.malformed("the header", found, "a whole netCDF header")
        })?;
        self.at += length;
        Ok(piece)
    }

    fn word(&mut self, length: usize) -> Result<u64, ExchangeError> {
        Ok(self.bytes(length)?.iter().fold(0, |word, byte| word << 8 | u64::from(*byte)))
    }

    /// The number of entries of a list, whose tag must be `tag`; 0 where the list is absent.
    fn list(&mut self, tag: u64) -> Result<u64, ExchangeError> {
        let (found, count) = (self.word(4)?, self.word(self.count)?);
        if found == tag || (found == 0 && count == 0) {
            return Ok(count);
        }
        let found = format!("tag {found} before byte {}", self.at);
        Err(self.source.malformed("the header", found, format!("tag {tag}, or 0 for an empty list")))
    }

    /// The next `length` bytes; the padding behind them, up to a multiple of four, is passed over.
    fn padded(&mut self, length: u64) -> Result<&'a [u8], ExchangeError> {
        let length = usize::try_from(length).unwrap_or(usize::MAX);
        let piece = self.bytes(length)?;
        self.at = (self.at + (4 - length % 4) % 4).min(self.source.bytes.len());
        Ok(piece)
    }

    fn name(&mut self) -> Result<String, ExchangeError> {
        let length = self.word(self.count)?;
        Ok(String::from_utf8_lossy(self.padded(length)?).into_owned())
    }

    fn kind(&mut self) -> Result<NumberType, ExchangeError> {
        Ok(match self.word(4)? {
            1 => NumberType::I8,
            2 | 7 => NumberType::U8,
            3 => NumberType::I16,
            4 => NumberType::I32,
            5 => NumberType::F32,
            6 => NumberType::F64,
            8 => NumberType::U16,
            9 => NumberType::U32,
            10 => NumberType::I64,
            11 => NumberType::U64,
            other => {
                return Err(self.source.malformed(
                    "the header",
                    format!("type {other}"),
                    "a type from 1 to 11",
                ));
            }
        })
    }

    fn skip_attributes(&mut self) -> Result<(), ExchangeError> {
        for _ in 0..self.list(ATTRIBUTES)? {
            self.name()?;
            let size = self.kind()?.size() as u64;
            let count = self.word(self.count)?;
            self.padded(count.saturating_mul(size))?;
        }
        Ok(())
    }
}

/// All variables without the dimension of records; the header gives that dimension the length 0.
fn variables<'a>(source: &Source<'a>) -> Result<Vec<Variable<'a>>, ExchangeError> {
    let (count, offset) = match source.bytes.get(3) {
        Some(1) => (4, 4),
        Some(2) => (4, 8),
        _ => (8, 8),
    };
    let mut header = Header { source, at: 4, count, offset };
    header.word(count)?;
    let mut sizes = Vec::new();
    for _ in 0..header.list(DIMENSIONS)? {
        header.name()?;
        sizes.push(header.word(count)?);
    }
    header.skip_attributes()?;
    let mut all = Vec::new();
    for _ in 0..header.list(VARIABLES)? {
        all.extend(variable(source, &mut header, &sizes)?);
    }
    // Variables that overlap in the file would be as many matrices as the header names, whatever the file's size.
    let held: usize = all.iter().map(|v| v.data.len()).sum();
    if held > source.bytes.len() {
        let found = format!("variables of {held} bytes in a file of {}", source.bytes.len());
        return Err(source.malformed("the header", found, "variables that lie behind each other"));
    }
    Ok(all)
}

fn variable<'a>(
    source: &Source<'a>,
    header: &mut Header<'_, 'a>,
    sizes: &[u64],
) -> Result<Option<Variable<'a>>, ExchangeError> {
    let name = header.name()?;
    let place = || format!("variable '{name}'");
    let mut shape = Vec::new();
    for _ in 0..header.word(header.count)? {
        let at = header.word(header.count)?;
        let size = usize::try_from(at).ok().and_then(|at| sizes.get(at));
        let size = *size.ok_or_else(|| {
            source.malformed(place(), format!("dimension {at}"), format!("one of {} dimensions", sizes.len()))
        })?;
        shape.push(usize::try_from(size).unwrap_or(usize::MAX));
    }
    header.skip_attributes()?;
    let kind = header.kind()?;
    header.word(header.count)?;
    let begin = header.word(header.offset)?;
    if shape.contains(&0) {
        return Ok(None);
    }
    let length = shape.iter().try_fold(kind.size(), |product, n| product.checked_mul(*n));
    let data = usize::try_from(begin).ok().zip(length);
    let data =
        data.and_then(|(begin, length)| source.bytes.get(begin..)?.get(..length)).ok_or_else(|| {
            let found = format!(
                "{} bytes of the file for the shape {shape:?} from byte {begin} on",
                source.bytes.len()
            );
            source.malformed(place(), found, "a whole file")
        })?;
    Ok(Some(Variable { name, shape, kind, data }))
}

/// The labels of the rows of a Craig-Bampton model: `cbmap` has a line node, component for each row. Both are 0 for the coordinate of a
/// fixed-interface mode, which then has the number of its row (from 1) as its node.
fn labels(source: &Source, map: &Variable) -> Result<Vec<Label>, ExchangeError> {
    let label = |row: usize| {
        let (node, number) = (map.at(2 * row), map.at(2 * row + 1));
        if node == 0.0 && number == 0.0 {
            return Ok(Label { node: row as u64 + 1, component: Component::Scalar });
        }
        let component = (1.0..=6.0).contains(&number).then(|| Component::numbered(number as u64)).flatten();
        let component = component.filter(|_| node >= 1.0);
        let place = || format!("variable 'cbmap', row {}", row + 1);
        let component = component.ok_or_else(|| {
            source.malformed(
                place(),
                format!("{node}, {number}"),
                "a node and a component from 1 to 6, or 0, 0",
            )
        })?;
        Ok(Label { node: node as u64, component })
    };
    (0..map.shape[0]).map(label).collect()
}

/// All matrices of numbers of a netCDF file; the rows of square matrices are labelled where `cbmap` states their meaning.
pub(crate) fn parse(source: &Source) -> Result<Vec<Matrix>, ExchangeError> {
    let variables = variables(source)?;
    let map = variables.iter().find(|v| v.name == "cbmap" && v.shape.len() == 2 && v.shape[1] == 2);
    let labels = map.map(|map| labels(source, map)).transpose()?;
    let mut matrices = Vec::new();
    for variable in variables.iter().filter(|v| v.shape.len() == 2 && v.kind.is_real()) {
        let (rows, columns) = (variable.shape[0], variable.shape[1]);
        let place = || format!("variable '{}'", variable.name);
        if rows as u64 > MOST_ROWS || columns as u64 > MOST_ROWS {
            return Err(source.malformed(
                place(),
                format!("{rows} x {columns}"),
                format!("at most {MOST_ROWS} rows"),
            ));
        }
        let mut entries = Vec::new();
        for at in 0..variable.count() {
            let value = variable.at(at);
            if !value.is_finite() {
                let found = format!("{value} in row {}, column {}", at / columns + 1, at % columns + 1);
                return Err(source.malformed(place(), found, "finite numbers"));
            }
            if value != 0.0 {
                entries.push(((at / columns) as u32, (at % columns) as u32, value));
            }
        }
        let own = labels.as_ref().filter(|labels| rows == columns && labels.len() == rows).cloned();
        let name = variable.name.clone();
        matrices.push(Matrix {
            name,
            rows,
            columns,
            entries,
            stored: Stored::All,
            labels: own,
            complex: false,
        });
    }
    if matrices.is_empty() {
        Err(source.ends("a variable of two dimensions that holds real numbers"))
    } else {
        Ok(matrices)
    }
}

/// Positions of nodes as an Exodus file stores them: `coordx`, `coordy`, `coordz` and `node_num_map`.
pub(crate) fn positions(source: &Source) -> Result<Vec<(u64, [f64; 3])>, ExchangeError> {
    let variables = variables(source)?;
    let get = |name: &str| {
        let found = variables.iter().find(|v| v.name == name && v.shape.len() == 1);
        found.ok_or_else(|| {
            source.malformed("the header", format!("no variable '{name}'"), "the nodes of an Exodus file")
        })
    };
    let [x, y, z, numbers] = [get("coordx")?, get("coordy")?, get("coordz")?, get("node_num_map")?];
    let node = |at: usize| {
        let (number, position) = (numbers.at(at), [x.at(at), y.at(at), z.at(at)]);
        if number >= 0.0 && number.fract() == 0.0 && position.iter().all(|p| p.is_finite()) {
            return Ok((number as u64, position));
        }
        let found = format!("node {number} at {position:?}");
        Err(source.malformed(
            format!("node {} of the file", at + 1),
            found,
            "a number and three finite positions",
        ))
    };
    (0..numbers.count()).map(node).collect()
}
