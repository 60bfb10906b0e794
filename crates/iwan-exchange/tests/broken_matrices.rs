//! Broken files of matrices are refused with the place and what is expected there; none is read silently.
#![allow(clippy::unwrap_used)]

use crate::common::packed::{mat_7_3, netcdf};
use crate::common::{
    Layout, abaqus_substructure, dmig, mat, matrix_market, npz, op4_binary, op4_text, sierra,
};
use iwan_exchange::{read_bytes, read_rows};
use std::path::Path;

fn refused(name: &str, bytes: &[u8], expected: &str) {
    let error = match read_bytes(Path::new(name), bytes, None) {
        Ok(read) => panic!("{name} with {expected:?} was read: {read:?}"),
        Err(error) => error.to_string(),
    };
    assert!(error.starts_with(&format!("{name}: ")) && error.contains(expected), "{error}\n{expected}");
}

/// `text` with the first `old` replaced.
fn with(text: &str, old: &str, new: &str) -> Vec<u8> {
    assert!(text.contains(old), "{old} is not in\n{text}");
    text.replacen(old, new, 1).into_bytes()
}

#[test]
fn matrix_market_files() {
    let text = matrix_market(false);
    let cases = [
        ("real", "complex", "line 1: the word complex of the first line cannot be read; write real numbers"),
        ("symmetric", "hermitian", "line 1: the word hermitian"),
        ("coordinate", "list", "line 1: the word list"),
        ("matrix coordinate", "matrix", "line 1: found '%%MatrixMarket matrix real symmetric'"),
        ("7 7 13", "7 7 14", "the end of the file: found 13 entries, expected 14 entries"),
        ("7 7 13", "7 8 13", "line 3: found '7 8 13', expected as many columns as rows"),
        ("7 7 13", "7 13", "line 3: found '7 13', expected rows, columns and entries"),
        ("7 7 13", "6 6 13", "expected the row: a whole number from 1 to 6"),
        ("1 1 1.25e1", "0 1 1.25e1", "line 4: found '0', expected the row: a whole number from 1 to 7"),
        ("1 1 1.25e1", "1 1 nan", "line 4: found 'nan', expected the value: a finite number"),
        ("1 1 1.25e1", "1 1", "line 4: found '1 1', expected row, column and value"),
    ];
    for (old, new, expected) in cases {
        refused("k.mtx", &with(&text, old, new), expected);
    }
    refused("k.mtx", b"%%MatrixMarket matrix array real general\n2 2\n1\n2\n3\n", "the values of column 2");
    refused(
        "k.mtx",
        b"%%MatrixMarket matrix array real general\n1 1\n1\n2\n",
        "line 4: found '2', expected no more values",
    );
}

#[test]
fn abaqus_calculix_and_sierra_files() {
    refused("k.mtx", b"3,1, 3,1, 5.0\n3,1, 3,2\n", "line 2: found '3,1, 3,2', expected row node");
    refused(
        "k.mtx",
        b"3,1, 3,9, 5.0\n",
        "line 1: found '9', expected the column component: a whole number from 0 to 6",
    );
    refused(
        "k.mtx",
        b"3,1, -4,1, 5.0\n",
        "line 1: the internal node -4 cannot be read; model without Lagrange",
    );
    refused("k.mtx", b"3,1, 3,1, inf\n", "line 1: found 'inf', expected the value: a finite number");
    refused("k.mtx", b"3 1\n", "line 1: found '3 1'");
    refused("k.mtx", b"  \n \n", "the whole file: found nothing, expected a matrix");
    let element = abaqus_substructure();
    refused("z.mtx", &with(&element, "NODES=2", "NODES=3"), "*MATRIX, TYPE=STIFFNESS, expected 9 rows");
    refused(
        "z.mtx",
        &with(&element, "12.5", "x"),
        "line 7: found 'x', expected an entry of the lower triangle",
    );
    refused("z.mtx", &with(&element, "NODES=2", "NODES=many"), "expected NODES: a whole number");
    refused(
        "z.mtx",
        &with(&element, "2, 1, 2, 6", "3, 1, 2, 6"),
        "line 5: found '3', expected a position: a whole number from 1 to 2",
    );
    // Its rows were once taken for those of the first element's matrix.
    refused(
        "z.mtx",
        &[element.as_bytes(), b"*USER ELEMENT, NODES=1\n1, 2\n"].concat(),
        "a second *USER ELEMENT cannot be read; give each a file of its own",
    );
    refused("k.sti", b"1 1 2.0\n1 x 2.0\n", "line 2: found 'x', expected the column");
    let text = sierra();
    refused("Kaa.m", &with(&text, "NumRows = 7;", ""), "expected NumRows");
    refused(
        "Kaa.m",
        &with(&text, "NumRows = 7;", "NumRows = 6;"),
        "line 14: found '7', expected the row: a whole number from 1 to 6",
    );
    refused("Kaa.m", &with(&text, "];", ""), "row, column and value;");
    refused("Kaa.m", &text.as_bytes()[..80], "");
}

