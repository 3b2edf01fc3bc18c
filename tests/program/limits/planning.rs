//! Studies are planned in time that grows with their runs, and their initial states are settled once.

use std::path::Path;
use std::time::Instant;

use slump::config::{Config, read_scene, scene_to_toml};
use slump::error::Result;
use slump::scene::{GrainSource, NewPile, built_in, settle};
use slump::study::Study;

use super::{folder, run, write};

fn plan(text: &str, path: &Path) -> Result<Study> {
    Study::parse(text, path, false)
}

#[test]
fn planning_takes_time_in_proportion_to_the_number_of_values() {
    let time = |count: usize| {
        let range = format!("bond = {{ from = 1, to = {count} }}");
        let text = format!("name = \"many\"\n[base]\nscene = \"cradle\"\n[vary]\n{range}\n");
        let start = Instant::now();
        let study = plan(&text, Path::new("many.toml")).expect("a study");
        assert_eq!(study.runs.len(), count);
        start.elapsed().as_secs_f64() / count as f64
    };
    let (few, many) = (time(5_000), time(100_000));
    assert!(many < 3.0 * few, "{few:e} s a value of few, {many:e} s of many");
}

#[test]
fn more_runs_than_anyone_can_wait_for_are_refused_before_they_take_room() {
    let range = "{ from = 1, to = 2, count = 2000 }";
    let text = format!(
        "name = \"many\"\n[base]\nscene = \"cradle\"\n[vary]\nbond = {range}\nduration = {range}\n\
         start = {range}\nmu = {range}\n"
    );
    // Of the axes after the second none is looked at.
    let said = plan(&text, Path::new("many.toml")).map(|_| ()).expect_err("too many").to_string();
    assert!(said.contains("vary is 4000000 runs with vary.duration, but must be"), "{said}");
}

#[test]
fn a_rained_scene_file_is_settled_once_and_no_run_of_a_plan_settles_it() {
    let folder = folder();
    let rain = NewPile { grains: 30, box_width_in_diameters: 8.0, seed: 3, ..NewPile::default() };
    let mut scene = built_in("pile").expect("a scene");
    scene.grains.clear();
    scene.source = Some(GrainSource::NewPile(rain.clone()));
    let path = write(&folder, "rained.toml", &scene_to_toml(&scene).expect("TOML"));

    let start = Instant::now();
    let settled = settle(&rain, |_| true).expect("a pile");
    let once = start.elapsed();
    let config = Config::of_scene(path.to_str().expect("UTF-8"));
    let mut told = 0;
    let made = config.scene(|_| {
        told += 1;
        true
    });
    let made = made.expect("a scene");
    assert!(told > 10, "settling is told of: {told} times");
    assert!(made.grains.iter().zip(&settled).all(|(a, b)| a.position == b.position));
    assert_eq!(made, read_scene(&path).expect("the same scene"));
    assert!(config.scene(|_| false).is_err_and(|error| error.to_string().contains("interrupted")));

    let study = format!(
        "name = \"rained\"\n[base]\nscene = {path:?}\n[vary]\nbond = {{ from = 1, to = 1000 }}\n"
    );
    let start = Instant::now();
    let study = plan(&study, Path::new("rained.toml")).expect("a study");
    assert_eq!(study.runs.len(), 1000);
    assert!(
        start.elapsed() < 20 * once,
        "{:?} for 1000 runs, a settling is {once:?}",
        start.elapsed()
    );
}

#[test]
fn a_sweep_of_a_rained_scene_file_keeps_its_state() {
    let folder = folder();
    let mut scene = built_in("pile").expect("a scene");
    scene.grains.clear();
    scene.duration_secs = 0.002;
    let rain = NewPile { grains: 12, box_width_in_diameters: 6.0, seed: 3, ..NewPile::default() };
    scene.source = Some(GrainSource::NewPile(rain));
    let scene = write(&folder, "rained.toml", &scene_to_toml(&scene).expect("TOML"));
    let study = format!("name = \"r\"\n[base]\nscene = {scene:?}\n[vary]\nbond = [1, 2, 3]\n");
    let study = write(&folder, "study.toml", &study);
    let out = folder.path().join("out");
    let text = |path: &Path| path.to_str().expect("UTF-8").to_owned();
    let output = run(&["sweep", &text(&study), "--out", &text(&out)]);
    assert!(output.status.success(), "{output:?}");
    let states = std::fs::read_dir(out.join("states")).expect("states").count();
    assert_eq!(states, 1, "settled once for three runs");
}
