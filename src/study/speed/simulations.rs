//! Speed against accuracy of whole simulations: what a pile's slump is off by, and how many seconds
//! are simulated in one.
//!
//! Steps are posed with the restitution threshold with which nearly all of them have a solution: an
//! error of the solver means something only where there is something to be solved. Two errors are
//! told apart. Against the reference *at the same Δt* a slump is off by what the solver left undone;
//! against the reference at [`FINEST_SECS`] also by the time step. Piles are chaotic: two references,
//! one solved ten times tighter than the other, differ by the *floor*, and no error below it means
//! anything.

use std::collections::{BTreeMap, HashMap};

use rayon::prelude::*;

use super::entrants::{self, Entrant};
use super::look::{colour, dots};
use super::peers::{self, PeerRun};
use super::runs::{Ending, TimedRun, timed_run};
use super::{Bench, Part};
use crate::error::Result;
use crate::output::Progress;
use crate::scene::{Config, Rain};
use crate::solver::{Method, MethodKind, SolverSettings, StopTest};
use crate::study::chart::{Axis, Chart, INK, Layer, Look, Sheet, points};
use crate::study::journal::Journal;
use crate::study::performance::pareto_front;
use crate::study::states::States;
use crate::study::statistics::mean;

/// Δt of the reference that has next to no error of the time step, s.
const FINEST_SECS: f64 = 1e-4;
/// Residual of the references, and of those that show the floor.
const REFERENCE: [f64; 2] = [1e-8, 1e-9];
/// A step gets no more sweeps: one without a solution must not take for ever.
const MOST_SWEEPS: u32 = 5_000;
/// A pile that slumps less than this holds.
const HOLDS: f64 = 0.1;
/// Contacts slower than this many g·Δt do not bounce.
const THRESHOLD: f64 = 2.0;
/// Errors below this are drawn here.
const LEAST_ERROR: f64 = 1e-3;

/// What is run.
struct Plan {
    time_steps_secs: Vec<f64>,
    /// (Bond, seed) of each pile.
    piles: Vec<(f64, u64)>,
    /// Methods, each with how well it is to solve its steps, in words and as settings.
    efforts: Vec<(Entrant, String, SolverSettings)>,
    /// How often each run is timed.
    repeats: u32,
    /// Wall time that a simulated second may take, s.
    limit_secs: f64,
}

impl Plan {
    fn new(quick: bool) -> Self {
        let shared = Rain::default().seed;
        let residuals: &[f64] =
            if quick { &[1e-2, 1e-4, 1e-6] } else { &[1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8] };
        let sweeps: &[u32] = if quick { &[20] } else { &[10, 40] };
        let substeps: &[u32] = if quick { &[0] } else { &[0, 16, 64] };
        let mut efforts = Vec::new();
        for entrant in entrants::all() {
            match entrant.method.kind() {
                MethodKind::Problem => {
                    for &tolerance in residuals {
                        let settings = entrant.to_residual(tolerance, MOST_SWEEPS);
                        efforts.push((
                            entrant.clone(),
                            format!("residual {tolerance:e}"),
                            settings,
                        ));
                    }
                    for &count in sweeps {
                        let settings = entrant.sweeps(count);
                        efforts.push((entrant.clone(), format!("{count} sweeps"), settings));
                    }
                }
                MethodKind::Scheme(_) => {
                    for &count in substeps {
                        let name = match count {
                            0 => "its own substeps".to_owned(),
                            count => format!("{count} substeps"),
                        };
                        efforts.push((entrant.clone(), name, entrant.substeps(count)));
                    }
                }
            }
        }
        // Bond numbers are dealt out to the seeds: each is met by several, and each meets several.
        let piles = if quick {
            vec![(0.0, shared), (20.0, 1), (50.0, 2), (100.0, 3)]
        } else {
            let bonds = [[0.0, 50.0], [20.0, 100.0]];
            let seeds = [shared, 1, 2, 3, 4, 5, 6, 7];
            let of = |(index, seed): (usize, u64)| bonds[index % 2].map(|bond| (bond, seed));
            seeds.into_iter().enumerate().flat_map(of).collect()
        };
        Self {
            time_steps_secs: if quick { vec![1e-3, 5e-3] } else { vec![5e-4, 1e-3, 2e-3, 5e-3] },
            piles,
            efforts,
            repeats: if quick { 1 } else { 2 },
            limit_secs: if quick { 0.8 } else { 10.0 },
        }
    }
}

