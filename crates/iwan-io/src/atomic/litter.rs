//! Folders and single files that are being filled, and those that a killed process has left.
//!
//! A process holds a lock on its folder as long as it lives, whatever ends it, and one on a file in it, for systems that lock no folders. A folder whose locks
//! are free belongs to nobody. The lock on the folder is there from its making until it stands under its final name, and also where a process was killed while it cleared
//! such a folder away, when the file was gone already.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::Path;
use tempfile::{Builder, NamedTempFile, TempDir};

/// What temporary names begin with.
pub(crate) const PREFIX: &str = ".iwan-";

/// The file that is locked.
const LOCK: &str = ".lock";

/// Tries for a folder or a file of one's own. One that clears litter can take a folder for litter between its making and its lock, and hardly
/// twice: a hundred tries mean that something else is wrong.
const TRIES: usize = 100;

/// A folder that is being filled, with the lock that says that its process lives.
#[derive(Debug)]
pub(crate) struct Staging {
    _alive: [Option<File>; 2],
    folder: TempDir,
}

impl Staging {
    /// Where it is.
    pub(crate) fn path(&self) -> &Path {
        self.folder.path()
    }

    /// The lock goes, the folder stays wherever it is: under its final name, or after a kill.
    pub(crate) fn keep(self) {
        let _ = self.folder.keep();
    }
}

/// A file in `place`, locked as long as it is open anywhere in this process.
pub(crate) fn file(builder: &Builder<'_, '_>, place: &Path) -> io::Result<NamedTempFile> {
    for _ in 0..TRIES {
        let file = builder.tempfile_in(place)?;
        // As with folders, a lock that somebody else holds is that of a process which is clearing it away.
        let taken = matches!(file.as_file().try_lock(), Err(TryLockError::WouldBlock));
        if !taken && file.path().exists() {
            return Ok(file);
        }
    }
    Err(io::Error::other("another process removes temporary files"))
}

/// A folder in `place`.
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
        // A lock that somebody else holds is that of a process which is clearing this folder away. Where the file system has no locks,
        // nothing is ever cleared, and all goes well without.
        if matches!(file.try_lock(), Err(TryLockError::WouldBlock)) {
            continue;
        }
        if path.exists() {
            return Ok(Staging { _alive: [whole, Some(file)], folder });
        }
    }
    Err(last.unwrap_or_else(|| io::Error::other("another process removes temporary folders")))
}

/// The folder becomes a result: it is no longer to be cleared.
pub(crate) fn forget(folder: &Path) -> io::Result<()> {
    match fs::remove_file(folder.join(LOCK)) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// A folder that somebody else has locked.
struct Taken;

/// The folder with a lock on it; none where the system locks no folders.
fn locked(folder: &Path) -> Result<Option<File>, Taken> {
    let Ok(file) = File::open(folder) else { return Ok(None) };
    match file.try_lock() {
        Ok(()) => Ok(Some(file)),
        Err(TryLockError::WouldBlock) => Err(Taken),
        Err(TryLockError::Error(_)) => Ok(None),
    }
}

/// Removes folders and files that processes which live no longer have left in `place`. What cannot be removed stays: it is not this run's business.
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

    /// A run found its folder gone: another had taken it for litter between its making and its lock.
    #[test]
    fn a_folder_that_is_being_made_is_no_litter() {
        let place = tempfile::tempdir().unwrap();
        thread::scope(|scope| {
            let clearing = scope.spawn(|| (0..20_000).for_each(|_| clear(place.path())));
            while !clearing.is_finished() {
                let staging = staging(Builder::new().prefix(PREFIX), place.path()).unwrap();
                // What was going to remove it has had its time.
                thread::yield_now();
                clear(place.path());
                assert!(staging.path().join(LOCK).exists());
            }
        });
    }

    /// A process was killed while it made its folder, while it gave it its name or while it cleared one away: the folder had no locked file, and no later run removed
    /// it (one of 160 kills).
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
