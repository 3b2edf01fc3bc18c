//! Tests of plots, comparisons and other views in the window, and of controls whose positions must not change.

use egui_kittest::kittest::Queryable;

use crate::robot::*;

#[test]
fn histograms_count_the_moment_that_is_shown() {
    let mut robot = Robot::open(pile());
    robot.key(egui::Key::ArrowRight);
    robot.clicks(&["Compare", "Distributions", "contacts"]);
    // The histogram must count each grain.
    let counted = "contacts of a grain: 138 in all";
    let start = std::time::Instant::now();
    while !robot.shows(counted) {
        assert!(start.elapsed().as_secs() < 60, "waited in vain for {counted}");
        robot.harness.step();
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
}

#[test]
fn slump_and_what_to_try_are_told_of_piles_alone() {
    let tried = "stick better";
    let mut robot = Robot::open(Config::of_scene("moving-walls"));
    robot.harness.step();
    assert!(!robot.shows("slump Δy") && robot.shows("overlap"), "all else is plotted");
    robot.load(Config::of_scene("chain"));
    robot.harness.step();
    assert!(robot.settings().parameters.bond > 0.0, "it sticks");
    assert!(!robot.shows(tried), "no pile");
    robot.load(pile());
    robot.harness.step();
    assert!(robot.shows("slump Δy") && !robot.shows("overlap"));
    assert!(robot.shows(tried));
}

#[test]
fn a_refusal_moves_no_control() {
    let mut robot = Robot::open(pile());
    let place = |robot: &Robot| robot.state().controls["μ"];
    let before = place(&robot);
    robot.type_number("Bond, cohesion", "-1");
    robot.harness.step();
    assert!(robot.harness.query_by_label_contains("Bond is -1").is_some(), "the refusal is told");
    assert_eq!(place(&robot), before);
}

#[test]
fn the_end_of_the_help_is_within_reach_on_a_low_window() {
    let mut robot = Robot::open(pile());
    robot.harness.set_size(egui::vec2(720.0, 480.0));
    robot.key(egui::Key::H);
    let end = "Type any value into";
    robot.harness.get_by_label_contains(end).scroll_to_me();
    robot.frames(10);
    let end = robot.harness.get_by_label_contains(end).rect();
    assert!(end.bottom() < 480.0 && end.top() > 0.0, "{end:?}");
}

#[test]
fn long_names_do_not_widen_the_panel() {
    let mut robot = Robot::open(pile());
    robot.click("Compare");
    let before = robot.state().controls["Pile"].left();
    for line_up in ["Two laws", "Law, solver", "Expert", "Solvers", "Compare"] {
        robot.click(line_up);
        robot.frames(10);
        let now = robot.state().controls["Pile"].left();
        assert!(now >= before - 1.0, "{line_up}: the panel begins at {now}, not at {before}");
    }
}

fn wait_for_words(robot: &mut Robot, words: &str) {
    let start = std::time::Instant::now();
    while !robot.shows(words) {
        assert!(start.elapsed().as_secs() < 120, "waited in vain for {words}");
        robot.harness.step();
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
}

#[test]
fn a_step_is_measured_by_all_methods() {
    let mut robot = Robot::open(pile());
    robot.take_steps(5);
    robot.clicks(&["Law, solver", "Expert", "Speed and accuracy", "Measure this step"]);
    wait_for_words(&mut robot, "measured here");
    assert!(robot.harness.query_all_by_label("newton").next().is_some());
    assert_eq!(robot.steps(), 5, "the run has taken no step");
    // Springs need no solver.
    robot.click("dem");
    robot.harness.step();
    let button = robot.harness.get_by_label("Measure this step");
    assert!(button.accesskit_node().is_disabled());
}

#[test]
fn a_scene_is_chosen_by_its_picture() {
    let mut robot = Robot::open(pile());
    robot.click("Pile");
    robot.harness.get_by_role_and_label(egui::Role::ComboBox, "Scene").click();
    robot.frames(SCENES.len() + 5);
    for info in SCENES.iter().filter(|info| info.group != SceneGroup::Stability) {
        let entry = robot.harness.query_by_role_and_label(egui::Role::Button, info.name);
        assert!(entry.is_some(), "{}", info.name);
    }
    robot.harness.get_by_role_and_label(egui::Role::Button, "drum").click();
    robot.harness.step();
    robot.settle();
    let start = robot.state().run.frame.start.clone().expect("a start");
    assert_eq!((start.scene.name.as_str(), robot.world().snapshot.grains.len()), ("drum", 150));
}

/// Returns true if the window shows this residual as a text.
fn tells(robot: &Robot, residual: f64) -> bool {
    robot.shows(&format!("{residual:.1e}"))
}

#[test]
fn the_panel_tells_the_residual_of_the_last_step() {
    let mut robot = Robot::open(pile());
    robot.click("Law, solver");
    for _ in 0..3 {
        robot.key(egui::Key::ArrowRight);
    }
    let residual = |robot: &Robot| robot.observables().residual;
    let loose = residual(&robot);
    assert!(tells(&robot, loose));

    let mut settings = robot.settings();
    (settings.solver.stop, settings.solver.tolerance) = (StopTest::Residual, 1e-7);
    settings.solver.max_sweeps = 20_000;
    settings.solver.friction_model = FrictionModel::Coulomb;
    robot.change(0, settings);
    robot.key(egui::Key::ArrowRight);
    assert!(residual(&robot) < 0.1 * loose, "{} after {loose}", residual(&robot));
    assert!(tells(&robot, residual(&robot)));
}

#[test]
fn compared_worlds_share_their_simulated_time() {
    let mut robot = Robot::open(pile());
    robot.clicks(&["Compare", "Paper Fig. 4"]);
    assert_eq!(robot.state().run.frame.worlds.len(), 6);
    let parameters = robot.of_worlds(|world| world.controls.settings.parameters);
    let numbers: Vec<_> = parameters.iter().map(|it| (it.bond, it.time_step_secs)).collect();
    let expected =
        [(20.0, 1e-4), (20.0, 1e-3), (20.0, 2e-3), (100.0, 1e-4), (100.0, 1e-3), (100.0, 2e-3)];
    assert_eq!(numbers, expected);
    for tick in 1..=10 {
        robot.key(egui::Key::ArrowRight);
        for world in &robot.state().run.frame.worlds {
            let last = &world.snapshot.observables;
            let apart = last.time_secs - f64::from(tick) * 2e-3;
            assert!(apart.abs() < 1e-9, "{} s after tick {tick}", last.time_secs);
        }
    }
    robot.seek(0.01);
    let times = robot.of_worlds(|world| world.snapshot.observables.time_secs);
    assert!(times.into_iter().all(|time| (time - 0.01).abs() < 1e-9));
}

#[test]
fn a_step_beside_a_far_longer_one_takes_many_and_ends_at_the_same_time() {
    let mut robot = Robot::open(pile());
    let base = robot.settings();
    robot.send(Command::Compare(vec![base.over(2e-7), base.over(1e-3)]));
    robot.state_mut().run.step();
    robot.until("the middle of the step", |state| state.run.frame.seeking);
    robot.settle();
    assert!(!robot.state().run.frame.playing);
    let rows = robot.of_worlds(|world| world.snapshot.observables);
    assert_eq!([rows[0].step, rows[1].step], [5000, 1], "more than come in a slice of time");
    assert!((rows[0].time_secs - rows[1].time_secs).abs() < 1e-9, "{}", rows[0].time_secs);
}

#[test]
fn steps_that_are_asked_for_while_one_is_computed_are_taken_after_it_until_a_pause() {
    let mut robot = Robot::open(pile());
    let base = robot.settings();
    robot.send(Command::Compare(vec![base.over(1e-7), base.over(1e-3)]));
    let steps = |robot: &Robot| robot.of_worlds(|world| world.snapshot.observables.step);
    (0..2).for_each(|_| robot.state_mut().run.step());
    robot.until("the middle of a step", |state| state.run.frame.seeking);
    robot.settle();
    assert_eq!(steps(&robot), [20_000, 2]);
    (0..3).for_each(|_| robot.state_mut().run.step());
    robot.send(Command::Pause);
    assert_eq!(
        steps(&robot),
        [30_000, 3],
        "the step under way is brought to its end, and no other is begun"
    );
}

#[test]
fn a_world_that_would_never_catch_up_lets_commands_in() {
    let mut robot = Robot::open(pile());
    let base = robot.settings();
    robot.send(Command::Compare(vec![base.over(1e-4), base.over(1e6)]));
    for plays in [false, true] {
        match plays {
            true => robot.state_mut().run.live.send(Command::Play),
            false => robot.state_mut().run.live.send(Command::Step),
        };
        robot.until("some steps", |state| state.run.frame.worlds[0].snapshot.observables.step > 3);
        robot.key(egui::Key::R);
        assert_eq!(robot.steps(), 0);
    }
}

#[test]
fn what_hardly_moves_rests_and_is_told_in_units_that_one_knows() {
    let mut config = pile();
    config.parameters.bond = Some(100.0);
    let mut robot = Robot::open(config);
    robot.take_steps(400);
    let speeds =
        robot.world().snapshot.grains.iter().map(|grain| grain.velocity.abs().max_element());
    let rests = |speed: f64| speed > 0.0 && speed < 1e-8;
    let grain = speeds
        .clone()
        .position(rests)
        .unwrap_or_else(|| panic!("{:?}", speeds.collect::<Vec<_>>()));
    robot.state_mut().run.pinned = Some(GrainRef { world: 0, grain });
    robot.frames(3);
    assert!(robot.shows("0.000 m/s, 0.000 m/s"), "grain {grain}");
}

/// Opens all pages of the panel in turn and checks that no text contains an internal name such as `rho`.
fn words_are_as_one_reads_them(robot: &mut Robot) {
    for page in Page::ALL {
        robot.state_mut().preferences.page = Some(page);
        robot.frames(5);
        let root = robot.harness.root();
        let all = root.children_recursive().map(|node| node.accesskit_node());
        let texts: Vec<String> = all.filter_map(|node| node.label().or(node.value())).collect();
        assert!(texts.len() > 20, "{page:?}: {} texts", texts.len());
        for text in texts {
            let words = text.split(|c: char| !c.is_alphanumeric());
            let odd = ["rho", "mu", "2th", "3th"];
            assert!(!words.into_iter().any(|word| odd.contains(&word)), "{page:?}: {text}");
        }
    }
    robot.state_mut().preferences.page = Some(Page::Compare);
    robot.frames(5);
}

#[test]
fn symbols_and_ordinals_are_written_as_one_reads_them() {
    // The run would have more rows than a curve can have.
    let mut config = Config::of_scene("cradle");
    config.source.duration = Some(1e6);
    let mut robot = Robot::open(config);
    robot.send(Command::SetPace(Pace::Max));
    robot.send(Command::Play);
    robot.until("a long curve", |state| {
        state.run.frame.worlds[0].snapshot.observables.step > 33_000
    });
    robot.send(Command::Pause);
    words_are_as_one_reads_them(&mut robot);
    assert!(robot.shows("plotted: one step every "), "the situation");
}

#[test]
fn worlds_and_refusals_write_symbols_as_well() {
    let mut robot = Robot::open(pile());
    let mut other = robot.settings();
    (other.parameters.restitution, other.parameters.friction) = (0.5, 0.3);
    robot.send(Command::Compare(vec![robot.settings(), other]));
    robot.type_number("ρ, restitution", "2");
    robot.type_number("μ, friction", "-1");
    words_are_as_one_reads_them(&mut robot);
    assert!(robot.shows("2: ρ 0.5, μ 0.3"), "the situation");
    assert!(robot.shows("ρ is 2, but") && robot.shows("μ is -1, but"), "the situation");
}

#[test]
fn the_paper_is_named() {
    let mut robot = Robot::open(pile());
    robot.key(egui::Key::H);
    robot.frames(3);
    assert!(robot.shows("The paper is A. Abramian and L. Staron"));
}

#[test]
fn two_laws_stand_side_by_side() {
    let mut robot = Robot::open(pile());
    robot.clicks(&["Compare", "Two laws"]);
    let told = robot.of_worlds(|world| {
        let Settings { stepper, parameters, .. } = world.controls.settings;
        (stepper, parameters.bond, parameters.time_step_secs)
    });
    let of_law = |law| [1e-4, 1e-3, 5e-3].map(|time| (law, 20.0, time));
    assert_eq!(told, [of_law(Stepper::Moreau), of_law(Stepper::Range)].concat());
}

#[test]
fn a_world_computes_what_it_computes_alone() {
    let mut robot = Robot::open(pile());
    robot.take_steps(20);
    let alone = robot.world().snapshot.grains.clone();
    let same = robot.settings();
    let mut other = same;
    other.parameters.bond = 0.0;
    robot.send(Command::Compare(vec![other, same]));
    robot.take_steps(20);
    let worlds = &robot.state().run.frame.worlds;
    assert_eq!(worlds[1].snapshot.grains, alone);
    assert_ne!(worlds[0].snapshot.grains, alone);
}

#[test]
fn an_experiment_shows_its_own_quantity_in_place_of_the_errors_of_the_solver() {
    let mut robot = Robot::open(Config::of_scene("drum"));
    robot.take_steps(3);
    robot.frames(2);
    assert!(robot.shows("angle of the surface (degrees)"));
    assert!(robot.shows("kinetic energy") && !robot.shows("error of velocities"));
    robot.load(pile());
    robot.frames(2);
    assert!(!robot.shows("angle of the surface") && robot.shows("slump Δy"));
}
