//! A table of an input file, read key by key with messages that name file, line, key and remedy.

use std::ops::Range;

use iwan_machine::{Kind, is_harmful};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::error::InputError;
use crate::text::InputText;

/// A table and its place in the text.
#[derive(Debug, Clone)]
pub struct TablePlace<'a> {
    table: &'a DeTable<'a>,
    /// Range of bytes of the text that the table occupies.
    span: Range<usize>,
}

impl<'a> TablePlace<'a> {
    /// The table that a value is; none where the value is no table.
    fn of(value: &'a Spanned<DeValue<'a>>) -> Option<Self> {
        Some(Self { table: value.get_ref().as_table()?, span: value.span() })
    }

    /// Whether the table has this key.
    #[must_use]
    pub fn has(&self, key: &str) -> bool {
        self.table.keys().any(|known| known.get_ref() == key)
    }
}

/// An input text, parsed as TOML.
#[derive(Debug)]
pub struct Document<'a>(Spanned<DeTable<'a>>);

impl Document<'_> {
    /// The table of keys at the top level.
    #[must_use]
    pub fn top(&self) -> TablePlace<'_> {
        TablePlace { table: self.0.get_ref(), span: self.0.span() }
    }
}

impl InputText {
    /// Parses the text as TOML.
    ///
    /// # Errors
    /// [`InputError`] with line and column where the text is no valid TOML; `example` names the built-in file to start from.
    pub fn document(&self, example: &str) -> Result<Document<'_>, InputError> {
        DeTable::parse(&self.text).map(Document).map_err(|error| {
            let start = error.span().map_or(0, |span| span.start);
            let message = format!("not valid TOML: {}", error.message().trim().replace('\n', "; "));
            let remedy = format!("correct this place; `iwan scenario {example}` prints a valid file");
            self.failure(start, &message, &remedy)
        })
    }
}

/// One of several variants of a table, distinguished by the key `kind`.
#[derive(Debug)]
pub struct TableKind {
    /// Value of `kind`.
    pub name: &'static str,
    /// Keys of this variant, without `kind` itself.
    pub keys: &'static [&'static str],
}

/// A table with its title for messages and its place in the text.
#[derive(Debug)]
pub struct Section<'a> {
    source: &'a InputText,
    title: String,
    place: TablePlace<'a>,
}

impl<'a> Section<'a> {
    /// A table that may hold the `known` keys only.
    ///
    /// # Errors
    /// [`InputError`] with the place, what stands there and what helps.
    pub fn new(
        source: &'a InputText,
        title: impl Into<String>,
        place: TablePlace<'a>,
        known: &[&str],
    ) -> Result<Self, InputError> {
        let section = Self { source, title: title.into(), place };
        match section.place.table.keys().find(|key| !known.contains(&key.get_ref().as_ref())) {
            Some(key) => Err(section.unknown(key, known)),
            None => Ok(section),
        }
    }

    /// A table whose keys the caller checks.
    #[must_use]
    pub fn any(source: &'a InputText, title: impl Into<String>, place: TablePlace<'a>) -> Self {
        Self { source, title: title.into(), place }
    }

    fn unknown(&self, key: &Spanned<toml::de::DeString<'_>>, known: &[&str]) -> InputError {
        let given = key.get_ref().as_ref();
        let list = known.join(", ");
        let remedy = match nearest(given, known) {
            Some(k) => format!("did you mean `{k}`? Known here: {list}"),
            None => format!("remove it; known here: {list}"),
        };
        self.source.failure(key.span().start, &format!("unknown key `{given}` in {}", self.title), &remedy)
    }

    /// The variant of the table that its key `kind` names. Keys are checked; a key of another variant is named as such in the error.
    ///
    /// # Errors
    /// [`InputError`] with the place, what stands there and what helps.
    pub fn kind(
        source: &'a InputText,
        title: impl Into<String>,
        place: TablePlace<'a>,
        kinds: &'static [TableKind],
        default: Option<&str>,
    ) -> Result<(Self, &'static TableKind), InputError> {
        Self::variant("kind", source, title, place, kinds, default)
    }

