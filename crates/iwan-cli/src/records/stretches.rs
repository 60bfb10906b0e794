//! Records that hold several hits: each hit becomes a record of its own.

use std::path::PathBuf;

use iwan_ident::signal::{Event, Hit, Overview, overview};
use iwan_machine::threads::in_parallel;

use super::args::{Hits, RecordArgs};
use super::reading::{Recording, read};
use crate::failure::Failure;

/// Files of fewer bytes than this altogether are read side by side. Larger ones are read one after the other, so that the memory for one is given back before the next is
/// read: as text a file takes several times its size.
const SIDE_BY_SIDE: u64 = 1 << 27;

/// Reads files as the options say; a record of several hits that are well apart becomes one recording per hit, in their order.
pub(crate) fn read_all(
    paths: &[PathBuf],
    args: &RecordArgs,
    threads: usize,
) -> Result<Vec<Recording>, Failure> {
    let size: u64 = paths.iter().filter_map(|path| path.metadata().ok()).map(|file| file.len()).sum();
    let at_once = if size < SIDE_BY_SIDE { threads } else { 1 };
    let read: Vec<Recording> =
        in_parallel(paths, at_once, &|path| read(path, args)).into_iter().collect::<Result<_, _>>()?;
    let seen = in_parallel(&read, threads, &|r| overview(r.record.samples(), r.record.dt()));
    let mut all = Vec::new();
    for (recording, seen) in read.into_iter().zip(&seen) {
        all.extend(stretches(recording, seen, args.hits)?);
    }
    Ok(all)
}

/// The wanted hits of a recording, with warnings about disturbances in it.
fn stretches(mut recording: Recording, seen: &Overview, wanted: Hits) -> Result<Vec<Recording>, Failure> {
    let record = &recording.record;
    let found = &seen.hits;
    let (name, start, release) = (recording.name.clone(), record.start(), seen.release());
    if release > 0 {
        let at = record.time(release);
        recording.warnings.push(format!(
            "{name}: before {at:.6} s the structure is pulled, held, handled or driven: the record begins there"
        ));
    }
    // Clipping is not reported here, because every fit checks for it itself.
    for event in seen.events.iter().filter(|event| !matches!(event, Event::Clipped { .. })) {
        let at = start + event.time();
        recording
            .warnings
            .push(format!("{name}: {event}, at {at:.6} s; cut there with --to {at:.4} or --from {at:.4}"));
    }
    let chosen: Vec<(usize, &Hit)> = match wanted {
        Hits::All => found.iter().enumerate().collect(),
        Hits::One(n) if n == 0 && found.len() < 2 => Vec::new(),
        Hits::One(n) => {
            if let Some(hit) = found.get(n) {
                vec![(n, hit)]
            } else {
                let message = format!("{name}: there is no hit {} ({} found)", n + 1, found.len());
                let remedy = match found.len() {
                    0 => "leave --hits out, and cut with --from and --to",
                    1 => "leave --hits out, or give first",
                    _ => "choose --hits all, first, or one of those",
                };
                return Err(Failure::input(message, remedy));
            }
        }
    };
    if found.len() < 2 {
        if release > 0 {
            let begin = record.time(release);
            recording.record = record.between(Some(begin), None).map_err(|e| Failure::said(&name, &e))?;
        }
        return Ok(vec![recording]);
    }
    let times: Vec<String> = found.iter().map(|hit| format!("{:.4}", start + hit.time)).collect();
    let used = match wanted {
        Hits::All => "each is used as a record of its own".into(),
        Hits::One(n) => format!("number {} is used", n + 1),
    };
    recording.warnings.push(format!(
        "{name}: {} hits, at {} s; {used} (--hits)",
        found.len(),
        times.join(", ")
    ));
    // Warnings about the whole file are given once, with its first hit.
    let mut cuts =
        chosen.into_iter().map(|(n, hit)| cut(&recording, n, hit)).collect::<Result<Vec<_>, _>>()?;
    if let Some(first) = cuts.first_mut() {
        (first.warnings, first.doubts) = (recording.warnings, recording.doubts);
    }
    Ok(cuts)
}

/// The recording of one hit.
fn cut(recording: &Recording, n: usize, hit: &Hit) -> Result<Recording, Failure> {
    let record = &recording.record;
    let ends = (record.time(hit.samples.start), record.time(hit.samples.end - 1));
    let name = format!("{}, hit {}", recording.name, n + 1);
    let cut = record.between(Some(ends.0), Some(ends.1)).map_err(|e| Failure::said(&name, &e))?;
    Ok(Recording {
        name,
        record: cut,
        quantity: recording.quantity,
        warnings: Vec::new(),
        doubts: Vec::new(),
        windowed: recording.windowed,
    })
}
