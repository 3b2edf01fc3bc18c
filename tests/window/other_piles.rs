//! Tests of new piles while they are computed, and of the ensemble: other piles with the same settings, which the
//! window computes on idle cores and whose mean it shows.

use crate::robot::*;

/// Time limit for computing the other piles of the ensemble, whose threads have low priority.
const PATIENCE: Duration = Duration::from_secs(600);
/// Label of the switch with which the user lets the window compute other piles.
const OTHERS: &str = "Other piles, on idle cores";
/// Number of grains of a small pile, which comes to rest very soon.
const GRAINS: usize = 12;
const WIDTH: f64 = 5.0;

fn small_pile() -> Config {
    let mut config = Config::default();
    config.source.scene = Some("pile".into());
    (config.source.grains, config.source.box_width) = (Some(GRAINS), Some(WIDTH));
    config.source.seed = Some(2);
    config.source.duration = Some(0.1);
    config.parameters.time_step_secs = Some(1e-3);
    config
}

fn open(cache: &Path) -> Robot {
    let mut robot = Robot::open(small_pile());
    robot.state_mut().ensemble.keep_in(cache.to_owned());
    robot.state_mut().preferences.ensemble = true;
    robot
}

/// Waits until the eight other piles for one of the compared simulations are complete. Returns the mean of their slumps
/// at the simulated time `time_secs` (s), half the width of its 95 % interval, and the number of piles.
fn mean(robot: &mut Robot, world: usize, time_secs: f64) -> (f64, f64, usize) {
    let begun = Instant::now();
    loop {
        let told = robot.state().ensemble.mean_at(world, time_secs);
        if let Some(told) = told.filter(|&(.., count)| count == 8) {
            return told;
        }
        assert!(begun.elapsed() < PATIENCE, "waited in vain for eight piles: {told:?}");
        // The window stops computing other piles if nothing happens for a long time. A command shows that somebody is
        // looking.
        robot.send(Command::SetPull(0, None));
        std::thread::sleep(Duration::from_millis(50));
    }
}

/// Runs piles with the same seeds as the window's other piles, without a window. Returns the mean of their final
/// slumps, and half the width of its 95 % interval.
fn headless(settings: &Settings) -> (f64, f64) {
    let slump = |seed: u64| {
        let pile =
            NewPile { grains: GRAINS, box_width_in_diameters: WIDTH, seed, ..NewPile::default() };
        let grains = settle(&pile, |_| true).expect("a pile at rest");
        let mut scene: Scene = small_pile().scene_from(grains).expect("a scene");
        scene.set_settings(*settings);
        let mut simulation = scene.simulation().expect("a sound scene");
        simulation.take_steps(simulation.step_at(0.1)).expect("finite states");
        simulation.observables().slump
    };
    let slumps = [1, 3, 4, 5, 6, 7, 9, 10].map(slump);
    let mean = slumps.iter().sum::<f64>() / 8.0;
    let variance = slumps.iter().map(|slump| (slump - mean).powi(2)).sum::<f64>() / 7.0;
    // Student's t for 95 % and 7 degrees of freedom, from tables: t(0.975; 7) = 2.364624.
    (mean, 2.364_624 * (variance / 8.0).sqrt())
}

fn assert_near((mean, half, count): (f64, f64, usize), expected: (f64, f64)) {
    assert!((mean - expected.0).abs() < 1e-15, "mean {mean}, expected {}", expected.0);
    assert!((half - expected.1).abs() < 1e-6 * expected.1, "± {half}, expected {}", expected.1);
    assert!(half > 1e-4 && count == 8, "± {half} of {count} piles");
}

#[test]
fn the_mean_is_that_of_the_same_seeds_without_a_window() {
    let cache = folder();
    let mut robot = open(cache.path());
    let settings = robot.settings();
    let at_end = mean(&mut robot, 0, 0.1);
    let expected = headless(&settings);
    assert_near(at_end, expected);
    let kept: Vec<_> = std::fs::read_dir(cache.path()).expect("a folder").collect();
    assert_eq!(kept.len(), 8, "initial states are kept");
    // The run does not affect the mean of the other piles, which is shown next to the value of the run.
    robot.state_mut().run.live.send(Command::SetPace(slump::live::Pace::Max));
    robot.state_mut().run.live.send(Command::Play);
    robot.until("the end", |state| !state.run.frame.playing && state.run.frame.time_secs() > 0.09);
    robot.settle();
    assert_near(mean(&mut robot, 0, 0.1), expected);
    robot.harness.step();
    assert!(robot.shows("(n = 8)"));
    // With other settings the other piles start again, from the stored initial states.
    let mut other = settings;
    other.parameters.bond = 0.0;
    robot.change(0, other);
    let told = robot.state().ensemble.mean_at(0, 0.1);
    assert_eq!(told, None, "the settings of the run changed on its way");
    robot.key(egui::Key::R);
    assert_near(mean(&mut robot, 0, 0.1), headless(&other));
}

