//! Who runs, and the checks that all compute the same.

use crate::support::{
    AMPLITUDES, Buffers, DT, Linear, Population, STEPS, force, grids, joint, newmark, oscillator, run_sliders,
};
use iwan::core::{Backbone, Continuum, Decay, Hysteresis, Reversal, Run, Sliders, TabledFourParameter};
use std::error::Error;
use std::fmt::Write;
use std::process::{Command, Stdio};
use std::time::Instant;

pub(crate) type Outcome<T> = Result<T, Box<dyn Error>>;

/// One way to compute, and the time of a unit of it in ns.
pub(crate) struct Contestant<'a> {
    pub(crate) name: String,
    pub(crate) run: Box<dyn FnMut() -> Outcome<f64> + 'a>,
}

/// Ring-down for the half-cycle map: 2 s from 0.107 φ_max, where the pulse of 1000 leads.
const RING_DOWN: usize = 200_000;
const SHARE: f64 = 0.107;
/// Runs per round; the fastest counts.
const BATCH: usize = 5;

fn amplitude() -> f64 {
    SHARE * joint().phi_max()
}

/// Fastest of a few runs, in ns per unit.
fn time(units: usize, batch: usize, mut run: impl FnMut()) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..batch {
        let start = Instant::now();
        run();
        best = best.min(start.elapsed().as_secs_f64());
    }
    best * 1e9 / units as f64
}

fn contestant<'a>(name: impl Into<String>, mut run: impl FnMut() -> f64 + 'a) -> Contestant<'a> {
    Contestant { name: name.into(), run: Box::new(move || Ok(run())) }
}

/// All of them, in the order of a round. `half_cycles` is the number in the ring-down.
pub(crate) fn field(peer: Option<&str>, half_cycles: usize) -> Outcome<Vec<Contestant<'static>>> {
    let mut field = vec![linear()];
    for bins in [100, 1000] {
        for (grid, _) in grids(bins) {
            for pulse in AMPLITUDES {
                field.push(sliders(grid, bins, pulse));
            }
            if let Some(program) = peer {
                for form in ["textbook", "saved"] {
                    let path = write_population(grid, bins)?;
                    let (program, form) = (program.to_owned(), form.to_owned());
                    let name = format!("C {form} {grid} N={bins} P=1000");
                    let run = move || Ok(call_peer(&program, &path, &form, 1e3, 5)?[0]);
                    field.push(Contestant { name, run: Box::new(run) });
                }
            }
        }
    }
    field.extend(AMPLITUDES.map(continuum));
    field.extend([map_half_cycle(), map_ring_down(half_cycles)]);
    for (grid, _) in grids(100) {
        field.extend([STEPS, RING_DOWN].map(|steps| newmark_decay(grid, steps, half_cycles)));
    }
    Ok(field)
}

fn linear() -> Contestant<'static> {
    let (linear, pulse, mut out) = (Linear::new(), force(1e3), Buffers::new(STEPS + 1));
    contestant("linear oscillator", move || time(STEPS, BATCH, || linear.run(&pulse, &mut out)))
}

fn population(grid: &str, bins: usize) -> Population {
    let grid = grids(bins).into_iter().find(|g| g.0 == grid).expect("one of the two").1;
    Population::new(grid, bins)
}

fn sliders(grid: &'static str, bins: usize, pulse: f64) -> Contestant<'static> {
    let (mut population, force) = (population(grid, bins), force(pulse));
    let (mut out, mut runs) = (Buffers::new(STEPS + 1), vec![Run::default(); bins + 1]);
    contestant(format!("sliders {grid} N={bins} P={pulse}"), move || {
        let sliders = population.sliders();
        time(STEPS, BATCH, || {
            run_sliders(&sliders, &mut runs, &force, &mut out);
        })
    })
}

fn continuum(pulse: f64) -> Contestant<'static> {
    let joint = Continuum::new(TabledFourParameter::new(joint()));
    let (force, mut out) = (force(pulse), Buffers::new(STEPS + 1));
    let mut stack = vec![Reversal::default(); 512];
    contestant(format!("continuum P={pulse}"), move || {
        time(STEPS, BATCH, || {
            let mut state = joint.virgin(&mut stack[..]).expect("room");
            let mut samples = out.samples();
            newmark()
                .integrate(&oscillator(), &joint, &mut state, 0.0, &force, &mut samples)
                .expect("buffers agree");
        })
    })
}

