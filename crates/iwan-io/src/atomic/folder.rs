//! Several files that appear together or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use super::file::{WriteError, builder, io_error, write_through};
use super::litter::{self, Staging};

/// Several files of one folder that become visible together.
///
/// A folder that does not exist yet appears in one step with all its files. In a folder that exists, the files are
/// renamed one after the other; when one renaming fails, the earlier ones are undone and the files they
/// replaced return. Only a crash between two renamings can leave some of the files. If the value is dropped without [`Folder::commit`], nothing
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
///
/// Of two processes with one destination, one writes all its files and the other gets an error. Files that a killed process has left behind
/// are removed by the next process that writes into the same place.
#[derive(Debug)]
pub struct Folder {
    target: PathBuf,
    /// Whether the folder existed when this value was made.
    joins: bool,
    /// A lock on the folder where it existed: nobody else writes into it.
    alone: Option<File>,
    staging: Staging,
    names: Vec<String>,
    /// Names of earlier results that are removed where no new file replaces them.
    outdated: Vec<String>,
    force: bool,
}

impl Folder {
    /// Prepares files for the folder `target`; its parents are made where they are missing.
    ///
    /// # Errors
    /// [`WriteError::Io`] when nothing can be written there, or `target` is a file; [`WriteError::Busy`] when another process writes
    /// into it.
    pub fn stage(target: impl AsRef<Path>, force: bool) -> Result<Self, WriteError> {
        let target = target.as_ref().to_path_buf();
        let parent = target.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let joins = target.exists();
        let place = if joins { target.as_path() } else { parent };
        fs::create_dir_all(place).map_err(io_error(&target, "make the folder"))?;
        let alone = if joins { locked(&target)? } else { None };
        litter::clear(place);
        let staging =
            litter::staging(&builder(0o777), place).map_err(io_error(&target, "make a temporary folder"))?;
        Ok(Self { target, joins, alone, staging, names: Vec::new(), outdated: Vec::new(), force })
    }

    /// The folder in which the files are until they appear. Code that ends the process without dropping this value must remove the folder.
    #[must_use]
    pub fn staged(&self) -> &Path {
        self.staging.path()
    }

    /// Checks early, before a long computation, whether these names may be written.
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

    /// States which files belong to these results. With `force`, files of an earlier run that this run does not write are removed when all
    /// appear, so that no folder holds results of two runs.
    #[must_use]
    pub fn in_place_of(mut self, names: &[&str]) -> Self {
        self.outdated = names.iter().map(ToString::to_string).collect();
        self
    }

