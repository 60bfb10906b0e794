//! A finding: a sentence about the paper with the numbers it rests on.

use serde::Serialize;

use crate::modes::Interval;
use iwan_sim::numbers::short;

/// What a finding says about the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FindingKind {
    /// Ours agrees.
    Reproduced,
    /// The formula as printed is wrong.
    Corrected,
    /// It holds in part, or under conditions the paper does not name.
    Limited,
}

impl FindingKind {
    /// In a word.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Reproduced => "reproduced",
            Self::Corrected => "corrected",
            Self::Limited => "limited",
        }
    }
}

/// A finding.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// Name, such as `eq-15`.
    pub id: &'static str,
    /// What it says about the paper.
    pub kind: FindingKind,
    /// In a line.
    pub title: &'static str,
    /// In a few sentences.
    pub text: String,
    /// The numbers it rests on.
    pub numbers: Vec<FindingNumber>,
}

/// A number of a finding.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FindingNumber {
    /// Name, unique within the finding.
    pub name: String,
    /// Value; none where there is none to be had, such as a root that does not exist.
    pub value: Option<f64>,
}

/// A number that there is.
pub(super) fn number(name: impl Into<String>, value: f64) -> FindingNumber {
    FindingNumber { name: name.into(), value: Some(value) }
}

/// An interval in words.
///
/// ```
/// use iwan_study::findings::bounds;
/// use iwan_study::modes::Interval;
/// let open = Interval { parameter: "beta", value: 1.0, low: Some(0.25), high: None, identifiable: false };
/// assert_eq!(bounds(&open), "above 0.2500");
/// ```
#[must_use]
pub fn bounds(interval: &Interval) -> String {
    match (interval.low, interval.high) {
        (Some(low), Some(high)) => format!("{} to {}", short(low), short(high)),
        (Some(low), None) => format!("above {}", short(low)),
        (None, Some(high)) => format!("up to {}", short(high)),
        (None, None) => "open".into(),
    }
}
