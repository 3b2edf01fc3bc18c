//! How well the last step was solved.

use egui_kittest::kittest::Queryable;
use slump::solver::{Fallback, StopTest};

use crate::robot::{Robot, pile};

/// True where the panel says the residual of the last step.
fn tells(robot: &Robot, residual: f64) -> bool {
    robot.harness.query_by_label_contains(&format!("{residual:.1e}")).is_some()
}

#[test]
fn the_panel_tells_the_residual_of_the_last_step() {
    let mut robot = Robot::open(pile());
    robot.click("Solver");
    for _ in 0..3 {
        robot.key(egui::Key::ArrowRight);
    }
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
