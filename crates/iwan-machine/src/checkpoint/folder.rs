//! The folder in which finished parts of work are kept.

use std::collections::HashMap;
use std::fmt::Write as _;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::digest::Digest;
use super::pieces::{self, State};
use crate::kinds::Kind;

/// Name of the file that says to which work the pieces in the folder belong.
const SAID: &str = "checkpoint.json";
/// Name of the file that holds the results of searches, one behind the other.
const JOURNAL: &str = "searches.journal";
/// Ending of the names of files that hold states.
const STATE: &str = ".state";

/// Shortest time between two writings of a state: to lose less than that is not worth a writing.
const OFTEN: Duration = Duration::from_secs(1);
/// Least time between two writings of a state, in units of the time that a writing takes: writing then costs a twentieth of the run at
/// most.
const SPARINGLY: u32 = 20;

/// Why a folder cannot serve as checkpoint.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    /// The folder cannot be read or written.
    #[error("checkpoint {}: {source}; give a folder that may be written to", folder.display())]
    Io {
        /// The folder.
        folder: PathBuf,
        /// The operating system's error.
        source: io::Error,
    },
    /// The folder holds files that belong to no checkpoint.
    #[error("checkpoint {}: holds files, but no {SAID}; give a folder of its own", folder.display())]
    Foreign {
        /// The folder.
        folder: PathBuf,
    },
    /// The folder holds a checkpoint of other work.
    #[error(
        "checkpoint {}: is of other work ({differs}); repeat the command and the input that began it, or give another folder", folder.display()
    )]
    OtherWork {
        /// The folder.
        folder: PathBuf,
        /// The parts of the work that differ.
        differs: String,
    },
}

impl CheckpointError {
    /// The error's kind in the catalogue of errors.
    #[must_use]
    pub const fn kind(&self) -> Kind {
        match self {
            Self::Io { .. } => Kind::Unwritable,
            Self::Foreign { .. } | Self::OtherWork { .. } => Kind::Checkpoint,
        }
    }
}

/// A folder that keeps finished parts of one piece of work, and returns them to a later process that does the same work.
///
/// Results of searches are appended as they are found; states of work that proceeds step by step replace each other. Both are found by keys
/// that hold all they depend on. A piece that is incomplete is ignored, so that a process may be killed at any time. A failure to write
/// does not stop the work; [`warning`](Self::warning) reports it.
///
/// ```
/// use iwan_machine::checkpoint::{Checkpoint, Digest};
/// let place = tempfile::tempdir()?;
/// let (folder, work, key) = (place.path().join("kept"), Digest::default().text("a scenario"), Digest::default().count(1).value());
/// let first = Checkpoint::open(&folder, "sums", "1.0", work)?;
/// first.note(key, &[0.1, f64::NAN]);
/// first.replace(key, 20, &[&[1.5], &[]]);
/// drop(first); // … or the process is killed
/// let second = Checkpoint::open(&folder, "sums", "1.0", work)?;
/// assert!(second.noted(key).is_some_and(|x| x[0] == 0.1 && x[1].is_nan()));
/// assert_eq!(second.state(key).unwrap().steps, 20);
/// assert!(Checkpoint::open(&folder, "sums", "1.1", work).unwrap_err().to_string().contains("version"));
/// second.remove();
/// assert!(!folder.exists());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Checkpoint {
    folder: PathBuf,
    journal: Mutex<Journal>,
    failed: Mutex<Option<String>>,
}

#[derive(Debug)]
struct Journal {
    file: File,
    known: HashMap<u128, Vec<f64>>,
}

impl Checkpoint {
    /// Opens the folder, and makes it where it does not exist. `of` names the kind of work; `given` is a digest of all that its results
    /// depend on.
    ///
    /// # Errors
    /// [`CheckpointError`]: also for a folder that holds other work, so that results are never mixed.
    pub fn open(folder: &Path, of: &str, version: &str, given: Digest) -> Result<Self, CheckpointError> {
        let io = |source| CheckpointError::Io { folder: folder.to_path_buf(), source };
        let said = said(of, version, given);
        fs::create_dir_all(folder).map_err(io)?;
        let path = folder.join(SAID);
        if !path.try_exists().map_err(io)? {
            // Files of a process that was killed while it wrote its first file are no other work.
            let mut others = fs::read_dir(folder).map_err(io)?;
            let unfinished = |name: &str| name.starts_with(SAID);
            if others.any(|e| e.is_ok_and(|e| !e.file_name().to_str().is_some_and(unfinished))) {
                return Err(CheckpointError::Foreign { folder: folder.to_path_buf() });
            }
            replace(&path, said.as_bytes()).map_err(io)?;
        }
        let found = crate::read_file(&path).map_err(io)?;
        if found != said.as_bytes() {
            let differs = differing(&said, &String::from_utf8_lossy(&found));
            return Err(CheckpointError::OtherWork { folder: folder.to_path_buf(), differs });
        }
        let journal = Mutex::new(Journal::open(&folder.join(JOURNAL)).map_err(io)?);
        Ok(Self { folder: folder.to_path_buf(), journal, failed: Mutex::default() })
    }

