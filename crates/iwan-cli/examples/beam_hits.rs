//! Writes hits on the paper's beam into a folder: three levels of five hits at 54 points and at the hammer, noise 40 dB, and the exact records of mode 1.
//! `scripts/validate` goes the whole way from there.
#![allow(clippy::expect_used, reason = "a program of the validation")]

#[path = "../tests/common/beam.rs"]
mod beam;

use std::path::PathBuf;

use beam::Beam;

fn main() {
    let folder = PathBuf::from(std::env::args().nth(1).expect("usage: beam_hits FOLDER"));
    std::fs::create_dir_all(&folder).expect("a folder");
    let beam = Beam::new();
    for (level, force) in [30.0, 100.0, 300.0].into_iter().enumerate() {
        let blow = beam.hit(force);
        for hit in 0..5 {
            let name = format!("level-{}-hit-{}.npz", level + 1, hit + 1);
            blow.write(&folder.join(name), (5 * level + hit) as u64);
        }
        blow.write_mode(&folder.join(format!("mode-{}.npz", level + 1)));
    }
}
