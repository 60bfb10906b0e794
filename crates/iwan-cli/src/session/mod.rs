//! One run of a computing command, from the choice of its folder to the last line on the terminal.
//!
//! A command reads its arguments and its input, opens a session for the files it will write, computes, and hands over what
//! it found: tables, a page, and a [`Summary`]. The session does all that commands have in common. It refuses a folder that
//! cannot be written before anything is computed, keeps Ctrl-C from leaving half a result, puts progress, notes and
//! warnings on standard error unless `--quiet` is given, lets all files appear together, and prints the summary.

mod warnings;
mod results;
mod summary;

use std::path::Path;
use std::sync::Arc;

use iwan_io::Table;
use iwan_machine::Kind;
use iwan_machine::checkpoint::{Checkpoint, Digest};
use iwan_machine::threads::limit;

use crate::args::{Common, Format, Keeping};
use crate::failure::{Failure, VERSION};
use crate::output;
use crate::progress::{self, Bar};
use crate::shown;
pub(crate) use results::Results;
pub(crate) use summary::{Summary, alone};
pub(crate) use warnings::Warnings;

/// Name of the summary in the folder of every command.
pub(crate) const SUMMARY: &str = "summary.json";

/// Name of the page in the folder of every command.
pub(crate) const PAGE: &str = "report.html";

/// Where the results go: a folder that the user names, or a default one.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place<'a> {
    /// The folder of `--out`, where it is given.
    pub(crate) given: Option<&'a Path>,
    /// The default folder; where it exists, the next free number is put behind its name.
    pub(crate) default: &'static str,
    /// Whether `--force` allows existing results to be overwritten.
    pub(crate) force: bool,
}

/// A running command.
#[derive(Debug)]
pub(crate) struct Session {
    results: Results,
    files: Vec<String>,
    console: Console,
    json: bool,
    strict: bool,
    threads: usize,
    kept: Option<Arc<Checkpoint>>,
    /// Warnings about the input that make the results doubtful.
    doubts: Warnings,
}

/// Standard error, where `--quiet` allows it.
#[derive(Debug, Clone, Copy)]
struct Console {
    quiet: bool,
}

impl Console {
    fn say(self, text: &str) {
        if !self.quiet {
            output::message(text);
        }
    }

    /// Prints notes or warnings, which begin with this `word`.
    fn all(self, word: &str, texts: &[String]) {
        for text in texts {
            self.say(&format!("{word}: {text}"));
        }
    }
}

impl Session {
    /// Opens the folder for `files` and fails where it cannot be written; from now on Ctrl-C is noticed.
    pub(crate) fn open(
        place: Place<'_>,
        common: &Common,
        files: impl IntoIterator<Item = impl Into<String>>,
    ) -> Result<Self, Failure> {
        let files: Vec<String> = files.into_iter().map(Into::into).collect();
        let names: Vec<&str> = files.iter().map(String::as_str).collect();
        if let Some(threads) = common.threads {
            limit(threads.get());
        }
        // Ctrl-C is caught before there is a folder that it could leave behind.
        progress::catch_interrupts();
        let results = Results::open(place.given, place.default, place.force, &names)?;
        progress::staged(results.staged());
        let console = Console { quiet: common.quiet };
        Ok(Self {
            results,
            files,
            console,
            json: common.json,
            strict: common.strict,
            threads: common.thread_count(),
            kept: None,
            doubts: Warnings::default(),
        })
    }

    /// Number of threads to use.
    pub(crate) fn threads(&self) -> usize {
        self.threads
    }

    /// Opens the checkpoint folder for work of the kind `of`, where one is wanted. `given` is all input on which the results depend.
    pub(crate) fn checkpoint(
        &mut self,
        keeping: &Keeping,
        of: &str,
        given: impl FnOnce() -> Digest,
    ) -> Result<Option<Arc<Checkpoint>>, Failure> {
        let Some(folder) = &keeping.checkpoint else { return Ok(None) };
        let opened = Checkpoint::open(folder, of, VERSION, given()).map_err(|error| {
            let text = error.to_string();
            let (message, remedy) = text.split_once("; ").unwrap_or((&text, ""));
            Failure::input(message, remedy).of(error.kind())
        })?;
        self.kept = Some(Arc::new(opened));
        Ok(self.kept.clone())
    }

    /// A progress bar, for work that can tell how far it is.
    pub(crate) fn bar(&self, title: &'static str) -> Bar {
        Bar::new(title, self.console.quiet)
    }

    /// A spinner, for work that cannot tell how far it is.
    pub(crate) fn busy(&self, title: &'static str) -> Bar {
        Bar::busy(title, self.console.quiet)
    }

