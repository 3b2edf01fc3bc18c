//! Drives that cannot be, and ways to step that know of none, are refused in one sentence.

use super::driven::pressed;
use crate::common::*;

#[test]
fn ways_to_step_that_know_of_no_driven_wall_are_refused() {
    let mut taken = 0;
    for (stepper, method) in every_way() {
        let mut scene = pressed(1.0);
        (scene.stepper, scene.solver.method) = (stepper, method);
        let made = scene.simulation().map(|_| ());
        if stepper.info().takes_drives && (!stepper.uses_method() || method.info().takes_drives) {
            made.expect("it is taken");
            taken += 1;
            continue;
        }
        let said = made.expect_err("it is not taken").to_string();
        assert!(said.ends_with(" where a motion has a drive"), "{said}");
        let mut run = start(&pressed(1.0));
        let settings = scene.settings();
        let live = run.change(settings).expect_err("nor while it runs").to_string();
        assert_eq!(live, said);
    }
    assert!(taken >= 5);
    let refused = Stepper::ALL.iter().filter(|stepper| !stepper.info().takes_drives);
    assert!(refused.eq(&[Stepper::Avbd]));
    let mut scene = pressed(1.0);
    scene.solver.fallback = Fallback::Tresca;
    let said = scene.simulation().map(|_| ()).expect_err("refused").to_string();
    assert_eq!(
        said,
        "fallback is tresca, but must be none or of-method where a motion has a drive"
    );
}

#[test]
fn drives_that_cannot_be_are_refused_in_one_sentence() {
    let refused = |change: &dyn Fn(&mut Motion)| {
        let mut scene = pressed(1.0);
        change(&mut scene.motions[0]);
        scene.simulation().map(|_| ()).expect_err("no such drive").to_string()
    };
    let with = |change: &dyn Fn(&mut Drive)| {
        refused(&|motion| change(motion.drive.as_mut().expect("a drive")))
    };
    for mass in [0.0, -1.0, f64::NAN] {
        let said = with(&|drive| drive.mass = mass);
        assert_eq!(
            said,
            format!("motions[0].drive.mass is {mass}, but must be a finite number of kg > 0")
        );
    }
    let said = with(&|drive| drive.pressure = Some(f64::NAN));
    assert_eq!(said, "motions[0].drive.pressure is NaN, but must be a finite number of N/m");
    let said = with(&|drive| drive.force = Some(1.0));
    assert_eq!(
        said,
        "motions[0].drive.force is given with a pressure, but must be given, or else a pressure, and not both"
    );
    let said = with(&|drive| drive.pressure = None);
    assert!(said.starts_with("motions[0].drive.force is left out, but"), "{said}");
    let said = with(&|drive| drive.damping = -1.0);
    assert!(said.starts_with("motions[0].drive.damping is -1, but"), "{said}");
    let said = with(&|drive| drive.direction = DVec2::ZERO);
    assert!(said.starts_with("motions[0].drive.direction is [0, 0], but"), "{said}");
    let said = with(&|drive| (drive.pressure, drive.width) = (Some(1.0), Some(0.0)));
    assert!(said.starts_with("motions[0].drive.width is 0, but"), "{said}");
    let said = refused(&|motion| motion.course = Some(straight(DVec2::new(1.0, 1.0))));
    assert!(said.starts_with("motions[0].course is along [1, 1], but must be across"), "{said}");
    let turn = MotionCourse::Rotation { pivot: DVec2::ZERO, rate: 1.0, travel: None };
    let said = refused(&|motion| motion.course = Some(turn.clone()));
    assert!(said.starts_with("motions[0].course is of another kind, but must be"), "{said}");
    let mut open = pressed(1.0);
    open.periodic = None;
    let said = open.simulation().map(|_| ()).expect_err("no width").to_string();
    assert!(said.starts_with("motions[0].drive.width is left out, but must be given"), "{said}");
}
