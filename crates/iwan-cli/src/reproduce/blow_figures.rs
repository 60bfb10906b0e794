//! Figs. 7 to 11: the truth (the beam with its discrete joints) under blows, and its modal counterpart.

use iwan_core::{Backbone, FourParameter};
use iwan_ident::curve_fit::predict;
use iwan_ident::curves::Curves;
use iwan_study::StudiedBeam;
use iwan_study::beam::{BeamUnderBlows, letter};
use iwan_study::blows::{DT, LEVELS, STEPS};
use iwan_study::modes::{BendingMode, Counterpart, CoupledMode, Distance, EARLY, FITTED, Reading, SHOWN};
use iwan_study::printed::TABLE_2;

use super::plate::{Plate, Section};
use super::units::{DISPLACEMENT, ENERGY, FORCE};
use crate::page::decimate::{history, thin};
use crate::page::figure::{Axis, Figure, Layer, Mark, Marker, colour};

/// Most dots of a measured curve: up to six curves share a figure, whose axis is 494 units long, and the dots of all must stay apart.
const MEASURED: usize = 40;
/// Points of a model's curve: straight pieces of four units of the axis look smooth.
const CURVE: usize = 121;
/// Most points of the first 50 ms of a response: 36 per cycle of mode 3.
const STRETCH: usize = 1400;
/// Number of stretches of a history; the smallest and the largest value of each are drawn: one stretch for each unit of the axis.
const BINS: usize = 500;
/// Frequencies that change by less than this part are drawn as their change, since tick labels would need seven digits. Mode 2 changes by 4e-5, the
/// others by a hundredth and more.
const SMALL_CHANGE: f64 = 1e-3;

/// The figures of one configuration.
pub(super) fn plates(studied: &StudiedBeam) -> Vec<Plate> {
    let mut plates = Vec::new();
    let name = letter(studied.truth.beam.configuration);
    let initial = name.chars().next().unwrap_or('A');
    for mode in &studied.modes {
        let (mode, counterpart) = (&mode.mode, mode.counterpart.as_ref());
        let coupled = studied.coupled.as_ref().and_then(|coupled| coupled.modes.get(mode.index));
        let drawing = Drawing { truth: &studied.truth, mode, counterpart, coupled };
        let mut add = |number: &str, what: &str, section, figure| {
            let id = format!("figure-{number}-{}-mode-{}-{what}", name.to_lowercase(), mode.index + 1);
            plates.push(Plate { id, section, figure });
        };
        add("7", "frequency", Section::Figure7(initial), drawing.frequency_over_force());
        add("7", "dissipation", Section::Figure7(initial), drawing.dissipation_over_force());
        for (n, which) in SHOWN.into_iter().zip(["8a", "8b"]) {
            if let Some([response, difference]) = drawing.against_truth(n, which) {
                add(which, "response", Section::Figure8(initial), response);
                add(which, "difference", Section::Figure8(initial), difference);
            }
        }
        add("9-11", "frequency", Section::Figures9To11(initial), drawing.frequency_at_all_levels());
        add("9-11", "dissipation", Section::Figures9To11(initial), drawing.dissipation_at_all_levels());
    }
    plates
}

struct Drawing<'a> {
    truth: &'a BeamUnderBlows,
    mode: &'a BendingMode,
    counterpart: Option<&'a Counterpart>,
    coupled: Option<&'a CoupledMode>,
}

/// A modal joint law with the colour and mark of its curves.
struct DrawnLaw {
    name: &'static str,
    colour: &'static str,
    mark: Mark,
    law: FourParameter,
}

/// Values of a law at one displacement.
#[derive(Clone, Copy)]
struct LawPoint {
    joint_force: f64,
    frequency: f64,
    dissipation: f64,
}

