//! Temporary folders and files: those that are being filled, and the litter, those that a killed process has left.
//!
//! A process holds a lock on its temporary folder as long as it lives, however it ends, and a second lock on a file in the folder, for
//! systems that cannot lock folders. A folder whose locks are free belongs to no living process. The lock on the folder also covers the
//! time between making the folder and giving it its final name, and the case of a process that was killed while it removed such a folder
//! and had already removed the file.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::Path;
use tempfile::{Builder, NamedTempFile, TempDir};

/// Beginning of all temporary names.
pub(crate) const PREFIX: &str = ".iwan-";

/// Name of the file in a temporary folder that is locked.
const LOCK: &str = ".lock";

/// Attempts to make a folder or a file of one's own. Another process that removes litter can take a folder for litter between its making
/// and its lock, and hardly twice; a hundred failures mean that something else is wrong, and an error is returned.
const TRIES: usize = 100;

/// A folder that is being filled, with the locks that show that its process lives.
#[derive(Debug)]
pub(crate) struct Staging {
    _alive: [Option<File>; 2],
    folder: TempDir,
}

impl Staging {
    /// The folder's path.
    pub(crate) fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Releases the locks; the folder stays: under its final name, or, in tests, as after a kill.
    pub(crate) fn keep(self) {
        let _ = self.folder.keep();
    }
}

/// Makes a temporary file in `place`, locked as long as it is open anywhere in this process.
pub(crate) fn file(builder: &Builder<'_, '_>, place: &Path) -> io::Result<NamedTempFile> {
    for _ in 0..TRIES {
        let file = builder.tempfile_in(place)?;
        // As with folders, a lock held by somebody else is that of a process that is removing the file as litter.
        let taken = matches!(file.as_file().try_lock(), Err(TryLockError::WouldBlock));
        if !taken && file.path().exists() {
            return Ok(file);
        }
    }
    Err(io::Error::other("another process removes temporary files"))
}

/// Makes a temporary folder in `place`, with its locks.
pub(crate) fn staging(builder: &Builder<'_, '_>, place: &Path) -> io::Result<Staging> {
    let mut last = None;
    for _ in 0..TRIES {
        let folder = builder.tempdir_in(place)?;
        let Ok(whole) = locked(folder.path()) else { continue };
        let path = folder.path().join(LOCK);
        let file = match File::create(&path) {
            Ok(file) => file,
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                last = Some(error);
                continue;
            }
            Err(error) => return Err(error),
        };
        // A lock held by somebody else is that of a process that is removing this folder as litter. Where the file system has no locks,
        // nothing is ever removed as litter, and the folder may be used without a lock.
        if matches!(file.try_lock(), Err(TryLockError::WouldBlock)) {
            continue;
        }
        if path.exists() {
            return Ok(Staging { _alive: [whole, Some(file)], folder });
        }
    }
    Err(last.unwrap_or_else(|| io::Error::other("another process removes temporary folders")))
}

/// Removes the lock file of a folder that becomes a result, so that it no longer counts as a temporary folder.
pub(crate) fn forget(folder: &Path) -> io::Result<()> {
    match fs::remove_file(folder.join(LOCK)) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// The error of a folder that somebody else has locked.
struct Taken;

/// A lock on the folder; none where the system cannot lock folders.
fn locked(folder: &Path) -> Result<Option<File>, Taken> {
    let Ok(file) = File::open(folder) else { return Ok(None) };
    match file.try_lock() {
        Ok(()) => Ok(Some(file)),
        Err(TryLockError::WouldBlock) => Err(Taken),
        Err(TryLockError::Error(_)) => Ok(None),
    }
}

/// Removes temporary folders and files in `place` whose processes live no longer. Those that cannot be removed stay; that is no error of
/// this run.
pub(crate) fn clear(place: &Path) {
    let Ok(entries) = fs::read_dir(place) else { return };
    for entry in entries.flatten().filter(|e| e.file_name().to_string_lossy().starts_with(PREFIX)) {
        let path = entry.path();
        if entry.file_type().is_ok_and(|kind| kind.is_file()) {
            if File::open(&path).is_ok_and(|file| file.try_lock().is_ok()) {
                let _ = fs::remove_file(&path);
            }
            continue;
        }
        let Ok(whole) = locked(&path) else { continue };
        let free = match File::open(path.join(LOCK)) {
            Ok(lock) => lock.try_lock().is_ok(),
            Err(error) => whole.is_some() && error.kind() == io::ErrorKind::NotFound,
        };
        if free {
            let _ = fs::remove_dir_all(&path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::thread;

    /// A run once found its folder gone: another run had taken it for litter between its making and its lock.
    #[test]
    fn a_folder_that_is_being_made_is_no_litter() {
        let place = tempfile::tempdir().unwrap();
        thread::scope(|scope| {
            let clearing = scope.spawn(|| (0..20_000).for_each(|_| clear(place.path())));
            while !clearing.is_finished() {
                let staging = staging(Builder::new().prefix(PREFIX), place.path()).unwrap();
                // By now a process that took the folder for litter would have removed it.
                thread::yield_now();
                clear(place.path());
                assert!(staging.path().join(LOCK).exists());
            }
        });
    }

    /// A process was killed while it made its folder, gave it its final name or removed litter: the folder had no locked file, and no later
    /// run removed it (one of 160 kills).
    #[cfg(unix)]
    #[test]
    fn a_folder_without_its_file_is_litter_unless_its_process_lives() {
        let place = tempfile::tempdir().unwrap();
        let left = place.path().join(".iwan-left");
        fs::create_dir(&left).unwrap();
        fs::write(left.join("response.csv"), "half").unwrap();
        let alive = staging(Builder::new().prefix(PREFIX), place.path()).unwrap();
        forget(alive.path()).unwrap();
        clear(place.path());
        assert!(!left.exists());
        assert!(alive.path().exists());
    }
}
