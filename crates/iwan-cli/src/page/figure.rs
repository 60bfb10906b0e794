//! A figure as inline SVG with real text.

use std::fmt::Write;

use maud::{Markup, html};

use super::scale::{Scale, Spread, Ticks, superscript};

/// Colours of Okabe and Ito, which colour-blind readers can tell apart, too.
pub(crate) mod colour {
    /// Colours of curves side by side, in turn. Behind those of Okabe and Ito stand three dark ones of Tol's "muted" scheme.
    const SERIES: [&str; 9] =
        [BLUE, VERMILLION, GREEN, PURPLE, ORANGE, "#56B4E9", "#882255", "#999933", "#332288"];

    /// Colour of curve `n` of several; the tenth has the first colour again.
    pub(crate) const fn of(n: usize) -> &'static str {
        SERIES[n % SERIES.len()]
    }

    /// Colour of curve `n` of several beside one in the colour `taken`; the ninth has the first colour again.
    pub(crate) fn beside(taken: &str, n: usize) -> &'static str {
        let mut others = SERIES.into_iter().filter(|colour| *colour != taken).cycle();
        others.nth(n).unwrap_or(GREY)
    }

    pub(crate) const BLUE: &str = "#0072B2";
    pub(crate) const VERMILLION: &str = "#D55E00";
    pub(crate) const GREEN: &str = "#009E73";
    pub(crate) const PURPLE: &str = "#CC79A7";
    pub(crate) const ORANGE: &str = "#E69F00";
    pub(crate) const GREY: &str = "#6b7280";
    pub(crate) const BLACK: &str = "#1f2328";
}

/// How a layer is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Mark {
    /// A line.
    Line,
    /// A dashed line.
    Dashed,
    /// Small circles.
    Dots,
    /// The inside of a closed line, in a pale colour.
    Area,
}

/// Half width of the pale band around a curve, in standard deviations: 95 % of a normal distribution.
pub(crate) const DEVIATIONS: f64 = 1.96;

/// Points that are drawn with one mark in one colour.
#[derive(Debug, Clone)]
pub(crate) struct Layer {
    /// Name in the legend; none for a layer without an entry.
    pub(crate) name: Option<String>,
    pub(crate) mark: Mark,
    pub(crate) colour: &'static str,
    pub(crate) points: Vec<(f64, f64)>,
}

impl Layer {
    /// A layer without an entry in the legend.
    pub(crate) fn new(mark: Mark, colour: &'static str, points: Vec<(f64, f64)>) -> Self {
        Self { name: None, mark, colour, points }
    }

    /// The layer with a name in the legend.
    pub(crate) fn named(self, name: impl Into<String>) -> Self {
        Self { name: Some(name.into()), ..self }
    }
}

/// One axis.
#[derive(Debug, Clone)]
pub(crate) struct Axis {
    pub(crate) label: String,
    /// Unit, written behind the label; empty for none.
    pub(crate) unit: String,
    pub(crate) spread: Spread,
}

impl Axis {
    pub(crate) fn linear(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { label: label.into(), unit: unit.into(), spread: Spread::Linear }
    }

    pub(crate) fn log(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { label: label.into(), unit: unit.into(), spread: Spread::Log }
    }

    fn title(&self, exponent: i32) -> String {
        let power = if exponent == 0 { String::new() } else { format!("10{}", superscript(exponent)) };
        let space = if power.is_empty() || self.unit.is_empty() { "" } else { " " };
        match (power.as_str(), self.unit.as_str()) {
            ("", "") => self.label.clone(),
            (power, unit) => format!("{} ({power}{space}{unit})", self.label),
        }
    }
}

impl Axis {
    /// The titles of both axes, each with the power of ten that was taken out of its tick labels; `before` is the room to the left of the drawing
    /// that long labels need.
    pub(super) fn titles(x: &Self, y: &Self, x_exponent: i32, y_exponent: i32, before: f64) -> Markup {
        let (middle_x, middle_y) = (0.5 * (LEFT + RIGHT), 0.5 * (TOP + BOTTOM));
        let turned = format!("translate({} {middle_y}) rotate(-90)", 17.0 - before);
        html! {
            text.label x=(middle_x) y=(HEIGHT - 10.0) text-anchor="middle" { (x.title(x_exponent)) }
            text.label transform=(turned) text-anchor="middle" { (y.title(y_exponent)) }
        }
    }
}

/// A vertical line with a label, drawn where its value lies on the axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Marker {
    /// Position on the axis of x.
    pub(crate) value: f64,
    pub(crate) label: &'static str,
}

/// A figure.
#[derive(Debug, Clone)]
pub(crate) struct Figure {
    pub(crate) title: String,
    /// What the figure shows, as text below it.
    pub(crate) caption: String,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    pub(crate) layers: Vec<Layer>,
    pub(crate) marker: Option<Marker>,
}

