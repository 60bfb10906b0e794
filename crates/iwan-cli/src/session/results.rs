//! Where results go: a folder whose files appear together or not at all.

use std::io::Write;
use std::path::{Path, PathBuf};

use iwan_io::Table;
use iwan_io::atomic::{Folder, WriteError};
use iwan_machine::Kind;

use crate::args::Format;
use crate::failure::Failure;
use crate::shown;

/// A results folder that is being filled.
#[derive(Debug)]
pub(crate) struct Results {
    folder: Folder,
    path: PathBuf,
    /// The default name, where the user named no folder.
    default: Option<String>,
    /// Dropped after `folder`, when the staged files are gone.
    _parents: Parents,
}

/// Parent folders of the results that did not exist; they are removed again where no results appeared in them.
#[derive(Debug)]
struct Parents(Vec<PathBuf>);

impl Parents {
    fn missing(path: &Path) -> Self {
        let above = path.ancestors().skip(1).filter(|p| !p.as_os_str().is_empty());
        Self(above.take_while(|p| p.symlink_metadata().is_err()).map(Path::to_path_buf).collect())
    }
}

impl Drop for Parents {
    fn drop(&mut self) {
        // The innermost folder comes first; removing a folder that is not empty fails, as it should.
        for path in &self.0 {
            let _ = std::fs::remove_dir(path);
        }
    }
}

impl Results {
    /// Chooses the folder and checks that it can be written: `given` by the user, else `default` or, where that exists, `default` with the next free
    /// number.
    pub(crate) fn open(
        given: Option<&Path>,
        default: &str,
        force: bool,
        names: &[&str],
    ) -> Result<Self, Failure> {
        let chosen = (given.is_none() && !force).then(|| default.to_owned());
        let input = |error: WriteError| match error {
            WriteError::Exists { path } => Failure::input(
                format!("{} exists already; nothing was written", shown::path(&path)),
                "choose another folder with --out, or overwrite with --force",
            )
            .of(Kind::Exists),
            other if other.is_of_machine() => failed(&other),
            other => Failure::input(other.to_string(), "choose a folder you may write to with --out DIR")
                .of(other.kind()),
        };
        loop {
            let path = given.map_or_else(|| free(default, force), Path::to_path_buf);
            let parents = Parents::missing(&path);
            let staged = Folder::stage(&path, force)
                .and_then(|folder| folder.check(names).map(|()| folder.in_place_of(names)));
            match staged {
                Ok(folder) => return Ok(Self { folder, path, default: chosen, _parents: parents }),
                // Another run has taken the folder since it was found free; the next number is tried.
                Err(WriteError::Exists { .. } | WriteError::Busy { .. }) if chosen.is_some() => {}
                Err(error) => return Err(input(error)),
            }
        }
    }

    /// The folder in which the files are kept until they appear together.
    pub(crate) fn staged(&self) -> &Path {
        self.folder.staged()
    }

    /// The folder in which the results will appear.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Keeps a file of an earlier run in its place.
    pub(crate) fn spare(&mut self, name: &str) {
        self.folder.spare(name);
    }

    /// Adds a file whose content is in memory.
    pub(crate) fn add(&mut self, name: &str, content: &[u8]) -> Result<(), Failure> {
        self.folder.write(name, |w| w.write_all(content)).map_err(|e| failed(&e))
    }

    /// Adds a file that `fill` writes.
    pub(crate) fn add_written(
        &mut self,
        name: &str,
        fill: impl FnOnce(&mut std::io::BufWriter<std::fs::File>) -> std::io::Result<()>,
    ) -> Result<(), Failure> {
        self.folder.write(name, fill).map_err(|e| failed(&e))
    }

    /// Adds a table.
    pub(crate) fn add_table(&mut self, name: &str, table: &Table<'_>, format: Format) -> Result<(), Failure> {
        let written = self.folder.write(name, |w| match format {
            Format::Csv => table.csv_to(w),
            Format::Npz => table.npz_to(w),
            Format::Parquet => table.parquet_to(w),
        });
        written.map_err(|e| failed(&e))
    }

    /// Makes all files visible and returns their folder. Where two runs chose the same default folder, the later one takes the next free number.
    pub(crate) fn commit(self) -> Result<PathBuf, Failure> {
        let committed = match &self.default {
            Some(default) => self.folder.commit_where_free(|| free(default, false)),
            None => self.folder.commit().map(|()| self.path),
        };
        committed.map_err(|e| failed(&e))
    }
}

fn failed(error: &WriteError) -> Failure {
    Failure::computation(error.to_string().replacen("; ", "\nremedy: ", 1)).of(error.kind())
}

/// The folder `default`, or the first of `default-2`, `default-3`, … that does not exist.
fn free(default: &str, force: bool) -> PathBuf {
    let first = PathBuf::from(default);
    if force || first.symlink_metadata().is_err() {
        return first;
    }
    let numbered = (2..).map(|n: u32| PathBuf::from(format!("{default}-{n}")));
    numbered.into_iter().find(|path| path.symlink_metadata().is_err()).unwrap_or(first)
}
