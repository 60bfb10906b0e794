//! The table of a modal test: which channel of which file measures what, at which point and in which direction; positions of the points,
//! and lines between them.

use std::path::Path;

use crate::error::InputError;
use crate::section::Section;
use crate::text::InputText;

/// Role of a channel in the test.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// The hammer's force.
    Force,
    /// The response of a sensor.
    Response,
    /// Not used.
    None,
}

/// One entry `[[channel]]`.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelEntry {
    /// Name of the channel as the file writes it.
    pub name: String,
    /// Name of the file; none: the entry holds for all files.
    pub file: Option<String>,
    /// Name or number of the point.
    pub point: String,
    /// Direction such as `+z`.
    pub direction: String,
    /// Role of the channel.
    pub role: Role,
    /// Factor by which the samples are multiplied, such as a calibration or a change of unit.
    pub scale: f64,
}

/// One entry `[[point]]`.
#[derive(Debug, Clone, PartialEq)]
pub struct PointEntry {
    /// Name or number of the point.
    pub name: String,
    /// Coordinates x, y, z.
    pub position: [f64; 3],
}

/// The table of channels and points.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ModalTable {
    /// Channels.
    pub channels: Vec<ChannelEntry>,
    /// Points with positions.
    pub points: Vec<PointEntry>,
    /// Lines of a drawing, each from point to point by their names.
    pub lines: Vec<Vec<String>>,
}

/// The remedy in messages where a file is no table of points at all.
const REMEDY: &str = "give a table in TOML with [[channel]] (name, point, direction, role) and [[point]] (name, position), or a universal file with points \
     (dataset 15 or 2411)";

impl ModalTable {
    /// Reads a file that holds a table.
    ///
    /// # Errors
    /// [`InputError`] for a file that cannot be read or is no text; else as [`parse`](Self::parse).
    pub fn read(path: &Path) -> Result<Self, InputError> {
        let source = InputText::read(path, "table of points", "paper-modal");
        Self::parse(&source.map_err(|e| InputError::new(e.message, REMEDY))?)
    }

    /// Reads a table from its text.
    ///
    /// ```
    /// use iwan_input::{InputText, ModalTable, Role};
    /// let text = "[[channel]]\nname = \"h\"\npoint = \"1\"\ndirection = \"-z\"\nrole = \"force\"\n[[point]]\nname = \"1\"\nposition = [0, 0.5, 0]";
    /// let table = ModalTable::parse(&InputText::built_in("points.toml", text))?;
    /// assert_eq!((table.channels[0].role, table.points[0].position), (Role::Force, [0.0, 0.5, 0.0]));
    /// # Ok::<(), iwan_input::InputError>(())
    /// ```
    ///
    /// # Errors
    /// [`InputError`] with file, line, key and remedy.
    pub fn parse(source: &InputText) -> Result<Self, InputError> {
        let no_table = |e: InputError| {
            InputError::new(
                format!("{} (as a table of points)", e.message),
                format!("correct this place, or {REMEDY}"),
            )
        };
        let document = source.document("paper-modal").map_err(no_table)?;
        let top = Section::new(source, "the file", document.top(), &["channel", "point", "line"])?;
        let mut table = Self::default();
        for (n, place) in top.tables("channel")?.into_iter().enumerate() {
            let known = ["name", "file", "point", "direction", "role", "scale"];
            let section = Section::new(source, format!("channel {}", n + 1), place, &known)?;
            let roles = [("force", Role::Force), ("response", Role::Response), ("none", Role::None)];
            let scale = section.number_or("scale", 1.0)?;
            if !(scale.is_finite() && scale != 0.0) {
                let message = format!("scale = {scale} is out of range: must be finite and not 0");
                return Err(section.failure(
                    "scale",
                    &message,
                    "give the factor from the file's samples to the unit wanted",
                ));
            }
            let name = section.name("name")?;
            table.channels.push(ChannelEntry {
                point: section.optional_name("point")?.unwrap_or_else(|| name.clone()),
                name,
                file: section.optional_text("file")?,
                direction: section.optional_text("direction")?.unwrap_or_default(),
                role: section.choice("role", &roles)?.unwrap_or(Role::Response),
                scale,
            });
        }
        for (n, place) in top.tables("point")?.into_iter().enumerate() {
            let section = Section::new(source, format!("point {}", n + 1), place, &["name", "position"])?;
            let numbers = section.numbers("position")?;
            let Ok(position) = <[f64; 3]>::try_from(numbers.as_slice()) else {
                let message = format!("position has {} numbers, not 3", numbers.len());
                return Err(section.failure("position", &message, "give x, y and z"));
            };
            table.points.push(PointEntry { name: section.name("name")?, position });
        }
        for (n, place) in top.tables("line")?.into_iter().enumerate() {
            let section = Section::new(source, format!("line {}", n + 1), place, &["points"])?;
            let points = section.texts("points")?;
            if let Some(unknown) = points.iter().find(|p| table.points.iter().all(|own| own.name != **p)) {
                let message = format!("there is no point \"{unknown}\"");
                return Err(section.failure("points", &message, "give it a [[point]] with its position"));
            }
            table.lines.push(points);
        }
        Ok(table)
    }

