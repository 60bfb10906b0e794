//! Texts for `repr`: each is a Python expression for an equal value.

/// A float as Python writes and reads it, with all its bits.
pub(crate) fn float(x: f64) -> String {
    if x.is_finite() { format!("{x:?}") } else { format!("float('{x}')") }
}

/// A list of floats.
pub(crate) fn floats(values: &[f64]) -> String {
    let all: Vec<_> = values.iter().map(|x| float(*x)).collect();
    format!("[{}]", all.join(", "))
}

/// A string in quotes.
pub(crate) fn text(value: &str) -> String {
    let mut quoted = String::from("'");
    for c in value.chars() {
        match c {
            '\'' | '\\' => quoted.extend(['\\', c]),
            '\n' => quoted.push_str("\\n"),
            '\r' => quoted.push_str("\\r"),
            '\t' => quoted.push_str("\\t"),
            c if c.is_control() => quoted.extend(format!("\\U{:08x}", u32::from(c)).chars()),
            c => quoted.push(c),
        }
    }
    quoted.push('\'');
    quoted
}

/// `iwan.NAME(key=value, ...)`.
pub(crate) fn call(name: &str, arguments: &[(&str, String)]) -> String {
    let all: Vec<_> = arguments.iter().map(|(key, value)| format!("{key}={value}")).collect();
    format!("iwan.{name}({})", all.join(", "))
}
