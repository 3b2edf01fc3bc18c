//! Tests that sliders, fields, buttons and keys of the window change the simulation in the solver's thread.

use crate::robot::*;
use slump::config::SceneSource;

#[test]
fn a_slider_changes_the_time_step_of_the_next_snapshot() {
    let mut robot = Robot::open(pile());
    let (from, to) = (robot.place("Δt", 0.66, 0.5), robot.place("Δt", 1.0, 0.5));
    robot.drag(from, to);
    robot.button(to, false);
    robot.settle();
    let wanted = robot.settings().parameters.time_step_secs;
    assert!((5e-3..=1e-2).contains(&wanted), "the slider's right end means 1e-2 s, not {wanted}");
    robot.key(egui::Key::ArrowRight);
    assert_eq!(robot.observables().time_step_secs, wanted);
}

#[test]
fn a_value_is_typed() {
    let mut robot = Robot::open(pile());
    robot.type_number("Δt, time step", "500 us");
    robot.key(egui::Key::ArrowRight);
    assert_eq!(robot.observables().time_step_secs, 5e-4);
}

#[test]
fn springs_are_set_in_the_panel_which_tells_what_follows() {
    let mut robot = Robot::open(pile());
    robot.clicks(&["Law, solver", "dem"]);
    robot.settle();
    robot.type_number("Bond, cohesion", "20");
    robot.type_number("k, stiffness", "2000");
    robot.settle();
    assert_eq!(robot.settings().parameters.stiffness, 2000.0);
    let (mass, g, d) = (std::f64::consts::PI * 6.25e-6, 9.8, 5e-3);
    // The expected work of fracture is C₀²/(2k) (C₀: cohesion force, k: stiffness) of two grains with about the mass of
    // a disc of the mean diameter.
    let expected = (20.0 * 0.5 * mass * g).powi(2) / 4000.0 / (mass * g * d);
    let told = robot.world().fracture_work.expect("bonds").over_mgd;
    assert!((told / expected - 1.0).abs() < 0.05, "{told} is not {expected}");
    robot.harness.step();
    for words in ["contact time t_c", "work of fracture", &format!("= {told:.1e} m g d")] {
        assert!(robot.shows(words), "{words}");
    }
}

/// Checks that the help does not mention double clicks on sliders, because sliders react only to dragging.
#[test]
fn help_promises_no_double_click_on_a_slider() {
    let mut robot = Robot::open(pile());
    robot.click("Help");
    robot.frames(2);
    assert!(robot.shows("Type any value into the field above a slider"));
    assert!(!robot.shows("Double-click") && !robot.shows("double-click"));
}

#[test]
fn the_run_changes_while_it_runs() {
    let mut robot = Robot::open(pile());
    robot.click("▶  Release");
    robot.until("ten steps", |state| state.run.world().unwrap().snapshot.observables.step >= 10);
    robot.type_number("Bond, cohesion", "75");
    let world = robot.world();
    assert!(robot.state().run.frame.playing);
    assert_eq!(world.controls.settings.parameters.bond, 75.0);
}

#[test]
fn a_press_and_release_without_delay_are_a_click() {
    let mut robot = Robot::open(pile());
    let click = |robot: &mut Robot, at: egui::Pos2, in_one_frame: bool| {
        let (button, modifiers) = (egui::PointerButton::Primary, egui::Modifiers::NONE);
        let press = |pressed| egui::Event::PointerButton { pos: at, button, pressed, modifiers };
        let events = [egui::Event::PointerMoved(at), press(true), press(false)];
        if in_one_frame {
            robot.harness.input_mut().events.extend(events);
        } else {
            events.into_iter().for_each(|event| robot.harness.event(event));
        }
        robot.frames(2);
        robot.settle();
    };
    let release = robot.place("release", 0.5, 0.5);
    click(&mut robot, release, true);
    assert!(robot.state().run.frame.playing);
    click(&mut robot, release, true);
    assert!(!robot.state().run.frame.playing);
    let (left, ground) = (robot.place("Δt", 0.1, 0.5), robot.settings());
    // A slider of egui misses a press that is released in the same frame.
    click(&mut robot, left, false);
    assert!(robot.settings().parameters.time_step_secs < ground.parameters.time_step_secs);
}

#[test]
fn pause_stops_time() {
    let mut robot = Robot::open(pile());
    robot.key(egui::Key::Space);
    robot.until("some steps", |state| state.run.world().unwrap().snapshot.observables.step >= 5);
    robot.key(egui::Key::Space);
    let steps = robot.steps();
    assert!(!robot.state().run.frame.playing);
    std::thread::sleep(std::time::Duration::from_millis(100));
    robot.harness.step();
    assert_eq!(robot.steps(), steps);
}