    /// The entry for a channel of a file; an entry that names the file takes precedence over one for all files.
    #[must_use]
    pub fn channel(&self, file: &Path, name: &str) -> Option<&ChannelEntry> {
        let own = |c: &&ChannelEntry| {
            c.name == name
                && c.file.as_ref().is_some_and(|f| file.ends_with(f) || file.as_os_str() == f.as_str())
        };
        let all = |c: &&ChannelEntry| c.name == name && c.file.is_none();
        self.channels.iter().find(own).or_else(|| self.channels.iter().find(all))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mistakes_are_named_with_their_line() {
        let refused =
            |text: &str| ModalTable::parse(&InputText::built_in("p.toml", text)).unwrap_err().to_string();
        let unknown = refused("[[channel]]\nname = \"a\"\npont = \"1\"");
        assert!(
            unknown.contains("pont") && unknown.contains("p.toml:3:1") && unknown.contains("`point`"),
            "{unknown}"
        );
        assert!(refused("[[point]]\nname = \"a\"\nposition = [1, 2]").contains("2 numbers"));
        assert!(refused("[[channel]]\nname = \"a\"\nscale = 0").contains("scale = 0"));
        assert!(refused("[[line]]\npoints = [\"a\", \"b\"]").contains("no point \"a\""));
    }

    #[test]
    fn what_is_no_table_at_all_is_not_told_of_scenarios() {
        let text = "0.0 1.0 2.0\n0.1 1.1 2.1\n";
        let refused = ModalTable::parse(&InputText::built_in("p.csv", text)).unwrap_err();
        assert!(
            refused.message.contains("p.csv:1:") && refused.message.contains("table of points"),
            "{refused}"
        );
        assert!(
            refused.remedy.contains("[[point]]") && refused.remedy.contains("universal file"),
            "{refused}"
        );
        let missing = ModalTable::read(Path::new("no-such-table.toml")).unwrap_err();
        assert!(missing.message.contains("no-such-table.toml: cannot be read"), "{missing}");
        assert!(!refused.remedy.contains("scenario") && !missing.remedy.contains("scenario"), "{missing}");
    }

    #[test]
    fn an_entry_for_one_file_goes_before_one_for_all() {
        let text = "[[channel]]\nname = \"a\"\npoint = \"1\"\n[[channel]]\nname = \"a\"\nfile = \"two.csv\"\npoint = \"2\"";
        let table = ModalTable::parse(&InputText::built_in("p.toml", text)).unwrap();
        let point = |file: &str| table.channel(Path::new(file), "a").map(|c| c.point.clone());
        assert_eq!((point("x/one.csv").as_deref(), point("x/two.csv").as_deref()), (Some("1"), Some("2")));
    }
}
