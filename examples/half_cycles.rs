//! From turning point to turning point, without time steps: damping against amplitude.

use std::error::Error;
use std::f64::consts::PI;

use iwan::core::{Decay, FourParameter, Motion, Oscillator, ResidualStiffness, Reversal};

#[expect(clippy::print_stdout, reason = "an example shows its result")]
pub(crate) fn main() -> Result<(), Box<dyn Error>> {
    let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3)?;
    let mode = Oscillator::new(124.0, 0.0, joint.k_t(), ResidualStiffness::Positive)?;
    // The mode is pulled to 0.1 φ_max and released; the joint's memory needs one reversal per half cycle.
    let start = 0.1 * joint.phi_max();
    let mut decay = Decay::new(&mode, &joint, 0.0, Motion::held_at(start), vec![Reversal::default(); 2100])?;

    let (mut time, mut amplitude) = (0.0, start);
    let mut curve = Vec::new();
    println!("{:>10}  {:>12}  {:>12}  {:>12}", "half cycle", "amplitude", "frequency", "damping");
    for n in 1..=2000 {
        let turn = decay.next().ok_or("at rest")?;
        let next = turn.displacement.abs();
        // Logarithmic decrement of half a cycle.
        let damping = (amplitude / next).ln() / PI;
        let mean = (amplitude * next).sqrt();
        if [1, 10, 100, 1000, 2000].contains(&n) {
            let frequency = 0.5 / (turn.time - time);
            println!("{n:>10}  {mean:>12.4e}  {frequency:>9.4} Hz  {:>10.5} %", 100.0 * damping);
        }
        curve.push((mean, damping));
        (time, amplitude) = (turn.time, next);
    }
    println!("the balance of all 2000 closes to {:.1e}", decay.energy().error());

    // In micro-slip D grows with a^(χ+3), hence the damping ratio D / (2π ω² a²) with a^(χ+1); the falling
    // frequency adds 0.002 to the slope at these amplitudes.
    let ((a, za), (b, zb)) = (curve[1000], curve[1999]);
    let slope = (za / zb).ln() / (a / b).ln();
    println!("slope of damping against amplitude {slope:.4}, chi + 1 = {:.4}", joint.chi() + 1.0);
    assert!((slope - (joint.chi() + 1.0)).abs() < 3e-3);
    assert!(decay.energy().error() < 1e-10);
    Ok(())
}
