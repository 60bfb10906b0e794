//! How long do the steps of the truth model take: matrices and modes, a full and a reduced time step, a large block?

use std::hint::black_box;

use criterion::{Criterion, Throughput};
use iwan::core::Pulse;
use iwan::fem::mesh::beam::Configuration;
use iwan::fem::mesh::block::{block, uniform};
use iwan::fem::{Assembled, Basis, Limit, Material, Modes, Representation, Structure, Transient, paper};

fn beam() -> Structure {
    paper::structure(Configuration::A, 1).expect("the paper's structure")
}

/// The paper's blow, recorded in bending modes 1 to 3.
fn blow(
    assembled: &Assembled,
    modes: &Modes,
    steps: usize,
    representation: Representation,
) -> Transient<'static> {
    Transient {
        dt: 1e-5,
        steps,
        pulse: Pulse::Haversine { amplitude: 1000.0, duration: 1.6e-3 },
        load: assembled.load("tip", [0.0, 0.0, 1.0]).expect("the tip"),
        initial_velocity: None,
        representation,
        outputs: [6, 7, 8].map(|i| assembled.modal_output(format!("mode {i}"), modes, i)).to_vec(),
    }
}

fn paper_beam(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("beam");
    group.sample_size(10);
    let structure = beam();
    group.bench_function("assembly and 50 modes", |b| {
        b.iter(|| structure.assemble().expect("sound").modes(Limit::Stuck, 50).expect("modes"));
    });
    let assembled = structure.assemble().expect("sound");
    let reduced = assembled.reduce(50, Basis::default()).expect("reduced");
    for (name, representation) in
        [("sliders", Representation::DEFAULT_IN_A_STRUCTURE), ("continuum", Representation::Continuum)]
    {
        let task = blow(&assembled, reduced.modes(), 20_000, representation);
        group.throughput(Throughput::Elements(20_000));
        group.bench_function(format!("reduced step, {name}"), |b| {
            b.iter(|| black_box(reduced.transient(&task).expect("response")));
        });
    }
    let task = blow(&assembled, reduced.modes(), 200, Representation::DEFAULT_IN_A_STRUCTURE);
    group.throughput(Throughput::Elements(200));
    group
        .bench_function("full step", |b| b.iter(|| black_box(assembled.transient(&task).expect("response"))));
    group.finish();
}

/// 107,811 unknowns in a cube: three dimensions, repeated modes, the hardest fill.
fn large_block(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("block of 107811 unknowns");
    group.sample_size(10);
    let lines = uniform(-0.5, 0.5, 32);
    let mesh = block(&[lines.clone(), lines.clone(), lines]);
    let structure = Structure::new(mesh, Material::new(1.0, 0.3, 1.0).expect("a material"));
    group.bench_function("assembly", |b| b.iter(|| structure.assemble().expect("sound")));
    let assembled = structure.assemble().expect("sound");
    group.bench_function("50 modes", |b| b.iter(|| assembled.modes(Limit::Stuck, 50).expect("modes")));
    group.finish();
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    paper_beam(&mut criterion);
    large_block(&mut criterion);
    criterion.final_summary();
}
