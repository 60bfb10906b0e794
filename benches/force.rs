//! How long does one evaluation of the joint force take, and the power inside it?

mod support;

use criterion::{BenchmarkGroup, BenchmarkId, Criterion, Throughput, measurement::WallTime};
use iwan::core::{Continuum, FixedPower, Hysteresis, Plain, Reversal, Run, TabledFourParameter};
use std::hint::black_box;
use support::{Population, grids, joint};

/// Displacements of a decaying oscillation from 0.1 φ_max: 10,000 steps in 25 cycles.
fn path() -> Vec<f64> {
    let motion = |n: i32| {
        let cycles = f64::from(n) / 400.0;
        (-0.01 * cycles).exp() * (std::f64::consts::TAU * cycles).sin()
    };
    (0..10_000).map(|n| 0.1 * joint().phi_max() * motion(n)).collect()
}

fn advance<State, J: Hysteresis<State>>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    name: &str,
    path: &[f64],
    law: &J,
    mut virgin: impl FnMut() -> State,
) {
    group.bench_function(name, |b| {
        b.iter(|| {
            let mut state = virgin();
            path.iter().map(|u| law.advance(&mut state, *u)).sum::<f64>()
        });
    });
}

fn evaluations(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("advance");
    let path = path();
    group.throughput(Throughput::Elements(path.len() as u64));
    for bins in [100, 1000] {
        for (name, grid) in grids(bins) {
            let mut population = Population::new(grid, bins);
            let sliders = population.sliders();
            let virgin = || sliders.virgin(vec![Run::default(); sliders.len()]).expect("room");
            advance(&mut group, &format!("runs/{name}/{bins}"), &path, &sliders, virgin);
            let plain = Plain::new(sliders);
            let virgin = || plain.virgin(vec![0.0; sliders.len()]).expect("room");
            advance(&mut group, &format!("plain/{name}/{bins}"), &path, &plain, virgin);
        }
    }
    let tabled = Continuum::new(TabledFourParameter::new(joint()));
    let virgin = || tabled.virgin(vec![Reversal::default(); 128]).expect("room");
    advance(&mut group, "continuum/tabled", &path, &tabled, virgin);
    let untabled = Continuum::new(joint());
    let virgin = || untabled.virgin(vec![Reversal::default(); 128]).expect("room");
    advance(&mut group, "continuum/libm", &path, &untabled, virgin);
    group.finish();
}

fn powers(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("power");
    let exponent = joint().chi() + 1.0;
    let bases: Vec<f64> = (1..=4096).map(|n| 0.2 * f64::from(n) / 4096.0).collect();
    let tabled = FixedPower::new(exponent);
    let libm = |x: f64| libm::pow(x, exponent);
    let standard = |x: f64| x.powf(exponent);
    let fixed = |x: f64| tabled.at(x);
    let powers: [(&str, &dyn Fn(f64) -> f64); 3] = [("tabled", &fixed), ("libm", &libm), ("std", &standard)];
    group.throughput(Throughput::Elements(bases.len() as u64));
    for (name, power) in powers {
        group.bench_function(BenchmarkId::new("throughput", name), |b| {
            b.iter(|| bases.iter().map(|x| power(*x)).sum::<f64>());
        });
        // Each base waits for the power before: what a time step feels.
        group.bench_function(BenchmarkId::new("latency", name), |b| {
            b.iter(|| bases.iter().fold(0.5, |before: f64, x| power(x + 1e-300 * before)));
        });
    }
    group.bench_function("table", |b| b.iter(|| FixedPower::new(black_box(exponent))));
    group.finish();
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    evaluations(&mut criterion);
    powers(&mut criterion);
    criterion.final_summary();
}
