//! Slopes of dissipation over force, level by level (Table 4).

use iwan_ident::curves::straight_line;
use iwan_ident::levels::LevelStep;
use serde::Serialize;

use super::bench::HITS;
use super::hit::{Hit, ViscousTerm};
use crate::printed::TABLE_4;
use crate::span::Span;

/// Slopes of ln D over ln force at one level.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Table4Row {
    /// Peak force of the hit, N.
    pub hit: f64,
    /// Modal forces at the beginning and the end of the record, √kg·m/s², between which the slope is taken.
    pub force: Span,
    /// Slope of the dissipation as measured.
    pub slope: f64,
    /// Slope of the dissipation without that of the viscous term.
    pub slope_without_viscous: f64,
    /// Slope from the softer hit to this one, at equal times; none for the softest.
    pub step: Option<f64>,
    /// The same slope without the viscous term.
    pub step_without_viscous: Option<f64>,
    /// The printed slope at this ratio to the hardest level; none where the paper has no such level.
    pub printed: Option<f64>,
}

impl Table4Row {
    /// The row of a hit; none where no line can be fitted.
    pub(super) fn new(hit: &Hit, viscous: ViscousTerm, step: Option<LevelStep>) -> Option<Self> {
        let slope = |dissipation: &[f64]| {
            let points = hit.curves.force.iter().zip(dissipation).filter(|(_, d)| **d > 0.0);
            straight_line(&points.map(|(f, d)| (f.ln(), d.ln())).collect::<Vec<_>>()).map(|line| line.slope)
        };
        Some(Self {
            hit: hit.force,
            force: Span::ends(&hit.curves.force),
            slope: slope(&hit.curves.dissipation)?,
            slope_without_viscous: slope(&hit.without(viscous))?,
            step: step.map(|s| s.total),
            step_without_viscous: step.map(|s| s.friction),
            printed: TABLE_4
                .iter()
                .find(|p| (p[0] * HITS[HITS.len() - 1] - hit.force).abs() < 1e-9)
                .map(|p| p[1]),
        })
    }
}
