//! Writes the figures of the book as SVG into the folder named by `IWAN_FIGURES`, or else into a temporary folder.

mod plot;

use std::error::Error;
use std::fs;
use std::path::PathBuf;

use iwan::core::{Backbone, Continuum, FourParameter, Hysteresis, Pulse, Reversal};
use iwan::sim::{JointLaw, Mode, Settings, simulate};
use plot::plot;

pub(crate) fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::var("IWAN_FIGURES")
        .map_or_else(|_| std::env::temp_dir().join("iwan-figures"), PathBuf::from);
    fs::create_dir_all(&folder)?;
    let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3)?;
    let (phi, f_s) = (joint.phi_max(), joint.f_s());
    let grid = |from: f64, to: f64, f: &dyn Fn(f64) -> f64| -> Vec<(f64, f64)> {
        (0..=200).map(|i| from + (to - from) * f64::from(i) / 200.0).map(|u| (u, f(u))).collect()
    };

    let virgin = grid(0.0, 1.5, &|u| joint.force(u * phi) / f_s);
    let closed = |amplitude: f64| -> Result<_, iwan::core::Error> {
        let continuum = Continuum::new(joint);
        let mut state = continuum.virgin([Reversal::default(); 4])?;
        let mut force = |u: f64| (u, continuum.advance(&mut state, u * phi) / f_s);
        force(amplitude);
        let swing = |i: i32| amplitude * (f64::from((i - 100).abs()) / 50.0 - 1.0);
        Ok((0..=200).map(|i| force(swing(i))).collect())
    };
    let loops =
        [("virgin curve", virgin), ("loop at 0.5 φ_max", closed(0.5)?), ("loop at 1.3 φ_max", closed(1.3)?)];
    fs::write(folder.join("loops.svg"), plot("u / φ_max", "F / F_S", (-1.5, -1.2), (1.5, 1.2), &loops))?;

    let scaled = |d: f64| (d / (f_s * phi)).log10();
    let exact = grid(-3.0, 1.0, &|x| scaled(joint.dissipation(phi * 10_f64.powf(x))));
    let printed = grid(-3.0, 1.0, &|x| scaled(joint.dissipation_printed_eq17(phi * 10_f64.powf(x))));
    let loss = [("exact", exact), ("Eq. 17 as printed", printed)];
    fs::write(
        folder.join("loss.svg"),
        plot("log10 of u / φ_max", "log10 of D / (F_S φ_max)", (-3.0, -9.0), (1.0, 3.0), &loss),
    )?;

    let mode = Mode::new("bending 1", 124.0, Some(JointLaw::FourParameter(joint)));
    let ring = |amplitude: f64| {
        let blow = Pulse::Haversine { amplitude, duration: 1.6e-3 };
        let response = simulate(&mode, &blow, &Settings::new(2e-4, 0.2))?;
        let peak = response.peak_displacement();
        let points = response.times().zip(&response.displacement).map(|(t, q)| (t, q / peak)).collect();
        Ok::<Vec<(f64, f64)>, iwan::sim::SimulationError>(points)
    };
    let rings = [("hard blow: 1.1 φ_max", ring(10_000.0)?), ("light blow: 0.001 φ_max", ring(10.0)?)];
    fs::write(folder.join("ring_down.svg"), plot("time, s", "q / peak", (0.0, -1.4), (0.2, 1.0), &rings))?;
    Ok(())
}
