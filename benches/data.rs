//! Benchmark: cost of a recording. Runs 10,000 discs with 40 sweeps per step, without a recording and with a recording
//! in each format, and a frame every ten steps. The time includes the start and the end of the recording.
//!
//! ```text
//! cargo bench --bench data
//! taskset --cpu-list 0 cargo bench --bench data    # the writer has no processor of its own
//! ```

mod common;

use common::timing::{criterion, least_secs};
use slump::data::{FormatName, Recording, RunFacts, Times};
use slump::sim::Simulation;
use slump::solver::StopTest;

const GRAINS: usize = 10_000;
/// Number of steps of a run. A run ends when its last frame is written, so many frames are needed for a fair
/// comparison.
const STEPS: u64 = 400;
const STEPS_A_FRAME: u64 = 10;

/// Returns the discs at rest, with settings that make each step take 40 sweeps.
fn start() -> Simulation {
    let mut simulation = common::settled(GRAINS);
    let mut settings = *simulation.solver();
    (settings.stop, settings.tolerance, settings.max_sweeps) =
        (StopTest::RelativeChange, 1e-15, 40);
    simulation.set_solver(settings).expect("proper settings");
    simulation
}

/// Takes the steps and records them in the given formats. Returns the size of the recording in bytes.
fn run(start: &Simulation, formats: &[FormatName]) -> u64 {
    let folder = tempfile::tempdir().expect("a folder");
    let mut simulation = start.clone();
    let mut recording = (!formats.is_empty()).then(|| {
        let started = Recording::start(folder.path(), formats, &RunFacts::default(), false);
        let every_secs = STEPS_A_FRAME as f64 * simulation.parameters().time_step_secs;
        started.expect("a recording").at(Times::Every(every_secs), &simulation)
    });
    for _ in 0..STEPS {
        let observables = *simulation.step().expect("a finite state");
        let Some(recording) = &mut recording else { continue };
        recording.add_step(&observables).expect("a row");
        recording.add_if_due(&simulation).expect("a frame");
    }
    recording.map_or(Ok(()), Recording::finish).expect("a recording");
    bytes_in(folder.path())
}

fn bytes_in(folder: &std::path::Path) -> u64 {
    let entries = std::fs::read_dir(folder).expect("a folder").flatten();
    let size = |path: std::path::PathBuf| match path.is_dir() {
        true => bytes_in(&path),
        false => path.metadata().map_or(0, |about| about.len()),
    };
    entries.map(|entry| size(entry.path())).sum()
}

fn main() {
    let mut criterion = criterion().sample_size(10);
    let start = start();
    println!("{} contacts", start.contacts().contacts().len());
    let plain = least_secs(&mut criterion, "without a recording", || {
        run(&start, &[]);
    });
    let frames = (STEPS / STEPS_A_FRAME) as f64;
    let mut lines = vec![format!("without: {:.2} ms a step", 1e3 * plain / STEPS as f64)];
    for format in FormatName::ALL {
        let mut bytes = 0;
        let secs = least_secs(&mut criterion, format.name(), || bytes = run(&start, &[*format]));
        lines.push(format!(
            "{}: {:+.1} % of the run, {:.2} MB a frame",
            format.name(),
            100.0 * (secs / plain - 1.0),
            bytes as f64 / frames / 1e6
        ));
    }
    println!("\nleast over all repeats, {GRAINS} discs, 40 sweeps a step, a frame each ten steps:");
    println!("{}", lines.join("\n"));
    criterion.final_summary();
}
