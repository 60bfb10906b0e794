//! `iwan reproduce`: its numbers against stored ones (`reproduce.values.json`, with where each comes from), its figures, its files.
#![allow(clippy::unwrap_used)]

use std::path::Path;

use crate::common::{folder, iwan, names, shown};
use assert_cmd::Command;
use serde_json::Value;

const FILES: [&str; 4] = ["curves.csv", "figures.json", "report.html", "reproduce.json"];

/// The stored values.
fn stored() -> Vec<Value> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reproduce.values.json");
    let all: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let values = all["values"].as_array().unwrap().clone();
    // Each says where it comes from, and the page says what that means.
    assert!(
        values.len() > 90 && values.iter().all(|v| all["about"][v["source"].as_str().unwrap()].is_string())
    );
    values
}

fn found<'a>(all: &'a Value, entry: &Value) -> (String, &'a Value) {
    if let Some(path) = entry["path"].as_str() {
        return (path.to_string(), all.pointer(path).unwrap_or(&Value::Null));
    }
    let (finding, number) = (entry["finding"].as_str().unwrap(), entry["number"].as_str().unwrap());
    let named = |list: &'a Value, key: &str, name: &str| {
        list.as_array().unwrap().iter().find(|item| item[key] == name).unwrap_or(&Value::Null)
    };
    let entry = named(&all["findings"], "id", finding);
    assert!(entry.is_object(), "there is no finding {finding}");
    (format!("{finding}: {number}"), &named(&entry["numbers"], "name", number)["value"])
}

/// What is wrong with a value, if anything.
fn complaint(all: &Value, entry: &Value) -> Option<String> {
    let (name, value) = found(all, entry);
    let Some(value) = value.as_f64() else { return Some(format!("{name} is missing")) };
    let (low, high) = match (entry["value"].as_f64(), entry["relative"].as_f64(), entry["absolute"].as_f64())
    {
        (Some(v), Some(part), None) => (v - part * v.abs(), v + part * v.abs()),
        (Some(v), None, Some(half)) => (v - half, v + half),
        _ => (entry["at_least"].as_f64().unwrap(), entry["at_most"].as_f64().unwrap()),
    };
    let source = entry["source"].as_str().unwrap();
    (!(low..=high).contains(&value)).then(|| format!("{name} = {value}, allowed {low} to {high} ({source})"))
}

/// Every figure has curves, every curve points, every axis a unit.
fn check_figures(figures: &Value, summary: &Value) {
    let figures = figures.as_array().unwrap();
    let entries = summary["figures"].as_array().unwrap();
    assert_eq!(figures.len(), entries.len());
    for (figure, entry) in figures.iter().zip(entries) {
        let id = figure["id"].as_str().unwrap();
        assert_eq!(figure["id"], entry["id"]);
        assert!(
            !figure["title"].as_str().unwrap().is_empty() && !figure["caption"].as_str().unwrap().is_empty()
        );
        for axis in ["x", "y"] {
            assert!(!figure[axis]["unit"].as_str().unwrap().is_empty(), "{id}: the {axis} axis has no unit");
        }
        let layers = figure["layers"].as_array().unwrap();
        assert!(!layers.is_empty(), "{id} has no curves");
        for layer in layers {
            let points = layer["points"].as_array().unwrap();
            // The slopes of Table 4 are three numbers, from hit to hit two.
            assert!(points.len() >= 2, "{id}: {} has {} points", layer["name"], points.len());
            let finite = |p: &Value| p[0].as_f64().is_some() && p[1].as_f64().is_some();
            assert!(points.iter().all(finite), "{id}: {} has points that are no numbers", layer["name"]);
        }
    }
    let mut wanted: Vec<String> = vec!["figure-2-loops".into(), "figure-4-frequency".into()];
    for configuration in ["a", "b"] {
        for mode in [1, 2, 3] {
            wanted.push(format!("figure-7-{configuration}-mode-{mode}-frequency"));
            wanted.push(format!("figure-7-{configuration}-mode-{mode}-dissipation"));
            wanted.push(format!("figure-9-11-{configuration}-mode-{mode}-frequency"));
            wanted.push(format!("figure-9-11-{configuration}-mode-{mode}-dissipation"));
        }
        for mode in [1, 3] {
            wanted.push(format!("figure-8a-{configuration}-mode-{mode}-response"));
            wanted.push(format!("figure-8b-{configuration}-mode-{mode}-difference"));
        }
    }
    wanted.extend(["figure-14-sensors", "figure-15-average", "figure-16-dissipation"].map(String::from));
    wanted.extend(["figure-17-without-viscous", "table-4-slopes"].map(String::from));
    for id in wanted {
        assert!(figures.iter().any(|figure| figure["id"] == id.as_str()), "figure {id} is missing");
    }
}

