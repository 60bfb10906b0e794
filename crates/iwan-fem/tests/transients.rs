//! Transients of the paper's beam: full model, reduced model, and a second program that shares no code with the library
//! (tests/peers/beam.py of the project prints its numbers).
#![allow(clippy::unwrap_used, reason = "a failed test may panic")]

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::Mutex;
use std::sync::OnceLock;

use iwan_core::Pulse;
use iwan_core::progress::UNWATCHED;
use iwan_fem::mesh::beam::Configuration;
use iwan_fem::{
    Assembled, Basis, Class, Error, Extras, Limit, ModalVelocity, Model, Modes, NamedModes, Output,
    Representation, StructureResponse, Transient, Watch, paper,
};

struct Beam {
    assembled: Assembled,
    modes: Modes,
    bending: Vec<usize>,
}

fn beam() -> &'static Beam {
    static BEAM: OnceLock<Beam> = OnceLock::new();
    BEAM.get_or_init(|| {
        let assembled = paper::structure(Configuration::A, 1).unwrap().assemble().unwrap();
        let modes = assembled.modes(Limit::Stuck, 50).unwrap();
        let bending = (0..20).filter(|&i| assembled.classify(&modes, i) == Class::Bending).collect();
        Beam { assembled, modes, bending }
    })
}

/// The paper's blow at the tip, recorded in bending modes 1 to 3.
fn blow(amplitude: f64, steps: usize) -> Transient<'static> {
    let Beam { assembled, modes, bending } = beam();
    Transient {
        dt: 1e-5,
        steps,
        pulse: Pulse::Haversine { amplitude, duration: 1.6e-3 },
        load: assembled.load("tip", [0.0, 0.0, 1.0]).unwrap(),
        initial_velocity: None,
        representation: Representation::DEFAULT_IN_A_STRUCTURE,
        outputs: (0..3)
            .map(|r| assembled.modal_output(format!("bending {}", r + 1), modes, bending[r]))
            .chain([assembled.output("tip", "tip", [0.0, 0.0, 1.0]).unwrap()])
            .collect(),
    }
}

fn peak(x: &[f64]) -> f64 {
    x.iter().fold(0.0_f64, |m, x| m.max(x.abs()))
}

/// Root mean square of the difference, relative to that of the reference.
fn distance(x: &[f64], reference: &[f64]) -> f64 {
    let square = |x: &mut dyn Iterator<Item = f64>| x.map(|x| x * x).sum::<f64>();
    let difference = square(&mut x.iter().zip(reference).map(|(a, b)| a - b));
    (difference / square(&mut reference.iter().copied())).sqrt()
}

fn slip_ratio(response: &StructureResponse) -> f64 {
    response.slips.iter().fold(0.0_f64, |m, s| m.max(s.slip_ratio))
}

/// Peaks of |q''| of bending modes 1, 2, 3 and the largest slip over φ_max, to the digits that tests/peers/beam.py prints.
#[test]
fn peaks_are_those_of_a_second_program() {
    let reduced = beam().assembled.reduce(50, Basis::default()).unwrap();
    assert_eq!(reduced.coordinates(), 58);
    for (amplitude, peaks, slip) in [
        (10.0, [220.79, 328.56, 337.48], 0.0289),
        (100.0, [2207.6, 3285.6, 3349.6], 0.301),
        (1000.0, [22061.0, 32850.0, 32865.0], 7.69),
    ] {
        let response = reduced.transient(&blow(amplitude, 20_000)).unwrap();
        for (history, expected) in response.outputs.iter().zip(peaks) {
            let found = peak(&history.acceleration);
            assert!((found / expected - 1.0).abs() < 5e-5, "{amplitude} {} {found} {expected}", history.name);
        }
        assert!((slip_ratio(&response) / slip - 1.0).abs() < 2e-3, "{}", slip_ratio(&response));
        assert!(response.energy.error() < 1e-12, "{}", response.energy.error());
    }
}

