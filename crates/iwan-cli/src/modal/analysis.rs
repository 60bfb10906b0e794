//! The computation: frequency responses and modes at each level of force.

use iwan_modal::measure::{Channel, Hit, levels};
use iwan_modal::modes::mac;
use iwan_modal::responses::{
    Estimator, FiniteRecord, FrequencyResponses, Function, Windows, free_responses, frequency_responses,
};
use iwan_modal::{Analysis, ModalFit, each_of, modal_fit, modal_fit_by_subspaces, on_threads};

use super::args::{EstimatorChoice, ModalArgs, WayChoice};
use super::file_of_test::nodal;
use super::hits::Test;
use crate::failure::Failure;

/// One level of force.
pub(super) struct Level {
    /// Mean peak force of the hits, in the unit of the hammer channel; 0 for responses that another program measured.
    pub(super) force: f64,
    /// Names of the level's hits.
    pub(super) hits: Vec<String>,
    pub(super) responses: FrequencyResponses,
    pub(super) fit: ModalFit,
    /// With `--compare`: the name of the other method for the poles, and the modes it finds.
    pub(super) other: Option<(&'static str, ModalFit)>,
}

/// Analyses all levels, the softest first, on the number of threads that was asked for.
pub(super) fn analyse(test: &Test, args: &ModalArgs) -> Result<Vec<Level>, Failure> {
    on_threads(args.common.thread_count(), || levels_of(test, args)).map_err(|e| failed(&e))?
}

fn failed(error: &iwan_modal::Error) -> Failure {
    Failure::said("modal analysis", error)
}

fn levels_of(test: &Test, args: &ModalArgs) -> Result<Vec<Level>, Failure> {
    if !test.decays.is_empty() {
        let names = test.decays.iter().map(|d| d.0.clone()).collect();
        return free(test, args).map(|mut level| {
            level.hits = names;
            vec![level]
        });
    }
    if args.method == WayChoice::Subspace {
        let remedy = "use it with --free, or take the chart or isolation";
        return Err(Failure::input("--method subspace is for free decays without a force", remedy));
    }
    if test.hits.is_empty() {
        return Ok(vec![fitted(measured(test, args)?, args, true)?]);
    }
    let used: Vec<&Hit> = test.hits.iter().filter(|h| !h.left_out).map(|h| &h.hit).collect();
    let peaks: Vec<f64> = used.iter().map(|h| h.peak_force()).collect();
    let windows = Windows { whole_force: args.whole_force, decay: args.exponential.unwrap_or(0.0) };
    let estimator = match args.estimator {
        EstimatorChoice::H1 => Estimator::H1,
        EstimatorChoice::H2 => Estimator::H2,
        EstimatorChoice::Hv => Estimator::Hv,
    };
    let one = |(n, members): &(usize, Vec<usize>)| {
        let hits: Vec<&Hit> = members.iter().map(|i| used[*i]).collect();
        let responses =
            frequency_responses(&hits, test.motion, estimator, windows).map_err(|e| failed(&e))?;
        let reported = n + 1 == args.level.get();
        let mut level = fitted(responses, args, reported).map_err(|failure| shortened(failure, &hits))?;
        if args.exponential.is_none() {
            let scaled = level.fit.scaled_at_begin(&hits, test.motion, estimator, args.whole_force);
            level.fit = scaled.map_err(|e| failed(&e))?;
        }
        level.force = members.iter().map(|i| peaks[*i]).sum::<f64>() / members.len() as f64;
        level.hits = hits.iter().map(|h| h.name.clone()).collect();
        Ok(level)
    };
    let levels: Vec<(usize, Vec<usize>)> = levels(&peaks).into_iter().enumerate().collect();
    each_of(&levels, one).into_iter().collect()
}

/// A hit shorter than this part of the longest is named where an analysis fails, because all records are cut to the shortest.
const SHORT: f64 = 0.5;

/// Adds to a failure the name of the hit to which all records were cut, where that hit is shorter than [`SHORT`] allows.
fn shortened(failure: Failure, hits: &[&Hit]) -> Failure {
    let length = |hit: &&Hit| hit.samples() as f64 * hit.dt;
    let by_length = |a: &&&Hit, b: &&&Hit| length(a).total_cmp(&length(b));
    let (Some(shortest), Some(longest)) = (hits.iter().min_by(by_length), hits.iter().max_by(by_length))
    else {
        return failure;
    };
    let Failure::Input { message, .. } = &failure else { return failure };
    if length(shortest) > SHORT * length(longest) {
        return failure;
    }
    let name = &shortest.name;
    let message = format!("{message}; {name} lasts {:.4} s, and all hits are cut to it", length(shortest));
    Failure::input(
        message,
        format!("leave it out with --leave-out \"{name}\", or record longer before the next hit"),
    )
}

/// The modes of the responses by the method of the options and, with `--compare`, by another one. Frequencies of `--drop-poles` must be modes of the
/// level that is reported (`reported`); other levels may lack them.
fn fitted(responses: FrequencyResponses, args: &ModalArgs, reported: bool) -> Result<Level, Failure> {
    let (way, name, other) = match (args.poles.is_empty(), args.method) {
        (false, _) => (Analysis::Given(args.poles.clone()), "chart", Analysis::Chart),
        (true, WayChoice::Isolation) => (Analysis::Isolation, "chart", Analysis::Chart),
        (true, _) => (Analysis::Chart, "isolation", Analysis::Isolation),
    };
    let fit = calibrated(overruled(found(&responses, args, &way)?, &responses, args, reported)?, args)?;
    let other = args.compare.then(|| by(&responses, args, &other).map(|fit| (name, fit))).transpose()?;
    Ok(Level { force: 0.0, hits: Vec::new(), responses, fit, other })
}

/// The modes that a method finds by itself, without the user's additions and omissions.
fn by(responses: &FrequencyResponses, args: &ModalArgs, way: &Analysis) -> Result<ModalFit, Failure> {
    calibrated(found(responses, args, way)?, args)
}

fn found(responses: &FrequencyResponses, args: &ModalArgs, way: &Analysis) -> Result<ModalFit, Failure> {
    let order = args.order.get().min(responses.lines() / 4);
    modal_fit(responses, args.band, way, order).map_err(|e| failed(&e))
}

/// The fit with the modes that `--add-poles` adds and without those that `--drop-poles` names.
fn overruled(
    fit: ModalFit,
    responses: &FrequencyResponses,
    args: &ModalArgs,
    reported: bool,
) -> Result<ModalFit, Failure> {
    let counts = |f: &f64| reported || fit.mode_at(*f, responses).is_some();
    let dropped: Vec<f64> = args.drop_poles.iter().copied().filter(counts).collect();
    if args.add_poles.is_empty() && dropped.is_empty() {
        return Ok(fit);
    }
    fit.overruled(responses, &args.add_poles, &dropped).map_err(|e| failed(&e))
}

fn calibrated(fit: ModalFit, args: &ModalArgs) -> Result<ModalFit, Failure> {
    let spread = args.calibration.map_or(0.0, |percent| 0.01 * percent);
    fit.with_calibration(spread).map_err(|e| failed(&e))
}

/// Responses and modes of the free decays of all files, cut to the shortest.
fn free(test: &Test, args: &ModalArgs) -> Result<Level, Failure> {
    let (decays, dt) = decays(test)?;
    let said = |e: iwan_modal::Error| Failure::said("free decays", &e);
    let responses = free_responses(&decays, dt, test.motion).map_err(said)?;
    let subspaces = args.method == WayChoice::Subspace;
    if !(args.poles.is_empty() && (subspaces || args.compare)) {
        return fitted(responses, args, true);
    }
    let order = args.order.get().min(responses.lines() / 4);
    let fit = modal_fit_by_subspaces(&responses, &decays, dt, args.band, order).map_err(said)?;
    if subspaces {
        let fit = overruled(fit, &responses, args, true)?;
        let other = args.compare.then(|| by(&responses, args, &Analysis::Chart)).transpose()?;
        let other = other.map(|fit| ("chart", fit));
        return Ok(Level { force: 0.0, hits: Vec::new(), responses, fit, other });
    }
    let mut level = fitted(responses, args, true)?;
    level.other = Some(("subspace", fit));
    Ok(level)
}

/// The channels of all files, cut to the same length, and their sampling interval (s).
fn decays(test: &Test) -> Result<(Vec<Vec<Channel>>, f64), Failure> {
    let (first, dt, _) = &test.decays[0];
    let lengths = test.decays.iter().flat_map(|d| &d.2).map(|c| c.samples.len());
    let shortest = lengths.min().unwrap_or(0);
    let mut decays = Vec::new();
    for (name, own, channels) in &test.decays {
        if (own / dt - 1.0).abs() > SAME_INTERVAL {
            let message = format!("{name}: sampled at {:.6} Hz, {first} at {:.6} Hz", 1.0 / own, 1.0 / dt);
            return Err(Failure::input(message, "give decays of one sampling rate"));
        }
        let cut = |c: &Channel| Channel { samples: c.samples[..shortest].to_vec(), ..c.clone() };
        decays.push(channels.iter().map(cut).collect());
    }
    Ok((decays, *dt))
}

/// Frequency intervals of functions may differ by this part: two units of the fifth and last digit that an ASCII header has. Functions that differ by
/// more are refused.
const SAME_INTERVAL: f64 = 2e-5;

/// The frequency responses that another program measured, read from the files.
fn measured(test: &Test, args: &ModalArgs) -> Result<FrequencyResponses, Failure> {
    let Some(first) = test.functions.first() else {
        return Err(Failure::input("the files hold neither hits nor frequency responses", "give either"));
    };
    let mut functions: Vec<Function> = Vec::new();
    for f in &test.functions {
        let offset = (f.start / f.step).round();
        if (f.step / first.step - 1.0).abs() > SAME_INTERVAL
            || f.re.len() != first.re.len()
            || offset * f.step != f.start
        {
            let text = |f: &iwan_io::UffFunction| {
                format!("{} lines, {} Hz apart from {} Hz", f.re.len(), f.step, f.start)
            };
            let message = format!("function {}: {}; {}: {}", f.name, text(f), first.name, text(first));
            return Err(Failure::input(
                message,
                "give functions of the same lines, from a multiple of their distance on",
            ));
        }
        let zero = iwan_modal::Complex::new(0.0, 0.0);
        let mut values = vec![zero; offset as usize];
        values.extend(f.re.iter().zip(&f.im).map(|(a, b)| iwan_modal::Complex::new(*a, *b)));
        let (response, force) = (nodal(f.response), nodal(f.reference));
        if functions.iter().any(|g| g.response == response && g.force == force) {
            let message = format!("two functions of {response} over {force}: the second is {}", f.name);
            return Err(Failure::input(message, "give each pair of response and force once"));
        }
        let (coherence, variance) = (Vec::new(), Vec::new());
        functions.push(Function {
            name: response.to_string(),
            response,
            force,
            hits: 1,
            values,
            coherence,
            variance,
        });
    }
    let (lines, decay) = (functions[0].values.len(), args.exponential.unwrap_or(0.0));
    Ok(FrequencyResponses {
        step: first.step,
        functions,
        motion: test.motion,
        force: Vec::new(),
        decay,
        record: Some(FiniteRecord::of_impulse(
            1.0 / first.step,
            lines,
            args.pretrigger.unwrap_or(0.0),
            decay,
        )),
    })
}

/// For each mode of `a`: the index of the mode of `b` within [`NEIGHBOURHOOD`] of its frequency that has the highest modal assurance criterion, and
/// that criterion. Points that only one of the two fits has do not count.
pub(super) fn partners(a: &ModalFit, b: &ModalFit) -> Vec<Option<(usize, f64)>> {
    let near = |f: f64, g: f64| (g / f - 1.0).abs() < NEIGHBOURHOOD;
    let partner = |mode: &iwan_modal::modes::Mode| {
        let candidates =
            b.modes.iter().enumerate().filter(|(_, other)| near(mode.frequency, other.frequency));
        let alike = candidates.map(|(i, other)| (i, alike(a, mode, b, i), other.frequency));
        // Shapes with a single channel all have a criterion of 1; the small weight of frequency then chooses the nearest mode.
        let worth = |mac: f64, frequency: f64| mac - SAME_SHAPE * (frequency / mode.frequency).ln().abs();
        let best = alike.max_by(|x, y| worth(x.1, x.2).total_cmp(&worth(y.1, y.2)));
        best.map(|(i, mac, _)| (i, mac))
    };
    a.modes.iter().map(partner).collect()
}

/// Modal assurance criterion of a mode of `a` with mode `i` of `b`, over the points that both fits have.
pub(super) fn alike(a: &ModalFit, mode: &iwan_modal::modes::Mode, b: &ModalFit, i: usize) -> f64 {
    let common = a.freedoms.iter().zip(&mode.shape).filter_map(|(freedom, x)| {
        let place = b.freedoms.iter().position(|f| f == freedom)?;
        Some((*x, b.modes[i].shape[place]))
    });
    let (x, y): (Vec<_>, Vec<_>) = common.unzip();
    mac(&x, &y)
}

/// A criterion lower by this much counts as much as a frequency farther away by a factor e. Within the neighbourhood this weight decides only between
/// modes whose shapes are equally alike.
const SAME_SHAPE: f64 = 1e-4;

/// A mode of a bolted structure moves by less than this part of its frequency from level to level. A judgement: the paper's modes move by 2 %. A mode
/// that moves farther has no partner.
const NEIGHBOURHOOD: f64 = 0.1;
