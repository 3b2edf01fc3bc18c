//! Tests of recordings: the contents of their files, the data that remain however a run ends, and reading them.

mod balance;
mod columns;
mod ids;
mod initial;
mod options;
mod refusals;
mod resumed;
mod tables;
#[cfg(unix)]
mod torn;

use slump::data::{FormatName, Recording, RecordingMark};
use slump::scene::{Scene, built_in};
use slump::sim::{Moment, Simulation};

use crate::program::*;

/// Runs the program without a window and checks that it ends with an error message of one sentence. Returns the
/// sentence.
fn refusal(arguments: &[&str]) -> String {
    let said = sentence(slump("--headless").args(arguments));
    said.strip_prefix("slump: ").unwrap_or_else(|| panic!("{said}")).to_owned()
}

fn scene(name: &str) -> Scene {
    built_in(name).expect("a built-in scene")
}

fn start(folder: &Path, formats: &[FormatName], scene: &Scene) -> Recording {
    let about = slump::config::scene_facts(scene).expect("facts");
    Recording::start(folder, formats, &about, false).expect("a recording")
}

/// Takes `steps` steps and passes each to the recording, which stores a frame after every `every` steps.
fn record(recording: &mut Recording, simulation: &mut Simulation, steps: u64, every: u64) {
    recording.follow(simulation);
    for _ in 0..steps {
        let observables = *simulation.step().expect("a finite state");
        recording.add_step(&observables).expect("a row");
        recording.follow(simulation);
        if observables.step.is_multiple_of(every) {
            recording.add(simulation.moment()).expect("a frame");
        }
    }
}

/// Records `steps` steps of a scene with a frame after every `every` steps, and finishes the recording.
fn recorded(folder: &Path, formats: &[FormatName], scene: &Scene, steps: u64, every: u64) {
    let mut recording = start(folder, formats, scene);
    record(&mut recording, &mut scene.simulation().expect("a scene"), steps, every);
    recording.finish().expect("a recording");
}
