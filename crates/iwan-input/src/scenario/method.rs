//! `[method]` and `[time]`: the method of simulation and the time axis.

use iwan_core::Grid;
use iwan_sim::{Method, Representation};

use crate::error::InputError;
use crate::section::{Section, TableKind};

/// The methods with their keys.
pub(crate) const KINDS: &[TableKind] = &[
    TableKind { name: "newmark", keys: &["joint", "sliders", "grid", "prewarp", "beta", "gamma"] },
    TableKind { name: "half-cycle", keys: &[] },
    TableKind { name: "averaging", keys: &[] },
    TableKind { name: "event", keys: &["sliders", "grid"] },
];

/// Keys of the time axis.
pub(crate) const TIME_KEYS: &[&str] = &["step", "duration"];

/// Largest number of sliders: this many take 1.2 GB and a minute for the built-in scenario, and more are refused. So many gain nothing: the
/// error from cutting the density into sliders is 4e-4 with 100 sliders and 2e-9 with 100,000, and the continuum has no such error.
pub const MOST_SLIDERS: usize = 10_000_000;

/// Why the keys of a method do not go together; the caller, which read the keys, adds their place.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Refusal {
    pub(super) key: &'static str,
    pub(super) message: String,
    /// What helps.
    pub(super) remedy: String,
}

/// How the joint is represented.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointChoice {
    /// A population of Jenkins elements
    Sliders,
    /// The exact continuum
    Continuum,
}

/// Where the bins of the density lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum GridKind {
    /// Geometric, fine at small strengths.
    Graded,
    /// Equal widths.
    Uniform,
}

/// Values of a scenario that the command line replaces.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Overrides {
    /// Name of the method of integration.
    pub method: Option<&'static str>,
    /// Representation of the joint in Newmark's method.
    pub joint: Option<JointChoice>,
    /// Number of sliders.
    pub sliders: Option<usize>,
    /// Time step, s.
    pub step: Option<f64>,
    /// Length of the response, s.
    pub duration: Option<f64>,
    /// Amplitude of the force.
    pub amplitude: Option<f64>,
    /// Whether the response is passed on while it is computed, so that no memory is needed to hold it.
    pub streamed: bool,
}

/// A method as written; keys that were left out are `None`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MethodKeys {
    pub(crate) kind: &'static str,
    pub(crate) joint: Option<JointChoice>,
    pub(crate) sliders: Option<usize>,
    pub(crate) grid: Option<GridKind>,
    pub(crate) prewarp: Option<bool>,
    pub(crate) beta: Option<f64>,
    pub(crate) gamma: Option<f64>,
}

impl MethodKeys {
    /// The method of this name with all other keys left out.
    pub(crate) const fn named(kind: &'static str) -> Self {
        Self { kind, joint: None, sliders: None, grid: None, prewarp: None, beta: None, gamma: None }
    }

    /// Reads the table.
    pub(super) fn read(section: &Section<'_>, kind: &'static TableKind) -> Result<Self, InputError> {
        let representations = [("sliders", JointChoice::Sliders), ("continuum", JointChoice::Continuum)];
        Ok(Self {
            joint: section.choice("joint", &representations)?,
            sliders: section.optional_count("sliders")?,
            grid: section.choice("grid", &[("graded", GridKind::Graded), ("uniform", GridKind::Uniform)])?,
            prewarp: section.optional_flag("prewarp")?,
            beta: section.optional_number("beta")?,
            gamma: section.optional_number("gamma")?,
            ..Self::named(kind.name)
        })
    }

