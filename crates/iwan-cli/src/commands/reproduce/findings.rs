//! What reproduces, what does not and why: each finding with its numbers, computed.

mod formulas;
mod levels;
mod modes;

use serde::Serialize;

use super::{Interval, Reproduction};
use crate::page::numbers::short;

/// What a finding says about the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Kind {
    /// Ours agrees.
    Reproduced,
    /// The formula as printed is wrong.
    Corrected,
    /// It holds in part, or under conditions the paper does not name.
    Limited,
}

impl Kind {
    /// In a word.
    pub(crate) const fn word(self) -> &'static str {
        match self {
            Self::Reproduced => "reproduced",
            Self::Corrected => "corrected",
            Self::Limited => "limited",
        }
    }
}

/// A finding.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Finding {
    pub(crate) id: &'static str,
    pub(crate) kind: Kind,
    pub(crate) title: &'static str,
    pub(crate) text: String,
    pub(crate) numbers: Vec<Number>,
}

/// A number of a finding; none where there is none to be had.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Number {
    pub(crate) name: String,
    pub(crate) value: Option<f64>,
}

fn number(name: impl Into<String>, value: f64) -> Number {
    Number { name: name.into(), value: Some(value) }
}

/// All findings.
pub(crate) fn findings(of: &Reproduction) -> Result<Vec<Finding>, iwan_core::Error> {
    let mut findings = vec![formulas::eq_15()?, formulas::eq_17()?];
    findings.extend(formulas::eq_14(of));
    findings.extend(formulas::eqs_8_to_11(of));
    findings.extend([
        modes::joint_stiffness(of),
        modes::second_mode(of),
        modes::slopes(of),
        modes::chi(of),
        modes::coupling(of),
        modes::beta(of),
        modes::figure_8(of),
        levels::table_4(of),
    ]);
    Ok(findings)
}

/// An interval in words.
pub(crate) fn bounds(interval: &Interval) -> String {
    match (interval.low, interval.high) {
        (Some(low), Some(high)) => format!("{} to {}", short(low), short(high)),
        (Some(low), None) => format!("above {}", short(low)),
        (None, Some(high)) => format!("up to {}", short(high)),
        (None, None) => "open".into(),
    }
}