    /// The result of a search, if it was noted under this key.
    #[must_use]
    pub fn noted(&self, key: u128) -> Option<Vec<f64>> {
        locked(&self.journal).known.get(&key).cloned()
    }

    /// Notes the result of a search under its key.
    pub fn note(&self, key: u128, result: &[f64]) {
        let mut journal = locked(&self.journal);
        if journal.known.insert(key, result.to_vec()).is_none() {
            let written = journal.file.write_all(&pieces::written(key, result));
            self.remember(JOURNAL.as_ref(), written);
        }
    }

    /// The last state that was written under this key.
    #[must_use]
    pub fn state(&self, key: u128) -> Option<State> {
        let bytes = crate::read_file(&self.folder.join(name(key))).ok()?;
        pieces::read_state(key, &bytes)
    }

    /// Replaces the last state of this key; that one stays until the new one is completely on the disk. Returns the time to wait before the
    /// next writing.
    pub fn replace(&self, key: u128, steps: usize, numbers: &[&[f64]]) -> Duration {
        let (begun, path) = (Instant::now(), self.folder.join(name(key)));
        let written = replace(&path, &pieces::state(key, steps, numbers));
        self.remember(&path, written);
        OFTEN.max(SPARINGLY * begun.elapsed())
    }

    fn remember(&self, path: &Path, written: io::Result<()>) {
        if let Err(error) = written {
            let text = format!(
                "checkpoint {}: cannot be written ({error}); a run that is broken off begins again from what was kept before",
                path.display()
            );
            locked(&self.failed).get_or_insert(text);
        }
    }

    /// What could not be written; none where all was written.
    #[must_use]
    pub fn warning(&self) -> Option<String> {
        locked(&self.failed).clone()
    }

    /// Removes the files that were kept, and the folder if nothing else is in it.
    pub fn remove(&self) {
        for path in self.files() {
            // A file that cannot be removed stays; the next run of other work in this folder is refused because of it.
            let _ = fs::remove_file(path);
        }
        let _ = fs::remove_dir(&self.folder);
    }

    /// The files that were kept. The file that says to which work they belong comes last: a process may be killed while it removes them,
    /// and a folder without this file no longer counts as a checkpoint.
    fn files(&self) -> Vec<PathBuf> {
        let is_said = |name: &str| name.starts_with(SAID);
        let own = |name: &str| name == JOURNAL || name.contains(STATE) || is_said(name);
        let all = fs::read_dir(&self.folder).into_iter().flatten().flatten();
        let mut names: Vec<String> =
            all.filter_map(|file| file.file_name().into_string().ok()).filter(|name| own(name)).collect();
        names.sort_by_key(|name| is_said(name));
        names.iter().map(|name| self.folder.join(name)).collect()
    }
}

impl Journal {
    /// Reads the complete pieces; later pieces are appended behind them.
    fn open(path: &Path) -> io::Result<Self> {
        let mut file = OpenOptions::new().append(true).create(true).open(path)?;
        let bytes = crate::read_file(path)?;
        let (mut known, mut rest) = (HashMap::new(), bytes.as_slice());
        while let Some((key, numbers, behind)) = pieces::read(rest) {
            known.insert(key, numbers);
            rest = behind;
        }
        if !rest.is_empty() {
            // The process was killed, or the disk was full, while a piece was written: the incomplete piece is cut off.
            file.set_len((bytes.len() - rest.len()) as u64)?;
            file.flush()?;
        }
        Ok(Self { file, known })
    }
}

fn name(key: u128) -> String {
    format!("{key:032x}{STATE}")
}

/// The text that identifies the work: one line for each of its parts.
fn said(of: &str, version: &str, given: Digest) -> String {
    format!("{{\n \"of\": {of:?},\n \"version\": {version:?},\n \"given\": \"{:032x}\"\n}}\n", given.value())
}

/// The parts in which two pieces of work differ.
fn differing(said: &str, found: &str) -> String {
    let name = |line: &str| line.split('"').nth(1).map(str::to_owned);
    let differ = |line: &&str| !found.lines().any(|other| &other == line);
    let mut parts = String::new();
    for part in said.lines().filter(differ).filter_map(name) {
        let comma = if parts.is_empty() { "" } else { ", " };
        // Writing to a string cannot fail.
        let _ = write!(parts, "{comma}{part}");
    }
    let verb = if parts.contains(',') { "differ" } else { "differs" };
    if parts.is_empty() { format!("{SAID} is damaged") } else { format!("{parts} {verb}") }
}