fn decay<'a, B: Backbone>(law: &'a B, stack: &'a mut [Reversal]) -> Decay<'a, B, &'a mut [Reversal]> {
    let start = iwan::core::Motion::held_at(amplitude());
    Decay::new(&oscillator(), law, 0.0, start, stack).expect("mode 1")
}

/// A half cycle alone: 400 of them, the set-up not counted.
fn map_half_cycle() -> Contestant<'static> {
    const MANY: usize = 400;
    let (law, mut stack) = (joint(), vec![Reversal::default(); MANY + 2]);
    contestant("map: half cycle", move || {
        let mut best = f64::INFINITY;
        for _ in 0..BATCH {
            let mut decay = decay(&law, &mut stack);
            best = best.min(time(MANY, 1, || {
                for _ in 0..MANY {
                    std::hint::black_box(decay.next());
                }
            }));
        }
        best
    })
}

/// All half cycles of the ring-down, set-up included.
fn map_ring_down(half_cycles: usize) -> Contestant<'static> {
    let (law, mut stack) = (joint(), vec![Reversal::default(); half_cycles + 2]);
    contestant("map: 2 s ring-down", move || {
        time(1, BATCH, || {
            let mut decay = decay(&law, &mut stack);
            for _ in 0..half_cycles {
                std::hint::black_box(decay.next());
            }
        })
    })
}

fn run_decay(sliders: &Sliders<'_>, runs: &mut [Run], out: &mut Buffers) {
    let mut state = sliders.virgin(runs).expect("one run per slider");
    sliders.advance(&mut state, amplitude());
    newmark()
        .integrate_sliders(&oscillator(), sliders, &mut state, 0.0, &[], &mut out.samples())
        .expect("buffers agree");
}