    /// Prints notes on the input.
    pub(crate) fn notes(&self, notes: &[String]) {
        self.console.all("note", &notes.iter().cloned().collect::<Warnings>());
    }

    /// Prints warnings about the input, before the work begins. Those among them that make the results doubtful, the `doubts`, count with `--strict`.
    pub(crate) fn warnings(&mut self, warnings: &[String], doubts: &[String]) {
        self.console.all("warning", &warnings.iter().cloned().collect::<Warnings>());
        self.doubts.extend(doubts.iter().cloned());
    }

    /// Adds a file whose content is in memory.
    pub(crate) fn file(&mut self, name: &str, content: &[u8]) -> Result<(), Failure> {
        progress::check_interrupt()?;
        debug_assert!(self.files.iter().any(|file| file == name), "{name} was not announced");
        self.results.add(name, content)
    }

    /// Adds a file that `fill` writes, where the content is too large to be held in memory a second time.
    pub(crate) fn written(
        &mut self,
        name: &str,
        fill: impl FnOnce(&mut std::io::BufWriter<std::fs::File>) -> std::io::Result<()>,
    ) -> Result<(), Failure> {
        progress::check_interrupt()?;
        debug_assert!(self.files.iter().any(|file| file == name), "{name} was not announced");
        self.results.add_written(name, fill)
    }

    /// The folder in which the files are kept until they appear together.
    pub(crate) fn staged(&self) -> &Path {
        self.results.staged()
    }

    /// The folder in which the results will appear.
    pub(crate) fn folder(&self) -> &Path {
        self.results.path()
    }

    /// Withdraws the announcement of a file that will not be written; with `--force` a file of this name from an earlier run is removed.
    pub(crate) fn omit(&mut self, name: &str) {
        self.files.retain(|file| file != name);
    }

    /// Withdraws the announcement of a file, but keeps a file of this name from an earlier run: this run may have read it.
    pub(crate) fn spare(&mut self, name: &str) {
        self.omit(name);
        self.results.spare(name);
    }

    /// Adds a table.
    pub(crate) fn table(&mut self, name: &str, table: &Table<'_>, format: Format) -> Result<(), Failure> {
        progress::check_interrupt()?;
        debug_assert!(self.files.iter().any(|file| file == name), "{name} was not announced");
        self.results.add_table(name, table, format)
    }

    /// Adds a table whose column names the program itself has chosen.
    pub(crate) fn columns<N: ToString>(
        &mut self,
        name: &str,
        columns: &[(N, Vec<f64>)],
        format: Format,
    ) -> Result<(), Failure> {
        let columns = columns.iter().map(|(name, values)| (name.to_string(), values.as_slice())).collect();
        let table = Table::new(columns).map_err(|error| Failure::computation(error.to_string()))?;
        self.table(name, &table, format)
    }

    /// Adds a summary as JSON.
    pub(crate) fn summary(&mut self, name: &str, summary: &impl Summary) -> Result<(), Failure> {
        let text = summary::written(summary, &self.files);
        self.file(name, text.as_bytes())
    }

    /// Adds the page.
    pub(crate) fn page(&mut self, page: &str) -> Result<(), Failure> {
        self.file(PAGE, page.as_bytes())
    }

    /// Makes all files visible, says where they are, and prints the summary.
    pub(crate) fn finish<S: Summary>(self, summary: &S) -> Result<(), Failure> {
        progress::check_interrupt()?;
        let ending = progress::ending();
        let folder = self.results.commit()?;
        progress::ended();
        drop(ending);
        let console = self.console;
        if let Some(kept) = &self.kept {
            console.all("warning", kept.warning().as_slice());
            kept.remove();
        }
        let heard = Console { quiet: console.quiet && !self.strict };
        if console.quiet {
            heard.all("warning", &self.doubts);
        }
        heard.all("warning", summary.warnings());
        console.say(&format!("results: {}", shown::path(&folder)));
        console.say(&format!("{}: {}", S::SHOWN, shown::path(&folder.join(PAGE))));
        let printed = if self.json {
            summary::printed(summary, &self.files, &folder)
        } else {
            iwan_machine::without_long_numbers(&summary.text()).into_owned()
        };
        output::result(&printed)?;
        match self.doubts.len() + summary.warnings().len() {
            n if self.strict && n > 0 => Err(Failure::computation(format!(
                "--strict: {n} warning{}, see above; the results are in {}",
                if n == 1 { "" } else { "s" },
                shown::path(&folder)
            ))
            .of(Kind::Strict)),
            _ => Ok(()),
        }
    }
}
