//! Figures of a fit: record and model, curves with the fit, density, profiles.

use iwan_core::Backbone;
use iwan_ident::curve_fit::predict;
use iwan_ident::curves::{Curves, ForceAxis};
use iwan_ident::density::{Evidence, FreeForm};
use iwan_ident::profile::Profile;
use iwan_ident::{Parameter, Parameters};
use iwan_study::identified::Comparison;

use crate::identified::Identified;
use crate::page::decimate::{STRETCHES, history, thin};
use crate::page::figure::{Axis, DEVIATIONS, Figure, Layer, Mark, Marker, colour};
use crate::records::Units;

/// Most points of a curve: two for every three units of the plane's width. Of dots a quarter of that, so that they do not touch.
const CURVE: usize = 300;
/// Cycles in a close view: each takes 40 units of the plane, so that a shift of a twentieth of a cycle between record and model is visible.
const CYCLES: f64 = 12.0;
/// Closed forms are drawn beyond the measured amplitudes by this ratio on either side. Ratios from 1.2 to 3 do as well.
const BEYOND: f64 = 1.5;
/// Deviances are drawn up to this multiple of the 95 % limit. The interval, where the curve is below the limit, then takes half the width of a
/// parabola.
const HIGHEST: f64 = 4.0;
/// A parameter whose profile spans more than this ratio is drawn on a logarithmic axis; on a linear one, an interval that is open above would squeeze
/// the rest against the left edge. Limits from 3 to 10 do as well.
const WIDE: f64 = 5.0;
/// Densities below this part of the largest one in the informed range are not drawn: a free-form density may vanish between its peaks, and three
/// decades are enough to compare the peaks.
const FAINT: f64 = 1e-3;

/// A fit and the units of its records.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fitted<'a> {
    pub(super) i: &'a Identified,
    pub(super) units: &'a Units,
}

/// A quantity of the curves at a given index.
type Value = fn(&Curves, usize) -> f64;

/// One panel of curves over amplitude or force.
struct Panel {
    title: &'static str,
    caption: String,
    x: Axis,
    y: Axis,
    /// Quantity on the axis of x.
    over: Value,
    /// Quantity on the axis of y.
    value: Value,
    /// Lower and upper edge of the pale band: the 95 % uncertainty of the curve.
    edges: fn(&Curves, usize) -> (f64, f64),
}

