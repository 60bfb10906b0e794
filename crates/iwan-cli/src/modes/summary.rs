//! The summary of `iwan modes`: `summary.json` and the table on the terminal.

use std::fmt::Write;

use iwan_fem::{Class, NamedMode};
use serde::Serialize;

use crate::page::numbers::short;
use crate::session::{Summary, Warnings};
use crate::structures::{Linear, Size};

/// The summary of the modes of a structure.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct ModesSummary {
    /// The structure's title, or its name.
    pub(crate) structure: String,
    /// Numbers of nodes, elements, unknowns and joints.
    pub(crate) size: Size,
    /// Elastic frequencies with all joints stuck, Hz, ascending.
    pub(crate) stuck: Vec<f64>,
    /// Elastic frequencies with all joints slipping, Hz, ascending.
    pub(crate) slipping: Vec<f64>,
    /// Numbers of zero modes (rigid-body motions and mechanisms) in both limits.
    pub(crate) zero_modes: ZeroModes,
    /// The bending modes, stuck and slipping.
    pub(crate) joint_modes: Vec<Pair>,
    /// All elastic modes, stuck and slipping.
    pub(crate) modes: Vec<Pair>,
    /// What the user should look at.
    pub(crate) warnings: Warnings,
    /// Wall-clock time of assembly and modes, s.
    pub(crate) seconds: f64,
}

/// Numbers of zero modes with all joints stuck and with all slipping.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct ZeroModes {
    pub(crate) stuck: usize,
    pub(crate) slipping: usize,
}

/// A stuck mode and the slipping mode with the most similar shape.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Pair {
    pub(crate) name: String,
    pub(crate) class: &'static str,
    /// Frequency with all joints stuck, Hz.
    pub(crate) frequency_stuck: f64,
    /// Frequency with all joints slipping, Hz.
    pub(crate) frequency_slipping: f64,
    /// Modal joint stiffness K_T = ω0² - ω∞², 1/s².
    pub(crate) k_t: f64,
    pub(crate) mac: f64,
}

impl ModesSummary {
    /// Makes the summary of a structure's modes.
    pub(crate) fn new(linear: &Linear, seconds: f64) -> Self {
        let pair = |mode: &NamedMode| Pair {
            name: mode.name.clone(),
            class: mode.class.word(),
            frequency_stuck: linear.frequency_stuck(mode),
            frequency_slipping: linear.frequency_slipping(mode),
            k_t: mode.pair.k_t,
            mac: mode.pair.mac,
        };
        let count = linear.elastic.len();
        let elastic = |modes: &iwan_fem::Modes| {
            modes.frequencies().into_iter().skip(modes.zero_modes()).take(count).collect()
        };
        let bending = linear.elastic.iter().filter(|mode| mode.class == Class::Bending);
        Self {
            structure: linear.file.title.clone().unwrap_or_else(|| linear.source.clone()),
            size: Size::of(linear),
            stuck: elastic(&linear.stuck),
            slipping: elastic(&linear.slipping),
            zero_modes: ZeroModes {
                stuck: linear.stuck.zero_modes(),
                slipping: linear.slipping.zero_modes(),
            },
            joint_modes: bending.map(pair).collect(),
            modes: linear.elastic.iter().map(pair).collect(),
            warnings: linear.warnings().into_iter().collect(),
            seconds,
        }
    }

    /// Columns of the table of modes.
    pub(crate) fn columns(&self) -> Vec<(&'static str, Vec<f64>)> {
        let column = |value: fn(&Pair) -> f64| self.modes.iter().map(value).collect::<Vec<_>>();
        vec![
            ("mode", (1..=self.modes.len()).map(|n| n as f64).collect()),
            ("frequency_stuck", column(|p| p.frequency_stuck)),
            ("frequency_slipping", column(|p| p.frequency_slipping)),
            ("k_t", column(|p| p.k_t)),
            ("mac", column(|p| p.mac)),
        ]
    }
}

impl Summary for ModesSummary {
    const SHOWN: &'static str = "pictures";

    fn warnings(&self) -> &[String] {
        &self.warnings
    }

    fn text(&self) -> String {
        let Size { nodes, elements, unknowns, joints, slips, total_mass } = self.size;
        let ZeroModes { stuck, slipping } = self.zero_modes;
        let mut text = format!(
            "{nodes} nodes, {elements} elements, {unknowns} unknowns, {joints} joints with {slips} slips, total mass {}\n\
             zero modes: {stuck} stuck, {slipping} slipping\n\n\
             {:<14}{:>12}{:>14}{:>14}{:>9}\n",
            short(total_mass),
            "mode",
            "stuck, Hz",
            "slipping, Hz",
            "K_T, 1/s^2",
            "MAC"
        );
        for pair in &self.modes {
            let Pair { name, frequency_stuck, frequency_slipping, k_t, mac, .. } = pair;
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "{name:<14}{frequency_stuck:>12.4}{frequency_slipping:>14.4}{:>14}{mac:>9.4}",
                short(*k_t)
            );
        }
        text
    }
}
