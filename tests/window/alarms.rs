//! What the window says of a run that goes wrong, and the button that mends what can be mended.

use egui_kittest::kittest::Queryable;
use slump::scene::{Config, SCENES, SceneGroup};
use slump::sim::Stepper;
use slump::solver::{Method, SolverChanges, StopTest};

use crate::robot::Robot;

fn scene(name: &str) -> Config {
    Config::of_scene(name)
}

#[test]
fn an_alarm_stands_in_the_status_bar_until_the_run_is_reset() {
    let mut robot = Robot::open(scene("overlap"));
    assert!(robot.world().alarms.is_empty() && !robot.state().controls.contains_key("alarm"));
    robot.click("Step");
    assert_eq!(robot.world().alarms.len(), 1);
    assert!(robot.world().alarms[0].contains("try a time step below"));
    robot.harness.step();
    assert!(robot.state().controls.contains_key("alarm"), "the status bar shows it");
    robot.key(egui::Key::R);
    assert!(robot.world().alarms.is_empty());
}

#[test]
fn the_robust_button_pushes_the_overlap_out() {
    let mut robot = Robot::open(scene("overlap"));
    robot.click("Solver");
    robot.click("Robust");
    assert!(robot.world().controls.settings.remedies.push_out);
    assert_eq!(robot.world().controls.settings.parameters.restitution_threshold, 2.0);
    robot.click("Step");
    let before = robot.world().snapshot.observables.max_overlap;
    for _ in 0..10 {
        robot.click("Step");
    }
    assert!(robot.world().snapshot.observables.max_overlap < 0.5 * before);
}

#[test]
fn the_law_range_takes_the_remedies_that_it_has_its_own_ways_for_away() {
    let mut robot = Robot::open(scene("pile"));
    robot.click("Solver");
    robot.click("Robust");
    assert!(robot.world().controls.settings.remedies.sequential_impacts);
    robot.click("range");
    robot.settle();
    let settings = robot.world().controls.settings;
    let left = settings.remedies;
    assert_eq!(settings, settings.with_only_what_is_taken());
    assert!(!left.push_out && left.max_travel > 0.0);
}

#[test]
fn every_scene_made_to_break_methods_opens_and_steps() {
    for info in SCENES.iter().filter(|info| info.group == SceneGroup::Stability) {
        let mut robot = Robot::open(scene(info.name));
        robot.click("Step");
        assert_eq!(robot.steps(), 1, "{}", info.name);
        assert_eq!(
            robot.state().frame.start.as_ref().map(|start| start.name.as_str()),
            Some(info.name)
        );
    }
}

#[test]
fn a_stalled_step_of_the_stepper_range_is_told_of() {
    let mut config = scene("pile");
    config.stepper = Some(Stepper::Range);
    config.solver = SolverChanges {
        method: Some(Method::Nncg),
        stop: Some(StopTest::Residual),
        // Below the rounding of any step of a pile.
        tolerance: Some(1e-18),
        max_sweeps: Some(100_000),
        ..SolverChanges::default()
    };
    let mut robot = Robot::open(config);
    robot.click("Solver");
    robot.click("Step");
    assert!(robot.world().snapshot.observables.stalled);
    robot.harness.step();
    assert!(robot.harness.query_by_label_contains("stalled").is_some());
}
