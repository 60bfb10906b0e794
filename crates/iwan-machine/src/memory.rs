//! Memory that is asked for before it is allocated.

use std::cell::Cell;
use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use sysinfo::{MemoryRefreshKind, ProcessRefreshKind, ProcessesToUpdate, System};

use crate::address_space::address_space;
use crate::threads::{at_once, begin};

/// The limit that the user sets for this process, bytes. Memory belongs to the process as a whole, so one static value holds for all of its
/// threads.
static LIMIT: AtomicU64 = AtomicU64::new(u64::MAX);

/// Requests below this size, bytes, are granted without asking the machine, which takes half a millisecond: no machine that runs this
/// program lacks 16 MB, and a call for a small response in a loop takes less than that half millisecond. A limit set by the user is checked
/// for these requests, too.
const SMALL: u64 = 16 << 20;

/// Sets the memory that this process may take in all, bytes; with `u64::MAX`, the initial value, only the machine limits it.
pub fn set_limit(bytes: u64) {
    LIMIT.store(bytes, Ordering::Relaxed);
}

/// The limit that was set, bytes.
#[must_use]
pub fn limit() -> u64 {
    LIMIT.load(Ordering::Relaxed)
}

/// Memory that may still be taken, and what limits it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Free {
    /// Number of bytes.
    pub bytes: u64,
    /// What sets the bound.
    pub bound: Bound,
}

/// What limits the memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bound {
    /// The free memory of the machine, or of the container in which the process runs.
    Machine,
    /// The process's own limit of address space (`ulimit -v`).
    Process,
    /// The limit given to [`set_limit`], on the command line `--memory`.
    Given,
}

/// The error of work that needs more memory than may be taken.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub struct Short {
    /// The work or data that needs the memory.
    pub what: String,
    /// About how many bytes are needed.
    pub needed: u64,
    /// How many bytes there are, and what limits them.
    pub free: Free,
    /// What helps.
    pub remedy: String,
}

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let whose = match self.free.bound {
            Bound::Machine => "are free on this machine",
            Bound::Process => "are left to this process (ulimit -v)",
            Bound::Given => "are left of what --memory allows",
        };
        let (needed, free) = (Bytes(self.needed), Bytes(self.free.bytes));
        write!(f, "{} needs about {needed} of memory, and {free} {whose}; {}", self.what, self.remedy)
    }
}

/// A number of bytes, displayed with a unit such as MB.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bytes(pub u64);

impl fmt::Display for Bytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let units = [(1e12, "TB"), (1e9, "GB"), (1e6, "MB"), (1e3, "kB")];
        let bytes = self.0 as f64;
        match units.iter().find(|(size, _)| bytes >= *size) {
            Some((size, unit)) => write!(f, "{:.3} {unit}", bytes / size),
            None => write!(f, "{bytes} bytes"),
        }
    }
}

/// Reads a number of bytes: `4GB`, `500 MB`, `2 GiB`, `1000000`.
///
/// # Errors
/// A text that says what is allowed.
///
/// ```
/// use iwan_machine::memory::parse_bytes;
/// assert_eq!(parse_bytes("1.5 GB"), Ok(1_500_000_000));
/// assert_eq!(parse_bytes("2GiB"), Ok(2 << 30));
/// assert!(parse_bytes("much").is_err());
/// ```
pub fn parse_bytes(text: &str) -> Result<u64, String> {
    let text = text.trim();
    let split = text.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(text.len());
    let unit = match text[split..].to_ascii_lowercase().as_str() {
        "" | "b" => 1.0,
        "k" | "kb" => 1e3,
        "m" | "mb" => 1e6,
        "g" | "gb" => 1e9,
        "t" | "tb" => 1e12,
        "kib" => 1024.0,
        "mib" => 1024.0 * 1024.0,
        "gib" => 1024.0 * 1024.0 * 1024.0,
        _ => return Err("must be a size such as 4GB, 500MB or 2GiB".into()),
    };
    let bytes = text[..split].trim().parse::<f64>().ok().map(|number| number * unit);
    let sensible = bytes.filter(|bytes| (1.0..=u64::MAX as f64).contains(bytes));
    sensible.map(|bytes| bytes as u64).ok_or_else(|| "must be a size such as 4GB, 500MB or 2GiB".into())
}

