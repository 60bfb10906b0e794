//! Lists of names in messages.

/// Largest number of names in a message; a list of more is longer than a screen, and the message says how many more there are.
const SHOWN: usize = 20;
/// Largest number of characters of a name in a message; longer names are cut.
const LONGEST: usize = 60;

/// Names for a message: the first twenty, each at most sixty characters long, and how many more there are; a file may hold a hundred
/// thousand names.
///
/// ```
/// assert_eq!(iwan_machine::listed(["tip", "root"]), "tip, root");
/// let many: Vec<String> = (1..=100_000).map(|n| format!("channel {n}")).collect();
/// assert!(iwan_machine::listed(&many).ends_with(", channel 20 and 99980 more"));
/// assert_eq!(iwan_machine::listed::<&str>([]), "none");
/// ```
pub fn listed<N: AsRef<str>>(names: impl IntoIterator<Item = N>) -> String {
    let mut names = names.into_iter();
    let shown: Vec<String> =
        names.by_ref().take(SHOWN).map(|name| shortened(name.as_ref(), LONGEST)).collect();
    match (shown.is_empty(), names.count()) {
        (true, _) => "none".into(),
        (_, 0) => shown.join(", "),
        (_, more) => format!("{} and {more} more", shown.join(", ")),
    }
}

/// The first `most` characters of a text, for a message; `...` follows where the text is longer.
///
/// ```
/// assert_eq!(iwan_machine::shortened("accelerometer", 5), "accel...");
/// ```
#[must_use]
pub fn shortened(text: &str, most: usize) -> String {
    match text.char_indices().nth(most) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.into(),
    }
}
