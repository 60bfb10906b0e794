//! The figures of a response.

use iwan_core::{Backbone, Pulse};
use iwan_sim::{Cycle, Extreme, JointLaw, Mode, Response, extremes};

use crate::page::decimate::{STRETCHES, history, thin};
use crate::page::figure::{Axis, Figure, Layer, Mark, Marker, colour};

/// Most points of a measured curve. Dots are 5 units wide and touch each other in the plane's 494 units from a hundred dots on; more than this only
/// make the page larger.
const MEASURED: usize = 400;

/// Points of a closed form: one for every four units of the plane's width, so that straight pieces look smooth.
const CURVE: usize = 121;

/// Most points of a loop: from 100 points per cycle on the straight pieces cannot be told from a curve.
const LOOP: usize = 240;

/// Closed forms are drawn beyond the amplitudes of the response by this ratio on either side: their course is visible, and no point lies at the edge.
/// Ratios from 1.2 to 3 do as well.
const BEYOND: f64 = 1.6;

/// The force is drawn beyond the time at which it has settled by this ratio, so that its end is visible.
const BEHIND: f64 = 1.25;

/// The onset of macro-slip is included in the figures where the largest amplitude reaches at least φ_max over this ratio.
const NEAR: f64 = 3.0;

/// Caption for a mode that shares joints with others.
const SHARED: &str = "Points: from the response, in which all modes move the joints. Line: the mode with all joints stuck; what it \
    would lose alone is less than what the points show.";

/// A mode with its response and the quantities read off the response.
#[derive(Debug)]
pub(crate) struct Decay<'a> {
    pub(crate) mode: &'a Mode,
    pub(crate) response: &'a Response,
    /// Cycles after the time `settled`.
    pub(crate) cycles: Vec<Cycle>,
    /// Time from which on the force is constant, s.
    pub(crate) settled: f64,
    /// Whether the mode shares joints with others; a mode that does has no closed forms.
    pub(crate) shares: bool,
}

/// A hysteresis loop of the joint.
struct Loop {
    name: &'static str,
    colour: &'static str,
    /// Displacement and force.
    points: Vec<(f64, f64)>,
}

/// A figure of one quantity over time.
pub(crate) fn of_history(title: String, quantity: &str, samples: &[f64], dt: f64, caption: &str) -> Figure {
    of_points(title, quantity, history(samples, dt, STRETCHES), caption)
}

/// A figure over time of points (time, value) that are drawn without reduction.
pub(super) fn of_points(title: String, quantity: &str, points: Vec<(f64, f64)>, caption: &str) -> Figure {
    Figure {
        title,
        caption: caption.into(),
        x: Axis::linear("time", "s"),
        y: Axis::linear(quantity, ""),
        layers: vec![Layer::new(Mark::Line, colour::BLUE, points)],
        marker: None,
    }
}

/// The force as the simulation samples it, until a little beyond its end; none where no force acts.
pub(crate) fn of_force(force: &Pulse<'_>, dt: f64, duration: f64, caption: &str) -> Option<Figure> {
    if *force == Pulse::None {
        return None;
    }
    let end = match force.settled() {
        settled if settled > 0.0 => (BEHIND * settled).min(duration),
        _ => duration,
    };
    let samples: Vec<f64> = (0..=(end / dt) as usize).map(|n| force.at(n as f64 * dt)).collect();
    let mut figure = of_history("Force".into(), "force", &samples, dt, caption);
    figure.layers[0].colour = colour::VERMILLION;
    Some(figure)
}

