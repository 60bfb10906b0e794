//! The summary of `iwan modal`: `modal.json` and the table on the terminal.

use std::fmt::Write;

use iwan_modal::ModalFit;
use iwan_modal::measure::Fault;
use iwan_modal::modes::{Scale, Sidebands};
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::agreement::doubts;
use super::analysis::{Level, partners};
use super::file_of_test::JudgedHit;
use super::hits::Test;
use super::linearity::Decay;
use crate::page::numbers::short;
use crate::session::{Summary, Warnings};

/// A mode.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct ModeSummary {
    pub(crate) frequency: f64,
    pub(crate) frequency_sd: f64,
    pub(crate) damping_ratio: f64,
    pub(crate) damping_ratio_sd: f64,
    /// Real shape values by channel.
    pub(crate) shape: Map<String, Value>,
    pub(crate) shape_sd: Map<String, Value>,
    /// Complex shape values by channel, [re, im].
    pub(crate) complex_shape: Map<String, Value>,
    /// Real shape value at the hammer, along its force; null without a drive point.
    pub(crate) shape_at_force: Option<f64>,
    /// Factor that stretches the shape to the scale of the beginning of the decay (an amplitude-dependent mode changes while it rings down); null for
    /// a linear mode.
    pub(crate) stretch: Option<f64>,
    pub(crate) phase_collinearity: f64,
    pub(crate) reciprocity: Option<f64>,
    /// Frequency of the mode of which this one is probably a sideband, Hz; null for a mode of its own.
    pub(crate) sideband_of: Option<f64>,
}

/// The time from which a mode of the hardest hit is linear, by zeroed spectra.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct LinearSummary {
    /// Frequency in the late half of the decay, Hz.
    pub(crate) frequency: f64,
    pub(crate) damping_ratio: f64,
    /// Time from the first sample of the hit, s; null where the decay is not linear before its late half.
    pub(crate) time: Option<f64>,
    /// Amplitude at that time, in the unit of the channel.
    pub(crate) amplitude: Option<f64>,
}

/// The linearity of the hardest hit's decay, mode by mode.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct LinearitySummary {
    /// Names of hit and channel.
    pub(crate) of: String,
    pub(crate) modes: Vec<LinearSummary>,
}

/// Results of the other method for the poles (`--compare`).
#[derive(Debug, Clone, Serialize)]
pub(crate) struct OtherSummary {
    pub(crate) method: &'static str,
    /// Number of modes that the other method finds.
    pub(crate) found: usize,
    /// One entry for each reported mode; null where the other method finds no such mode.
    pub(crate) modes: Vec<Option<LevelMode>>,
}

/// Frequency and damping of a mode at another level, or by another method.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct LevelMode {
    pub(crate) frequency: f64,
    pub(crate) damping_ratio: f64,
    /// Modal assurance criterion with the reported mode.
    pub(crate) mac: f64,
}

/// A level of force: hits of similar peak force.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct LevelSummary {
    /// Mean peak force of its hits.
    pub(crate) force: f64,
    pub(crate) hits: Vec<String>,
    /// Root mean square of the fit's residual over that of the responses.
    pub(crate) misfit: f64,
    /// One entry for each reported mode; null where the level has no such mode.
    pub(crate) modes: Vec<Option<LevelMode>>,
}

/// A hit.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct HitSummary {
    pub(crate) name: String,
    pub(crate) peak_force: f64,
    pub(crate) faults: Vec<String>,
    pub(crate) left_out: bool,
}

/// The whole summary.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct ModalSummary {
    /// Files that were read, as absolute paths where these can be found, so that `iwan fit --modal` finds them from any folder.
    pub(crate) sources: Vec<String>,
    pub(crate) quantity: &'static str,
    pub(crate) band: [f64; 2],
    pub(crate) mass_normalised: bool,
    /// Number of the level whose modes are reported, from 1.
    pub(crate) level: usize,
    pub(crate) channels: Vec<String>,
    pub(crate) freedoms: Vec<String>,
    pub(crate) modes: Vec<ModeSummary>,
    pub(crate) levels: Vec<LevelSummary>,
    /// Results of the other method that `--compare` asks for.
    pub(crate) other: Option<OtherSummary>,
    pub(crate) linear_from: Option<LinearitySummary>,
    pub(crate) hits: Vec<HitSummary>,
    pub(crate) warnings: Warnings,
}

