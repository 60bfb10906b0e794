//! What is computed: responses and modes at each level of force.

use iwan_modal::measure::{Channel, Hit, levels};
use iwan_modal::modes::mac;
use iwan_modal::responses::{
    Estimator, FiniteRecord, FrequencyResponses, Function, Windows, free_responses, frequency_responses,
};
use iwan_modal::{Analysis, ModalFit, modal_fit};

use super::args::{EstimatorChoice, ModalArgs, WayChoice};
use super::hits::{Test, nodal};
use crate::failure::Failure;

/// One level of force.
pub(super) struct Level {
    /// Mean peak force; 0 for responses that others measured.
    pub(super) force: f64,
    /// Names of its hits.
    pub(super) hits: Vec<String>,
    pub(super) responses: FrequencyResponses,
    pub(super) fit: ModalFit,
}

/// All levels, the softest first.
pub(super) fn analyse(test: &Test, args: &ModalArgs) -> Result<Vec<Level>, Failure> {
    let failed = |e: iwan_modal::Error| Failure::said("modal analysis", &e);
    let way = match (args.poles.is_empty(), args.method) {
        (false, _) => Analysis::Given(args.poles.clone()),
        (true, WayChoice::Chart) => Analysis::Chart,
        (true, WayChoice::Isolation) => Analysis::Isolation,
    };
    let level = |force, hits, responses: FrequencyResponses| {
        let order = args.order.get().min(responses.lines() / 4);
        let fit = modal_fit(&responses, args.band, &way, order).map_err(failed)?;
        Ok(Level { force, hits, responses, fit })
    };
    if !test.decays.is_empty() {
        let names = test.decays.iter().map(|d| d.0.clone()).collect();
        return Ok(vec![level(0.0, names, free(test)?)?]);
    }
    if test.hits.is_empty() {
        return Ok(vec![level(0.0, Vec::new(), measured(test, args)?)?]);
    }
    let used: Vec<&Hit> = test.hits.iter().filter(|h| !h.left_out).map(|h| &h.hit).collect();
    let peaks: Vec<f64> = used.iter().map(|h| h.peak_force()).collect();
    let windows = Windows { whole_force: args.whole_force, decay: args.exponential.unwrap_or(0.0) };
    let estimator = match args.estimator {
        EstimatorChoice::H1 => Estimator::H1,
        EstimatorChoice::H2 => Estimator::H2,
        EstimatorChoice::Hv => Estimator::Hv,
    };
    let one = |members: &Vec<usize>| {
        let hits: Vec<Hit> = members.iter().map(|i| used[*i].clone()).collect();
        let force = members.iter().map(|i| peaks[*i]).sum::<f64>() / members.len() as f64;
        let responses = frequency_responses(&hits, test.motion, estimator, windows).map_err(failed)?;
        level(force, hits.iter().map(|h| h.name.clone()).collect(), responses)
    };
    levels(&peaks).iter().map(one).collect()
}

/// Free decays of all files, cut to the shortest.
fn free(test: &Test) -> Result<FrequencyResponses, Failure> {
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
    free_responses(&decays, *dt, test.motion).map_err(|e| Failure::said("free decays", &e))
}

/// Intervals of functions may differ by this part, two units of the fifth and last digit that an ASCII header has.
const SAME_INTERVAL: f64 = 2e-5;

/// Frequency responses that others measured.
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

/// For each mode of `a` the modal assurance criterion with the mode of `b` that is most like it in its neighbourhood, and its index.
pub(super) fn partners(a: &ModalFit, b: &ModalFit) -> Vec<Option<(usize, f64)>> {
    let near = |f: f64, g: f64| (g / f - 1.0).abs() < NEIGHBOURHOOD;
    let partner = |mode: &iwan_modal::modes::Mode| {
        let candidates =
            b.modes.iter().enumerate().filter(|(_, other)| near(mode.frequency, other.frequency));
        let alike = candidates.map(|(i, other)| (i, mac(&mode.shape, &other.shape)));
        alike.max_by(|x, y| x.1.total_cmp(&y.1))
    };
    a.modes.iter().map(partner).collect()
}

/// A mode of a bolted structure moves less than this part of its frequency from level to level. A judgement: the paper's moves by 2 %.
const NEIGHBOURHOOD: f64 = 0.1;