/// What one method at one Δt and one effort comes to.
struct Charted {
    /// Number in `Plan::efforts`.
    effort: usize,
    time_step_secs: f64,
    /// The runs that reached their end, pile by pile; `None` where one did not.
    runs: Vec<Option<TimedRun>>,
    /// Why there is no point, where there is none.
    failed: Option<&'static str>,
    /// Simulated seconds per second.
    speed: f64,
    /// Mean |slump − reference| at the same Δt, and at the finest.
    errors: [f64; 2],
    /// Share of piles about which it says what the reference at the same Δt says: holds or not.
    verdicts: f64,
}

/// Slumps of references by Δt and number of the pile.
type References = HashMap<(u64, usize), f64>;

pub(super) fn make(bench: &Bench) -> Result<Vec<Part>> {
    let plan = Plan::new(bench.quick);
    let states = States::of(
        bench.states_folder(),
        plan.piles.iter().map(|&pile| config(pile, 1e-3)).collect::<Vec<_>>().iter(),
    )?;
    let (journal, done) = bench.journal::<TimedRun>("simulations")?;
    let mut done: HashMap<String, TimedRun> =
        done.into_iter().map(|run| (run.key.clone(), run)).collect();
    let [references, others] = references(&plan, &states, &journal, &mut done)?;
    let charted = run_all(&plan, &states, &journal, &mut done, &references)?;
    let floor = floor(&plan, &references, &others);
    let peers = peers::read(&bench.peers)?;
    Ok(vec![draw(bench, &plan, &charted, floor, &references, &peers)])
}

fn config((bond, seed): (f64, u64), time_step_secs: f64) -> Config {
    Config {
        seed: Some(seed),
        bond: Some(bond),
        dt: Some(time_step_secs),
        restitution_threshold: Some(THRESHOLD),
        ..Config::default()
    }
}

fn references(
    plan: &Plan,
    states: &States,
    journal: &Journal,
    done: &mut HashMap<String, TimedRun>,
) -> Result<[References; 2]> {
    let mut wanted = Vec::new();
    let steps = std::iter::once(&FINEST_SECS).chain(&plan.time_steps_secs);
    for &time_step_secs in steps {
        for (pile, &numbers) in plan.piles.iter().enumerate() {
            for (number, tolerance) in REFERENCE.into_iter().enumerate() {
                wanted.push((time_step_secs, pile, numbers, number, tolerance));
            }
        }
    }
    let progress = Progress::new("references", wanted.len() as u64);
    let known = &*done;
    let runs: Result<Vec<_>> = wanted
        .into_par_iter()
        .with_max_len(1)
        .map(|(time_step_secs, pile, numbers, number, tolerance)| {
            let (bond, seed) = numbers;
            let key =
                format!("reference {tolerance:e}, Bond {bond}, seed {seed}, dt {time_step_secs:e}");
            let run = match known.get(&key) {
                Some(run) => run.clone(),
                None => {
                    let mut scene = states.scene(&config(numbers, time_step_secs))?;
                    scene.solver = SolverSettings {
                        method: Method::Newton,
                        stop: StopTest::Residual,
                        tolerance,
                        ..SolverSettings::default()
                    };
                    let run = timed_run(key, &scene, 1, f64::INFINITY)?;
                    journal.add(&run)?;
                    run
                }
            };
            progress.advance(1);
            Ok((number, (time_step_secs.to_bits(), pile), run.slump))
        })
        .collect();
    progress.finish();
    let mut references = [References::new(), References::new()];
    for (number, key, slump) in runs? {
        references[number].insert(key, slump);
    }
    Ok(references)
}

/// Mean difference between two references, over all piles and the charted Δt.
fn floor(plan: &Plan, references: &References, others: &References) -> f64 {
    let mut differences = Vec::new();
    for time_step_secs in &plan.time_steps_secs {
        for pile in 0..plan.piles.len() {
            let key = (time_step_secs.to_bits(), pile);
            differences.push((references[&key] - others[&key]).abs());
        }
    }
    mean(&differences).mean
}

