//! What a step of 2,000 grains at rest costs, here and in other engines, against the overlap that it
//! leaves: an engine is fast at will where grains may sink into each other.
//!
//! A state from a file has no impulses. From none, a step of 40 layers takes thousands of sweeps, and
//! what is left undone is overlap for good, which no other step here tells of. So the pile first comes
//! to carry itself, in small steps that are not counted.

use std::collections::BTreeMap;

use super::entrants::{self, Way};
use super::look::{colour, dots};
use super::peers::{self, PeerRun};
use super::runs::{Ending, TimedRun, timed_steps};
use super::{Bench, Part};
use crate::chart::{Axis, Chart, Layer, Look, Sheet, points};
use crate::config::{Config, SceneSource};
use crate::error::Result;
use crate::output::Progress;
use crate::scene::{Deposition, NewPile, Scene, walls};
use crate::sim::Simulation;
use crate::solver::{SolverSettings, StopTest};
use crate::states::States;
use crate::world::ParameterChanges;

/// The grains, as `benches/peers/run.sh` rains them.
const RAIN: NewPile =
    NewPile { grains: 2000, box_width_in_diameters: 60.0, seed: 1, deposition: Deposition::Rain };
/// Simulated time, s.
const DURATION_SECS: f64 = 0.2;
/// Δt, s.
const TIME_STEPS_SECS: [f64; 2] = [1e-3, 5e-3];
/// Mean overlap, in diameters, at which steps are compared.
const OVERLAP: f64 = 5e-4;
/// Substeps of the engines that are compared.
const SUBSTEPS: u32 = 16;
/// Steps in which the pile comes to carry itself, and their Δt, s.
const FIRST_STEPS: u32 = 400;
/// See [`FIRST_STEPS`].
const FIRST_STEP_SECS: f64 = 1e-4;
/// A run that takes longer is given up, s.
const LIMIT_SECS: f64 = 10.0;

/// One method at one Δt and effort.
struct Entry {
    entrant: entrants::Entrant,
    effort: String,
    time_step_secs: f64,
    run: TimedRun,
}

pub(super) fn make(bench: &Bench) -> Result<Vec<Part>> {
    let source = SceneSource {
        grains: Some(RAIN.grains),
        box_width: Some(RAIN.box_width_in_diameters),
        seed: Some(RAIN.seed),
        ..SceneSource::default()
    };
    let parameters = ParameterChanges {
        bond: Some(0.0),
        restitution_threshold: Some(2.0),
        ..ParameterChanges::default()
    };
    let config = Config { source, parameters, ..Config::default() };
    let states = States::of(bench.states_folder(), std::iter::once(&config))?;
    let mut scene = states.scene(&config)?;
    scene.boundaries = walls(RAIN.box_width_in_diameters);
    let entries = run_all(bench, &carried(scene)?)?;
    let mut peers = peers::read(&bench.peers)?;
    peers
        .retain(|run| run.scene == "rest" && run.grains == RAIN.grains && run.substeps == SUBSTEPS);
    Ok(vec![draw(bench, &entries, &peers)])
}

/// The pile with the impulses that carry it.
fn carried(mut scene: Scene) -> Result<Simulation> {
    scene.parameters.time_step_secs = FIRST_STEP_SECS;
    scene.solver = SolverSettings {
        stop: StopTest::Residual,
        tolerance: 1e-5,
        max_sweeps: 1_000,
        ..SolverSettings::default()
    };
    let mut simulation = scene.simulation()?;
    for _ in 0..FIRST_STEPS {
        simulation.step()?;
    }
    Ok(simulation)
}

fn run_all(bench: &Bench, carried: &Simulation) -> Result<Vec<Entry>> {
    let (journal, mut done) = bench.journal::<TimedRun>("rest")?;
    let mut wanted: Vec<(entrants::Entrant, String, Way, f64)> = Vec::new();
    for time_step_secs in TIME_STEPS_SECS {
        for entrant in entrants::all() {
            let mut want = |effort: String, way| {
                wanted.push((entrant.clone(), effort, way, time_step_secs));
            };
            if entrant.stepper.uses_method() {
                for tolerance in [1e-2, 1e-4] {
                    let way = entrant.to_residual(tolerance, 2_000);
                    want(format!("residual {tolerance:e}"), way);
                }
                want("10 sweeps".into(), entrant.sweeps(10));
            } else {
                want(format!("{SUBSTEPS} substeps"), entrant.substeps(SUBSTEPS));
            }
        }
    }
    let progress = Progress::new("at rest", wanted.len() as u64);
    let mut entries = Vec::new();
    for (entrant, effort, way, time_step_secs) in wanted {
        let key = format!("{}, {effort}, dt {time_step_secs:e}", entrant.name);
        let run = match done.iter().position(|run| run.key == key) {
            Some(place) => done.swap_remove(place),
            None => {
                let mut start = carried.clone();
                start.change(way.over(start.settings()).over(time_step_secs))?;
                let steps = (DURATION_SECS / time_step_secs).round() as u64;
                let run = timed_steps(key, &start, steps, 3, LIMIT_SECS)?;
                journal.add(&run)?;
                run
            }
        };
        progress.advance(1);
        entries.push(Entry { entrant, effort, time_step_secs, run });
    }
    progress.finish();
    Ok(entries)
}

