//! `joint = { ... }` of a mode.

use iwan_core::{Error, FourParameter, Jenkins, Uniform};
use iwan_sim::JointLaw;

use super::section::{Kind, Section};
use crate::failure::Failure;

/// The joint laws and their keys.
pub(crate) const KINDS: &[Kind] = &[
    Kind { name: "four-parameter", keys: &["k_t", "f_s", "chi", "beta"] },
    Kind { name: "jenkins", keys: &["k_t", "f_s"] },
    Kind { name: "uniform", keys: &["k_t", "f_s", "width"] },
    Kind { name: "tabulated", keys: &["strength", "density", "dirac"] },
];

/// A joint as written, kept beside the law so that it can be written again.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Joint {
    FourParameter { k_t: f64, f_s: f64, chi: f64, beta: f64 },
    Jenkins { k_t: f64, f_s: f64 },
    Uniform { k_t: f64, f_s: f64, width: f64 },
    Tabulated { strength: Vec<f64>, density: Vec<f64>, dirac: f64 },
}

impl Joint {
    /// Reads the table's values; [`law`](Self::law) checks them.
    pub(super) fn read(section: &Section<'_>, kind: &Kind) -> Result<Self, Failure> {
        let number = |key| section.number(key);
        Ok(match kind.name {
            "four-parameter" => Self::FourParameter {
                k_t: number("k_t")?,
                f_s: number("f_s")?,
                chi: number("chi")?,
                beta: number("beta")?,
            },
            "jenkins" => Self::Jenkins { k_t: number("k_t")?, f_s: number("f_s")? },
            "uniform" => Self::Uniform { k_t: number("k_t")?, f_s: number("f_s")?, width: number("width")? },
            _ => Self::Tabulated {
                strength: section.numbers("strength")?,
                density: section.numbers("density")?,
                dirac: section.number_or("dirac", 0.0)?,
            },
        })
    }

    /// The joint law.
    pub(super) fn law(&self) -> Result<JointLaw, Error> {
        match self {
            Self::FourParameter { k_t, f_s, chi, beta } => {
                FourParameter::new(*k_t, *f_s, *chi, *beta).map(JointLaw::FourParameter)
            }
            Self::Jenkins { k_t, f_s } => Jenkins::new(*k_t, *f_s).map(JointLaw::Jenkins),
            Self::Uniform { k_t, f_s, width } => Uniform::new(*k_t, *f_s, *width).map(JointLaw::Uniform),
            Self::Tabulated { strength, density, dirac } => JointLaw::tabulated(strength, density, *dirac),
        }
    }
}

/// The key behind a name in an error of the libraries.
pub(super) fn key_of(name: &str) -> String {
    match name {
        "phi_max" | "f_s/k_t" => "f_s",
        "k_t/width" => "width",
        name => name,
    }
    .into()
}
