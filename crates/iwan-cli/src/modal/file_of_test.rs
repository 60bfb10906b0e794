//! From a file to hits: which channel is the hammer, which are sensors, and at which points they are.

use iwan_machine::listed;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::Path;

use iwan_input::{ChannelEntry, ModalTable, Role};
use iwan_io::{MeasuredChannel, Measurement, NodalDirection, Quantity, ReadOptions, UffFunction};
use iwan_modal::measure::{Channel, Direction, Fault, Freedom, Hit, cut, faults};

use super::args::ModalArgs;
use super::geometry::is_universal;
use crate::failure::Failure;
use crate::shown;

/// A hit with its faults.
pub(super) struct JudgedHit {
    pub(super) hit: Hit,
    /// Name of the file that holds the hit.
    pub(super) file: String,
    pub(super) faults: Vec<Fault>,
    /// Whether the force has a pulse, or `--whole-force` takes the force as measured.
    pub(super) has_pulse: bool,
    pub(super) left_out: bool,
}

impl JudgedHit {
    /// The faults as text.
    pub(super) fn in_words(&self) -> Vec<String> {
        self.faults.iter().map(ToString::to_string).collect()
    }
}

/// Words in the name of a channel that mark the hammer where no file says which channel it is.
const HAMMERS: [&str; 4] = ["force", "hammer", "impact", "load"];

/// Bytes at the beginning of a file within which the first line of a universal file must stand.
const HEAD: u64 = 4096;

/// The contents of one file.
#[derive(Default)]
pub(super) struct FileOfTest {
    pub(super) hits: Vec<JudgedHit>,
    pub(super) decays: Vec<(String, f64, Vec<Channel>)>,
    pub(super) functions: Vec<UffFunction>,
    /// Names of the channels with the quantity that each measures.
    pub(super) quantities: Vec<(String, Quantity)>,
    /// The bytes of a universal file, from which points may be read; none for other files.
    pub(super) universal: Option<Vec<u8>>,
    pub(super) warnings: Vec<String>,
}

impl FileOfTest {
    /// Reads a file, finds its hits and checks them for faults.
    pub(super) fn read(path: &Path, table: &ModalTable, args: &ModalArgs) -> Result<Self, Failure> {
        let name = shown::path(path);
        let options = ReadOptions { time: args.time.clone(), rate: args.rate, ..ReadOptions::default() };
        let read = iwan_io::read_modal_test(path, &options).map_err(|e| Failure::read(&name, &e))?;
        let mut file = Self {
            warnings: read.warnings.iter().map(|w| format!("{name}: {w}")).collect(),
            universal: begins_universal(path).then(|| iwan_machine::read_file(path).ok()).flatten(),
            ..Self::default()
        };
        let several = read.measurements.len() > 1;
        for (n, measurement) in read.measurements.into_iter().enumerate() {
            let place = if several { format!("{name}, record {}", n + 1) } else { name.clone() };
            let record = Record { path, place: &place, table };
            file.warnings.extend(record.doubts(&measurement.channels, args));
            if args.free {
                let decay = record.decay(measurement, args, &mut file.quantities)?;
                file.decays.push(decay);
                continue;
            }
            for hit in cut(record.hit(measurement, args, &mut file.quantities)?) {
                // With `--whole-force` a hit without a pulse in the force is no fault.
                let is_missing = |f: &Fault| matches!(f, Fault::NoPulse { .. });
                let counts = |f: &&Fault| !(args.whole_force && is_missing(f));
                let found = faults(&hit);
                let has_pulse = args.whole_force || !found.iter().any(is_missing);
                let faults = found.into_iter().filter(|fault| counts(&fault)).collect();
                file.hits.push(JudgedHit { hit, file: name.clone(), faults, has_pulse, left_out: false });
            }
        }
        file.quantities.extend(read.responses.iter().map(|f| (format!("{name}, {}", f.name), f.quantity)));
        file.functions = read.responses;
        Ok(file)
    }
}

/// Whether a file begins as universal files do.
fn begins_universal(path: &Path) -> bool {
    let mut head = Vec::new();
    let read = File::open(path).and_then(|file| file.take(HEAD).read_to_end(&mut head));
    read.is_ok() && is_universal(&head)
}

/// Where channels that were sampled together come from.
struct Record<'a> {
    path: &'a Path,
    /// Name of the record in messages.
    place: &'a str,
    table: &'a ModalTable,
}

