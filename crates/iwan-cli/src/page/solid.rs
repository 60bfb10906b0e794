//! Pictures of meshes: the outer faces in parallel projection, shaded and drawn from back to front. A mesh of nodes without elements, as matrices of
//! another program give it, is drawn as dots.

use std::fmt::Write;

use iwan_fem::mesh::Mesh;
use maud::{Markup, PreEscaped, html};

/// Width of a drawing, in its own units: the width of a figure, beside which it stands.
const WIDTH: f64 = 600.0;
/// Margin around the mesh, within which the lines at its edge (0.35 wide in style.css) stay.
const MARGIN: f64 = 12.0;
/// Largest height of a drawing over its width: a cube is drawn smaller, so that picture and caption fit on a screen.
const HIGHEST: f64 = 0.75;
/// Direction from which the light comes, a unit vector to 0.3 %, in the view (x to the right, y up, z to the viewer): from above the viewer's left
/// shoulder, where readers expect it. Faces on top are brightest.
const LIGHT: [f64; 3] = [-0.35, 0.65, 0.67];
/// Brightness of a face that the light does not reach: its colour remains recognisable.
const SHADE: f64 = 0.62;
/// Brightness that full light adds; colour values are cut off at 255.
const SHINE: f64 = 0.40;
/// Rotation of the view about the vertical, degrees: the long side runs to the right, and the end is visible beside it.
const AZIMUTH: f64 = 30.0;
/// Elevation from which the view looks down, degrees: the top is visible. Both angles are a matter of taste, from 20 to 40.
const ELEVATION: f64 = 28.0;

/// Most dots in a picture of nodes without elements: this many already touch each other. Of more nodes only every second, third, ... is drawn.
const MOST_DOTS: usize = 4000;

/// A mesh that is ready to be drawn, deformed or not.
#[derive(Debug)]
pub(crate) struct Solid<'a> {
    mesh: &'a Mesh,
    /// Outer faces: element and corners.
    faces: Vec<(usize, [usize; 4])>,
    /// Rows of the view matrix: to the right, up, to the viewer.
    view: [[f64; 3]; 3],
    /// Diagonal of the bounding box of the mesh.
    diagonal: f64,
}

/// Colour of a face: red, green, blue, 0 to 255.
pub(crate) type Colour = [f64; 3];

/// How a mesh is drawn in deformed shape.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Deformation<'a> {
    /// x, y, z of each node, in any scale.
    pub(crate) shape: &'a [f64],
    /// Largest displacement in the picture, as a part of the mesh's diagonal.
    pub(crate) part: f64,
}

