//! How long do a steady loop, a forced response and a nonlinear mode take?

mod support;

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput};
use iwan::core::{FourParameter, Harmonics, SteadyWork, TabledFourParameter, one_harmonic, steady_force};
use iwan::fem::mesh::beam::Configuration;
use iwan::fem::{Basis, paper};
use iwan::sim::{
    Control, JointLaw, JointedModes, Mode, Residual, SlipJoint, StuckMode, Sweep, backbone, forced_response,
    forced_response_of, nonlinear_mode,
};
use support::joint;

/// A motion of seven harmonics: that of a mode with a share of higher ones, in units of its fundamental.
fn motion(harmonics: Harmonics, size: f64) -> Vec<f64> {
    let mut x = vec![0.0; harmonics.len()];
    for n in harmonics.orders() {
        let share = if n == 1 { 1.0 } else { 0.02 / (1.0 + n as f64) };
        x[harmonics.index(n)] = size * share;
        if n > 1 {
            x[harmonics.index(n) + 1] = 0.5 * size * share;
        }
    }
    x
}

/// Force and Jacobian of one joint.
fn loops(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("steady loop");
    let law: FourParameter = joint();
    let tabled = TabledFourParameter::new(law);
    let mut work = Box::new(SteadyWork::new());
    let odd = Harmonics::odd(7).expect("odd");
    let all = Harmonics::all(7).expect("all");
    for (name, harmonics) in [("odd to 7", odd), ("0 to 7", all), ("0 to 3", Harmonics::all(3).expect("all"))]
    {
        let count = harmonics.len();
        let (mut force, mut jacobian) = (vec![0.0; count], vec![0.0; count * count]);
        for (slip, share) in [("micro", 0.5), ("macro", 2.0)] {
            let x = motion(harmonics, share * law.phi_max());
            group.bench_function(BenchmarkId::new(name, slip), |b| {
                b.iter(|| {
                    steady_force(
                        &tabled,
                        harmonics,
                        black_box(&x),
                        &mut force,
                        Some(&mut jacobian),
                        &mut work,
                    )
                });
            });
        }
    }
    let (mut cosine, mut sine) = ([0.0; 4], [0.0; 4]);
    let a = 0.5 * law.phi_max();
    group.bench_function("one harmonic, closed form", |b| {
        b.iter(|| one_harmonic(&law, black_box(a), &mut cosine, &mut sine));
    });
    group.finish();
}

fn modal(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("mode");
    let mode = Mode {
        damping_ratio: 2.5e-4,
        ..Mode::new("bending 1", 124.0, Some(JointLaw::FourParameter(joint())))
    };
    let sweep = Sweep {
        from: 112.0,
        to: 128.0,
        control: Control::Force,
        levels: vec![100.0],
        harmonics: 1,
        points: 1000,
    };
    group.throughput(Throughput::Elements(1000));
    group.bench_function("forced response, 1000 points", |b| b.iter(|| forced_response(&mode, &sweep, 1.0)));
    let seven = Sweep { harmonics: 7, ..sweep };
    group.bench_function("forced response, harmonics to 7", |b| {
        b.iter(|| forced_response(&mode, &seven, 1.0));
    });
    let phi = joint().phi_max();
    let amplitudes: Vec<f64> = (0..50).map(|i| phi * 1e-3 * 1e4_f64.powf(f64::from(i) / 49.0)).collect();
    group.throughput(Throughput::Elements(50));
    group.bench_function("backbone, harmonics to 7", |b| b.iter(|| backbone(&mode, 7, &amplitudes)));
    group.finish();
}

/// The paper's beam, its joints, 50 modes and the attachment vectors.
fn beam() -> JointedModes {
    let assembled =
        paper::structure(Configuration::A, 1).expect("the paper's structure").assemble().expect("sound");
    let reduced =
        assembled.reduce(50, Basis::default()).expect("reduced").with_damping(|_| 2.5e-4).expect("damped");
    let tip = assembled.load("tip", [0.0, 0.0, 1.0]).expect("the tip");
    let model = reduced.steady_model(&tip, &tip).expect("fits");
    let modes = model.coordinates.iter().map(|c| StuckMode {
        omega: c.omega,
        damping_ratio: c.damping_ratio,
        at_force: c.at_force,
        at_output: c.at_output,
    });
    let modes = modes.collect();
    let joints = model.slips.into_iter();
    let joints =
        joints.map(|s| SlipJoint { name: s.name, law: s.law, participation: s.participation }).collect();
    JointedModes::new(modes, joints, Residual::default()).expect("elastic modes")
}

fn structure(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("beam in steady vibration");
    let system = beam();
    let bending = 6;
    let onset = system.macro_slip(bending).expect("its joints slip");
    let amplitudes: Vec<f64> = (0..50).map(|i| onset * 1e-3 * 1e4_f64.powf(f64::from(i) / 49.0)).collect();
    let name = format!("nonlinear mode, {} slips, harmonics to 7, 50 amplitudes", system.joints().len());
    group.sample_size(10);
    group.bench_function(name, |b| b.iter(|| nonlinear_mode(&system, bending, 7, &amplitudes)));
    let f = system.modes()[bending].omega / std::f64::consts::TAU;
    let sweep = Sweep {
        from: 0.9 * f,
        to: 1.05 * f,
        control: Control::Force,
        levels: vec![1.0],
        harmonics: 7,
        points: 400,
    };
    group.bench_function("forced response, harmonics to 7", |b| {
        b.iter(|| forced_response_of(&system, &sweep));
    });
    group.finish();
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    loops(&mut criterion);
    modal(&mut criterion);
    structure(&mut criterion);
    criterion.final_summary();
}
