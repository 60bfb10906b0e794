//! The speed within a half cycle, as a function of the phase θ: y = ½L (1 - cos θ), y' = ½L sin θ · Ω(θ).

use core::f64::consts::PI;

use crate::quadrature::Rule;

/// Nodes of the quadrature in the phase, per panel.
pub(crate) const NODES: usize = 12;
/// Panels of a half cycle: below, between and above the weakest and the strongest slider.
pub(crate) const PANELS: usize = 3;
pub(crate) const RULE: Rule<NODES> = Rule::gauss_legendre();
pub(crate) const MATRIX: [[f64; NODES]; NODES] = RULE.integration_matrix();

/// A stretch of the phase on which Ω is smooth, with Ω at the nodes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Panel {
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) omega: [f64; NODES],
}

impl Panel {
    pub(crate) const WHOLE: Self = Self { from: 0.0, to: PI, omega: [0.0; NODES] };

    pub(crate) fn half_width(&self) -> f64 {
        0.5 * (self.to - self.from)
    }

    /// Phase of node `i`.
    pub(crate) fn phase(&self, i: usize) -> f64 {
        self.from + self.half_width() * (1.0 + RULE.nodes[i])
    }

    /// ∫dθ/Ω.
    pub(crate) fn duration(&self) -> f64 {
        self.half_width() * RULE.weights.iter().zip(&self.omega).map(|(w, o)| w / o).sum::<f64>()
    }

    /// Time from the start of the panel to the phase `theta`, and Ω there, from the polynomial through
    /// the 1/Ω at the nodes (in Legendre form).
    fn time_at(&self, theta: f64) -> (f64, f64) {
        let x = (theta - self.from) / self.half_width() - 1.0;
        let (mut time, mut slowness) = (0.0, 0.0);
        // Legendre polynomials at x, and at the nodes for the coefficients.
        let (mut p, mut below) = (1.0, 0.0);
        let (mut at, mut before) = ([1.0; NODES], [0.0; NODES]);
        for k in 0..NODES {
            let (order, double) = (k as f64, 2.0 * k as f64 + 1.0);
            let sum: f64 = (0..NODES).map(|j| RULE.weights[j] * at[j] / self.omega[j]).sum();
            let above = (double * x * p - order * below) / (order + 1.0);
            let lower = if k == 0 { -1.0 } else { below };
            slowness += 0.5 * double * sum * p;
            time += 0.5 * sum * (above - lower);
            for j in 0..NODES {
                let next = (double * RULE.nodes[j] * at[j] - order * before[j]) / (order + 1.0);
                (before[j], at[j]) = (at[j], next);
            }
            (below, p) = (p, above);
        }
        (self.half_width() * time, 1.0 / slowness)
    }
}

/// Ω over a whole half cycle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Phase {
    panels: [Panel; PANELS],
    used: usize,
}

impl Phase {
    /// A half cycle in one panel.
    pub(crate) const fn single(omega: [f64; NODES]) -> Self {
        Self { panels: [Panel { omega, ..Panel::WHOLE }; PANELS], used: 1 }
    }

    /// Panels between the phases `first` and `last`; slivers go to their neighbours.
    pub(crate) fn cut(first: f64, last: f64) -> Self {
        const SLIVER: f64 = 1e-6;
        let mut phase = Self::single([0.0; NODES]);
        let mut start = 0.0;
        phase.used = 0;
        for end in [first, last] {
            if end - start > SLIVER && PI - end > SLIVER {
                phase.panels[phase.used] = Panel { from: start, to: end, ..Panel::WHOLE };
                phase.used += 1;
                start = end;
            }
        }
        phase.panels[phase.used].from = start;
        phase.used += 1;
        phase
    }

    pub(crate) fn panels_mut(&mut self) -> &mut [Panel] {
        &mut self.panels[..self.used]
    }

    fn panels(&self) -> &[Panel] {
        &self.panels[..self.used]
    }

    pub(crate) fn duration(&self) -> f64 {
        self.panels().iter().map(Panel::duration).sum()
    }

    /// Phase and Ω at the time `t` after the start, by Newton's method on a function that is all but straight.
    pub(crate) fn at(&self, t: f64) -> (f64, f64) {
        let mut left = t;
        let mut panel = &self.panels[0];
        let mut duration = panel.duration();
        for next in &self.panels()[1..] {
            if left <= duration {
                break;
            }
            left -= duration;
            (panel, duration) = (next, next.duration());
        }
        let mut theta = panel.from + (panel.to - panel.from) * (left / duration).clamp(0.0, 1.0);
        let mut omega = 0.0;
        for _ in 0..8 {
            let (time, rate) = panel.time_at(theta);
            let step = (left - time) * rate;
            (theta, omega) = (theta + step, rate);
            if libm::fabs(step) < 1e-9 {
                break;
            }
        }
        (theta, omega)
    }
}
