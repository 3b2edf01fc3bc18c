//! Worlds side by side.

use slump::live::Command;
use slump::sim::Stepper;

use crate::robot::{Robot, pile};

#[test]
fn compared_worlds_share_their_simulated_time() {
    let mut robot = Robot::open(pile());
    robot.click("Compare");
    robot.click("Paper Fig. 4");
    assert_eq!(robot.state().frame.worlds.len(), 6);
    let numbers: Vec<(f64, f64)> = robot
        .state()
        .frame
        .worlds
        .iter()
        .map(|world| {
            (
                world.controls.settings.parameters.bond,
                world.controls.settings.parameters.time_step_secs,
            )
        })
        .collect();
    let expected =
        [(20.0, 1e-4), (20.0, 1e-3), (20.0, 2e-3), (100.0, 1e-4), (100.0, 1e-3), (100.0, 2e-3)];
    assert_eq!(numbers, expected);
    for tick in 1..=10 {
        robot.key(egui::Key::ArrowRight);
        for world in &robot.state().frame.worlds {
            let last = &world.snapshot.observables;
            let apart = last.time_secs - f64::from(tick) * 2e-3;
            assert!(apart.abs() < 1e-9, "{} s after tick {tick}", last.time_secs);
        }
    }
    robot.state_mut().live.send(Command::Seek(0.01));
    robot.settle();
    let times = robot.state().frame.worlds.iter().map(|world| world.snapshot.observables.time_secs);
    assert!(times.into_iter().all(|time| (time - 0.01).abs() < 1e-9));
}

#[test]
fn two_laws_stand_side_by_side() {
    let mut robot = Robot::open(pile());
    robot.click("Compare");
    robot.click("Two laws");
    let worlds = &robot.state().frame.worlds;
    let told: Vec<(Stepper, f64, f64)> = worlds
        .iter()
        .map(|world| world.controls.settings)
        .map(|settings| (settings.stepper, settings.parameters))
        .map(|(stepper, numbers)| (stepper, numbers.bond, numbers.time_step_secs))
        .collect();
    let of_law = |law| [1e-4, 1e-3, 5e-3].map(|time| (law, 20.0, time));
    assert_eq!(told, [of_law(Stepper::Moreau), of_law(Stepper::Range)].concat());
}

#[test]
fn a_world_computes_what_it_computes_alone() {
    let mut robot = Robot::open(pile());
    for _ in 0..20 {
        robot.state_mut().step();
    }
    robot.settle();
    let alone = robot.world().snapshot.grains.clone();
    let same = robot.world().controls.settings;
    let mut other = same;
    other.parameters.bond = 0.0;
    robot.state_mut().live.send(Command::Compare(vec![other, same]));
    robot.settle();
    for _ in 0..20 {
        robot.state_mut().step();
    }
    robot.settle();
    let worlds = &robot.state().frame.worlds;
    assert_eq!(worlds[1].snapshot.grains, alone);
    assert_ne!(worlds[0].snapshot.grains, alone);
}
