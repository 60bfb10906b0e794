//! The pages name real places.

/// Every path in back quotes or link targets of a top-level page exists.
#[test]
fn paths_in_the_pages_exist() {
    let mut seen = 0;
    for page in ["README.md", "ARCHITECTURE.md", "DESIGN.md", "CONTRIBUTING.md"] {
        let text = std::fs::read_to_string(crate::root().join(page)).expect(page);
        let quoted = text.split('`').skip(1).step_by(2);
        let linked = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
        let is_path = |s: &&str| {
            let prefixes =
                ["crates/", "src/", "tests/", "benches", "scripts/", "book/", "examples/", "LICENSE"];
            std::path::Path::new(s).extension().is_some_and(|e| e == "md")
                || prefixes.iter().any(|p| s.starts_with(p))
        };
        for path in quoted.chain(linked).filter(is_path).filter(|s| !s.contains(char::is_whitespace)) {
            assert!(crate::root().join(path).exists(), "{page} names {path}, which does not exist");
            seen += 1;
        }
    }
    assert!(seen > 20, "only {seen} paths found: the pages or this test have changed");
}