/// A response whose mean coherence in the band is below this gets a warning: noise, or a wrongly assigned channel, dominates it.
const INCOHERENT: f64 = 0.5;

impl ModalSummary {
    pub(super) fn new(
        test: &Test,
        levels: &[Level],
        chosen: usize,
        linearity: Option<&Decay>,
        args: &super::args::ModalArgs,
    ) -> Self {
        let fit = &levels[chosen].fit;
        let by_name = |values: &[Value]| fit.names.iter().cloned().zip(values.iter().cloned()).collect();
        let sidebands = fit.sidebands();
        let carrier = |n: usize| {
            let own = sidebands.iter().flat_map(|s| &s.all).find(|s| s.mode == n)?;
            Some(fit.modes[own.of].frequency)
        };
        let modes = fit.modes.iter().enumerate().map(|(n, m)| ModeSummary {
            frequency: m.frequency,
            frequency_sd: m.frequency_sd,
            damping_ratio: m.damping_ratio,
            damping_ratio_sd: m.damping_ratio_sd,
            shape: by_name(&m.real_shape.iter().map(|x| json!(x)).collect::<Vec<_>>()),
            shape_sd: by_name(&m.shape_sd.iter().map(|x| json!(x)).collect::<Vec<_>>()),
            complex_shape: by_name(&m.shape.iter().map(|x| json!([x.re, x.im])).collect::<Vec<_>>()),
            shape_at_force: fit.shape_at_force(m),
            stretch: m.stretch,
            phase_collinearity: m.phase_collinearity,
            reciprocity: m.reciprocity,
            sideband_of: carrier(n),
        });
        let level = |own: &Level| LevelSummary {
            force: own.force,
            hits: own.hits.clone(),
            misfit: own.fit.fitted.misfit,
            modes: beside(fit, &own.fit),
        };
        let other = levels[chosen].other.as_ref().map(|(method, other)| OtherSummary {
            method,
            found: other.modes.len(),
            modes: beside(fit, other),
        });
        let path = |p: &std::path::PathBuf| {
            std::path::absolute(p).unwrap_or_else(|_| p.clone()).display().to_string()
        };
        Self {
            sources: args.files.iter().map(path).collect(),
            quantity: ["displacement", "velocity", "acceleration"][test.motion.derivatives() as usize],
            band: [fit.band.0, fit.band.1],
            mass_normalised: fit.scale == Scale::DrivePoint,
            level: chosen + 1,
            channels: fit.names.clone(),
            freedoms: fit.freedoms.iter().map(ToString::to_string).collect(),
            modes: modes.collect(),
            levels: levels.iter().map(level).collect(),
            other,
            linear_from: linearity.map(linear),
            hits: test.hits.iter().map(hit).collect(),
            warnings: [
                warnings(test, &levels[chosen], &args.poles),
                sidebands.iter().filter_map(|s| sideband_words(fit, s)).collect(),
                doubts(test, levels),
            ]
            .concat()
            .into_iter()
            .collect(),
        }
    }
}

/// For each mode of `fit`, the mode of the `other` fit that corresponds to it.
fn beside(fit: &ModalFit, other: &ModalFit) -> Vec<Option<LevelMode>> {
    let mode = |partner: Option<(usize, f64)>| {
        let (i, mac) = partner?;
        let m = &other.modes[i];
        Some(LevelMode { frequency: m.frequency, damping_ratio: m.damping_ratio, mac })
    };
    partners(fit, other).into_iter().map(mode).collect()
}

fn linear(decay: &Decay) -> LinearitySummary {
    let mode = |m: &iwan_modal::LinearFrom| LinearSummary {
        frequency: m.pole.norm() / std::f64::consts::TAU,
        damping_ratio: -m.pole.re / m.pole.norm(),
        time: m.time.map(|t| decay.start + t),
        amplitude: m.amplitude,
    };
    LinearitySummary { of: decay.place.clone(), modes: decay.zeroed.modes.iter().map(mode).collect() }
}

fn hit(judged: &JudgedHit) -> HitSummary {
    let (name, peak_force) = (judged.hit.name.clone(), judged.hit.peak_force());
    HitSummary { name, peak_force, faults: judged.in_words(), left_out: judged.left_out }
}