/// Replaces a file as a whole, so that it never holds a part of the new content.
fn replace(path: &Path, content: &[u8]) -> io::Result<()> {
    let mut temporary = path.as_os_str().to_owned();
    temporary.push(format!(".{}", std::process::id()));
    let temporary = PathBuf::from(temporary);
    let write = || {
        let mut file = File::create(&temporary)?;
        file.write_all(content)?;
        file.sync_all()?;
        fs::rename(&temporary, path)
    };
    write().inspect_err(|_| drop(fs::remove_file(&temporary)))
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests may panic")]
mod tests {
    use super::*;

    fn open(folder: &Path, given: usize) -> Result<Checkpoint, CheckpointError> {
        Checkpoint::open(folder, "tests", "1", Digest::default().count(given))
    }

    /// A process is killed while it writes a piece, at any byte of it: the pieces before it are read, and pieces noted later are read
    /// again.
    #[test]
    fn a_journal_that_is_cut_anywhere_goes_on() {
        let place = tempfile::tempdir().unwrap();
        let first = open(place.path(), 1).unwrap();
        first.note(7, &[1.0, -0.0, f64::INFINITY]);
        first.note(8, &[]);
        first.note(9, &[2.0]);
        drop(first);
        let path = place.path().join(JOURNAL);
        let whole = fs::read(&path).unwrap();
        for cut in 0..=whole.len() {
            fs::write(&path, &whole[..cut]).unwrap();
            let again = open(place.path(), 1).unwrap();
            let there = [7, 8, 9].map(|key| again.noted(key).is_some());
            assert_eq!(there, [64, 104, 152].map(|end| cut >= end), "cut at {cut}");
            again.note(10, &[3.0]);
            drop(again);
            let last = open(place.path(), 1).unwrap();
            assert_eq!(last.noted(10).unwrap(), [3.0]);
            assert_eq!(last.noted(7).map(|x| x[1].to_bits()), there[0].then_some((-0.0_f64).to_bits()));
        }
    }

    /// A run was once killed while it removed its checkpoint, and the next run was refused: the file that identifies the work had been
    /// removed first.
    #[test]
    fn a_removal_that_is_broken_off_leaves_a_checkpoint() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("kept");
        let first = open(&folder, 1).unwrap();
        first.note(7, &[1.0]);
        for key in 0..20 {
            first.replace(key, 1, &[&[2.0]]);
        }
        let files = first.files();
        assert_eq!(files.len(), 22);
        for path in &files {
            open(&folder, 1).unwrap();
            fs::remove_file(path).unwrap();
        }
        assert_eq!(files[21].file_name().unwrap(), SAID);
    }

    #[test]
    fn a_state_that_is_cut_or_changed_is_no_state() {
        let place = tempfile::tempdir().unwrap();
        let kept = open(place.path(), 1).unwrap();
        kept.replace(5, 12, &[&[1.0, 2.0], &[], &[3.0]]);
        let state = kept.state(5).unwrap();
        assert_eq!((state.steps, state.numbers.clone()), (12, vec![vec![1.0, 2.0], vec![], vec![3.0]]));
        assert!(kept.state(6).is_none());
        let path = place.path().join(name(5));
        let whole = fs::read(&path).unwrap();
        for at in 0..whole.len() {
            fs::write(&path, &whole[..at]).unwrap();
            assert!(kept.state(5).is_none(), "cut at {at}");
            let mut changed = whole.clone();
            changed[at] ^= 4;
            fs::write(&path, changed).unwrap();
            assert!(kept.state(5).is_none(), "changed at {at}");
        }
    }

    #[test]
    fn folders_of_others_are_left_alone() {
        let place = tempfile::tempdir().unwrap();
        open(place.path(), 1).unwrap().note(1, &[1.0]);
        let message = open(place.path(), 2).unwrap_err().to_string();
        assert!(message.contains("given differs"), "{message}");
        fs::write(place.path().join(SAID), "{}").unwrap();
        assert!(matches!(open(place.path(), 1), Err(CheckpointError::OtherWork { .. })));
        let mine = place.path().join("mine");
        fs::create_dir(&mine).unwrap();
        fs::write(mine.join("thesis.tex"), "x").unwrap();
        assert!(matches!(open(&mine, 1), Err(CheckpointError::Foreign { .. })));
        assert!(matches!(open(&mine.join("thesis.tex"), 1), Err(CheckpointError::Io { .. })));
        assert_eq!(fs::read_dir(&mine).unwrap().count(), 1);
    }

    /// Files that a user puts beside the pieces stay.
    #[test]
    fn the_end_removes_its_own_files_only() {
        let place = tempfile::tempdir().unwrap();
        let kept = open(place.path(), 1).unwrap();
        kept.replace(5, 1, &[&[1.0]]);
        fs::write(place.path().join("notes.txt"), "x").unwrap();
        kept.remove();
        let left: Vec<_> = fs::read_dir(place.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
        assert_eq!(left, ["notes.txt"]);
    }

    /// A folder that vanishes during a run, or a full disk, leads to a warning and does not stop the run.
    #[test]
    fn what_cannot_be_written_is_told() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("kept");
        let kept = open(&folder, 1).unwrap();
        assert!(kept.warning().is_none());
        fs::remove_dir_all(&folder).unwrap();
        kept.replace(5, 1, &[&[1.0]]);
        assert!(kept.warning().is_some_and(|text| text.contains("cannot be written")));
    }
}
