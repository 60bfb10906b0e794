//! How long does identification take: curves and least squares, one evaluation of the model, all with intervals?

mod support;

use std::hint::black_box;

use criterion::{BatchSize, Criterion, Throughput};
use iwan::core::{Decay, Reversal, Samples};
use iwan::ident::channels::Combination;
use iwan::ident::curve_fit::{fit, start};
use iwan::ident::curves::{Curves, ForceAxis, Quantity};
use iwan::ident::identify::{ModeRecord, Settings, identify};
use iwan::ident::likelihood::Buffers;
use iwan::ident::signal::{Method, Options, envelope};
use support::{joint, oscillator};

/// Channels of the long record.
const CHANNELS: usize = 3;

/// Acceleration of mode 1 after release at `ratio` φ_max, with noise 40 dB below.
fn record(ratio: f64, dt: f64, samples: usize, seed: u64) -> Vec<f64> {
    let mut out: [Vec<f64>; 4] = std::array::from_fn(|_| vec![0.0; samples]);
    let [displacement, velocity, acceleration, joint_force] = &mut out;
    let (oscillator, law) = (oscillator(), joint());
    let start = iwan::core::Motion::held_at(ratio * law.phi_max());
    Decay::new(&oscillator, &law, 0.0, start, vec![Reversal::default(); 8192])
        .and_then(|mut decay| {
            decay.sample(dt, &mut Samples { displacement, velocity, acceleration, joint_force })
        })
        .expect("a ring-down");
    let size = out[2].iter().map(|x| x * x).sum::<f64>() / samples as f64;
    let (sd, mut state) = (0.01 * size.sqrt(), seed);
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    // Twelve uniform numbers, less their mean, are normal enough here.
    out[2].iter().map(|x| x + sd * ((0..12).map(|_| uniform()).sum::<f64>() - 6.0)).collect()
}

/// 65,536 samples at 10 kHz in three channels of one mode: its shape, envelope, curves, start values, least squares.
fn curves(criterion: &mut Criterion) {
    let dt = 1e-4;
    let channels: Vec<Vec<f64>> = (1..=CHANNELS as u64).map(|seed| record(0.5, dt, 65_536, seed)).collect();
    let curves_of = |x: &Vec<f64>| {
        let envelope = envelope(x, dt, Method::Hilbert, &Options::default()).expect("an envelope");
        Curves::new(&envelope, Quantity::Acceleration, ForceAxis::Modal).expect("curves")
    };
    let mut group = criterion.benchmark_group("identification");
    group.sample_size(20);
    group.bench_function("envelopes and curves, 65,536 x 3", |b| {
        b.iter(|| channels.iter().map(curves_of).collect::<Vec<_>>());
    });
    let views: Vec<&[f64]> = channels.iter().map(Vec::as_slice).collect();
    let names = ["left", "middle", "right"].map(str::to_owned);
    group.bench_function("shape, envelope, curves, least squares of one mode, 65,536 x 3", |b| {
        b.iter(|| {
            let combination =
                Combination::dominant(&views, &names, dt, &Options::default()).expect("a shape");
            let curves = curves_of(&combination.apply(&views).expect("the mode's record"));
            let first = start(&curves).expect("start values").parameters;
            fit(&[curves], &first, &[]).expect("a fit")
        });
    });
    group.finish();
}

/// All six parameters with their intervals, and one evaluation of the likelihood with its residuals.
fn in_the_loop(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("simulation in the loop");
    group.sample_size(10);
    let cases = [
        ("0.2 s, micro-slip", 0.3, 2000),
        ("0.3 s, macro-slip", 1.5, 3000),
        ("1 s, micro-slip", 0.3, 10_000),
        ("6.6 s, macro-slip", 1.5, 65_536),
    ];
    for (name, ratio, samples) in cases {
        let x = record(ratio, 1e-4, samples, 1);
        let record = ModeRecord { samples: &x, dt: 1e-4, quantity: Quantity::Acceleration };
        let run = || identify(&[record], &Settings::default()).expect("an identification");
        let found = run();
        group.bench_function(format!("with intervals, {name}"), |b| b.iter(run));
        let likelihood = &found.likelihood;
        group.throughput(Throughput::Elements(1));
        group.bench_function(format!("evaluation, {name}"), |b| {
            b.iter_batched_ref(
                Buffers::default,
                |buffers| black_box(likelihood.log(likelihood.parameters(), likelihood.starts(), buffers)),
                BatchSize::NumIterations(1000),
            );
        });
    }
    group.finish();
}

criterion::criterion_group!(benches, curves, in_the_loop);
criterion::criterion_main!(benches);