/// The reduced model against the full one, with and without attachment vectors.
#[test]
fn reduced_agrees_with_full_and_only_with_attachment_vectors() {
    let steps = 20_000;
    let reduced = beam().assembled.reduce(50, Basis::default()).unwrap();
    let without = beam().assembled.reduce(50, Basis::Modes).unwrap();
    for (amplitude, tolerance, without_attachments) in [(10.0, 1e-5, 1e-4), (1000.0, 5e-4, 0.3)] {
        let task = blow(amplitude, steps);
        let full = beam().assembled.transient(&task).unwrap();
        assert!(full.energy.error() < 1e-12, "{}", full.energy.error());
        let errors = |response: &StructureResponse| -> Vec<f64> {
            let pairs = response.outputs.iter().zip(&full.outputs);
            pairs.map(|(a, b)| distance(&a.acceleration, &b.acceleration)).collect()
        };
        let (with, bare) =
            (errors(&reduced.transient(&task).unwrap()), errors(&without.transient(&task).unwrap()));
        assert!(with[0] < tolerance, "{amplitude} {with:?}");
        assert!(bare[0] > without_attachments && bare[0] > 30.0 * with[0], "{amplitude} {bare:?}");
    }
}

/// The basis grows until the outputs change no more; a tolerance that cannot be reached is reported as a status, not as an error.
#[test]
fn the_basis_grows_until_the_outputs_stand_still() {
    let mut task = blow(100.0, 1000);
    task.outputs.truncate(1);
    let good = beam().assembled.reduced_transient(&task, 1e-3).unwrap();
    let modes = good.reduced.modes().len();
    assert!(good.converged && good.error < 1e-3 && modes <= 100, "{modes} {}", good.error);
    let full = beam().assembled.transient(&task).unwrap();
    let actual = distance(&good.response.outputs[0].acceleration, &full.outputs[0].acceleration);
    assert!(actual < good.error, "{actual} {}", good.error);
    task.outputs.clear();
    assert!(beam().assembled.reduced_transient(&task, 1e-3).is_err());
}

/// The continuum and 100 graded sliders give the same response; a long history of the joint does not affect the energy balance.
#[test]
fn sliders_and_continuum_agree() {
    let reduced = beam().assembled.reduce(50, Basis::default()).unwrap();
    let sliders = reduced.transient(&blow(1000.0, 5000)).unwrap();
    let continuum = reduced
        .transient(&Transient { representation: Representation::Continuum, ..blow(1000.0, 5000) })
        .unwrap();
    assert_eq!(continuum.forgotten_force, 0.0);
    assert!(continuum.energy.error() < 1e-12, "{}", continuum.energy.error());
    let apart = distance(&sliders.outputs[0].acceleration, &continuum.outputs[0].acceleration);
    assert!(apart < 5e-3, "{apart}");
}

/// Frequency and energy loss per cycle of mode 1 near a time, by a demodulation over six cycles with a Hann window.
fn demodulate(acceleration: &[f64], dt: f64, near: f64, time: f64) -> (f64, f64) {
    let omega = 2.0 * std::f64::consts::PI * near;
    let half = (3.0 / near / dt).round() as usize;
    let at = |centre: usize| -> (f64, f64) {
        let (mut c, mut s) = (0.0, 0.0);
        for (k, a) in acceleration.iter().enumerate().take(centre + half + 1).skip(centre - half) {
            let u = (k as f64 - centre as f64) / half as f64;
            let weight = 0.5 * (1.0 + (std::f64::consts::PI * u).cos());
            let phase = omega * k as f64 * dt;
            c += weight * a * phase.cos();
            s -= weight * a * phase.sin();
        }
        (c.hypot(s) * 2.0 / half as f64, s.atan2(c))
    };
    let (n, lag) = ((time / dt).round() as usize, (0.5 / near / dt).round() as usize);
    let ((a0, p0), (a1, p1)) = (at(n - lag), at(n + lag));
    let mut turn = p1 - p0;
    turn -= (turn / (2.0 * std::f64::consts::PI)).round() * 2.0 * std::f64::consts::PI;
    let span = 2.0 * lag as f64 * dt;
    let frequency = near + turn / (2.0 * std::f64::consts::PI * span);
    let w = 2.0 * std::f64::consts::PI * frequency;
    let energy = |a: f64| 0.5 * (a / w).powi(2);
    (frequency, (energy(a0) - energy(a1)) / (span * frequency))
}