/// Entries before NumRows were once not held to it, and those of a second matrix joined the first.
#[test]
fn sierra_files_hold_one_matrix_of_the_order_they_say() {
    let text = sierra();
    let late = with(&text.replacen("NumRows = 7;\n", "", 1), "];", "];\nNumRows = 6;");
    refused(
        "Kaa.m",
        &late,
        "the entries: found an entry in row 7 and column 5, expected numbers from 1 to NumRows = 6",
    );
    let twice = [text.as_bytes(), text.as_bytes()].concat();
    refused(
        "Kaa.m",
        &twice,
        "a second matrix from 'NumRows = 7;' on cannot be read; give each a file of its own",
    );
    let blocks = with(&text, "];", "];\nb=[\n1 1 1;\n];");
    refused("Kaa.m", &blocks, "a second matrix from 'b=[' on cannot be read");
}

#[test]
fn op4_files() {
    let text = op4_text(Layout::Dense, false);
    let cases = [
        (
            "       7       7       6       2KAA",
            "       7       7       6       5KAA",
            "line 1, matrix KAA: found 5, expected the type",
        ),
        (
            "       7       7       6",
            "     x 7       7       6",
            "line 1: found 'x 7', expected the number of columns in columns 1 to 8",
        ),
        ("1P,3E24.16", "3F24", "line 1: found '3F24', expected a format such as 1P,3E23.16"),
        ("1.2500000000000000E+01", "1.25000000000000xxE+01", "line 3: found"),
        (
            "       1       1       5",
            "       1       4       5",
            "line 2, matrix KAA: found 5 values from row 4 on in column 1, expected a string within 7 rows",
        ),
        (
            "       1       1       5",
            "       1       1      -5",
            "line 2: found '       1       1      -5', expected a column",
        ),
    ];
    for (old, new, expected) in cases {
        refused("k.op4", &with(&text, old, new), expected);
    }
    refused("k.op4", &text.as_bytes()[..200], "");
    let packed = op4_text(Layout::Packed, false);
    refused("k.op4", &with(&packed, "  327681", "  983041"), "a string of at most the");
    let bigmat = op4_text(Layout::BigMat, false);
    refused(
        "k.op4",
        &with(&bigmat, "       5       1", "       5       7"),
        "2 values from row 7 on in column 1",
    );
    let binary = op4_binary(Layout::Dense, false, false, 4);
    refused("k.op4", &binary[..80], "byte 33: found a record of 52 bytes without its end");
    let mut changed = binary.clone();
    changed[0] = 25;
    refused(
        "k.op4",
        &changed,
        "byte 1: found a record of 25 bytes, expected a first record of 24 or 48 bytes",
    );
    changed = binary.clone();
    changed[48..56].copy_from_slice(&f64::NAN.to_le_bytes());
    refused(
        "k.op4",
        &changed,
        "byte 33, matrix KAA: found NaN in row 1 of column 1, expected finite numbers",
    );
    changed = binary.clone();
    changed[40] = 6;
    refused("k.op4", &changed, "5 values from row 6 on in column 1");
    // The other byte order in the middle of a file.
    let mut swapped = binary[..32].to_vec();
    swapped.extend(&op4_binary(Layout::Dense, false, true, 4)[32..]);
    refused("k.op4", &swapped, "byte 33: found a record of");
}

