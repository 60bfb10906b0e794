//! Columns of f64 as a Parquet file.

use parquet::basic::{Encoding, Repetition, Type as Physical};
use parquet::data_type::DoubleType;
use parquet::errors::Result;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use std::io::Write;
use std::sync::Arc;

/// Rows of one row group: 8 MiB for each column, which the writer holds in memory until the group is closed. Readers accept groups of any
/// size; with a tenth or ten times as many rows only the file's index changes in size.
const GROUP: usize = 1 << 20;

pub(super) fn write(columns: &[(String, &[f64])], sink: impl Write + Send) -> Result<()> {
    let names: Vec<String> = columns.iter().map(|(name, _)| name.clone()).collect();
    let mut file = open(&names, sink)?;
    let rows = columns.first().map_or(0, |(_, values)| values.len());
    for start in (0..rows).step_by(GROUP) {
        let end = rows.min(start + GROUP);
        let part: Vec<&[f64]> = columns.iter().map(|(_, values)| &values[start..end]).collect();
        group(&mut file, &part)?;
    }
    file.close()?;
    Ok(())
}

/// Begins a file of required DOUBLE columns.
pub(super) fn open<W: Write + Send>(names: &[String], sink: W) -> Result<SerializedFileWriter<W>> {
    let field = |name: &String| {
        let field = Type::primitive_type_builder(name, Physical::DOUBLE);
        field.with_repetition(Repetition::REQUIRED).build().map(Arc::new)
    };
    let fields = names.iter().map(field).collect::<Result<Vec<_>>>()?;
    let schema = Type::group_type_builder("table").with_fields(fields).build()?;
    let properties = WriterProperties::builder().set_dictionary_enabled(false).set_encoding(Encoding::PLAIN);
    SerializedFileWriter::new(sink, Arc::new(schema), Arc::new(properties.build()))
}

/// Adds a row group.
pub(super) fn group<W: Write + Send>(file: &mut SerializedFileWriter<W>, columns: &[&[f64]]) -> Result<()> {
    let mut group = file.next_row_group()?;
    for values in columns {
        if let Some(mut column) = group.next_column()? {
            column.typed::<DoubleType>().write_batch(values, None, None)?;
            column.close()?;
        }
    }
    group.close()?;
    Ok(())
}