impl<'a> Solid<'a> {
    /// Finds the outer faces and a view in which the longest side runs from left to right.
    pub(crate) fn new(mesh: &'a Mesh) -> Self {
        let sides: [f64; 3] = std::array::from_fn(|axis| {
            let along = mesh.positions.iter().map(|p| p[axis]);
            along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min)
        });
        let diagonal = sides.iter().map(|s| s * s).sum::<f64>().sqrt();
        Self { mesh, faces: mesh.outer_faces(), view: view(sides), diagonal }
    }

    /// Number of pieces of which a picture consists: outer faces, or dots where there are no faces.
    pub(crate) fn pieces(&self) -> usize {
        if self.faces.is_empty() { self.dotted().count() } else { self.faces.len() }
    }

    /// The nodes that are drawn as dots where the mesh has no faces; none where no coordinates are known, so that all nodes coincide.
    fn dotted(&self) -> impl Iterator<Item = usize> + use<> {
        let nodes = if self.faces.is_empty() && self.diagonal > 0.0 { self.mesh.positions.len() } else { 0 };
        (0..nodes).step_by(nodes.div_ceil(MOST_DOTS).max(1))
    }

    /// The picture, deformed or not. `colour` gives the colour of a face from its element and the corners of the face; for a dot it receives element
    /// 0 and four times the node. A line joins each dot to its position at rest.
    pub(crate) fn draw(
        &self,
        deformation: Option<Deformation<'_>>,
        title: &str,
        colour: &dyn Fn(usize, [usize; 4]) -> Colour,
    ) -> Markup {
        if self.pieces() == 0 {
            return html! { p { "Nothing is drawn: the nodes have no coordinates." } };
        }
        let (places, rest) = (self.places(deformation), self.places(None));
        let resting = self.dotted().map(|node| &rest[node]);
        let (low, high) = bounds(places.iter().chain(resting));
        let scale = ((WIDTH - 2.0 * MARGIN) / (high[0] - low[0]).max(f64::MIN_POSITIVE))
            .min((HIGHEST * WIDTH - 2.0 * MARGIN) / (high[1] - low[1]).max(f64::MIN_POSITIVE));
        let height = scale * (high[1] - low[1]) + 2.0 * MARGIN;
        let left = 0.5 * (WIDTH - scale * (high[0] - low[0]));
        let on_page = |p: [f64; 3]| [left + scale * (p[0] - low[0]), MARGIN + scale * (high[1] - p[1])];
        let mut faces: Vec<(f64, usize)> = (0..self.faces.len())
            .filter_map(|face| {
                let corners = self.faces[face].1.map(|node| places[node]);
                // Faces that look away from the viewer are hidden by others and left out.
                (normal(corners)[2] > 0.0).then(|| (corners.iter().map(|c| c[2]).sum::<f64>(), face))
            })
            .collect();
        faces.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut paths = String::new();
        for (_, face) in faces {
            let (element, corners) = self.faces[face];
            let shade = shade(normal(corners.map(|node| places[node])));
            let fill = colour(element, corners).map(|c| (c * shade).clamp(0.0, 255.0) as u8);
            let [a, b, c, d] = corners.map(|node| on_page(places[node]));
            // Writing to a string cannot fail.
            let _ = write!(
                paths,
                "<path fill=\"#{:02x}{:02x}{:02x}\" d=\"M{:.1} {:.1}L{:.1} {:.1} {:.1} {:.1} {:.1} {:.1}Z\"/>",
                fill[0], fill[1], fill[2], a[0], a[1], b[0], b[1], c[0], c[1], d[0], d[1]
            );
        }
        for node in self.dotted() {
            let fill = colour(0, [node; 4]).map(|c| c as u8);
            let ([x, y], [u, v]) = (on_page(places[node]), on_page(rest[node]));
            let _ = write!(
                paths,
                "<path d=\"M{u:.1} {v:.1}L{x:.1} {y:.1}\"/><circle fill=\"#{:02x}{:02x}{:02x}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\"/>",
                fill[0], fill[1], fill[2]
            );
        }
        let box_ = format!("0 0 {WIDTH} {height:.0}");
        html! {
            svg.solid viewBox=(box_) role="img" aria-label=(title) { (PreEscaped(paths)) }
        }
    }

    /// Positions of the nodes in the view, deformed or not.
    fn places(&self, deformation: Option<Deformation<'_>>) -> Vec<[f64; 3]> {
        let largest = |shape: &[f64]| shape.chunks_exact(3).map(length).fold(f64::MIN_POSITIVE, f64::max);
        let factor = deformation.map_or(0.0, |d| d.part * self.diagonal / largest(d.shape));
        let moved = |node: usize, axis: usize| {
            let by = deformation.map_or(0.0, |d| factor * d.shape[3 * node + axis]);
            self.mesh.positions[node][axis] + by
        };
        (0..self.mesh.positions.len())
            .map(|node| self.view.map(|row| (0..3).map(|axis| row[axis] * moved(node, axis)).sum()))
            .collect()
    }
}

/// Length of a vector.
pub(crate) fn length(vector: &[f64]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Colour for a share from 0 to 1: blue through pale blue and pale orange to red.
pub(crate) fn by_share(share: f64) -> Colour {
    // Dark at both ends and pale between, so that the shading remains visible; all readers can tell blue from red-orange.
    const STOPS: [Colour; 4] =
        [[68.0, 119.0, 170.0], [190.0, 215.0, 230.0], [245.0, 205.0, 120.0], [213.0, 94.0, 0.0]];
    let place = share.clamp(0.0, 1.0) * (STOPS.len() - 1) as f64;
    let from = (place.floor() as usize).min(STOPS.len() - 2);
    let rest = place - from as f64;
    std::array::from_fn(|i| STOPS[from][i] * (1.0 - rest) + STOPS[from + 1][i] * rest)
}

/// An axonometric view from the front, right and above: the longest side of the mesh runs to the right, the shortest upwards.
fn view(sides: [f64; 3]) -> [[f64; 3]; 3] {
    let mut order = [0, 1, 2];
    order.sort_by(|a, b| sides[*b].total_cmp(&sides[*a]));
    // An odd permutation of the axes would mirror the mesh: the middle axis is then reversed.
    let even = matches!(order, [0, 1, 2] | [1, 2, 0] | [2, 0, 1]);
    let turn = if even { 1.0 } else { -1.0 };
    let (azimuth, elevation) = (AZIMUTH.to_radians(), ELEVATION.to_radians());
    let (sa, ca, se, ce) = (azimuth.sin(), azimuth.cos(), elevation.sin(), elevation.cos());
    let own = [[ca, sa, 0.0], [-sa * se, ca * se, ce], [sa * ce, -ca * ce, se]];
    own.map(|row| {
        let mut mixed = [0.0; 3];
        mixed[order[0]] = row[0];
        mixed[order[1]] = turn * row[1];
        mixed[order[2]] = row[2];
        mixed
    })
}

fn bounds<'p>(places: impl Iterator<Item = &'p [f64; 3]>) -> ([f64; 2], [f64; 2]) {
    places.fold(([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]), |(low, high), p| {
        ([low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])])
    })
}