/// Width of the drawing, in units of nearly a pixel where two figures stand side by side on a page of full width (style.css gives each 586 pixels
/// there); the browser scales the drawing to any other width.
pub(super) const WIDTH: f64 = 600.0;
/// Height of the drawing. A matter of taste; from 300 to 400 do as well.
pub(super) const HEIGHT: f64 = 350.0;
/// Left edge of the plane: labels of [`SHORT`] characters (13 high in style.css) and the turned title fit to the left of it.
pub(super) const LEFT: f64 = 84.0;
/// Right edge of the plane: half of a label at the last tick fits to the right of it.
pub(super) const RIGHT: f64 = 578.0;
/// Upper edge of the plane: one line of the legend fits above it.
pub(super) const TOP: f64 = 30.0;
/// Lower edge of the plane: tick labels and the title fit below it.
pub(super) const BOTTOM: f64 = 296.0;
/// Width of a character in the legend: the mean of a sans-serif font 13 high. A name of wide letters is longer than computed and reaches into the gap
/// behind it.
const CHARACTER: f64 = 7.3;
/// Characters of a label on the axis of y for which there is room beside the turned title; longer labels make the drawing wider to the left.
const SHORT: usize = 6;
/// Room that an entry of the legend takes beside its name: its mark (28) and the gap to the next entry (16).
const KEY: f64 = 44.0;
/// Height of a line of the legend, for letters 13 high; further lines make the drawing higher, while the plane keeps its size.
const LINE: f64 = 18.0;
/// Number of ticks aimed at along an axis: ticks are then 80 units apart across and 45 up, so that labels of seven digits do not touch.
const TICKS: f64 = 6.0;

/// Both scales of a figure.
pub(super) struct Plane {
    pub(super) x: Scale,
    pub(super) y: Scale,
}

impl Plane {
    fn of(figure: &Figure) -> Self {
        let points = || figure.layers.iter().flat_map(|layer| &layer.points);
        let lines = figure.layers.iter().all(|layer| layer.mark != Mark::Dots);
        let histories = figure.x.spread == Spread::Linear && figure.x.unit == "s" && lines;
        Self {
            x: Scale::around(figure.x.spread, points().map(|p| p.0), !histories),
            y: Scale::around(figure.y.spread, points().map(|p| p.1), true),
        }
    }

    /// Ticks of both axes.
    pub(super) fn ticks(&self) -> (Ticks, Ticks) {
        (self.x.ticks(TICKS), self.y.ticks(TICKS))
    }

    fn x(&self, value: f64) -> f64 {
        LEFT + (RIGHT - LEFT) * self.x.share(value).clamp(0.0, 1.0)
    }

    pub(super) fn y(&self, value: f64) -> f64 {
        BOTTOM + (TOP - BOTTOM) * self.y.share(value).clamp(0.0, 1.0)
    }

    /// Positions in the drawing of the points that have one; a point beyond the end of an axis is drawn on the frame.
    fn places(&self, points: &[(f64, f64)]) -> Vec<(f64, f64)> {
        let has_place = |&&(x, y): &&(f64, f64)| self.x.share(x).is_finite() && self.y.share(y).is_finite();
        points.iter().filter(has_place).map(|&(x, y)| (self.x(x), self.y(y))).collect()
    }
}

impl Ticks {
    /// Room to the left of the drawing that long labels on the axis of y need.
    pub(super) fn room_before(&self) -> f64 {
        let lengths =
            self.ticks.iter().filter_map(|tick| tick.label.as_ref()).map(|label| label.chars().count());
        CHARACTER * lengths.max().unwrap_or(0).saturating_sub(SHORT) as f64
    }
}

impl Figure {
    /// The figure with its caption.
    pub(crate) fn draw(&self) -> Markup {
        let plane = Plane::of(self);
        let (x_ticks, y_ticks) = plane.ticks();
        let legend = self.legend_lines();
        let above = LINE * legend.len().saturating_sub(1) as f64;
        let before = y_ticks.room_before();
        let box_ = format!("{} {} {} {}", -before, -above, WIDTH + before, HEIGHT + above);
        html! {
            figure {
                figcaption { strong { (self.title) } }
                svg viewBox=(box_) role="img" aria-label=(self.title) {
                    (grid(&plane, &x_ticks, &y_ticks, true))
                    @for layer in &self.layers { (draw_layer(&plane, layer)) }
                    (self.draw_marker(&plane))
                    rect class="frame" x=(LEFT) y=(TOP) width=(RIGHT - LEFT) height=(BOTTOM - TOP) {}
                    (Axis::titles(&self.x, &self.y, x_ticks.exponent, y_ticks.exponent, before))
                    (draw_legend(&legend))
                }
                p.caption { (self.caption) }
            }
        }
    }

    fn draw_marker(&self, plane: &Plane) -> Markup {
        let shown = self.marker.filter(|marker| plane.x.contains(marker.value));
        html! {
            @if let Some(Marker { value, label }) = shown {
                @let x = plane.x(value);
                @let left = x > 0.75 * RIGHT;
                @let y = if self.is_high_beyond(plane, value) { BOTTOM - 9.0 } else { TOP + 18.0 };
                line.marker x1=(format!("{x:.1}")) x2=(format!("{x:.1}")) y1=(TOP) y2=(BOTTOM) {}
                text.key x=(format!("{:.1}", if left { x - 6.0 } else { x + 6.0 })) y=(y)
                    text-anchor=(if left { "end" } else { "start" }) { (label) }
            }
        }
    }

