//! The panel of published experiments.

use egui_kittest::kittest::Queryable;

use crate::robot::{Robot, pile};

#[test]
fn a_report_is_read_into_the_panel_and_what_is_none_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let report = folder.path().join("quantities.json");
    let quantity = |experiment: &str, verdict: &str| {
        serde_json::json!({
            "experiment": experiment, "way": "nsgs, 20 sweeps", "quantity": "angle", "system": "9 discs",
            "published": { "value": 20.0, "low": 18.0, "high": null, "provenance": "read", "source": "A. Nobody" },
            "measured": { "mean": 21.0, "low": 20.5, "high": 21.5 }, "samples": 3, "verdict": verdict, "error": 0.05,
        })
    };
    let all =
        [quantity("silo", "agrees"), quantity("silo", "differs"), quantity("gas", "not-decided")];
    std::fs::write(&report, serde_json::to_string(&all).expect("JSON")).expect("a file");

    let mut robot = Robot::open(pile());
    for section in ["Physics", "Run", "Validation"] {
        robot.click(section);
    }
    // The first start has a report.
    assert!(robot.harness.query_by_label_contains("shipped, by slump validate").is_some());
    assert!(robot.harness.query_by_label_contains("packing: ").is_some());
    // A folder is as good as the file in it.
    let type_path = |robot: &mut Robot, path: &std::path::Path| {
        robot.type_number("Report", path.to_str().expect("UTF-8"));
    };
    type_path(&mut robot, folder.path());
    assert!(robot.harness.query_by_label("gas: 0 agree, 0 differ, 1 open").is_some());
    robot.click("silo: 1 agree, 1 differ, 0 open");
    for words in ["● agrees", "● differs"] {
        assert!(robot.harness.query_by_label(words).is_some(), "{words}");
    }
    assert!(robot.harness.query_all_by_label("21.0 ± 0.500").count() == 2);
    assert!(robot.harness.query_all_by_label("≥ 18.0").count() == 2);

    std::fs::write(&report, "[{}]").expect("a file");
    type_path(&mut robot, &report);
    let said = robot.state().notice().expect("a complaint").0.text.clone();
    assert!(said.contains("missing field `experiment`"), "{said}");
    assert!(said.contains("quantities.json that slump validate wrote"), "{said}");
    assert!(robot.harness.query_by_label("silo: 1 agree, 1 differ, 0 open").is_some());

    robot.click("Open silo");
    robot.settle();
    assert_eq!(robot.state().frame.start.as_ref().expect("a start").name, "silo");
}