/// Address space, bytes, that a thread takes beside the memory it asks for: the system's allocator reserves 64 MiB for it, and its stack is
/// 2 MiB. Before this was counted, a response for which 378 MB seemed to be free under `ulimit -v` ended in an abort at 288 MB.
const ARENA: u64 = 66 << 20;

/// The memory that may still be taken.
///
/// ```
/// assert!(iwan_machine::memory::free().bytes > 0);
/// ```
#[must_use]
pub fn free() -> Free {
    let mut system = System::new();
    system.refresh_memory_specifics(MemoryRefreshKind::nothing().with_ram());
    // Without a handle for one more file nothing can be learnt, and nothing is refused for want of memory.
    let machine = match system.total_memory() {
        0 => u64::MAX,
        _ => system.available_memory(),
    };
    let group = (machine != u64::MAX).then(|| system.cgroup_limits()).flatten();
    let machine = group.map_or(machine, |group| machine.min(left(group.total_memory, group.rss)));
    let mut free = Free { bytes: machine, bound: Bound::Machine };
    let (limit, address_space) = (limit(), address_space());
    if limit == u64::MAX && address_space == u64::MAX {
        return free;
    }
    let (resident, reserved) = own(&mut system);
    let reserved = reserved.saturating_add(ARENA.saturating_mul(at_once() as u64));
    for (most, taken, bound) in [(address_space, reserved, Bound::Process), (limit, resident, Bound::Given)] {
        let left = most.saturating_sub(taken);
        if most != u64::MAX && left < free.bytes {
            free = Free { bytes: left, bound };
        }
    }
    free
}

/// What a control group may still take of its total, bytes, when its processes hold `held` bytes. The group's own count of free memory
/// treats files that the system caches in memory as used, although they make room when needed: on a machine of 24 GB that had read 20 GB of
/// files and used 0.9 GB, a response of 2.9 GB was refused.
fn left(total: u64, held: u64) -> u64 {
    total.saturating_sub(held)
}

/// Memory in use by this process, and address space reserved by it, bytes.
fn own(system: &mut System) -> (u64, u64) {
    let Ok(me) = sysinfo::get_current_pid() else { return (0, 0) };
    let kind = ProcessRefreshKind::nothing().with_memory();
    system.refresh_processes_specifics(ProcessesToUpdate::Some(&[me]), false, kind);
    system.process(me).map_or((0, 0), |own| (own.memory(), own.virtual_memory()))
}

/// Time between two looks at the memory of this process: memory is filled at some 2 GB in a second, so that a limit is exceeded by some 40 MB
/// at most before that is seen; a look takes a twentieth of a millisecond.
const TICK: Duration = Duration::from_millis(20);

/// Where a limit was set, calls `beyond` once this process holds more, for work that was not estimated, or not well. A thread of its own
/// looks fifty times a second; where the system gives none, nobody looks.
pub fn watch(beyond: impl Fn(Short) + Send + 'static) {
    if limit() == u64::MAX {
        return;
    }
    let look = move || {
        let mut system = System::new();
        loop {
            let ((held, _), limit) = (own(&mut system), limit());
            if held > limit {
                let free = Free { bytes: limit, bound: Bound::Given };
                let remedy = "allow more, or ask for less: a shorter record, fewer samples, modes or points";
                beyond(Short { what: "what is computed".into(), needed: held, free, remedy: remedy.into() });
                return;
            }
            std::thread::sleep(TICK);
        }
    };
    drop(begin("memory", look));
}

/// Least address space, bytes, in which a command can run: the program itself takes 40 MB, each of its threads 66 MB. With less, an allocation
/// that cannot be refused in words would abort the process.
const LEAST: u64 = 300_000_000;

