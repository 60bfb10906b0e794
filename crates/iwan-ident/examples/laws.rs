//! Which law is named on simulated records of each, and how often its intervals hold the truth.
//!
//! `laws COUNT DECIBELS [LAW]`: random ring-downs of every law by time steps, with noise of so many decibels below the first
//! amplitude. `scripts/validate` runs it; the last figures stand in the book's chapter on validation.

#[path = "../tests/law_records/mod.rs"]
mod law_records;

use iwan_ident::curves::Quantity;
use iwan_ident::identify::{ModeRecord, Settings, compare_laws};
use law_records::{LAWS, noisy, ring_down};

#[derive(Default)]
struct Tally {
    named: u32,
    /// Another law named that is as good: the criterion of the true one within 6 of the best, or the true one contained.
    within: u32,
    refused: u32,
    closed: u32,
    held: u32,
    seconds: f64,
    others: Vec<(&'static str, f64)>,
}

#[allow(clippy::print_stderr)] // a program for the terminal
fn trial(law: &str, seed: u64, decibels: f64, tally: &mut Tally) {
    let clean = ring_down(law, seed);
    let samples = noisy(&clean, decibels, seed);
    let record = ModeRecord { samples: &samples, dt: clean.dt, quantity: Quantity::Displacement };
    let begun = std::time::Instant::now();
    let found = match compare_laws(&[record], &Settings::default()) {
        Ok(found) => found,
        Err(error) => {
            eprintln!("{law} {seed} refused: {error}");
            tally.refused += 1;
            return;
        }
    };
    tally.seconds += begun.elapsed().as_secs_f64();
    if std::env::var_os("ALL").is_some() {
        eprintln!("{law} {seed} noise {:.2e} truth {:?}", found.noise[0], clean.truth);
        let b = &found.backbone;
        eprintln!(
            "   a {:.3?}\n   f {:.4?}\n   z {:.5?}\n   zl {:.5?}\n   zh {:.5?}",
            b.amplitude, b.frequency, b.damping_ratio, b.damping_ratio_low, b.damping_ratio_high
        );
        for l in &found.laws {
            eprintln!(
                "   {:<26} {:8.2} D {:7.4} f {:.5} {:?} {:?}",
                l.law.name,
                l.criterion,
                l.dissipation_misfit,
                l.frequency_misfit,
                l.discrepancy,
                l.parameters.iter().map(|p| (p.name, p.value)).collect::<Vec<_>>()
            );
        }
    }
    let Some(own) = found.named(law) else { return };
    if found.chosen().law.name == law {
        tally.named += 1;
    } else {
        tally.others.push((found.chosen().law.name, own.criterion));
        tally.within += u32::from(own.criterion < 6.0);
    }
    for p in &own.parameters {
        let Some((_, truth)) = clean.truth.iter().find(|t| t.0 == p.name) else { continue };
        if let (Some(low), Some(high)) = (p.low, p.high) {
            tally.closed += 1;
            let holds = (low..=high).contains(truth);
            tally.held += u32::from(holds);
            if !holds && std::env::var_os("VERBOSE").is_some() {
                eprintln!("{law} {seed}: {} {truth:.6e} not in {low:.6e} {high:.6e}", p.name);
            }
        }
    }
}

#[allow(clippy::print_stdout, clippy::print_stderr)] // a program for the terminal
fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (Some(Ok(count)), Some(Ok(decibels))) =
        (arguments.first().map(|a| a.parse::<u64>()), arguments.get(1).map(|a| a.parse::<f64>()))
    else {
        eprintln!("usage: laws COUNT DECIBELS [LAW]");
        std::process::exit(2);
    };
    println!(
        "{:<28}{:>7}{:>8}{:>9}{:>9}{:>9}{:>9}",
        "law", "named", "within", "refused", "closed", "hold, %", "ms"
    );
    for law in LAWS.iter().filter(|l| arguments.get(2).is_none_or(|only| only == *l)) {
        let mut tally = Tally::default();
        for seed in 0..count {
            trial(law, seed, decibels, &mut tally);
        }
        let part = 100.0 * f64::from(tally.held) / f64::from(tally.closed.max(1));
        let each = 1e3 * tally.seconds / count as f64;
        let Tally { named, within, refused, closed, .. } = tally;
        println!(
            "{law:<28}{named:>7}{within:>8}{refused:>9}{closed:>9}{part:>9.1}{each:>9.1}   {:.1?}",
            tally.others
        );
    }
}
