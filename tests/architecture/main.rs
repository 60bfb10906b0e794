//! The plan of the house is true: every file stands in it, and imports run in the order that it promises.

mod house;
mod pages;
mod plan;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use house::{House, Import};
use plan::Plan;

/// Source files that a reader takes in at a glance; more, and the room has two ideas (or three).
const MOST_FILES_IN_A_ROOM: usize = 14;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn plan() -> Plan {
    Plan::parse(&std::fs::read_to_string(root().join("ARCHITECTURE.md")).expect("ARCHITECTURE.md"))
}

/// The source folders of all crates of the workspace.
fn crates() -> Vec<PathBuf> {
    let folders = std::fs::read_dir(root().join("crates")).expect("crates");
    let mut sources: Vec<PathBuf> = folders.map(|entry| entry.expect("entry").path().join("src")).collect();
    sources.sort();
    assert!(sources.len() > 8, "only {} crates found", sources.len());
    sources
}

fn relative(path: &Path) -> String {
    path.strip_prefix(root()).expect("inside").to_str().expect("ASCII").to_owned()
}

fn shown(import: &Import) -> String {
    format!(
        "{} names {}, which is defined in {}",
        import.from.join("::"),
        import.written,
        import.to.join("::")
    )
}

/// Source files by folder: `("law", "jenkins")`; the folder itself is `.`, and `mod.rs` stands for its room.
fn files(source: &Path, ending: &str) -> BTreeSet<(String, String)> {
    let mut found = BTreeSet::new();
    let mut folders = vec![source.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display())) {
            let path = entry.expect("entry").path();
            let stem = path.file_stem().and_then(|s| s.to_str()).expect("ASCII").to_owned();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == ending) {
                let room = folder.strip_prefix(source).expect("inside").to_str().expect("ASCII");
                found.insert((if room.is_empty() { "." } else { room }.to_owned(), stem));
            }
        }
    }
    found
}

/// The faces of rooms, which the plan does not name: the row of the room is theirs.
const FACES: [&str; 5] = ["lib", "main", "mod", "__init__", "__main__"];

