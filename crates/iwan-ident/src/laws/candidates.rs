//! The short list of laws that are compared, the simplest first.

use super::terms::Term;

/// A law that is tried on every record.
#[derive(Debug, Clone, Copy)]
pub struct Candidate {
    /// Name in results and for `--law`: plain kebab-case.
    pub name: &'static str,
    /// The law in words.
    pub words: &'static str,
    pub(super) terms: &'static [Term],
}

impl Candidate {
    /// Whether the law has an Iwan joint, whose coordinates then come first among those of its terms.
    pub(super) const fn has_iwan(&self) -> bool {
        matches!(self.terms, [Term::Iwan, ..])
    }
}

/// All laws, by ascending number of parameters. Every law has a stiffness and a viscous damper.
pub const CANDIDATES: &[Candidate] = &[
    Candidate { name: "linear", words: "a linear mode with viscous damping", terms: &[] },
    Candidate {
        name: "viscous-coulomb",
        words: "linear stiffness with viscous and Coulomb damping",
        terms: &[Term::Coulomb],
    },
    Candidate {
        name: "viscous-quadratic",
        words: "linear stiffness with viscous and quadratic damping",
        terms: &[Term::Quadratic],
    },
    Candidate { name: "duffing", words: "a cubic spring with viscous damping", terms: &[Term::Cubic] },
    Candidate {
        name: "viscous-coulomb-quadratic",
        words: "linear stiffness with viscous, Coulomb and quadratic damping",
        terms: &[Term::Coulomb, Term::Quadratic],
    },
    Candidate {
        name: "duffing-coulomb",
        words: "a cubic spring with viscous and Coulomb damping",
        terms: &[Term::Coulomb, Term::Cubic],
    },
    Candidate {
        name: "duffing-quadratic",
        words: "a cubic spring with viscous and quadratic damping",
        terms: &[Term::Quadratic, Term::Cubic],
    },
    Candidate {
        name: "power-damping",
        words: "linear stiffness with viscous damping and damping by a power of the velocity",
        terms: &[Term::PowerDamping],
    },
    Candidate { name: "jenkins", words: "one Jenkins element with viscous damping", terms: &[Term::Jenkins] },
    Candidate {
        name: "pinning",
        words: "a spring beyond a gap with viscous damping",
        terms: &[Term::Pinning],
    },
    Candidate {
        name: "duffing-coulomb-quadratic",
        words: "a cubic spring with viscous, Coulomb and quadratic damping",
        terms: &[Term::Coulomb, Term::Quadratic, Term::Cubic],
    },
    Candidate {
        name: "separate-powers",
        words: "softening and damping by separate powers, with viscous damping",
        terms: &[Term::PowerDamping, Term::PowerSpring],
    },
    Candidate {
        name: "iwan",
        words: "one four-parameter Iwan joint with viscous damping",
        terms: &[Term::Iwan],
    },
    Candidate {
        name: "iwan-coulomb",
        words: "one four-parameter Iwan joint with viscous and Coulomb damping",
        terms: &[Term::Iwan, Term::Coulomb],
    },
    Candidate {
        name: "iwan-quadratic",
        words: "one four-parameter Iwan joint with viscous and quadratic damping",
        terms: &[Term::Iwan, Term::Quadratic],
    },
    Candidate {
        name: "iwan-duffing",
        words: "one four-parameter Iwan joint with viscous damping and a cubic spring",
        terms: &[Term::Iwan, Term::Cubic],
    },
];

impl Candidate {
    /// Whether the law is an Iwan joint with a further part beside it.
    pub(super) fn is_combined(&self) -> bool {
        matches!(self.terms, [Term::Iwan, _, ..])
    }

    /// The law with this name; none where there is no such law.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Self> {
        CANDIDATES.iter().find(|c| c.name == name)
    }
}
