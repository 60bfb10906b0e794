//! Nodes, directions there, and mode shapes at them.

use std::fmt;

/// Node and direction of a response or a force; directions are 0 (none), ±1 to ±3 along x, y, z, ±4 to ±6 about them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct NodalDirection {
    /// Number of the node.
    pub node: i64,
    /// Direction, -6 to 6.
    pub direction: i64,
}

/// Written as in `12:+z`; the node alone where there is no direction.
impl fmt::Display for NodalDirection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const AXES: [&str; 7] = ["", "x", "y", "z", "rx", "ry", "rz"];
        let axis = usize::try_from(self.direction.unsigned_abs()).ok().and_then(|n| AXES.get(n));
        match (self.direction, axis) {
            (0, _) | (_, None) => write!(f, "{}", self.node),
            (d, Some(axis)) => write!(f, "{}:{}{axis}", self.node, if d < 0 { '-' } else { '+' }),
        }
    }
}

/// A point of a structure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// Number, > 0.
    pub number: i64,
    /// Coordinates x, y, z, in the file's unit of length.
    pub position: [f64; 3],
}

/// Complex values (re, im) along x, y, z.
pub type NodalValues = [[f64; 2]; 3];

/// How the values of a mode shape are scaled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ModalScale {
    /// The file does not say.
    Unknown,
    /// Real shapes with this modal mass.
    Mass(f64),
    /// Complex shapes ψ with modal A (re, im): receptances are ψ ψᵀ/(A (s - λ)) and the conjugates.
    A([f64; 2]),
}

/// A mode shape at nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct NodalMode {
    /// Frequency, Hz.
    pub frequency: f64,
    /// Ratio of critical damping.
    pub damping_ratio: f64,
    /// Pole (real, imaginary), 1/s.
    pub pole: [f64; 2],
    /// How the values are scaled.
    pub scale: ModalScale,
    /// For each node its number and complex values (re, im) along x, y, z.
    pub values: Vec<(i64, NodalValues)>,
}

impl NodalMode {
    /// The values of the mass-normalised shape, for which modal A is 2i ω_d and the modal mass is 1; none where the file does not state the
    /// scale.
    ///
    /// ```
    /// use iwan_io::write_uff::{ModalScale, NodalMode};
    /// let mode = NodalMode {
    ///     frequency: 1.0, damping_ratio: 0.0, pole: [0.0, 6.283], scale: ModalScale::Mass(4.0), values: vec![(7, [[0.0; 2], [0.0; 2], [3.0, 0.0]])],
    /// };
    /// assert_eq!(mode.mass_normalised().unwrap()[0].1[2], [1.5, 0.0]);
    /// ```
    #[must_use]
    pub fn mass_normalised(&self) -> Option<Vec<(i64, NodalValues)>> {
        let [re, im] = match self.scale {
            ModalScale::Unknown => return None,
            ModalScale::Mass(mass) => [mass.sqrt().recip(), 0.0],
            ModalScale::A(a) => {
                // The square root of 2i ω_d/a, of the two roots the one that turns the phase least.
                let size = (2.0 * self.pole[1] / a[0].hypot(a[1])).sqrt();
                let angle = 0.5 * (std::f64::consts::FRAC_PI_2 - a[1].atan2(a[0]));
                [size * angle.cos(), size * angle.sin()]
            }
        };
        let turned = |[x, y]: [f64; 2]| [x * re - y * im, x * im + y * re];
        Some(self.values.iter().map(|(node, values)| (*node, values.map(turned))).collect())
    }
}
