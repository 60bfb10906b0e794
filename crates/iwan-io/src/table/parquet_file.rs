//! Columns of f64 as a Parquet file.

use parquet::basic::{Encoding, Repetition, Type as Physical};
use parquet::data_type::DoubleType;
use parquet::errors::Result;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use std::io::Write;
use std::sync::Arc;

/// Rows of one row group: 8 MiB for each column, which the writer holds in memory until the group is closed. Readers take
/// groups of any size; a tenth or ten times as many change no file by more than its index.
const GROUP: usize = 1 << 20;

pub(super) fn write(columns: &[(String, &[f64])], sink: impl Write + Send) -> Result<()> {
    let field = |name: &String| {
        let field = Type::primitive_type_builder(name, Physical::DOUBLE);
        field.with_repetition(Repetition::REQUIRED).build().map(Arc::new)
    };
    let fields = columns.iter().map(|(name, _)| field(name)).collect::<Result<Vec<_>>>()?;
    let schema = Type::group_type_builder("table").with_fields(fields).build()?;
    let properties = WriterProperties::builder().set_dictionary_enabled(false).set_encoding(Encoding::PLAIN);
    let mut file = SerializedFileWriter::new(sink, Arc::new(schema), Arc::new(properties.build()))?;
    let rows = columns.first().map_or(0, |(_, values)| values.len());
    for start in (0..rows).step_by(GROUP) {
        let mut group = file.next_row_group()?;
        let end = rows.min(start + GROUP);
        for (_, values) in columns {
            if let Some(mut column) = group.next_column()? {
                column.typed::<DoubleType>().write_batch(&values[start..end], None, None)?;
                column.close()?;
            }
        }
        group.close()?;
    }
    file.close()?;
    Ok(())
}
