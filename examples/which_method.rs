//! The same decay by four methods, each compared with the event-driven solution of a fine slider population.

use std::error::Error;

use iwan::core::{FourParameter, Grid, Motion, Pulse};
use iwan::sim::{JointLaw, Method, Mode, Representation, Response, Settings, simulate};

/// Largest difference of the displacements at the samples of `exact`, relative to the largest displacement of `exact`.
fn error(response: &Response, exact: &Response) -> f64 {
    let stride = response.steps() / exact.steps();
    let pairs = response.displacement.iter().step_by(stride).zip(&exact.displacement);
    pairs.fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs())) / exact.peak_displacement()
}

#[expect(clippy::print_stdout, reason = "an example shows its result")]
pub(crate) fn main() -> Result<(), Box<dyn Error>> {
    let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3)?;
    let mode = Mode {
        damping_ratio: 2.5e-4,
        initial: Motion::held_at(0.3 * joint.phi_max()),
        ..Mode::new("bending 1", 124.0, Some(JointLaw::FourParameter(joint)))
    };
    let run = |method, dt| {
        let settings = Settings { method, quality: false, ..Settings::new(dt, 0.2) };
        simulate(&mode, &Pulse::None, &settings)
    };
    let exact = run(Method::Event { bins: 4000, grid: Grid::Geometric { ratio: 1.0025 } }, 1e-4)?;

    let newmark = |joint| Method::Newmark { beta: 0.25, gamma: 0.5, prewarp: true, joint };
    let ways = [
        ("Newmark, 100 sliders", newmark(Representation::default_sliders()), 1e-5),
        ("Newmark, continuum", newmark(Representation::Continuum), 1e-5),
        ("half-cycle map", Method::HalfCycle, 1e-4),
        ("averaging", Method::Averaging, 1e-4),
    ];
    let mut errors = Vec::new();
    for (name, method, dt) in ways {
        let response = run(method, dt)?;
        errors.push(error(&response, &exact));
        let (samples, time) = (response.steps() + 1, 1e6 * response.seconds);
        println!(
            "{name:<21} {:.1e} of the peak, {samples:>6} samples in {time:>7.0} µs",
            errors[errors.len() - 1]
        );
    }
    // The half-cycle map is exact; what is left is the discretisation error of the reference's 4000 sliders.
    assert!(errors[2] < 2e-6, "{errors:?}");
    assert!(errors[2] < errors[1] && errors[1] < errors[0] && errors[0] < errors[3], "{errors:?}");
    Ok(())
}
