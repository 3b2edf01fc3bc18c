//! What the window says of a run that goes wrong, and the button that mends what can be mended.

use slump::scene::{Config, SCENES, SceneGroup};

use crate::robot::Robot;

fn scene(name: &str) -> Config {
    Config { scene: Some(name.to_owned()), ..Config::default() }
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
    assert!(robot.world().settings.solver.remedies.push_out);
    assert_eq!(robot.world().settings.parameters.restitution_threshold, 2.0);
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
    assert!(robot.world().settings.solver.remedies.sequential_impacts);
    robot.click("range");
    robot.settle();
    let settings = robot.world().settings;
    let left = settings.solver.remedies;
    assert_eq!(left, left.under(settings.parameters.law), "{settings:?}");
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