/// Frequency and dissipation of mode 1 at 30, 100 and 170 ms under an impact that excites all modes, to the digits that
/// tests/peers/beam.py prints, which demodulates in the same way.
#[test]
fn mode_one_curves_are_those_of_a_second_program() {
    let reduced = beam().assembled.reduce(50, Basis::default()).unwrap();
    for (amplitude, frequencies, losses) in [
        (10.0, [132.192, 132.198, 132.202], [8.88e-5, 8.54e-5, 7.76e-5]),
        (100.0, [131.520, 131.653, 131.743], [4.68e-2, 3.13e-2, 2.08e-2]),
        (1000.0, [128.257, 129.253, 130.474], [11.9, 5.25, 1.32]),
    ] {
        let response = reduced.transient(&blow(amplitude, 20_000)).unwrap();
        let q = &response.outputs[0].acceleration;
        for (i, time) in [0.03, 0.1, 0.17].into_iter().enumerate() {
            let (frequency, loss) = demodulate(q, 1e-5, frequencies[i], time);
            assert!((frequency - frequencies[i]).abs() < 2e-3, "{amplitude} {time}: {frequency} Hz");
            assert!((loss / losses[i] - 1.0).abs() < 5e-3, "{amplitude} {time}: loss {loss}");
        }
    }
}

/// Each model can be run through the common entry point, and a run that is stopped or too large ends with an error.
#[test]
fn models_by_their_names() {
    let (assembled, task) = (&beam().assembled, blow(10.0, 600));
    let shares = Mutex::new(Vec::new());
    let heard = |share: f64| {
        shares.lock().unwrap().push(share);
        ControlFlow::Continue(())
    };
    let basis = assembled.integrate(Model::Basis(50), &task, &heard).unwrap();
    let shares = shares.into_inner().unwrap();
    // Two stages report progress: the search for modes, then the run.
    assert!(shares[0] == 0.0 && shares.windows(2).all(|s| s[1] >= s[0]), "{shares:?}");
    assert_eq!(shares[shares.len() - 2..], [256.0, 512.0].map(|n| 0.5 + 0.5 * (n / 600.0)));
    let reduced = assembled.reduce(50, Basis::default()).unwrap();
    assert_eq!(basis.response.outputs, reduced.transient(&task).unwrap().outputs);
    assert_eq!((basis.basis(), basis.basis_error), (Some(50), None));
    let full = assembled.integrate(Model::Full, &blow(10.0, 50), UNWATCHED).unwrap();
    assert_eq!(full.response.outputs, assembled.transient(&blow(10.0, 50)).unwrap().outputs);
    let found = assembled.integrate(Model::Tolerance(0.5), &task, UNWATCHED).unwrap();
    assert_eq!(found.basis_error.map(|error| error.converged), Some(true));

    // The scheme is of second order: the error with half the step is a quarter of that with the whole step.
    let errors = reduced.step_errors(&task, &basis.response, UNWATCHED).unwrap();
    let fine = Transient { dt: 0.5 * task.dt, steps: 2 * task.steps, ..task.clone() };
    let smaller = reduced.step_errors(&fine, &reduced.transient(&fine).unwrap(), UNWATCHED).unwrap();
    for (coarse, fine) in errors.time_step.iter().zip(&smaller.time_step) {
        assert!((coarse / fine / 4.0 - 1.0).abs() < 0.1, "{coarse} {fine}");
    }
    let continuum = Transient { representation: Representation::Continuum, ..task.clone() };
    let exact = reduced.transient(&continuum).unwrap();
    assert_eq!(reduced.step_errors(&continuum, &exact, UNWATCHED).unwrap().sliders, None);

    let off = |_: f64| ControlFlow::Break(());
    for model in [Model::Full, Model::Basis(50), Model::Tolerance(0.5)] {
        assert_eq!(assembled.integrate(model, &task, &off).unwrap_err(), Error::Interrupted);
    }
    // As many modes as there are unknowns, and no more: a basis is not cut in silence.
    let most = assembled.unknowns();
    for modes in [0, most + 1] {
        let error = assembled.integrate(Model::Basis(modes), &task, UNWATCHED).unwrap_err();
        assert_eq!(error, Error::Modes { name: "basis", value: modes, most }, "{error}");
    }
    let endless = Transient { steps: usize::MAX, ..task };
    let error = assembled.integrate(Model::Basis(50), &endless, UNWATCHED).unwrap_err();
    assert!(error.to_string().contains("8 GB"), "{error}");
}

