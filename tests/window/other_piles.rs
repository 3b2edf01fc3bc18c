//! The mean over other piles: whose it is, when it is there, and when it is not.

use std::path::Path;
use std::time::{Duration, Instant};

use egui_kittest::kittest::Queryable;
use slump::config::Config;
use slump::live::Command;
use slump::scene::{NewPile, Scene, settle};
use slump::sim::Settings;

use crate::robot::Robot;

/// They give way to whatever else the machine does.
const PATIENCE: Duration = Duration::from_secs(600);
/// Piles that settle in no time.
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

/// Waits until all other piles of a world have come to their end, and tells their mean at a time.
fn mean(robot: &mut Robot, world: usize, time_secs: f64) -> (f64, f64, usize) {
    let begun = Instant::now();
    loop {
        let told = robot.state().ensemble.mean_at(world, time_secs);
        if let Some(told) = told.filter(|&(.., count)| count == 8) {
            return told;
        }
        assert!(begun.elapsed() < PATIENCE, "waited in vain for eight piles: {told:?}");
        // Someone is looking: what stands still for long is not computed for.
        robot.state_mut().live.send(Command::SetPull(0, None));
        robot.settle();
        std::thread::sleep(Duration::from_millis(50));
    }
}

/// Mean and half the interval of the slump at the end of runs from the same seeds, without a window.
fn headless(settings: &Settings) -> (f64, f64) {
    let slump = |seed: u64| {
        let pile =
            NewPile { grains: GRAINS, box_width_in_diameters: WIDTH, seed, ..NewPile::default() };
        let grains = settle(&pile, |_| true).expect("a pile at rest");
        let mut scene: Scene = small_pile().scene_from(grains).expect("a scene");
        scene.set_settings(*settings);
        let mut simulation = scene.simulation().expect("a sound scene");
        simulation.take_steps(100).expect("finite states");
        simulation.observables().slump
    };
    let slumps = [1, 3, 4, 5, 6, 7, 9, 10].map(slump);
    let mean = slumps.iter().sum::<f64>() / 8.0;
    let variance = slumps.iter().map(|slump| (slump - mean).powi(2)).sum::<f64>() / 7.0;
    // Tables: t(0.975; 7) = 2.364624.
    (mean, 2.364_624 * (variance / 8.0).sqrt())
}

fn assert_near((mean, half, count): (f64, f64, usize), expected: (f64, f64)) {
    assert!((mean - expected.0).abs() < 1e-15, "mean {mean}, expected {}", expected.0);
    assert!((half - expected.1).abs() < 1e-6 * expected.1, "± {half}, expected {}", expected.1);
    assert!(half > 1e-4 && count == 8, "± {half} of {count} piles");
}

#[test]
fn the_mean_is_that_of_the_same_seeds_without_a_window() {
    let cache = tempfile::tempdir().expect("a folder");
    let mut robot = open(cache.path());
    let settings = robot.world().controls.settings;
    let at_end = mean(&mut robot, 0, 0.1);
    let expected = headless(&settings);
    assert_near(at_end, expected);
    let kept: Vec<_> = std::fs::read_dir(cache.path()).expect("a folder").collect();
    assert_eq!(kept.len(), 8, "initial states are kept");

    // The run itself changes nothing of it, and the number stands beside its own.
    robot.state_mut().live.send(Command::SetPace(slump::live::Pace::Max));
    robot.state_mut().live.send(Command::Play);
    robot.until("the end", |state| !state.frame.playing && state.frame.time_secs() > 0.09);
    robot.settle();
    assert_near(mean(&mut robot, 0, 0.1), expected);
    robot.harness.step();
    assert!(robot.harness.query_by_label_contains("(n = 8)").is_some());

    // Other settings begin anew, from the kept states.
    let mut other = settings;
    other.parameters.bond = 0.0;
    robot.state_mut().change(0, other);
    robot.settle();
    let told = robot.state().ensemble.mean_at(0, 0.1);
    assert_eq!(told, None, "the settings of the run changed on its way");
    robot.key(egui::Key::R);
    assert_near(mean(&mut robot, 0, 0.1), headless(&other));
}

#[test]
fn compared_worlds_have_others_each() {
    let cache = tempfile::tempdir().expect("a folder");
    let mut robot = open(cache.path());
    let strong = robot.world().controls.settings.with_bond(100.0);
    let weak = strong.with_bond(0.0);
    robot.state_mut().live.send(Command::Compare(vec![strong, weak]));
    robot.settle();
    for (world, settings) in [strong, weak].iter().enumerate() {
        assert_near(mean(&mut robot, world, 0.1), headless(settings));
    }
}

#[test]
fn a_run_that_was_pulled_or_changed_on_its_way_has_none() {
    let cache = tempfile::tempdir().expect("a folder");
    let mut robot = open(cache.path());
    mean(&mut robot, 0, 0.1);
    let pull = slump::sim::Pull { grain: 3, target: glam::DVec2::new(0.0, 0.1) };
    robot.state_mut().live.send(Command::SetPull(0, Some(pull)));
    robot.click("Step");
    robot.state_mut().live.send(Command::SetPull(0, None));
    robot.settle();
    assert_eq!(robot.state().ensemble.mean_at(0, 0.1), None);
    assert!(robot.state().ensemble.threads() > 0);
}

#[test]
fn switched_off_there_is_no_thread() {
    let cache = tempfile::tempdir().expect("a folder");
    let mut robot = open(cache.path());
    robot.until("a thread", |state| state.ensemble.threads() > 0);
    robot.click("other piles");
    assert_eq!(robot.state().ensemble.threads(), 0);
    assert_eq!(robot.state().ensemble.mean_at(0, 0.0), None);
    // A scene that is no pile has none either.
    robot.click("other piles");
    robot.until("a thread", |state| state.ensemble.threads() > 0);
    robot.state_mut().load(Config::of_scene("cradle"));
    robot.settle();
    robot.harness.step();
    assert_eq!(robot.state().ensemble.threads(), 0);
    assert!(robot.harness.query_by_label("other piles").is_none());
}