/// Words of the findings that have no number.
fn check_words(summary: &Value) {
    let text = |id: &str| -> &str {
        let findings = summary["findings"].as_array().unwrap();
        findings.iter().find(|f| f["id"] == id).unwrap()["text"].as_str().unwrap()
    };
    assert!(text("eq-14").contains("no root"), "{}", text("eq-14"));
    assert!(text("mode-2").contains("linear"), "{}", text("mode-2"));
    for configuration in [0, 1] {
        assert_eq!(summary["truth"][configuration]["modes"][1]["linear"], true);
    }
    let rows = summary["table_2"].as_array().unwrap();
    assert_eq!(rows.len(), 6);
    for row in rows.iter().filter(|row| row["mode"] == "bending 2") {
        assert!(row["identified"].is_null() && row["verdict"].as_str().unwrap().contains("it is linear"));
    }
    for row in rows.iter().filter(|row| row["mode"] == "bending 1") {
        let beta = row["intervals"].as_array().unwrap().iter().find(|i| i["parameter"] == "beta").unwrap();
        assert_eq!(beta["identifiable"], false, "{row}");
    }
}

/// Where no thread can be had: a stack of 100 TB is found nowhere. The responses of the laboratory's modal test panicked there, because they
/// asked for the threads of a pool that nobody had started. The Python package computes the same numbers on two threads (`test_study.py`).
#[test]
fn the_papers_tables_and_figures() {
    let place = folder("");
    let output = Command::new(assert_cmd::cargo::cargo_bin!("iwan"))
        .args("reproduce --json --quiet --out paper".split_whitespace())
        .env("RUST_MIN_STACK", "100000000000000")
        .current_dir(place.path())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", shown(&output));
    let results = place.path().join("paper");
    assert_eq!(names(&results), FILES);
    let read = |name: &str| std::fs::read_to_string(results.join(name)).unwrap();
    let summary: Value = serde_json::from_str(&read("reproduce.json")).unwrap();
    let printed: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(printed["truth"], summary["truth"]);
    assert!(printed["seconds"].as_f64().unwrap() > 0.0 && summary["seconds"].is_null());

    let complaints: Vec<String> = stored().iter().filter_map(|entry| complaint(&summary, entry)).collect();
    assert!(complaints.is_empty(), "{complaints:#?}");
    check_figures(&serde_json::from_str(&read("figures.json")).unwrap(), &summary);
    check_words(&summary);

    let report = read("report.html");
    let figures = summary["figures"].as_array().unwrap();
    assert_eq!(report.matches("<svg ").count(), figures.len());
    assert!(!report.contains("NaN") && !report.contains("inf "));
    for figure in figures {
        // As HTML writes it.
        let title = figure["title"].as_str().unwrap().replace('&', "&amp;").replace('<', "&lt;");
        assert!(report.contains(&title), "{title} is not in the report");
    }
    // Nothing is fetched from elsewhere.
    assert!(!report.contains("<script") && !report.contains("src=") && !report.contains("@import"));
    assert!(
        read("curves.csv").starts_with("configuration,mode,level,t,displacement,frequency,damping_ratio,")
    );

    // What is there already stays, and is said so before anything is computed.
    let again = iwan(place.path(), "reproduce --quiet --out paper");
    assert_eq!(again.status.code(), Some(2), "{}", shown(&again));
    assert!(String::from_utf8_lossy(&again.stderr).contains("--force"));
}
