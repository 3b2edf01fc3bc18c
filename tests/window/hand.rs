//! Tests of the mouse in the scene: pinning, dragging, adding and removing grains, and dragging walls.

use egui::{Event, Modifiers, PointerButton, Pos2};

use crate::robot::*;

fn press(robot: &mut Robot, at: Pos2, pressed: bool) {
    let (button, modifiers) = (PointerButton::Primary, Modifiers::SHIFT);
    robot.harness.event(Event::ModifiersChanged(modifiers));
    robot.harness.event(Event::PointerButton { pos: at, button, pressed, modifiers });
    robot.harness.step();
}

fn shift_click(robot: &mut Robot, at: Pos2) {
    // Two clicks in quick succession would count as a double click, so the clock is advanced.
    robot.harness.input_mut().time = Some(robot.harness.input().time.unwrap_or(0.0) + 2.0);
    robot.harness.hover_at(at);
    press(robot, at, true);
    press(robot, at, false);
    robot.harness.event(Event::ModifiersChanged(Modifiers::NONE));
    robot.settle();
}

fn count(robot: &Robot) -> usize {
    robot.world().snapshot.grains.len()
}

#[test]
fn a_press_and_release_in_one_frame_pin_a_grain() {
    let mut robot = Robot::open(pile());
    let pos = at(&robot, robot.world().snapshot.grains[60].position);
    let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
    let press = |pressed| Event::PointerButton { pos, button, pressed, modifiers };
    // The harness would give each event a frame of its own.
    let events = [Event::PointerMoved(pos), press(true), press(false)];
    robot.harness.input_mut().events.extend(events);
    robot.frames(2);
    assert_eq!(robot.state().run.pinned, Some(GrainRef { world: 0, grain: 60 }));
}

#[test]
fn shift_that_is_released_in_the_frame_of_the_click_counts() {
    let mut robot = Robot::open(pile());
    let grains = count(&robot);
    let pos = robot.place("scene", 0.555, 0.08);
    let (button, modifiers) = (PointerButton::Primary, Modifiers::SHIFT);
    let press = |pressed| Event::PointerButton { pos, button, pressed, modifiers };
    robot.harness.hover_at(pos);
    robot.frames(2);
    robot.harness.input_mut().events.extend([
        Event::ModifiersChanged(modifiers),
        press(true),
        press(false),
        Event::ModifiersChanged(Modifiers::NONE),
    ]);
    robot.frames(2);
    robot.settle();
    assert_eq!(count(&robot), grains + 1);
}

#[test]
fn a_click_puts_a_grain_where_there_is_room_and_another_takes_it_out() {
    let mut robot = Robot::open(pile());
    robot.take_steps(10);
    let (before, grains) = (robot.bits(), count(&robot));
    robot.state_mut().preferences.new_grain_diameters = 1.5;
    let free = robot.place("scene", 0.555, 0.08);
    shift_click(&mut robot, free);
    assert_eq!(count(&robot), grains + 1);
    let added = robot.world().snapshot.grains[grains];
    let diameter = robot.world().snapshot.surroundings.mean_diameter;
    assert!((added.radius - 0.75 * diameter).abs() < 1e-12 && added.velocity == DVec2::ZERO);
    assert_eq!(robot.bits()[..grains], before, "the others stay as they are");
    assert!(!robot.world().is_even, "no command line makes this");
    // The new grain falls, and its path is recorded.
    robot.take_steps(40);
    let fallen = robot.bits();
    assert!(robot.world().snapshot.grains[grains].position.y < added.position.y - 1e-3);
    let end = robot.state().run.frame.recorded_secs();
    for goal in [0.0, end] {
        robot.seek(goal);
    }
    assert_eq!(robot.bits(), fallen, "computed again, bit for bit");
    robot.seek(0.005);
    assert_eq!(count(&robot), grains, "before, it was not there");
    robot.seek(end);
    // A click on a grain with the shift key removes it.
    let taken = robot.world().snapshot.grains[60].position;
    let there = at(&robot, taken);
    shift_click(&mut robot, there);
    assert_eq!(count(&robot), grains, "one less");
    robot.take_steps(5);
    assert_eq!(robot.steps(), 55);
}