    /// As [`kind`](Self::kind), for variants that the key `tells` distinguishes.
    ///
    /// # Errors
    /// [`InputError`] with the place, what stands there and what helps.
    pub fn variant(
        tells: &str,
        source: &'a InputText,
        title: impl Into<String>,
        place: TablePlace<'a>,
        kinds: &'static [TableKind],
        default: Option<&str>,
    ) -> Result<(Self, &'static TableKind), InputError> {
        let every: Vec<&str> = [tells].into_iter().chain(known(kinds).into_iter().skip(1)).collect();
        let section = Self::new(source, title, place, &every)?;
        let names = kinds.iter().map(|k| k.name).collect::<Vec<_>>().join(", ");
        let name = match section.optional_text(tells)? {
            Some(name) => name,
            None => default
                .map(String::from)
                .ok_or_else(|| section.missing(tells, &format!("add {tells} = one of {names}")))?,
        };
        let Some(kind) = kinds.iter().find(|k| k.name == name) else {
            return Err(section.choice_failure(tells, &name, &names));
        };
        for (key, _) in section.place.table {
            let given = key.get_ref().as_ref();
            if given != tells && !kind.keys.contains(&given) {
                let owners: Vec<_> = kinds
                    .iter()
                    .filter(|k| k.keys.contains(&given))
                    .map(|k| format!("\"{}\"", k.name))
                    .collect();
                let message =
                    format!("`{given}` does not apply to {tells} = \"{name}\" in {}", section.title);
                let remedy = format!("remove it, or choose {tells} = {}", owners.join(" or "));
                return Err(source.failure(key.span().start, &message, &remedy));
            }
        }
        Ok((section, kind))
    }

    /// The same table under another title.
    #[must_use]
    pub fn renamed(self, title: String) -> Self {
        Self { title, ..self }
    }

    /// Title of the table for messages.
    #[must_use]
    pub fn title(&self) -> &str {
        &self.title
    }

    fn value(&self, key: &str) -> Option<&'a Spanned<DeValue<'a>>> {
        self.place.table.iter().find(|(k, _)| k.get_ref().as_ref() == key).map(|(_, v)| v)
    }

    /// Range of bytes of the text that the value of `key` occupies.
    #[must_use]
    pub fn span(&self, key: &str) -> Option<Range<usize>> {
        self.value(key).map(Spanned::span)
    }

    /// An error at the value of `key`, or at the table when it has no such key.
    #[must_use]
    pub fn failure(&self, key: &str, message: &str, remedy: &str) -> InputError {
        let start = self.value(key).map_or(self.place.span.start, |v| v.span().start);
        self.source.failure(start, &format!("{}: {message}", self.title), remedy)
    }

    fn missing(&self, key: &str, remedy: &str) -> InputError {
        self.failure(key, &format!("the key `{key}` is missing"), remedy)
    }

    fn choice_failure(&self, key: &str, given: &str, names: &str) -> InputError {
        self.failure(key, &format!("{key} = \"{given}\" is not known"), &format!("choose one of {names}"))
    }

    fn wrong_type(&self, key: &str, found: &DeValue<'_>, wanted: &str) -> InputError {
        let article = if found.type_str().starts_with(['a', 'i']) { "an" } else { "a" };
        let message = format!("{key} is {article} {}, not {wanted}", found.type_str());
        self.failure(key, &message, &format!("give {key} as {wanted}"))
    }

    /// A number that may be left out.
    ///
    /// # Errors
    /// [`InputError`] with the place, what stands there and what helps.
    pub fn optional_number(&self, key: &str) -> Result<Option<f64>, InputError> {
        self.value(key).map(|v| self.to_number(key, v)).transpose()
    }

    /// A number with a default.
    ///
    /// # Errors
    /// [`InputError`] with the place, what stands there and what helps.
    pub fn number_or(&self, key: &str, default: f64) -> Result<f64, InputError> {
        Ok(self.optional_number(key)?.unwrap_or(default))
    }

    /// A number that must be there.
    ///
    /// # Errors
    /// [`InputError`] with the place, what stands there and what helps.
    pub fn number(&self, key: &str) -> Result<f64, InputError> {
        self.optional_number(key)?.ok_or_else(|| self.missing(key, &format!("add {key} = NUMBER")))
    }

