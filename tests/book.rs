//! The book names files and tests that exist, and every chapter stands in its summary and in the documentation.
#![allow(clippy::unwrap_used, reason = "a failed test may panic")]

use std::fs;
use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Path and text of all chapters.
fn chapters() -> Vec<(PathBuf, String)> {
    let files = fs::read_dir(root().join("book/src")).unwrap().map(|entry| entry.unwrap().path());
    let pages = files.filter(|path| path.extension().is_some_and(|e| e == "md"));
    pages.map(|path| (path.clone(), fs::read_to_string(path).unwrap())).collect()
}

/// What stands between backticks outside of code blocks.
fn code_spans(text: &str) -> Vec<&str> {
    let prose = text.split("```").step_by(2);
    prose.flat_map(|part| part.split('`').skip(1).step_by(2)).collect()
}

#[test]
fn every_path_named_in_the_book_exists() {
    let mut found = 0;
    for (chapter, text) in chapters() {
        let folders = ["crates/", "examples/", "tests/", "benches/", "book/", "src/", "scripts/"];
        let spans = code_spans(&text).into_iter().filter(|s| folders.iter().any(|f| s.starts_with(f)));
        for span in spans {
            let (path, test) = span.split_once("::").map_or((span, None), |(path, test)| (path, Some(test)));
            let file = root().join(path);
            assert!(file.exists(), "{}: {span}", chapter.display());
            if let Some(test) = test {
                let source = fs::read_to_string(file).unwrap();
                assert!(source.contains(&format!("fn {test}(")), "{}: {span}", chapter.display());
            }
            found += 1;
        }
        for include in text.split("{{#include ").skip(1) {
            let path = include.split("}}").next().unwrap();
            assert!(root().join("book/src").join(path).exists(), "{}: {path}", chapter.display());
            found += 1;
        }
        for link in text.split("](").skip(1) {
            let target = link.split(')').next().unwrap();
            assert!(target.contains("://") || root().join("book/src").join(target).exists(), "{target}");
        }
    }
    assert!(found > 20, "only {found} paths: does the search still work?");
}

#[test]
fn every_chapter_is_in_the_summary_and_in_the_documentation() {
    let summary = fs::read_to_string(root().join("book/src/SUMMARY.md")).unwrap();
    let library = fs::read_to_string(root().join("src/lib.rs")).unwrap();
    for (path, _) in chapters() {
        let name = path.file_stem().unwrap().to_str().unwrap();
        if name != "SUMMARY" {
            assert!(summary.contains(&format!("({name}.md)")), "{name} is missing in the summary");
            assert!(library.contains(&format!("pub mod {name} ")), "{name} is missing in the documentation");
        }
    }
}

#[test]
fn every_example_is_in_the_book_and_short() {
    let book = fs::read_to_string(root().join("book/src/examples.md")).unwrap();
    for entry in fs::read_dir(root().join("examples")).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            continue;
        }
        let name = path.file_name().unwrap().to_str().unwrap();
        assert!(book.contains(&format!("{{{{#include ../../examples/{name}}}}}")), "{name}");
        assert!(fs::read_to_string(&path).unwrap().lines().count() <= 60, "{name} is longer than 60 lines");
    }
}