/// Asks whether there is room for a command at all, whatever it computes.
///
/// # Errors
/// [`Short`] where `ulimit -v` leaves less than 300 MB of address space.
pub fn ask_to_begin() -> Result<(), Short> {
    let bytes = address_space();
    if bytes >= LEAST {
        return Ok(());
    }
    let remedy = "raise or lift ulimit -v; --memory bounds what is really taken".into();
    Err(Short {
        what: "any command".into(),
        needed: LEAST,
        free: Free { bytes, bound: Bound::Process },
        remedy,
    })
}

/// Whether a limit such as `ulimit -v` bounds the address space that this process may reserve. Kernels of dense matrices reserve twice the
/// largest cache of the processor on each thread: under such a limit, small matrices are better factored without these kernels.
#[must_use]
pub fn is_address_space_bounded() -> bool {
    address_space() != u64::MAX
}

thread_local! {
    /// Whether this thread has been granted the address space that kernels of dense matrices reserve on it.
    static GRANTED: Cell<bool> = const { Cell::new(false) };
}

/// Asks for the address space that the kernels of dense matrices reserve once on each thread and hardly use: twice the largest cache of the
/// processor, 960 MiB where the cache has 480 MiB. It matters only where `ulimit -v` limits the address space. `started` is the number of
/// threads that were started for the work; with 0 the calling thread does the work, and has to ask only once.
///
/// # Errors
/// [`Short`] where there is less; without this refusal the kernels would abort the process.
pub fn ask_for_kernels(started: usize) -> Result<(), Short> {
    if !is_address_space_bounded() || (started == 0 && GRANTED.get()) {
        return Ok(());
    }
    let needed = 2 * largest_cache() * started.max(1) as u64;
    let free = free();
    if free.bound == Bound::Process && needed > free.bytes {
        let what = "the workspace of matrix factors (address space, of which little is used)".into();
        let remedy = "raise or lift ulimit -v; --memory bounds what is really taken".into();
        return Err(Short { what, needed, free, remedy });
    }
    GRANTED.set(GRANTED.get() || started == 0);
    Ok(())
}

/// Size of the processor's largest cache, bytes; 0 where the system does not state it.
fn largest_cache() -> u64 {
    let size = |level: usize| {
        let path = format!("/sys/devices/system/cpu/cpu0/cache/index{level}/size");
        parse_bytes(std::fs::read_to_string(path).ok()?.trim().strip_suffix('K')?).ok().map(|kib| kib << 10)
    };
    (0..8).filter_map(size).max().unwrap_or(0)
}

/// Asks whether about `needed` bytes are free for `what`; nothing is allocated.
///
/// # Errors
/// [`Short`], with `remedy`, when fewer bytes are free.
///
/// ```
/// use iwan_machine::memory::ask;
/// assert!(ask("a response of 1000 samples", 32_000, "take fewer").is_ok());
/// let refused = ask("a response of 1e15 samples", 32_000_000_000_000_000, "take fewer").unwrap_err();
/// assert!(refused.to_string().starts_with("a response of 1e15 samples needs about 32000.000 TB of memory, and "));
/// ```
pub fn ask(what: impl Into<String>, needed: u64, remedy: impl Into<String>) -> Result<(), Short> {
    if needed < SMALL && limit() == u64::MAX {
        return Ok(());
    }
    let free = free();
    if needed <= free.bytes {
        return Ok(());
    }
    Err(Short { what: what.into(), needed, free, remedy: remedy.into() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_that_the_system_keeps_are_no_memory_in_use() {
        // A control group of 24 GB has read 20 GB of files; its processes hold 0.9 GB.
        assert_eq!(left(24_000_000_000, 900_000_000), 23_100_000_000);
        assert_eq!(left(1_000_000_000, 2_000_000_000), 0);
        assert!(free().bytes > 0);
    }
}