fn run_all(
    plan: &Plan,
    states: &States,
    journal: &Journal,
    done: &mut HashMap<String, TimedRun>,
    references: &References,
) -> Result<Vec<Charted>> {
    let points = plan.time_steps_secs.len() * plan.efforts.len();
    let progress = Progress::new("simulations", (points * plan.piles.len()) as u64);
    let mut charted = Vec::with_capacity(points);
    for &time_step_secs in &plan.time_steps_secs {
        for (effort, (entrant, name, settings)) in plan.efforts.iter().enumerate() {
            let mut runs = Vec::new();
            let mut failed = None;
            for &(bond, seed) in &plan.piles {
                progress.advance(1);
                if failed.is_some() {
                    runs.push(None);
                    continue;
                }
                let key = format!(
                    "{}, {name}, Bond {bond}, seed {seed}, dt {time_step_secs:e}",
                    entrant.name
                );
                let run = match done.remove(&key) {
                    Some(run) => run,
                    None => {
                        let mut scene = states.scene(&config((bond, seed), time_step_secs))?;
                        scene.solver = *settings;
                        let run = timed_run(key, &scene, plan.repeats, plan.limit_secs)?;
                        journal.add(&run)?;
                        run
                    }
                };
                failed = match run.ending {
                    Ending::Done => None,
                    Ending::TooSlow => Some("too slow"),
                    Ending::NotFinite => Some("not finite"),
                };
                runs.push(failed.is_none().then_some(run));
            }
            let mut point = Charted {
                effort,
                time_step_secs,
                runs,
                failed,
                speed: 0.0,
                errors: [f64::NAN; 2],
                verdicts: 0.0,
            };
            point.sum_up(references);
            charted.push(point);
        }
    }
    progress.finish();
    Ok(charted)
}

impl Charted {
    fn sum_up(&mut self, references: &References) {
        if self.failed.is_some() {
            return;
        }
        let runs: Vec<&TimedRun> = self.runs.iter().flatten().collect();
        let sum = |number: fn(&TimedRun) -> f64| runs.iter().map(|run| number(run)).sum::<f64>();
        self.speed = sum(|run| run.simulated_secs) / sum(|run| run.wall_secs);
        let off = |step_secs: f64| {
            let off = |(pile, run): (usize, &&TimedRun)| {
                (run.slump - references[&(step_secs.to_bits(), pile)]).abs()
            };
            mean(&runs.iter().enumerate().map(off).collect::<Vec<_>>()).mean
        };
        self.errors = [off(self.time_step_secs), off(FINEST_SECS)];
        let agree = runs.iter().enumerate().filter(|(pile, run)| {
            let reference = references[&(self.time_step_secs.to_bits(), *pile)];
            (run.slump < HOLDS) == (reference < HOLDS)
        });
        self.verdicts = agree.count() as f64 / runs.len().max(1) as f64;
    }
}

fn draw(
    bench: &Bench,
    plan: &Plan,
    charted: &[Charted],
    floor: f64,
    references: &References,
    peers: &[PeerRun],
) -> Part {
    let good: Vec<&Charted> = charted.iter().filter(|point| point.failed.is_none()).collect();
    let speeds = || {
        let peers = peers.iter().filter(|run| run.is_collapse_of(Rain::default().grains));
        good.iter().map(|point| point.speed).chain(peers.map(PeerRun::speed))
    };
    let slowest = speeds().fold(f64::INFINITY, f64::min).min(1.0);
    let fastest = speeds().fold(0.0, f64::max).max(10.0 * slowest);
    let mut charts = Vec::new();
    for (panel, title) in ["against the same Δt", "against Δt = 10⁻⁴ s"].into_iter().enumerate()
    {
        let mut chart = Chart::new(
            format!("Error of the slump {title}"),
            Axis::log("simulated seconds per second", 0.7 * slowest, 1.5 * fastest),
            Axis::log("mean error of Δy_G", LEAST_ERROR, 1.0),
        );
        if panel == 0 {
            let line = [0.7 * slowest, 1.5 * fastest].map(|x| (x, floor.max(LEAST_ERROR)));
            let grey = (130, 130, 130);
            chart.layers.push(Layer::curve(
                "two references\nfrom each other",
                points(line),
                grey,
                Look::Dashes(2),
            ));
        }
        let places: Vec<(f64, f64)> =
            good.iter().map(|point| (point.speed, point.errors[panel].max(LEAST_ERROR))).collect();
        // Below the floor no error is better than another.
        let honest: Vec<_> = places.iter().map(|&(x, y)| (x, y.max(floor))).collect();
        let front = pareto_front(&honest).into_iter().map(|index| honest[index]);
        chart.layers.push(Layer::curve("Pareto front", points(front), INK, Look::Line(1)));
        for entrant in entrants::all() {
            let is_its = |point: &Charted| plan.efforts[point.effort].0.method == entrant.method;
            let of_method = || charted.iter().filter(|point| is_its(point));
            let failed = of_method().filter(|point| point.failed.is_some()).count();
            let told = match failed {
                0 => entrant.name.clone(),
                failed => format!("{}\n{failed} of {} failed", entrant.name, of_method().count()),
            };
            let mut in_legend = panel == 1;
            for (size, time_step_secs) in plan.time_steps_secs.iter().enumerate() {
                let here = good
                    .iter()
                    .zip(&places)
                    .filter(|(point, _)| is_its(point) && point.time_step_secs == *time_step_secs);
                let layer = points(here.map(|(_, place)| *place));
                let look = dots(entrant.look, 4 + 2 * size as u32);
                let make = if in_legend { Layer::curve } else { Layer::quiet };
                in_legend = false;
                chart.layers.push(make(told.clone(), layer, colour(entrant.look), look));
            }
        }
        if panel == 1 {
            chart.layers.extend(peer_layers(plan, peers, references));
        }
        charts.push(chart);
    }
    let legend = Chart::legend_of(&mut charts, 0.36);
    charts.push(legend);
    let sheet = Sheet {
        size: (1900, 820),
        charts,
        caption: bench.caption(&[&format!(
            "A point for each method, effort and Δt (the larger the dot, the larger: {}); means over {} piles of 138 grains.",
            said(plan.time_steps_secs.iter().map(|step| format!("{step:e} s"))),
            plan.piles.len()
        )]),
    };
    let told = told(plan, charted, floor);
    let tables = vec![("chart-simulation-points".into(), table(plan, charted))];
    Part { name: "chart-simulation".into(), sheet, report: told, tables }
}