#[test]
fn a_grain_that_finds_no_room_is_refused_with_a_notice() {
    let mut robot = Robot::open(pile());
    robot.take_steps(2);
    let grains = count(&robot);
    robot.state_mut().preferences.new_grain_diameters = 5.0;
    // The position is just above the heap: its centre is free, but the large new grain would overlap others.
    let grains_then = robot.world().snapshot.grains.iter();
    let top = grains_then.map(|it| it.position.y + it.radius).fold(0.0, f64::max);
    let edit = Edit::Add(slump::world::Disc { position: DVec2::new(0.0, top), radius: 0.0125 });
    robot.send(Command::Edit(0, edit));
    assert_eq!(count(&robot), grains);
    assert_eq!(robot.notice(), "place of a new grain is on another one, but must be free");
}

#[test]
fn what_a_hand_changes_in_the_past_leaves_the_run_that_was_there() {
    let mut robot = Robot::open(pile());
    robot.take_steps(30);
    robot.seek(0.01);
    assert_eq!(robot.steps(), 10);
    let free = robot.place("scene", 0.555, 0.08);
    shift_click(&mut robot, free);
    assert_eq!(robot.state().run.frame.past.len(), 1, "the run before is kept");
    assert!((robot.state().run.frame.recorded_secs() - 0.01).abs() < 1e-9);
    robot.take_steps(5);
    assert_eq!(robot.steps(), 15);
    // A saved session restores the changes.
    let folder = folder();
    let path = robot.save_session(folder.path());
    let now = robot.bits();
    let mut again = Robot::open_saved(&path);
    assert_eq!(again.bits(), now);
    again.seek(0.0);
    again.seek(again.state().run.frame.recorded_secs());
    assert_eq!(again.bits(), now, "and its way");
    // The notice about a copied link says that the link does not contain these changes.
    let context = robot.harness.ctx.clone();
    robot.state_mut().copy_link(&context);
    robot.until("the link", |state| {
        state.notice().is_some_and(|(notice, _)| notice.text.starts_with("The link is copied"))
    });
    let told = robot.notice();
    assert!(told.contains("added or removed"), "{told}");
}

#[test]
fn a_wall_follows_the_mouse_while_time_passes_and_stays_when_let_go() {
    let ends = [DVec2::new(-0.02, 0.0), DVec2::new(-0.02, 0.04)];
    let (_folder, config) = one_grain(|scene| {
        scene.name = "wall".into();
        scene.grains[0].position = DVec2::new(0.05, 0.02);
        scene.boundaries = vec![slump::world::Boundary::Segment { from: ends[0], to: ends[1] }];
        scene.view = Some(View { min: DVec2::new(-0.04, -0.02), max: DVec2::new(0.06, 0.06) });
    });
    let mut robot = Robot::open(config);
    robot.state_mut().preferences.full_speed = true;
    let place = |robot: &Robot| place_of(&robot.world().snapshot.surroundings.boundaries[0]);
    assert_eq!(place(&robot), ends[0]);

    let from = at(&robot, DVec2::new(-0.02, 0.02));
    let to = at(&robot, DVec2::new(0.01, 0.02));
    // While the simulation is paused, a notice says that walls move only in a running simulation.
    robot.harness.hover_at(from);
    press(&mut robot, from, true);
    robot.harness.hover_at(to);
    robot.harness.step();
    robot.harness.step();
    let told = robot.state().notice().map(|it| it.0.text.clone()).unwrap_or_default();
    assert!(told.starts_with("Walls move only while time passes"), "{told}");
    robot.state_mut().run.live.send(Command::Play);
    robot.until("the wall to come", |state| {
        let boundaries = &state.run.world().unwrap().snapshot.surroundings.boundaries;
        (place_of(&boundaries[0]).x - 0.01).abs() < 1e-3
    });
    press(&mut robot, to, false);
    robot.harness.event(Event::ModifiersChanged(Modifiers::NONE));
    robot.settle();
    let there = place(&robot);
    robot.state_mut().run.live.send(Command::Pause);
    robot.take_steps(20);
    assert_eq!(place(&robot), there, "it stays");
    assert!((there.y - ends[0].y).abs() < 1e-3, "and went straight: {there}");
}

/// Returns the screen position of a point of the scene (m), in a view that shows the whole scene.
fn at(robot: &Robot, point: DVec2) -> Pos2 {
    let rect = robot.state().controls["scene"];
    let style = slump::render::Style { legend: false, ..robot.state().preferences.style.clone() };
    let start = robot.state().run.frame.start.as_ref().expect("a start");
    let size = [rect.width() as u32, rect.height() as u32];
    let camera = style.camera(start.view[0], start.view[1], size[0], size[1]);
    let [x, y] = camera.project(point);
    rect.center() + egui::vec2(x, -y)
}