/// Channels that are overloaded in every hit that is used.
fn always_overloaded(taken: &[&JudgedHit]) -> Vec<String> {
    let of = |hit: &&JudgedHit| -> Vec<String> {
        let channel = |fault: &Fault| match fault {
            Fault::Overload { channel, .. } => Some(channel.clone()),
            _ => None,
        };
        hit.faults.iter().filter_map(channel).collect()
    };
    let mut all = taken.iter().map(of);
    let first = all.next().unwrap_or_default();
    all.fold(first, |left, own| left.into_iter().filter(|name| own.contains(name)).collect())
}

/// The warning on a channel that is overloaded in every hit: leaving out the overloaded hits would leave none.
fn without_remedy(name: &str, taken: &[&JudgedHit], fit: &ModalFit) -> String {
    let hits = if taken.len() == 1 { taken[0].hit.name.clone() } else { format!("all {} hits", taken.len()) };
    let normalises = fit.scale != Scale::LargestIsOne
        && fit.drive.is_some_and(|drive| {
            let (at, hit) = (&fit.freedoms[drive.freedom], &taken[0].hit);
            hit.force.name == name || hit.responses.iter().any(|c| c.name == name && c.freedom.is_at(at))
        });
    let wrong = if normalises {
        "the scale of all shapes, which are normalised by it, is wrong"
    } else {
        "what is said of its point is wrong"
    };
    format!(
        "channel {name} is overloaded in {hits}: {wrong}; measure it with a lower gain, or leave it out by role = \"none\" in the table of --points"
    )
}

/// The warning where the modes leave most of the responses unexplained; `given` are the frequencies that the user gave.
fn missing_modes(fit: &ModalFit, given: &[f64]) -> String {
    let place = format!(
        "the modes leave {:.0} % of the responses between {:.3} and {:.3} Hz",
        100.0 * fit.fitted.misfit,
        fit.band.0,
        fit.band.1
    );
    if given.is_empty() {
        return format!(
            "{place}: noise, or motion that is no linear vibration; choose another --band, or hit harder"
        );
    }
    format!(
        "--poles: {place}, because other modes stand there too; give their frequencies as well, or choose the band around yours with --band"
    )
}

/// A warning that names the modes whose damping ratio is smaller than its standard deviation.
fn without_damping(fit: &ModalFit) -> Option<String> {
    let is_not_told = |m: &&iwan_modal::modes::Mode| m.damping_ratio < m.damping_ratio_sd;
    let list: Vec<String> =
        fit.modes.iter().filter(is_not_told).map(|m| format!("{:.2}", m.frequency)).collect();
    (!list.is_empty()).then(|| {
        format!(
            "the damping of {} modes is less than its standard deviation: lines that do not decay, or parts of a mode that moves between hits; leave them out with --drop-poles {}",
            list.len(),
            list.join(",")
        )
    })
}

