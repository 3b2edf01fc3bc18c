//! A step that cannot be solved any better says so, under every stepper that solves problems and wherever
//! a user looks: observables, the tally of a run, its manifest, stderr. The window's words are in
//! `tests/window/alarms.rs`.

use crate::common::*;
use assert_cmd::Command;

/// Below the rounding of any step of a pile.
const OUT_OF_REACH: f64 = 1e-18;

fn pile(stepper: Stepper) -> Scene {
    let solver = SolverSettings {
        method: Method::Nncg,
        stop: StopTest::Residual,
        tolerance: OUT_OF_REACH,
        max_sweeps: 100_000,
        ..SolverSettings::default()
    };
    Scene { stepper, solver, ..built_in("pile").expect("the shipped state") }
}

#[test]
fn a_stalled_step_is_observed_as_such_under_every_stepper_with_a_method() {
    for &stepper in Stepper::ALL.iter().filter(|stepper| stepper.uses_method()) {
        let mut run = pile(stepper).simulation().expect("a sound scene");
        let mut tally = Tally::default();
        for _ in 0..5 {
            tally.add(run.step().expect("a finite state"));
        }
        assert_eq!(tally.unconverged_steps, 5, "{stepper}: nothing gets to {OUT_OF_REACH:e}");
        assert_eq!(tally.stalled_steps, 5, "{stepper}: more sweeps are of no use");
    }
}

#[test]
fn a_run_tells_of_stalled_steps_in_its_manifest_and_on_stderr() {
    let folder = tempfile::tempdir().expect("a folder");
    let frames = folder.path().to_str().expect("a path");
    let run = Command::new(assert_cmd::cargo::cargo_bin!("slump"))
        .args(["--headless", "--frames", frames, "--renderer", "cpu", "--size", "16x16"])
        .args(["--stepper", "range", "--solver", "nncg", "--stop", "residual"])
        .args(["--tolerance", "1e-18", "--max-sweeps", "100000"])
        .args(["--dt", "1e-3", "--duration", "5e-3", "--times", "5e-3"])
        .assert()
        .success();
    let said = String::from_utf8_lossy(&run.get_output().stderr).into_owned();
    assert!(said.contains("5 of 5 steps did not reach tolerance"), "{said}");
    assert!(said.contains("5 of them stalled"), "{said}");
    let manifest = std::fs::read(folder.path().join("manifest.json")).expect("a manifest");
    let manifest: serde_json::Value = serde_json::from_slice(&manifest).expect("JSON");
    assert_eq!(manifest["runs"][0]["tally"]["stalled_steps"], 5);
    let rows = std::fs::read_to_string(folder.path().join("observables.csv")).expect("rows");
    let header = rows.lines().next().expect("a header");
    let column = header.split(',').position(|name| name == "stalled").expect("a column");
    let stalled = rows.lines().skip(1).filter(|row| row.split(',').nth(column) == Some("true"));
    assert_eq!(stalled.count(), 5);
}
