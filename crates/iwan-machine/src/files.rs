//! The bytes of a file, as far as memory reaches.

use std::fs::{File, Metadata, OpenOptions};
use std::io::{self, ErrorKind, Read};
use std::path::Path;
use std::time::{Duration, Instant};

use crate::memory;

/// Bytes read from a pipe between two looks at the memory that is left: a look costs half a millisecond, reading so much two.
const PIECE: usize = 16 << 20;

/// How long a pipe may stay without a writer. The shell opens both ends of `<(command)` at once; whoever gives a named pipe has
/// started its writer or will not.
const PATIENCE: Duration = Duration::from_secs(5);

/// Time between two looks into an empty pipe.
const NAP: Duration = Duration::from_millis(10);

/// Reads a file, or a pipe that something writes into, whole.
///
/// # Errors
/// What the operating system says; [`ErrorKind::OutOfMemory`] where the file needs more memory than there is;
/// [`ErrorKind::InvalidInput`] for a device, which has no end; [`ErrorKind::TimedOut`] for a pipe without a writer.
///
/// ```
/// let place = tempfile::NamedTempFile::new()?;
/// std::fs::write(place.path(), "whole")?;
/// assert_eq!(iwan_machine::read_file(place.path())?, b"whole");
/// assert!(iwan_machine::read_file("no such file".as_ref()).is_err());
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn read_file(path: &Path) -> io::Result<Vec<u8>> {
    let meta = std::fs::metadata(path)?;
    if is_pipe(&meta) {
        return from_pipe(path);
    }
    if is_device(&meta) {
        let what = "it is a device and has no end; give a file";
        return Err(io::Error::new(ErrorKind::InvalidInput, what));
    }
    ask(meta.len())?;
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(usize::try_from(meta.len()).unwrap_or(usize::MAX)).map_err(io::Error::other)?;
    // Files of /proc say that they are empty, and others may grow.
    let mut file = File::open(path)?;
    if meta.len() > 0 {
        file.by_ref().take(meta.len()).read_to_end(&mut bytes)?;
    }
    drain(&mut file, &mut bytes, || Ok(false))?;
    Ok(bytes)
}

fn ask(bytes: u64) -> io::Result<()> {
    let remedy = "free some, or cut the file into parts";
    let asked = memory::ask("the file alone", bytes, remedy);
    asked.map_err(|short| io::Error::new(ErrorKind::OutOfMemory, short))
}

/// Reads to the end, looking at the memory that is left; `wait` says whether to go on where there is nothing at the moment.
fn drain(file: &mut File, bytes: &mut Vec<u8>, wait: impl Fn() -> io::Result<bool>) -> io::Result<()> {
    let mut piece = vec![0; 1 << 16];
    let mut asked = bytes.len();
    loop {
        match file.read(&mut piece) {
            Ok(0) if !(bytes.is_empty() && wait()?) => return Ok(()),
            Ok(n) => {
                // A vector doubles when it grows, and the old half stays until it is copied.
                if bytes.len() + n > asked {
                    asked = bytes.len() + PIECE;
                    ask(2 * asked as u64)?;
                }
                bytes.try_reserve(n).map_err(io::Error::other)?;
                bytes.extend_from_slice(&piece[..n]);
            }
            Err(error) if error.kind() == ErrorKind::WouldBlock => std::thread::sleep(NAP),
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
}

/// From a pipe. Opened without waiting for a writer, it is at its end until there is one.
fn from_pipe(path: &Path) -> io::Result<Vec<u8>> {
    let mut options = OpenOptions::new();
    options.read(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::custom_flags(
        &mut options,
        rustix::fs::OFlags::NONBLOCK.bits().cast_signed(),
    );
    let mut file = options.open(path)?;
    let (begin, mut bytes) = (Instant::now(), Vec::new());
    let wait = || {
        if begin.elapsed() > PATIENCE {
            let what = format!(
                "it is a pipe, and nothing was written into it for {} s; start its writer first, or give a file",
                PATIENCE.as_secs()
            );
            return Err(io::Error::new(ErrorKind::TimedOut, what));
        }
        std::thread::sleep(NAP);
        Ok(true)
    };
    drain(&mut file, &mut bytes, wait)?;
    Ok(bytes)
}

#[cfg(unix)]
fn is_pipe(meta: &Metadata) -> bool {
    std::os::unix::fs::FileTypeExt::is_fifo(&meta.file_type())
}

#[cfg(unix)]
fn is_device(meta: &Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt;
    let kind = meta.file_type();
    kind.is_char_device() || kind.is_block_device() || kind.is_socket()
}

#[cfg(not(unix))]
fn is_pipe(_: &Metadata) -> bool {
    false
}

#[cfg(not(unix))]
fn is_device(_: &Metadata) -> bool {
    false
}