/// Entries of curves as points, with dissipations that are not positive left out.
fn points(x: &[f64], y: &[f64]) -> Vec<(f64, f64)> {
    let pairs: Vec<(f64, f64)> = x.iter().copied().zip(y.iter().copied()).collect();
    thin(&pairs, MEASURED)
}

impl Drawing<'_> {
    /// Curves, on the axis of joint force, of the levels to which the modal joint is fitted; each with the number of its level.
    fn on_force(&self) -> Vec<(usize, Curves)> {
        let axis = self.mode.axis();
        let quiet = self.mode.curves.iter().enumerate().filter(|(n, _)| LEVELS[*n] <= FITTED);
        quiet.filter_map(|(n, curves)| Some((n, curves.clone().on_axis(axis).ok()?))).collect()
    }

    fn force_axis(&self) -> Axis {
        let label = if self.mode.has_joint() { "modal joint force" } else { "modal force" };
        Axis::log(label, FORCE)
    }

    /// Displacements between the smallest and the largest of the first `levels` levels.
    fn displacements(&self, levels: usize) -> Vec<f64> {
        let seen = self.mode.curves.iter().take(levels).flat_map(|c| c.displacement.iter().copied());
        let (low, high) = seen.fold((f64::INFINITY, 0.0_f64), |(l, h), q| (l.min(q), h.max(q)));
        (0..CURVE).map(|i| low * (high / low).powf(i as f64 / (CURVE - 1) as f64)).collect()
    }

    /// The fitted joint and the one printed in Table 2, both with the frequency ω0 of the truth.
    fn laws(&self) -> Vec<DrawnLaw> {
        let Some(counterpart) = self.counterpart else { return Vec::new() };
        let printed = TABLE_2[self.mode.index].law();
        [
            ("modal model", colour::BLACK, Mark::Dashed, counterpart.law()),
            ("Table 2 as printed", colour::GREY, Mark::Line, printed),
        ]
        .into_iter()
        .filter_map(|(name, colour, mark, law)| Some(DrawnLaw { name, colour, mark, law: law.ok()? }))
        .collect()
    }

    /// Values of a law at one displacement; none where the law gives none.
    fn of_law(&self, law: &FourParameter, q: f64) -> Option<LawPoint> {
        let parameters = iwan_ident::Parameters {
            frequency: self.mode.stuck,
            damping_ratio: 0.0,
            k_t: law.k_t(),
            f_s: law.f_s(),
            chi: law.chi(),
            beta: law.beta(),
        };
        let model = predict(&parameters, q).ok()?;
        Some(LawPoint {
            joint_force: law.harmonic_stiffness(q) * q,
            frequency: model.frequency,
            dissipation: model.dissipation,
        })
    }

    fn force_figure(
        &self,
        title: &str,
        y: Axis,
        caption: &str,
        choose: fn(&Curves) -> &Vec<f64>,
        model: fn(LawPoint) -> f64,
    ) -> Figure {
        let mut layers: Vec<Layer> = self
            .on_force()
            .iter()
            .map(|(n, c)| {
                Layer::new(Mark::Dots, colour::of(*n), points(&c.force, choose(c))).named(level(*n))
            })
            .collect();
        let fitted = LEVELS.iter().filter(|level| **level <= FITTED).count();
        for DrawnLaw { name, colour, mark, law } in self.laws() {
            let line = self.displacements(fitted).into_iter().filter_map(|q| self.of_law(&law, q));
            layers.push(
                Layer::new(mark, colour, line.map(|p| (p.joint_force, model(p))).collect()).named(name),
            );
        }
        Figure {
            title: format!("Fig. 7, {}: {title}", self.mode.name),
            caption: caption.into(),
            x: self.force_axis(),
            y,
            layers,
            marker: None,
        }
    }

    fn frequency_over_force(&self) -> Figure {
        let caption = if self.mode.has_joint() {
            "Frequency over the amplitude of the modal joint force (\u{3c9}\u{b2} \u{2212} \u{3c9}\u{221e}\u{b2}) q."
        } else {
            "Linear: the frequency hardly moves, so its change is drawn. There is no joint force: the modal force is drawn."
        };
        relative(self.force_figure(
            "frequency",
            Axis::linear("frequency", "Hz"),
            caption,
            |c| &c.frequency,
            |p| p.frequency,
        ))
    }

    fn dissipation_over_force(&self) -> Figure {
        let caption = if self.mode.has_joint() {
            "Slope \u{3c7} + 3 on this axis."
        } else {
            "Next to nothing is lost in this mode: values at the lowest levels are what the envelope's noise leaves."
        };
        self.force_figure(
            "dissipation",
            Axis::log("dissipation per cycle", ENERGY),
            caption,
            |c| &c.dissipation,
            |p| p.dissipation,
        )
    }

    /// Truth and modal model at one level: the first cycles of both, and their difference.
    fn against_truth(&self, n: usize, which: &str) -> Option<[Figure; 2]> {
        let counterpart = self.counterpart?;
        let shown = SHOWN.iter().position(|s| *s == n)?;
        let truth = &self.truth.responses[n].outputs[self.mode.index].acceleration;
        let model = counterpart.shown.get(shown)?;
        let samples = ((EARLY / DT) as usize).min(STEPS);
        let early = |x: &[f64]| -> Vec<(f64, f64)> {
            let all: Vec<(f64, f64)> = (0..=samples).map(|i| (i as f64 * DT, x[i])).collect();
            thin(&all, STRETCH)
        };
        let error = counterpart.errors[n];
        let title = format!("Fig. {which}, {}: {} lbf", self.mode.name, LEVELS[n]);
        let y = || Axis::linear("modal acceleration q''", FORCE);
        let difference: Vec<f64> = model.iter().zip(truth).map(|(a, b)| a - b).collect();
        let coupled = self.coupled.and_then(|c| Some((c.errors.get(n)?, c.shown.get(shown)?)));
        let words = |of: fn(&Distance) -> f64| {
            coupled.map_or_else(String::new, |(e, _)| {
                format!("; modes that share the joint, nothing fitted: {:.2} %", 100.0 * of(e))
            })
        };
        let mut both = Figure {
            title: title.clone(),
            caption: format!(
                "The first 50 ms; the difference is {:.2} % (root mean square){}.",
                100.0 * error.early,
                words(|e| e.early)
            ),
            x: Axis::linear("time", "s"),
            y: y(),
            layers: vec![
                Layer::new(Mark::Line, colour::BLUE, early(truth)).named("truth"),
                Layer::new(Mark::Dashed, colour::VERMILLION, early(model)).named("modal model"),
            ],
            marker: None,
        };
        let mut apart = Figure {
            title: format!("{title}, difference"),
            caption: format!(
                "Modal model less truth over the whole record: {:.2} % (root mean square) of the truth{}.",
                100.0 * error.whole,
                words(|e| e.whole)
            ),
            x: Axis::linear("time", "s"),
            y: y(),
            layers: vec![
                Layer::new(Mark::Line, colour::BLUE, history(truth, DT, BINS)).named("truth"),
                Layer::new(Mark::Line, colour::VERMILLION, history(&difference, DT, BINS))
                    .named("difference"),
            ],
            marker: None,
        };
        if let Some((_, model)) = coupled {
            let difference: Vec<f64> = model.iter().zip(truth).map(|(a, b)| a - b).collect();
            let name = "modes that share the joint";
            both.layers.push(Layer::new(Mark::Dashed, colour::BLACK, early(model)).named(name));
            apart
                .layers
                .push(Layer::new(Mark::Line, colour::BLACK, history(&difference, DT, BINS)).named(name));
        }
        Some([both, apart])
    }

    fn all_levels(&self, choose: fn(&Curves) -> &Vec<f64>) -> Vec<Layer> {
        let layer = |(n, c): (usize, &Curves)| {
            Layer::new(Mark::Dots, colour::of(n), points(&c.displacement, choose(c))).named(level(n))
        };
        self.mode.curves.iter().enumerate().map(layer).collect()
    }

    /// Values of the modes that share the joint, early, in the middle and late in the response at each level.
    fn of_coupled(&self, choose: fn(&Reading) -> f64) -> Option<Layer> {
        let levels = &self.coupled?.readings;
        let points = levels.iter().flatten().map(|r| (r.displacement, choose(r))).collect();
        Some(Layer::new(Mark::Dots, colour::BLACK, points).named("modes that share the joint"))
    }

    fn frequency_at_all_levels(&self) -> Figure {
        let mut layers = self.all_levels(|c| &c.frequency);
        layers.extend(self.of_coupled(|r| r.frequency));
        for DrawnLaw { name, colour, law, .. } in self.laws().into_iter().take(1) {
            let line = self.displacements(LEVELS.len()).into_iter();
            let line = line.filter_map(|q| Some((q, self.of_law(&law, q)?.frequency)));
            layers.push(Layer::new(Mark::Dashed, colour, line.collect()).named(name));
        }
        relative(Figure {
            title: format!("Figs. 9\u{2013}11, {}: frequency", self.mode.name),
            caption: "All levels from 1 to 10,000 lbf over the amplitude of the modal displacement.".into(),
            x: Axis::log("modal displacement q", DISPLACEMENT),
            y: Axis::linear("frequency", "Hz"),
            layers,
            marker: None,
        })
    }

    fn dissipation_at_all_levels(&self) -> Figure {
        let mut layers = self.all_levels(|c| &c.dissipation);
        layers.extend(self.of_coupled(|r| r.dissipation));
        let mut marker = None;
        for DrawnLaw { colour, law, .. } in self.laws().into_iter().take(1) {
            let places = self.displacements(LEVELS.len());
            let exact = places.iter().map(|&q| (q, law.dissipation(q))).collect();
            let macro_slip = places.iter().filter(|q| **q >= law.phi_max());
            let printed = macro_slip.map(|&q| (q, law.dissipation_printed_eq17(q))).collect();
            layers.push(Layer::new(Mark::Dashed, colour, exact).named("modal model, exact"));
            layers.push(Layer::new(Mark::Line, colour::BLACK, printed).named("Eq. 17 as printed"));
            marker = Some(Marker { value: law.phi_max(), label: "\u{3c6}_max" });
        }
        Figure {
            title: format!("Figs. 9\u{2013}11, {}: dissipation", self.mode.name),
            caption: if self.mode.has_joint() {
                "Dashed: the modal model's closed form. Beyond \u{3c6}_max the printed Eq. 17 lies above it and is less steep.".into()
            } else {
                "Linear mode: no modal joint is drawn.".into()
            },
            x: Axis::log("modal displacement q", DISPLACEMENT),
            y: Axis::log("dissipation per cycle", ENERGY),
            layers,
            marker,
        }
    }
}

/// The figure of frequencies; where they change by less than [`SMALL_CHANGE`], a figure of their change, because long numbers at the ticks are hard
/// to read.
fn relative(mut figure: Figure) -> Figure {
    let values = || figure.layers.iter().flat_map(|layer| &layer.points).map(|p| p.1);
    let (low, high) = values().fold((f64::INFINITY, 0.0_f64), |(l, h), y| (l.min(y), h.max(y)));
    let first = values().next().unwrap_or(0.0);
    if high - low < SMALL_CHANGE * high {
        figure.y.label = format!("frequency \u{2212} {first:.4} Hz");
        figure.layers.iter_mut().flat_map(|layer| &mut layer.points).for_each(|p| p.1 -= first);
    }
    figure
}

/// A level's name in the legend.
fn level(n: usize) -> String {
    format!("{} lbf", LEVELS[n])
}