#[test]
fn the_panel_says_how_and_how_large() {
    let mut robot = Robot::open(pile());
    robot.click("Pile");
    let field = robot.harness.get_by_role_and_label(egui::Role::SpinButton, "New grain");
    assert_eq!(field.accesskit_node().numeric_value(), Some(1.0));
    robot.key(egui::Key::H);
    assert!(robot.harness.query_by_label("Shift drag a wall").is_some(), "the help has it");
}

#[test]
fn exported_data_has_the_new_grain_and_says_who_put_it_there() {
    let folder = folder();
    let mut robot = crate::recordings::open(pile(), folder.path(), slump::data::FormatName::ALL);
    robot.take_steps(5);
    let grains = count(&robot);
    let disc = slump::world::Disc { position: DVec2::new(0.0, 0.2), radius: 2e-3 };
    robot.state_mut().run.live.send(Command::Edit(0, Edit::Add(disc)));
    robot.take_steps(5);
    robot.state_mut().run.live.send(Command::Edit(0, Edit::Remove(3)));
    robot.take_steps(1);
    assert_eq!(count(&robot), grains);
    crate::recordings::export(&mut robot);
    let at = |step| {
        let found = slump::data::read_grains(folder.path(), step).expect("grains");
        found.grains.len()
    };
    assert_eq!(
        [at(Some(5)), at(Some(6)), at(Some(10)), at(None)],
        [grains, grains + 1, grains + 1, grains]
    );
    let told = &crate::recordings::facts(folder.path())["changed_by_hand"];
    assert!(told.contains("a grain of radius 0.002 m added at 0, 0.2 m after step 5"), "{told}");
    assert!(told.ends_with("grain 3 removed after step 10"), "{told}");
}

/// Writes a scene with one grain in the middle of its view. Returns the folder of its file, and the configuration that
/// opens it.
fn in_the_middle() -> (tempfile::TempDir, Config) {
    one_grain(|scene| {
        scene.name = "one".into();
        scene.grains = vec![slump::world::Grain::at_rest(DVec2::new(0.0, 0.02), 2e-3)];
        scene.view = Some(View { min: DVec2::new(-0.01, 0.01), max: DVec2::new(0.01, 0.03) });
    })
}

#[test]
fn a_click_pins_a_grain_and_another_lets_it_go() {
    let (_folder, config) = in_the_middle();
    let mut robot = Robot::open(config);
    let at = robot.place("scene", 0.5, 0.5);
    for expected in [Some(GrainRef { world: 0, grain: 0 }), None] {
        // Two clicks in quick succession would count as a double click, so the clock is advanced.
        robot.harness.input_mut().time = Some(robot.harness.input().time.unwrap_or(0.0) + 2.0);
        robot.harness.hover_at(at);
        robot.button(at, true);
        robot.button(at, false);
        assert_eq!(robot.state().run.pinned, expected);
        robot.harness.step();
        assert_eq!(robot.harness.query_by_label("Unpin").is_some(), expected.is_some());
        robot.frames(40);
    }
}

#[test]
fn a_dragged_grain_follows_the_mouse_and_stays_when_let_go() {
    let (_folder, config) = in_the_middle();
    let mut robot = Robot::open(config);
    robot.state_mut().preferences.full_speed = true;
    let (from, to) = (robot.place("scene", 0.5, 0.45), robot.place("scene", 0.7, 0.3));
    robot.key(egui::Key::Space);
    robot.drag(from, to);
    robot.until("the grain to follow", |state| {
        let grain = &state.run.world().unwrap().snapshot.grains[0];
        grain.position.x > 4e-3 && grain.position.y > 0.022 && grain.velocity.length() < 1e-3
    });
    robot.button(to, false);
    robot.settle();
    assert_eq!(robot.world().controls.pull, None);
    assert!(robot.state().panels.scene.mouse.grabbed.is_none());
}

#[test]
fn the_wheel_zooms_and_f_frames_the_scene_again() {
    let (_folder, config) = in_the_middle();
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
    robot.frames(30);
    assert_ne!(robot.state().camera, before);
    robot.key(egui::Key::F);
    assert_eq!(robot.state().camera, before);
}
