//! Figs. 7 to 11: the truth under blows and its modal counterpart.

use iwan_core::{Backbone, FourParameter};
use iwan_ident::curve_fit::predict;
use iwan_ident::curves::Curves;

use super::{Plate, Section};
use crate::commands::reproduce::{
    Counterpart, DT, FITTED, LEVELS, SHOWN, STEPS, Side, Studied, Study, TABLE_2,
};
use crate::report::decimate::{history, thin};
use crate::report::figure::{Axis, Figure, Layer, Mark, colour};

/// Units of modal quantities: displacement, force and acceleration, energy.
const DISPLACEMENT: &str = "\u{221a}(lbf\u{b7}in)\u{b7}s";
pub(super) const FORCE: &str = "\u{221a}(lbf\u{b7}in)/s";
const ENERGY: &str = "lbf\u{b7}in";
/// One colour per level.
const COLOURS: [&str; 6] =
    [colour::BLUE, colour::ORANGE, colour::GREEN, colour::PURPLE, colour::VERMILLION, colour::GREY];
/// Points of a measured curve, of a model's, of a stretch of a response, and stretches of a history.
const MEASURED: usize = 40;
const CURVE: usize = 121;
const STRETCH: usize = 1400;
const BINS: usize = 500;
/// Frequencies that change less than this, relatively, are drawn as their change.
const SMALL_CHANGE: f64 = 1e-3;
/// End of the stretch of Figs. 8a and 8b that is drawn cycle by cycle, s.
const EARLY: f64 = 0.05;

/// The figures of one configuration.
pub(super) fn plates(side: &Side, studies: &[Studied]) -> Vec<Plate> {
    let mut plates = Vec::new();
    let letter = side.name.chars().next().unwrap_or('A');
    for (study, counterpart) in studies {
        let of = Drawing { side, study, counterpart: counterpart.as_ref() };
        let mut add = |number: &str, what: &str, section, figure| {
            let id = format!("figure-{number}-{}-mode-{}-{what}", side.name.to_lowercase(), study.index + 1);
            plates.push(Plate { id, section, figure });
        };
        add("7", "frequency", Section::Figure7(letter), of.frequency_over_force());
        add("7", "dissipation", Section::Figure7(letter), of.dissipation_over_force());
        for (n, which) in SHOWN.into_iter().zip(["8a", "8b"]) {
            if let Some([response, difference]) = of.against_truth(n, which) {
                add(which, "response", Section::Figure8(letter), response);
                add(which, "difference", Section::Figure8(letter), difference);
            }
        }
        add("9-11", "frequency", Section::Figures9To11(letter), of.frequency_at_all_levels());
        add("9-11", "dissipation", Section::Figures9To11(letter), of.dissipation_at_all_levels());
    }
    plates
}

struct Drawing<'a> {
    side: &'a Side,
    study: &'a Study,
    counterpart: Option<&'a Counterpart>,
}

/// Entries of curves as points, with dissipations that are not positive left out.
fn points(x: &[f64], y: &[f64]) -> Vec<(f64, f64)> {
    let pairs: Vec<(f64, f64)> = x.iter().copied().zip(y.iter().copied()).collect();
    thin(&pairs, MEASURED)
}

