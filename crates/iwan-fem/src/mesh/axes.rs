//! Local axes, and cylindrical and spherical coordinates.

/// Axes in which positions are given: the origin and the directions of x, y and z.
#[derive(Debug, Clone, Copy)]
pub(super) struct Axes {
    pub(super) origin: [f64; 3],
    pub(super) directions: [[f64; 3]; 3],
}

impl Default for Axes {
    fn default() -> Self {
        Self { origin: [0.0; 3], directions: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] }
    }
}

/// Two lines span no plane if the sine of the angle between them is below this; numbers of seven digits in a file leave errors of 1e-7.
const PARALLEL: f64 = 1e-6;

impl Axes {
    /// Axes with x along `along` and y in the plane of `along` and `inside`, on the side of `inside`; none if the two span no plane.
    pub(super) fn spanned(origin: [f64; 3], along: [f64; 3], inside: [f64; 3]) -> Option<Self> {
        let (x, towards) = (unit(along)?, unit(inside)?);
        let normal = cross(x, towards);
        let z = unit(normal).filter(|_| dot(normal, normal).sqrt() > PARALLEL)?;
        Some(Self { origin, directions: [x, cross(z, x), z] })
    }

    /// Global position of a point given in local coordinates.
    pub(super) fn global(&self, local: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|a| {
            self.origin[a] + (0..3).map(|k| local[k] * self.directions[k][a]).sum::<f64>()
        })
    }
}

fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let length = dot(v, v).sqrt();
    (length > 0.0 && length.is_finite()).then(|| v.map(|x| x / length))
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Meaning of the three coordinates of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Coordinates {
    Rectangular,
    /// Radius, angle in degrees, height.
    Cylindrical,
    /// Radius, angle about z and elevation in degrees.
    Spherical,
    /// Radius, angle from z and angle about z in degrees.
    Colatitude,
}

impl Coordinates {
    /// Converts the coordinates to rectangular ones.
    pub(super) fn rectangular(self, [a, b, c]: [f64; 3]) -> [f64; 3] {
        let (sin, cos) = b.to_radians().sin_cos();
        match self {
            Self::Rectangular => [a, b, c],
            Self::Colatitude => Self::Spherical.rectangular([a, c, 90.0 - b]),
            Self::Cylindrical => [a * cos, a * sin, c],
            Self::Spherical => {
                let (up, out) = c.to_radians().sin_cos();
                [a * out * cos, a * out * sin, a * up]
            }
        }
    }
}

/// Rotates a point about the line from `a` to `b` by an angle in degrees, right-handed (O. Rodrigues' formula).
pub(super) fn turned(point: [f64; 3], a: [f64; 3], b: [f64; 3], degrees: f64) -> [f64; 3] {
    let Some(axis) = unit(std::array::from_fn(|i| b[i] - a[i])) else { return point };
    let arm: [f64; 3] = std::array::from_fn(|i| point[i] - a[i]);
    let (sin, cos) = degrees.to_radians().sin_cos();
    let (spin, along) = (cross(axis, arm), dot(axis, arm));
    std::array::from_fn(|i| a[i] + arm[i] * cos + spin[i] * sin + axis[i] * along * (1.0 - cos))
}
