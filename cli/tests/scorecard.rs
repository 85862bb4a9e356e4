//! `asperity scorecard`: figures beside their anchors, failures first, the same in every run.

use crate::support;

use serde_json::Value;
use std::fs;
use support::{asperity, told};

#[test]
fn two_quick_scorecards_are_one_but_for_speed_and_failures_come_first() {
    let folder = tempfile::tempdir().unwrap();
    let card = |name: &str| -> Value {
        let (status, out, err) =
            told(&asperity(folder.path(), &["scorecard", "--quick", "--json", "-o", name]));
        assert_eq!((status, err.as_str()), (0, ""));
        let written = fs::read_to_string(folder.path().join(name).join("scorecard.json")).unwrap();
        assert_eq!(out, written);
        let mut card: Value = serde_json::from_str(&out).unwrap();
        for row in card["rows"].as_array_mut().unwrap() {
            assert!(
                row["ours"].is_number() && row["command"].as_str().unwrap().starts_with("asperity "),
                "{row}"
            );
            assert!(row["bound"].as_array().unwrap().len() == 2 && row["source"].is_string(), "{row}");
            if row["name"].as_str().unwrap().starts_with("speed") {
                row["ours"] = Value::Null;
            }
        }
        card
    };
    let (one, two) = (card("one"), card("two"));
    assert_eq!(one, two);
    let rows = one["rows"].as_array().unwrap();
    let passes: Vec<bool> = rows.iter().map(|row| row["pass"].as_bool().unwrap()).collect();
    assert!(passes.windows(2).all(|pair| pair[0] <= pair[1]), "{passes:?}");
    let names: Vec<&str> = rows.iter().map(|row| row["name"].as_str().unwrap()).collect();
    for begin in [
        "modal bank",
        "fit of made",
        "six plates by sound, second",
        "seven materials",
        "growth",
        "port ",
        "speed",
        "shuffled labels",
        "a plate against itself",
    ] {
        assert!(names.iter().any(|name| name.starts_with(begin)), "{begin}: {names:?}");
    }
    let matrix = &one["confusion"]["six plates by touch, first observer"];
    assert_eq!((matrix["labels"].as_array().unwrap().len(), &matrix["paper"]), (6, &Value::Null));
    assert_eq!(one["observers"][0]["sha256"].as_str().unwrap().len(), 64);
    let page = fs::read_to_string(folder.path().join("one/index.html")).unwrap();
    assert!(page.contains("six plates by both") && !page.contains("http") && !page.contains("<script"));
}
