//! Help, lists, completions and manual pages.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use crate::common;
use crate::common::{folder, iwan, shown};

#[test]
fn help_texts() {
    let place = folder("");
    for arguments in [
        "--help",
        "simulate --help",
        "frf --help",
        "backbone --help",
        "envelope --help",
        "fit --help",
        "modal --help",
        "modes --help",
        "quasi-static --help",
        "update --help",
        "reproduce --help",
        "scenario --help",
        "completions --help",
        "man --help",
    ] {
        let output = iwan(place.path(), arguments);
        let name = format!("of_{}", arguments.replace("--help", "iwan").replace(' ', "_"));
        insta::assert_snapshot!(name, shown(&output));
    }
}

#[test]
fn usage_errors_exit_with_2() {
    let place = folder("");
    for arguments in [
        "",
        "frobnicate",
        "simulate --step 0",
        "simulate --step nan",
        "simulate --sliders 0",
        "simulate --threads 0",
        "simulate --amplitude inf",
        "simulate --format xlsx",
        "simulate a.toml b.toml",
        "envelope",
        "fit",
        "fit a.csv --hold x=1",
        "envelope a.csv --method fourier",
        "modal",
        "modal a.uff --poles -3",
        "modes --count 0",
        "modes no-such-file.toml",
        "quasi-static --points 3",
        "quasi-static --from -1",
        "reproduce --out",
        "reproduce somewhere",
        "scenario nonsense",
        "scenario --list paper-modal",
        "man nonsense",
    ] {
        let output = iwan(place.path(), arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments}");
        assert!(output.stdout.is_empty() && !output.stderr.is_empty(), "{arguments}");
        assert_eq!(common::names(place.path()), ["in.toml"]);
    }
}

#[test]
fn scenarios_are_listed_and_printed() {
    let place = folder("");
    for arguments in ["scenario", "scenario --list"] {
        insta::assert_snapshot!("scenario_list", shown(&iwan(place.path(), arguments)));
    }
    let text = iwan(place.path(), "scenario paper-modal").stdout;
    assert_eq!(text, include_bytes!("../../iwan-input/scenarios/paper-modal.toml"));
    let schema = iwan(place.path(), "scenario --schema").stdout;
    assert_eq!(schema, include_bytes!("../../iwan-input/schema/scenario.schema.json"));
}

#[test]
fn completions_and_manual_pages_name_every_command() {
    let place = folder("");
    for arguments in
        ["completions bash", "completions zsh", "completions fish", "completions powershell", "man"]
    {
        let output = iwan(place.path(), arguments);
        assert!(output.status.success());
        // Manual pages escape hyphens.
        let text = String::from_utf8(output.stdout).unwrap().replace("\\-", "-");
        for command in
            ["simulate", "envelope", "fit", "modes", "quasi-static", "scenario", "completions", "man"]
        {
            assert!(text.contains(command), "{arguments}: {command}");
        }
    }
    let page = String::from_utf8(iwan(place.path(), "man simulate").stdout).unwrap();
    assert!(page.starts_with(".ie") || page.contains(".TH"), "{page}");
    assert!(page.contains("half\\-cycle"));
}