    /// The method with its defaults filled in; `graded` gives the default grid for a number of bins, which differs between a mode and a
    /// structure.
    ///
    /// # Errors
    /// [`Refusal`] of a key that is out of range or does not go with another.
    pub(super) fn resolve(&self, graded: fn(usize) -> Grid) -> Result<Method, Refusal> {
        let problem = |key, message: &str, remedy: &str| {
            Err(Refusal { key, message: message.into(), remedy: remedy.into() })
        };
        let bins = self.sliders.unwrap_or(Representation::DEFAULT_BINS);
        if bins > MOST_SLIDERS {
            let message = format!("sliders = {bins} is out of range: must be at most {MOST_SLIDERS}");
            return problem(
                "sliders",
                &message,
                "choose joint = \"continuum\" for the limit of many sliders",
            );
        }
        let grid = match self.grid {
            Some(GridKind::Uniform) => Grid::Uniform,
            _ => graded(bins),
        };
        match self.kind {
            "half-cycle" => return Ok(Method::HalfCycle),
            "averaging" => return Ok(Method::Averaging),
            "event" => return Ok(Method::Event { bins, grid }),
            _ => {}
        }
        let joint = match self.joint {
            Some(JointChoice::Continuum) => {
                for (key, given) in [("sliders", self.sliders.is_some()), ("grid", self.grid.is_some())] {
                    if given {
                        let message = format!("`{key}` does not apply to joint = \"continuum\"");
                        return problem(key, &message, "remove it, or choose joint = \"sliders\"");
                    }
                }
                Representation::Continuum
            }
            _ => Representation::Sliders { bins, grid },
        };
        let (beta, gamma) = (self.beta.unwrap_or(0.25), self.gamma.unwrap_or(0.5));
        let average = beta == 0.25 && gamma == 0.5;
        let prewarp = self.prewarp.unwrap_or(average);
        if prewarp && !average {
            let message = "prewarp = true goes with beta = 0.25 and gamma = 0.5 only";
            return problem("prewarp", message, "set prewarp = false, or leave beta and gamma out");
        }
        // The allowed range of β and γ does not depend on the step; 1.0 stands for any.
        iwan_core::Newmark::new(1.0, beta, gamma).map_err(|error| match error {
            iwan_core::Error::OutOfRange { name, value, allowed } => Refusal {
                key: name,
                message: format!("{name} = {value} is out of range: {allowed}"),
                remedy: format!("give {name} a value in that range"),
            },
            other => Refusal { key: "kind", message: other.to_string(), remedy: String::new() },
        })?;
        Ok(Method::Newmark { beta, gamma, prewarp, joint })
    }
}

impl MethodKeys {
    /// The method for a structure: average acceleration on all unknowns, without prewarping, because not all of their frequencies can be
    /// prewarped.
    ///
    /// # Errors
    /// [`Refusal`] of a key that applies to modes only.
    pub(super) fn on_structure(self) -> Result<Self, Refusal> {
        let remedy = "a structure is integrated by kind = \"newmark\" with joint, sliders and grid only";
        let given = [
            ("kind", self.kind != "newmark"),
            ("prewarp", self.prewarp == Some(true)),
            ("beta", self.beta.is_some_and(|beta| beta != 0.25)),
            ("gamma", self.gamma.is_some_and(|gamma| gamma != 0.5)),
        ];
        match given.into_iter().find(|(_, given)| *given) {
            Some((key, _)) => Err(Refusal {
                key,
                message: format!("this {key} does not apply to a structure"),
                remedy: remedy.into(),
            }),
            None => Ok(Self { prewarp: Some(false), ..self }),
        }
    }
}

impl MethodKeys {
    /// The keys with those replaced that the command line gives.
    pub(super) fn overridden(self, overrides: &Overrides) -> Result<Self, InputError> {
        let mut keys = match overrides.method {
            Some(kind) if kind != self.kind => {
                let applies = |key| KINDS.iter().any(|k| k.name == kind && k.keys.contains(&key));
                let bins = self.sliders.filter(|_| applies("sliders"));
                Self { sliders: bins, grid: self.grid.filter(|_| applies("grid")), ..Self::named(kind) }
            }
            _ => self,
        };
        let given = [("sliders", overrides.sliders.is_some()), ("joint", overrides.joint.is_some())];
        for (key, given) in given {
            let owner = KINDS.iter().find(|k| k.name == keys.kind);
            if given && !owner.is_some_and(|k| k.keys.contains(&key)) {
                let message = format!("--{key} does not apply to the method {}", keys.kind);
                return Err(InputError::new(message, format!("leave --{key} out, or add --method newmark")));
            }
        }
        if let Some(joint) = overrides.joint {
            keys.joint = Some(joint);
            if joint == JointChoice::Continuum {
                (keys.sliders, keys.grid) = (None, None);
            }
        }
        keys.sliders = overrides.sliders.or(keys.sliders);
        Ok(keys)
    }
}
