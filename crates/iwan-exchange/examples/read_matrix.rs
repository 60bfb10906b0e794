//! Reads files of matrices and says how long it took, and how much memory at most: `read_matrix FILE ...`; with `--entries` first what the rows
//! of each matrix are, where the file says so (`label`, row, node, component), and all its entries follow it, one a line: row, column (from 0), value.
#![allow(clippy::print_stdout, reason = "what an example is for")]

use std::time::Instant;

/// Peak memory of this process, bytes, where the system tells it.
fn peak() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(1024.0 * line.split_whitespace().nth(1)?.parse::<f64>().ok()?)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut files: Vec<String> = std::env::args().skip(1).collect();
    let entries = files.first().is_some_and(|first| first == "--entries");
    if entries {
        files.remove(0);
    }
    for file in files {
        let clock = Instant::now();
        let matrices = iwan_exchange::read(&file, None)?;
        let seconds = clock.elapsed().as_secs_f64();
        for matrix in &matrices {
            let held = (matrix.entries.len() * size_of::<iwan_exchange::Entry>()) as f64;
            println!(
                "{file}: {} with {} rows and {} entries in {seconds:.2} s; entries {:.0} MB, peak {:.0} MB",
                matrix.name,
                matrix.rows,
                matrix.entries.len(),
                held / 1e6,
                peak().unwrap_or(f64::NAN) / 1e6
            );
            if entries {
                let words = [matrix.rows, matrix.columns, usize::from(matrix.complex)];
                println!("matrix {} {} {} {}", matrix.name, words[0], words[1], words[2]);
                for (row, label) in matrix.labels.iter().flatten().enumerate() {
                    println!("label {row} {} {}", label.node, label.component.number());
                }
                let twice = matrix.stored == iwan_exchange::Stored::Triangle;
                for (i, j, value) in &matrix.entries {
                    println!("{i} {j} {value:e}");
                    if twice && i != j {
                        println!("{j} {i} {value:e}");
                    }
                }
            }
        }
    }
    Ok(())
}
