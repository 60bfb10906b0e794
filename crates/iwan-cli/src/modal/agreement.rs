//! Checks whether hits and levels are consistent: swapped or reversed channels, points that a level lacks.

use iwan_modal::each_of;
use iwan_modal::measure::{Channel, Freedom, Hit};
use iwan_modal::responses::disagreements;

use super::analysis::Level;
use super::hits::Test;

/// Doubts about the channels, level by level, as sentences.
pub(super) fn doubts(test: &Test, levels: &[Level]) -> Vec<String> {
    let of_levels = each_of(levels, |level| [of_level(test, level), lacking(test, level)].concat());
    of_levels.into_iter().flatten().chain(missing(test, levels)).chain(same_samples(test)).collect()
}

/// Names points that are missing in a hit although more than half of the hits of its level at the same place have them: the average at such a point
/// is over fewer hits. Where sensors are moved between hits, few hits have any one point, and nothing is said.
fn lacking(test: &Test, level: &Level) -> Vec<String> {
    let mut said = Vec::new();
    for f in &level.responses.functions {
        let has = |hit: &&Hit| hit.responses.iter().any(|c| c.freedom == f.response);
        let (with, without): (Vec<&Hit>, Vec<&Hit>) =
            used(test, level).filter(|hit| hit.force.freedom == f.force).partition(has);
        if with.len() > without.len() {
            said.extend(without.iter().map(|hit| {
                format!(
                    "{}: point {} is missing, which {} has; it is averaged over {} hits",
                    hit.name,
                    f.response,
                    with[0].name,
                    with.len()
                )
            }));
        }
    }
    said
}

/// Names hits that hold the same samples: copies would look like two hits that agree perfectly.
fn same_samples(test: &Test) -> Vec<String> {
    let hits: Vec<&Hit> = test.hits.iter().filter(|h| !h.left_out).map(|h| &h.hit).collect();
    let same = |a: &Hit, b: &Hit| {
        let alike = |(a, b): (&Channel, &Channel)| a.samples == b.samples;
        a.responses.len() == b.responses.len()
            && alike((&a.force, &b.force))
            && a.responses.iter().zip(&b.responses).all(alike)
    };
    let twin = |(n, b): (usize, &&Hit)| {
        let a = hits[..n].iter().find(|a| same(a, b))?;
        Some(format!(
            "{} holds the samples of {} again: standard deviations are too small; leave it out with --leave-out \"{}\"",
            b.name, a.name, b.name
        ))
    };
    hits.iter().enumerate().filter_map(twin).collect()
}

fn used<'a>(test: &'a Test, level: &'a Level) -> impl Iterator<Item = &'a Hit> {
    test.hits.iter().map(|h| &h.hit).filter(|hit| level.hits.contains(&hit.name))
}

fn of_level(test: &Test, level: &Level) -> Vec<String> {
    let hits: Vec<&Hit> = used(test, level).collect();
    // Hits that cannot be compared have been refused with a message before; an error adds nothing here.
    let found = if hits.is_empty() { Ok(Vec::new()) } else { disagreements(&hits) };
    found.unwrap_or_default().iter().map(ToString::to_string).collect()
}

/// Names points that were measured at one level and not at another: comparisons between levels leave them out.
fn missing(test: &Test, levels: &[Level]) -> Vec<String> {
    let pairs = |level: &Level| -> Vec<(Freedom, Freedom)> {
        level.responses.functions.iter().map(|f| (f.response.clone(), f.force.clone())).collect()
    };
    let all: Vec<Vec<(Freedom, Freedom)>> = levels.iter().map(pairs).collect();
    let mut said = Vec::new();
    for (level, own) in levels.iter().zip(&all) {
        for (n, (response, force)) in all.iter().flatten().enumerate() {
            let pair = (response.clone(), force.clone());
            let known = own.contains(&pair) || all.iter().flatten().take(n).any(|p| *p == pair);
            if known {
                continue;
            }
            let where_it_is = test.hits.iter().find(|h| {
                h.hit.force.freedom == *force && h.hit.responses.iter().any(|c| c.freedom == *response)
            });
            let file = where_it_is.map_or("another level", |h| h.hit.name.as_str());
            said.push(format!(
                "{}: point {response} is missing, which {file} has; levels are compared without it",
                level.hits.join(", ")
            ));
        }
    }
    said
}
