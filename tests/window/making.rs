//! New piles, seen while they are made.

use egui_kittest::kittest::Queryable;
use slump::config::Config;
use slump::scene::NewPile;

use crate::recordings::take_steps;
use crate::robot::{Robot, bits, pile};

/// So many grains that they fall for a while.
fn rain() -> Config {
    let mut config = pile();
    config.source.grains = Some(400);
    config.source.box_width = Some(NewPile::default().box_width_in_diameters);
    config
}

#[test]
fn grains_are_seen_as_they_rain_and_the_world_before_comes_back() {
    let mut robot = Robot::open(pile());
    take_steps(&mut robot, 5);
    let (before, steps) = (bits(robot.world()), robot.steps());
    robot.state_mut().load(rain());
    let preview = |state: &slump::app::AppState| {
        state.frame.loading.as_ref().and_then(|loading| loading.preview.clone())
    };
    robot.until("the rain", |state| preview(state).is_some());
    let first = preview(robot.state()).expect("the rain");
    assert_eq!(first.snapshot.grains.len(), 400);
    robot.until("grains that have fallen", |state| {
        preview(state).is_some_and(|now| now.snapshot.observables.time_secs > 0.05)
    });
    let told = robot.state().frame.loading.as_ref().expect("progress").text.clone();
    assert!(told.starts_with("Raining a new pile of 400"), "{told}");
    assert!(robot.state().controls.contains_key("pile in the making"), "it is drawn");
    let shown = robot.harness.query_all_by_label_contains("Raining a new pile of 400").count();
    assert!(shown >= 1, "and told");

    // Nothing can be played, and nothing that is asked for waits.
    for key in [egui::Key::Space, egui::Key::ArrowRight, egui::Key::R] {
        robot.harness.key_press(key);
        robot.harness.step();
    }
    assert!(robot.state().frame.loading.is_some(), "the situation: it still rains");
    assert_eq!((bits(robot.world()), robot.steps()), (before.clone(), steps), "the world waits");

    robot.click("Cancel");
    assert!(robot.state().frame.loading.is_none() && !robot.state().frame.playing);
    assert_eq!((bits(robot.world()), robot.steps()), (before, steps), "it is there again");
    take_steps(&mut robot, 1);
    assert_eq!(robot.steps(), steps + 1, "and goes on");
    assert_eq!(robot.state().frame.worlds[0].curve.rows().count(), 7, "with its record");
}
