//! Any law in closed form at any displacement: the bounds that no parallel-series Iwan model leaves.
#![no_main]

use iwan_core::{Backbone, DensityPoint, FourParameter, Jenkins, TabledFourParameter, Tabulated, Uniform};
use iwan_core_fuzz::{Bytes, four_parameter, table_of_density};
use libfuzzer_sys::fuzz_target;

/// Bounds at a displacement `u`, with what rounding may add to them.
fn check<B: Backbone>(law: &B, u: f64) {
    let (k_t, f_s, (weakest, strongest)) = (law.initial_stiffness(), law.slip_force(), law.strengths());
    assert!(
        k_t > 0.0 && f_s > 0.0 && weakest >= 0.0 && weakest <= strongest,
        "{k_t} {f_s} {weakest} {strongest}"
    );
    let near = u.abs().min(strongest);
    let (force, tangent) = (law.force(u), law.tangent(u));
    let rounding = 1e-9 * f_s + 1e-12 * k_t * near;
    assert!(
        force.abs() <= f_s + rounding && force * u >= -rounding * u.abs(),
        "force {force} of {f_s} at {u}"
    );
    assert!(force.abs() <= k_t * u.abs() + rounding, "force {force} above the line {k_t} {u}");
    assert!((-1e-9 * k_t..=k_t * (1.0 + 1e-9)).contains(&tangent), "tangent {tangent} of {k_t} at {u}");
    let (both, slope) = law.force_and_tangent(u);
    assert!(
        (both - force).abs() <= rounding && (slope - tangent).abs() <= 1e-9 * k_t,
        "{both} {force} {slope}"
    );
    let (energy, lost) = (law.energy(u), law.dissipation(u));
    let room = f_s * u.abs() + k_t * near * near;
    assert!((-1e-9 * room..=room).contains(&energy), "energy {energy} of {room} at {u}");
    assert!(
        (-1e-9 * room..=4.0 * room * (1.0 + 1e-9)).contains(&lost),
        "dissipation {lost} of {room} at {u}"
    );
    let (harmonic, also_lost) = law.stiffness_and_dissipation(u);
    assert!(
        (-1e-9 * k_t..=k_t * (1.0 + 1e-9)).contains(&harmonic),
        "harmonic stiffness {harmonic} of {k_t} at {u}"
    );
    assert!((also_lost - lost).abs() <= 1e-9 * room, "{also_lost} {lost} at {u}");
    let (k, f) = (law.stiffness_below(u.abs()), law.force_below(u.abs()));
    assert!((-1e-9 * k_t..=k_t * (1.0 + 1e-9)).contains(&k), "{k} of {k_t} below {u}");
    assert!(f >= -rounding && f <= f_s + rounding, "{f} of {f_s} below {u}");
}

fn at_all<B: Backbone>(law: &B, bytes: &mut Bytes<'_>) {
    let strongest = law.strengths().1;
    for u in [0.0, strongest, -strongest, strongest * (1.0 - 1e-16)] {
        check(law, u);
    }
    while !bytes.is_empty() {
        check(law, bytes.displacement(strongest));
    }
}

fuzz_target!(|bytes: &[u8]| {
    let mut bytes = Bytes::new(bytes);
    match bytes.byte() % 5 {
        0 => {
            if let Ok(law) = four_parameter(&mut bytes) {
                at_all(&law, &mut bytes);
            }
        }
        1 => {
            if let Ok(law) = four_parameter(&mut bytes) {
                at_all(&TabledFourParameter::new(law), &mut bytes);
            }
        }
        2 => {
            if let Ok(law) = Jenkins::new(bytes.positive(), bytes.positive()) {
                at_all(&law, &mut bytes);
            }
        }
        3 => {
            if let Ok(law) = Uniform::new(bytes.positive(), bytes.positive(), bytes.share()) {
                at_all(&law, &mut bytes);
            }
        }
        _ => {
            let (strength, density, dirac) = table_of_density(&mut bytes);
            let points = vec![DensityPoint::default(); strength.len()];
            if let Ok(law) = Tabulated::new(&strength, &density, dirac, points) {
                at_all(&law, &mut bytes);
            }
        }
    }
    let _ = FourParameter::from_density(bytes.number(), bytes.number(), bytes.number(), bytes.number());
});