impl Decay<'_> {
    /// All figures of the mode.
    pub(crate) fn figures(&self) -> Vec<Figure> {
        let mut figures = vec![self.displacement(), self.acceleration()];
        if !self.cycles.is_empty() {
            figures.push(self.envelope());
        }
        figures.extend(self.hysteresis());
        figures.push(self.frequency());
        figures.push(self.damping());
        figures.extend(self.dissipation());
        figures
    }

    fn displacement(&self) -> Figure {
        let (q, dt) = (&self.response.displacement, self.response.dt);
        let caption = match self.cycles.len() {
            0 => "Modal displacement q.",
            _ => "Modal displacement q, with the amplitude between its successive extremes after the force.",
        };
        let mut figure = of_history("Displacement".into(), "modal displacement q", q, dt, caption);
        let side = |sign: f64| {
            let points = self.cycles.iter().map(|c| (c.t, sign * c.amplitude)).collect::<Vec<_>>();
            Layer::new(Mark::Line, colour::VERMILLION, thin(&points, MEASURED))
        };
        if !self.cycles.is_empty() {
            figure.layers.push(side(1.0).named("envelope"));
            figure.layers.push(side(-1.0));
        }
        figure
    }

    fn acceleration(&self) -> Figure {
        let caption = "Modal acceleration q''.";
        let (a, dt) = (&self.response.acceleration, self.response.dt);
        of_history("Acceleration".into(), "modal acceleration q''", a, dt, caption)
    }

    fn envelope(&self) -> Figure {
        let points: Vec<_> = self.cycles.iter().map(|c| (c.t, c.amplitude)).collect();
        Figure {
            title: "Envelope".into(),
            caption:
                "Amplitude at successive extremes on a logarithmic axis: a linear mode is a straight line, \
                friction bends it."
                    .into(),
            x: Axis::linear("time", "s"),
            y: Axis::log("amplitude of q", ""),
            layers: vec![Layer::new(Mark::Dots, colour::BLUE, thin(&points, MEASURED))],
            marker: None,
        }
    }

    /// The first, middle and last cycle after the force (or of the whole response, where the force never settles), as displacement and joint force.
    fn loops(&self) -> Vec<Loop> {
        let response = self.response;
        let turns_from = |first| extremes(&response.displacement, response.dt, first);
        let first = (self.settled / response.dt).ceil().min(response.displacement.len() as f64) as usize;
        let turns = Some(turns_from(first)).filter(|t| t.len() > 2).unwrap_or_else(|| turns_from(0));
        let cycles: Vec<&[Extreme]> = turns.windows(3).collect();
        let Some(last) = cycles.len().checked_sub(1) else { return Vec::new() };
        let at = |n: usize| (response.displacement[n], response.joint_force[n]);
        let points = |cycle: &[Extreme]| (cycle[0].sample..=cycle[2].sample).map(at).collect::<Vec<_>>();
        [
            ("first cycle", 0, colour::BLUE),
            ("middle", last / 2, colour::VERMILLION),
            ("last", last, colour::GREEN),
        ]
        .map(|(name, index, colour)| Loop { name, colour, points: thin(&points(cycles[index]), LOOP) })
        .into()
    }

    /// The loops with the virgin curve, and both again minus the line of the stuck joint, which makes thin loops visible.
    fn hysteresis(&self) -> Vec<Figure> {
        let law = self.mode.joint.as_ref();
        if law.is_none() && self.mode.is_plain() && !self.shares {
            return Vec::new();
        }
        let (reach, k_t) = (self.response.peak_displacement(), law.map_or(0.0, Backbone::initial_stiffness));
        let at = |n: usize| reach * (n as f64 / (CURVE - 1) as f64);
        // Where dampers act beside the joint, the force has no virgin curve.
        let bare = law.filter(|_| self.mode.is_plain() && !self.shares);
        let virgin: Vec<_> =
            bare.map(|law| (0..CURVE).map(|n| (at(n), law.force(at(n)))).collect()).unwrap_or_default();
        let loops = self.loops();
        let figure = |title: &str, caption: &str, y: &str, less: f64| {
            let shown = |points: &[(f64, f64)]| points.iter().map(|&(q, f)| (q, f - less * q)).collect();
            let mut layers = Vec::new();
            if bare.is_some() {
                layers.push(Layer::new(Mark::Dashed, colour::GREY, shown(&virgin)).named("virgin curve"));
            }
            for Loop { name, colour, points } in &loops {
                layers.push(Layer::new(Mark::Line, colour, shown(points)).named(*name));
            }
            let (title, caption, x) =
                (title.into(), caption.into(), Axis::linear("modal displacement q", ""));
            Figure { title, caption, x, y: Axis::linear(y, ""), layers, marker: None }
        };
        let mut figures = vec![
            figure(
                "Hysteresis of the joint",
                "Joint force F in the first, middle and last cycle (after the force, where it ends); the area of a loop is the energy \
                 lost in it.",
                "joint force F",
                0.0,
            ),
            figure(
                "Slip in the joint",
                "The same less the line of the stuck joint: what slip takes off the force. The areas are the same.",
                "F \u{2212} K_T q",
                k_t,
            ),
        ];
        // Without a joint there is no line of the stuck joint to subtract, and the second figure would repeat the first.
        figures.truncate(if law.is_some() && !self.shares { 2 } else { 1 });
        figures
    }

    fn frequency(&self) -> Figure {
        let measured = |c: &Cycle| (c.amplitude, c.frequency);
        let closed = |a: f64| self.mode.frequency_at(a).unwrap_or(f64::NAN);
        let caption =
            "Line: first-harmonic balance in closed form. Points: time between extremes of the response.";
        self.against_amplitude("Frequency", caption, Axis::linear("frequency", "Hz"), measured, closed)
    }

    fn damping(&self) -> Figure {
        let measured = |c: &Cycle| (c.amplitude, 100.0 * c.damping_ratio);
        let closed = |a: f64| 100.0 * self.mode.damping_ratio_at(a).unwrap_or(f64::NAN);
        let caption = "Line: viscous part and friction loss per cycle in closed form. Points: logarithmic decrement of \
            the response; where the joint softens, amplitudes fall faster than the energy balance of a linear \
            oscillator says.";
        self.against_amplitude("Damping ratio", caption, Axis::log("damping ratio", "%"), measured, closed)
    }

    fn dissipation(&self) -> Option<Figure> {
        let linear = self.mode.joint.is_none() && self.mode.is_plain();
        if linear && (!self.shares || self.cycles.is_empty()) {
            return None;
        }
        let measured = |c: &Cycle| (c.amplitude, c.dissipation);
        let caption = "Energy lost in the joint per cycle. Line: closed form D(a), slope \u{3c7}+3 in micro-slip for a \
            four-parameter joint. Points: areas of the response's loops.";
        let axis = Axis::log("energy per cycle", "");
        Some(self.against_amplitude("Dissipation per cycle", caption, axis, measured, |a| {
            self.mode.dissipation_at(a).unwrap_or(f64::NAN)
        }))
    }

    /// A closed form as a line, with the measured values as dots.
    fn against_amplitude(
        &self,
        title: &str,
        caption: &str,
        y: Axis,
        measured: impl Fn(&Cycle) -> (f64, f64),
        closed: impl Fn(f64) -> f64,
    ) -> Figure {
        let (low, high) = self.amplitudes();
        let curve = |n: usize| {
            let a = low * (high / low).powf(n as f64 / (CURVE - 1) as f64);
            (a, closed(a))
        };
        let points: Vec<_> = self.cycles.iter().map(measured).collect();
        let line = Layer::new(Mark::Line, colour::GREY, (0..CURVE).map(curve).collect());
        let dots = Layer::new(Mark::Dots, colour::BLUE, thin(&points, MEASURED));
        let mut layers = vec![line.named(if self.shares { "with all joints stuck" } else { "closed form" })];
        if !dots.points.is_empty() {
            layers.push(dots.named("from the response"));
        }
        let onset = |law: &JointLaw| Marker { value: law.strengths().1, label: "\u{3c6}_max: macro-slip" };
        let marker = self.mode.joint.as_ref().filter(|_| !self.shares).map(onset);
        // A stuck mode without viscous damping dissipates nothing, and a logarithmic axis cannot show zero.
        if self.shares {
            for layer in &mut layers {
                layer.points.retain(|(_, y)| *y > 0.0);
            }
            layers.retain(|layer| !layer.points.is_empty());
        }
        let caption = match self.cycles.len() {
            _ if self.shares => SHARED.into(),
            0 => "Line: closed form. There is no free decay from which points could be read.".into(),
            _ => caption.into(),
        };
        let (title, x) = (title.into(), Axis::log("amplitude of q", ""));
        Figure { title, caption, x, y, layers, marker }
    }

    /// Range of amplitudes for the closed forms: that of the response, extended to φ_max where this is near.
    fn amplitudes(&self) -> (f64, f64) {
        let measured = self.cycles.iter().map(|c| c.amplitude);
        let peak = self.response.peak_displacement();
        let fallback = if peak > 0.0 { peak } else { 1.0 };
        let (low, high) =
            measured.fold((fallback, fallback), |(low, high): (f64, f64), a| (low.min(a), high.max(a)));
        let low = if low < high { low } else { 0.01 * high };
        let near = self.response.strongest < NEAR * high;
        let end = if near { high.max(self.response.strongest) } else { high };
        (low / BEYOND, end * BEYOND)
    }
}
