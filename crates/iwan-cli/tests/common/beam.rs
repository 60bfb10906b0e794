//! Hits on the paper's beam as 54 sensors and one at the hammer see them, with the exact record of mode 1 beside them.
#![allow(dead_code, clippy::expect_used, reason = "tests and validation may panic, each uses its part")]

use std::fmt::Write;
use std::fs::File;
use std::path::Path;

use iwan_core::{Pulse, SplitMix64};
use iwan_fem::{Basis, NamedModes, Output, Representation, Transient};
use iwan_input::{InputText, StructureFile, built_in_structure};
use iwan_io::Table;

/// Samples a second: 96 in a cycle of mode 1.
const RATE: f64 = 12_800.0;
/// Steps of the integration for each sample.
const STEPS: usize = 2;
/// Samples before the hit.
const BEFORE: usize = 64;
/// Length of a record after that, s: 200 cycles of mode 1.
const SECONDS: f64 = 1.5;
/// Length of the blow, s.
const BLOW: f64 = 1.6e-3;
/// What the suspension takes of every elastic mode.
const SUSPENSION: f64 = 2.5e-4;
/// Modes of the reduced model.
const MODES: usize = 50;
/// Noise: root mean square over that of each response, 40 dB.
const NOISE: f64 = 1e-2;

/// The beam with sets for 54 points along both edges of its top face.
pub(crate) struct Beam {
    file: StructureFile,
    named: NamedModes,
}

/// What sensors see of a hit, and how mode 1 moves.
pub(crate) struct Blow {
    force: Vec<f64>,
    sensors: Vec<(String, Vec<f64>)>,
    /// Acceleration of mode 1.
    mode: Vec<f64>,
}

impl Beam {
    pub(crate) fn new() -> Self {
        let mut text = built_in_structure("paper-a").expect("built in").text;
        for k in 0..54 {
            let (x, y) = (-9.75 + 0.75 * f64::from(k % 27), if k < 27 { -1.0 } else { 1.0 });
            let name = format!("p{}", k + 1);
            let place = |d: f64| format!("[{}, {}, {}]", x + d, y + d, 0.25 + d);
            // Writing to a string cannot fail.
            let _ = write!(
                text,
                "\n[[set]]\nkind = \"box\"\nname = \"{name}\"\nlow = {}\nhigh = {}\n[[output]]\nname = \"{name}\"\nnodes = \"{name}\"\ndirection = \"z\"\n",
                place(-1e-3),
                place(1e-3)
            );
        }
        let file = StructureFile::read(&InputText::built_in("beam.toml", &text)).expect("a structure");
        let named = NamedModes::new(&file.structure, 12).expect("modes");
        Self { file, named }
    }

    /// A blow of a peak force in lbf at the tip.
    pub(crate) fn hit(&self, amplitude: f64) -> Blow {
        let assembled = &self.named.assembled;
        let modes = self.named.chosen(&["bending 1".to_owned()]).expect("mode 1");
        let outputs: Vec<Output> = self.file.recorded(&self.named, &modes).expect("outputs");
        let pulse = Pulse::Haversine { amplitude, duration: BLOW };
        let dt = 1.0 / (STEPS as f64 * RATE);
        let reduced = assembled.reduce(MODES, Basis::default()).and_then(|r| r.with_damping(|_| SUSPENSION));
        let response = reduced.expect("a basis").transient(&Transient {
            dt,
            steps: (SECONDS / dt) as usize,
            pulse,
            load: self.file.forces(assembled).expect("a load"),
            initial_velocity: None,
            representation: Representation::DEFAULT_IN_A_STRUCTURE,
            outputs,
        });
        let outputs = response.expect("a response").outputs;
        let sampled = |x: &[f64]| -> Vec<f64> {
            std::iter::repeat_n(0.0, BEFORE).chain(x.iter().step_by(STEPS).copied()).collect()
        };
        let mode = sampled(&outputs[0].acceleration);
        let names = self.file.outputs.iter().map(|o| o.name.clone());
        let sensors = names.zip(&outputs[1..]).map(|(n, o)| (n, sampled(&o.acceleration))).collect();
        let at = |n: usize| {
            let t = n as f64 / RATE - BEFORE as f64 / RATE;
            let inside = (0.0..BLOW).contains(&t);
            if inside { 0.5 * amplitude * (1.0 - (std::f64::consts::TAU * t / BLOW).cos()) } else { 0.0 }
        };
        Blow { force: (0..mode.len()).map(at).collect(), sensors, mode }
    }
}

impl Blow {
    /// Writes the hit with noise of a seed.
    pub(crate) fn write(&self, path: &Path, seed: u64) {
        let mut random = SplitMix64::new(seed);
        // Twelve uniform numbers make a normal one well enough for noise.
        let mut normal = move || (0..12).map(|_| random.next_symmetric()).sum::<f64>() * 0.5;
        let peak = self.force.iter().fold(0.0_f64, |m, f| m.max(*f));
        let force: Vec<f64> = self.force.iter().map(|f| f + 1e-4 * peak * normal()).collect();
        let mut columns = vec![("t".to_string(), self.times()), ("hammer".to_string(), force)];
        for (name, x) in &self.sensors {
            let rms = (x.iter().map(|x| x * x).sum::<f64>() / x.len() as f64).sqrt();
            columns.push((name.clone(), x.iter().map(|x| x + NOISE * rms * normal()).collect()));
        }
        save(path, &columns);
    }

    /// Writes the record of mode 1 as it is.
    pub(crate) fn write_mode(&self, path: &Path) {
        save(path, &[("t".to_string(), self.times()), ("q".to_string(), self.mode.clone())]);
    }

    fn times(&self) -> Vec<f64> {
        (0..self.mode.len()).map(|n| n as f64 / RATE).collect()
    }
}

fn save(path: &Path, columns: &[(String, Vec<f64>)]) {
    let columns = columns.iter().map(|(name, values)| (name.clone(), values.as_slice())).collect();
    let table = Table::new(columns).expect("columns");
    table.npz_to(File::create(path).expect("a file")).expect("written");
}
