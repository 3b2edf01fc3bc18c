//! What can be looked at and asked besides the pile itself, and that controls stay where they are.

use egui_kittest::kittest::Queryable;
use slump::config::Config;

use crate::robot::{Robot, pile};

#[test]
fn any_quantity_is_plotted_against_any_other() {
    let mut robot = Robot::open(pile());
    robot.click("Step");
    robot.click("y over x");
    assert!(robot.state().preferences.chosen_plot.on);
    robot.harness.step();
    let title = "kinetic energy (J) against slump";
    assert!(robot.harness.query_by_label(title).is_some());
    robot.click("log y");
    assert_eq!(robot.state().preferences.chosen_plot.logarithmic, [false, true]);
}

#[test]
fn histograms_count_the_moment_that_is_shown() {
    let mut robot = Robot::open(pile());
    robot.click("Step");
    robot.click("Distributions");
    robot.click("contacts");
    // Each of the grains has its place.
    let counted = "contacts of a grain: 138 in all";
    let start = std::time::Instant::now();
    while robot.harness.query_by_label_contains(counted).is_none() {
        assert!(start.elapsed().as_secs() < 60, "waited in vain for {counted}");
        robot.harness.step();
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
}

#[test]
fn slump_and_what_to_try_are_told_of_piles_alone() {
    let tried = "and see whether the pile holds";
    let mut robot = Robot::open(Config::of_scene("moving-walls"));
    robot.harness.step();
    assert!(robot.harness.query_by_label("slump").is_none());
    assert!(robot.harness.query_by_label("overlap").is_some());
    robot.state_mut().load(Config::of_scene("chain"));
    robot.settle();
    robot.harness.step();
    assert!(robot.world().controls.settings.parameters.bond > 0.0, "it sticks");
    assert!(robot.harness.query_by_label_contains(tried).is_none(), "no pile");
    robot.state_mut().load(pile());
    robot.settle();
    robot.harness.step();
    assert!(robot.harness.query_by_label("slump").is_some());
    assert!(robot.harness.query_by_label_contains(tried).is_some());
}

#[test]
fn a_refusal_moves_no_control() {
    let mut robot = Robot::open(pile());
    let place = |robot: &Robot| robot.state().controls["μ"];
    let before = place(&robot);
    robot.type_number("Bond", "-1");
    robot.harness.step();
    let said = robot.harness.query_by_label_contains("bond is -1");
    assert!(said.is_some(), "the refusal is told");
    assert_eq!(place(&robot), before);
}

#[test]
fn the_end_of_the_help_is_within_reach_on_a_low_window() {
    let mut robot = Robot::open(pile());
    robot.harness.set_size(egui::vec2(720.0, 480.0));
    robot.key(egui::Key::H);
    let end = "Double-click a slider";
    robot.harness.get_by_label_contains(end).scroll_to_me();
    for _ in 0..10 {
        robot.harness.step();
    }
    let end = robot.harness.get_by_label_contains(end).rect();
    assert!(end.bottom() < 480.0 && end.top() > 0.0, "{end:?}");
}

#[test]
fn long_names_do_not_widen_the_panel() {
    let mut robot = Robot::open(pile());
    robot.click("Compare");
    // The scene begins where the panel ends.
    let before = robot.state().controls["scene"].left();
    for line_up in ["Two laws", "Steppers"] {
        robot.click(line_up);
        for _ in 0..10 {
            robot.harness.step();
        }
        // The selected world is the first.
        let now = robot.state().controls["scene"].left();
        assert!(now <= before + 1.0, "{line_up}: the panel ends at {now}, not at {before}");
    }
}

#[test]
fn a_step_is_measured_by_all_methods() {
    let mut robot = Robot::open(pile());
    for _ in 0..5 {
        robot.state_mut().step();
    }
    robot.settle();
    robot.click("Speed and accuracy");
    robot.click("Measure this step");
    let start = std::time::Instant::now();
    while robot.harness.query_by_label_contains("measured here").is_none() {
        assert!(start.elapsed().as_secs() < 120, "waited in vain for the methods");
        robot.harness.step();
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    assert!(robot.harness.query_by_label("newton").is_some());
    assert_eq!(robot.steps(), 5, "the run has taken no step");
}
