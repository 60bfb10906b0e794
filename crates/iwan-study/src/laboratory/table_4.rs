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
    /// Modal forces at the beginning and the end of the record, √kg·m/s²: between them the slope was taken.
    pub force: Span,
    /// Slope of the dissipation as measured.
    pub slope: f64,
    /// Slope of what is left when the viscous term is taken off.
    pub slope_without_viscous: f64,
    /// From the softer hit to this one at equal times; none for the softest.
    pub step: Option<f64>,
    /// The same without the viscous term.
    pub step_without_viscous: Option<f64>,
    /// Slope as printed for this level over the hardest; none where the paper has no such level.
    pub printed: Option<f64>,
}

impl Table4Row {
    /// Of a hit; none where a line cannot be laid.
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
