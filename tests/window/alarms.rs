//! Tests of warnings in the window, and of the button that applies their advice.

use crate::robot::*;

fn scene(name: &str) -> Config {
    Config::of_scene(name)
}

#[test]
fn an_alarm_stands_in_the_status_bar_until_the_run_is_reset() {
    let mut robot = Robot::open(scene("thin-wall"));
    assert!(robot.world().alarms.is_empty() && !robot.state().controls.contains_key("alarm"));
    robot.take_steps(40);
    let lost = robot.world().alarms.iter().find(|alarm| alarm.kind == AlarmKind::GrainLost);
    assert!(lost.expect("an alarm").text.contains("try a time step below"));
    robot.harness.step();
    assert!(robot.state().controls.contains_key("alarm"), "the status bar shows it");
    robot.key(egui::Key::R);
    assert!(robot.world().alarms.is_empty());
}

#[test]
fn whoever_points_at_an_alarm_reads_it_whole_and_once() {
    let mut robot = Robot::open(scene("thin-wall"));
    robot.take_steps(40);
    // The window is so narrow that the line of the warning is cut.
    robot.harness.set_size(egui::vec2(800.0, 700.0));
    robot.frames(3);
    let count = |robot: &Robot| robot.harness.query_all_by_label_contains("▲").count();
    assert_eq!(count(&robot), 1);
    let at = robot.place("alarm", 0.3, 0.5);
    robot.harness.hover_at(at);
    robot.frames(90);
    assert_eq!(count(&robot), 2, "the line and its tooltip");
}

#[test]
fn a_state_that_begins_in_alarm_says_so_before_the_first_step() {
    let mut robot = Robot::open(scene("overlap"));
    robot.harness.step();
    let said = &robot.world().alarms;
    assert!(said.len() == 1 && said[0].text.contains("push-out"), "{said:?}");
    assert!(robot.state().controls.contains_key("alarm"), "the status bar shows it");
    robot.key(egui::Key::ArrowRight);
    assert_eq!(robot.world().alarms.len(), 1);
}

#[test]
fn an_alarm_advises_on_the_settings_that_it_was_raised_under() {
    let mut robot = Robot::open(scene("thin-wall"));
    let before = robot.settings();
    robot.take_steps(40);
    let mut settings = before;
    settings.parameters.time_step_secs *= 0.1;
    robot.change(0, settings);
    let alarm = robot.world().alarms[0].clone();
    let asked = format!("below {} ms", 1e3 * before.parameters.time_step_secs);
    assert!(alarm.is_earlier && alarm.text.contains(&asked), "{alarm:?}");
}

#[test]
fn a_break_that_is_not_seen_is_told_of_with_the_time_step_that_sees_it() {
    let mut config = scene("pile");
    config.stepper = Some(Stepper::Range);
    config.parameters.bond = Some(20.0);
    config.parameters.time_step_secs = Some(5e-3);
    config.parameters.debonding_distance = Some(1e-4);
    let mut robot = Robot::open(config);
    for _ in 0..12 {
        robot.key(egui::Key::ArrowRight);
    }
    let said = &robot.world().alarms;
    assert!(said.iter().any(|alarm| alarm.text.contains("at most 0.45 ms")), "{said:?}");
}

#[test]
fn the_robust_button_pushes_the_overlap_out() {
    let mut robot = Robot::open(scene("overlap"));
    robot.clicks(&["Law, solver", "Robust"]);
    assert!(robot.settings().remedies.push_out);
    robot.key(egui::Key::ArrowRight);
    let chosen = robot.harness.get_by_label("Robust").accesskit_node().toggled();
    assert_eq!(chosen, Some(egui::accesskit::Toggled::True), "a preset like the other three");
    let before = robot.observables().max_overlap;
    for _ in 0..10 {
        robot.key(egui::Key::ArrowRight);
    }
    assert!(robot.observables().max_overlap < 0.5 * before);
}

#[test]
fn the_law_range_takes_the_remedies_that_it_has_its_own_ways_for_away() {
    let mut robot = Robot::open(scene("pile"));
    robot.clicks(&["Law, solver", "Robust"]);
    assert!(robot.settings().remedies.sequential_impacts);
    robot.click("range");
    robot.settle();
    let settings = robot.settings();
    let left = settings.remedies;
    assert_eq!(settings, settings.with_only_what_is_taken());
    assert!(!left.push_out && left.max_travel > 0.0);
}

#[test]
fn every_scene_made_to_break_methods_opens_and_steps() {
    for info in SCENES.iter().filter(|info| info.group == SceneGroup::Stability) {
        let mut robot = Robot::open(scene(info.name));
        robot.key(egui::Key::ArrowRight);
        assert_eq!(robot.steps(), 1, "{}", info.name);
        assert_eq!(
            robot.state().run.frame.start.as_ref().map(|start| start.scene.name.as_str()),
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
        // This tolerance is below the rounding error of any step of a pile.
        tolerance: Some(1e-18),
        max_sweeps: Some(100_000),
        ..SolverChanges::default()
    };
    let mut robot = Robot::open(config);
    robot.click("Law, solver");
    robot.key(egui::Key::ArrowRight);
    assert!(robot.observables().stalled);
    robot.harness.step();
    assert!(robot.shows("stalled"));
}

#[test]
fn a_step_that_is_not_solved_is_told_of_on_both_pages() {
    let mut config = scene("pile");
    config.parameters.time_step_secs = Some(5e-3);
    config.solver = SolverChanges {
        friction_model: Some(FrictionModel::Coulomb),
        max_sweeps: Some(3),
        ..SolverChanges::default()
    };
    let mut robot = Robot::open(config);
    robot.click("Law, solver");
    for _ in 0..5 {
        robot.key(egui::Key::ArrowRight);
    }
    assert!(!robot.observables().converged, "three sweeps are too few");
    robot.harness.step();
    assert_eq!(robot.harness.query_all_by_label_contains("not converged").count(), 1);
    robot.state_mut().preferences.page = None;
    robot.click("Can I trust this? no");
    assert!(robot.shows("5 of 5 steps were not solved as asked"));
}
