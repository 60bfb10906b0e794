//! From files to hits: which channel is the hammer, which are sensors, and where they are.

use std::path::Path;

use iwan_input::{InputText, ModalTable, Role};
use iwan_io::{MeasuredChannel, Measurement, NodalDirection, Quantity, ReadOptions, UffFunction};
use iwan_modal::measure::{Channel, Direction, Freedom, Hit, Motion as Sensed, cut, faults};

use super::args::ModalArgs;
use super::geometry::{Geometry, is_universal};
use crate::failure::Failure;
use crate::records::Motion;

/// A hit with what is wrong with it.
pub(super) struct JudgedHit {
    pub(super) hit: Hit,
    /// File that it comes from.
    pub(super) file: String,
    /// In words.
    pub(super) faults: Vec<String>,
    pub(super) left_out: bool,
}

/// What the files hold.
pub(super) struct Test {
    pub(super) hits: Vec<JudgedHit>,
    /// Free decays without a force: file, interval and channels of each.
    pub(super) decays: Vec<(String, f64, Vec<Channel>)>,
    /// Frequency responses that others measured.
    pub(super) functions: Vec<UffFunction>,
    pub(super) motion: Sensed,
    pub(super) table: ModalTable,
    pub(super) geometry: Geometry,
    pub(super) warnings: Vec<String>,
}

/// Names of channels that are hammers where no file says so.
const HAMMERS: [&str; 4] = ["force", "hammer", "impact", "load"];

