//! Which of several times (clocks) belongs to which channels: one file may hold records of different specimens or tests.

use super::units;
use super::variable::Variable;
use crate::time_unit::TimeUnit;

/// Two times are one clock when they agree, each counted from its start, within this part of an interval: to the nearest sample they are
/// then the same.
const SAME_CLOCK: f64 = 0.5;

/// Where a name stands: in which struct, at which index of a cell array, and with which mark (`steel` in `time_steel`).
#[derive(Debug, PartialEq, Eq)]
struct Place<'a> {
    parent: &'a str,
    index: &'a str,
    mark: String,
}

impl<'a> Place<'a> {
    fn of(name: &'a str) -> Self {
        let (parent, last) = name.rsplit_once('.').unwrap_or(("", name));
        let at = last.find('{').unwrap_or(last.len());
        Self { parent, index: &last[at..], mark: mark(&last[..at]) }
    }

    /// Whether a channel at the place `other` belongs, by its name, to a time at this place.
    fn owns(&self, other: &Self) -> bool {
        let marked =
            self.mark.is_empty() || other.mark.starts_with(&self.mark) || other.mark.ends_with(&self.mark);
        self.parent == other.parent && self.index == other.index && marked
    }

    fn is_plain(&self) -> bool {
        self.parent.is_empty() && self.index.is_empty() && self.mark.is_empty()
    }
}

/// The rest of a name after the word for time is removed.
fn mark(base: &str) -> String {
    let base = base.to_lowercase();
    let edge = |c: char| matches!(c, '_' | '-' | ' ');
    let word = |w: &str| units::is_time_name(w);
    if word(&base) {
        return String::new();
    }
    if let Some((_, tail)) = base.split_once(edge).filter(|(head, _)| word(head)) {
        return tail.into();
    }
    if let Some((head, _)) = base.rsplit_once(edge).filter(|(_, tail)| word(tail)) {
        return head.into();
    }
    let digits = base.trim_start_matches(|c: char| !c.is_ascii_digit());
    if !digits.is_empty() && word(&base[..base.len() - digits.len()]) { digits.into() } else { base }
}

/// Whether a vector is a time: its name is a word for time alone, or holds one (`t2`, `time_steel`, `t{1,2}`) and its values never
/// decrease.
pub(super) fn is_time(v: &Variable) -> bool {
    let rises = || v.values.windows(2).all(|w| w[1] >= w[0]) && v.values.first() < v.values.last();
    v.is_vector() && (units::is_time_name(&v.name) || (is_marked(&v.name) && rises()))
}

/// Whether a name may be the name of a time.
pub(crate) fn is_time_named(name: &str) -> bool {
    units::is_time_name(name) || is_marked(name)
}

/// Whether a name holds a word for time beside other words.
fn is_marked(name: &str) -> bool {
    let last = name.rsplit('.').next().unwrap_or(name);
    mark(last.split(['{', '[']).next().unwrap_or(last)) != units::base(name)
}

/// The times of a file and its other arrays, to find out whether the times are clocks of different records.
pub(super) struct Clocks<'a> {
    times: Vec<&'a Variable>,
    others: Vec<&'a Variable>,
}

impl<'a> Clocks<'a> {
    pub(super) fn of(variables: &'a [Variable]) -> Self {
        let (times, others) = variables.iter().partition(|v| is_time(v));
        Self { times, others }
    }

    /// Names of the times when they belong to different records: their clocks differ, or at least two of them have channels of their own.
    pub(super) fn apart(&self) -> Option<Vec<&'a str>> {
        let (first, rest) = self.times.split_first()?;
        let differ = rest.iter().any(|t| !same_clock(first, t));
        let owners = self.times.iter().filter(|t| self.others.iter().any(|v| self.is_only_of(v, t)));
        let apart = differ || owners.count() > 1;
        apart.then(|| self.times.iter().map(|t| t.name.as_str()).collect())
    }

    /// The one time to which all of these channels belong by their names, or else by their length.
    pub(super) fn of_channels(&self, channels: &[String]) -> Option<&'a str> {
        let named = |time: &&&Variable| {
            let place = Place::of(&time.name);
            !place.is_plain() && channels.iter().all(|c| place.owns(&Place::of(c)))
        };
        let found: Vec<_> = self.times.iter().filter(named).collect();
        if let [one] = found[..] {
            return Some(&one.name);
        }
        let length = |name: &String| self.others.iter().find(|v| v.name == *name).map(|v| v.values.len());
        let fits = |time: &&&Variable| channels.iter().all(|c| length(c) == Some(time.values.len()));
        let found: Vec<_> = self.times.iter().filter(fits).collect();
        if let [one] = found[..] { Some(&one.name) } else { None }
    }

    /// Whether a channel belongs, by its name, to another time than `time` and not to `time`.
    pub(super) fn is_elsewhere(&self, channel: &Variable, time: &str) -> bool {
        let place = Place::of(&channel.name);
        let owned = |t: &Variable| {
            let at = Place::of(&t.name);
            !at.is_plain() && at.owns(&place)
        };
        let others = self.times.iter().filter(|t| t.name != time).any(|t| owned(t));
        others && !self.times.iter().any(|t| t.name == time && owned(t))
    }

    fn is_only_of(&self, channel: &Variable, time: &Variable) -> bool {
        let place = Place::of(&channel.name);
        let owned = |t: &Variable| !Place::of(&t.name).is_plain() && Place::of(&t.name).owns(&place);
        channel.values.len() > 1 && owned(time) && self.times.iter().filter(|t| owned(t)).count() == 1
    }
}

