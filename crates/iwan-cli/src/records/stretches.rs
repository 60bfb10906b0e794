//! Several hits in one record: each a record of its own.

use std::path::PathBuf;

use iwan_ident::signal::{Event, Hit, events, hits};

use super::args::{Hits, RecordArgs};
use super::reading::{Recording, read};
use crate::failure::Failure;

/// Reads files by the user's word; a record of several hits that are well apart is as many records, one after the other.
pub(crate) fn read_all(paths: &[PathBuf], args: &RecordArgs) -> Result<Vec<Recording>, Failure> {
    let mut all = Vec::new();
    for path in paths {
        all.extend(stretches(read(path, args)?, args.hits)?);
    }
    Ok(all)
}

/// The hits of a recording that are wanted, and a word on what disturbs it.
fn stretches(mut recording: Recording, wanted: Hits) -> Result<Vec<Recording>, Failure> {
    let record = &recording.record;
    let loudest = record.samples().iter().max_by(|a, b| peak(a).total_cmp(&peak(b)));
    let Some(samples) = loudest else { return Ok(vec![recording]) };
    // A record too short to be looked at is refused where it is used.
    let found = hits(samples, record.dt()).unwrap_or_default();
    let from = found.first().filter(|hit| hit.lead_in).map_or(0, |hit| hit.samples.start);
    let disturbed = events(&samples[from..], record.dt()).unwrap_or_default();
    let (name, start) = (recording.name.clone(), record.start());
    if from > 0 {
        let at = record.time(from);
        recording.warnings.push(format!(
            "{name}: before {at:.6} s the structure is pulled, held, handled or driven: the record begins there"
        ));
    }
    let ringing = record.time(from);
    recording.warnings.extend(disturbed.iter().filter_map(|event| disturbance(&name, ringing, event)));
    for again in found.iter().flat_map(|hit| &hit.again) {
        let at = start + again;
        recording.warnings.push(format!("{name}: driven again at {at:.6} s, as by a double hit: behind it with --from {at:.4} the decay is free"));
    }
    let chosen: Vec<(usize, &Hit)> = match wanted {
        Hits::All => found.iter().enumerate().collect(),
        Hits::One(n) if n == 0 && found.len() < 2 => Vec::new(),
        Hits::One(n) => {
            if let Some(hit) = found.get(n) {
                vec![(n, hit)]
            } else {
                let message = format!("{name}: there is no hit {} ({} found)", n + 1, found.len());
                return Err(Failure::input(message, "choose --hits all, first, or one of those"));
            }
        }
    };
    if found.len() < 2 {
        if from > 0 {
            let end = record.time(samples.len() - 1);
            let cut = record.between(Some(ringing), Some(end)).map_err(|e| Failure::said(&name, &e))?;
            recording.record = cut;
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
    // What is said of the file is said once, with its first hit.
    let mut cuts =
        chosen.into_iter().map(|(n, hit)| cut(&recording, n, hit)).collect::<Result<Vec<_>, _>>()?;
    if let Some(first) = cuts.first_mut() {
        first.warnings = recording.warnings;
    }
    Ok(cuts)
}

/// What disturbs a record that begins at `start`, with what to do about it; none for what every fit looks after itself.
fn disturbance(name: &str, start: f64, event: &Event) -> Option<String> {
    let (what, at) = match *event {
        Event::Jump { time, size } => (format!("the zero line jumps by {size:.4}"), start + time),
        Event::Wild { time, size, count } => {
            let others = if count > 1 { format!(" ({count} such samples)") } else { String::new() };
            (format!("one sample stands {size:.4} off its neighbours{others}"), start + time)
        }
        Event::Lost { time, count } => {
            let others = if count > 1 { format!(" ({count} such places)") } else { String::new() };
            (format!("the vibration breaks off, as where samples are lost{others}"), start + time)
        }
        _ => return None,
    };
    Some(format!("{name}: {what} at {at:.6} s; cut there with --to {at:.4} or --from {at:.4}"))
}

/// The stretch of a hit.
fn cut(recording: &Recording, n: usize, hit: &Hit) -> Result<Recording, Failure> {
    let record = &recording.record;
    let ends = (record.time(hit.samples.start), record.time(hit.samples.end - 1));
    let name = format!("{}, hit {}", recording.name, n + 1);
    let cut = record.between(Some(ends.0), Some(ends.1)).map_err(|e| Failure::said(&name, &e))?;
    Ok(Recording { name, record: cut, quantity: recording.quantity, warnings: Vec::new() })
}

/// Largest magnitude.
fn peak(samples: &[f64]) -> f64 {
    samples.iter().map(|x| x.abs()).fold(0.0, f64::max)
}