/// A hundred names of one array were read as a hundred matrices: a small file could fill any memory.
#[test]
fn netcdf_variables_that_lie_on_each_other_are_refused() {
    let word = |n: u32| n.to_be_bytes();
    let named = [word(1), *b"K\0\0\0"].concat();
    let mut bytes = [*b"CDF\x01", word(0), word(10), word(1)].concat();
    bytes.extend([&named[..], &word(8)].concat());
    bytes.extend([word(0), word(0), word(11), word(100)].concat());
    let begin = u32::try_from(bytes.len() + 100 * 44).unwrap();
    for _ in 0..100 {
        bytes.extend(&named);
        bytes.extend([2, 0, 0, 0, 0, 6, 512, begin].map(word).concat());
    }
    bytes.resize(bytes.len() + 512 + 400, 0);
    refused("k.nc", &bytes, "the header: found variables of 51200 bytes in a file of");
}

/// Rows and lengths of strings near the ends of 64 bits overflowed.
#[test]
fn op4_words_of_eight_bytes_may_hold_anything() {
    let mut dense = op4_binary(Layout::Dense, false, false, 8);
    dense[68..76].copy_from_slice(&i64::MAX.to_le_bytes());
    refused(
        "k.op4",
        &dense,
        "5 values from row 9223372036854775807 on in column 1, expected a string within 7",
    );
    let mut bigmat = op4_binary(Layout::BigMat, false, false, 8);
    bigmat[84..92].copy_from_slice(&i64::MIN.to_le_bytes());
    refused("k.op4", &bigmat, "a string of -9223372036854775808 words in");
}

#[test]
fn dmig_files() {
    let text = dmig("large");
    refused(
        "k.pch",
        &with(&text, "       6       2", "       5       2"),
        "line 2: found form 5 of 'KAAX', expected 1 (square)",
    );
    refused("k.pch", &with(&text, "       6       2", "       6       9"), "line 2: found type 9");
    refused(
        "k.pch",
        &with(&text, "DMIG    KAAX           0", "DMIG    KAAX           3"),
        "line 2: found a column of 'KAAX' before its header",
    );
    refused(
        "k.pch",
        &with(&text, "1.250000000D+01", "1.2500x0000D+01"),
        "expected the value in column node 3 component 1, row node 3 component 1",
    );
    refused(
        "k.pch",
        &with(&text, "10               6", "10               7"),
        "found component 7 of point 10, expected a component from 0 to 6",
    );
    refused("k.pch", b"GRID,1,,0.,0.,0.\n", "the end of the file: found nothing more, expected entries DMIG");
}

#[test]
fn archives() {
    let bytes = npz("csr");
    refused("k.npz", &bytes[..bytes.len() - 30], "zip directory: found");
    refused("k.npz", &npz("dia"), "array 'format': a matrix of the kind dia cannot be read; save it with");
    refused("k.npy", b"\x93NUMPY\x01\x00\x10\x00{'descr': '<f8'}", "key 'fortran_order': found");
    refused("k.mat", b"MATLAB 7.3 MAT-file", "header: found 19 bytes without the header of level 5");
    let bytes = mat(true, false, false);
    refused("k.mat", &bytes[..bytes.len() - 20], "data element at byte 128: found");
    let mut changed = bytes.clone();
    let at = bytes.len() - 8;
    changed[at..].copy_from_slice(&f64::INFINITY.to_le_bytes());
    refused("k.mat", &changed, "variable 'K': found row 7 with value inf in column 7");
    refused(
        "k.mat",
        &[b'x'; 200],
        "header: found 200 bytes without the header of level 5, expected 128 bytes",
    );
    refused("k.dat2", b"1 1 1", "unknown format (extension 'dat2'");
}