/// Whether two times agree when each is counted from its own start.
fn same_clock(a: &Variable, b: &Variable) -> bool {
    let factor = |v: &Variable| units::bare(&v.unit).parse::<TimeUnit>().map_or(1.0, TimeUnit::seconds);
    let (fa, fb) = (factor(a), factor(b));
    let (a, b) = (&a.values, &b.values);
    if a.len() != b.len() {
        return false;
    }
    let interval = fa * (a[a.len() - 1] - a[0]) / (a.len() - 1) as f64;
    let apart = |(x, y): (&f64, &f64)| (fa * (x - a[0]) - fb * (y - b[0])).abs();
    a.iter().zip(b).all(|pair| apart(pair) <= SAME_CLOCK * interval.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vector(name: &str, step: f64, n: i32) -> Variable {
        Variable::vector(name.into(), String::new(), (0..n).map(|i| f64::from(i) * step).collect())
    }

    fn apart(names: &[(&str, f64, i32)]) -> bool {
        let variables: Vec<_> = names.iter().map(|(name, step, n)| vector(name, *step, *n)).collect();
        Clocks::of(&variables).apart().is_some()
    }

    #[test]
    fn records_of_several_clocks_are_apart() {
        assert!(apart(&[("t_steel", 0.1, 9), ("steel", 1.0, 9), ("t_alu", 0.2, 9), ("alu", 1.0, 9)]));
        assert!(apart(&[("a.t", 0.1, 9), ("a.x", 1.0, 9), ("b.t", 0.1, 9), ("b.x", 1.0, 9)]));
        assert!(apart(&[("t{1,1}", 0.1, 9), ("x{1,1}", 1.0, 9), ("t{1,2}", 0.1, 8), ("x{1,2}", 1.0, 8)]));
        assert!(apart(&[("t1", 0.1, 9), ("x1", 1.0, 9), ("t2", 0.1, 9), ("x2", 1.0, 9)]));
        // None of these is apart: a time of day beside the time, sensors of one test, a temperature whose name is no time.
        assert!(!apart(&[("time", 0.1, 9), ("timestamp", 0.1, 9), ("x", 1.0, 9)]));
        assert!(!apart(&[("t", 0.1, 9), ("x1", 1.0, 9), ("x2", 1.0, 9), ("t_max", -1.0, 9)]));
    }

    #[test]
    fn channels_lead_to_their_time() {
        let names = [("t_steel", 0.1, 9), ("x_steel", 1.0, 9), ("t_alu", 0.2, 9), ("x_alu", 1.0, 9)];
        let variables: Vec<_> = names.iter().map(|(name, step, n)| vector(name, *step, *n)).collect();
        let clocks = Clocks::of(&variables);
        assert_eq!(clocks.of_channels(&["x_alu".into()]), Some("t_alu"));
        assert_eq!(clocks.of_channels(&["x_alu".into(), "x_steel".into()]), None);
        assert!(
            clocks.is_elsewhere(&variables[3], "t_steel") && !clocks.is_elsewhere(&variables[1], "t_steel")
        );
        let names = [("t", 0.1, 9), ("x", 1.0, 9), ("time", 0.1, 7), ("y", 1.0, 7)];
        let variables: Vec<_> = names.iter().map(|(name, step, n)| vector(name, *step, *n)).collect();
        assert_eq!(Clocks::of(&variables).of_channels(&["y".into()]), Some("time"));
    }
}
