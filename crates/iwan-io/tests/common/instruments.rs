//! Small valid files of sound recorders, LabVIEW and MATLAB 7.3.

use super::{element, mat_array, mat_file, number, times, wave, word};
use hdf5_pure::{AttrValue, FileBuilder};
use std::fmt::Write;

/// A sound file of one channel: `format` 1 (linear) or 3 (floating point), samples as bytes.
pub fn wav(format: u16, bits: u16, channels: u16, rate: u32, data: &[u8]) -> Vec<u8> {
    let frame = channels * (bits / 8);
    let mut out = b"RIFF".to_vec();
    out.extend((36 + u32::try_from(data.len()).unwrap()).to_le_bytes());
    out.extend(b"WAVEfmt ");
    out.extend(16_u32.to_le_bytes());
    for two in [format, channels] {
        out.extend(two.to_le_bytes());
    }
    out.extend(rate.to_le_bytes());
    out.extend((rate * u32::from(frame)).to_le_bytes());
    for two in [frame, bits] {
        out.extend(two.to_le_bytes());
    }
    out.extend(b"data");
    out.extend(u32::try_from(data.len()).unwrap().to_le_bytes());
    out.extend(data);
    out
}

/// `n` samples of a wave at 128 Hz, 16 bits.
#[allow(clippy::cast_possible_truncation)] // rounding to 16 bits is meant
pub fn wav_wave(n: usize) -> Vec<u8> {
    let data: Vec<u8> = wave(n).iter().flat_map(|v| ((v * 32_768.0) as i16).to_le_bytes()).collect();
    wav(1, 16, 1, 128, &data)
}

/// A file of LabVIEW with two segments of two channels that follow each other, one column of X.
pub fn lvm(n: usize) -> Vec<u8> {
    let header = "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\nMulti_Headings\tYes\nX_Columns\tOne\nTime_Pref\tRelative\n***End_of_Header***\t\n\t\n";
    let mut out = header.to_string();
    let half = n / 2;
    for (segment, part) in wave(n).chunks(half).enumerate() {
        let start = (segment * half) as f64 / 128.0;
        write!(
            out,
            "Channels\t2\t\t\nSamples\t{0}\t{0}\t\nDate\t2026/01/01\t2026/01/01\t\nX_Dimension\tTime\tTime\t\nX0\t{start:E}\t{start:E}\t\nDelta_X\t7.8125E-3\t7.8125E-3\t\nY_Unit_Label\tm/s^2\tm/s^2\t\n***End_of_Header***\t\t\t\nX_Value\tacc\tback\tComment\n",
            part.len()
        )
        .unwrap();
        for (i, v) in part.iter().enumerate() {
            writeln!(out, "{}\t{v}\t{}", start + i as f64 / 128.0, -v).unwrap();
        }
        out.push('\n');
    }
    out.into_bytes()
}

/// A struct `d` with `time` and `acc` in HDF5 behind MATLAB's own header, one of them compressed in chunks.
pub fn mat_7_3(n: usize) -> Vec<u8> {
    let mut file = FileBuilder::new();
    let mut group = file.create_group("d");
    let class = || AttrValue::AsciiString("double".into());
    let shape = [1, n as u64];
    group
        .create_dataset("time")
        .with_f64_data(&times(n))
        .with_shape(&shape)
        .set_attr("MATLAB_class", class());
    let acc = group.create_dataset("acc").with_f64_data(&wave(n)).with_shape(&shape);
    acc.with_chunks(&[1, 10]).with_deflate(3).set_attr("MATLAB_class", class());
    file.add_group(group.finish());
    behind_matlabs_header(file)
}

/// The file with the 512 bytes before it by which MATLAB knows its own.
pub fn behind_matlabs_header(mut file: FileBuilder) -> Vec<u8> {
    let mut head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".to_vec();
    head.resize(124, b' ');
    head.extend(b"\x00\x02IM");
    head.resize(512, 0);
    file.with_userblock(512).with_userblock_content(&head);
    file.finish().unwrap()
}

/// A struct `d` with a number `x` and a cell array of so many cells, each of which is the struct itself.
pub fn mat_7_3_circle(cells: usize) -> Vec<u8> {
    let mut file = FileBuilder::new();
    let mut group = file.create_group("d");
    group.create_dataset("x").with_f64_data(&[1.0]).with_shape(&[1, 1]);
    let set =
        group.create_dataset("c").with_path_references(&vec!["d"; cells]).with_shape(&[1, cells as u64]);
    set.set_attr("MATLAB_class", AttrValue::AsciiString("cell".into()));
    file.add_group(group.finish());
    file.finish().unwrap()
}

/// A cell array `x` of two cells, and a time `t`.
pub fn mat_cells(n: usize) -> Vec<u8> {
    let bytes = |v: &[f64]| -> Vec<u8> { v.iter().flat_map(|v| number(*v, false, true)).collect() };
    let dims = [1_u32, 2].map(|d| word(d, false)).concat();
    let mut cells =
        [element(6, &[word(1, false), word(0, false)].concat(), false), element(5, &dims, false)].concat();
    cells.extend(element(1, b"x", false));
    let back: Vec<f64> = wave(n).iter().map(|v| -v).collect();
    for values in [wave(n), back] {
        cells.extend(mat_array("", n, 1, 9, &bytes(&values), false));
    }
    let time = mat_array("t", 1, n, 9, &bytes(&times(n)), false);
    mat_file(&[time, element(14, &cells, false)], false, false)
}
