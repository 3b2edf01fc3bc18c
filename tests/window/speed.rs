//! The chart of speed against accuracy, and the run on it.

use egui_kittest::kittest::Queryable;
use slump::solver::{Fallback, StopTest};

use crate::robot::{Robot, pile};

/// Whether the panel says where the run is.
fn tells(robot: &Robot, residual: f64) -> bool {
    let text = format!(" ms a step, residual {residual:.1e}");
    robot.harness.query_by_label_contains(&text).is_some()
}

#[test]
fn the_run_has_its_place_on_the_chart() {
    let mut robot = Robot::open(pile());
    robot.click("Speed and accuracy");
    let waiting = "The run shows here from its first step on.";
    assert!(robot.harness.query_by_label(waiting).is_some());
    for _ in 0..3 {
        robot.key(egui::Key::ArrowRight);
    }
    assert!(robot.harness.query_by_label(waiting).is_none());
    let residual = |robot: &Robot| robot.world().snapshot.observables.residual;
    let loose = residual(&robot);
    assert!(tells(&robot, loose));

    let mut settings = robot.world().controls.settings;
    (settings.solver.stop, settings.solver.tolerance) = (StopTest::Residual, 1e-7);
    settings.solver.max_sweeps = 20_000;
    // By Coulomb's law bounds of friction may err by any amount.
    settings.solver.fallback = Fallback::None;
    robot.state_mut().change(0, settings);
    robot.settle();
    robot.key(egui::Key::ArrowRight);
    assert!(residual(&robot) < 0.1 * loose, "{} after {loose}", residual(&robot));
    assert!(tells(&robot, residual(&robot)));
}
