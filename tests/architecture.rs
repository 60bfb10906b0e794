//! The plan of the house names real rooms.

use std::path::Path;

/// Every path in back quotes or link targets of a top-level page exists.
#[test]
fn paths_in_the_pages_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut seen = 0;
    for page in ["README.md", "ARCHITECTURE.md", "DESIGN.md", "CONTRIBUTING.md"] {
        let text = std::fs::read_to_string(root.join(page)).expect(page);
        let quoted = text.split('`').skip(1).step_by(2);
        let linked = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
        let is_path = |s: &&str| {
            let prefixes =
                ["crates/", "src/", "tests/", "benches", "scripts/", "book/", "examples/", "LICENSE"];
            Path::new(s).extension().is_some_and(|e| e == "md") || prefixes.iter().any(|p| s.starts_with(p))
        };
        for path in quoted.chain(linked).filter(is_path).filter(|s| !s.contains(char::is_whitespace)) {
            assert!(root.join(path).exists(), "{page} names {path}, which does not exist");
            seen += 1;
        }
    }
    assert!(seen > 20, "only {seen} paths found: the pages or this test have changed");
}

/// Every source file of the core stands in the plan.
#[test]
fn every_room_of_the_core_is_in_the_plan() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let plan = std::fs::read_to_string(root.join("ARCHITECTURE.md")).expect("ARCHITECTURE.md");
    let small = ["lib.rs", "error.rs", "quadrature.rs", "power.rs", "response.rs", "no_joint.rs"];
    for entry in std::fs::read_dir(root.join("crates/iwan-core/src")).expect("iwan-core") {
        let name = entry.expect("entry").file_name().into_string().expect("ASCII");
        assert!(
            small.contains(&name.as_str()) || plan.contains(&name),
            "{name} is missing in ARCHITECTURE.md"
        );
    }
}
