//! How long do a half cycle of the energy map, its output and averaging take, beside time steps?

mod support;

use criterion::{BenchmarkId, Criterion, Throughput};
use iwan::core::{
    Averaging, Backbone, Continuum, Decay, Grid, Hysteresis, Motion, Reversal, Run, Samples,
    TabledFourParameter,
};
use support::{Buffers, DT, Population, SHARES, joint, newmark, oscillator};

/// Ring-downs, by time steps.
const RING_DOWNS: [(&str, usize); 2] = [("0.2 s", 20_000), ("2 s", 200_000)];

/// Half cycles of a free decay from `amplitude` within `duration`; returns their number.
fn half_cycles<B: Backbone>(law: &B, amplitude: f64, duration: f64, stack: &mut [Reversal]) -> u64 {
    let start = Motion::held_at(amplitude);
    let mut decay = Decay::new(&oscillator(), law, 0.0, start, stack).expect("mode 1");
    let mut count = 0;
    while decay.next().is_some_and(|turn| turn.time < duration) {
        count += 1;
    }
    count
}

fn map(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("half cycle");
    let law = joint();
    let mut stack = vec![Reversal::default(); 1024];
    for (name, share) in SHARES {
        let start = Motion::held_at(share * law.phi_max());
        // A start at 1.5 φ_max leaves macro-slip within a few half cycles: those alone.
        let most = if share < 1.0 { 400 } else { 4 };
        group.throughput(Throughput::Elements(most));
        group.bench_function(name, |b| {
            b.iter_batched_ref(
                || {
                    Decay::new(&oscillator(), &law, 0.0, start, vec![Reversal::default(); 512])
                        .expect("mode 1")
                },
                |decay| (0..most).filter_map(|_| decay.next()).fold(0.0, |sum, turn| sum + turn.displacement),
                criterion::BatchSize::LargeInput,
            );
        });
    }
    group.throughput(Throughput::Elements(1));
    group.bench_function("set-up", |b| {
        b.iter(|| {
            Decay::new(&oscillator(), &law, 0.0, Motion::held_at(0.1), &mut stack[..])
                .expect("mode 1")
                .memory()
                .forgotten()
        });
    });
    group.finish();
}

fn ring_downs(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("ring-down");
    let law = joint();
    let tabled = TabledFourParameter::new(law);
    let mut stack = vec![Reversal::default(); 1024];
    let mut population = Population::new(Grid::graded(100), 100);
    let sliders = population.sliders();
    for (name, steps) in RING_DOWNS {
        let (mut out, duration) = (Buffers::new(steps + 1), steps as f64 * DT);
        for (slip, share) in SHARES {
            let id = |what: &str| BenchmarkId::new(format!("{name}/{slip}"), what);
            let start = share * law.phi_max();
            group.throughput(Throughput::Elements(half_cycles(&law, start, duration, &mut stack)));
            group.bench_function(id("map"), |b| b.iter(|| half_cycles(&law, start, duration, &mut stack)));
            group.sample_size(20).bench_function(id("newmark on sliders"), |b| {
                b.iter(|| {
                    let mut state = sliders.virgin(vec![Run::default(); sliders.len()]).expect("room");
                    sliders.advance(&mut state, start);
                    newmark().integrate_sliders(
                        &oscillator(),
                        &sliders,
                        &mut state,
                        0.0,
                        &[],
                        &mut out.samples(),
                    )
                });
            });
            group.bench_function(id("newmark on the continuum"), |b| {
                b.iter(|| {
                    let continuum = Continuum::new(&tabled);
                    let mut state = continuum.virgin(&mut stack[..]).expect("room");
                    continuum.advance(&mut state, start);
                    newmark().integrate(&oscillator(), &continuum, &mut state, 0.0, &[], &mut out.samples())
                });
            });
        }
    }
    group.finish();
}

/// Output at uniform times (1 ms: four a half cycle), per sample.
fn output(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("output");
    let law = joint();
    let mut stack = vec![Reversal::default(); 1024];
    let mut out = Buffers::new(2001);
    group.throughput(Throughput::Elements(2001)).sample_size(20);
    for (slip, share) in SHARES {
        let start = Motion::held_at(share * law.phi_max());
        let mut bench = |what: &str, run: &mut dyn FnMut(Samples<'_>)| {
            group.bench_function(BenchmarkId::new(what, slip), |b| b.iter(|| run(out.samples())));
        };
        bench("map", &mut |mut out| {
            let mut decay = Decay::new(&oscillator(), &law, 0.0, start, &mut stack[..]).expect("mode 1");
            decay.sample(1e-3, &mut out).expect("buffers agree");
        });
        bench("averaging", &mut |mut out| {
            let mut decay = Averaging::new(&oscillator(), &law, start).expect("mode 1");
            decay.sample(1e-3, &mut out).expect("buffers agree");
        });
    }
    group.finish();
}

/// Amplitude and phase at the end of a ring-down, nothing in between.
fn averaging(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("averaging");
    let law = joint();
    for (name, steps) in RING_DOWNS {
        for (slip, share) in SHARES {
            let start = Motion::held_at(share * law.phi_max());
            group.bench_function(BenchmarkId::new(name, slip), |b| {
                b.iter(|| Averaging::new(&oscillator(), &law, start).expect("mode 1").at(steps as f64 * DT));
            });
        }
    }
    group.finish();
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    map(&mut criterion);
    ring_downs(&mut criterion);
    output(&mut criterion);
    averaging(&mut criterion);
    criterion.final_summary();
}
