//! ARCHITECTURE.md as data: which crates there are, what each needs, and which files stand in which room.

use std::collections::BTreeMap;

/// What the page says.
pub(crate) struct Plan {
    /// For each crate's folder (`crates/iwan-core`) the other crates that it needs.
    pub(crate) needs: BTreeMap<String, Vec<String>>,
    /// For each source folder of the page's headings (`crates/iwan-core/src`) its rooms.
    pub(crate) houses: BTreeMap<String, BTreeMap<String, Vec<String>>>,
}

impl Plan {
    /// Reads the page: `## iwan-core (`crates/iwan-core/src`)` begins a house, a row of its table is a room.
    pub(crate) fn parse(page: &str) -> Self {
        let mut plan = Self { needs: BTreeMap::new(), houses: BTreeMap::new() };
        let mut house = None;
        for line in page.lines() {
            if let Some(heading) = line.strip_prefix("## ") {
                house = quoted(heading).into_iter().next();
            }
            let cells: Vec<&str> = line.split('|').map(str::trim).collect();
            let ["", name, second, third, ""] = cells[..] else { continue };
            let Some(name) = quoted(name).into_iter().next() else { continue };
            match &house {
                None => {
                    plan.needs.insert(name, third.split(", ").map(str::to_owned).collect());
                }
                Some(house) => {
                    let rooms = plan.houses.entry(house.clone()).or_default();
                    let room = name.trim_end_matches('/').to_owned();
                    assert!(!rooms.contains_key(&room), "{house} has two rows for {room}");
                    rooms.insert(room, quoted(second));
                }
            }
        }
        plan
    }
}

/// What stands in back quotes.
fn quoted(text: &str) -> Vec<String> {
    text.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}
