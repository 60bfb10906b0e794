//! All cards that matter, sorted by kind.

use std::collections::BTreeMap;

use super::super::error::MeshError;
use super::super::file::FileBytes;
use super::card::Card;
use super::known;

/// The cards, collected until all are read.
#[derive(Default)]
pub(super) struct Reader<'a> {
    pub(super) systems: BTreeMap<i64, Card<'a>>,
    pub(super) grids: Vec<Card<'a>>,
    /// Defaults of GRID (card GRDSET).
    pub(super) defaults: Option<Card<'a>>,
    pub(super) elements: Vec<Card<'a>>,
    pub(super) properties: BTreeMap<u64, Card<'a>>,
    pub(super) materials: BTreeMap<u64, Card<'a>>,
    pub(super) connections: Vec<Card<'a>>,
    /// Factor of PARAM, WTMASS.
    pub(super) mass_factor: Option<f64>,
    /// For each name the line of its first card, and the number of cards.
    pub(super) passed_over: BTreeMap<String, (usize, usize)>,
    pub(super) ignored: BTreeMap<String, (usize, usize)>,
}

impl<'a> Reader<'a> {
    /// Adds a card to the list of its kind; refuses a card that may change the model and is not known.
    pub(super) fn card(
        &mut self,
        source: FileBytes,
        card: Card<'a>,
        ignored: &[String],
    ) -> Result<(), MeshError> {
        let line = card.line;
        let count = |list: &mut BTreeMap<String, (usize, usize)>, name: &str| {
            list.entry(name.into()).or_insert((line, 0)).1 += 1;
        };
        if ignored.contains(&card.name) {
            count(&mut self.ignored, &card.name);
            return Ok(());
        }
        match card.name.as_str() {
            "GRID" => self.grids.push(card),
            "GRDSET" => self.defaults = Some(card),
            "CORD2R" | "CORD2C" | "CORD2S" => {
                let number = card.label(source, 0)?.cast_signed();
                once(source, &mut self.systems, number, card)?;
            }
            "CHEXA" | "CPENTA" | "CTETRA" => self.elements.push(card),
            "PSOLID" => {
                let number = card.label(source, 0)?;
                once(source, &mut self.properties, number, card)?;
            }
            "MAT1" => {
                let number = card.label(source, 0)?;
                once(source, &mut self.materials, number, card)?;
            }
            "RBE2" | "RBE3" | "MPC" | "MPCADD" | "SPC" | "SPC1" | "SPCADD" | "CONM2" => {
                self.connections.push(card);
            }
            "PARAM" if card.field(0).eq_ignore_ascii_case("WTMASS") => {
                self.mass_factor = Some(card.real(source, 1, None)?);
            }
            "PARAM" => count(&mut self.passed_over, "PARAM"),
            name if known::is_harmless(name) => count(&mut self.passed_over, name),
            name => {
                let found = format!("{name}, which may change the model,");
                return Err(card.unsupported(source, found, known::remedy(name)));
            }
        }
        Ok(())
    }
}

fn once<'a, K: Ord + std::fmt::Display + Copy>(
    source: FileBytes,
    list: &mut BTreeMap<K, Card<'a>>,
    number: K,
    card: Card<'a>,
) -> Result<(), MeshError> {
    let (line, name) = (card.line, card.name.clone());
    if list.insert(number, card).is_none() {
        return Ok(());
    }
    let place = format!("{}, {name}", source.at_line(line));
    Err(source.malformed(place, format!("number {number} twice"), "a number of its own"))
}
