//! One file that appears whole or not at all.

use iwan_machine::{Kind, lacking};
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::Builder;

use super::litter;

/// Bytes gathered before they are passed to the operating system: 64 KiB, eight times the default of the standard library, because files
/// have many megabytes.
const BUFFER: usize = 1 << 16;

/// What helps where the machine lacks nothing.
const FOLDER: &str = "check that the folder exists and may be written to";

/// Why a file could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The destination exists and overwriting was not asked for.
    #[error("{}: exists already; nothing was written: choose another place or overwrite with --force", .path.display())]
    Exists {
        /// Destination.
        path: PathBuf,
    },
    /// The destination is no plain file name inside the folder.
    #[error("{}: is not a plain file name; give a name without folders", .path.display())]
    Name {
        /// Name given.
        path: PathBuf,
    },
    /// A folder stands where a file is to go.
    #[error("{}: is a folder, and folders are never overwritten; move it away or choose another place", .path.display())]
    Folder {
        /// Destination.
        path: PathBuf,
    },
    /// Another process writes into the folder.
    #[error("{}: another process is writing into this folder; wait for it, or choose another place", .path.display())]
    Busy {
        /// Destination.
        path: PathBuf,
    },
    /// The operating system refused a step.
    #[error("{}: cannot {action}: {source}; {}", .path.display(), lacking(source).unwrap_or(FOLDER))]
    Io {
        /// Destination.
        path: PathBuf,
        /// The step that was refused.
        action: &'static str,
        /// Reason given by the operating system.
        source: io::Error,
    },
}

impl WriteError {
    /// The error's kind in the catalogue of errors.
    #[must_use]
    pub fn kind(&self) -> Kind {
        match self {
            Self::Exists { .. } => Kind::Exists,
            Self::Busy { .. } => Kind::Busy,
            Self::Name { .. } | Self::Folder { .. } | Self::Io { .. } => Kind::Unwritable,
        }
    }

    /// Whether the machine lacks what the file needs: handles, or space.
    #[must_use]
    pub fn is_of_machine(&self) -> bool {
        matches!(self, Self::Io { source, .. } if lacking(source).is_some())
    }
}

pub(super) fn io_error(path: &Path, action: &'static str) -> impl FnOnce(io::Error) -> WriteError {
    let path = path.to_path_buf();
    move |source| WriteError::Io { path, action, source }
}

/// Writes one file through `fill`; it appears under `path` when all of it is on the disk.
///
/// # Errors
/// [`WriteError::Exists`] when `path` exists and `force` is false (checked again in the moment of renaming);
/// [`WriteError::Io`] for errors of the operating system or of `fill`. In both cases `path` stays as it was.
///
/// ```
/// use std::io::Write;
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("a.txt");
/// iwan_io::atomic::write_file(&path, false, |w| writeln!(w, "whole"))?;
/// assert_eq!(std::fs::read_to_string(&path)?, "whole\n");
/// assert!(iwan_io::atomic::write_file(&path, false, |w| writeln!(w, "again")).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_file(
    path: impl AsRef<Path>,
    force: bool,
    fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), WriteError> {
    let path = path.as_ref();
    if !force && path.symlink_metadata().is_ok() {
        return Err(WriteError::Exists { path: path.into() });
    }
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    litter::clear(folder);
    let temporary =
        litter::file(&builder(0o666), folder).map_err(io_error(path, "create a temporary file"))?;
    let (file, temporary) = temporary.into_parts();
    // The second handle keeps the lock until the file has its final name.
    let _alive = file.try_clone();
    write_through(path, file, fill)?;
    let persisted = if force { temporary.persist(path) } else { temporary.persist_noclobber(path) };
    persisted.map_err(|e| match e.error.kind() {
        io::ErrorKind::AlreadyExists => WriteError::Exists { path: path.into() },
        _ => io_error(path, "rename the temporary file")(e.error),
    })
}

/// Makes temporary names with the permissions that the user's mask allows, not with the stricter ones usual for temporary files.
pub(super) fn builder(mode: u32) -> Builder<'static, 'static> {
    let mut builder = Builder::new();
    builder.prefix(litter::PREFIX);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(mode));
    #[cfg(not(unix))]
    let _ = mode;
    builder
}

pub(super) fn write_through(
    path: &Path,
    file: File,
    fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), WriteError> {
    let mut writer = BufWriter::with_capacity(BUFFER, file);
    fill(&mut writer).and_then(|()| writer.flush()).map_err(io_error(path, "write"))?;
    writer.get_ref().sync_all().map_err(io_error(path, "flush to the disk"))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use std::fs;

    /// Sorted names of the entries of a folder.
    pub(in crate::atomic) fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> =
            fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_failed_write_leaves_nothing_and_the_old_file() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("a");
        let failing = |w: &mut BufWriter<File>| w.write_all(b"half").and(Err(io::Error::other("disk full")));
        assert!(write_file(&path, false, failing).unwrap_err().to_string().contains("disk full"));
        assert!(names(place.path()).is_empty());
        write_file(&path, false, |w| w.write_all(b"old")).unwrap();
        assert!(write_file(&path, true, failing).is_err());
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(place.path()), ["a"]);
    }

    #[test]
    fn nothing_is_overwritten_without_force() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("a");
        write_file(&path, false, |w| w.write_all(b"1")).unwrap();
        let refused = write_file(&path, false, |w| w.write_all(b"2")).unwrap_err();
        assert!(refused.to_string().contains("--force"));
        write_file(&path, true, |w| w.write_all(b"3")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"3");
    }

    /// A process that was killed while it wrote a single file once left that file under its temporary name for ever.
    #[test]
    fn the_next_write_clears_what_a_killed_one_left() {
        let place = tempfile::tempdir().unwrap();
        fs::write(place.path().join(".iwan-left"), "half").unwrap();
        fs::write(place.path().join(".another"), "not ours").unwrap();
        let alive = litter::file(&builder(0o666), place.path()).unwrap();
        write_file(place.path().join("a"), false, |w| w.write_all(b"1")).unwrap();
        let own = alive.path().file_name().unwrap().to_str().unwrap();
        assert_eq!(names(place.path()), [".another", own, "a"]);
    }

    #[cfg(unix)]
    #[test]
    fn others_may_read_what_the_mask_allows() {
        use std::os::unix::fs::PermissionsExt;
        let place = tempfile::tempdir().unwrap();
        let plain = place.path().join("plain");
        fs::write(&plain, "").unwrap();
        let path = place.path().join("a");
        write_file(&path, false, |_| Ok(())).unwrap();
        let mode = |p: &Path| fs::metadata(p).unwrap().permissions().mode();
        assert_eq!(mode(&path), mode(&plain));
    }
}
