//! Windows that an analyser applied to functions: dataset 1858, the qualifiers of a dataset 58.
//!
//! Layout after the "Universal Dataset Number 1858" page of the Structural Dynamics Research Laboratory, University of Cincinnati. That
//! page does not say whether qualifiers stand before or behind their function. In a file that begins with qualifiers they are taken to
//! stand before it, in any other file behind it.

use super::header::Header;
use super::sections::{self, Section, line_at};
use crate::error::ReadError;
use crate::file_bytes::{FileBytes, decode};
use crate::quantity::Quantity;
use crate::warning::Warning;

/// Bytes of a line that are decoded: a line of a universal file has 80 columns.
const LINE: usize = 80;

/// The window applied to one function.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Window {
    /// Record 2, field 2: 1 and 2 Hanning, 3 flat top, 4 exponential, 5 impact, 6 impact and exponential.
    kind: i64,
    /// Record 4, field 5: damping factor of an exponential window, as the file states it.
    damping: f64,
}

impl Window {
    fn parse(body: &[u8]) -> Option<Self> {
        let (mut lines, mut at) = (Vec::new(), 0);
        while let Some((line, next)) = line_at(body, at).filter(|_| lines.len() < 4) {
            lines.push(decode(&line[..line.len().min(LINE)]));
            at = next;
        }
        let kind = lines.get(1)?.split_whitespace().nth(1)?.parse().ok()?;
        let damping =
            lines.get(3).and_then(|l| l.split_whitespace().nth(4)?.replace(['D', 'd'], "e").parse().ok());
        Some(Self { kind, damping: damping.unwrap_or(0.0) }).filter(|w| (1..=6).contains(&w.kind))
    }

    fn name(self) -> String {
        match self.kind {
            1 | 2 => "a Hanning window".into(),
            3 => "a flat-top window".into(),
            4 => format!("an exponential window (damping factor {} in its header)", self.damping),
            5 => "an impact window".into(),
            _ => format!("an impact and exponential window (damping factor {} in its header)", self.damping),
        }
    }

    /// Why a time history under the window cannot be used; none where it can be used.
    pub(super) fn refusal(window: Option<Self>, header: &Header) -> Option<String> {
        let window = window.filter(|w| header.is_over_time() && w.kind <= 3)?;
        Some(format!(
            "{} lies over it by its dataset 1858, and a decay under it is the window's",
            window.name()
        ))
    }

    /// The warning that a function under the window needs; none where it needs none.
    pub(super) fn remark(window: Option<Self>, header: &Header, name: &str) -> Option<Warning> {
        let window =
            window.filter(|w| w.kind == 4 || w.kind == 6 || (w.kind == 5 && header.is_over_time()))?;
        let advice = match window.kind {
            5 if header.quantity() == Quantity::Force => return None,
            5 => "only what the window left is there: export the motions without it",
            _ if header.is_over_time() => {
                "damping that is found is the structure's and the window's together: export the time history without it"
            }
            _ => "iwan modal takes its damping off again where --exponential gives its decay in 1/s",
        };
        Some(Warning::Windowed { name: name.into(), window: window.name(), advice })
    }
}

/// Advice for a time history that a window has made useless.
pub(super) const REMEDY: &str = "export the time histories without a window; where their samples are raw all the same, set the window type in dataset 1858 to 0";

/// Finds all datasets 58 and 58b, each with the window applied to it.
pub(super) fn split<'a>(
    source: &FileBytes<'a>,
    warnings: &mut Vec<Warning>,
) -> Result<Vec<(Section<'a>, Option<Window>)>, ReadError> {
    let mut qualifiers = Vec::new();
    let sections = sections::split(source, warnings, &mut |other| {
        if other.number == "1858" {
            qualifiers.push((other.offset, Window::parse(other.body)));
        }
    })?;
    let offsets: Vec<usize> = sections.iter().map(|s| s.offset).collect();
    let before = qualifiers.first().zip(offsets.first()).is_some_and(|(q, s)| q.0 < *s);
    let window = |i: usize| {
        let (from, to) = if before {
            (i.checked_sub(1).map_or(0, |p| offsets[p]), offsets[i])
        } else {
            (offsets[i], offsets.get(i + 1).copied().unwrap_or(usize::MAX))
        };
        let first = qualifiers.partition_point(|(offset, _)| *offset < from);
        qualifiers[first..].iter().take_while(|(offset, _)| *offset < to).find_map(|(_, window)| *window)
    };
    let windows: Vec<Option<Window>> = (0..offsets.len()).map(window).collect();
    Ok(sections.into_iter().zip(windows).collect())
}
