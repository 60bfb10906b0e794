//! The address space that this process may reserve.

/// Most address space of this process (`ulimit -v`), bytes; `u64::MAX` where nothing bounds it.
#[cfg(unix)]
pub(crate) fn address_space() -> u64 {
    use rustix::process::{Resource, getrlimit};
    getrlimit(Resource::As).current.unwrap_or(u64::MAX)
}

/// Most address space of this process, which other systems than Unix do not bound.
#[cfg(not(unix))]
pub(crate) fn address_space() -> u64 {
    u64::MAX
}
