//! Names in messages: lists of them, long ones, and those with characters that do harm.

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

/// Whether a terminal obeys a character in place of showing it, or a reader is misled by it: control characters (of ASCII and of Unicode's
/// second block, U+0080 to U+009F) and those that change the direction of writing, by which one name can be made to look like another
/// (Unicode UAX 9).
///
/// ```
/// assert!(iwan_machine::is_harmful('\u{1b}') && iwan_machine::is_harmful('\u{9b}') && iwan_machine::is_harmful('\u{202e}'));
/// assert!(!iwan_machine::is_harmful('\u{e9}'));
/// ```
#[must_use]
pub const fn is_harmful(character: char) -> bool {
    matches!(character, '\0'..='\u{1f}' | '\u{7f}'..='\u{9f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// A name as it may be shown anywhere: U+FFFD stands for each [harmful](is_harmful) character.
///
/// ```
/// assert_eq!(iwan_machine::plain("acc\u{1b}[2J\n"), "acc\u{fffd}[2J\u{fffd}");
/// ```
#[must_use]
pub fn plain(name: &str) -> String {
    name.replace(is_harmful, "\u{fffd}")
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