#[test]
fn a_step_is_exactly_one() {
    let mut robot = Robot::open(pile());
    robot.key(egui::Key::ArrowRight);
    assert_eq!(robot.steps(), 1);
    robot.key(egui::Key::ArrowRight);
    assert_eq!(robot.steps(), 2);
    robot.key(egui::Key::R);
    assert_eq!(robot.steps(), 0);
}

#[test]
fn a_run_pauses_at_the_end_of_its_scene_and_plays_on_from_there() {
    let mut config = pile();
    config.source.duration = Some(0.02);
    let mut robot = Robot::open(config);
    robot.state_mut().preferences.full_speed = true;
    robot.key(egui::Key::Space);
    robot.until("the end", |state| !state.run.frame.playing);
    assert_eq!(robot.steps(), 20);
    robot.key(egui::Key::Space);
    robot.until("more", |state| state.run.world().unwrap().snapshot.observables.step > 22);
}

#[test]
fn what_makes_no_sense_is_refused_visibly() {
    let mut robot = Robot::open(pile());
    for (text, complaint) in [
        ("-5", "Bond is -5, but must be a finite number ≥ 0"),
        ("strong", "“strong” is not a number"),
    ] {
        robot.type_number("Bond, cohesion", text);
        assert_eq!(robot.settings().parameters.bond, 20.0);
        assert!(robot.harness.query_by_label(complaint).is_some(), "{complaint}");
    }
    robot.type_number("Bond, cohesion", "500");
    assert_eq!(robot.settings().parameters.bond, 500.0, "beyond the slider is no mistake");
    assert!(!robot.shows("is not a number"));
}

/// Returns the command line of the displayed run, and the scene that the next start of the program would open.
fn identity(robot: &Robot) -> (Option<String>, Config) {
    (robot.state().run.command_line(), robot.state().preferences.scene.clone())
}

#[test]
fn a_scene_that_cannot_be_opened_says_why_and_leaves_the_old_one() {
    let mut robot = Robot::open(pile());
    let before = identity(&robot);
    robot.load(Config::of_scene("no-such.toml"));
    assert_eq!(identity(&robot), before);
    let (notice, _) = robot.state().notice().expect("a complaint");
    assert!(notice.text.starts_with("no-such.toml: "), "{}", notice.text);
    assert_eq!(robot.world().snapshot.grains.len(), 138);
}

#[test]
fn a_dropped_list_of_discs_is_opened_and_anything_else_is_not() {
    let folder = folder();
    let discs = folder.path().join("three.csv");
    write(&discs, "x,y,radius\n0,0.01,0.002\n0.01,0.01,0.002\n0.02,0.01,0.002\n");
    let mut robot = Robot::open(pile());
    for (path, grains) in [(discs, 3), (folder.path().join("photograph.jpeg"), 3)] {
        robot.drop(&path);
        assert_eq!(robot.world().snapshot.grains.len(), grains);
    }
    let (notice, _) = robot.state().notice().expect("a complaint");
    assert!(notice.text.contains("photograph.jpeg is neither a scene"), "{}", notice.text);
}

#[test]
fn a_new_pile_can_be_given_up() {
    let mut robot = Robot::open(pile());
    let before = identity(&robot);
    let mut config = pile();
    (config.source.grains, config.source.seed) = (Some(300), Some(1));
    robot.state_mut().load(config);
    robot.until("progress", |state| {
        state.run.frame.loading.as_ref().is_some_and(|progress| !progress.text.is_empty())
    });
    assert_eq!(identity(&robot), before, "while the new pile is made");
    robot.click("Cancel");
    assert_eq!(identity(&robot), before, "once it is given up");
    assert_eq!(robot.world().snapshot.grains.len(), 138, "the old pile is still there");
    assert!(robot.state().notice().is_none(), "giving up is no failure");
}

#[test]
fn a_run_that_blows_up_pauses_says_so_and_can_be_scrubbed_back() {
    // If a step moves a grain to infinity, no number of sweeps can help.
    let mut robot = Robot::open(pile());
    robot.key(egui::Key::ArrowRight);
    robot.set(|settings| settings.parameters.time_step_secs = 1e200);
    robot.key(egui::Key::ArrowRight);
    robot.key(egui::Key::ArrowRight);
    let failure = robot.world().failure.clone().expect("a failure");
    assert!(
        failure.contains("no longer finite at step") && failure.contains("Bond 20"),
        "{failure}"
    );
    assert!(!robot.state().run.frame.playing);
    assert!(robot.shows("no longer finite"));
    robot.seek(1e-3);
    assert!(robot.world().failure.is_none());
    assert_eq!(robot.steps(), 1);
}