/// Lets the window save the points of its plot of slump against Δt (Fig. 5a of Abramian & Staron 2020). Returns for
/// each point the time step Δt (s) and, in parentheses, the mean slump, half the width of its 95 % confidence interval,
/// and the number of piles.
fn saved_points(robot: &mut Robot) -> Vec<(f64, (f64, f64, usize))> {
    robot.click("CSV");
    let table = read(robot.saved());
    let point = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let [time_step, mean] = [2, 3].map(|cell| cells[cell].parse().expect("a number"));
        let count = cells[5].parse().expect("a count");
        assert_eq!(cells[4].is_empty(), count < 3, "an interval of {count} piles: {line}");
        (time_step, (mean, cells[4].parse().unwrap_or(f64::NAN), count))
    };
    table.lines().skip(1).map(point).collect()
}

#[test]
fn released_piles_leave_a_point_each_though_the_next_is_released_before_their_others_are_done() {
    let (cache, folder) = (folder(), folder());
    let mut robot = open(cache.path());
    robot.state_mut().preferences.folder = folder.path().to_owned();
    robot.state_mut().preferences.starts_again = true;
    robot.send(Command::SetPace(Pace::Max));
    let long = robot.settings().over(2e-3);
    let short = robot.settings();
    robot.send(Command::Play);
    robot.until("a step", |state| state.run.frame.recorded_secs() > 0.0);
    assert!(!robot.state().controls.contains_key("clear figure"), "nothing tells its end before");
    robot.type_number("Δt, time step", "2");
    robot.until("the end", |state| !state.run.frame.playing);
    let begun = Instant::now();
    let points = loop {
        robot.send(Command::SetPull(0, None));
        if robot.state().controls.contains_key("clear figure") {
            let points = saved_points(&mut robot);
            if points.len() == 2 && points.iter().all(|(_, (.., count))| *count == 8) {
                break points;
            }
        }
        assert!(begun.elapsed() < PATIENCE, "waited in vain for two points");
        std::thread::sleep(Duration::from_millis(50));
    };
    for ((time_step, point), settings) in points.into_iter().zip([short, long]) {
        assert_eq!(time_step, settings.parameters.time_step_secs);
        assert_near(point, headless(&settings));
    }
    robot.harness.step();
    let said = "Δt 1 ms → 2 ms: slump ";
    assert!(robot.shows(said) && robot.shows(", eight piles each; difference "), "{said}");
    // The point of the pile that is shown remains.
    robot.click("Clear");
    robot.harness.step();
    assert_eq!(saved_points(&mut robot).len(), 1);
}

#[test]
fn a_released_pile_leaves_its_own_point_if_no_other_piles_can_run() {
    let folder = folder();
    let mut robot = Robot::open(small_pile());
    robot.state_mut().ensemble = slump::app::Ensemble::default();
    robot.state_mut().preferences.folder = folder.path().to_owned();
    robot.state_mut().preferences.starts_again = true;
    robot.send(Command::SetPace(Pace::Max));
    robot.send(Command::Play);
    robot.until("the end", |state| !state.run.frame.playing && state.run.frame.time_secs() > 0.09);
    robot.type_number("Δt, time step", "2");
    robot.until("the end with 2 ms", |state| {
        let frame = &state.run.frame;
        let last = frame.worlds[0].snapshot.observables;
        !frame.playing && last.time_secs > 0.09 && last.time_step_secs > 1.5e-3
    });
    robot.harness.step();
    assert_eq!(robot.state().ensemble.threads(), 0, "other piles run");
    robot.click("CSV");
    let table = read(robot.saved());
    let slump = robot.state().run.frame.worlds[0].snapshot.observables.slump;
    let rows: Vec<&str> = table.lines().skip(1).collect();
    assert!(rows.len() == 2 && rows.iter().all(|row| row.ends_with(",,1")), "{table}");
    assert!(rows[1].contains(&format!(",0.002,{slump},,1")), "{slump}: {table}");
}

