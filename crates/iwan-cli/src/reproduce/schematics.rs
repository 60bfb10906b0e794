//! Figs. 2 and 4: the meaning of the four parameters, drawn from computed curves.

use iwan_core::{Backbone, FourParameter, Oscillator, ResidualStiffness};
use iwan_study::printed::TABLE_2;

use super::plate::{Plate, Section};
use super::units::{ENERGY, FORCE};
use crate::page::figure::{Axis, Figure, Layer, Mark, Marker, colour};

/// Small-amplitude frequency of the modal schematic, Hz: near that of mode 1, and named in the caption. Any frequency does whose ω0² is above the
/// joint's K_T.
const FREQUENCY: f64 = 125.0;
/// Points of a curve: straight pieces of three units of the axis look smooth.
const CURVE: usize = 161;
/// Straight pieces of each half of a loop.
const HALF_LOOP: u32 = 80;

/// Displacements from `from` to `to` times φ_max on a logarithmic scale.
fn range(law: &FourParameter, from: f64, to: f64) -> impl Iterator<Item = f64> {
    let (phi, last) = (law.phi_max(), (CURVE - 1) as f64);
    (0..CURVE).map(move |i| phi * from * (to / from).powf(i as f64 / last))
}

/// The schematics.
pub(super) fn plates() -> Vec<Plate> {
    let mut plates = Vec::new();
    let mut add = |id: &str, figure: Figure| {
        plates.push(Plate { id: id.into(), section: Section::Schematics, figure });
    };
    if let Ok(law) = iwan_fem::paper::joint() {
        add("figure-2-loops", loops(&law));
        add("figure-2-dissipation", dissipation(&law));
    }
    if let Ok(law) = TABLE_2[0].law() {
        add("figure-4-force", force(&law));
        if let Ok(oscillator) = Oscillator::new(FREQUENCY, 0.0, law.k_t(), ResidualStiffness::Positive) {
            add("figure-4-frequency", frequency(&law, &oscillator));
        }
    }
    plates
}

/// Force over displacement: one hysteresis loop at each of three amplitudes, by Masing's rule.
fn loops(law: &FourParameter) -> Figure {
    let turn = |amplitude: f64, name: &str, colour| {
        let top = law.force(amplitude);
        let down = (0..=HALF_LOOP).map(|i| 2.0 * amplitude * f64::from(i) / f64::from(HALF_LOOP));
        let half: Vec<(f64, f64)> = down.map(|l| (amplitude - l, top - 2.0 * law.force(0.5 * l))).collect();
        let back: Vec<(f64, f64)> = half.iter().map(|(u, f)| (-u, -f)).collect();
        Layer::new(Mark::Line, colour, half.into_iter().chain(back).collect()).named(name)
    };
    let phi = law.phi_max();
    Figure {
        title: "Fig. 2: loops of the joint of Table 1".into(),
        caption: "Joint force over displacement at a quarter of, at and at twice the onset of macro-slip; the loop's area is the \
                  dissipation per cycle."
            .into(),
        x: Axis::linear("joint displacement u", "in"),
        y: Axis::linear("joint force", "lbf"),
        layers: vec![
            turn(2.0 * phi, "2 \u{3c6}_max", colour::VERMILLION),
            turn(phi, "\u{3c6}_max", colour::GREEN),
            turn(0.25 * phi, "\u{3c6}_max/4", colour::BLUE),
        ],
        marker: None,
    }
}

/// Dissipation per cycle over displacement, in micro-slip and macro-slip.
fn dissipation(law: &FourParameter) -> Figure {
    let phi = law.phi_max();
    let exact = range(law, 1e-3, 30.0).map(|u| (u, law.dissipation(u))).collect();
    let line = |u: f64| law.dissipation(1e-3 * phi) * (u / (1e-3 * phi)).powf(law.chi() + 3.0);
    let micro = range(law, 1e-3, 10.0).map(|u| (u, line(u))).collect();
    let printed = range(law, 0.3, 30.0).map(|u| (u, law.dissipation_printed_eq17(u))).collect();
    Figure {
        title: "Fig. 2: dissipation of the joint of Table 1".into(),
        caption: "Slope \u{3c7} + 3 in micro-slip; Eq. 17 as printed is the asymptote of macro-slip only."
            .into(),
        x: Axis::log("joint displacement u", "in"),
        y: Axis::log("dissipation per cycle", ENERGY),
        layers: vec![
            Layer::new(Mark::Line, colour::BLUE, exact).named("exact"),
            Layer::new(Mark::Dashed, colour::GREEN, micro).named("slope \u{3c7}+3"),
            Layer::new(Mark::Dashed, colour::VERMILLION, printed).named("Eq. 17 as printed"),
        ],
        marker: Some(Marker { value: phi, label: "\u{3c6}_max" }),
    }
}

fn force(law: &FourParameter) -> Figure {
    let exact = range(law, 1e-3, 10.0).map(|q| (law.force(q), law.dissipation(q))).collect();
    Figure {
        title: "Fig. 4: dissipation of modal joint 1 of Table 2".into(),
        caption: "Over the joint's force: slope \u{3c7} + 3 at low force, then straight up at F_S.".into(),
        x: Axis::log("modal joint force", FORCE),
        y: Axis::log("dissipation per cycle", ENERGY),
        layers: vec![Layer::new(Mark::Line, colour::BLUE, exact).named("modal joint 1")],
        marker: Some(Marker { value: law.f_s(), label: "F_S" }),
    }
}

fn frequency(law: &FourParameter, oscillator: &Oscillator) -> Figure {
    let at = |q: f64| (oscillator.k_inf() + law.harmonic_stiffness(q)).sqrt() / std::f64::consts::TAU;
    let curve: Vec<(f64, f64)> = range(law, 1e-3, 30.0).map(|q| (law.force(q), at(q))).collect();
    let slipping = oscillator.k_inf().sqrt() / std::f64::consts::TAU;
    let ends = [curve[0].0, curve[CURVE - 1].0];
    let level = |f: f64| ends.map(|force| (force, f)).to_vec();
    Figure {
        title: "Fig. 4: frequency of a mode with that joint".into(),
        caption: format!(
            "From \u{3c9}\u{2080} (taken as {FREQUENCY} Hz) to \u{3c9}\u{221e}: K_T = \u{3c9}\u{2080}\u{b2} \u{2212} \u{3c9}\u{221e}\u{b2}."
        ),
        x: Axis::log("modal joint force", FORCE),
        y: Axis::linear("frequency", "Hz"),
        layers: vec![
            Layer::new(Mark::Line, colour::BLUE, curve).named("frequency"),
            Layer::new(Mark::Dashed, colour::GREEN, level(FREQUENCY)).named("\u{3c9}\u{2080}"),
            Layer::new(Mark::Dashed, colour::VERMILLION, level(slipping)).named("\u{3c9}\u{221e}"),
        ],
        marker: Some(Marker { value: law.f_s(), label: "F_S" }),
    }
}
