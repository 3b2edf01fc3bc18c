//! The mouse in the scene.

use egui_kittest::kittest::Queryable;
use slump::app::GrainRef;
use slump::config::Config;

use crate::robot::{Robot, pile};

/// The one grain of a scene, which lies in the middle of its view.
fn one_grain() -> (tempfile::TempDir, Config) {
    let folder = tempfile::tempdir().unwrap();
    let mut scene = pile().scene(|_| true).unwrap();
    scene.name = "one".into();
    scene.grains = vec![slump::world::Grain::at_rest(glam::DVec2::new(0.0, 0.02), 2e-3)];
    scene.fixed_discs.clear();
    scene.gravity = slump::world::Gravity::Uniform { acceleration: glam::DVec2::ZERO };
    scene.view = Some(slump::scene::View {
        min: glam::DVec2::new(-0.01, 0.01),
        max: glam::DVec2::new(0.01, 0.03),
    });
    let path = folder.path().join("one.toml");
    std::fs::write(&path, slump::config::scene_to_toml(&scene).unwrap()).unwrap();
    let config = Config::of_scene(path.to_str().expect("a path"));
    (folder, config)
}

#[test]
fn a_click_pins_a_grain_and_another_lets_it_go() {
    let (_folder, config) = one_grain();
    let mut robot = Robot::open(config);
    let at = robot.place("scene", 0.5, 0.5);
    for expected in [Some(GrainRef { world: 0, grain: 0 }), None] {
        // Two clicks in quick succession would be a double click.
        robot.harness.input_mut().time = Some(robot.harness.input().time.unwrap_or(0.0) + 2.0);
        robot.harness.hover_at(at);
        robot.button(at, true);
        robot.button(at, false);
        assert_eq!(robot.state().mouse.pinned, expected);
        robot.harness.step();
        let listed = robot.harness.query_by_label("Unpin").is_some();
        assert_eq!(listed, expected.is_some());
        for _ in 0..40 {
            robot.harness.step();
        }
    }
}

#[test]
fn a_dragged_grain_follows_the_mouse_and_stays_when_let_go() {
    let (_folder, config) = one_grain();
    let mut robot = Robot::open(config);
    robot.state_mut().preferences.full_speed = true;
    let (from, to) = (robot.place("scene", 0.5, 0.45), robot.place("scene", 0.7, 0.3));
    robot.key(egui::Key::Space);
    robot.drag(from, to);
    robot.until("the grain to follow", |state| {
        let grain = &state.world().unwrap().snapshot.grains[0];
        grain.position.x > 4e-3 && grain.position.y > 0.022 && grain.velocity.length() < 1e-3
    });
    robot.button(to, false);
    robot.settle();
    assert_eq!(robot.world().controls.pull, None);
    assert!(robot.state().mouse.grabbed.is_none());
}

#[test]
fn the_wheel_zooms_and_f_frames_the_scene_again() {
    let (_folder, config) = one_grain();
    let mut robot = Robot::open(config);
    let before = robot.state().camera;
    let at = robot.place("scene", 0.8, 0.2);
    robot.harness.hover_at(at);
    robot.harness.event(egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: egui::vec2(0.0, 120.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: egui::Modifiers::NONE,
    });
    for _ in 0..30 {
        robot.harness.step();
    }
    assert_ne!(robot.state().camera, before);
    robot.key(egui::Key::F);
    assert_eq!(robot.state().camera, before);
}
