//! Outer faces of a mesh, and geometry of a face of an element: nodes, shape functions, nearest point and area.

use std::collections::BTreeMap;

use super::topology::Mesh;

/// A face of an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Face {
    /// Index of the element.
    pub element: usize,
    /// Number of the face, from 0, in the order of the faces of the element's shape.
    pub side: usize,
}

/// A point of a face, nearest to a given point.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Foot {
    /// Values of the shape functions, in the order of [`Face::nodes`].
    pub(crate) values: Vec<f64>,
    pub(crate) position: [f64; 3],
    /// Distance from the given point.
    pub(crate) distance: f64,
}

impl Face {
    /// Indices of the nodes: corners, counter-clockwise when seen from outside, then the mid-edge nodes if the element has any.
    ///
    /// # Panics
    /// When the element has no face of this number.
    ///
    /// ```
    /// use iwan_fem::mesh::{Face, block::{block, uniform}};
    /// let mesh = block(&[uniform(0.0, 1.0, 1), uniform(0.0, 1.0, 1), uniform(0.0, 1.0, 1)]);
    /// let bottom = Face { element: 0, side: 0 }.nodes(&mesh);
    /// assert!(bottom.iter().all(|node| mesh.positions[*node][2] == 0.0));
    /// ```
    #[must_use]
    pub fn nodes(&self, mesh: &Mesh) -> Vec<usize> {
        let element = &mesh.elements[self.element];
        let corners = element.shape.faces().nth(self.side).expect("a side of the element");
        let mut nodes: Vec<usize> = corners.iter().map(|corner| element.nodes[*corner]).collect();
        if element.shape.has_middles() {
            for (at, a) in corners.iter().enumerate() {
                let b = corners[(at + 1) % corners.len()];
                let edges = element.shape.edges();
                let edge = edges.iter().position(|edge| *edge == (*a, b) || *edge == (b, *a));
                nodes.push(element.nodes[element.shape.corners() + edge.expect("an edge of the face")]);
            }
        }
        nodes
    }

    /// Share of each node in the area of the face: the integral of its shape function, ∫N_i dA.
    pub(crate) fn tributary(&self, mesh: &Mesh) -> Vec<(usize, f64)> {
        let nodes = self.nodes(mesh);
        let positions: Vec<[f64; 3]> = nodes.iter().map(|n| mesh.positions[*n]).collect();
        let mut areas = vec![0.0; nodes.len()];
        for (at, weight) in rule(nodes.len()) {
            let (values, slopes) = functions(nodes.len(), at);
            let [x, y] = tangents(&slopes, &positions);
            let area = weight * length(cross(x, y));
            areas.iter_mut().zip(&values).for_each(|(sum, value)| *sum += area * value);
        }
        nodes.into_iter().zip(areas).collect()
    }

    /// Point of the face, edges included, that is nearest to `point`; none if the face is degenerate (its two tangents are parallel).
    pub(crate) fn nearest(&self, mesh: &Mesh, point: [f64; 3]) -> Option<Foot> {
        let nodes = self.nodes(mesh);
        let positions: Vec<[f64; 3]> = nodes.iter().map(|n| mesh.positions[*n]).collect();
        let mut at = start(nodes.len());
        // Gauss-Newton steps to the foot of the perpendicular, kept inside the face. On a plane face with straight edges two steps are
        // exact.
        for _ in 0..50 {
            let (values, slopes) = functions(nodes.len(), at);
            let gap = minus(point, interpolate(&values, &positions));
            let [x, y] = tangents(&slopes, &positions);
            let (a, b, c) = (dot(x, x), dot(x, y), dot(y, y));
            let (p, q) = (dot(x, gap), dot(y, gap));
            let determinant = a * c - b * b;
            if determinant.is_nan() || determinant <= 1e-12 * a * c {
                return None;
            }
            let step = [(c * p - b * q) / determinant, (a * q - b * p) / determinant];
            let next = inside(nodes.len(), [at[0] + step[0], at[1] + step[1]]);
            let moved = (next[0] - at[0]).abs().max((next[1] - at[1]).abs());
            at = next;
            if moved < 1e-14 {
                break;
            }
        }
        let (values, _) = functions(nodes.len(), at);
        let position = interpolate(&values, &positions);
        Some(Foot { values, position, distance: length(minus(point, position)) })
    }
}

impl Mesh {
    /// Outer faces: the index of the element, and the indices of the nodes at the corners, counter-clockwise when seen from outside. A
    /// triangle repeats its third corner as the fourth.
    ///
    /// ```
    /// use iwan_fem::mesh::block::{block, uniform};
    /// let mesh = block(&[uniform(0.0, 4.0, 4), uniform(0.0, 2.0, 2), uniform(0.0, 1.0, 1)]);
    /// assert_eq!(mesh.outer_faces().len(), 2 * (4 * 2 + 4 + 2));
    /// ```
    #[must_use]
    pub fn outer_faces(&self) -> Vec<(usize, [usize; 4])> {
        let mut seen: BTreeMap<[usize; 4], Option<(usize, [usize; 4])>> = BTreeMap::new();
        for (index, element) in self.elements.iter().enumerate() {
            for face in element.shape.faces() {
                let corner = |at: usize| element.nodes[face[at.min(face.len() - 1)]];
                let corners: [usize; 4] = std::array::from_fn(corner);
                let mut key = corners;
                key.sort_unstable();
                // A face that two elements share is inside. For triangles the key leaves out the repeated corner, which may differ between
                // the two elements.
                if face.len() == 3 {
                    key = [corners[0], corners[1], corners[2], usize::MAX];
                    key.sort_unstable();
                }
                seen.entry(key).and_modify(|entry| *entry = None).or_insert(Some((index, corners)));
            }
        }
        seen.into_values().flatten().collect()
    }

