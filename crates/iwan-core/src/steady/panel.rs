//! Fourier integrals of force and tangent over one interval of angles, by a Gauss-Legendre rule.

use super::harmonics::{Course, MOST_HARMONICS};
use crate::law::Backbone;
use crate::memory::Branch;
use crate::quadrature::Rule;

/// Number of nodes of a stretch (an interval of angles). Sixteen fill four registers of four numbers, and integrate an oscillation of
/// [`FASTEST`] rad to rounding.
const NODES: usize = 16;
const RULE: Rule<NODES> = Rule::gauss_legendre();

/// One number per node.
type Lanes = [f64; NODES];

/// Longest stretch, rad: the nodes are then less than 0.8 from the middle, where twelve terms give their sine and cosine to rounding.
pub(super) const LONGEST: f64 = 1.6;

/// Longest stretch times the highest harmonic, rad. Force and shape together then turn by at most three times as much, without the
/// overtones that the law adds; sixteen nodes integrate that to 1e-13.
pub(super) const FASTEST: f64 = 6.0;

/// The same limit (rad) for a stretch with its nodes crowded at its start: the substitution s^4 makes the far end four times as fast.
pub(super) const FASTEST_CROWDED: f64 = 2.0;

/// Nodes and weights of the stretch [0, 1].
struct Nodes {
    at: Lanes,
    weight: Lanes,
}

/// Nodes symmetric about the middle of the stretch.
const EVEN: Nodes = {
    let (mut at, mut weight, mut i) = ([0.0; NODES], [0.0; NODES], 0);
    while i < NODES {
        (at[i], weight[i]) = (0.5 * RULE.nodes[i], 0.5 * RULE.weights[i]);
        i += 1;
    }
    Nodes { at, weight }
};

/// Nodes crowded at the start of the stretch by θ = s^4. Behind a turning point the tangent falls like θ^(2χ+2); the substitution makes the
/// integrand smooth enough for any χ > -1.
const CROWDED: Nodes = {
    let (mut at, mut weight, mut i) = ([0.0; NODES], [0.0; NODES], 0);
    while i < NODES {
        let s = 0.5 * (1.0 + RULE.nodes[i]);
        (at[i], weight[i]) = (s * s * s * s, 2.0 * s * s * s * RULE.weights[i]);
        i += 1;
    }
    Nodes { at, weight }
};

/// Weights that give the Legendre coefficients of degrees 14 and 15: they show how much of a function lies in still higher degrees.
const TAILS: [Lanes; 2] = {
    let (mut tails, mut i) = ([[0.0; NODES]; 2], 0);
    while i < NODES {
        let (mut before, mut p, mut k) = (1.0, RULE.nodes[i], 1.0);
        while k < 15.0 {
            let next = ((2.0 * k + 1.0) * RULE.nodes[i] * p - k * before) / (k + 1.0);
            before = p;
            p = next;
            k += 1.0;
        }
        tails[0][i] = 14.5 * RULE.weights[i] * before;
        tails[1][i] = 15.5 * RULE.weights[i] * p;
        i += 1;
    }
    tails
};

/// Integrals ∫ F e^(inθ) and ∫ K e^(inθ), as real and imaginary part for each harmonic.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sums {
    pub(super) force: [[f64; 2]; MOST_HARMONICS + 1],
    pub(super) tangent: [[f64; 2]; 2 * MOST_HARMONICS + 1],
}

impl Sums {
    pub(super) const ZERO: Self =
        Self { force: [[0.0; 2]; MOST_HARMONICS + 1], tangent: [[0.0; 2]; 2 * MOST_HARMONICS + 1] };

    /// Sets to zero the entries that the harmonics up to `highest` use.
    pub(super) fn clear(&mut self, highest: usize) {
        self.force[..=highest].fill([0.0; 2]);
        self.tangent[..=2 * highest].fill([0.0; 2]);
    }
}

/// An interval of angles: start and length in rad, and whether its nodes are crowded at the start.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stretch {
    pub(super) start: f64,
    pub(super) length: f64,
    pub(super) crowded: bool,
}

/// Force and tangent at the nodes of a stretch.
pub(super) struct Panel {
    /// e^(iθ), real and imaginary parts.
    turn: [Lanes; 2],
    weight: Lanes,
    force: Lanes,
    tangent: Lanes,
}

