//! Warnings, of which like ones are counted: a file of a hundred thousand sets may give as many warnings of one kind.

use std::collections::HashMap;
use std::ops::Deref;

use iwan_machine::brief;
use serde::Serialize;

/// Warnings of one kind that are given one by one: who has read as many learns nothing from more. A judgement.
const GIVEN: usize = 5;
/// Kinds that are told apart. The program has fewer kinds of warnings; names without quotes in them may make more of one.
const KINDS: usize = 100;

/// Warnings in their order, at most five of a kind, and behind them how many more there are of it.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[serde(transparent)]
pub(crate) struct Warnings(Vec<String>);

impl Warnings {
    /// Adds warnings, of which like ones are counted.
    pub(crate) fn extend(&mut self, more: impl IntoIterator<Item = String>) {
        self.0.extend(more.into_iter().collect::<Self>().0);
    }
}

impl FromIterator<String> for Warnings {
    fn from_iter<I: IntoIterator<Item = String>>(all: I) -> Self {
        let (mut places, mut kinds, mut others) = (HashMap::new(), Vec::<(Vec<String>, usize)>::new(), 0);
        for text in all.into_iter().map(|text| brief(&text)) {
            let kind = kind(&text);
            let known = kinds.len();
            let Some(at) = places.get(&kind).copied().or_else(|| (known < KINDS).then_some(known)) else {
                others += 1;
                continue;
            };
            if at == known {
                places.insert(kind, at);
                kinds.push((Vec::new(), 0));
            }
            let (given, more) = &mut kinds[at];
            if given.len() < GIVEN { given.push(text) } else { *more += 1 }
        }
        let of_kind = |(mut given, more): (Vec<String>, usize)| {
            given.extend((more > 0).then(|| format!("and {more} more like the one before")));
            given
        };
        let others = (others > 0).then(|| format!("and {others} warnings more"));
        Self(kinds.into_iter().flat_map(of_kind).chain(others).collect())
    }
}

impl Deref for Warnings {
    type Target = [String];

    fn deref(&self) -> &[String] {
        &self.0
    }
}

/// What warnings of one kind have in common: the text without names in quotes and without digits.
fn kind(text: &str) -> String {
    let (mut kind, mut quote, mut before) = (String::new(), None, ' ');
    for c in text.chars() {
        match quote {
            Some(end) if c == end => quote = None,
            Some(_) => {}
            // Behind a letter an apostrophe opens no quotation.
            None if matches!(c, '\'' | '"') && !before.is_alphanumeric() => quote = Some(c),
            None if c.is_ascii_digit() => {}
            None => kind.push(c),
        }
        before = c;
    }
    kind
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn like_warnings_are_counted() {
        let many =
            (0..1000).map(|n| format!("a.uff: 'set {n}' has {n}.5 points; the file's header has more"));
        let other = ["b.csv: another".to_string()];
        let given: Warnings = many.chain(other).collect();
        assert_eq!(given.len(), GIVEN + 2);
        assert_eq!(given[GIVEN], "and 995 more like the one before");
        assert_eq!(given[GIVEN + 1], "b.csv: another");
        let letters = |n: u32| char::from_u32(0x4e00 + n).unwrap().to_string();
        let kinds: Warnings = (0..10_000).map(letters).collect();
        assert_eq!(kinds.len(), KINDS + 1);
        assert_eq!(kinds[KINDS], "and 9900 warnings more");
    }
}