impl Record<'_> {
    /// The channels of one free decay.
    fn decay(
        &self,
        measurement: Measurement,
        args: &ModalArgs,
        quantities: &mut Vec<(String, Quantity)>,
    ) -> Result<(String, f64, Vec<Channel>), Failure> {
        let place = self.place;
        let skipped = (args.from.unwrap_or(0.0) / measurement.dt).round() as usize;
        let samples = measurement.channels.first().map_or(0, |c| c.samples.len());
        if skipped > 0 && skipped >= samples {
            let message = format!(
                "{place}: --from {} s lies behind the record, which lasts {:.6} s",
                args.from.unwrap_or(0.0),
                samples as f64 * measurement.dt
            );
            return Err(Failure::input(message, "give the time at which the decay begins"));
        }
        let mut channels = Vec::new();
        for mut channel in measurement.channels {
            let entry = self.entry(&channel.name);
            if channel.quantity == Quantity::Force || entry.is_some_and(|e| e.role != Role::Response) {
                continue;
            }
            let freedom = self.freedom(&channel)?;
            quantities.push((format!("{place}, channel {}", channel.name), channel.quantity));
            channel.samples.drain(..skipped.min(channel.samples.len()));
            channels.push(made(channel, freedom, entry));
        }
        if channels.is_empty() {
            return Err(Failure::input(
                format!("{place}: no channel measures a motion"),
                "check the file and the table of --points",
            ));
        }
        Ok((place.into(), measurement.dt, channels))
    }

    /// One hit: the hammer's channel and those of the sensors.
    fn hit(
        &self,
        measurement: Measurement,
        args: &ModalArgs,
        quantities: &mut Vec<(String, Quantity)>,
    ) -> Result<Hit, Failure> {
        let place = self.place;
        let names: Vec<String> = measurement.channels.iter().map(|c| c.name.clone()).collect();
        let hammer = self.hammer(&measurement.channels, args).ok_or_else(|| {
            if let Some(name) = &args.hammer {
                let message =
                    format!("{place}: --hammer {name}: no channel is called that (there are: {})", listed(names));
                return Failure::input(message, "choose one of them");
            }
            let message = format!("{place}: no channel measures a force (there are: {})", listed(names));
            Failure::input(message, "name the channel of the hammer with --hammer NAME, or give it role = \"force\" in the table of --points")
        })?;
        let (mut force, mut responses) = (None, Vec::new());
        for (k, channel) in measurement.channels.into_iter().enumerate() {
            let entry = self.entry(&channel.name);
            if k != hammer
                && (channel.quantity == Quantity::Force || entry.is_some_and(|e| e.role != Role::Response))
            {
                continue;
            }
            let freedom = self.freedom(&channel)?;
            if k != hammer {
                quantities.push((format!("{place}, channel {}", channel.name), channel.quantity));
            }
            let made = made(channel, freedom, entry);
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

    /// Doubts about channels: a unit that is not known, a force beside the hammer, or a name that speaks of a force although the channel is taken as
    /// a motion.
    fn doubts(&self, channels: &[MeasuredChannel], args: &ModalArgs) -> Vec<String> {
        let hammer = if args.free { None } else { self.hammer(channels, args) };
        let mut units: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
        let mut said = Vec::new();
        if let Some(hammer) = hammer {
            let others =
                channels.iter().enumerate().filter(|(k, c)| *k != hammer && c.quantity == Quantity::Force);
            said.extend(others.filter(|(_, c)| self.entry(&c.name).is_none()).map(|(_, c)| {
                format!(
                    "{}, channel {}: it measures a force too and is left out, the hammer is {}; --hammer chooses another",
                    self.place, c.name, channels[hammer].name
                )
            }));
        }
        for (k, c) in channels.iter().enumerate().filter(|(_, c)| c.quantity == Quantity::Unknown) {
            let entry = self.entry(&c.name);
            if entry.is_some_and(|e| e.role == Role::None) {
                continue;
            }
            if !c.unit.is_empty() && !c.unit.eq_ignore_ascii_case("none") {
                units.entry(&c.unit).or_default().push(&c.name);
            }
            if Some(k) != hammer && entry.is_none() && names_a_force(&c.name) {
                said.push(format!(
                    "{}, channel {}: its name speaks of a force, it is taken as a motion; role = \"none\" in the table of --points leaves it out",
                    self.place, c.name
                ));
            }
        }
        said.extend(units.iter().map(|(unit, names)| {
            format!(
                "{}, channel {}: the unit \"{unit}\" is not known, samples are taken as they stand; scale in the table of --points changes them",
                self.place,
                listed(names)
            )
        }));
        said
    }

    fn entry(&self, channel: &str) -> Option<&ChannelEntry> {
        self.table.channel(self.path, channel)
    }

    /// Index of the hammer's channel: by `--hammer`, else by the table of points, else by the quantity in the file, else by the channel's name.
    fn hammer(&self, channels: &[MeasuredChannel], args: &ModalArgs) -> Option<usize> {
        let place = |is: &dyn Fn(&MeasuredChannel) -> bool| channels.iter().position(is);
        if let Some(name) = &args.hammer {
            return place(&|c| c.name == *name);
        }
        let by_table = |c: &MeasuredChannel| self.entry(&c.name).is_some_and(|e| e.role == Role::Force);
        let by_name = |c: &MeasuredChannel| c.quantity == Quantity::Unknown && names_a_force(&c.name);
        place(&by_table).or_else(|| place(&|c| c.quantity == Quantity::Force)).or_else(|| place(&by_name))
    }

    /// Point and direction of a channel: by the table, else by the file, else a point with the channel's name.
    fn freedom(&self, channel: &MeasuredChannel) -> Result<Freedom, Failure> {
        if let Some(entry) = self.entry(&channel.name) {
            let direction = Direction::from_name(&entry.direction).ok_or_else(|| {
                let message = format!(
                    "{}, channel {}: direction = \"{}\" is not known",
                    self.place, channel.name, entry.direction
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
}

fn names_a_force(channel: &str) -> bool {
    let name = channel.to_lowercase();
    HAMMERS.iter().any(|h| name.starts_with(h))
}

/// The channel with the table's scale applied.
fn made(channel: MeasuredChannel, freedom: Freedom, entry: Option<&ChannelEntry>) -> Channel {
    let scale = entry.map_or(1.0, |e| e.scale);
    let mut samples = channel.samples;
    if scale != 1.0 {
        for x in &mut samples {
            *x *= scale;
        }
    }
    Channel { name: channel.name, freedom, samples }
}

/// Point and direction of a node of a universal file.
pub(super) fn nodal(at: NodalDirection) -> Freedom {
    Freedom { point: at.node.to_string(), direction: Direction::from_code(at.direction).unwrap_or_default() }
}
