//! Medians, ratios and the two tables.

use std::fmt::Write;

/// Times of all contestants, round by round.
pub(crate) struct Figures {
    rows: Vec<(String, Vec<f64>)>,
}

/// Lower quartile, median, upper quartile.
fn quartiles(values: &[f64]) -> [f64; 3] {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    [1, 2, 3].map(|quarter| sorted[(sorted.len() - 1) * quarter / 4])
}

/// What must hold: the time of one contestant over that of another, at most or at least so much.
pub(crate) struct Target {
    above: String,
    below: String,
    most: Option<f64>,
    least: Option<f64>,
}

impl Target {
    fn at_most(above: &str, below: &str, limit: f64) -> Self {
        Self { above: above.into(), below: below.into(), most: Some(limit), least: None }
    }

    fn at_least(above: &str, below: &str, limit: f64) -> Self {
        Self { above: above.into(), below: below.into(), most: None, least: Some(limit) }
    }

    /// Without a limit: to be known.
    fn told(above: &str, below: &str) -> Self {
        Self { above: above.into(), below: below.into(), most: None, least: None }
    }

    pub(crate) fn all() -> Vec<Self> {
        let mut all = Vec::new();
        for grid in ["uniform", "graded"] {
            let ours = |bins: u32| format!("sliders {grid} N={bins} P=1000");
            all.push(Self::at_most(&ours(100), "linear oscillator", 1.3));
            all.push(Self::at_most(&ours(1000), &ours(100), 1.8));
            for (bins, limit) in [(100, 30.0), (1000, 100.0)] {
                let peer = |form: &str| format!("C {form} {grid} N={bins} P=1000");
                all.push(Self::at_least(&peer("textbook"), &ours(bins), limit));
                all.push(Self::told(&peer("saved"), &ours(bins)));
            }
            for unit in ["half cycle", "2 s ring-down"] {
                let (steps, map) = (format!("newmark {grid} N=100: {unit}"), format!("map: {unit}"));
                all.push(Self::at_least(&steps, &map, 20.0));
            }
        }
        all.push(Self::at_most("continuum P=1000", "", 25.0));
        all
    }

    fn limit(&self) -> String {
        match (self.most, self.least) {
            (Some(limit), _) => format!("<= {limit}"),
            (_, Some(limit)) => format!(">= {limit}"),
            _ => String::new(),
        }
    }

    fn holds(&self, figure: f64) -> Option<bool> {
        self.most.map(|limit| figure <= limit).or(self.least.map(|limit| figure >= limit))
    }

    fn question(&self) -> String {
        if self.below.is_empty() {
            format!("{} (ns)", self.above)
        } else {
            format!("{} / {}", self.above, self.below)
        }
    }
}

impl Figures {
    pub(crate) fn new(rows: Vec<(String, Vec<f64>)>) -> Self {
        Self { rows }
    }

    /// Peers so slow that a median of their own will do.
    pub(crate) fn add_slow(&mut self, peers: Vec<(String, f64)>) {
        let rounds = self.rows[0].1.len();
        self.rows.extend(peers.into_iter().map(|(name, time)| (name, vec![time; rounds])));
    }

    fn times(&self, name: &str) -> Option<&[f64]> {
        self.rows.iter().find(|row| row.0 == name).map(|row| &row.1[..])
    }

    /// Quartiles of the ratios of the rounds; none when one side did not run.
    fn ratio(&self, target: &Target) -> Option<[f64; 3]> {
        let above = self.times(&target.above)?;
        if target.below.is_empty() {
            return Some(quartiles(above));
        }
        let below = self.times(&target.below)?;
        Some(quartiles(&above.iter().zip(below).map(|(a, b)| a / b).collect::<Vec<_>>()))
    }

    pub(crate) fn table(&self) -> String {
        let mut text = String::new();
        let linear = &self.rows[0].1;
        let _ = writeln!(text, "{:<38} {:>11} {:>23} {:>11}", "what", "ns", "quartiles", "/ linear");
        for (name, times) in &self.rows {
            let [low, median, high] = quartiles(times);
            let ratios: Vec<f64> = times.iter().zip(linear).map(|(a, b)| a / b).collect();
            let spread = format!("{low:.2} .. {high:.2}");
            let ratio = quartiles(&ratios)[1];
            let _ = writeln!(text, "{name:<38} {median:>11.2} {spread:>23} {ratio:>11.2}");
        }
        text
    }

    pub(crate) fn targets(&self, targets: &[Target]) -> String {
        let mut text = String::new();
        let _ = writeln!(text, "{:<72} {:>7} {:>8} {:>19}", "what", "target", "figure", "quartiles");
        for target in targets {
            let Some([low, median, high]) = self.ratio(target) else { continue };
            let mark = match target.holds(median) {
                Some(true) => "  holds",
                Some(false) => "  missed",
                None => "",
            };
            let (question, limit, spread) =
                (target.question(), target.limit(), format!("{low:.2} .. {high:.2}"));
            let _ = writeln!(text, "{question:<72} {limit:>7} {median:>8.2} {spread:>19}{mark}");
        }
        text
    }

    /// Both tables for machines.
    pub(crate) fn json(&self, targets: &[Target]) -> String {
        let number = |limit: Option<f64>| limit.map_or("null".into(), |l| l.to_string());
        let times = self.rows.iter().map(|(name, times)| {
            let [low, median, high] = quartiles(times);
            format!(r#"    {{"what": "{name}", "ns": {median:.4}, "quartiles": [{low:.4}, {high:.4}]}}"#)
        });
        let ratios = targets.iter().filter_map(|target| {
            let [low, median, high] = self.ratio(target)?;
            let (most, least) = (number(target.most), number(target.least));
            let figure = format!(r#""figure": {median:.4}, "quartiles": [{low:.4}, {high:.4}]"#);
            Some(format!(
                r#"    {{"what": "{}", "most": {most}, "least": {least}, {figure}}}"#,
                target.question()
            ))
        });
        let (times, ratios): (Vec<_>, Vec<_>) = (times.collect(), ratios.collect());
        format!(
            "{{\n  \"times\": [\n{}\n  ],\n  \"targets\": [\n{}\n  ]\n}}\n",
            times.join(",\n"),
            ratios.join(",\n")
        )
    }
}
