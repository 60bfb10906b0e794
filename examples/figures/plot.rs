//! Curves in a frame, drawn as SVG.

use std::fmt::Write;

/// The name of a curve and its points.
pub(super) type Curve = (&'static str, Vec<(f64, f64)>);

/// SVG text of the curves with their names, in a frame from the lower left corner `low` to the upper right corner `high`.
pub(super) fn plot(x: &str, y: &str, low: (f64, f64), high: (f64, f64), curves: &[Curve]) -> String {
    let at = |(a, b): (f64, f64)| {
        (60.0 + 520.0 * (a - low.0) / (high.0 - low.0), 290.0 - 270.0 * (b - low.1) / (high.1 - low.1))
    };
    let mut svg = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 600 340\" font-family=\"sans-serif\" font-size=\"13\">\n",
    );
    svg += "<rect width=\"600\" height=\"340\" fill=\"white\"/><rect x=\"60\" y=\"20\" width=\"520\" height=\"270\" fill=\"none\" stroke=\"#888\"/>\n";
    let mut text = |a: f64, b: f64, anchor: &str, colour: &str, text: &str| {
        let _ = writeln!(
            svg,
            "<text x=\"{a:.0}\" y=\"{b:.0}\" text-anchor=\"{anchor}\" fill=\"{colour}\">{text}</text>"
        );
    };
    for i in 0..=4 {
        let (a, b) =
            (low.0 + 0.25 * f64::from(i) * (high.0 - low.0), low.1 + 0.25 * f64::from(i) * (high.1 - low.1));
        text(at((a, b)).0, 307.0, "middle", "#444", &format!("{a:.2}"));
        text(54.0, at((a, b)).1 + 4.0, "end", "#444", &format!("{b:.2}"));
    }
    text(320.0, 330.0, "middle", "black", x);
    text(66.0, 14.0, "start", "black", y);
    let colours = ["#0072b2", "#d55e00", "#009e73"];
    for (i, ((name, _), colour)) in curves.iter().zip(colours).enumerate() {
        text(572.0, 282.0 - 17.0 * i as f64, "end", colour, name);
    }
    for ((_, points), colour) in curves.iter().zip(colours) {
        let path: Vec<String> = points.iter().map(|&p| format!("{:.1},{:.1}", at(p).0, at(p).1)).collect();
        let _ = writeln!(
            svg,
            "<polyline fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.5\" points=\"{}\"/>",
            path.join(" ")
        );
    }
    svg + "</svg>\n"
}