/// Modes by names, the range of amplitudes, and the end of quasi-static curves.
#[test]
fn modes_have_names_and_amplitudes() {
    let modes = NamedModes::new(&paper::structure(Configuration::A, 1).unwrap(), 5).unwrap();
    let names: Vec<&str> = modes.elastic.iter().map(|mode| mode.name.as_str()).collect();
    assert_eq!(names, ["bending 1", "bending 2", "bending 3", "torsion 1", "lateral 1"]);
    assert_eq!(modes.chosen(&[]).unwrap(), modes.first_bending());
    assert_eq!(
        modes.named("sway").unwrap_err().to_string().split("; ").next(),
        Some("there is no mode \"sway\"")
    );
    let mode = modes.named("bending 1").unwrap();
    let onset = modes.onset(mode).unwrap();
    let range = modes.amplitudes(mode, (None, None), 5).unwrap();
    assert!(
        (range[0] / (1e-3 * onset) - 1.0).abs() < 1e-12 && (range[4] / (10.0 * onset) - 1.0).abs() < 1e-12
    );
    assert!(range.windows(2).all(|q| (q[1] / q[0] / 10.0 - 1.0).abs() < 1e-12));
    for (ends, points) in [((Some(2.0), Some(1.0)), 5), ((Some(-1.0), None), 5), ((None, None), 1)] {
        assert!(matches!(modes.amplitudes(mode, ends, points), Err(Error::OutOfRange { .. })));
    }
    // Far beyond macro-slip the parts slide freely.
    let far = [onset, 1e9 * onset];
    assert_eq!(modes.static_curves(mode, &far, false).unwrap().displacement, [onset]);
    assert!(modes.static_curves(mode, &far, true).is_err());
}

/// With stuck joints and modal damping, the amplitude of a mode decays as exp(-ζ ω t), and the energy balance closes.
#[test]
fn modal_damping_is_that_of_the_modes() {
    let Beam { assembled, modes, bending } = beam();
    let zeta = 0.01;
    let reduced = assembled.reduce(50, Basis::default()).unwrap().with_damping(|_| zeta).unwrap();
    let omega = modes.eigenvalue(bending[0]).sqrt();
    let task = Transient {
        pulse: Pulse::None,
        // The amplitude is so small that friction, which grows with its third power, has no effect.
        initial_velocity: Some(modes.shape(bending[0]).iter().map(|x| 1e-6 * x).collect()),
        ..blow(0.0, 10_000)
    };
    let response = reduced.transient(&task).unwrap();
    let q = &response.outputs[0];
    for n in [2_000, 5_000, 10_000] {
        let t = n as f64 * task.dt;
        let damped = omega * (1.0_f64 - zeta * zeta).sqrt();
        let exact = 1e-6 / damped * (-zeta * omega * t).exp();
        // The amplitude follows from displacement and velocity together.
        let (x, v) = (q.displacement[n], q.velocity[n]);
        let amplitude = x.hypot((v + zeta * omega * x) / damped);
        assert!((amplitude / exact - 1.0).abs() < 1e-3, "{t}: {amplitude} {exact}");
    }
    assert!(response.energy.error() < 1e-12 && response.energy.viscous > 0.5 * response.energy.initial);
    assert!(assembled.reduce(10, Basis::default()).unwrap().with_damping(|_| -0.1).is_err());
}

