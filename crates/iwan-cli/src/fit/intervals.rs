//! The 95 % intervals as a picture: bars relative to the best value; open ends are arrows.

use maud::{Markup, html};

use super::joint::{Estimate, JointFit, interval};
use crate::page::figure::colour;
use crate::page::numbers::long;

/// Width of the picture, in units of nearly a pixel: nearly the whole width of a page (1200).
const WIDTH: f64 = 1180.0;
/// Height of a parameter's row: text 13 high or an arrow 14 high, and the gap to the next row as much again.
const ROW: f64 = 34.0;
/// Right end of the column of names.
const NAMES: f64 = 200.0;
/// Right end of the column of values: seven digits and an exponent fit.
const VALUES: f64 = 330.0;
/// Left and right end of the bars; the interval as text stands to the right of them.
const LEFT: f64 = 350.0;
const RIGHT: f64 = 800.0;
/// Widest scale, as ln of the ratio to the best value: a factor of ten to either side. An end beyond it is drawn at the edge, and its value stands in
/// the text.
const WIDEST: f64 = std::f64::consts::LN_10;
/// Narrowest scale, one per cent to either side: on a narrower one the rounding of the tick labels (four digits) would show.
const NARROWEST: f64 = 0.01;

/// An end of a bar.
#[derive(Debug, Clone, Copy, PartialEq)]
enum End {
    /// Position within the scale: ln of the ratio to the best value.
    At(f64),
    /// Closed, but beyond the scale.
    Beyond,
    /// Open: the data do not bound the parameter on this side.
    Open,
}

/// The picture with its caption.
pub(super) fn draw(joint: &JointFit) -> Markup {
    let (rows, reach) = (joint.rows(), reach(joint));
    let height = ROW * (rows.len() as f64 + 1.6);
    let middle = 0.5 * (LEFT + RIGHT);
    let bottom = ROW * (rows.len() as f64 + 0.4);
    html! {
        figure.intervals {
            figcaption { strong { "95 % intervals" } }
            svg viewBox=(format!("0 0 {WIDTH} {height:.0}")) role="img" aria-label="95 % intervals" {
                line.marker x1=(middle) x2=(middle) y1="8" y2=(bottom) {}
                @for (n, (label, e)) in rows.into_iter().enumerate() { (row(ROW * (n as f64 + 0.7), label, e, reach)) }
                line.frame x1=(LEFT) x2=(RIGHT) y1=(bottom) y2=(bottom) {}
                @for share in [-1.0, -0.5, 0.0, 0.5, 1.0] {
                    @let x = place(share * reach, reach);
                    line.small x1=(x) x2=(x) y1=(bottom) y2=(bottom + 5.0) {}
                    text.tick x=(x) y=(bottom + 20.0) text-anchor="middle" { (tick(share * reach)) }
                }
                text.label x=(middle) y=(bottom + 38.0) text-anchor="middle" { "ratio to the best value (of \u{3c7}: of \u{3c7} + 1)" }
            }
            p.caption {
                "An arrow is an open end: these records do not bound the parameter on that side. A bar that ends at the rim "
                "goes on beyond it; its end stands at the right."
            }
        }
    }
}

/// ln of the ratio of a bound to the best value; for χ, which is negative, of χ + 1.
fn ratio(e: &Estimate, bound: f64, chi: bool) -> f64 {
    let shift = if chi { 1.0 } else { 0.0 };
    ((bound + shift) / (e.value + shift)).ln()
}

/// How far the scale reaches, as ln of a ratio: to the farthest closed end, between `NARROWEST` and `WIDEST`.
fn reach(joint: &JointFit) -> f64 {
    let ends = joint.rows().into_iter().flat_map(|(label, e)| {
        [e.low, e.high].into_iter().flatten().map(move |bound| ratio(e, bound, label == "chi").abs())
    });
    1.1 * ends.filter(|r| r.is_finite()).fold(NARROWEST, f64::max).min(WIDEST)
}

fn end(e: &Estimate, bound: Option<f64>, chi: bool, reach: f64) -> End {
    match bound.map(|b| ratio(e, b, chi)) {
        None => End::Open,
        Some(r) if r.abs() <= reach => End::At(r),
        Some(_) => End::Beyond,
    }
}

fn place(r: f64, reach: f64) -> f64 {
    0.5 * (LEFT + RIGHT) + 0.5 * (RIGHT - LEFT) * r / reach
}

fn tick(r: f64) -> String {
    if r == 0.0 {
        "1".into()
    } else if r.abs() < 0.1 {
        format!("{:.4}", r.exp())
    } else {
        format!("{:.2}", r.exp())
    }
}

fn row(y: f64, label: &str, e: &Estimate, reach: f64) -> Markup {
    let chi = label == "chi";
    let [low, high] = [e.low, e.high].map(|bound| end(e, bound, chi, reach));
    let at = |end: End, rim: f64| if let End::At(r) = end { place(r, reach) } else { rim };
    let (from, to) = (at(low, LEFT), at(high, RIGHT));
    let shown = if e.identifiable { colour::BLUE } else { colour::VERMILLION };
    let arrow = |x: f64, s: f64| format!("M{x:.1} {y:.1}l{:.1} -7l0 14Z", -10.0 * s);
    html! {
        text.key x=(NAMES) y=(y + 4.0) text-anchor="end" { (label) }
        text.key x=(VALUES) y=(y + 4.0) text-anchor="end" { (long(e.value)) }
        @if !e.held {
            line x1=(format!("{from:.1}")) x2=(format!("{to:.1}")) y1=(y) y2=(y) stroke=(shown) stroke-width="5" {}
            @for (end, x, s) in [(low, from, -1.0), (high, to, 1.0)] {
                @if end == End::Open { path d=(arrow(x + 9.0 * s, s)) fill=(shown) {} }
                @else { line x1=(format!("{x:.1}")) x2=(format!("{x:.1}")) y1=(y - 8.0) y2=(y + 8.0) stroke=(shown) stroke-width="2" {} }
            }
        }
        circle cx=(place(0.0, reach)) cy=(y) r="4.5" fill="#fff" stroke=(shown) stroke-width="2" {}
        text.key x=(RIGHT + 24.0) y=(y + 4.0) { (interval(e)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_open_beyond_or_in_place() {
        let e = Estimate { value: 2.0, low: Some(1.0), high: None, identifiable: false, held: false };
        assert_eq!(end(&e, e.high, false, 1.0), End::Open);
        assert_eq!(end(&e, e.low, false, 0.5), End::Beyond);
        assert_eq!(end(&e, e.low, false, 1.0), End::At(-std::f64::consts::LN_2));
        let chi = Estimate { value: -0.5, low: Some(-0.75), ..e };
        assert_eq!(end(&chi, chi.low, true, 1.0), End::At(-std::f64::consts::LN_2));
        // A damping ratio whose interval begins at 0 is closed and beyond any scale of ratios.
        assert_eq!(end(&e, Some(0.0), false, 1.0), End::Beyond);
    }
}
