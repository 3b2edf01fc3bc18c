//! Tests of pictures of the panels before the first step. These pictures do not depend on the solver.

#[path = "../../pictures/golden/compare.rs"]
mod compare;

use crate::robot::*;

use compare::{FilterType, Tolerance, complaint, save_small};

const TOLERANCE: Tolerance = Tolerance { channel: 2, pixels: 0.01 };

/// Draws the window and compares the picture with the stored picture of this name.
fn check(robot: &mut Robot, name: &str) {
    robot.harness.remove_cursor();
    robot.frames(30);
    let mut actual = robot.harness.render().unwrap();
    // A window is opaque, even if some of its pixels are stored as transparent.
    actual.pixels_mut().for_each(|pixel| pixel.0[3] = 255);
    if std::env::var_os("SLUMP_BLESS").is_some() {
        save_small(&actual, name, FilterType::Adaptive);
    }
    assert_eq!(complaint(&actual, name, "window", TOLERANCE), None);
}

#[test]
#[ignore = "needs a graphics driver"]
fn the_first_thing_that_a_newcomer_sees() {
    check(&mut Robot::open_with_gpu(Config::default(), Preferences::default()), "window-first");
}

#[test]
#[ignore = "needs a graphics driver"]
fn worlds_side_by_side_in_the_dark() {
    let mut preferences =
        Preferences { theme: egui::ThemePreference::Dark, ..Preferences::default() };
    preferences.style.colour_by = slump::render::ColourBy::Coordination;
    let mut robot = Robot::open_with_gpu(Config::default(), preferences);
    robot.clicks(&["Compare", "Paper Fig. 4"]);
    check(&mut robot, "window-compare");
}

#[test]
#[ignore = "needs a graphics driver"]
fn the_panels_of_a_physicist() {
    let preferences = Preferences { plots: false, ..Preferences::default() };
    let mut robot = Robot::open_with_gpu(Config::default(), preferences);
    robot.clicks(&["Law, solver", "Expert", "Pile"]);
    robot.state_mut().run.pinned = Some(GrainRef { world: 0, grain: 70 });
    check(&mut robot, "window-panels");
}