impl Entry {
    fn ms_per_step(&self) -> f64 {
        1e3 * self.run.wall_secs / self.run.steps.max(1) as f64
    }

    fn is_done(&self) -> bool {
        self.run.ending == Ending::Done
    }
}

fn draw(bench: &Bench, entries: &[Entry], peers: &[PeerRun]) -> Part {
    let done = || entries.iter().filter(|entry| entry.is_done());
    let times = || done().map(Entry::ms_per_step).chain(peers.iter().map(|run| run.ms_per_step));
    let from = 0.6 * times().fold(f64::INFINITY, f64::min).min(1.0);
    let to = 1.6 * times().fold(10.0 * from, f64::max);
    let mut chart = Chart::new(
        "2,000 grains at rest between walls",
        Axis::log("time of a step (ms)", from, to),
        Axis::log("mean overlap (d)", 1e-5, 0.1),
    );
    let line = points([from, to].map(|x| (x, OVERLAP)));
    chart.layers.push(Layer::curve("5·10⁻⁴ d", line, (130, 130, 130), Look::Dashes(2)));
    for entrant in entrants::all() {
        let of_method = || entries.iter().filter(|entry| entry.entrant.look == entrant.look);
        let failed = of_method().filter(|entry| !entry.is_done()).count();
        let name = match failed {
            0 => entrant.name.clone(),
            failed => format!("{}\n{failed} of {} failed", entrant.name, of_method().count()),
        };
        let places = of_method()
            .filter(|entry| entry.is_done())
            .map(|entry| (entry.ms_per_step(), entry.run.mean_overlap.max(1e-5)));
        let look = dots(entrant.look, 6);
        chart.layers.push(Layer::curve(name, points(places), colour(entrant.look), look));
    }
    let mut by_engine: BTreeMap<&str, Vec<&PeerRun>> = BTreeMap::new();
    for run in peers {
        by_engine.entry(&run.engine).or_default().push(run);
    }
    for (index, (engine, runs)) in by_engine.iter().enumerate() {
        let places = points(runs.iter().map(|run| (run.ms_per_step, run.mean_overlap)));
        chart.layers.push(Layer::curve(*engine, places, peers::colour(index), Look::Rings(9)));
    }
    let mut charts = vec![chart];
    let legend = Chart::legend_of(&mut charts, 0.3);
    charts.push(legend);
    let caption = bench.caption(&["Bond 0; other engines with 16 substeps."]);
    let sheet = Sheet { size: (1400, 820), charts, caption };
    let report = told(entries, &by_engine);
    let tables = vec![("chart-rest-points".into(), table(entries))];
    Part { name: "chart-rest".into(), sheet, report, tables }
}

/// The fastest of each side at the overlap of the comparison, and their ratio.
fn told(entries: &[Entry], by_engine: &BTreeMap<&str, Vec<&PeerRun>>) -> String {
    let mut lines = vec![format!(
        "Fastest with a mean overlap of at most {OVERLAP:e} d, at each Δt. A ratio above 1: the step here \
         is the faster one.\n\n| Δt, s | here, ms a step | engine, ms a step | ratio |\n|---|---|---|---|"
    )];
    for time_step_secs in TIME_STEPS_SECS {
        let ours = entries
            .iter()
            .filter(|entry| entry.is_done() && entry.time_step_secs == time_step_secs)
            .filter(|entry| entry.run.mean_overlap <= OVERLAP)
            .min_by(|one, other| one.ms_per_step().total_cmp(&other.ms_per_step()));
        let Some(ours) = ours else {
            lines.push(format!("| {time_step_secs:e} | none | | |"));
            continue;
        };
        let ms = ours.ms_per_step();
        let here = format!("{ms:.3} ({}, {})", ours.entrant.name, ours.effort);
        for (engine, runs) in by_engine {
            let best = runs
                .iter()
                .filter(|run| run.time_step_secs == time_step_secs && run.mean_overlap <= OVERLAP)
                .min_by(|one, other| one.ms_per_step.total_cmp(&other.ms_per_step));
            let (there, ratio) = match best {
                Some(run) => (
                    format!("{:.3} ({engine}, on {})", run.ms_per_step, run.processor),
                    format!("{:.2}", run.ms_per_step / ms),
                ),
                None => (format!("none ({engine})"), String::new()),
            };
            lines.push(format!("| {time_step_secs:e} | {here} | {there} | {ratio} |"));
        }
        if by_engine.is_empty() {
            lines.push(format!("| {time_step_secs:e} | {here} | no table of other engines | |"));
        }
    }
    lines.join("\n")
}

fn table(entries: &[Entry]) -> String {
    let mut text =
        String::from("method,time_step_secs,effort,ending,ms_per_step,mean_overlap,slump\n");
    for entry in entries {
        let ending = match entry.run.ending {
            Ending::Done => "done",
            Ending::TooSlow => "too-slow",
            Ending::NotFinite => "not-finite",
        };
        text.push_str(&format!(
            "{},{:e},{},{ending},{},{},{}\n",
            entry.entrant.name,
            entry.time_step_secs,
            entry.effort,
            entry.ms_per_step(),
            entry.run.mean_overlap,
            entry.run.slump
        ));
    }
    text
}
