//! Charts the accuracy of whole simulations against their computing time: the error of a pile's slump against the
//! computing time per simulated second. Contacts whose approach speed is below a threshold do not bounce in these
//! simulations, because nearly all steps then have a solution.
//!
//! The error is the difference to a reference, a simulation whose steps are solved very accurately. The difference to
//! the reference *at the same Δt* is the error of the solver. The difference to the reference at the smallest Δt also
//! includes the error of the time step. Piles are chaotic: two references with different tolerances differ by the
//! *floor*, below which errors have no meaning. Simulations with the stepper `range` have their own references.

mod report;

use std::ops::ControlFlow;
use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::variants::{self, Family};
use super::{Bench, ChartSection, listed};
use crate::chart::{Axis, Chart, Layer, Look, Point, Rgb, Sheet, pareto_front, points};
use crate::config::{Config, SceneSource};
use crate::error::{Error, Result};
use crate::harness::{Case, Change, Effort, Runner, Threads};
use crate::number;
use crate::output::Progress;
use crate::scene::{NewPile, Scene};
use crate::sim::{RunEnding, Stepper, Tally};
use crate::solver::{Method, SolverSettings, StopTest};
use crate::states::States;
use crate::statistics::{Mean, mean};
use crate::world::ParameterChanges;

/// Largest number of sweeps per step in the compared simulations. Without this limit, the solver would never stop in a
/// step that has no solution.
const MOST_SWEEPS: u32 = 5_000;
/// Smallest time step of the reference simulations, s. References with this time step have the smallest error due to
/// the time step.
const FINEST_SECS: f64 = 1e-4;
const DURATION_SECS: f64 = 1.0;
/// Solver method of the reference simulations, with which the other simulations are compared.
const REFERENCE: Method = Method::Newton;
/// Residuals to which the steps of the reference simulations are solved. References with the second residual only serve
/// to measure how much two accurate simulations of a chaotic pile differ; errors below this difference have no meaning.
const TOLERANCES: [f64; 2] = [1e-8, 1e-9];
/// Slump (drop of the mean height divided by the first mean height) below which a pile counts as stable. The value only
/// serves to count how many piles have the same outcome (stable or not) in a simulation and in its reference.
const HOLDS: f64 = 0.1;
/// Stepper, which defines the contact law, of those reference simulations from which the floor is measured. The floor
/// is the difference between two accurate simulations of a chaotic pile; errors below the floor have no meaning.
const FLOOR_LAW: Stepper = Stepper::Moreau;
/// Number of steps of a timed simulation between two checks whether its computing time exceeds the limit.
const STEPS_PER_LOOK: u64 = 16;
/// Computing time of a run, s, above which its timing is not repeated, because disturbances average out within the run.
const LONG_ENOUGH_SECS: f64 = 2.0;
/// Smallest error of the slump on the axis of the chart. Smaller errors are drawn at this value.
const LEAST_ERROR: f64 = 1e-3;
const GREY: Rgb = (130, 130, 130);

pub(super) fn make(bench: &Bench) -> Result<Vec<ChartSection>> {
    let plan = &SimulationPlan::new(bench.effort);
    let configs: Vec<_> =
        (0..plan.piles.len()).map(|pile| plan.config(pile, FINEST_SECS, FLOOR_LAW)).collect();
    let states = States::of(bench.states_folder(), configs.iter())?;
    let runner = bench.runner("simulations")?;
    let references = References::run(plan, &states, &runner)?;
    let simulated = run_all(plan, &states, &runner, &references)?;
    Ok(vec![ChartSection {
        name: "chart-simulation".into(),
        sheet: report::sheet(bench, plan, &simulated, &references),
        words: report::words(plan, &references),
        tables: vec![report::table(&simulated)],
    }])
}

/// A solver variant with a given effort: the residual to which it solves steps, or the number of sweeps or substeps per
/// step.
struct BudgetedVariant {
    charted: Change,
    /// Stepper of the reference simulations with which this variant is compared. The stepper defines the contact law.
    law: Stepper,
    /// Change of the settings that selects the variant and its effort. The name of the change describes the effort.
    change: Change,
}

/// The simulations whose speed and accuracy are measured: piles of 138 grains, as in Abramian & Staron (2020), with all
/// time steps and solver variants.
struct SimulationPlan {
    time_steps_secs: Vec<f64>,
    /// Bond number and seed of each pile.
    piles: Vec<(f64, u64)>,
    budgeted: Vec<BudgetedVariant>,
    laws: Vec<Stepper>,
    repeats: u32,
    /// Limit of the computing time per simulated second, s. Slower runs are stopped.
    limit_secs: f64,
}