fn said(words: impl Iterator<Item = String>) -> String {
    words.collect::<Vec<_>>().join(", ")
}

/// Runs of other engines from the shared state without cohesion, against the reference for it.
fn peer_layers(plan: &Plan, peers: &[PeerRun], references: &References) -> Vec<Layer> {
    let shared = (0.0, Rain::default().seed);
    let Some(pile) = plan.piles.iter().position(|pile| *pile == shared) else { return Vec::new() };
    let reference = references[&(FINEST_SECS.to_bits(), pile)];
    let mut by_engine: BTreeMap<&str, Vec<(f64, f64)>> = BTreeMap::new();
    for run in peers.iter().filter(|run| run.is_collapse_of(Rain::default().grains)) {
        let error = (run.slump - reference).abs().max(LEAST_ERROR);
        by_engine.entry(&run.engine).or_default().push((run.speed(), error));
    }
    let layers = by_engine.into_iter().enumerate().map(|(index, (engine, places))| {
        let name = format!("{engine},\nBond 0 alone");
        Layer::curve(name, points(places), peers::colour(index), Look::Rings(9))
    });
    layers.collect()
}

fn told(plan: &Plan, charted: &[Charted], floor: f64) -> String {
    let mut lines = vec![
        format!(
            "Two references at the same Δt, solved to residuals of {:e} and {:e}, differ by {floor:.4} in the \
             mean: no smaller error means anything. Runs that take more than {} s a simulated second are \
             given up as too slow. Every time is the least of {}.",
            REFERENCE[0],
            REFERENCE[1],
            plan.limit_secs,
            if plan.repeats == 1 { "1 run".into() } else { format!("{} runs", plan.repeats) }
        ),
        "\n| method | Δt, s | effort | simulated s per s | error, same Δt | error, finest Δt | verdicts agreed |\n|---|---|---|---|---|---|---|".into(),
    ];
    for point in charted {
        let (entrant, effort, _) = &plan.efforts[point.effort];
        let (name, step) = (&entrant.name, point.time_step_secs);
        lines.push(match point.failed {
            Some(why) => format!("| {name} | {step:e} | {effort} | {why} | | | |"),
            None => format!(
                "| {name} | {step:e} | {effort} | {:.2} | {:.4} | {:.4} | {:.0} % |",
                point.speed,
                point.errors[0],
                point.errors[1],
                100.0 * point.verdicts
            ),
        });
    }
    lines.join("\n")
}

fn table(plan: &Plan, charted: &[Charted]) -> String {
    let mut text = String::from(
        "method,time_step_secs,effort,failed,simulated_secs_per_sec,error_same_step,error_finest_step,\
         verdicts_agreed,mean_overlap,unconverged_steps,steps\n",
    );
    for point in charted {
        let (entrant, effort, _) = &plan.efforts[point.effort];
        let runs = || point.runs.iter().flatten();
        let overlap = mean(&runs().map(|run| run.mean_overlap).collect::<Vec<_>>()).mean;
        let sum = |number: fn(&TimedRun) -> u64| runs().map(number).sum::<u64>();
        let numbers = match point.failed {
            Some(why) => format!("{why},,,,,,,"),
            None => format!(
                ",{},{},{},{},{overlap},{},{}",
                point.speed,
                point.errors[0],
                point.errors[1],
                point.verdicts,
                sum(|run| run.unconverged_steps),
                sum(|run| run.steps)
            ),
        };
        text.push_str(&format!(
            "{},{:e},{},{numbers}\n",
            entrant.name, point.time_step_secs, effort
        ));
    }
    text
}
