//! A mode, a blow, a ring-down: response, energy balance, frequency at start and end.

use std::error::Error;

use iwan::core::{FourParameter, Pulse};
use iwan::sim::{JointLaw, Method, Mode, Representation, Response, Settings, simulate};

/// Mean frequency, Hz, between the first and the last upward zero crossing in the time range from `from` to `to`, s.
fn frequency(response: &Response, from: f64, to: f64) -> f64 {
    let q = &response.displacement;
    let range = (from / response.dt) as usize..(to / response.dt) as usize;
    let crossings: Vec<f64> = range
        .filter(|&n| q[n] <= 0.0 && q[n + 1] > 0.0)
        .map(|n| (n as f64 + q[n] / (q[n] - q[n + 1])) * response.dt)
        .collect();
    (crossings.len() - 1) as f64 / (crossings[crossings.len() - 1] - crossings[0])
}

#[expect(clippy::print_stdout, reason = "an example shows its result")]
pub(crate) fn main() -> Result<(), Box<dyn Error>> {
    // Mode 1 of Table 2 of Deaner et al.: K_T in 1/s², F_S in mass^½·length/s².
    let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3)?;
    let mode = Mode::new("bending 1", 125.0, Some(JointLaw::FourParameter(joint)));
    let blow = Pulse::Haversine { amplitude: 1000.0, duration: 1.6e-3 };

    // Plain average acceleration on the exact continuum; `Settings::new` alone would take prewarped steps on 100 sliders.
    let method = Method::Newmark { beta: 0.25, gamma: 0.5, prewarp: false, joint: Representation::Continuum };
    let response = simulate(&mode, &blow, &Settings { method, ..Settings::new(1e-5, 0.2) })?;

    let energy = response.energy;
    println!("peak displacement {:.4e} = {:.3} phi_max", response.peak_displacement(), response.slip_ratio());
    println!("frequency {:.2} Hz at the start", frequency(&response, 0.002, 0.03));
    println!("          {:.2} Hz at the end", frequency(&response, 0.17, 0.2));
    println!("work of the blow   {:.6}", energy.input);
    println!("lost in friction   {:.6}", energy.friction);
    println!("still in motion    {:.6}", energy.kinetic + energy.elastic + energy.stored);
    println!("balance closes to  {:.1e}", energy.error());

    // Three independent codes agree on this displacement at t = 0.2 s.
    let last = response.displacement[20_000];
    println!("displacement at the end {last:.6e}");
    assert!((last / -7.303701e-4 - 1.0).abs() < 1e-6);
    assert!(energy.error() < 1e-10);
    Ok(())
}