fn warnings(test: &Test, level: &Level, given: &[f64]) -> Vec<String> {
    let mut warnings = test.warnings.clone();
    let taken: Vec<&JudgedHit> = test.hits.iter().filter(|h| !h.left_out).collect();
    let always = always_overloaded(&taken);
    for judged in &taken {
        let name = &judged.hit.name;
        let advice = format!("leave it out with --leave-out \"{name}\"");
        let spared =
            |fault: &&Fault| !matches!(fault, Fault::Overload { channel, .. } if always.contains(channel));
        warnings
            .extend(judged.faults.iter().filter(spared).map(|fault| format!("{name}: {fault}; {advice}")));
    }
    let fit = &level.fit;
    warnings.extend(always.iter().map(|name| without_remedy(name, &taken, fit)));
    if fit.scale == Scale::LargestIsOne && test.decays.is_empty() {
        warnings.push("no response was measured where the hammer hits: shapes are not mass-normalised, their largest value is 1; say where it hits with --at POINT".into());
    }
    for (m, stretch) in fit.modes.iter().filter_map(|m| Some((m, m.stretch?))) {
        warnings.push(format!(
            "the decay at {:.3} Hz is not linear: the scale of its shape is that of the decay's begin, {:.2} % off that of the whole",
            m.frequency,
            100.0 * (stretch - 1.0)
        ));
    }
    warnings.extend(without_damping(fit));
    warnings.extend(fit.moved_doubt(given).map(|doubt| format!("--poles: {doubt}")));
    warnings.extend(fit.parts_doubt().map(|doubt| {
        format!("{doubt}; iwan envelope shows how it changes (--mode HZ), softer hits leave one mode of it, and --drop-poles leaves parts out")
    }));
    let place = |k: usize| {
        let f = &level.responses.functions[k];
        let named = |h: &&JudgedHit| {
            h.hit.force.freedom == f.force && h.hit.responses.iter().any(|c| c.freedom == f.response)
        };
        let file = test.hits.iter().find(named).map_or_else(String::new, |h| format!("{}, ", h.file));
        format!("{file}channel {} ({} over {})", f.name, f.response, f.force)
    };
    let lines = |v: &[f64]| {
        let at = |f: f64| (f / level.responses.step) as usize;
        let part = &v[at(fit.band.0).min(v.len() - 1)..=at(fit.band.1).min(v.len() - 1)];
        part.iter().sum::<f64>() / part.len() as f64
    };
    let strangers = fit.strangers();
    for (k, f) in level.responses.functions.iter().enumerate() {
        if !f.coherence.is_empty() && lines(&f.coherence) < INCOHERENT {
            warnings.push(format!(
                "{}: mean coherence {:.2} in the band: noise, a loose sensor, or hits at other points",
                place(k),
                lines(&f.coherence)
            ));
        }
        if strangers.contains(&k) {
            warnings.push(format!(
                "{}: the modes leave {:.0} % of it: it does not move as the other channels do",
                place(k),
                100.0 * fit.fitted.left[k]
            ));
        }
    }
    if fit.leaves_most() {
        warnings.push(missing_modes(fit, given));
    }
    if let (Some(doubt), Some(drive)) = (fit.drive_point_doubt(), fit.drive) {
        let at = &fit.freedoms[drive.freedom];
        let there = |f: &&iwan_modal::responses::Function| f.response.is_at(at) || f.force.is_at(at);
        let k = level.responses.functions.iter().position(|f| there(&f)).unwrap_or(0);
        warnings.push(format!("{}: {doubt}", place(k)));
    }
    warnings
}

/// A warning that names probable sidebands, and the option that leaves them out.
fn sideband_words(fit: &ModalFit, found: &Sidebands) -> Option<String> {
    let list: Vec<String> = found.all.iter().map(|s| format!("{:.2}", fit.modes[s.mode].frequency)).collect();
    Some(format!("{}: leave them out with --drop-poles {}", fit.sideband_doubt()?, list.join(",")))
}

impl Summary for ModalSummary {
    fn warnings(&self) -> &[String] {
        &self.warnings
    }

    fn text(&self) -> String {
        let mut text = format!(
            "{} modes between {:.3} and {:.3} Hz, shapes at {} channels{}\n\n{:>14}{:>12}{:>14}{:>12}{:>9}\n",
            self.modes.len(),
            self.band[0],
            self.band[1],
            self.channels.len(),
            if self.mass_normalised { ", mass-normalised" } else { " (largest value 1)" },
            "frequency, Hz",
            "sd",
            "damping, %",
            "sd",
            "MPC"
        );
        for m in &self.modes {
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "{:>14.5}{:>12}{:>14.5}{:>12}{:>9.4}",
                m.frequency,
                short(m.frequency_sd),
                100.0 * m.damping_ratio,
                short(100.0 * m.damping_ratio_sd),
                m.phase_collinearity
            );
        }
        if let Some(other) = &self.other {
            let _ = writeln!(text, "\nby {} ({} modes):", other.method, other.found);
            lines_of(&mut text, &other.modes);
        }
        for (n, level) in self.levels.iter().enumerate().filter(|_| self.levels.len() > 1) {
            let _ = writeln!(
                text,
                "\nlevel {} ({} hits, peak force {}):",
                n + 1,
                level.hits.len(),
                short(level.force)
            );
            lines_of(&mut text, &level.modes);
        }
        text
    }
}

/// Appends a line for each mode that the other method or level has too.
fn lines_of(text: &mut String, modes: &[Option<LevelMode>]) {
    for mode in modes.iter().flatten() {
        let _ = writeln!(
            text,
            "{:>14.5} Hz{:>12.5} %   MAC {:.4}",
            mode.frequency,
            100.0 * mode.damping_ratio,
            mode.mac
        );
    }
}
