//! How do we stand beside a linear oscillator, the peers and our own slower ways? One interleaved run.
//!
//! Every round runs every contestant once; figures are medians over the rounds, ratios are taken round by round,
//! so that a busy machine slows both sides of a ratio. `scripts/bench` builds the peers and calls this.
//!
//! usage: ratios [--peer PROGRAM] [--python PYTHON SCRIPT] [--rounds N] [--json FILE]
#![allow(clippy::print_stdout, reason = "a table is its result")]

#[path = "ratios/contestants.rs"]
mod contestants;
#[path = "ratios/report.rs"]
mod report;
mod support;

use contestants::{Contestant, field};
use report::{Figures, Target};
use std::error::Error;

struct Options {
    peer: Option<String>,
    python: Option<(String, String)>,
    rounds: usize,
    json: Option<String>,
}

fn options() -> Result<Options, Box<dyn Error>> {
    let mut options = Options { peer: None, python: None, rounds: 31, json: None };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value"));
        match word.as_str() {
            "--peer" => options.peer = Some(value()?),
            "--python" => options.python = Some((value()?, value()?)),
            "--rounds" => options.rounds = value()?.parse::<usize>()?.max(1),
            "--json" => options.json = Some(value()?),
            // Cargo's own.
            "--bench" => {}
            _ => return Err(format!("unknown option {word}").into()),
        }
    }
    Ok(options)
}

/// Times in ns, one row per contestant, one column per round.
fn measure(contestants: &mut [Contestant<'_>], rounds: usize) -> Result<Vec<Vec<f64>>, Box<dyn Error>> {
    let mut times = vec![Vec::with_capacity(rounds); contestants.len()];
    for round in 0..=rounds {
        for (contestant, times) in contestants.iter_mut().zip(&mut times) {
            let time = (contestant.run)()?;
            // The first round warms up.
            if round > 0 {
                times.push(time);
            }
        }
    }
    Ok(times)
}

fn main() -> Result<(), Box<dyn Error>> {
    let options = options()?;
    contestants::check_linear()?;
    let checked = options.peer.as_deref().map(contestants::check_peer).transpose()?;
    let half_cycles = contestants::check_map()?;
    let mut field = field(options.peer.as_deref(), half_cycles)?;
    let times = measure(&mut field, options.rounds)?;
    let mut figures = Figures::new(field.iter().map(|c| c.name.clone()).zip(times).collect());
    if let Some((python, script)) = &options.python {
        figures.add_slow(contestants::python(python, script)?);
    }
    if let Some(checked) = checked {
        println!("{checked}");
    }
    println!("ns per step (half cycle, ring-down), median of {} interleaved rounds\n", options.rounds);
    print!("{}", figures.table());
    let targets = Target::all();
    println!("\nratios, round by round\n");
    print!("{}", figures.targets(&targets));
    if let Some(file) = options.json {
        std::fs::write(file, figures.json(&targets))?;
    }
    Ok(())
}