impl Test {
    /// Reads all files.
    pub(super) fn read(args: &ModalArgs) -> Result<Self, Failure> {
        let mut warnings = Vec::new();
        let (mut table, mut geometry) = (ModalTable::default(), Geometry::default());
        if let Some(path) = &args.points {
            if let Some(bytes) = iwan_machine::read_file(path).ok().filter(|bytes| is_universal(bytes)) {
                warnings = geometry.add(path, &bytes)?;
            } else {
                table = ModalTable::parse(&InputText::read(path, "table of points", "paper-modal")?)?;
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
        for path in &args.files {
            test.add(path, args, &mut quantities)?;
        }
        test.settle_motion(args, &quantities)?;
        test.look_for_entries(args)?;
        if !test.hits.is_empty() && !test.functions.is_empty() {
            let message = "some files hold hits, others frequency responses".to_string();
            return Err(Failure::input(message, "give either of them"));
        }
        test.leave_out(&args.leave_out)?;
        Ok(test)
    }

    fn add(
        &mut self,
        path: &Path,
        args: &ModalArgs,
        quantities: &mut Vec<(String, Quantity)>,
    ) -> Result<(), Failure> {
        let name = path.display().to_string();
        let options = ReadOptions { time: args.time.clone(), rate: args.rate, ..ReadOptions::default() };
        let read = iwan_io::read_modal_test(path, &options).map_err(|e| Failure::read(&name, &e))?;
        self.warnings.extend(read.warnings.iter().map(|w| format!("{name}: {w}")));
        if let Some(bytes) = iwan_machine::read_file(path).ok().filter(|bytes| is_universal(bytes)) {
            self.warnings.extend(self.geometry.add(path, &bytes)?);
        }
        let several = read.measurements.len() > 1;
        for (n, measurement) in read.measurements.into_iter().enumerate() {
            let place = if several { format!("{name}, record {}", n + 1) } else { name.clone() };
            if args.free {
                let decay = self.decay(path, &place, measurement, args, quantities)?;
                self.decays.push(decay);
                continue;
            }
            let record = self.record(path, &place, measurement, args, quantities)?;
            for hit in cut(record) {
                let faults = faults(&hit).iter().map(ToString::to_string).collect();
                self.hits.push(JudgedHit { hit, file: name.clone(), faults, left_out: false });
            }
        }
        quantities.extend(read.responses.iter().map(|f| (format!("{name}, {}", f.name), f.quantity)));
        self.functions.extend(read.responses);
        Ok(())
    }

    /// One free decay.
    fn decay(
        &self,
        path: &Path,
        place: &str,
        measurement: Measurement,
        args: &ModalArgs,
        quantities: &mut Vec<(String, Quantity)>,
    ) -> Result<(String, f64, Vec<Channel>), Failure> {
        let skipped = (args.from.unwrap_or(0.0) / measurement.dt).round() as usize;
        let mut channels = Vec::new();
        for channel in measurement.channels {
            let entry = self.table.channel(path, &channel.name);
            if channel.quantity == Quantity::Force || entry.is_some_and(|e| e.role != Role::Response) {
                continue;
            }
            let freedom = self.freedom(path, place, &channel)?;
            quantities.push((format!("{place}, channel {}", channel.name), channel.quantity));
            let scale = entry.map_or(1.0, |e| e.scale);
            let samples = channel.samples.iter().skip(skipped).map(|x| scale * x).collect();
            channels.push(Channel { name: channel.name, freedom, samples });
        }
        if channels.is_empty() {
            return Err(Failure::input(
                format!("{place}: no channel measures a motion"),
                "check the file and the table of --points",
            ));
        }
        Ok((place.into(), measurement.dt, channels))
    }

    /// One record with its hammer and its sensors.
    fn record(
        &self,
        path: &Path,
        place: &str,
        measurement: Measurement,
        args: &ModalArgs,
        quantities: &mut Vec<(String, Quantity)>,
    ) -> Result<Hit, Failure> {
        let names: Vec<String> = measurement.channels.iter().map(|c| c.name.clone()).collect();
        let hammer = self.hammer(path, &measurement.channels, args).ok_or_else(|| {
            let message = format!("{place}: no channel measures a force (there are: {})", names.join(", "));
            Failure::input(message, "name the channel of the hammer with --hammer NAME, or give it role = \"force\" in the table of --points")
        })?;
        let (mut force, mut responses) = (None, Vec::new());
        for (k, channel) in measurement.channels.into_iter().enumerate() {
            let entry = self.table.channel(path, &channel.name);
            if k != hammer
                && (channel.quantity == Quantity::Force || entry.is_some_and(|e| e.role != Role::Response))
            {
                continue;
            }
            let freedom = self.freedom(path, place, &channel)?;
            if k != hammer {
                quantities.push((format!("{place}, channel {}", channel.name), channel.quantity));
            }
            let scale = entry.map_or(1.0, |e| e.scale);
            let samples = channel.samples.iter().map(|x| scale * x).collect();
            let made = Channel { name: channel.name, freedom, samples };
            if k == hammer { force = Some(made) } else { responses.push(made) }
        }
        let Some(mut force) = force else { return Err(Failure::input(format!("{place}: no force"), "")) };
        if let Some(at) = &args.at {
            force.freedom = at.clone();
        }
        let hit = Hit { name: place.into(), dt: measurement.dt, force, responses };
        hit.check().map_err(|e| Failure::said(place, &e))?;
        Ok(hit)
    }

    /// The hammer's channel: by the user's word, by the table, by what the file says it measures, by its name.
    fn hammer(&self, path: &Path, channels: &[MeasuredChannel], args: &ModalArgs) -> Option<usize> {
        let place = |is: &dyn Fn(&MeasuredChannel) -> bool| channels.iter().position(is);
        if let Some(name) = &args.hammer {
            return place(&|c| c.name == *name);
        }
        let by_table =
            |c: &MeasuredChannel| self.table.channel(path, &c.name).is_some_and(|e| e.role == Role::Force);
        let by_name = |c: &MeasuredChannel| {
            let name = c.name.to_lowercase();
            c.quantity == Quantity::Unknown && HAMMERS.iter().any(|h| name.starts_with(h))
        };
        place(&by_table).or_else(|| place(&|c| c.quantity == Quantity::Force)).or_else(|| place(&by_name))
    }

    /// Where a channel is: by the table, by the file, else a point of the channel's name.
    fn freedom(&self, path: &Path, place: &str, channel: &MeasuredChannel) -> Result<Freedom, Failure> {
        if let Some(entry) = self.table.channel(path, &channel.name) {
            let direction = Direction::from_name(&entry.direction).ok_or_else(|| {
                let message = format!(
                    "{place}, channel {}: direction = \"{}\" is not known",
                    channel.name, entry.direction
                );
                Failure::input(message, "choose one of +x, -x, +y, -y, +z, -z, +rx, -rx, +ry, -ry, +rz, -rz")
            })?;
            return Ok(Freedom { point: entry.point.clone(), direction });
        }
        Ok(match channel.at {
            Some(at) => nodal(at),
            None => Freedom::parse(&channel.name).unwrap_or_else(|| Freedom::point(&channel.name)),
        })
    }

    /// One motion for all sensors.
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

    /// Entries of the table that no file has: a point that is missing, or a name that is wrong.
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
                place.display(),
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
                    format!("--leave-out {name}: there is no such hit (there are: {})", all.join("; "));
                return Err(Failure::input(message, "choose one of those, or `faulty`"));
            }
        }
        if !self.hits.is_empty() && self.hits.iter().all(|h| h.left_out) {
            return Err(Failure::input("--leave-out leaves no hit", "leave fewer out"));
        }
        Ok(())
    }
}

/// Point and direction of a node.
pub(super) fn nodal(at: NodalDirection) -> Freedom {
    Freedom { point: at.node.to_string(), direction: Direction::from_code(at.direction).unwrap_or_default() }
}

fn sensed(motion: Motion) -> Sensed {
    match motion {
        Motion::Acceleration => Sensed::Acceleration,
        Motion::Velocity => Sensed::Velocity,
        Motion::Displacement => Sensed::Displacement,
    }
}