#[test]
fn compared_worlds_have_others_each() {
    let cache = folder();
    let mut robot = open(cache.path());
    let strong = robot.settings().with_bond(100.0);
    let weak = strong.with_bond(0.0);
    robot.send(Command::Compare(vec![strong, weak]));
    for (world, settings) in [strong, weak].iter().enumerate() {
        assert_near(mean(&mut robot, world, 0.1), headless(settings));
    }
}

#[test]
fn a_run_that_was_pulled_or_changed_on_its_way_has_none() {
    let cache = folder();
    let mut robot = open(cache.path());
    mean(&mut robot, 0, 0.1);
    let pull = Pull { grain: 3, target: DVec2::new(0.0, 0.1) };
    robot.state_mut().run.live.send(Command::SetPull(0, Some(pull)));
    robot.key(egui::Key::ArrowRight);
    robot.send(Command::SetPull(0, None));
    assert_eq!(robot.state().ensemble.mean_at(0, 0.1), None);
    assert!(robot.state().ensemble.threads() > 0);
}

#[test]
fn switched_off_there_is_no_thread() {
    let cache = folder();
    let mut robot = open(cache.path());
    robot.until("a thread", |state| state.ensemble.threads() > 0);
    robot.clicks(&["Compare", OTHERS]);
    assert_eq!(robot.state().ensemble.threads(), 0);
    assert_eq!(robot.state().ensemble.mean_at(0, 0.0), None);
    // For a scene that is not a pile, the switch is not shown.
    robot.click(OTHERS);
    robot.until("a thread", |state| state.ensemble.threads() > 0);
    robot.load(Config::of_scene("cradle"));
    robot.harness.step();
    assert_eq!(robot.state().ensemble.threads(), 0);
    assert!(robot.harness.query_by_label(OTHERS).is_none());
}

/// Returns the configuration of a pile with so many grains that it takes a while until they have fallen and come to
/// rest.
fn rain() -> Config {
    let mut config = pile();
    config.source.grains = Some(400);
    config.source.box_width = Some(NewPile::default().box_width_in_diameters);
    config
}

#[test]
fn a_first_pile_that_is_given_up_leaves_the_default_one() {
    let mut robot = Robot::begin(rain(), Preferences::default(), |window| window);
    robot.until("the rain", |state| {
        state.run.frame.loading.as_ref().is_some_and(|loading| loading.preview.is_some())
    });
    robot.click("Cancel");
    robot.until("a pile", |state| !state.run.frame.worlds.is_empty());
    assert_eq!(robot.world().snapshot.grains.len(), 138);
    robot.take_steps(1);
}

#[test]
fn grains_are_seen_as_they_rain_and_the_world_before_comes_back() {
    let mut robot = Robot::open(pile());
    robot.take_steps(5);
    let (before, steps) = (robot.bits(), robot.steps());
    robot.state_mut().load(rain());
    let preview = |state: &slump::app::AppState| {
        state.run.frame.loading.as_ref().and_then(|loading| loading.preview.clone())
    };
    robot.until("the rain", |state| preview(state).is_some());
    assert_eq!(preview(robot.state()).expect("the rain").grains.len(), 400);
    robot.until("grains that have fallen", |state| {
        preview(state).is_some_and(|now| now.observables.time_secs > 0.05)
    });
    let told = robot.state().run.frame.loading.as_ref().expect("progress").text.clone();
    assert!(told.starts_with("Raining a new pile of 400"), "{told}");
    assert!(robot.state().controls.contains_key("pile in the making"), "it is drawn");
    let shown = robot.harness.query_all_by_label_contains("Raining a new pile of 400").count();
    assert!(shown >= 1, "and told");
    // While the new pile is computed, keys have no effect, and their commands are not carried out later.
    for key in [egui::Key::Space, egui::Key::ArrowRight, egui::Key::R] {
        robot.harness.key_press(key);
        robot.harness.step();
    }
    assert!(robot.state().run.frame.loading.is_some(), "the situation: it still rains");
    assert_eq!((robot.bits(), robot.steps()), (before.clone(), steps), "the world waits");

    robot.click("Cancel");
    assert!(robot.state().run.frame.loading.is_none() && !robot.state().run.frame.playing);
    assert_eq!((robot.bits(), robot.steps()), (before, steps), "it is there again");
    robot.take_steps(1);
    assert_eq!(robot.steps(), steps + 1, "and goes on");
    assert_eq!(robot.state().run.frame.worlds[0].curve.rows().count(), 7, "with its record");
}
