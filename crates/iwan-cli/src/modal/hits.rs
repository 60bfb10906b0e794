//! All files of a test together: one kind of motion for all sensors, the table's entries, hits that are left out.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use iwan_input::{ModalTable, Role};
use iwan_io::{Quantity, UffFunction};
use iwan_machine::threads::in_parallel;
use iwan_machine::{listed, memory};
use iwan_modal::measure::{Channel, Motion as Sensed, levels};

use super::args::ModalArgs;
use super::file_of_test::{FileOfTest, JudgedHit};
use super::geometry::{Geometry, is_universal};
use crate::failure::Failure;
use crate::records::Motion;
use crate::shown;

/// Columns of the table of shapes beside those of the channels.
pub(super) const COLUMNS: [&str; 2] = ["frequency", "damping_ratio"];

/// The contents of all files.
pub(super) struct Test {
    pub(super) hits: Vec<JudgedHit>,
    /// Free decays without a force: name, sampling interval (s) and channels of each.
    pub(super) decays: Vec<(String, f64, Vec<Channel>)>,
    /// Frequency responses that another program measured.
    pub(super) functions: Vec<UffFunction>,
    pub(super) motion: Sensed,
    pub(super) table: ModalTable,
    pub(super) geometry: Geometry,
    pub(super) warnings: Vec<String>,
}

impl Test {
    /// Reads all files.
    pub(super) fn read(args: &ModalArgs) -> Result<Self, Failure> {
        let mut warnings = Vec::new();
        let (mut table, mut geometry) = (ModalTable::default(), Geometry::default());
        if let Some(path) = &args.points {
            if let Some(bytes) = iwan_machine::read_file(path).ok().filter(|bytes| is_universal(bytes)) {
                warnings = geometry.add(path, &bytes)?;
            } else {
                table = ModalTable::read(path)?;
                geometry = Geometry::of_table(&table);
            }
        }
        let mut test = Self {
            hits: Vec::new(),
            decays: Vec::new(),
            functions: Vec::new(),
            motion: args.quantity.map_or(Sensed::Acceleration, sensed),
            table,
            geometry,
            warnings,
        };
        let mut quantities = Vec::new();
        // Of several files that cannot be read, the error names the first in their order, whatever the number of threads.
        let read = |path: &PathBuf| FileOfTest::read(path, &test.table, args);
        let files = in_parallel(&args.files, args.common.thread_count(), &read);
        for (path, file) in args.files.iter().zip(files) {
            test.add(path, file?, &mut quantities)?;
        }
        test.settle_motion(args, &quantities)?;
        test.look_for_entries(args)?;
        if !test.hits.is_empty() && !test.functions.is_empty() {
            let message = "some files hold hits, others frequency responses".to_string();
            return Err(Failure::input(message, "give either of them"));
        }
        test.leave_out(&args.leave_out)?;
        test.check_level(args.level)?;
        test.check_names()?;
        test.ask()?;
        Ok(test)
    }

    /// Refuses a level of force that the hits do not have.
    fn check_level(&self, level: NonZeroUsize) -> Result<(), Failure> {
        let used = self.hits.iter().filter(|hit| !hit.left_out);
        let peaks: Vec<f64> = used.map(|hit| hit.hit.peak_force()).collect();
        let count = levels(&peaks).len().max(1);
        if level.get() <= count {
            return Ok(());
        }
        let message = format!(
            "--level {level}: there {} of force",
            if count == 1 { "is one level".into() } else { format!("are {count} levels") }
        );
        Err(Failure::input(message, "choose one of them, the softest is 1"))
    }

    /// Refuses channels and points that are called as columns of the table of shapes are.
    fn check_names(&self) -> Result<(), Failure> {
        let of_hits = self.hits.iter().flat_map(|hit| &hit.hit.responses);
        let of_decays = self.decays.iter().flat_map(|decay| &decay.2);
        let named =
            of_hits.chain(of_decays).map(|channel| (channel.name.as_str(), channel.freedom.point.as_str()));
        let Some((channel, point)) =
            named.into_iter().find(|(channel, point)| COLUMNS.contains(channel) || COLUMNS.contains(point))
        else {
            return Ok(());
        };
        let message = format!(
            "channel \"{channel}\" at point \"{point}\": {} are columns of the table of shapes",
            COLUMNS.join(" and ")
        );
        Err(Failure::input(
            message,
            "call it otherwise in the file, or leave it out by role = \"none\" in the table of --points",
        ))
    }

    /// Asks for the memory of the transforms of all hits and of what is drawn of them.
    fn ask(&self) -> Result<(), Failure> {
        /// Memory in bytes that a sample of a hit takes: 41 to 80 were measured, with the modes of a few responses.
        const SAMPLE: u64 = 100;
        let of_hits = self.hits.iter().flat_map(|hit| &hit.hit.responses);
        let of_decays = self.decays.iter().flat_map(|decay| &decay.2);
        let samples = of_hits.chain(of_decays).map(|channel| channel.samples.len() as u64).sum::<u64>();
        let remedy = "give fewer hits or channels, or shorter records";
        memory::ask(format!("the analysis of {samples} samples"), samples.saturating_mul(SAMPLE), remedy)
            .map_err(Failure::from)
    }