impl SimulationPlan {
    /// Returns the plan of a quick pass (a pass with fewer simulations) or of the full pass. The stepper `range` is
    /// only run with Newton's method, and only in the full pass.
    fn new(effort: Effort) -> Self {
        let laws: &[Stepper] = effort.pick(&[Stepper::Moreau], &[Stepper::Moreau, Stepper::Range]);
        Self {
            time_steps_secs: effort.pick(vec![1e-3, 5e-3], vec![1e-3, 2e-3, 5e-3]),
            piles: piles(effort),
            budgeted: budgeted(laws, effort),
            laws: laws.to_vec(),
            repeats: effort.pick(1, 2),
            limit_secs: effort.pick(2.0, 10.0),
        }
    }

    fn config(&self, pile: usize, time_step_secs: f64, law: Stepper) -> Config {
        let ((bond, seed), made_as) = (self.piles[pile], NewPile::default());
        let parameters = ParameterChanges {
            bond: Some(bond),
            time_step_secs: Some(time_step_secs),
            ..ParameterChanges::default()
        };
        let source = SceneSource {
            grains: Some(made_as.grains),
            box_width: Some(made_as.box_width_in_diameters),
            deposition: Some(made_as.deposition),
            seed: Some(seed),
            duration: Some(DURATION_SECS),
            ..SceneSource::default()
        };
        Config { source, stepper: Some(law), parameters, ..Config::default() }
    }
}

fn budgeted(laws: &[Stepper], effort: Effort) -> Vec<BudgetedVariant> {
    let residuals: &[f64] = effort.pick(&[1e-2, 1e-4, 1e-6], &[1e-1, 1e-2, 1e-4, 1e-6, 1e-8]);
    let sweeps: &[u32] = effort.pick(&[20], &[10, 40]);
    let all_substeps: &[u32] = effort.pick(&[0], &[0, 16, 64]);
    let mut budgeted = Vec::new();
    let of_law = |law| variants::all().into_iter().map(move |variant| (law, variant));
    let models = variants::models().into_iter().map(|model| (Stepper::Moreau, model));
    for (law, mut variant) in laws.iter().copied().flat_map(of_law).chain(models) {
        if law == Stepper::Range {
            if variant.method() != Some(Method::Newton) {
                continue;
            }
            variant.config.stepper = Some(law);
            variant.name.push_str(" (range)");
        }
        let mut add = |budget: String, solver: SolverSettings, substeps: u32| {
            let mut change = Change::of_solver(budget, variant.stepper(), &solver);
            change.config.parameters.substeps = Some(substeps);
            budgeted.push(BudgetedVariant { charted: variant.clone(), law, change });
        };
        if variant.is_default() {
            add("its own effort".to_owned(), variant.solver(), 0);
        } else if variant.method().is_some() {
            for &tolerance in residuals {
                let solver = variant.to_residual(tolerance, MOST_SWEEPS);
                add(format!("residual {tolerance:e}"), solver, 0);
            }
            for &count in sweeps.iter().filter(|_| law == Stepper::Moreau) {
                add(format!("{count} sweeps"), variant.sweeps(count), 0);
            }
        } else {
            for &count in all_substeps {
                let budget = match count {
                    0 => "its own substeps".to_owned(),
                    count => format!("{count} substeps"),
                };
                add(budget, variant.sweeps(1), count);
            }
        }
    }
    budgeted
}

