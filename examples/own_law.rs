//! A new joint law is one `impl Backbone`: here the virgin curve is a quarter of a sine.

use std::error::Error;
use std::f64::consts::FRAC_PI_2;

use iwan::core::{Backbone, Decay, Grid, Motion, Oscillator, ResidualStiffness, Reversal, Slider, Sliders};

/// F(u) = F_S sin(u K_T/F_S) up to φ_max = π F_S / (2 K_T), i.e. the density ρ = (K_T²/F_S) sin(φ K_T/F_S).
struct Sine {
    k_t: f64,
    f_s: f64,
}

impl Sine {
    fn angle(&self, u: f64) -> f64 {
        (u.abs() * self.k_t / self.f_s).min(FRAC_PI_2)
    }
}

#[rustfmt::skip]
impl Backbone for Sine {
    fn initial_stiffness(&self) -> f64 { self.k_t }
    fn slip_force(&self) -> f64 { self.f_s }
    fn strengths(&self) -> (f64, f64) { (0.0, FRAC_PI_2 * self.f_s / self.k_t) }
    fn force(&self, u: f64) -> f64 { (self.f_s * self.angle(u).sin()).copysign(u) }
    fn tangent(&self, u: f64) -> f64 { if self.angle(u) < FRAC_PI_2 { self.k_t * self.angle(u).cos() } else { 0.0 } }
    fn energy(&self, u: f64) -> f64 {
        let beyond = (u.abs() - self.strengths().1).max(0.0);
        self.f_s * (self.f_s / self.k_t * (1.0 - self.angle(u).cos()) + beyond)
    }
    // Without a Dirac part, ∫ρ dφ = K_T - K(φ) and ∫ρφ dφ = F(φ) - φ K(φ), both from 0 to φ.
    fn stiffness_below(&self, phi: f64) -> f64 { self.k_t - self.tangent(phi) }
    fn force_below(&self, phi: f64) -> f64 { self.force(phi) - phi * self.tangent(phi) }
    fn is_smooth(&self) -> bool { true }
}

#[expect(clippy::print_stdout, reason = "an example shows its result")]
pub(crate) fn main() -> Result<(), Box<dyn Error>> {
    let law = Sine { k_t: 4.45e4, f_s: 239.4 };
    let mode = Oscillator::new(124.0, 1e-3, law.k_t, ResidualStiffness::Positive)?;
    let start = Motion::held_at(0.8 * law.strengths().1);

    // The law discretised into sliders is a law itself; the comparison checks that force, density and energy are consistent.
    let mut table = vec![Slider::default(); Sliders::table_len(2000)];
    let sliders = Sliders::discretise(&law, Grid::Uniform, 2000, &mut table)?;
    let mut exact = Decay::new(&mode, &law, 0.0, start, [Reversal::default(); 64])?;
    let mut cut = Decay::new(&mode, &sliders, 0.0, start, [Reversal::default(); 64])?;
    let mut worst = 0.0_f64;
    for _ in 0..24 {
        let (a, b) = (exact.next().ok_or("at rest")?, cut.next().ok_or("at rest")?);
        println!("{:.6} s  {:+.6e}  {:+.6e}", a.time, a.displacement, b.displacement);
        worst = worst.max((a.displacement / b.displacement - 1.0).abs());
    }
    println!("largest difference {worst:.1e}");
    assert!(worst < 1e-6);
    Ok(())
}
