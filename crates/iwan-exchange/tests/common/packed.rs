//! The matrix of the tests in files that are packed: MATLAB 7.3 and netCDF.

use super::{ORDER, all, labels};
use hdf5_pure::{AttrValue, FileBuilder};
use iwan_exchange::Component;

/// A MATLAB 7.3 file with the matrix as the variable K, sparse or full; `starts` of its columns.
pub fn mat_7_3(sparse: bool, starts: Option<Vec<u64>>) -> Vec<u8> {
    let mut file = FileBuilder::new();
    file.with_userblock(512);
    let mut head = format!("{:124}", "MATLAB 7.3 MAT-file, Platform: GLNXA64").into_bytes();
    head.extend(b"\x00\x02IM");
    file.with_userblock_content(&head);
    if sparse {
        let found = (0..=ORDER as u32).map(|k| all().iter().filter(|e| e.1 < k).count() as u64).collect();
        let mut group = file.create_group("K");
        group.set_attr("MATLAB_sparse", AttrValue::U64(ORDER as u64));
        group.set_attr("MATLAB_class", AttrValue::AsciiString("double".into()));
        let rows: Vec<u64> = all().iter().map(|e| u64::from(e.0)).collect();
        let values: Vec<f64> = all().iter().map(|e| e.2).collect();
        group.create_dataset("data").with_f64_data(&values).with_shape(&[values.len() as u64]);
        group.create_dataset("ir").with_u64_data(&rows).with_shape(&[rows.len() as u64]);
        let starts: Vec<u64> = starts.unwrap_or(found);
        group.create_dataset("jc").with_u64_data(&starts).with_shape(&[starts.len() as u64]);
        file.add_group(group.finish());
    } else {
        let mut data = vec![0.0; ORDER * ORDER];
        for (i, j, v) in all() {
            data[j as usize * ORDER + i as usize] = v;
        }
        let set = file.create_dataset("K").with_f64_data(&data).with_shape(&[ORDER as u64, ORDER as u64]);
        set.set_attr("MATLAB_class", AttrValue::AsciiString("double".into()));
    }
    file.finish().unwrap()
}

/// A netCDF classic file of version 1, 2 or 5 with the matrix as `Kr`, its rows in `cbmap`, an attribute and a variable of records.
pub fn netcdf(version: u8) -> Vec<u8> {
    let (wide, far) = (version == 5, version >= 2);
    let count = |n: u64| if wide { n.to_be_bytes().to_vec() } else { (n as u32).to_be_bytes().to_vec() };
    let offset =
        |n: usize| if far { (n as u64).to_be_bytes().to_vec() } else { (n as u32).to_be_bytes().to_vec() };
    let name = |text: &str| {
        let mut out = count(text.len() as u64);
        out.extend(text.bytes());
        out.resize(out.len().div_ceil(4) * 4, 0);
        out
    };
    let tag = |n: u32, entries: u64| [n.to_be_bytes().to_vec(), count(entries)].concat();
    let mut matrix = vec![0.0; ORDER * ORDER];
    for (i, j, v) in all() {
        matrix[i as usize * ORDER + j as usize] = v;
    }
    let matrix: Vec<u8> = matrix.iter().flat_map(|v: &f64| v.to_be_bytes()).collect();
    let pair = |label: &iwan_exchange::Label| match label.component {
        Component::Scalar => [0, 0],
        component => [label.node as i32, i32::from(component.number())],
    };
    let map: Vec<u8> = labels().iter().flat_map(pair).flat_map(i32::to_be_bytes).collect();
    let build = |begin: [usize; 2]| {
        let mut out = vec![b'C', b'D', b'F', version];
        out.extend(count(0));
        out.extend(tag(10, 3));
        for (word, size) in [("NumDof", ORDER as u64), ("two", 2), ("time_step", 0)] {
            out.extend([name(word), count(size)].concat());
        }
        out.extend(tag(12, 1));
        out.extend([name("title"), 2_u32.to_be_bytes().to_vec(), count(3), b"abc\0".to_vec()].concat());
        out.extend(tag(11, 3));
        let variables = [
            ("time", vec![2_u64], 6_u32, 0),
            ("Kr", vec![0, 0], 6, begin[0]),
            ("cbmap", vec![0, 1], 4, begin[1]),
        ];
        for (word, dimensions, kind, at) in variables {
            out.extend([name(word), count(dimensions.len() as u64)].concat());
            for d in &dimensions {
                out.extend(count(*d));
            }
            out.extend([tag(0, 0), kind.to_be_bytes().to_vec(), count(0), offset(at)].concat());
        }
        out
    };
    let head = build([0, 0]).len();
    [build([head, head + matrix.len()]), matrix, map].concat()
}
