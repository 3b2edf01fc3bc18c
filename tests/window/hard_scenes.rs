//! Tests of scenes that are made to break solvers: the window shows the known result of the scene as the right answer,
//! and for each simulation a verdict, which says if it agrees with this answer.

use crate::robot::*;
use slump::solver::SolverSettings;
use slump::study::stability::Challenge;

/// Checks the verdicts on two simulations of the scene `mass-ratio`: ten sweeps per step fail, and the default solver
/// succeeds.
#[test]
fn a_scene_that_is_made_to_break_methods_shows_its_right_answer_and_a_verdict() {
    let mut robot = Robot::open(Config::of_scene("mass-ratio"));
    assert!(robot.shows("Right answer: The light disc carries the heavy disc"));
    assert!(!robot.shows("largest displacement"), "no step was taken");
    let base = robot.settings();
    let mut few = base;
    few.solver = SolverSettings::to_residual(Method::Nsgs, 1e-6, 10);
    robot.send(Command::Compare(vec![few, base]));
    robot.send(Command::SetPace(Pace::Max));
    robot.send(Command::Play);
    robot.until("the end", |state| !state.run.frame.playing);
    robot.frames(2);
    assert!(robot.shows("✗ 1: largest displacement in diameters"));
    assert!(robot.shows("✓ 2: largest displacement in diameters"));
    // With another contact law the right answer is unknown.
    let mut other = base;
    other.parameters.restitution = 0.7;
    robot.send(Command::Compare(vec![other]));
    robot.take_steps(1);
    robot.frames(2);
    assert!(robot.shows("unknown, because a parameter of the law was changed"));
    robot.load(pile());
    assert!(!robot.shows("Right answer"));
}

#[test]
fn scenes_that_break_methods_are_for_experts() {
    let mut robot = Robot::open(pile());
    let gallery = |robot: &mut Robot, page: &str, list: &str| {
        robot.click(page);
        if page == "Law, solver" {
            robot.click("Expert");
        }
        robot.harness.get_by_role_and_label(egui::Role::ComboBox, list).scroll_to_me();
        robot.frames(10);
        robot.harness.get_by_role_and_label(egui::Role::ComboBox, list).click();
        robot.frames(5);
        let found = ["silo", "newtons-cradle"].map(|name| robot.shows(name));
        robot.key(egui::Key::Escape);
        robot.frames(5);
        found
    };
    assert_eq!(gallery(&mut robot, "Pile", "Scene"), [true, false]);
    assert_eq!(gallery(&mut robot, "Law, solver", "Scenes made to break methods"), [false, true]);
}

#[test]
fn every_scene_that_is_made_to_break_methods_has_a_right_answer() {
    for info in SCENES {
        let challenge = Challenge::seen_in(info.name);
        assert_eq!(challenge.is_some(), info.group == SceneGroup::Stability, "{}", info.name);
        assert!(challenge.is_none_or(|it| it.right_answer().is_some()), "{}", info.name);
    }
}
