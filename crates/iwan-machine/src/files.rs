//! Reads the bytes of a file, as far as there is memory for them.

use std::fs::{File, Metadata, OpenOptions};
use std::io::{self, ErrorKind, Read};
use std::path::Path;
use std::time::{Duration, Instant};

use crate::memory;

/// Bytes read from a pipe between two checks of the free memory: a check costs half a millisecond, reading this many bytes two
/// milliseconds.
const PIECE: usize = 16 << 20;

/// How long a pipe may stay without a writer; then reading it ends with an error. The shell opens both ends of `<(command)` at once; a user
/// who names a pipe has started its writer already, or never will.
const PATIENCE: Duration = Duration::from_secs(5);

/// How long a pipe may give nothing although its writer lives: a program that computes before it writes may take a while, and one that never
/// writes must not hold this program for ever. The error names the remedy, a file.
const SILENCE: Duration = Duration::from_secs(30);

/// Time between two attempts to read an empty pipe.
const NAP: Duration = Duration::from_millis(10);

/// What helps where the machine lacks something that a file needs: handles of open files, or space on the disk; none where it lacks nothing.
///
/// ```
/// use std::io::{Error, ErrorKind};
/// assert!(iwan_machine::lacking(&Error::from(ErrorKind::StorageFull)).is_some_and(|remedy| remedy.contains("space")));
/// assert!(iwan_machine::lacking(&Error::from(ErrorKind::NotFound)).is_none());
/// ```
#[must_use]
pub fn lacking(error: &io::Error) -> Option<&'static str> {
    match error.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
            Some("free some space, or choose a folder on another disk")
        }
        ErrorKind::FileTooLarge if error.raw_os_error().is_some() => {
            Some("raise the limit on the length of files (`ulimit -f`), or write less")
        }
        _ if is_without_handle(error) => {
            Some("raise the limit on open files (`ulimit -n`), or close other programs")
        }
        _ => None,
    }
}

#[cfg(unix)]
fn is_without_handle(error: &io::Error) -> bool {
    use rustix::io::Errno;
    Errno::from_io_error(error).is_some_and(|number| matches!(number, Errno::MFILE | Errno::NFILE))
}

#[cfg(not(unix))]
fn is_without_handle(_: &io::Error) -> bool {
    false
}

/// Reads a whole file, or all that is written into a pipe.
///
/// # Errors
/// The operating system's error; [`ErrorKind::OutOfMemory`] where the file needs more memory than there is;
/// [`ErrorKind::InvalidInput`] for a device, which has no end; [`ErrorKind::TimedOut`] for a pipe without a writer, and for one whose writer
/// stays silent.
///
/// ```
/// let place = tempfile::NamedTempFile::new()?;
/// std::fs::write(place.path(), "whole")?;
/// assert_eq!(iwan_machine::read_file(place.path())?, b"whole");
/// assert!(iwan_machine::read_file("no such file".as_ref()).is_err());
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn read_file(path: &Path) -> io::Result<Vec<u8>> {
    read_file_within(path, u64::MAX)
}

/// Reads a file of at most `most` bytes, or at most as many out of a pipe.
///
/// # Errors
/// Those of [`read_file`]; [`ErrorKind::FileTooLarge`] for one byte more, before the file is read.
///
/// ```
/// let place = tempfile::NamedTempFile::new()?;
/// std::fs::write(place.path(), "whole")?;
/// assert!(iwan_machine::read_file_within(place.path(), 5).is_ok());
/// assert!(iwan_machine::read_file_within(place.path(), 4).is_err());
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn read_file_within(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let meta = std::fs::metadata(path)?;
    if is_pipe(&meta) {
        return from_pipe(path, most);
    }
    if is_device(&meta) {
        let what = "it is a device and has no end; give a file";
        return Err(io::Error::new(ErrorKind::InvalidInput, what));
    }
    fits(meta.len(), most)?;
    ask(meta.len())?;
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(usize::try_from(meta.len()).unwrap_or(usize::MAX)).map_err(io::Error::other)?;
    // Files of /proc state that they are empty, and other files may grow while they are read.
    let mut file = File::open(path)?;
    if meta.len() > 0 {
        file.by_ref().take(meta.len()).read_to_end(&mut bytes)?;
    }
    drain(&mut file, &mut bytes, most, || Ok(false))?;
    Ok(bytes)
}

fn fits(bytes: u64, most: u64) -> io::Result<()> {
    if bytes <= most {
        return Ok(());
    }
    let what = format!("it is longer than {}", memory::Bytes(most));
    Err(io::Error::new(ErrorKind::FileTooLarge, what))
}

fn ask(bytes: u64) -> io::Result<()> {
    let remedy = "free some, or cut the file into parts";
    let asked = memory::ask("the file alone", bytes, remedy);
    asked.map_err(|short| io::Error::new(ErrorKind::OutOfMemory, short))
}

/// Reads to the end and checks the length and the free memory meanwhile; where nothing has been read yet, `wait` decides whether to try again.
fn drain(
    file: &mut File,
    bytes: &mut Vec<u8>,
    most: u64,
    wait: impl Fn() -> io::Result<bool>,
) -> io::Result<()> {
    let mut piece = vec![0; 1 << 16];
    let mut asked = bytes.len();
    let mut heard = Instant::now();
    loop {
        match file.read(&mut piece) {
            Ok(0) if !(bytes.is_empty() && wait()?) => return Ok(()),
            Ok(n) => {
                heard = Instant::now();
                fits((bytes.len() + n) as u64, most)?;
                // A vector that grows allocates twice its size, and the old half stays until it is copied.
                if bytes.len() + n > asked {
                    asked = bytes.len() + PIECE;
                    ask(2 * asked as u64)?;
                }
                bytes.try_reserve(n).map_err(io::Error::other)?;
                bytes.extend_from_slice(&piece[..n]);
            }
            Err(error) if error.kind() == ErrorKind::WouldBlock => {
                silent_for(heard, SILENCE)?;
                std::thread::sleep(NAP);
            }
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
}

/// Reads a pipe. It is opened without waiting for a writer, and appears to be at its end until a writer opens it.
fn from_pipe(path: &Path, most: u64) -> io::Result<Vec<u8>> {
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
        silent_for(begin, PATIENCE)?;
        std::thread::sleep(NAP);
        Ok(true)
    };
    drain(&mut file, &mut bytes, most, wait)?;
    Ok(bytes)
}

/// Whether a pipe has given something since `heard`, or may still be waited for.
fn silent_for(heard: Instant, patience: Duration) -> io::Result<()> {
    if heard.elapsed() <= patience {
        return Ok(());
    }
    let what = format!(
        "it is a pipe, and nothing was written into it for {} s; start its writer first, or give a file",
        patience.as_secs()
    );
    Err(io::Error::new(ErrorKind::TimedOut, what))
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