impl Fitted<'_> {
    fn parameters(&self) -> &Parameters {
        &self.i.found.parameters
    }

    /// Number of the record for the title of a figure; empty where there is one record only.
    fn suffix(&self, n: usize) -> String {
        if self.i.extractions.len() == 1 { String::new() } else { format!(", record {}", n + 1) }
    }

    /// Name of a record in legends.
    fn record_name(&self, n: usize) -> String {
        if self.i.extractions.len() == 1 { "record".into() } else { format!("record {}", n + 1) }
    }

    /// Record and model over the whole time, at the start and at the end, and their difference.
    pub(super) fn comparison(&self, n: usize) -> Vec<Figure> {
        let c = &self.i.comparisons[n];
        let seconds = CYCLES / self.parameters().frequency;
        let cycles = (seconds / c.dt) as usize;
        let last = c.record.len();
        let suffix = self.suffix(n);
        let view = |title: &str, caption: String, range: std::ops::Range<usize>, bins| {
            let start = c.start + range.start as f64 * c.dt;
            let points = |samples: &[f64]| -> Vec<(f64, f64)> {
                history(&samples[range.clone()], c.dt, bins)
                    .into_iter()
                    .map(|(t, y)| (start + t, y))
                    .collect()
            };
            self.over_time(
                format!("{title}{suffix}"),
                caption,
                vec![
                    Layer::new(Mark::Line, colour::BLUE, points(&c.record)).named(if c.unfiltered {
                        "record"
                    } else {
                        "record in the band"
                    }),
                    Layer::new(Mark::Dashed, colour::VERMILLION, points(&c.model)).named("fitted model"),
                ],
            )
        };
        let near = "Record and model must lie on each other in size and in phase.".to_string();
        vec![
            view(
                "Record and model",
                format!(
                    "What is left over is {:.2} % of the record (root mean square).",
                    100.0 * c.relative()
                ),
                0..last,
                STRETCHES,
            ),
            self.residual(c, &suffix),
            view("The first cycles", near.clone(), 0..cycles.min(last), CURVE * 4),
            view("The last cycles", near, last.saturating_sub(cycles)..last, CURVE * 4),
        ]
    }

    fn over_time(&self, title: String, caption: String, layers: Vec<Layer>) -> Figure {
        let y = Axis::linear(self.units.quantity, &self.units.samples);
        Figure { title, caption, x: Axis::linear("time", "s"), y, layers, marker: None }
    }

    fn residual(&self, c: &Comparison, suffix: &str) -> Figure {
        let points =
            history(&c.residual(), c.dt, STRETCHES).into_iter().map(|(t, y)| (c.start + t, y)).collect();
        let caption =
            "Noise alone is even in time; a swelling and shrinking residual is what the model misses.";
        let layer = Layer::new(Mark::Line, colour::GREY, points).named("record less model");
        self.over_time(format!("Residual{suffix}"), caption.into(), vec![layer])
    }

    /// Frequency and damping against amplitude, dissipation against force.
    pub(super) fn curves(&self) -> Vec<Figure> {
        let level = || Axis::log("amplitude of displacement", &self.units.displacement);
        let pale = "Points: the record, with what it may be wrong by, at 95 %, as the pale band. Line: the fitted model's ring-down, by the \
            same method.";
        let force =
            if matches!(self.i.curves[0].axis, ForceAxis::Modal) { "modal force" } else { "joint force" };
        let panels = [
            Panel {
                title: "Frequency against amplitude",
                caption: pale.into(),
                x: level(),
                y: Axis::linear("frequency", "Hz"),
                over: |c, i| c.displacement[i],
                value: |c, i| c.frequency[i],
                edges: |c, i| {
                    let reach = DEVIATIONS * c.frequency_sd[i];
                    (c.frequency[i] - reach, c.frequency[i] + reach)
                },
            },
            Panel {
                title: "Damping ratio against amplitude",
                caption: pale.into(),
                x: level(),
                y: Axis::linear("damping ratio", "%"),
                over: |c, i| c.displacement[i],
                value: |c, i| 100.0 * c.damping_ratio[i],
                edges: |c, i| {
                    let (zeta, reach) = (100.0 * c.damping_ratio[i], DEVIATIONS * c.log_dissipation_sd[i]);
                    (zeta * (-reach).exp(), zeta * reach.exp())
                },
            },
            Panel {
                title: "Dissipation per cycle against force",
                caption: "The dashed lines are the two parts of the model in closed form: friction with slope \u{3c7} + 3 in \
                    micro-slip, the viscous damper with slope 2."
                    .into(),
                x: Axis::log(force, &self.units.force),
                y: Axis::log("energy per cycle", &self.units.energy),
                over: |c, i| c.force[i],
                value: |c, i| c.dissipation[i],
                edges: |c, i| {
                    let reach = (DEVIATIONS * c.log_dissipation_sd[i]).exp();
                    (c.dissipation[i] / reach, c.dissipation[i] * reach)
                },
            },
        ];
        let [frequency, damping, dissipation] = panels.map(|p| self.panel(&p));
        vec![frequency, damping, self.with_parts(dissipation)]
    }

    fn panel(&self, panel: &Panel) -> Figure {
        let points = |c: &Curves| -> Vec<(f64, f64)> {
            thin(
                &(0..c.t.len()).map(|k| ((panel.over)(c, k), (panel.value)(c, k))).collect::<Vec<_>>(),
                CURVE,
            )
        };
        let mut layers = Vec::new();
        for (n, c) in self.i.curves.iter().enumerate() {
            let colour = colour::beside(colour::VERMILLION, n);
            let edge = |upper: bool| {
                let point = |k: usize| {
                    let (low, high) = (panel.edges)(c, k);
                    ((panel.over)(c, k), if upper { high } else { low })
                };
                thin(&(0..c.t.len()).map(point).collect::<Vec<_>>(), CURVE)
            };
            let outline = edge(true).into_iter().chain(edge(false).into_iter().rev()).collect();
            layers.push(Layer::new(Mark::Area, colour, outline));
            layers
                .push(Layer::new(Mark::Dots, colour, thin(&points(c), CURVE / 4)).named(self.record_name(n)));
        }
        for (n, c) in self.i.found.model_curves.iter().enumerate() {
            let Ok(c) = c.clone().on_axis(self.i.curves[0].axis) else { continue };
            let layer = Layer::new(Mark::Line, colour::VERMILLION, points(&c));
            layers.push(if n == 0 { layer.named("fitted model") } else { layer });
        }
        Figure {
            title: panel.title.into(),
            caption: panel.caption.clone(),
            x: panel.x.clone(),
            y: panel.y.clone(),
            layers,
            marker: None,
        }
    }

    /// Adds to the figure of dissipation the part of the joint's friction and the part of the viscous damper.
    fn with_parts(&self, mut figure: Figure) -> Figure {
        let p = self.parameters();
        let Ok((_, joint)) = p.model() else { return figure };
        let k_inf = match self.i.curves[0].axis {
            ForceAxis::Modal => 0.0,
            ForceAxis::Joint { frequency, k_t } => (std::f64::consts::TAU * frequency).powi(2) - k_t,
        };
        let part = |friction: bool| -> Vec<(f64, f64)> {
            let point = |u: f64| {
                let model = predict(p, u).ok()?;
                let omega = std::f64::consts::TAU * model.frequency;
                let lost = joint.dissipation(u);
                Some(((omega * omega - k_inf) * u, if friction { lost } else { model.dissipation - lost }))
            };
            self.amplitudes().into_iter().filter_map(point).collect()
        };
        let named = |points, colour, name: &str| Layer::new(Mark::Dashed, colour, points).named(name);
        figure.layers.insert(0, named(part(true), colour::GREY, "friction"));
        if p.damping_ratio > 0.0 {
            figure.layers.insert(1, named(part(false), colour::ORANGE, "viscous"));
        }
        figure
    }

    /// Amplitudes from the smallest to the largest measured, extended by [`BEYOND`] on either side.
    fn amplitudes(&self) -> Vec<f64> {
        let all = self.i.curves.iter().flat_map(|c| c.displacement.iter().copied());
        let (low, high) = all.fold((f64::INFINITY, 0.0_f64), |e, u| (e.0.min(u), e.1.max(u)));
        let ratio = BEYOND * BEYOND * high / low;
        (0..CURVE).map(|k| low / BEYOND * ratio.powf(k as f64 / (CURVE - 1) as f64)).collect()
    }

    /// The identified densities of slider strengths, parametric and free-form.
    pub(super) fn density(&self) -> Option<Figure> {
        let (_, joint) = self.parameters().model().ok()?;
        let informed = self.i.densities.first()?.informed;
        let (r, chi, phi_max) = (joint.r(), self.parameters().chi, joint.phi_max());
        let reach = (0.1 * informed.0, 3.0 * informed.1.max(phi_max.min(3.0 * informed.1)));
        let power = |k: usize| {
            let phi = reach.0 * (reach.1 / reach.0).powf(k as f64 / (CURVE - 1) as f64);
            (phi, if phi < phi_max { r * phi.powf(chi) } else { 0.0 })
        };
        let four: Vec<(f64, f64)> = (0..CURVE).map(power).filter(|p| p.1 > 0.0).collect();
        let free = |d: &FreeForm| -> Vec<(f64, f64)> {
            let points = d.strength.iter().copied().zip(d.density.iter().copied());
            points.filter(|p| p.0 >= reach.0 && p.1 > 0.0).collect()
        };
        let inside = |p: &&(f64, f64)| (informed.0..=informed.1).contains(&p.0);
        let seen = self.i.densities.iter().flat_map(free).chain(four.iter().copied());
        let seen: Vec<(f64, f64)> = seen.collect();
        let (low, high) =
            seen.iter().filter(inside).fold((f64::INFINITY, 0.0_f64), |e, p| (e.0.min(p.1), e.1.max(p.1)));
        let floor = (0.5 * low).max(FAINT * high);
        let visible = |points: Vec<(f64, f64)>| {
            points.into_iter().filter(|p| p.1 > floor && p.1 < 10.0 * high).collect()
        };
        let area = vec![
            (informed.0, floor),
            (informed.1, floor),
            (informed.1, 2.0 * high),
            (informed.0, 2.0 * high),
        ];
        let mut layers = vec![
            Layer::new(Mark::Area, colour::ORANGE, area).named("informed"),
            Layer::new(Mark::Line, colour::VERMILLION, visible(four)).named("4 parameters"),
        ];
        for d in &self.i.densities {
            let (mark, colour, name) = match d.evidence {
                Evidence::Both => (Mark::Line, colour::BLUE, "free form"),
                Evidence::Dissipation => (Mark::Dashed, colour::GREEN, "from dissipation"),
            };
            layers.push(Layer::new(mark, colour, visible(free(d))).named(name));
        }
        let displacement = &self.units.displacement;
        let per =
            if displacement.is_empty() { String::new() } else { format!("1/s\u{b2} per {displacement}") };
        Some(Figure {
            title: "Density of the sliders".into(),
            caption: "Stiffness per strength. Inside the pale band sliders begin to slip in the record; to its left only their \
                sum is known, to its right nothing. A part at \u{3c6}_max in one point (\u{3b2}) is not drawn."
                .into(),
            x: Axis::log("strength \u{3c6}", displacement),
            y: Axis::log("density \u{3c1}", per),
            layers,
            marker: Some(Marker { value: phi_max, label: "\u{3c6}_max" }),
        })
    }

    /// The profile likelihood of each parameter that was not held.
    pub(super) fn profiles(&self) -> Vec<Figure> {
        let profiles = &self.i.found.profiles;
        profiles.parameters.iter().filter(|p| !p.held).map(|p| self.profile(p, profiles.limit)).collect()
    }

    fn profile(&self, profile: &Profile, limit: f64) -> Figure {
        let (label, unit) = match profile.parameter {
            Parameter::Frequency => ("frequency", "Hz"),
            Parameter::DampingRatio => ("viscous damping ratio", ""),
            Parameter::KT => ("K_T", "1/s\u{b2}"),
            Parameter::FS => ("F_S", self.units.force.as_str()),
            Parameter::Chi => ("\u{3c7}", ""),
            Parameter::Beta => ("\u{3b2}", ""),
        };
        let points: Vec<(f64, f64)> =
            profile.points.iter().map(|p| (p.value, p.deviance)).filter(|p| p.1 <= HIGHEST * limit).collect();
        let ends =
            points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |e, p| (e.0.min(p.0), e.1.max(p.0)));
        let wide = ends.0 > 0.0 && ends.1 > WIDE * ends.0;
        let caption = match (profile.low, profile.high) {
            (Some(_), Some(_)) => "The 95 % interval is where the curve lies below the dashed line.",
            (None, None) => "Never above the dashed line on either side: these records do not tell it.",
            (Some(_), None) => "To the right it never rises above the dashed line: no upper bound.",
            (None, Some(_)) => "To the left it never rises above the dashed line: no lower bound.",
        };
        Figure {
            title: format!("Profile likelihood of {label}"),
            caption: caption.into(),
            x: if wide { Axis::log(label, unit) } else { Axis::linear(label, unit) },
            y: Axis::linear("deviance", ""),
            layers: vec![
                Layer::new(Mark::Dashed, colour::VERMILLION, vec![(ends.0, limit), (ends.1, limit)])
                    .named("95 %"),
                Layer::new(Mark::Line, colour::BLUE, between(&points, profile.value)),
                Layer::new(Mark::Dots, colour::BLUE, points),
            ],
            marker: Some(Marker { value: profile.value, label: "best" }),
        }
    }
}

/// Interpolates between the points of a profile. The signed root of the deviance is interpolated linearly, so that a parabola, which a profile
/// resembles near its minimum, is drawn as a parabola.
fn between(points: &[(f64, f64)], best: f64) -> Vec<(f64, f64)> {
    // Twelve straight pieces between two points of a profile cannot be told from the parabola.
    const STEPS: u32 = 12;
    let root = |p: &(f64, f64)| p.1.max(0.0).sqrt().copysign(p.0 - best);
    let inner = |pair: &[(f64, f64)]| {
        let (a, b) = (root(&pair[0]), root(&pair[1]));
        let (from, to) = (pair[0].0, pair[1].0);
        let point = move |k: u32| {
            let s = f64::from(k) / f64::from(STEPS);
            (from + s * (to - from), (a + s * (b - a)).powi(2))
        };
        (0..=STEPS).map(point)
    };
    points.windows(2).flat_map(inner).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parabolas_stay_parabolas() {
        let points = [-2.0, 0.0, 1.0].map(|x: f64| (3.0 + x, x * x));
        let all = between(&points, 3.0);
        assert!(all.len() > 20 && all.iter().all(|(x, y)| ((x - 3.0).powi(2) - y).abs() < 1e-12));
    }
}
