//! A finding: a statement on the paper, with the numbers on which it rests.

use serde::Serialize;

use crate::modes::Interval;
use iwan_sim::numbers::short;

/// The verdict of a finding on the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FindingKind {
    /// Our result agrees with the paper's.
    Reproduced,
    /// The formula as printed is wrong.
    Corrected,
    /// The paper's statement holds in part, or under conditions that the paper does not name.
    Limited,
}

impl FindingKind {
    /// The verdict as one word.
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
    /// The verdict on the paper.
    pub kind: FindingKind,
    /// The finding in one line.
    pub title: &'static str,
    /// The finding in a few sentences.
    pub text: String,
    /// The numbers on which it rests.
    pub numbers: Vec<FindingNumber>,
}

/// A number of a finding.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FindingNumber {
    /// Name, unique within the finding.
    pub name: String,
    /// Value; none where it does not exist, such as a root of an equation without one.
    pub value: Option<f64>,
}

/// A number of a finding that has a value.
pub(super) fn number(name: impl Into<String>, value: f64) -> FindingNumber {
    FindingNumber { name: name.into(), value: Some(value) }
}

/// An interval as text, open ends included.
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