fn named() -> &'static NamedModes {
    static NAMED: OnceLock<NamedModes> = OnceLock::new();
    NAMED.get_or_init(|| NamedModes::new(&paper::structure(Configuration::A, 1).unwrap(), 4).unwrap())
}

/// A mode that moves alone, and so little that its joints are stuck: q = v/ω sin ωt, with a joint force of K_T q (Deaner et al., Eq. 5).
#[test]
fn a_run_from_a_moving_mode_is_its_sine() {
    let named = named();
    let mode = named.named("bending-1").unwrap().clone();
    let omega = 2.0 * std::f64::consts::PI * named.frequency_stuck(&mode);
    let velocity = 1e-10;
    let moving = [ModalVelocity { mode: "bending 1".into(), velocity }];
    assert_eq!(named.velocity(&[]).unwrap(), None);
    let task = Transient {
        dt: 2e-5,
        steps: 1000,
        pulse: Pulse::None,
        load: vec![0.0; named.assembled.unknowns()],
        initial_velocity: named.velocity(&moving).unwrap(),
        representation: Representation::DEFAULT_IN_A_STRUCTURE,
        outputs: vec![named.assembled.modal_output("bending 1", &named.stuck, mode.pair.stuck)],
    };
    let extras = Extras { errors: true, frames: 3 };
    let run = named.run(vec![mode.clone()], Model::Basis(12), &task, extras, UNWATCHED).unwrap();
    let (q, size) = (&run.response.outputs[0].displacement, velocity / omega);
    let sine = |n: usize| size * (omega * task.dt * n as f64).sin();
    let off = (0..q.len()).fold(0.0_f64, |most, n| most.max((q[n] - sine(n)).abs())) / size;
    let told = run.errors.clone().unwrap();
    assert!(off < 5e-3 && told.time_step[0] > 0.5 * off && told.time_step[0] < 2.0 * off, "{off} {told:?}");
    assert!(told.sliders.as_ref().unwrap()[0] < 1e-5);
    for (n, force) in run.joint_forces[0].iter().enumerate() {
        assert!((force - mode.pair.k_t * q[n]).abs() < 1e-4 * mode.pair.k_t * size, "{n}");
    }
    // Pictures at the beginning, halfway and at the end show the mode shape times q.
    let shape = named.assembled.displacements(named.stuck.shape(mode.pair.stuck));
    let widest = shape.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    assert_eq!(run.frames.iter().map(|f| f.time).collect::<Vec<_>>(), [0.0, 0.01, 0.02]);
    for (frame, n) in run.frames.iter().zip([0, 500, 1000]) {
        for (u, phi) in frame.displacement.iter().zip(&shape) {
            assert!((u - q[n] * phi).abs() < 1e-4 * size * widest, "{n} {u} {}", q[n] * phi);
        }
    }
    assert_eq!((run.basis, run.basis_error), (Some(12), None));
    // The full model returns the response only.
    let short = Transient { steps: 20, ..task };
    let full = named.run(vec![mode], Model::Full, &short, extras, UNWATCHED).unwrap();
    assert!(full.errors.is_none() && full.frames.is_empty() && full.basis.is_none());
    assert!((full.response.outputs[0].displacement[20] / q[20] - 1.0).abs() < 1e-4);
    let missing = [ModalVelocity { mode: "bending 9".into(), velocity }];
    let message = named.velocity(&missing).unwrap_err().to_string();
    assert!(message.starts_with("there is no mode \"bending 9\"; choose from bending 1"), "{message}");
}

