//! Sound files: RIFF/WAVE with linear samples of 8, 16, 24 and 32 bits and with floating point numbers.
//!
//! Layout after "Multimedia Programming Interface and Data Specifications 1.0" (IBM and Microsoft, 1991) and the extensible format of
//! `mmreg.h`. Samples are relative to full scale, so that the largest sample a file can hold is 1; which voltage or acceleration full scale
//! stands for is known only to whoever recorded the file. The reader is our own because it is short, bounds memory by the file's size and
//! names what is wrong in the file.

use crate::assembly::{Axis, Channel, Raw};
use crate::bytes::{NumberType, Order, to_f64, u32_at};
use crate::error::ReadError;
use crate::file_bytes::FileBytes;
use crate::options::ReadOptions;
use crate::quantity::Quantity;
use crate::warning::Warning;
use iwan_machine::listed;

/// Format code of linear samples (PCM).
const LINEAR: u16 = 1;
/// Format code of floating-point samples.
const FLOAT: u16 = 3;
/// Format code that says that the true format code stands in the extension of the chunk `fmt `.
const EXTENSIBLE: u16 = 0xfffe;
/// Offset in bytes, from the start of the chunk `fmt `, of the format's identifier in the extension. Its first two bytes are the format
/// code.
const EXTENSION: usize = 24;
/// The unit of the samples.
const FULL_SCALE: &str = "full scale";

/// Whether bytes begin with the header of a WAV file.
pub(crate) fn is_wave(bytes: &[u8]) -> bool {
    bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WAVE")
}

/// How samples are stored in the file.
struct Layout {
    format: u16,
    channels: usize,
    rate: u32,
    /// Bits of one sample.
    bits: u16,
}

/// Channels of a sound file, at the sampling rate that the file states.
pub(crate) fn parse(source: FileBytes, options: &ReadOptions) -> Result<Raw, ReadError> {
    if !is_wave(source.bytes) {
        let found = format!("{} bytes that do not begin with RIFF and WAVE", source.bytes.len());
        return Err(source.malformed("header", found, "a WAV file"));
    }
    let (mut layout, mut warnings, mut at) = (None, Vec::new(), 12);
    while let (Some(name), Some(size)) =
        (source.bytes.get(at..at + 4), u32_at(source.bytes, at + 4, Order::Little))
    {
        let start = at + 8;
        let promised = usize::try_from(size).unwrap_or(usize::MAX);
        let end = start.saturating_add(promised).min(source.bytes.len());
        let body = &source.bytes[start..end];
        if name == b"fmt " {
            layout = Some(Layout::of(&source, body)?);
        } else if name == b"data" {
            let Some(layout) = &layout else {
                return Err(source.malformed(
                    format!("byte {at}"),
                    "samples before their format",
                    "a chunk 'fmt ' first",
                ));
            };
            // A program that was stopped while it recorded leaves 0 or the largest number as the size of the samples; they then go to the
            // end of the file.
            let open = size == 0 || size == u32::MAX;
            let body = if size == 0 { &source.bytes[start..] } else { body };
            let frame = layout.channels * usize::from(layout.bits / 8);
            if !open && promised > body.len() {
                let (promised, found) = (promised / frame, body.len() / frame);
                warnings.push(Warning::Count { place: "data".into(), promised: promised as u64, found });
            }
            return channels(&source, layout, body, options, warnings);
        }
        at = end + (end - start) % 2;
    }
    Err(source.cut_short("data", "bytes", 8, source.bytes.len().saturating_sub(at) as u64))
}

impl Layout {
    fn of(source: &FileBytes, body: &[u8]) -> Result<Self, ReadError> {
        let short = |at: usize| body.get(at..at + 2).map(|b| u16::from_le_bytes([b[0], b[1]]));
        let fields = (short(0), short(2), u32_at(body, 4, Order::Little), short(14));
        let (Some(mut format), Some(channels), Some(rate), Some(bits)) = fields else {
            return Err(source.cut_short("chunk 'fmt '", "bytes", 16, body.len() as u64));
        };
        if format == EXTENSIBLE {
            format = short(EXTENSION).unwrap_or(format);
        }
        let bad = |found: String, expected: &str| Err(source.malformed("chunk 'fmt '", found, expected));
        if channels == 0 || rate == 0 {
            return bad(format!("{channels} channels at {rate} Hz"), "at least one of both");
        }
        let known = match format {
            LINEAR => matches!(bits, 8 | 16 | 24 | 32),
            FLOAT => matches!(bits, 32 | 64),
            _ => {
                let remedy = "save it as linear samples (PCM) or floating point numbers";
                return Err(source.unsupported(
                    "chunk 'fmt '",
                    format!("samples of format {format}"),
                    remedy,
                ));
            }
        };
        if !known {
            return bad(format!("{bits} bits a sample"), "8, 16, 24 or 32, or 32 or 64 of floating point");
        }
        Ok(Self { format, channels: channels.into(), rate, bits })
    }

    /// All samples as parts of full scale, interleaved: one of each channel in turn.
    fn samples(&self, body: &[u8]) -> Vec<f64> {
        let little = |kind, scale: f64| -> Vec<f64> {
            to_f64(body, kind, Order::Little).into_iter().map(|v| v * scale).collect()
        };
        match (self.format, self.bits) {
            // Samples of eight bits are unsigned; silence is 128.
            (LINEAR, 8) => body.iter().map(|b| (f64::from(*b) - 128.0) / 128.0).collect(),
            (LINEAR, 16) => little(NumberType::I16, 1.0 / 32_768.0),
            (LINEAR, 24) => {
                let whole = |b: &[u8]| f64::from(i32::from_le_bytes([0, b[0], b[1], b[2]]) >> 8);
                body.chunks_exact(3).map(|b| whole(b) / 8_388_608.0).collect()
            }
            (LINEAR, _) => little(NumberType::I32, 1.0 / 2_147_483_648.0),
            (_, 32) => little(NumberType::F32, 1.0),
            _ => little(NumberType::F64, 1.0),
        }
    }
}

fn channels(
    source: &FileBytes,
    layout: &Layout,
    body: &[u8],
    options: &ReadOptions,
    warnings: Vec<Warning>,
) -> Result<Raw, ReadError> {
    let frame = layout.channels * usize::from(layout.bits / 8);
    let frames = body.len() / frame;
    if frames < 2 {
        return Err(source.cut_short("data", "samples", 2, frames as u64));
    }
    let samples = layout.samples(&body[..frames * frame]);
    let all: Vec<String> = (1..=layout.channels).map(|k| format!("channel {k}")).collect();
    let chosen = !options.channels.is_empty();
    let wanted = if chosen { &options.channels } else { &all };
    let channel = |name: &String| {
        let Some(k) = all.iter().position(|n| n == name) else {
            let (file, names) = (source.file.into(), listed(all.iter().map(String::as_str)));
            return Err(ReadError::UnknownName { file, role: "channel", name: name.clone(), names });
        };
        let values = samples.iter().skip(k).step_by(layout.channels).copied().collect();
        Ok(Channel { name: name.clone(), unit: FULL_SCALE.into(), quantity: Quantity::Unknown, values })
    };
    let channels = wanted.iter().map(channel).collect::<Result<_, _>>()?;
    let axis = Axis::Even { start: 0.0, step: 1.0 / f64::from(layout.rate) };
    Ok(Raw { axis, channels, chosen, warnings })
}