    fn add(
        &mut self,
        path: &Path,
        file: FileOfTest,
        quantities: &mut Vec<(String, Quantity)>,
    ) -> Result<(), Failure> {
        self.warnings.extend(file.warnings);
        if let Some(bytes) = &file.universal {
            self.warnings.extend(self.geometry.add(path, bytes)?);
        }
        self.hits.extend(file.hits);
        self.decays.extend(file.decays);
        self.functions.extend(file.functions);
        quantities.extend(file.quantities);
        Ok(())
    }

    /// Chooses the kind of motion (displacement, velocity or acceleration) that all sensors measure.
    fn settle_motion(&mut self, args: &ModalArgs, quantities: &[(String, Quantity)]) -> Result<(), Failure> {
        if args.quantity.is_some() {
            return Ok(());
        }
        let mut first: Option<&(String, Quantity)> = None;
        for own in quantities {
            if !own.1.is_motion() && own.1 != Quantity::Unknown {
                let message = format!("{} measures {}, not a motion", own.0, own.1);
                return Err(Failure::input(
                    message,
                    "give it role = \"none\" in the table of --points, or say with --quantity what motion it is",
                ));
            }
            if own.1 == Quantity::Unknown {
                continue;
            }
            match first {
                Some(known) if known.1 != own.1 => {
                    let message = format!("{} measures {}, {} {}", known.0, known.1, own.0, own.1);
                    return Err(Failure::input(
                        message,
                        "give channels of one kind of motion, or say with --quantity which all are",
                    ));
                }
                _ => first = Some(own),
            }
        }
        match first.map(|f| f.1) {
            Some(Quantity::Velocity) => self.motion = Sensed::Velocity,
            Some(Quantity::Displacement) => self.motion = Sensed::Displacement,
            Some(_) => {}
            None => self.warnings.push(
                "the files do not say what the sensors measure: taken as acceleration; --quantity says otherwise".into(),
            ),
        }
        Ok(())
    }

    /// Refuses entries of the table that occur in no file: a point is missing, or its name is wrong.
    fn look_for_entries(&self, args: &ModalArgs) -> Result<(), Failure> {
        let Some(place) = &args.points else { return Ok(()) };
        let channels = || {
            let hits = self.hits.iter().flat_map(|h| {
                std::iter::once(&h.hit.force)
                    .chain(&h.hit.responses)
                    .map(move |c| (h.file.as_str(), c.name.as_str()))
            });
            hits.chain(
                self.decays.iter().flat_map(|d| d.2.iter().map(move |c| (d.0.as_str(), c.name.as_str()))),
            )
        };
        for entry in self.table.channels.iter().filter(|e| e.role != Role::None) {
            let here = |file: &str| entry.file.as_ref().is_none_or(|own| Path::new(file).ends_with(own));
            let force_of_decays = entry.role == Role::Force && self.hits.is_empty();
            if force_of_decays || channels().any(|(file, name)| name == entry.name && here(file)) {
                continue;
            }
            let file = entry.file.as_deref().unwrap_or("all files");
            let message = format!(
                "{}: point {} is missing: no channel \"{}\" in {file}",
                shown::path(place),
                entry.point,
                entry.name
            );
            let remedy = "check the names of file and channel, give the file, or take the entry out";
            return Err(Failure::input(message, remedy));
        }
        Ok(())
    }

    fn leave_out(&mut self, names: &[String]) -> Result<(), Failure> {
        for name in names {
            let mut found = false;
            for judged in &mut self.hits {
                let own = judged.hit.name == *name || Path::new(&judged.hit.name).ends_with(name);
                if own || name == "faulty" && !judged.faults.is_empty() {
                    (judged.left_out, found) = (true, true);
                }
            }
            if !found && name != "faulty" {
                let all: Vec<&str> = self.hits.iter().map(|h| h.hit.name.as_str()).collect();
                let message =
                    format!("--leave-out {name}: there is no such hit (there are: {})", listed(all));
                return Err(Failure::input(message, "choose one of those, or `faulty`"));
            }
        }
        if !self.hits.is_empty() && self.hits.iter().all(|h| h.left_out) {
            return Err(Failure::input("--leave-out leaves no hit", "leave fewer out"));
        }
        // Dividing a response by a force that is only noise gives no frequency response.
        if let Some(judged) = self.hits.iter().find(|h| !h.left_out && !h.has_pulse) {
            let name = &judged.hit.name;
            return Err(Failure::input(
                format!("{name}: {}", judged.in_words().join("; ")),
                format!(
                    "name the hammer with --hammer NAME, leave the hit out with --leave-out \"{name}\", or take the force from end to end with --whole-force"
                ),
            ));
        }
        Ok(())
    }
}

fn sensed(motion: Motion) -> Sensed {
    match motion {
        Motion::Acceleration => Sensed::Acceleration,
        Motion::Velocity => Sensed::Velocity,
        Motion::Displacement => Sensed::Displacement,
    }
}