#[test]
fn gravity_is_tilted_while_the_pile_runs_and_the_record_knows() {
    let mut robot = Robot::open(pile());
    robot.take_steps(5);
    robot.click("Law, solver");
    robot.type_number("Tilt", "25");
    let g = robot.world().gravity.expect("uniform gravity");
    assert!((g.x / g.length() - 25f64.to_radians().sin()).abs() < 1e-12, "{g}");
    robot.take_steps(40);
    let (end, end_secs) = (robot.bits(), robot.state().run.frame.time_secs());
    let mean_x = |robot: &Robot| {
        let grains = &robot.world().snapshot.grains;
        grains.iter().map(|grain| grain.velocity.x).sum::<f64>() / grains.len() as f64
    };
    assert!(mean_x(&robot) > 0.0, "the pile slides to the right");
    for secs in [0.002, end_secs] {
        robot.seek(secs);
    }
    assert_eq!(robot.bits(), end);
    assert!(robot.state().run.command_line().expect("a command line").contains("--tilt 25"));
    // If gravity points to a centre, it cannot be tilted.
    let cradle = Robot::open(Config::of_scene("cradle"));
    assert!(cradle.harness.query_by_label("Tilt slider").is_none());
}

#[test]
fn a_pile_is_rolled_in_place() {
    let mut robot = Robot::open(pile());
    robot.click("Pile");
    robot.harness.get_by_role_and_label(egui::Role::SpinButton, "Grains").focus();
    robot.frames(3);
    robot.harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    robot.harness.event(egui::Event::Text("600".to_owned()));
    robot.harness.step();
    robot.harness.key_press(egui::Key::Enter);
    robot.frames(3);
    robot.clicks(&["drop-and-roll", "New pile"]);
    robot.until("the pile", |state| {
        state.run.world().is_some_and(|world| world.snapshot.grains.len() == 600)
    });
    let line = robot.state().run.command_line().expect("a command line");
    assert!(line.contains("--grains 600") && line.contains("--deposition drop-and-roll"), "{line}");
}

#[test]
fn piles_of_every_size_begin_with_solved_steps_and_what_fast_leaves_is_told() {
    let source = SceneSource {
        scene: Some("pile".into()),
        grains: Some(1_000),
        box_width: Some(70.0),
        deposition: Some(Deposition::DropAndRoll),
        ..SceneSource::default()
    };
    let mut robot = Robot::open(Config { source, ..Config::default() });
    assert_eq!(robot.settings().solver, slump::solver::SolverSettings::default());
    robot.take_steps(1);
    robot.harness.get_by_label_contains("Can I trust this?").click();
    robot.frames(5);
    assert!(robot.shows("All 1 step are solved as asked"));
    robot.clicks(&["Law, solver", "Fast"]);
    robot.take_steps(1);
    // The page "Law, solver" has replaced the page with the answer.
    robot.harness.get_by_label_contains("Can I trust this?").click();
    robot.frames(5);
    assert!(
        robot.shows(
            "A step gets 40 sweeps, solved or not: velocities of the last one are off by some"
        )
    );
    assert!(
        robot.shows(
            "With cohesion, piles can slump although they would not if each step were solved"
        )
    );
}

#[test]
fn a_large_pile_is_solved_as_on_the_command_line_and_says_what_is_left() {
    for bond in [0.0, 50.0] {
        let source = SceneSource {
            grains: Some(2_100),
            box_width: Some(61.0),
            deposition: Some(Deposition::DropAndRoll),
            ..SceneSource::default()
        };
        let parameters = slump::world::ParameterChanges { bond: Some(bond), ..Default::default() };
        let mut robot = Robot::open(Config { source, parameters, ..Config::default() });
        assert_eq!(robot.settings().solver, slump::solver::SolverSettings::DEFAULT);
        robot.take_steps(3);
        let last = robot.observables();
        // Steps of standing piles are solved. Steps of falling piles keep an error, which is reported.
        assert_eq!(last.converged, bond > 0.0, "{last:?}");
        let falling_speed = (9.81 * robot.world().snapshot.surroundings.mean_diameter).sqrt();
        assert!(last.velocity_error < 0.03 * falling_speed, "{last:?}");
    }
}

#[test]
fn a_presentation_is_twice_as_large_until_the_key_is_pressed_again() {
    let mut robot = Robot::open(pile());
    let zoom = |robot: &mut Robot| {
        robot.key(egui::Key::P);
        robot.frames(2);
        robot.harness.ctx.zoom_factor()
    };
    assert_eq!([zoom(&mut robot), zoom(&mut robot)], [2.0, 1.0]);
}