/// Modes that an earlier run kept can be used as if they were computed again, but only with the matrices to which they belong.
#[test]
fn kept_modes_serve_their_own_structure() {
    let first = named();
    let mut structure = paper::structure(Configuration::A, 1).unwrap();
    let kept = first.keep(12, UNWATCHED).unwrap();
    structure.kept = Some(Arc::new(kept.clone()));
    let again = NamedModes::new(&structure, 4).unwrap();
    assert_eq!(
        (&again.stuck, &again.slipping, &again.elastic),
        (&first.stuck, &first.slipping, &first.elastic)
    );
    let task = Transient { steps: 200, ..blow(100.0, 200) };
    let run = |named: &NamedModes, model: Model| {
        named
            .run(named.first_bending(), model, &task, Extras::default(), UNWATCHED)
            .map(|r| r.response.outputs)
    };
    assert_eq!(run(&again, Model::Kept).unwrap(), run(first, Model::Basis(12)).unwrap());
    let message = run(first, Model::Kept).unwrap_err().to_string();
    assert!(
        message.contains("the structure was not opened from the folder of one; name the folder"),
        "{message}"
    );
    let mut short = kept;
    short.slipping.vectors.pop();
    structure.kept = Some(Arc::new(short));
    let message = NamedModes::new(&structure, 4).unwrap_err().to_string();
    assert!(message.contains("`slipping` has") && message.contains("for 4514 unknowns"), "{message}");
    structure.material = iwan_fem::Material::new(28.1e6, 0.29, 7.48e-4).unwrap();
    let message = NamedModes::new(&structure, 4).unwrap_err().to_string();
    assert!(message.contains("stiffness or mass of its structure are not those it was made of"), "{message}");
}

/// A duration that is a multiple of the step has all its steps; tasks that do not fit the structure are refused with what was found.
#[test]
fn tasks_are_checked_before_they_are_run() {
    assert_eq!((Transient::steps_in(1e-5, 0.2), Transient::steps_in(1e-5, 0.2 - 1e-9)), (20_000, 19_999));
    assert_eq!(Transient::steps_in(0.1, 0.3), 3);
    let Beam { assembled, .. } = beam();
    let refused = |change: &dyn Fn(&mut Transient<'static>)| {
        let mut task = blow(10.0, 10);
        change(&mut task);
        assembled.integrate(Model::Basis(4), &task, UNWATCHED).unwrap_err().to_string()
    };
    let n = assembled.unknowns();
    for change in [
        &|task: &mut Transient<'static>| task.load.truncate(7),
        &|task: &mut Transient<'static>| task.initial_velocity = Some(vec![0.0; 7]),
        &|task: &mut Transient<'static>| {
            task.outputs.push(Output { name: "short".into(), coefficients: vec![0.0; 7] });
        },
    ] as [&dyn Fn(&mut Transient<'static>); 3]
    {
        let message = refused(change);
        let words =
            format!("a load, initial velocity or output has 7 entries, the structure has {n} unknowns");
        assert!(message.contains(&words), "{message}");
    }
    let message = refused(&|task| task.load[3] = f64::INFINITY);
    assert_eq!(message, "load, initial velocity or output = inf is out of range: must be finite");
    let message = refused(&|task| task.dt = 0.0);
    assert!(message.starts_with("time step = 0 is out of range"), "{message}");
    let message = refused(&|task| task.steps = usize::MAX);
    assert!(message.contains("the response would need more than 8 GB of memory"), "{message}");
    assert!(format!("{:?}", Watch::default()).starts_with("Watch { kept: None"));
}