    fn to_number(&self, key: &str, value: &Spanned<DeValue<'_>>) -> Result<f64, InputError> {
        match value.get_ref() {
            DeValue::Float(float) => Ok(float.as_str().parse().unwrap_or(f64::NAN)),
            DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix())
                .map(|i| i as f64)
                .or_else(|_| integer.as_str().parse())
                .map_err(|_| self.wrong_type(key, value.get_ref(), "a number")),
            other => Err(self.wrong_type(key, other, "a number")),
        }
    }

    /// A whole number >= 1 that may be left out.
    ///
    /// # Errors
    /// [`InputError`] with the place, what stands there and what helps.
    pub fn optional_count(&self, key: &str) -> Result<Option<usize>, InputError> {
        let Some(value) = self.value(key) else { return Ok(None) };
        let DeValue::Integer(integer) = value.get_ref() else {
            return Err(self.wrong_type(key, value.get_ref(), "a whole number >= 1"));
        };
        match usize::from_str_radix(integer.as_str(), integer.radix()) {
            Ok(count) if count >= 1 => Ok(Some(count)),
            _ => {
                let message =
                    format!("{key} = {} is out of range: must be a whole number >= 1", integer.as_str());
                Err(self.failure(key, &message, &format!("give {key} as a whole number >= 1")))
            }
        }
    }

    /// A text that may be left out.
    ///
    /// # Errors
    /// [`InputError`] with the place, what stands there and what helps.
    pub fn optional_text(&self, key: &str) -> Result<Option<String>, InputError> {
        let Some(value) = self.value(key) else { return Ok(None) };
        let text = value.get_ref().as_str();
        text.map(|t| Some(t.to_string()))
            .ok_or_else(|| self.wrong_type(key, value.get_ref(), "a text in quotes"))
    }

    /// A text that must be there.
    ///
    /// # Errors
    /// [`InputError`] with the place, what stands there and what helps.
    pub fn text(&self, key: &str) -> Result<String, InputError> {
        self.optional_text(key)?.ok_or_else(|| self.missing(key, &format!("add {key} = \"...\"")))
    }

    /// A name: a text that is not empty and has no character that does harm where it is shown; none where the key is missing.
    ///
    /// # Errors
    /// [`InputError`] with the place, what stands there and what helps.
    pub fn optional_name(&self, key: &str) -> Result<Option<String>, InputError> {
        let name = self.optional_text(key)?;
        match name {
            Some(name) if name.trim().is_empty() || name.contains(is_harmful) => {
                let message = format!("{key} is empty or has control characters");
                Err(self.failure(key, &message, "give it a readable name"))
            }
            name => Ok(name),
        }
    }

    /// A name that must be there.
    ///
    /// # Errors
    /// [`InputError`] with the place, what stands there and what helps.
    pub fn name(&self, key: &str) -> Result<String, InputError> {
        self.optional_name(key)?.ok_or_else(|| self.missing(key, &format!("add {key} = \"...\"")))
    }

    /// The meaning of one of several words; none where the key is missing.
    ///
    /// # Errors
    /// [`InputError`] with the place, what stands there and what helps.
    pub fn choice<T: Copy>(&self, key: &str, choices: &[(&str, T)]) -> Result<Option<T>, InputError> {
        let Some(given) = self.optional_text(key)? else { return Ok(None) };
        if let Some((_, value)) = choices.iter().find(|(name, _)| *name == given) {
            return Ok(Some(*value));
        }
        let names = choices.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
        Err(self.choice_failure(key, &given, &names))
    }

    /// A switch that may be left out.
    ///
    /// # Errors
    /// [`InputError`] with the place, what stands there and what helps.
    pub fn optional_flag(&self, key: &str) -> Result<Option<bool>, InputError> {
        let Some(value) = self.value(key) else { return Ok(None) };
        let flag = value.get_ref().as_bool();
        flag.map(Some).ok_or_else(|| self.wrong_type(key, value.get_ref(), "true or false"))
    }

    /// Whether the table has this key.
    #[must_use]
    pub fn has(&self, key: &str) -> bool {
        self.value(key).is_some()
    }

    /// Whether the value of `key` is a text.
    #[must_use]
    pub fn is_text(&self, key: &str) -> bool {
        self.value(key).is_some_and(|v| v.get_ref().is_str())
    }

    /// A list of texts that must be there.
    ///
    /// # Errors
    /// [`InputError`] with the place, what stands there and what helps.
    pub fn texts(&self, key: &str) -> Result<Vec<String>, InputError> {
        let Some(value) = self.value(key) else {
            return Err(self.missing(key, &format!("add {key} = [\"...\", ...]")));
        };
        let wanted = "a list of texts in quotes";
        let Some(array) = value.get_ref().as_array() else {
            return Err(self.wrong_type(key, value.get_ref(), wanted));
        };
        let text = |v: &Spanned<DeValue<'_>>| v.get_ref().as_str().map(str::to_string);
        array.iter().map(|v| text(v).ok_or_else(|| self.wrong_type(key, v.get_ref(), wanted))).collect()
    }

    /// A list of numbers that must be there.
    ///
    /// # Errors
    /// [`InputError`] with the place, what stands there and what helps.
    pub fn numbers(&self, key: &str) -> Result<Vec<f64>, InputError> {
        let Some(value) = self.value(key) else {
            return Err(self.missing(key, &format!("add {key} = [NUMBER, ...]")));
        };
        let Some(array) = value.get_ref().as_array() else {
            return Err(self.wrong_type(key, value.get_ref(), "a list of numbers"));
        };
        array.iter().map(|v| self.to_number(key, v)).collect()
    }

    /// The tables of an array of tables, or a single table; empty when the key is missing.
    ///
    /// # Errors
    /// [`InputError`] with the place, what stands there and what helps.
    pub fn tables(&self, key: &str) -> Result<Vec<TablePlace<'a>>, InputError> {
        let Some(value) = self.value(key) else { return Ok(Vec::new()) };
        let wanted = format!("an array of tables ([[{key}]])");
        let Some(array) = value.get_ref().as_array() else {
            return Err(self.wrong_type(key, value.get_ref(), &wanted));
        };
        let table = |v| TablePlace::of(v).ok_or_else(|| self.wrong_type(key, v.get_ref(), &wanted));
        array.iter().map(table).collect()
    }

    /// A table that may be left out.
    ///
    /// # Errors
    /// [`InputError`] with the place, what stands there and what helps.
    pub fn optional_table(&self, key: &str) -> Result<Option<TablePlace<'a>>, InputError> {
        let Some(value) = self.value(key) else { return Ok(None) };
        match TablePlace::of(value) {
            Some(place) => Ok(Some(place)),
            None => Err(self.wrong_type(key, value.get_ref(), "a table")),
        }
    }

    /// All entries of a table with free keys, as numbers in the order of the file.
    ///
    /// # Errors
    /// [`InputError`] with the place, what stands there and what helps.
    pub fn entries(
        source: &'a InputText,
        title: &str,
        place: TablePlace<'a>,
    ) -> Result<(Self, Vec<(String, f64)>), InputError> {
        let section = Self { source, title: title.into(), place };
        let entry = |(key, value): (&Spanned<toml::de::DeString<'_>>, &Spanned<DeValue<'_>>)| {
            let name = key.get_ref().to_string();
            section.to_number(&name, value).map(|number| (name, number))
        };
        let entries = section.place.table.iter().map(entry).collect::<Result<_, _>>()?;
        Ok((section, entries))
    }

    /// Turns an error of the libraries about a value of this table into one with file, line and remedy; `key_of` gives the key for the
    /// libraries' name of a value.
    #[must_use]
    pub fn out_of_range(&self, error: iwan_core::Error, key_of: impl Fn(&str) -> String) -> InputError {
        use iwan_core::Error;
        let told = match error {
            Error::OutOfRange { name, value, allowed } => {
                let key = key_of(name);
                let shown = self.optional_number(&key).ok().flatten().unwrap_or(value);
                let message = format!("{key} = {} is out of range: {allowed}", plain(shown));
                self.failure(&key, &message, &format!("give {key} a value in that range"))
            }
            Error::Length { name, .. } | Error::Entry { name, .. } => {
                let key = key_of(name);
                self.failure(&key, &error.to_string(), &format!("give {key} a value in that range"))
            }
            Error::Unsupported { what } => self.failure("kind", what, "choose another combination"),
        };
        told.of(Kind::Value)
    }
}

/// The known name nearest to `given`; none where all are too different.
#[must_use]
pub fn nearest<'a>(given: &str, known: &[&'a str]) -> Option<&'a str> {
    let distance = |name: &str| strsim::damerau_levenshtein(&given.to_lowercase(), &name.to_lowercase());
    let nearest = known.iter().map(|name| (distance(name), *name)).min();
    // Up to two wrong letters in a short name, or up to half of the letters of a long one, count as a slip; with more, another key was
    // meant.
    nearest.filter(|(distance, name)| *distance <= 2.max(name.len() / 2)).map(|(_, name)| name)
}

/// A number for a message: with an exponent where it would be long.
#[must_use]
pub fn plain(value: f64) -> String {
    match value.abs() {
        x if x == 0.0 || !x.is_finite() || (1e-4..1e9).contains(&x) => value.to_string(),
        _ => format!("{value:e}"),
    }
}

/// All keys of these variants, each once, `kind` first.
#[must_use]
pub fn known(kinds: &[TableKind]) -> Vec<&'static str> {
    let mut keys = vec!["kind"];
    for key in kinds.iter().flat_map(|k| k.keys) {
        if !keys.contains(key) {
            keys.push(key);
        }
    }
    keys
}
