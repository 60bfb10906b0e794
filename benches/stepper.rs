//! How long does one time step take, beside a linear oscillator with the same outputs?

mod support;

use std::hint::black_box;

use criterion::{BenchmarkGroup, BenchmarkId, Criterion, Throughput, measurement::WallTime};
use iwan::core::{
    Continuum, CoupledJoint, CoupledMode, CoupledModes, CoupledMotion, CoupledRows, FourParameter, Grid,
    Hysteresis, Newmark, OneJoint, Oscillator, Plain, ResidualStiffness, Reversal, Run, Slider, Sliders,
    TabledFourParameter,
};
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

/// Three modes of the paper's beam, configuration A, that share one joint: scaled to a slip of 1 in mode 1.
struct Shared {
    modes: CoupledModes<[[f64; 4]; 1]>,
    law: FourParameter,
    rows: [Vec<[f64; 4]>; 3],
    of_joint: [Vec<f64>; 2],
}

impl Shared {
    const K: f64 = 31_600.0;

    fn new() -> Self {
        let mode = |frequency: f64| {
            let oscillator =
                Oscillator::new(frequency, 2.5e-4, 0.0, ResidualStiffness::Positive).expect("> 0");
            let scheme = Newmark::average_acceleration(support::DT).expect("dt > 0");
            CoupledMode { oscillator, scheme, shape_at_force: 23.0 }
        };
        let joint = CoupledJoint {
            stiffness: Self::K,
            participation: &[1.0, 0.0, -4.905],
            compliance: &[0.2875 / Self::K],
            slip_at_force: 0.0,
        };
        let modes = [132.35, 344.23, 696.24].map(mode);
        Self {
            modes: CoupledModes::new(&modes, &[joint], |_| [[0.0; 4]; 1]).expect("fits"),
            law: FourParameter::new(Self::K, 143.8, -0.3, 0.02).expect("in range"),
            rows: std::array::from_fn(|_| vec![[1.0; 4]; STEPS + 1]),
            of_joint: std::array::from_fn(|_| vec![1.0; STEPS + 1]),
        }
    }

    fn run(&mut self, sliders: Option<&Sliders<'_>>, force: &[f64]) -> f64 {
        let storage = |_| [[0.0; 4]; 1];
        let Self { modes, law, rows: [displacement, velocity, acceleration], of_joint: [slip, joint_force] } =
            self;
        let mut out = CoupledRows { displacement, velocity, acceleration, slip, joint_force };
        let rest: [&[f64]; 2] = [&[0.0; 3]; 2];
        if let Some(sliders) = sliders {
            let mut state = sliders.virgin(vec![Run::default(); sliders.len()]).expect("room");
            let motion =
                CoupledMotion::new(modes, &mut OneJoint::new(sliders, &mut state), rest, 0.0, storage);
            let mut motion = motion.expect("in balance");
            modes.integrate_sliders(&mut motion, sliders, &mut state, force, &mut out).expect("steps");
            return motion.displacement(0);
        }
        let law = Continuum::new(TabledFourParameter::new(*law));
        let mut state = law.virgin(vec![Reversal::default(); 512]).expect("room");
        let mut joint = OneJoint::new(&law, &mut state);
        let mut motion = CoupledMotion::new(modes, &mut joint, rest, 0.0, storage).expect("in balance");
        modes.integrate(&mut motion, &mut joint, force, &mut out).expect("steps");
        motion.displacement(0)
    }
}

/// One joint, three modes: the continuum, and 100 sliders.
fn coupled(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("coupled");
    group.throughput(Throughput::Elements(STEPS as u64));
    let mut shared = Shared::new();
    let mut table = vec![Slider::default(); Sliders::table_len(100)];
    let sliders = Sliders::discretise(&shared.law, Grid::graded(100), 100, &mut table).expect("room");
    for amplitude in AMPLITUDES {
        let force = force(amplitude);
        group.bench_function(BenchmarkId::new("continuum", amplitude), |b| {
            b.iter(|| black_box(shared.run(None, &force)));
        });
        group.bench_function(BenchmarkId::new("sliders/100", amplitude), |b| {
            b.iter(|| black_box(shared.run(Some(&sliders), &force)));
        });
    }
    group.finish();
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    steppers(&mut criterion);
    coupled(&mut criterion);
    criterion.final_summary();
}
