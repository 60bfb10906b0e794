//! What all targets ask of a reader.

use iwan_io::{Format, ReadError, ReadOptions, Record, read_bytes};
use std::path::Path;

/// Name of the file in messages.
pub const NAME: &str = "fuzz";

/// Reads any bytes as a file of the format, with its own times and with a rate that goes before them: an error that names the file or a
/// sound record, never a panic.
///
/// # Panics
/// Where a record is none, or a message does not say which file it is about.
pub fn read(format: Format, bytes: &[u8]) {
    for rate in [None, Some(1.0)] {
        let options = ReadOptions { format: Some(format), rate, resample: true, ..Default::default() };
        if let Some(record) = told(read_bytes(Path::new(NAME), bytes, &options)) {
            sound(&record);
        }
    }
}

/// What was read, or none where it was refused.
///
/// # Panics
/// Where the message does not begin with the name of the file.
pub fn told<T>(outcome: Result<T, ReadError>) -> Option<T> {
    match outcome {
        Ok(found) => Some(found),
        Err(error) => {
            let text = error.to_string();
            assert!(text.starts_with(NAME), "{text}");
            None
        }
    }
}

fn sound(record: &Record) {
    assert!(record.len() >= 2 && record.dt() > 0.0 && record.dt().is_finite());
    let whole = |c: &Vec<f64>| c.len() == record.len() && c.iter().all(|v| v.is_finite());
    assert!(record.samples().iter().all(whole));
    assert_eq!(record.names().len(), record.channels());
}
