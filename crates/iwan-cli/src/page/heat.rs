//! A figure of shaded cells: a quantity over two axes.

use std::fmt::Write;

use maud::{Markup, html};

use super::figure::{Axis, BOTTOM, HEIGHT, LEFT, Plane, RIGHT, TOP, WIDTH, grid};
use super::scale::Scale;

/// Shades from low to high values: dark enough to be told apart by all readers and in print, and as light as paper for low values. More shades would
/// make the drawing larger without a visible gain.
const SHADES: [&str; 10] = [
    "#f2f7fb", "#dcebf5", "#c3dded", "#a4cbe2", "#7fb5d6", "#5a9cc8", "#3a82b7", "#2167a1", "#114c83",
    "#08305e",
];

/// Shaded cells over two axes.
#[derive(Debug, Clone)]
pub(crate) struct HeatMap {
    pub(crate) title: String,
    /// What the figure shows, as text below it.
    pub(crate) caption: String,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    /// Ends of the axis of x.
    pub(crate) across: (f64, f64),
    /// Ends of the axis of y.
    pub(crate) up: (f64, f64),
    /// `values[column][row]` from 0 (light) to 1 (dark), rows from below; all columns equally long.
    pub(crate) values: Vec<Vec<f64>>,
    /// Two values on the axis of y that are marked by lines, as the edges of a frequency band.
    pub(crate) band: Option<(f64, f64)>,
    /// Meaning of the lightest and the darkest shade.
    pub(crate) ends: (String, String),
}

impl HeatMap {
    /// The figure with its caption.
    pub(crate) fn draw(&self) -> Markup {
        let ends = |(low, high): (f64, f64)| [low, high].into_iter();
        let plane = Plane {
            x: Scale::around(self.x.spread, ends(self.across), false),
            y: Scale::around(self.y.spread, ends(self.up), false),
        };
        let (x_ticks, y_ticks) = plane.ticks();
        let before = y_ticks.room_before();
        html! {
            figure {
                figcaption { strong { (self.title) } }
                svg viewBox=(format!("{} 0 {} {HEIGHT}", -before, WIDTH + before)) role="img" aria-label=(self.title) {
                    (self.cells())
                    @if let Some((low, high)) = self.band {
                        @for edge in [low, high] {
                            @let y = format!("{:.1}", plane.y(edge));
                            line.edge x1=(LEFT) x2=(RIGHT) y1=(y) y2=(y) {}
                        }
                    }
                    (grid(&plane, &x_ticks, &y_ticks, false))
                    rect class="frame" x=(LEFT) y=(TOP) width=(RIGHT - LEFT) height=(BOTTOM - TOP) {}
                    (Axis::titles(&self.x, &self.y, x_ticks.exponent, y_ticks.exponent, before))
                    (self.legend())
                }
                p.caption { (self.caption) }
            }
        }
    }

    /// One path for each shade, made of runs of equal cells along the rows.
    fn cells(&self) -> Markup {
        let columns = self.values.len().max(1);
        let rows = self.values.first().map_or(1, Vec::len).max(1);
        let mut paths = vec![String::new(); SHADES.len()];
        for row in 0..rows {
            let shade = |column: usize| shade(self.values[column].get(row).copied().unwrap_or(0.0));
            let mut from = 0;
            for column in 1..=self.values.len() {
                if column < self.values.len() && shade(column) == shade(from) {
                    continue;
                }
                // Writing to a string cannot fail.
                let width = column - from;
                let _ = write!(paths[shade(from)], "M{from} {row}h{width}v1h-{width}z");
                from = column;
            }
        }
        let (x, y) = ((RIGHT - LEFT) / columns as f64, (BOTTOM - TOP) / rows as f64);
        let placed = format!("translate({LEFT} {BOTTOM}) scale({x:.6} {:.6})", -y);
        html! {
            g transform=(placed) shape-rendering="crispEdges" {
                @for (d, colour) in paths.iter().zip(SHADES) {
                    @if !d.is_empty() { path d=(d) fill=(colour) {} }
                }
            }
        }
    }

    fn legend(&self) -> Markup {
        let width = 16.0;
        let right = RIGHT - 7.3 * self.ends.1.chars().count() as f64 - 6.0;
        let left = right - width * SHADES.len() as f64;
        html! {
            text.key x=(format!("{:.1}", left - 6.0)) y=(TOP - 9.0) text-anchor="end" { (self.ends.0) }
            @for (n, colour) in SHADES.iter().enumerate() {
                rect x=(format!("{:.1}", left + width * n as f64)) y=(TOP - 19.0) width=(width) height="11" fill=(colour) {}
            }
            text.key x=(RIGHT) y=(TOP - 9.0) text-anchor="end" { (self.ends.1) }
        }
    }
}

/// The shade of a value from 0 to 1.
fn shade(value: f64) -> usize {
    ((value * SHADES.len() as f64).max(0.0) as usize).min(SHADES.len() - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_cells_are_drawn_as_one_and_all_are_covered() {
        let map = HeatMap {
            title: "a".into(),
            caption: String::new(),
            x: Axis::linear("time", "s"),
            y: Axis::linear("frequency", "Hz"),
            across: (0.0, 1.0),
            up: (0.0, 2.0),
            values: vec![vec![0.0, 1.0], vec![0.0, 0.5], vec![0.0, f64::NAN]],
            band: Some((0.5, 1.0)),
            ends: ("low".into(), "high".into()),
        };
        let drawn = map.cells().into_string();
        assert!(drawn.contains("M0 0h3v1h-3z") && drawn.contains("M0 1h1v1h-1z"), "{drawn}");
        assert_eq!(drawn.matches('z').count(), 4);
        assert_eq!((shade(-1.0), shade(1.0), shade(0.55)), (0, 9, 5));
        assert_eq!(map.draw().into_string().matches("class=\"edge\"").count(), 2);
    }
}