/// Outward normal of a face, from its diagonals; its length has no meaning.
fn normal([a, b, c, d]: [[f64; 3]; 4]) -> [f64; 3] {
    let (p, q): ([f64; 3], [f64; 3]) =
        (std::array::from_fn(|i| c[i] - a[i]), std::array::from_fn(|i| d[i] - b[i]));
    [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
}

/// Brightness of a face by the angle between its normal and the light.
fn shade(normal: [f64; 3]) -> f64 {
    let along: f64 = normal.iter().zip(LIGHT).map(|(n, l)| n * l).sum();
    SHADE + SHINE * (along / length(&normal).max(f64::MIN_POSITIVE)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use iwan_fem::mesh::block::{block, uniform};

    #[test]
    fn only_outer_faces_that_look_at_the_viewer_are_drawn() {
        let mesh = block(&[uniform(0.0, 4.0, 4), uniform(0.0, 2.0, 2), uniform(0.0, 1.0, 1)]);
        let solid = Solid::new(&mesh);
        assert_eq!(solid.pieces(), 2 * (4 * 2 + 4 + 2));
        let drawn = solid.draw(None, "a block", &|_, _| [200.0; 3]).into_string();
        assert_eq!(drawn.matches("<path").count(), 4 * 2 + 4 + 2);
    }

    #[test]
    fn nodes_alone_are_dots() {
        let mut mesh = block(&[uniform(0.0, 4.0, 4), uniform(0.0, 2.0, 2), uniform(0.0, 1.0, 1)]);
        mesh.elements.clear();
        let nodes = mesh.positions.len();
        let shape: Vec<f64> = (0..3 * nodes).map(|n| f64::from(u8::from(n == 5))).collect();
        let solid = Solid::new(&mesh);
        let drawn = solid.draw(Some(Deformation { shape: &shape, part: 0.1 }), "nodes", &|_, corners| {
            [if corners == [1; 4] { 255.0 } else { 0.0 }, 0.0, 0.0]
        });
        let drawn = drawn.into_string();
        assert_eq!((solid.pieces(), drawn.matches("<circle").count()), (nodes, nodes));
        // Only node 1 has moved, upwards on the page; its dot alone has a line to the position at rest.
        let moved = drawn.split("<path d=\"M").skip(1).filter(|dot| {
            let (from, to) = dot.split('"').next().and_then(|d| d.split_once('L')).unwrap_or_default();
            from != to
        });
        assert_eq!(moved.map(|dot| dot.contains("#ff0000")).collect::<Vec<_>>(), [true]);
        mesh.positions.fill([0.0; 3]);
        let drawn = Solid::new(&mesh).draw(None, "nodes", &|_, _| [0.0; 3]).into_string();
        assert!(drawn.contains("no coordinates") && !drawn.contains("<svg"), "{drawn}");
    }

    #[test]
    fn every_view_is_a_rotation() {
        for sides in [[3.0, 2.0, 1.0], [1.0, 2.0, 3.0], [2.0, 3.0, 1.0], [1.0, 3.0, 2.0], [3.0, 1.0, 2.0]] {
            let [a, b, c] = view(sides);
            let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
            assert!(cross.iter().zip(c).all(|(x, y)| (x - y).abs() < 1e-14), "{sides:?}");
            assert!((length(&a) - 1.0).abs() < 1e-14 && (length(&b) - 1.0).abs() < 1e-14);
        }
    }
}