/// Returns the Bond number and the seed of each simulated pile. In a quick pass (a pass with fewer simulations) there
/// are four piles. In the full pass, every Bond number occurs with several seeds, and every seed with several Bond
/// numbers.
fn piles(effort: Effort) -> Vec<(f64, u64)> {
    let shared = NewPile::default().seed;
    if effort == Effort::Quick {
        return vec![(0.0, shared), (20.0, 1), (50.0, 2), (100.0, 3)];
    }
    let bonds = [[0.0, 50.0], [20.0, 100.0]];
    let seeds = [shared, 1, 2, 3, 4, 5];
    let of = |(index, seed): (usize, u64)| bonds[index % 2].map(|bond| (bond, seed));
    seeds.into_iter().enumerate().flat_map(of).collect()
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct TimedRun {
    /// Reason why the run did not reach its end, in words; `None` if it reached its end.
    failed: Option<String>,
    /// Computing time of the run, s: the shortest among its repetitions.
    least_secs: f64,
    simulated_secs: f64,
    steps: u64,
    unconverged_steps: u64,
    /// Slump Δy_G at the end of the run: the drop of the mean height of the grains, divided by the first mean height.
    #[serde(with = "number")]
    slump: f64,
    /// Mean overlap of touching grains, averaged over the steps, in mean diameters.
    #[serde(with = "number")]
    mean_overlap: f64,
}

/// Runs a scene to its end `repeats` times, and returns its results with the shortest computing time. A run that takes
/// more than `limit_secs` is stopped and counts as failed. A run that takes longer than [`LONG_ENOUGH_SECS`] is not
/// repeated. If positions become NaN or infinite, the run counts as failed, and the function does not return an error.
fn timed_run(scene: &Scene, repeats: u32, limit_secs: f64) -> Result<TimedRun> {
    let mut run = timed_once(scene, limit_secs)?;
    for _ in 1..repeats {
        if run.failed.is_some() || run.least_secs > LONG_ENOUGH_SECS {
            break;
        }
        run.least_secs = run.least_secs.min(timed_once(scene, limit_secs)?.least_secs);
    }
    Ok(run)
}

fn timed_once(scene: &Scene, limit_secs: f64) -> Result<TimedRun> {
    let mut simulation = scene.simulation()?;
    let steps = scene.parameters.steps_in(scene.duration_secs);
    let mut tally = Tally::default();
    let started = Instant::now();
    let ended = simulation.run(steps, |simulation| {
        tally.add(simulation.observables());
        let looks = tally.steps % STEPS_PER_LOOK == 0 && tally.steps < steps;
        let is_over = looks && started.elapsed().as_secs_f64() > limit_secs;
        Ok(if is_over { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    })?;
    let failed = match ended {
        RunEnding::Done => None,
        RunEnding::Stopped => Some("too slow".to_owned()),
        RunEnding::NotFinite(_) => {
            tally.add(simulation.observables());
            Some("not finite".to_owned())
        }
    };
    Ok(TimedRun {
        failed,
        least_secs: started.elapsed().as_secs_f64(),
        simulated_secs: simulation.time_secs(),
        steps: tally.steps,
        unconverged_steps: tally.unconverged_steps,
        slump: simulation.observables().slump,
        mean_overlap: tally.mean_overlap,
    })
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct ReferenceCase {
    law: Stepper,
    time_step_secs: f64,
    /// Index of the simulated pile in `SimulationPlan::piles`.
    pile: usize,
    /// Index of the solver's tolerance in [`TOLERANCES`].
    tolerance: usize,
}

/// All reference simulations, whose steps are solved very accurately, and their results. Some of them only serve to
/// measure the difference between two references (the floor).
struct References(Vec<(ReferenceCase, TimedRun)>);

impl References {
    /// Returns all reference simulations to compute. They are solved to the first residual of [`TOLERANCES`]. At the
    /// time steps on the chart, the references with the contact law [`FLOOR_LAW`] are also solved to the second
    /// residual, to measure how much two accurate simulations differ (the floor).
    fn cases(plan: &SimulationPlan) -> Vec<ReferenceCase> {
        let mut cases = Vec::new();
        for &law in &plan.laws {
            for &time_step_secs in [FINEST_SECS].iter().chain(&plan.time_steps_secs) {
                let has_floor = law == FLOOR_LAW && time_step_secs != FINEST_SECS;
                for pile in 0..plan.piles.len() {
                    let of = |tolerance| ReferenceCase { law, time_step_secs, pile, tolerance };
                    cases.extend((0..if has_floor { 2 } else { 1 }).map(of));
                }
            }
        }
        cases
    }

    fn run(plan: &SimulationPlan, states: &States, runner: &Runner<TimedRun>) -> Result<Self> {
        let case = |setup: ReferenceCase| {
            let ReferenceCase { law, time_step_secs, pile, tolerance } = setup;
            let ((bond, seed), tolerance) = (plan.piles[pile], TOLERANCES[tolerance]);
            let key = format!(
                "reference {tolerance:e}, law {law}, Bond {bond}, seed {seed}, dt {time_step_secs:e}"
            );
            Case { key, cost: 1.0, setup }
        };
        let cases: Vec<_> = Self::cases(plan).into_iter().map(case).collect();
        let runs = runner.run(&cases, Threads::All, |case| {
            let ReferenceCase { law, time_step_secs, pile, tolerance } = *case;
            let mut scene = states.scene(&plan.config(pile, time_step_secs, law))?;
            let tolerance = TOLERANCES[tolerance];
            let (method, stop) = (REFERENCE, StopTest::Residual);
            scene.solver = SolverSettings { method, stop, tolerance, ..SolverSettings::SWEEPS };
            timed_run(&scene, 1, f64::INFINITY)
        })?;
        if let Some(run) = runs.iter().find(|run| run.result.failed.is_some()) {
            return Err(Error::value(&run.key, "not finite", "finite to compare with it"));
        }
        Ok(Self(cases.iter().zip(runs).map(|(case, run)| (case.setup, run.result)).collect()))
    }

    /// Returns the slump in the reference simulation `wanted`. There are references for every contact law, every pile,
    /// every time step of the chart, and the smallest time step.
    fn slump(&self, wanted: ReferenceCase) -> f64 {
        self.0.iter().find(|(case, _)| *case == wanted).map_or(f64::NAN, |(_, run)| run.slump)
    }

    /// Returns the floor, below which errors of the slump have no meaning: the mean size of the difference of the slump
    /// between two reference simulations with different tolerances, over all piles and the time steps on the chart.
    fn floor(&self, plan: &SimulationPlan) -> f64 {
        let mut differences = Vec::new();
        for &time_step_secs in &plan.time_steps_secs {
            for pile in 0..plan.piles.len() {
                let of =
                    |tolerance| ReferenceCase { law: FLOOR_LAW, time_step_secs, pile, tolerance };
                differences.push((self.slump(of(0)) - self.slump(of(1))).abs());
            }
        }
        mean(&differences).mean
    }

    /// Returns the number of steps of the reference simulations that were not solved to their tolerance, and the number
    /// of all their steps.
    fn unsolved(&self) -> [u64; 2] {
        let sum = |number: fn(&TimedRun) -> u64| self.0.iter().map(|(_, run)| number(run)).sum();
        [sum(|run| run.unconverged_steps), sum(|run| run.steps)]
    }
}

/// Results of one solver variant with one effort (residual, or number of sweeps) at one time step, over all piles: a
/// point of the chart.
struct SimulatedPoint<'a> {
    variant: &'a BudgetedVariant,
    time_step_secs: f64,
    /// Runs that reached their end, one per pile, in the order of the piles. After the first failed run, no further
    /// pile is run.
    runs: Vec<TimedRun>,
    failed: Option<String>,
    speed: f64,
    /// Mean over the piles of |slump − slump of the reference simulation|, first with the reference at the same time
    /// step, then with the reference at the smallest time step.
    errors: [Mean; 2],
    /// Fraction of the piles that have the same outcome (stable or not) as in the reference simulation at the same time
    /// step.
    verdicts: f64,
}

fn run_all<'a>(
    plan: &'a SimulationPlan,
    states: &States,
    runner: &Runner<TimedRun>,
    references: &References,
) -> Result<Vec<SimulatedPoint<'a>>> {
    let points = plan.time_steps_secs.len() * plan.budgeted.len();
    let progress = Progress::new("simulations", (points * plan.piles.len()) as u64);
    let mut simulated = Vec::with_capacity(points);
    for &time_step_secs in &plan.time_steps_secs {
        for variant in &plan.budgeted {
            let BudgetedVariant { charted, law, change } = variant;
            let (mut runs, mut failed) = (Vec::new(), None);
            for (pile, (bond, seed)) in plan.piles.iter().enumerate() {
                progress.advance(1);
                if failed.is_some() {
                    continue;
                }
                let (name, budget) = (&charted.name, &change.name);
                let key =
                    format!("{name}, {budget}, Bond {bond}, seed {seed}, dt {time_step_secs:e}");
                let run = runner.result(&key, || {
                    let mut scene = states.scene(&plan.config(pile, time_step_secs, *law))?;
                    change.apply(&mut scene);
                    timed_run(&scene, plan.repeats, plan.limit_secs * DURATION_SECS)
                })?;
                failed = run.result.failed.clone();
                runs.extend(failed.is_none().then_some(run.result));
            }
            simulated.push(summed_up(references, variant, time_step_secs, runs, failed));
        }
    }
    progress.finish();
    Ok(simulated)
}

fn summed_up<'a>(
    references: &References,
    variant: &'a BudgetedVariant,
    time_step_secs: f64,
    runs: Vec<TimedRun>,
    failed: Option<String>,
) -> SimulatedPoint<'a> {
    let sum = |number: fn(&TimedRun) -> f64| runs.iter().map(number).sum::<f64>();
    let (law, tolerance) = (variant.law, 0);
    let slumps = |time_step_secs: f64| {
        runs.iter().enumerate().map(move |(pile, run)| {
            let of = ReferenceCase { law, time_step_secs, pile, tolerance };
            (run.slump, references.slump(of))
        })
    };
    let error = |time_step_secs| {
        let errors = slumps(time_step_secs).map(|(slump, reference)| (slump - reference).abs());
        mean(&errors.collect::<Vec<_>>())
    };
    let agree =
        slumps(time_step_secs).filter(|(slump, right)| (*slump < HOLDS) == (*right < HOLDS));
    SimulatedPoint {
        variant,
        time_step_secs,
        failed,
        speed: sum(|run| run.simulated_secs) / sum(|run| run.least_secs),
        errors: [error(time_step_secs), error(FINEST_SECS)],
        verdicts: agree.count() as f64 / runs.len().max(1) as f64,
        runs,
    }
}

#[cfg(test)]
mod tests;