/// Time steps through the same decay: the first 0.2 s, in ns per half cycle, or the whole ring-down.
fn newmark_decay(grid: &'static str, steps: usize, half_cycles: usize) -> Contestant<'static> {
    let whole = steps == RING_DOWN;
    let (mut population, mut runs) = (population(grid, 100), vec![Run::default(); 101]);
    let mut out = Buffers::new(steps + 1);
    let per_half_cycle = RING_DOWN as f64 / half_cycles as f64;
    let unit = if whole { "2 s ring-down" } else { "half cycle" };
    contestant(format!("newmark {grid} N=100: {unit}"), move || {
        let sliders = population.sliders();
        let per_step = time(steps, BATCH, || run_decay(&sliders, &mut runs, &mut out));
        per_step * if whole { steps as f64 } else { per_half_cycle }
    })
}

/// The linear baseline is the slider stepper's limit for small loads.
pub(crate) fn check_linear() -> Outcome<()> {
    let (mut ours, mut linear) = (Buffers::new(STEPS + 1), Buffers::new(STEPS + 1));
    let mut population = population("uniform", 100);
    let force = force(1e-3);
    run_sliders(&population.sliders(), &mut vec![Run::default(); 101], &force, &mut ours);
    Linear::new().run(&force, &mut linear);
    agree("linear oscillator", linear.last_displacement(), ours.last_displacement(), 1e-9)
}

/// Both forms of the peer end where we end. Returns what to tell the reader about them.
pub(crate) fn check_peer(program: &str) -> Outcome<String> {
    let mut note =
        String::from("the peer in C agrees in the final displacement; its force evaluations a step:");
    for bins in [100, 1000] {
        for (grid, _) in grids(bins) {
            let path = write_population(grid, bins)?;
            let (mut population, mut out) = (population(grid, bins), Buffers::new(STEPS + 1));
            run_sliders(&population.sliders(), &mut vec![Run::default(); bins + 1], &force(1e3), &mut out);
            for form in ["textbook", "saved"] {
                let [_, end, evaluations] = call_peer(program, &path, form, 1e3, 1)?;
                agree("peer in C", end, out.last_displacement(), 1e-6)?;
                let _ = write!(note, " {form} {grid} N={bins} {evaluations:.2}");
                note += if bins == 1000 && grid == "graded" && form == "saved" { "." } else { "," };
            }
        }
    }
    Ok(note)
}

/// The map's amplitude at the end is that of the time steps on the continuum. Returns its half cycles.
pub(crate) fn check_map() -> Outcome<usize> {
    let law = joint();
    let tabled = Continuum::new(TabledFourParameter::new(law));
    let (mut out, mut stack) = (Buffers::new(RING_DOWN + 1), vec![Reversal::default(); 1024]);
    let mut state = tabled.virgin(&mut stack[..])?;
    tabled.advance(&mut state, amplitude());
    newmark().integrate(&oscillator(), &tabled, &mut state, 0.0, &[], &mut out.samples())?;
    // A cycle has 806 steps.
    let cycle = 900;
    let last = out.samples().displacement.iter().rev().take(cycle).fold(0.0_f64, |m, q| m.max(q.abs()));
    let mut decay = decay(&law, &mut stack);
    let turns: Vec<f64> = std::iter::from_fn(|| decay.next())
        .take_while(|turn| turn.time <= RING_DOWN as f64 * DT)
        .map(|turn| turn.displacement.abs())
        .collect();
    let found = turns[turns.len() - 2];
    agree("half-cycle map", found, last, 2e-3)?;
    Ok(turns.len())
}

fn agree(what: &str, found: f64, expected: f64, tolerance: f64) -> Outcome<()> {
    let error = (found / expected - 1.0).abs();
    if error <= tolerance {
        return Ok(());
    }
    Err(format!("{what}: {found:e} instead of {expected:e}, relative error {error:e}").into())
}

/// The population in a file for the peers.
fn write_population(grid: &str, bins: usize) -> Outcome<String> {
    let path = format!("{}/sliders-{grid}-{bins}.txt", env!("CARGO_TARGET_TMPDIR"));
    std::fs::write(&path, population(grid, bins).lines())?;
    Ok(path)
}

/// Time of a step (ns), final displacement and force evaluations a step.
fn call_peer(program: &str, path: &str, form: &str, pulse: f64, repeats: u32) -> Outcome<[f64; 3]> {
    let output = Command::new(program)
        .args([path, form, &pulse.to_string(), &repeats.to_string()])
        .output()
        .map_err(|e| format!("{program}: {e}"))?;
    if !output.status.success() {
        return Err(format!("{program}: {}", String::from_utf8_lossy(&output.stderr)).into());
    }
    let words = String::from_utf8(output.stdout)?;
    let values: Vec<f64> = words.split_whitespace().map(str::parse).collect::<Result<_, _>>()?;
    Ok(values.try_into().map_err(|_| "the peer prints three numbers")?)
}

/// The peers in Python: one line each, time of a step (ns), final displacement and name.
pub(crate) fn python(python: &str, script: &str) -> Outcome<Vec<(String, f64)>> {
    let mut found = Vec::new();
    for bins in [100, 1000] {
        let path = write_population("uniform", bins)?;
        let mut out = Buffers::new(STEPS + 1);
        let mut population = population("uniform", bins);
        run_sliders(&population.sliders(), &mut vec![Run::default(); bins + 1], &force(1e3), &mut out);
        let output = Command::new(python).args([script, &path, "1000"]).stderr(Stdio::inherit()).output()?;
        if !output.status.success() {
            return Err(format!("{script}: {}", output.status).into());
        }
        for line in String::from_utf8(output.stdout)?.lines() {
            let mut words = line.splitn(4, ' ');
            let mut number =
                || words.next().ok_or("a number is missing")?.parse::<f64>().map_err(|e| e.to_string());
            let (time, end, tolerance) = (number()?, number()?, number()?);
            let name = words.next().unwrap_or("unnamed");
            agree(name, end, out.last_displacement(), tolerance)?;
            found.push((format!("{name} uniform N={bins} P=1000"), time));
        }
    }
    Ok(found)
}
