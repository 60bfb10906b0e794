//! What does the event-driven reference cost per sample and per event?

mod support;

use criterion::{BenchmarkId, Criterion, Throughput};
use iwan::core::{EventDriven, Hysteresis, Pulse, Run};
use support::{Buffers, PULSE, Population, grids, joint, oscillator};

/// Two cycles, sampled coarsely, so that events and series count and not the samples.
const DT: f64 = 1e-4;
const SAMPLES: usize = 162;

fn events(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("events");
    group.throughput(Throughput::Elements(SAMPLES as u64 - 1)).sample_size(20);
    let mut out = Buffers::new(SAMPLES);
    for bins in [100, 1000] {
        for (name, grid) in grids(bins) {
            let mut population = Population::new(grid, bins);
            let sliders = population.sliders();
            for (kind, pulse, start) in [
                ("decay", Pulse::None, 0.107 * joint().phi_max()),
                ("pulse", Pulse::Haversine { amplitude: 1e3, duration: PULSE }, 0.0),
            ] {
                let solver = EventDriven::new(&oscillator(), sliders, pulse, 1.0).expect("mode 1");
                group.bench_function(BenchmarkId::new(format!("{name}/{bins}"), kind), |b| {
                    b.iter(|| {
                        let mut state = sliders.virgin(vec![Run::default(); sliders.len()]).expect("room");
                        sliders.advance(&mut state, start);
                        solver.integrate(&mut state, 0.0, DT, &mut out.samples())
                    });
                });
            }
        }
    }
    group.finish();
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    events(&mut criterion);
    criterion.final_summary();
}