#[test]
fn hdf_files() {
    let bytes = mat_7_3(true, None);
    refused("k.mat", &bytes[..bytes.len() / 2], "");
    refused(
        "k.mat",
        &bytes[..512],
        "header: a MATLAB v7.3 file without the HDF5 part behind its first 512 bytes",
    );
    refused(
        "k.mat",
        &mat_7_3(true, Some(vec![0, 2, 1])),
        "variable 'K': found start 1 of column 3, expected 2 to",
    );
    refused(
        "k.mat",
        &mat_7_3(true, Some(vec![0, 900])),
        "variable 'K': found start 900 of column 2, expected 0 to",
    );
    refused("k.mat", &mat_7_3(true, Some(vec![])), "variable 'K': found 0 column starts, expected 1");
}

#[test]
fn netcdf_files() {
    let bytes = netcdf(2);
    let at = |word: &str| bytes.windows(word.len()).position(|w| w == word.as_bytes()).unwrap();
    refused("k.nc", &bytes[..60], "the header: found a header that needs");
    refused("k.nc", &bytes[..bytes.len() - 1], "variable 'cbmap': found");
    let mut changed = bytes.clone();
    // The second dimension of Kr: behind its name of two letters, padded, and the count of dimensions.
    let dimension = at("Kr") + 4 + 4 + 7;
    changed[dimension] = 9;
    refused("k.nc", &changed, "variable 'Kr': found dimension 9, expected one of 3 dimensions");
    changed = bytes.clone();
    let last = bytes.len();
    changed[last - 1] = 9;
    refused("k.nc", &changed, "variable 'cbmap', row 7: found");
    changed = bytes.clone();
    let values = bytes.len() - 7 * 8 - 49 * 8;
    changed[values..values + 8].copy_from_slice(&f64::NAN.to_be_bytes());
    refused("k.nc", &changed, "variable 'Kr': found NaN in row 1, column 1, expected finite numbers");
    changed = bytes.clone();
    changed[11] = 7;
    refused("k.nc", &changed, "the header: found tag 7");
    let other = read_bytes("k.nc".as_ref(), b"\x89HDF\r\n\x1a\n", Some(iwan_exchange::Format::Netcdf));
    assert!(other.unwrap_err().to_string().contains("expected CDF and version 1, 2 or 5"));
}

#[test]
fn row_maps() {
    let folder = std::env::temp_dir().join(format!("iwan-broken-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let refused = |name: &str, text: &str, expected: &str| {
        let path = folder.join(name);
        std::fs::write(&path, text).unwrap();
        let error = read_rows(&path, None).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}\n{expected}");
    };
    refused("a.csv", "1,1\n1,7\n", "line 2: found '7', expected the component (or x, y, z, rx, ry, rz)");
    refused("a.csv", "1,1\n1\n", "line 2: found '1', expected node, component");
    refused("a.dof", "1.1\n13\n", "line 2: found '13', expected node.component");
    refused(
        "ASetMap.m",
        "x(1) = 1;\nx(2) = 1;\n",
        "x(2): found row 1 for node 1 component 2 and for node 1 component 1",
    );
    refused("ASetMap.m", "x(1) = 1;\nx(2) = 3;\n", "beyond all entries of the map");
    refused("ASetMap.m", "x(1) = 1;\nx(7) = 2;\n", "x(7), component 7 of a node cannot be read");
    refused("ASetMap.m", "x(3) = 1;\nx(1) = 2;\n", "line 2: found '1', expected the index, ascending");
    std::fs::remove_dir_all(&folder).unwrap();
}
