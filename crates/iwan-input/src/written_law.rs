//! Joint laws as input files write them: `joint = { ... }` of a mode, `law = { ... }` of a slip.

use iwan_core::{Error, FiveParameter, FourParameter, Jenkins, Uniform};
use iwan_sim::JointLaw;

use crate::error::InputError;
use crate::section::{Section, TableKind, TablePlace};
use crate::text::InputText;

/// The joint laws with their keys.
pub const LAWS: &[TableKind] = &[
    TableKind { name: "four-parameter", keys: &["k_t", "f_s", "chi", "beta"] },
    TableKind { name: "five-parameter", keys: &["k_t", "f_s", "chi", "beta", "theta"] },
    TableKind { name: "jenkins", keys: &["k_t", "f_s"] },
    TableKind { name: "uniform", keys: &["k_t", "f_s", "width"] },
    TableKind { name: "tabulated", keys: &["strength", "density", "dirac"] },
];

/// A joint law as the file writes it, kept beside the law itself so that it can be written out again.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs, reason = "the fields carry the names of the keys, which are those of the laws")]
pub enum WrittenLaw {
    /// Segalman's four-parameter Iwan joint ([`FourParameter`]).
    FourParameter { k_t: f64, f_s: f64, chi: f64, beta: f64 },
    /// A four-parameter joint whose dynamic friction is below the static one ([`FiveParameter`]).
    FiveParameter { k_t: f64, f_s: f64, chi: f64, beta: f64, theta: f64 },
    /// One Jenkins element ([`Jenkins`]).
    Jenkins { k_t: f64, f_s: f64 },
    /// Iwan's uniform band of strengths ([`Uniform`]).
    Uniform { k_t: f64, f_s: f64, width: f64 },
    /// A density given point by point ([`JointLaw::tabulated`]).
    Tabulated { strength: Vec<f64>, density: Vec<f64>, dirac: f64 },
}

impl WrittenLaw {
    /// Reads and checks a table; `title` serves the messages. Without the key `kind` the law is a four-parameter joint, or, with the key
    /// `theta`, a five-parameter one.
    ///
    /// # Errors
    /// [`InputError`] with the place, what stands there and what helps.
    pub fn read<'a>(
        source: &'a InputText,
        title: String,
        place: TablePlace<'a>,
    ) -> Result<(Self, JointLaw), InputError> {
        let default = if place.has("theta") { "five-parameter" } else { "four-parameter" };
        let (section, kind) = Section::kind(source, title, place, LAWS, Some(default))?;
        let written = Self::values(&section, kind)?;
        let law = written.law().map_err(|error| section.out_of_range(error, key_of))?;
        Ok((written, law))
    }

    fn values(section: &Section<'_>, kind: &TableKind) -> Result<Self, InputError> {
        let number = |key| section.number(key);
        Ok(match kind.name {
            "four-parameter" => Self::FourParameter {
                k_t: number("k_t")?,
                f_s: number("f_s")?,
                chi: number("chi")?,
                beta: number("beta")?,
            },
            "five-parameter" => Self::FiveParameter {
                k_t: number("k_t")?,
                f_s: number("f_s")?,
                chi: number("chi")?,
                beta: number("beta")?,
                theta: number("theta")?,
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

    /// `count` joints of this law in parallel: stiffness and slip force are multiplied by `count`, at the same slips.
    #[must_use]
    pub fn times(&self, count: f64) -> Self {
        match self {
            Self::FourParameter { k_t, f_s, chi, beta } => {
                Self::FourParameter { k_t: count * k_t, f_s: count * f_s, chi: *chi, beta: *beta }
            }
            Self::FiveParameter { k_t, f_s, chi, beta, theta } => Self::FiveParameter {
                k_t: count * k_t,
                f_s: count * f_s,
                chi: *chi,
                beta: *beta,
                theta: *theta,
            },
            Self::Jenkins { k_t, f_s } => Self::Jenkins { k_t: count * k_t, f_s: count * f_s },
            Self::Uniform { k_t, f_s, width } => {
                Self::Uniform { k_t: count * k_t, f_s: count * f_s, width: *width }
            }
            Self::Tabulated { strength, density, dirac } => Self::Tabulated {
                strength: strength.clone(),
                density: density.iter().map(|rho| count * rho).collect(),
                dirac: count * dirac,
            },
        }
    }

    /// The joint law.
    ///
    /// # Errors
    /// [`Error`] with the name of the parameter that is out of range.
    pub fn law(&self) -> Result<JointLaw, Error> {
        match self {
            Self::FourParameter { k_t, f_s, chi, beta } => {
                FourParameter::new(*k_t, *f_s, *chi, *beta).map(JointLaw::FourParameter)
            }
            Self::FiveParameter { k_t, f_s, chi, beta, theta } => {
                FiveParameter::new(*k_t, *f_s, *chi, *beta, *theta).map(JointLaw::FiveParameter)
            }
            Self::Jenkins { k_t, f_s } => Jenkins::new(*k_t, *f_s).map(JointLaw::Jenkins),
            Self::Uniform { k_t, f_s, width } => Uniform::new(*k_t, *f_s, *width).map(JointLaw::Uniform),
            Self::Tabulated { strength, density, dirac } => JointLaw::tabulated(strength, density, *dirac),
        }
    }
}

/// The key of the file for a name in an error of the libraries.
fn key_of(name: &str) -> String {
    match name {
        "phi_max" | "f_s/k_t" => "f_s",
        "k_t/width" => "width",
        name => name,
    }
    .into()
}
