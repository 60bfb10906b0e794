//! Files that appear whole or not at all.
//!
//! Everything is written beside its destination under a temporary name, flushed to the disk, then renamed. Whatever
//! happens before the renaming, an error or a crash, leaves the destination as it was.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::{Builder, TempDir};

/// Bytes gathered before the operating system is asked to write: 64 KiB, eight times what the standard library takes, for
/// files of many megabytes.
const BUFFER: usize = 1 << 16;

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
    /// The operating system refused a step.
    #[error("{}: cannot {action}: {source}; check that the folder exists, may be written to and has space", .path.display())]
    Io {
        /// Destination.
        path: PathBuf,
        /// The step.
        action: &'static str,
        /// Reason given by the operating system.
        source: io::Error,
    },
}

fn io_error(path: &Path, action: &'static str) -> impl FnOnce(io::Error) -> WriteError {
    let path = path.to_path_buf();
    move |source| WriteError::Io { path, action, source }
}

/// Writes one file through `fill`; it appears under `path` when all is on the disk.
///
/// # Errors
/// [`WriteError::Exists`] when `path` exists and `force` is false (checked again in the moment of renaming);
/// [`WriteError::Io`] for what the operating system or `fill` reports. Then `path` is as it was.
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
    let temporary = builder(0o666).tempfile_in(folder).map_err(io_error(path, "create a temporary file"))?;
    let (file, temporary) = temporary.into_parts();
    write_through(path, file, fill)?;
    let persisted = if force { temporary.persist(path) } else { temporary.persist_noclobber(path) };
    persisted.map_err(|e| match e.error.kind() {
        io::ErrorKind::AlreadyExists => WriteError::Exists { path: path.into() },
        _ => io_error(path, "rename the temporary file")(e.error),
    })
}

/// Temporary names with the permissions that the user's mask allows, not the stricter ones of temporary files.
fn builder(mode: u32) -> Builder<'static, 'static> {
    let mut builder = Builder::new();
    builder.prefix(".iwan-");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(mode));
    #[cfg(not(unix))]
    let _ = mode;
    builder
}

fn write_through(
    path: &Path,
    file: File,
    fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), WriteError> {
    let mut writer = BufWriter::with_capacity(BUFFER, file);
    fill(&mut writer).and_then(|()| writer.flush()).map_err(io_error(path, "write"))?;
    writer.get_ref().sync_all().map_err(io_error(path, "flush to the disk"))
}

/// Several files of one folder that become visible together.
///
/// A folder that does not exist yet appears in one step with all its files. In a folder that exists, the files are
/// renamed one after the other; when one of them cannot be, those before it are taken back and the files they
/// replaced return. Only a crash between two renamings can leave a part. Dropped without [`Folder::commit`], nothing
/// appears.
///
/// ```
/// use std::io::Write;
/// let place = tempfile::tempdir()?;
/// let out = place.path().join("out");
/// let mut folder = iwan_io::atomic::Folder::stage(&out, false)?;
/// folder.write("a.txt", |w| writeln!(w, "a"))?;
/// folder.write("b.txt", |w| writeln!(w, "b"))?;
/// assert!(!out.exists());
/// folder.commit()?;
/// assert!(out.join("a.txt").exists() && out.join("b.txt").exists());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Folder {
    target: PathBuf,
    staging: TempDir,
    names: Vec<String>,
    force: bool,
}

impl Folder {
    /// Prepares files for the folder `target`; its parents are made where they are missing.
    ///
    /// # Errors
    /// [`WriteError::Io`] when nothing can be written there, or `target` is a file.
    pub fn stage(target: impl AsRef<Path>, force: bool) -> Result<Self, WriteError> {
        let target = target.as_ref().to_path_buf();
        let parent = target.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let place = if target.exists() { target.as_path() } else { parent };
        fs::create_dir_all(place).map_err(io_error(&target, "make the folder"))?;
        let staging =
            builder(0o777).tempdir_in(place).map_err(io_error(&target, "make a temporary folder"))?;
        Ok(Self { target, staging, names: Vec::new(), force })
    }

    /// Says early, before a long computation, whether these names may be written.
    ///
    /// # Errors
    /// [`WriteError::Folder`] for the first name that is a folder; [`WriteError::Exists`] for the first name that
    /// exists, unless overwriting was asked for.
    pub fn check(&self, names: &[&str]) -> Result<(), WriteError> {
        if let Some(name) = names.iter().find(|name| self.target.join(name).is_dir()) {
            return Err(WriteError::Folder { path: self.target.join(name) });
        }
        let taken = |name: &&&str| self.target.join(name).symlink_metadata().is_ok();
        match names.iter().find(taken).filter(|_| !self.force) {
            Some(name) => Err(WriteError::Exists { path: self.target.join(name) }),
            None => Ok(()),
        }
    }