impl Panel {
    /// Evaluates force and tangent of a branch at the nodes of a stretch.
    pub(super) fn evaluate<B: Backbone>(
        law: &B,
        course: &Course<'_>,
        branch: &Branch,
        stretch: Stretch,
    ) -> Self {
        let nodes = if stretch.crowded { &CROWDED } else { &EVEN };
        let anchor = stretch.start + if stretch.crowded { 0.0 } else { 0.5 * stretch.length };
        let (sine, cosine) = libm::sincos(anchor);
        let mut panel = Self {
            turn: [[0.0; NODES]; 2],
            weight: [0.0; NODES],
            force: [0.0; NODES],
            tangent: [0.0; NODES],
        };
        for i in 0..NODES {
            let [c, s] = small_angle(stretch.length * nodes.at[i]);
            panel.turn[0][i] = cosine * c - sine * s;
            panel.turn[1][i] = sine * c + cosine * s;
            panel.weight[i] = stretch.length * nodes.weight[i];
        }
        let displacement = values(course, &panel.turn);
        for (i, &u) in displacement.iter().enumerate() {
            (panel.force[i], panel.tangent[i]) = branch.force_and_tangent(law, u);
        }
        panel
    }

    /// Sum of the absolute values of the force's last two Legendre coefficients.
    pub(super) fn tail(&self) -> f64 {
        dot(&self.force, &TAILS[0]).abs() + dot(&self.force, &TAILS[1]).abs()
    }

    /// Adds the integrals of the force up to the harmonic `highest`; if `with_tangent`, also those of the tangent up to twice `highest`.
    pub(super) fn add(&self, highest: usize, with_tangent: bool, sums: &mut Sums) {
        let [c, s] = &self.turn;
        let [mut re, mut im] = [self.weight, [0.0; NODES]];
        let top = if with_tangent { 2 * highest } else { highest };
        for n in 0..=top {
            if n <= highest {
                sums.force[n][0] += dot(&self.force, &re);
                sums.force[n][1] += dot(&self.force, &im);
            }
            if with_tangent {
                sums.tangent[n][0] += dot(&self.tangent, &re);
                sums.tangent[n][1] += dot(&self.tangent, &im);
            }
            for i in 0..NODES {
                let next = re[i] * c[i] - im[i] * s[i];
                im[i] = re[i] * s[i] + im[i] * c[i];
                re[i] = next;
            }
        }
    }
}

/// The displacements at the nodes.
fn values(course: &Course<'_>, turn: &[Lanes; 2]) -> Lanes {
    let [c, s] = turn;
    let (odd, step) = (course.harmonics.is_odd(), course.harmonics.step());
    let mut step_c = *c;
    let mut step_s = *s;
    if step == 2 {
        for i in 0..NODES {
            (step_c[i], step_s[i]) = (c[i] * c[i] - s[i] * s[i], 2.0 * c[i] * s[i]);
        }
    }
    let (mut re, mut im) = (*c, *s);
    let mut value = [if odd { 0.0 } else { course.coefficients[0] }; NODES];
    for pair in course.coefficients[usize::from(!odd)..].chunks_exact(2) {
        for i in 0..NODES {
            value[i] += pair[0] * re[i] + pair[1] * im[i];
            let next = re[i] * step_c[i] - im[i] * step_s[i];
            im[i] = re[i] * step_s[i] + im[i] * step_c[i];
            re[i] = next;
        }
    }
    value
}

/// Cosine and sine of an angle up to 0.8 rad by their Taylor series up to the powers 16 and 17 (the terms left out are below 0.8^18/18! =
/// 3e-18). The compiler can do this plain arithmetic for several nodes at once.
#[inline]
fn small_angle(x: f64) -> [f64; 2] {
    let y = -x * x;
    let mut cosine = 1.0;
    let mut sine = 1.0;
    let mut k = 16.0;
    while k > 0.0 {
        cosine = 1.0 + cosine * y * (1.0 / (k * (k - 1.0)));
        sine = 1.0 + sine * y * (1.0 / (k * (k + 1.0)));
        k -= 2.0;
    }
    [cosine, x * sine]
}

/// The sum of products, in four partial sums: the order of summation is fixed, and four products are made at once.
#[inline]
fn dot(a: &Lanes, b: &Lanes) -> f64 {
    let mut sums = [0.0; 4];
    for (x, y) in a.chunks_exact(4).zip(b.chunks_exact(4)) {
        for i in 0..4 {
            sums[i] += x[i] * y[i];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}
