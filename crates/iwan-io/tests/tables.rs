//! Tables come back as they were written.
#![allow(clippy::unwrap_used)]

use iwan_io::{Table, TableError, read_table};
use parquet::file::reader::{FileReader, SerializedFileReader};
use proptest::prelude::*;

const ODD: [f64; 9] =
    [0.0, -0.0, 0.1, 1e-320, f64::MAX, -1.0 / 3.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

fn table(values: &[f64]) -> Table<'_> {
    Table::new(vec![("t, \"s\"".into(), values), ("b".into(), values)]).unwrap()
}

fn same(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan())
}

#[test]
fn csv_gives_the_same_bits_back() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("a.csv");
    table(&ODD).write_csv(&path, false).unwrap();
    let back = read_table(&path).unwrap();
    assert_eq!(back.names(), ["t, \"s\"", "b"]);
    assert!(same(back.column("b").unwrap(), &ODD) && same(&back.columns()[0], &ODD));
    assert!(table(&ODD).write_csv(&path, false).unwrap_err().to_string().contains("--force"));
}

#[test]
fn parquet_gives_the_same_bits_back() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("a.parquet");
    table(&ODD).write_parquet(&path, false).unwrap();
    let file = SerializedFileReader::new(std::fs::File::open(&path).unwrap()).unwrap();
    let rows = file.get_row_iter(None).unwrap();
    let back: Vec<f64> =
        rows.map(|r| parquet::record::RowAccessor::get_double(&r.unwrap(), 1).unwrap()).collect();
    assert!(same(&back, &ODD));
}

#[test]
fn columns_are_checked() {
    assert_eq!(Table::new(vec![]), Err(TableError::Empty));
    let uneven = Table::new(vec![("a".into(), &ODD[..]), ("b".into(), &ODD[1..])]);
    assert!(matches!(uneven, Err(TableError::Lengths { rows: 8, expected: 9, .. })));
    let twice = Table::new(vec![("a".into(), &ODD[..]), ("a".into(), &ODD[..])]);
    assert!(matches!(twice, Err(TableError::Name { index: 1, .. })));
}

proptest! {
    #[test]
    fn any_bits_survive_csv(bits in prop::collection::vec(any::<u64>(), 1..50)) {
        let values: Vec<f64> = bits.into_iter().map(f64::from_bits).collect();
        let mut text = Vec::new();
        table(&values).csv_to(&mut text).unwrap();
        let back = iwan_io::parse_table("a.csv".as_ref(), &text).unwrap();
        prop_assert!(same(&back.columns()[1], &values));
    }
}

/// Writes the three formats to the folder named by `IWAN_TABLE_CHECK`, for a look by other programs.
#[test]
#[ignore = "for a check by hand with pyarrow and NumPy"]
fn files_for_other_programs() {
    let Some(folder) = std::env::var_os("IWAN_TABLE_CHECK") else { return };
    let folder = std::path::PathBuf::from(folder);
    let values: Vec<f64> = (0..1_500_000).map(|i| f64::from(i).sqrt()).collect();
    let table = Table::new(vec![("t".into(), &values[..]), ("tip.velocity".into(), &values[..])]).unwrap();
    table.write_csv(folder.join("a.csv"), true).unwrap();
    table.write_npz(folder.join("a.npz"), true).unwrap();
    table.write_parquet(folder.join("a.parquet"), true).unwrap();
}