impl Drawing<'_> {
    /// Curves of the levels that are fitted, on the axis of joint force.
    fn on_force(&self) -> Vec<(usize, Curves)> {
        let axis = self.study.axis();
        let quiet = self.study.curves.iter().enumerate().filter(|(n, _)| LEVELS[*n] <= FITTED);
        quiet.filter_map(|(n, curves)| Some((n, curves.clone().on_axis(axis).ok()?))).collect()
    }

    fn force_axis(&self) -> Axis {
        let label = if self.study.has_joint() { "modal joint force" } else { "modal force" };
        Axis::log(label, FORCE)
    }

    /// Displacements between the smallest and the largest seen among the first `levels`.
    fn displacements(&self, levels: usize) -> Vec<f64> {
        let seen = self.study.curves.iter().take(levels).flat_map(|c| c.displacement.iter().copied());
        let (low, high) = seen.fold((f64::INFINITY, 0.0_f64), |(l, h), q| (l.min(q), h.max(q)));
        (0..CURVE).map(|i| low * (high / low).powf(i as f64 / (CURVE - 1) as f64)).collect()
    }

    /// The fitted joint and the printed one, with ω0 of the truth.
    fn laws(&self) -> Vec<(&'static str, &'static str, Mark, FourParameter)> {
        let Some(counterpart) = self.counterpart else { return Vec::new() };
        let printed = TABLE_2[self.study.index].law();
        [
            ("modal model", colour::BLACK, Mark::Dashed, counterpart.law()),
            ("Table 2 as printed", colour::GREY, Mark::Line, printed),
        ]
        .into_iter()
        .filter_map(|(name, colour, mark, law)| Some((name, colour, mark, law.ok()?)))
        .collect()
    }

    /// Joint force and frequency or dissipation of a law at a displacement.
    fn of_law(&self, law: &FourParameter, q: f64) -> Option<(f64, f64, f64)> {
        let parameters = iwan_ident::Parameters {
            frequency: self.study.stuck,
            damping_ratio: 0.0,
            k_t: law.k_t(),
            f_s: law.f_s(),
            chi: law.chi(),
            beta: law.beta(),
        };
        let model = predict(&parameters, q).ok()?;
        Some((law.harmonic_stiffness(q) * q, model.frequency, model.dissipation))
    }

    fn force_figure(
        &self,
        title: &str,
        y: Axis,
        caption: &str,
        choose: fn(&Curves) -> &Vec<f64>,
        model: fn((f64, f64, f64)) -> f64,
    ) -> Figure {
        let mut layers: Vec<Layer> = self
            .on_force()
            .iter()
            .map(|(n, c)| Layer::new(Mark::Dots, COLOURS[*n], points(&c.force, choose(c))).named(level(*n)))
            .collect();
        for (name, colour, mark, law) in self.laws() {
            let line = self.displacements(4).into_iter().filter_map(|q| self.of_law(&law, q));
            layers.push(Layer::new(mark, colour, line.map(|v| (v.0, model(v))).collect()).named(name));
        }
        Figure {
            title: format!("Fig. 7, {}: {title}", self.study.name),
            caption: caption.into(),
            x: self.force_axis(),
            y,
            layers,
            marker: None,
        }
    }

    fn frequency_over_force(&self) -> Figure {
        let caption = if self.study.has_joint() {
            "Frequency over the amplitude of the modal joint force (\u{3c9}\u{b2} \u{2212} \u{3c9}\u{221e}\u{b2}) q."
        } else {
            "Linear: the frequency hardly moves, so its change is drawn. There is no joint force: the modal force is drawn."
        };
        relative(self.force_figure(
            "frequency",
            Axis::linear("frequency", "Hz"),
            caption,
            |c| &c.frequency,
            |v| v.1,
        ))
    }

    fn dissipation_over_force(&self) -> Figure {
        let caption = if self.study.has_joint() {
            "Slope \u{3c7} + 3 on this axis."
        } else {
            "Next to nothing is lost in this mode: values at the lowest levels are what the envelope's noise leaves."
        };
        self.force_figure(
            "dissipation",
            Axis::log("dissipation per cycle", ENERGY),
            caption,
            |c| &c.dissipation,
            |v| v.2,
        )
    }

    /// Truth and modal model at one level: cycle by cycle at first, and their difference.
    fn against_truth(&self, n: usize, which: &str) -> Option<[Figure; 2]> {
        let counterpart = self.counterpart?;
        let shown = SHOWN.iter().position(|s| *s == n)?;
        let truth = &self.side.responses[n].outputs[self.study.index].acceleration;
        let model = counterpart.shown.get(shown)?;
        let samples = ((EARLY / DT) as usize).min(STEPS);
        let early = |x: &[f64]| -> Vec<(f64, f64)> {
            let all: Vec<(f64, f64)> = (0..=samples).map(|i| (i as f64 * DT, x[i])).collect();
            thin(&all, STRETCH)
        };
        let error = counterpart.errors[n];
        let title = format!("Fig. {which}, {}: {} lbf", self.study.name, LEVELS[n]);
        let y = || Axis::linear("modal acceleration q''", FORCE);
        let difference: Vec<f64> = model.iter().zip(truth).map(|(a, b)| a - b).collect();
        let both = Figure {
            title: title.clone(),
            caption: format!(
                "The first 50 ms; the difference is {:.2} % (root mean square).",
                100.0 * error.early
            ),
            x: Axis::linear("time", "s"),
            y: y(),
            layers: vec![
                Layer::new(Mark::Line, colour::BLUE, early(truth)).named("truth"),
                Layer::new(Mark::Dashed, colour::VERMILLION, early(model)).named("modal model"),
            ],
            marker: None,
        };
        let apart = Figure {
            title: format!("{title}, difference"),
            caption: format!(
                "Modal model less truth over the whole record: {:.2} % (root mean square) of the truth.",
                100.0 * error.whole
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
        Some([both, apart])
    }

    fn all_levels(&self, choose: fn(&Curves) -> &Vec<f64>) -> Vec<Layer> {
        let layer = |(n, c): (usize, &Curves)| {
            Layer::new(Mark::Dots, COLOURS[n], points(&c.displacement, choose(c))).named(level(n))
        };
        self.study.curves.iter().enumerate().map(layer).collect()
    }

    fn frequency_at_all_levels(&self) -> Figure {
        let mut layers = self.all_levels(|c| &c.frequency);
        for (name, colour, _, law) in self.laws().into_iter().take(1) {
            let line = self.displacements(LEVELS.len()).into_iter();
            let line = line.filter_map(|q| Some((q, self.of_law(&law, q)?.1)));
            layers.push(Layer::new(Mark::Dashed, colour, line.collect()).named(name));
        }
        relative(Figure {
            title: format!("Figs. 9\u{2013}11, {}: frequency", self.study.name),
            caption: "All levels from 1 to 10,000 lbf over the amplitude of the modal displacement.".into(),
            x: Axis::log("modal displacement q", DISPLACEMENT),
            y: Axis::linear("frequency", "Hz"),
            layers,
            marker: None,
        })
    }

    fn dissipation_at_all_levels(&self) -> Figure {
        let mut layers = self.all_levels(|c| &c.dissipation);
        let mut marker = None;
        for (_, colour, _, law) in self.laws().into_iter().take(1) {
            let places = self.displacements(LEVELS.len());
            let exact = places.iter().map(|&q| (q, law.dissipation(q))).collect();
            let macro_slip = places.iter().filter(|q| **q >= law.phi_max());
            let printed = macro_slip.map(|&q| (q, law.dissipation_printed_eq17(q))).collect();
            layers.push(Layer::new(Mark::Dashed, colour, exact).named("modal model, exact"));
            layers.push(Layer::new(Mark::Line, colour::BLACK, printed).named("Eq. 17 as printed"));
            marker = Some((law.phi_max(), "\u{3c6}_max"));
        }
        Figure {
            title: format!("Figs. 9\u{2013}11, {}: dissipation", self.study.name),
            caption: if self.study.has_joint() {
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

/// A figure of frequencies; where they hardly change, of their change: long numbers at the ticks are hard to read.
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