    /// Outer faces whose corners all belong to a set of nodes (indices, ascending).
    pub(crate) fn faces_within(&self, nodes: &[usize]) -> Vec<Face> {
        let all = |corners: &[usize]| corners.iter().all(|n| nodes.binary_search(n).is_ok());
        let outer = self.outer_faces().into_iter().filter(|(_, corners)| all(corners));
        let side = |(element, corners): (usize, [usize; 4])| {
            let of = &self.elements[element];
            let same = |face: &[usize]| {
                face.iter().all(|c| corners.contains(&of.nodes[*c]))
                    && corners.iter().all(|n| face.iter().any(|c| of.nodes[*c] == *n))
            };
            of.shape.faces().position(same).map(|side| Face { element, side })
        };
        let mut faces: Vec<Face> = outer.filter_map(side).collect();
        faces.sort_unstable();
        faces
    }
}

/// Whether a face with this number of nodes (3 or 6) is a triangle (ξ, η >= 0, ξ + η <= 1); other faces are squares (-1 <= ξ, η <= 1).
fn is_triangle(nodes: usize) -> bool {
    matches!(nodes, 3 | 6)
}

fn start(nodes: usize) -> [f64; 2] {
    if is_triangle(nodes) { [1.0 / 3.0; 2] } else { [0.0; 2] }
}

/// The point of the reference face that is nearest to the given point.
fn inside(nodes: usize, [x, y]: [f64; 2]) -> [f64; 2] {
    if !is_triangle(nodes) {
        return [x.clamp(-1.0, 1.0), y.clamp(-1.0, 1.0)];
    }
    let (x, y) = (x.max(0.0), y.max(0.0));
    if x + y <= 1.0 {
        return [x, y];
    }
    let along = (0.5 * (1.0 + x - y)).clamp(0.0, 1.0);
    [along, 1.0 - along]
}

/// Shape functions and their derivatives with respect to ξ and η; corners first.
fn functions(nodes: usize, [x, y]: [f64; 2]) -> (Vec<f64>, Vec<[f64; 2]>) {
    if is_triangle(nodes) { triangle(nodes, [x, y]) } else { square(nodes, [x, y]) }
}

fn triangle(nodes: usize, [x, y]: [f64; 2]) -> (Vec<f64>, Vec<[f64; 2]>) {
    let l = [1.0 - x - y, x, y];
    let d = [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]];
    if nodes == 3 {
        return (l.to_vec(), d.to_vec());
    }
    let (mut values, mut slopes) = (Vec::new(), Vec::new());
    for i in 0..3 {
        values.push(l[i] * (2.0 * l[i] - 1.0));
        slopes.push(d[i].map(|s| (4.0 * l[i] - 1.0) * s));
    }
    for i in 0..3 {
        let j = (i + 1) % 3;
        values.push(4.0 * l[i] * l[j]);
        slopes.push(std::array::from_fn(|k| 4.0 * (l[i] * d[j][k] + l[j] * d[i][k])));
    }
    (values, slopes)
}

fn square(nodes: usize, [x, y]: [f64; 2]) -> (Vec<f64>, Vec<[f64; 2]>) {
    const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let (mut values, mut slopes) = (Vec::new(), Vec::new());
    for [a, b] in CORNERS {
        let (p, q) = (1.0 + a * x, 1.0 + b * y);
        let extra = if nodes == 8 { a * x + b * y - 1.0 } else { 1.0 };
        let grows = if nodes == 8 { 1.0 } else { 0.0 };
        values.push(0.25 * p * q * extra);
        slopes.push([0.25 * a * q * (extra + grows * p), 0.25 * b * p * (extra + grows * q)]);
    }
    if nodes == 8 {
        for i in 0..4 {
            let ([a, b], [c, d]) = (CORNERS[i], CORNERS[(i + 1) % 4]);
            if b == d {
                values.push(0.5 * (1.0 - x * x) * (1.0 + b * y));
                slopes.push([-x * (1.0 + b * y), 0.5 * b * (1.0 - x * x)]);
            } else {
                debug_assert_eq!(a, c);
                values.push(0.5 * (1.0 + a * x) * (1.0 - y * y));
                slopes.push([0.5 * a * (1.0 - y * y), -y * (1.0 + a * x)]);
            }
        }
    }
    (values, slopes)
}

/// Points and weights of the quadrature, exact for the shape functions of plane faces with straight edges.
fn rule(nodes: usize) -> Vec<([f64; 2], f64)> {
    if is_triangle(nodes) {
        let (a, b) = (1.0 / 6.0, 2.0 / 3.0);
        return vec![([a, a], a), ([b, a], a), ([a, b], a)];
    }
    let line =
        [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];
    line.iter().flat_map(|(y, b)| line.iter().map(move |(x, a)| ([*x, *y], a * b))).collect()
}

fn interpolate(values: &[f64], positions: &[[f64; 3]]) -> [f64; 3] {
    std::array::from_fn(|a| values.iter().zip(positions).map(|(v, p)| v * p[a]).sum())
}

fn tangents(slopes: &[[f64; 2]], positions: &[[f64; 3]]) -> [[f64; 3]; 2] {
    std::array::from_fn(|k| {
        std::array::from_fn(|a| slopes.iter().zip(positions).map(|(s, p)| s[k] * p[a]).sum())
    })
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn length(v: [f64; 3]) -> f64 {
    dot(v, v).sqrt()
}