    /// Writes one file through `fill`; it stays hidden until [`Folder::commit`].
    ///
    /// # Errors
    /// [`WriteError::Name`] unless `name` is one plain file name, [`WriteError::Exists`], [`WriteError::Io`].
    pub fn write(
        &mut self,
        name: &str,
        fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
    ) -> Result<(), WriteError> {
        if Path::new(name).file_name() != Some(name.as_ref()) {
            return Err(WriteError::Name { path: name.into() });
        }
        self.check(&[name])?;
        let path = self.target.join(name);
        let file = File::create(self.staging.path().join(name)).map_err(io_error(&path, "create"))?;
        write_through(&path, file, fill)?;
        if !self.names.iter().any(|n| n == name) {
            self.names.push(name.into());
        }
        Ok(())
    }

    /// Makes all files visible.
    ///
    /// # Errors
    /// [`WriteError::Exists`], [`WriteError::Io`]; then no file has become visible and none was replaced.
    pub fn commit(self) -> Result<(), WriteError> {
        if !self.target.exists() {
            // The guard goes only after success: otherwise it removes what was staged.
            fs::rename(self.staging.path(), &self.target).map_err(io_error(&self.target, "rename"))?;
            let _ = self.staging.keep();
            return Ok(());
        }
        let names: Vec<&str> = self.names.iter().map(String::as_str).collect();
        self.check(&names)?;
        let replaced = builder(0o777)
            .tempdir_in(&self.target)
            .map_err(io_error(&self.target, "make a temporary folder"))?;
        for (done, name) in names.iter().enumerate() {
            if let Err(error) = self.exchange(name, replaced.path()) {
                names[..=done].iter().for_each(|name| self.take_back(name, replaced.path()));
                return Err(error);
            }
        }
        Ok(())
    }

    /// Moves the old file, if any, aside and the new one in.
    fn exchange(&self, name: &str, replaced: &Path) -> Result<(), WriteError> {
        let (new, target) = (self.staging.path().join(name), self.target.join(name));
        if target.symlink_metadata().is_ok() {
            fs::rename(&target, replaced.join(name)).map_err(io_error(&target, "move the old file aside"))?;
        }
        fs::rename(&new, &target).map_err(io_error(&target, "rename"))
    }

    /// Undoes [`Folder::exchange`], however far it came.
    fn take_back(&self, name: &str, replaced: &Path) {
        let (new, target, old) =
            (self.staging.path().join(name), self.target.join(name), replaced.join(name));
        if !new.exists() {
            let _ = fs::rename(&target, &new);
        }
        if old.symlink_metadata().is_ok() {
            let _ = fs::rename(&old, &target);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
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

    #[test]
    fn a_folder_dropped_leaves_no_trace() {
        let place = tempfile::tempdir().unwrap();
        let mut folder = Folder::stage(place.path().join("out"), false).unwrap();
        folder.write("a", |w| w.write_all(b"1")).unwrap();
        drop(folder);
        assert!(names(place.path()).is_empty());
    }

    #[test]
    fn files_join_an_existing_folder_all_or_none() {
        let place = tempfile::tempdir().unwrap();
        fs::write(place.path().join("a"), "old").unwrap();
        let mut folder = Folder::stage(place.path(), true).unwrap();
        folder.write("a", |w| w.write_all(b"new")).unwrap();
        folder.write("b", |w| w.write_all(b"new")).unwrap();
        fs::remove_file(folder.staging.path().join("b")).unwrap(); // the second renaming must fail
        assert!(folder.commit().is_err());
        assert_eq!(names(place.path()), ["a"]);
        assert_eq!(fs::read(place.path().join("a")).unwrap(), b"old");
    }

    #[test]
    fn an_existing_file_stops_the_folder_early() {
        let place = tempfile::tempdir().unwrap();
        fs::write(place.path().join("a"), "old").unwrap();
        let mut folder = Folder::stage(place.path(), false).unwrap();
        assert!(matches!(folder.check(&["z", "a"]), Err(WriteError::Exists { .. })));
        assert!(matches!(folder.write("a", |_| Ok(())), Err(WriteError::Exists { .. })));
        for name in ["../a", "x/y", "..", "", "."] {
            assert!(matches!(folder.write(name, |_| Ok(())), Err(WriteError::Name { .. })), "{name}");
        }
        folder.write("b", |w| w.write_all(b"1")).unwrap();
        folder.commit().unwrap();
        assert_eq!(names(place.path()), ["a", "b"]);
    }

    /// Overwriting once deleted a folder that stood in the place of a file, with all that was in it.
    #[test]
    fn folders_are_never_overwritten() {
        let place = tempfile::tempdir().unwrap();
        let inner = place.path().join("report.html");
        fs::create_dir(&inner).unwrap();
        fs::write(inner.join("precious"), "x").unwrap();
        let folder = Folder::stage(place.path(), true).unwrap();
        assert!(matches!(folder.check(&["report.html"]), Err(WriteError::Folder { .. })));
        let mut folder = folder;
        assert!(folder.write("report.html", |_| Ok(())).is_err());
        assert!(inner.join("precious").exists());
    }
}
