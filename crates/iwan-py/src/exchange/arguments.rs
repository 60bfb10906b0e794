//! What the command line calls options, in messages of the libraries, as arguments of the function of Python that was called.

/// Whose arguments a message names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Call {
    /// Records from a file: `iwan.read_record`.
    File,
    /// Records of what other libraries hand out: `iwan.as_record`, and whatever makes a record by it.
    Data,
    /// Envelopes, which are cut by `window`: `iwan.envelope`.
    Envelope,
    /// Records of several modes: `iwan.fit_coupled`.
    SeveralModes,
    /// All else: `iwan.fit` and its like.
    Other,
}

/// Whole phrases, where the names alone would make no sentence, with the call that they are for; none for every call.
const PHRASES: [(Option<Call>, &str, &str); 15] = [
    (Some(Call::Data), "the sampling rate with --rate HZ", "the sampling interval with dt="),
    (Some(Call::Data), "the rate by --rate HZ", "the sampling interval by dt="),
    (Some(Call::Data), "--time NAME", "time= of iwan.as_record"),
    (Some(Call::Data), "--channel NAME", "channels= of iwan.as_record"),
    (Some(Call::Data), "--quantity", "quantity= of iwan.as_record"),
    (Some(Call::Data), "--resample", "resample=True of iwan.as_record"),
    (Some(Call::Envelope), "--quantity", "quantity= of iwan.Record"),
    (Some(Call::SeveralModes), "one --band", "one band"),
    (Some(Call::SeveralModes), "choose one channel with --channel", "give one channel"),
    (Some(Call::SeveralModes), "a column `frequency` (Hz) in the file", "frequencies="),
    (None, "give the window as start:end", "give window=(start, end)"),
    (None, "as in --level 1 --level 10", "as in levels=[1, 10]"),
    (None, "raise or lift ulimit -v; --memory bounds what is really taken", "raise or lift ulimit -v"),
    (None, "`iwan modes STRUCTURE.toml --write-reduced N --out FOLDER`", "Structure.write_reduced"),
    (None, "`iwan modes STRUCTURE.toml --write-reduced N`", "Structure.write_reduced"),
];

/// Options whose argument has another name; none for every call.
const NAMES: [(Option<Call>, &str, &str); 13] = [
    (Some(Call::File), "channel", "channels"),
    (Some(Call::Data), "rate", "dt"),
    (Some(Call::Data), "channel", "channels"),
    (Some(Call::Envelope), "from", "window"),
    (Some(Call::Envelope), "to", "window"),
    (Some(Call::SeveralModes), "band", "bands"),
    (Some(Call::SeveralModes), "mode", "near"),
    (Some(Call::Other), "shapes", "shape"),
    (None, "from", "start"),
    (None, "to", "stop"),
    (None, "sweep", "sweeps"),
    (None, "backbone", "backbones"),
    (None, "level", "levels"),
];

/// Options that have no value.
const FLAGS: [&str; 3] = ["force", "resample", "undamped"];

/// A text with arguments in place of options: `--mode HZ` is `mode=`, `--mode 93.2` is `mode=93.2`, `--force` is `force=True`. Options
/// are looked for behind a blank or a bracket, so that names that users gave, which stand in quotes, stay as they are.
pub(crate) fn in_python(text: &str, call: Call) -> String {
    let meant = |of: &Option<Call>| of.is_none_or(|of| of == call);
    let phrases = PHRASES.iter().filter(|(of, ..)| meant(of));
    let text = phrases.fold(text.to_owned(), |text, (_, from, to)| text.replace(from, to));
    let (mut out, mut rest) = (String::with_capacity(text.len()), text.as_str());
    let mut behind_option = false;
    while let Some(place) = rest.find("--") {
        let (before, option) = (&rest[..place], &rest[place + 2..]);
        let end = option.find(|c: char| !(c.is_ascii_lowercase() || c == '-')).unwrap_or(option.len());
        let (name, after) = option.split_at(end);
        let begins = before.ends_with([' ', '(']) || (before.is_empty() && out.is_empty());
        if !begins || !name.starts_with(|c: char| c.is_ascii_lowercase()) {
            out.push_str(&rest[..place + 2]);
            (rest, behind_option) = (option, false);
            continue;
        }
        // One option behind another: arguments stand apart by commas.
        out.push_str(if behind_option && before == " " { ", " } else { before });
        let renamed = NAMES.iter().find(|(of, from, _)| meant(of) && *from == name);
        out.push_str(&renamed.map_or_else(|| name.replace('-', "_"), |(.., to)| (*to).to_owned()));
        out.push('=');
        if FLAGS.contains(&name) {
            out.push_str("True");
        }
        (rest, behind_option) = (value(after, &mut out), true);
    }
    out.push_str(rest);
    out
}

/// What follows an option without its value: a number and a name in quotes are put to the argument, a word in capitals stands for a value
/// and is left out.
fn value<'a>(after: &'a str, out: &mut String) -> &'a str {
    let Some(given) = after.strip_prefix(' ') else { return after };
    let quoted = given.strip_prefix('\'').and_then(|inner| inner.find('\'')).map(|end| end + 2);
    let end = quoted.unwrap_or_else(|| {
        let ends = |c: char| c.is_whitespace() || matches!(c, ',' | ';' | ')');
        given.find(ends).unwrap_or(given.len())
    });
    let (word, rest) = given.split_at(end);
    let placeholder = word.len() > 1 && word.chars().all(|c| c.is_ascii_uppercase() || c == ':');
    let choices = word.contains('|');
    if placeholder || choices {
        return rest;
    }
    if quoted.is_some() || word.parse::<f64>().is_ok() {
        out.push_str(word);
        return rest;
    }
    after
}
