//! Whether hits and levels go together: swapped or reversed channels, points that a level lacks.

use iwan_modal::measure::{Freedom, Hit};
use iwan_modal::responses::disagreements;

use super::analysis::Level;
use super::hits::Test;

/// What is said of channels, level by level.
pub(super) fn doubts(test: &Test, levels: &[Level]) -> Vec<String> {
    levels.iter().flat_map(|level| of_level(test, level)).chain(missing(test, levels)).collect()
}

fn used<'a>(test: &'a Test, level: &'a Level) -> impl Iterator<Item = &'a Hit> {
    test.hits.iter().map(|h| &h.hit).filter(|hit| level.hits.contains(&hit.name))
}

fn of_level(test: &Test, level: &Level) -> Vec<String> {
    let hits: Vec<Hit> = used(test, level).cloned().collect();
    // What these hits are refused for has been said before.
    let found = if hits.is_empty() { Ok(Vec::new()) } else { disagreements(&hits) };
    found.unwrap_or_default().iter().map(ToString::to_string).collect()
}

/// Points that were measured at one level and not at another: they do not count where levels are compared.
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