    /// Whether the first layer lies in the upper half of the plane beyond `x`; the marker's label is then placed below it.
    fn is_high_beyond(&self, plane: &Plane, x: f64) -> bool {
        let beyond = self.layers.iter().take(1).flat_map(|layer| &layer.points).filter(|p| p.0 >= x);
        let (sum, count) = beyond.fold((0.0, 0.0), |(sum, n), p| (sum + plane.y.share(p.1), n + 1.0));
        sum > 0.5 * count
    }

    /// Entries of the legend, broken into as many lines as they need.
    fn legend_lines(&self) -> Vec<Vec<(&Layer, &str)>> {
        let mut lines: Vec<Vec<(&Layer, &str)>> = Vec::new();
        let mut left = 0.0;
        for (layer, name) in self.layers.iter().filter_map(|l| Some((l, l.name.as_deref()?))) {
            left -= key_width(name);
            match lines.last_mut() {
                Some(line) if left >= 0.0 => line.push((layer, name)),
                _ => {
                    left = RIGHT - LEFT - key_width(name);
                    lines.push(vec![(layer, name)]);
                }
            }
        }
        lines
    }
}

fn key_width(name: &str) -> f64 {
    KEY + CHARACTER * name.chars().count() as f64
}

/// The legend above the plane, its last line nearest to the plane; lines are flush right.
fn draw_legend(lines: &[Vec<(&Layer, &str)>]) -> Markup {
    let mut placed = Vec::new();
    for (n, line) in lines.iter().rev().enumerate() {
        let total: f64 = line.iter().map(|(_, name)| key_width(name)).sum();
        let mut x = (RIGHT - total).max(LEFT);
        for (layer, name) in line {
            placed.push((*layer, *name, x, TOP - LINE * n as f64));
            x += key_width(name);
        }
    }
    html! {
        @for (layer, name, x, top) in placed {
            (draw_key(layer, x, top - 13.0))
            text.key x=(format!("{:.1}", x + 28.0)) y=(top - 9.0) { (name) }
        }
    }
}

fn draw_key(layer: &Layer, x: f64, y: f64) -> Markup {
    match layer.mark {
        Mark::Dots => html! { circle cx=(x + 14.0) cy=(y) r="3" fill=(layer.colour) {} },
        Mark::Area => {
            html! { rect x=(x + 4.0) y=(y - 5.0) width="20" height="10" fill=(layer.colour) fill-opacity="0.22" {} }
        }
        _ => path(&[(x + 4.0, y), (x + 24.0, y)], layer),
    }
}

fn draw_layer(plane: &Plane, layer: &Layer) -> Markup {
    let places = plane.places(&layer.points);
    match layer.mark {
        Mark::Dots => html! {
            g fill=(layer.colour) fill-opacity="0.75" {
                @for (x, y) in places { circle cx=(format!("{x:.1}")) cy=(format!("{y:.1}")) r="2.6" {} }
            }
        },
        Mark::Area => {
            html! { path d=(format!("{}Z", outline(&places))) fill=(layer.colour) fill-opacity="0.22" {} }
        }
        _ => path(&places, layer),
    }
}

/// The polyline through the positions as an SVG path.
fn outline(places: &[(f64, f64)]) -> String {
    let mut d = String::with_capacity(12 * places.len());
    for (n, (x, y)) in places.iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = write!(d, "{}{x:.1} {y:.1}", if n == 0 { 'M' } else { 'L' });
    }
    d
}

fn path(places: &[(f64, f64)], layer: &Layer) -> Markup {
    let d = outline(places);
    let dash = (layer.mark == Mark::Dashed).then_some("6 4");
    html! { path d=(d) fill="none" stroke=(layer.colour) stroke-dasharray=[dash] {} }
}

/// Ticks with their labels, and grid lines across the plane where `lines` is true.
pub(super) fn grid(plane: &Plane, x_ticks: &Ticks, y_ticks: &Ticks, lines: bool) -> Markup {
    let place = |value: f64| format!("{value:.1}");
    html! {
        @for tick in &x_ticks.ticks {
            @let x = place(plane.x(tick.value));
            @if let Some(label) = &tick.label {
                @if lines { line.grid x1=(x) x2=(x) y1=(TOP) y2=(BOTTOM) {} }
                text.tick x=(x) y=(BOTTOM + 18.0) text-anchor="middle" { (label) }
            } @else {
                line.small x1=(x) x2=(x) y1=(BOTTOM - 4.0) y2=(BOTTOM) {}
            }
        }
        @for tick in &y_ticks.ticks {
            @let y = plane.y(tick.value);
            @if let Some(label) = &tick.label {
                @if lines { line.grid x1=(LEFT) x2=(RIGHT) y1=(place(y)) y2=(place(y)) {} }
                text.tick x=(LEFT - 7.0) y=(place(y + 4.0)) text-anchor="end" { (label) }
            } @else {
                line.small x1=(LEFT) x2=(LEFT + 4.0) y1=(place(y)) y2=(place(y)) {}
            }
        }
    }
}