/// Fails with everything that is wrong, not only with the first.
fn nothing_is_wrong(faults: &[String]) {
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn every_source_file_stands_in_the_plan_and_the_plan_names_no_other() {
    let plan = plan();
    let mut faults = Vec::new();
    let mut houses: Vec<(PathBuf, &str)> = crates().into_iter().map(|source| (source, "rs")).collect();
    houses.push((root().join("crates/iwan-py/python/iwan"), "py"));
    for (source, ending) in houses {
        let name = relative(&source);
        let Some(rooms) = plan.houses.get(&name) else {
            faults.push(format!("ARCHITECTURE.md has no section for {name}"));
            continue;
        };
        let planned: BTreeSet<(String, String)> = rooms
            .iter()
            .flat_map(|(room, files)| files.iter().map(move |file| (room.clone(), file.clone())))
            .collect();
        let mut there = files(&source, ending);
        there.retain(|(_, stem)| !FACES.contains(&stem.as_str()));
        let missing = there.difference(&planned);
        faults.extend(missing.map(|(room, file)| format!("{name}: {room}/{file} is not in ARCHITECTURE.md")));
        let gone = planned.difference(&there);
        faults.extend(
            gone.map(|(room, file)| {
                format!("{name}: ARCHITECTURE.md names {room}/{file}, which is not there")
            }),
        );
    }
    nothing_is_wrong(&faults);
}

#[test]
fn no_room_holds_more_files_than_a_glance_takes_in() {
    let mut faults = Vec::new();
    for source in crates() {
        let mut counts = BTreeMap::new();
        for (room, _) in files(&source, "rs") {
            *counts.entry(room).or_insert(0) += 1;
        }
        let name = relative(&source);
        let full = counts.iter().filter(|(_, count)| **count > MOST_FILES_IN_A_ROOM);
        faults.extend(full.map(|(room, count)| format!("{name}: {room} holds {count} files")));
    }
    nothing_is_wrong(&faults);
}

#[test]
fn files_import_only_from_above_themselves_in_the_order_of_the_mod_lines() {
    let mut faults = Vec::new();
    for source in crates() {
        let upward = House::read(&source).upward();
        faults.extend(upward.iter().map(|import| format!("{}: {}", relative(&source), shown(import))));
    }
    nothing_is_wrong(&faults);
}

#[test]
fn no_files_import_each_other_in_a_circle() {
    let mut faults = Vec::new();
    for source in crates() {
        if let Some(circle) = House::read(&source).circle() {
            let files: Vec<String> = circle.iter().map(|file| file.join("::")).collect();
            faults.push(format!("{}: {}", relative(&source), files.join(" -> ")));
        }
    }
    nothing_is_wrong(&faults);
}

#[test]
fn crates_need_only_what_the_plan_says() {
    let plan = plan();
    let mut faults = Vec::new();
    for source in crates() {
        let folder = source.parent().expect("crate");
        let name = relative(folder);
        let manifest = std::fs::read_to_string(folder.join("Cargo.toml")).expect("Cargo.toml");
        let manifest = toml::de::DeTable::parse(&manifest).expect("TOML");
        let dependencies = manifest.get_ref()["dependencies"].get_ref().as_table().expect("a table");
        let needed: BTreeSet<&str> =
            dependencies.keys().filter_map(|name| name.get_ref().strip_prefix("iwan-")).collect();
        let ours = |word: &&str| root().join("crates").join(format!("iwan-{word}")).exists();
        let said = plan.needs.get(&name).map(Vec::as_slice).unwrap_or_default();
        let said: BTreeSet<&str> = said.iter().map(String::as_str).filter(ours).collect();
        if needed != said {
            faults.push(format!("{name} needs {needed:?} and ARCHITECTURE.md says {said:?}"));
        }
    }
    nothing_is_wrong(&faults);
}

#[test]
fn every_import_of_a_known_crate_is_seen() {
    // What a reader counts by hand in three files: were the reader of imports blind, the tests above would pass.
    let house = House::read(&root().join("crates/iwan-core/src"));
    assert!(house.len() > 25, "{} files", house.len());
    let imports = house.imports();
    let seen = |from: &str, to: &str| {
        imports.iter().any(|i| i.from.join("::").ends_with(from) && i.to.join("::").ends_with(to))
    };
    assert!(seen("four_parameter", "backbone"));
    assert!(seen("newmark", "oscillator"));
    assert!(!seen("backbone", "four_parameter"));
}

#[test]
fn an_import_from_below_is_found() {
    let house = House::on_paper(&[
        ("", "mod ground; mod upper; pub use upper::Roof;"),
        ("ground", "use crate::upper::Roof; pub struct Stone;"),
        ("upper", "use crate::ground::Stone; pub struct Roof;"),
    ]);
    let upward = house.upward();
    assert_eq!(
        upward.iter().map(shown).collect::<Vec<_>>(),
        ["ground names crate::upper::Roof, which is defined in upper"]
    );
    assert!(house.circle().is_some());
}

#[test]
fn names_are_followed_to_where_they_are_defined() {
    let inside = "fn roof() { let r = crate::Roof; assert!(matches!(r, crate::room::attic::Roof)); }";
    let house = House::on_paper(&[
        ("", "mod ground; mod room; pub use room::Roof;"),
        ("ground", inside),
        ("room", "mod attic; pub(crate) use attic::Roof;"),
        ("room::attic", "pub struct Roof;"),
    ]);
    let upward: Vec<String> = house.upward().iter().map(shown).collect();
    let found = ["crate::Roof", "crate::room::attic::Roof"]
        .map(|written| format!("ground names {written}, which is defined in room::attic"));
    assert_eq!(upward, found);
}

#[test]
fn a_child_and_its_parent_that_import_each_other_are_a_circle() {
    let house = House::on_paper(&[
        ("", "mod room;"),
        ("room", "mod child; use child::walk; pub struct Floor;"),
        ("room::child", "use super::Floor; pub fn walk() {}"),
    ]);
    assert!(house.upward().is_empty());
    assert_eq!(house.circle().map(|circle| circle.len()), Some(2));
}

#[test]
fn what_only_tests_import_does_not_count() {
    let tests = "pub struct Stone; #[cfg(test)] mod tests { use super::*; use crate::upper::Roof; }";
    let house = House::on_paper(&[
        ("", "mod ground; mod upper;"),
        ("ground", tests),
        ("upper", "use super::ground::{self, Stone}; pub struct Roof;"),
    ]);
    assert!(house.upward().is_empty() && house.circle().is_none());
    assert_eq!(house.imports().len(), 2);
}
