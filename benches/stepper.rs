//! How long does one time step take, beside a linear oscillator with the same outputs?

mod support;

use criterion::{BenchmarkGroup, BenchmarkId, Criterion, Throughput, measurement::WallTime};
use iwan::core::{Continuum, Hysteresis, Plain, Reversal, Run, TabledFourParameter};
use support::{
    AMPLITUDES, Buffers, Linear, Population, STEPS, force, grids, newmark, oscillator, run_sliders,
};

/// The fast path for sliders, and the linear oscillator before and behind it.
fn sliders(group: &mut BenchmarkGroup<'_, WallTime>, out: &mut Buffers) {
    for bins in [100, 1000] {
        for (name, grid) in grids(bins) {
            let mut population = Population::new(grid, bins);
            let sliders = population.sliders();
            let mut runs = vec![Run::default(); sliders.len()];
            for amplitude in AMPLITUDES {
                let force = force(amplitude);
                let id = BenchmarkId::new(format!("sliders/{name}/{bins}"), amplitude);
                group.bench_function(id, |b| b.iter(|| run_sliders(&sliders, &mut runs, &force, out)));
            }
        }
    }
}

/// Newton's scheme that takes any joint.
fn general<State, J: Hysteresis<State>>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    (name, amplitude): (&str, f64),
    out: &mut Buffers,
    joint: &J,
    mut virgin: impl FnMut() -> State,
) {
    let force = force(amplitude);
    group.bench_function(BenchmarkId::new(name, amplitude), |b| {
        b.iter(|| {
            let (mut state, mut samples) = (virgin(), out.samples());
            newmark().integrate(&oscillator(), joint, &mut state, 0.0, &force, &mut samples)
        });
    });
}

fn steppers(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step");
    group.throughput(Throughput::Elements(STEPS as u64));
    let mut out = Buffers::new(STEPS + 1);
    let (linear, pulse) = (Linear::new(), force(1e3));
    group.bench_function("linear", |b| b.iter(|| linear.run(&pulse, &mut out)));
    sliders(&mut group, &mut out);
    let tabled = Continuum::new(TabledFourParameter::new(support::joint()));
    let untabled = Continuum::new(support::joint());
    for amplitude in AMPLITUDES {
        let stack = || vec![Reversal::default(); 512];
        let virgin = || tabled.virgin(stack()).expect("room");
        general(&mut group, ("continuum/tabled", amplitude), &mut out, &tabled, virgin);
        let virgin = || untabled.virgin(stack()).expect("room");
        general(&mut group, ("continuum/libm", amplitude), &mut out, &untabled, virgin);
    }
    group.sample_size(10);
    for bins in [100, 1000] {
        for (name, grid) in grids(bins) {
            let mut population = Population::new(grid, bins);
            let sliders = population.sliders();
            let virgin = || sliders.virgin(vec![Run::default(); sliders.len()]).expect("room");
            general(&mut group, (&format!("general/{name}/{bins}"), 1e3), &mut out, &sliders, virgin);
            let plain = Plain::new(sliders);
            let virgin = || plain.virgin(vec![0.0; sliders.len()]).expect("room");
            general(&mut group, (&format!("plain/{name}/{bins}"), 1e3), &mut out, &plain, virgin);
        }
    }
    group.finish();
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    steppers(&mut criterion);
    criterion.final_summary();
}