    /// Keeps one of these files where it is although no new file replaces it.
    pub fn spare(&mut self, name: &str) {
        self.outdated.retain(|outdated| outdated != name);
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
        // Where the folder has appeared since this value was made, only the commit checks the names; it may choose another folder.
        if self.joins {
            self.check(&[name])?;
        }
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
    /// [`WriteError::Exists`], [`WriteError::Busy`], [`WriteError::Io`]; then no file has become visible and none was replaced.
    pub fn commit(self) -> Result<(), WriteError> {
        if !self.target.exists() {
            return self.appear().map_err(|refused| refused.1);
        }
        // The folder exists although it did not when this value was made: another process made it.
        let _alone = if self.alone.is_none() { locked(&self.target)? } else { None };
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
        for name in self.outdated.iter().filter(|name| self.force && !self.names.contains(name)) {
            // A file that cannot be moved stays, as do all files that are not among the names of results.
            let _ = fs::rename(self.target.join(name), replaced.path().join(name));
        }
        Ok(())
    }

    /// Makes all files visible in a folder that does not exist yet: the destination, or the first folder named by `next` that does not
    /// exist by then. Returns the folder.
    ///
    /// # Errors
    /// [`WriteError::Io`]; then nothing has become visible.
    pub fn commit_where_free(mut self, next: impl Fn() -> PathBuf) -> Result<PathBuf, WriteError> {
        loop {
            if self.target.symlink_metadata().is_ok() {
                self.target = next();
            }
            let target = self.target.clone();
            match self.appear() {
                Ok(()) => return Ok(target),
                Err(refused) => match *refused {
                    (folder, WriteError::Exists { .. }) => self = folder,
                    (_, error) => return Err(error),
                },
            }
        }
    }

    /// Renames the staged folder. The guard is released only after success, because it removes the staged files when dropped.
    fn appear(self) -> Result<(), Box<(Self, WriteError)>> {
        let renamed =
            litter::forget(self.staging.path()).and_then(|()| fs::rename(self.staging.path(), &self.target));
        match renamed {
            Ok(()) => {
                self.staging.keep();
                Ok(())
            }
            Err(error) => {
                let taken =
                    matches!(error.kind(), io::ErrorKind::AlreadyExists | io::ErrorKind::DirectoryNotEmpty);
                let path = self.target.clone();
                let error =
                    if taken { WriteError::Exists { path } } else { io_error(&path, "rename")(error) };
                Err(Box::new((self, error)))
            }
        }
    }

    /// Moves the old file, if any, aside and the new one in.
    fn exchange(&self, name: &str, replaced: &Path) -> Result<(), WriteError> {
        let (new, target) = (self.staging.path().join(name), self.target.join(name));
        if target.symlink_metadata().is_ok() {
            fs::rename(&target, replaced.join(name)).map_err(io_error(&target, "move the old file aside"))?;
        }
        fs::rename(&new, &target).map_err(io_error(&target, "rename"))
    }

    /// Undoes [`Folder::exchange`], also where only its first step was done.
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

/// A lock on the folder for this process alone; none where the system has no locks for folders.
fn locked(folder: &Path) -> Result<Option<File>, WriteError> {
    let Ok(file) = File::open(folder) else { return Ok(None) };
    match file.try_lock() {
        Err(fs::TryLockError::WouldBlock) => Err(WriteError::Busy { path: folder.into() }),
        Err(fs::TryLockError::Error(_)) => Ok(None),
        Ok(()) => Ok(Some(file)),
    }
}

#[cfg(test)]
mod tests {
    use super::super::file::tests::names;
    use super::*;
    use std::io::Write;

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

    /// A second fit with --force into one folder once left the first fit's law beside its own results.
    #[test]
    fn results_of_two_runs_do_not_stand_side_by_side() {
        let place = tempfile::tempdir().unwrap();
        for name in ["a", "law", "mine", "read"] {
            fs::write(place.path().join(name), "old").unwrap();
        }
        let mut folder =
            Folder::stage(place.path(), true).unwrap().in_place_of(&["a", "law", "read", "absent"]);
        folder.spare("read");
        folder.write("a", |w| w.write_all(b"new")).unwrap();
        folder.commit().unwrap();
        assert_eq!(names(place.path()), ["a", "mine", "read"]);
        assert_eq!(fs::read(place.path().join("a")).unwrap(), b"new");
    }

    /// Two processes once wrote into one folder that existed: five times of sixty it then held files of both.
    #[test]
    fn one_folder_has_one_writer() {
        let place = tempfile::tempdir().unwrap();
        let first = Folder::stage(place.path(), false).unwrap();
        assert!(matches!(Folder::stage(place.path(), false), Err(WriteError::Busy { .. })));
        drop(first);
        assert!(Folder::stage(place.path(), false).is_ok());
    }

    /// Of two runs that named no folder, the second once computed to the end and then failed.
    #[test]
    fn the_later_of_two_takes_the_next_name() {
        let place = tempfile::tempdir().unwrap();
        let (out, next) = (place.path().join("out"), place.path().join("out-2"));
        let both = [1, 2].map(|_| Folder::stage(&out, false).unwrap());
        let took = both.map(|mut folder| {
            // The second run finds its name taken by now.
            folder.write("a", |w| w.write_all(b"1")).unwrap();
            folder.commit_where_free(|| next.clone()).unwrap()
        });
        assert_eq!(took, [out.clone(), next.clone()]);
        assert_eq!((names(&out), names(&next)), (vec!["a".to_string()], vec!["a".to_string()]));
    }

    /// After SIGKILL, up to 650 MB once stayed for good.
    #[test]
    fn the_next_run_clears_what_a_killed_one_left() {
        let place = tempfile::tempdir().unwrap();
        let out = place.path().join("out");
        let mut killed = Folder::stage(&out, false).unwrap();
        killed.write("a", |w| w.write_all(b"1")).unwrap();
        let living = Folder::stage(&out, false).unwrap();
        assert_eq!(names(place.path()).len(), 2, "what a living process stages stays");
        killed.staging.keep();
        drop(Folder::stage(&out, false).unwrap());
        assert_eq!(names(place.path()).len(), 1);
        living.commit().unwrap();
        assert_eq!(names(place.path()), ["out"]);
        assert!(names(&out).is_empty());
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

    /// Overwriting once deleted a folder with all its contents, because its name was that of a file to be written.
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
