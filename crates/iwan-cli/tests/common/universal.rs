//! Time histories of universal files (datasets 58 and 1858).

use std::fmt::Write;

/// A channel as a universal file has it, with the window that its header names (0 none, 4 exponential).
pub fn channel(name: &str, (code, unit): (u8, &str), dt: f64, samples: &[f64], window: u8) -> String {
    let mut text = format!(
        "    -1\n    58\n{name}\nNONE\n01-Jan-26 00:00:00\nNONE\nNONE\n    1         0    0         0 NONE               1   3 NONE               0   0\n"
    );
    writeln!(text, "{:>10}{:>10}{:>10}{:>13.5e}{dt:>13.5e}{:>13.5e}", 2, samples.len(), 1, 0.0, 0.0).unwrap();
    for (code, label, unit) in
        [(17, "Time", "s"), (code, name, unit), (0, "NONE", "NONE"), (0, "NONE", "NONE")]
    {
        writeln!(text, "{code:>10}    0    0    0 {label:<20} {unit:<20}").unwrap();
    }
    for x in samples {
        writeln!(text, "{x:>20.11e}").unwrap();
    }
    let zeros = |n: usize| format!("{:>15.7e}", 0.0).repeat(n);
    let none = format!("{:>12}", 0).repeat(6);
    let (rest, constant) = (format!("{:>6}", 0).repeat(10), format!("{:>15.7e}", 2.5));
    text + &format!(
        "    -1\n    -1\n  1858\n{none}\n     0{window:>6}{rest}\n{}\n{}{constant}\n{}\nNONE  NONE\nNONE\n    -1\n",
        zeros(5),
        zeros(4),
        zeros(5)
    )
}
