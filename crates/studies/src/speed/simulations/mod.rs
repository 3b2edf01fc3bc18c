//! Speed against accuracy of whole simulations: what a pile's slump is off by, and how many seconds
//! are simulated in one. Steps have the restitution threshold with which nearly all of them have a solution.
//!
//! Against the reference *at the same Δt* a slump is off by what the solver left undone; against the
//! reference at the finest Δt also by the time step. Piles are chaotic: two references, one solved ten times
//! tighter, differ by the *floor*, below which no error means anything. `range` has references of its own.

mod report;

use std::ops::ControlFlow;
use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::performance::pareto_front;
use super::variants::{self, ChartedVariant};
use super::{Bench, ChartSection, listed};
use crate::chart::{Axis, Chart, INK, Layer, Look, Rgb, Sheet, points};
use crate::config::{Config, SceneSource};
use crate::error::{Error, Result};
use crate::number;
use crate::output::Progress;
use crate::runner::{Case, Runner, Threads};
use crate::scene::{Deposition, NewPile, Scene};
use crate::sim::{RunEnding, Stepper, Tally};
use crate::solver::{Method, SolverSettings, StopTest};
use crate::states::States;
use crate::statistics::mean;
use crate::world::ParameterChanges;

/// A step gets no more sweeps: one without a solution must not take for ever.
const MOST_SWEEPS: u32 = 5_000;
/// Contacts slower than this many g·Δt do not bounce.
const THRESHOLD: f64 = 2.0;
/// Piles of 2,000 grains.
const LARGE: NewPile =
    NewPile { grains: 2_000, box_width_in_diameters: 60.0, seed: 1, deposition: Deposition::Rain };
/// A pile that slumps less than this holds.
const HOLDS: f64 = 0.1;
/// The law under which the floor is measured.
const FLOOR_LAW: Stepper = Stepper::Moreau;
/// Steps between two looks at the clock.
const STEPS_PER_LOOK: u64 = 16;
/// What disturbs a run that takes longer, s, averages out within it.
const LONG_ENOUGH_SECS: f64 = 2.0;
/// Errors below this are drawn here.
const LEAST_ERROR: f64 = 1e-3;
const GREY: Rgb = (130, 130, 130);

pub(super) fn make(bench: &Bench) -> Result<Vec<ChartSection>> {
    let quick = bench.options.quick;
    let mut plans = vec![SimulationPlan::of_paper(quick)];
    plans.extend(bench.options.large.then(|| SimulationPlan::of_large(quick)));
    plans.iter().map(|plan| section(bench, plan)).collect()
}

fn section(bench: &Bench, plan: &SimulationPlan) -> Result<ChartSection> {
    let configs: Vec<_> =
        (0..plan.piles.len()).map(|pile| plan.config(pile, plan.finest_secs, FLOOR_LAW)).collect();
    let states = States::of(bench.states_folder(), configs.iter())?;
    let runner = bench.runner(&format!("simulations{}", plan.label))?;
    let references = References::run(plan, &states, &runner)?;
    let simulated = run_all(plan, &states, &runner, &references)?;
    let name = format!("chart-simulation{}", plan.label);
    Ok(ChartSection {
        sheet: report::sheet(bench, plan, &simulated, &references),
        report: report::report(plan, &simulated, &references),
        tables: vec![(format!("{name}-points"), report::table(plan, &simulated))],
        name,
    })
}

/// A variant with its budget: how well it is to solve its steps.
struct BudgetedVariant {
    /// Number in `SimulationPlan::variants`.
    variant: usize,
    /// Whose references it is held against.
    law: Stepper,
    /// The budget in words.
    budget: String,
    solver: SolverSettings,
    /// Of a stepper without a method; its own number where this is 0.
    substeps: u32,
}

/// The budgets that each variant is tried with.
struct Budgets {
    residuals: Vec<f64>,
    sweeps: Vec<u32>,
    substeps: Vec<u32>,
}

/// What is simulated.
struct SimulationPlan {
    /// In the names of files.
    label: &'static str,
    time_steps_secs: Vec<f64>,
    /// What the piles are made as; each has a seed of its own.
    made_as: NewPile,
    /// Simulated time of a run, s.
    duration_secs: f64,
    /// (Bond, seed) of each pile.
    piles: Vec<(f64, u64)>,
    variants: Vec<ChartedVariant>,
    budgeted: Vec<BudgetedVariant>,
    /// Laws that have references.
    laws: Vec<Stepper>,
    /// Δt of the reference with the least error of the time step, s.
    finest_secs: f64,
    /// How the references are solved.
    reference: ChartedVariant,
    /// Residual of the references, and of those that show the floor.
    tolerances: [f64; 2],
    /// How often a run is timed.
    repeats: u32,
    /// Wall time that a simulated second may take, s.
    limit_secs: f64,
}

impl SimulationPlan {
    /// The paper's 138 grains. What the law range costs is told by one good method, and by long runs.
    fn of_paper(quick: bool) -> Self {
        let laws =
            if quick { vec![Stepper::Moreau] } else { vec![Stepper::Moreau, Stepper::Range] };
        let budgets = if quick {
            Budgets { residuals: vec![1e-2, 1e-4, 1e-6], sweeps: vec![20], substeps: vec![0] }
        } else {
            Budgets {
                residuals: vec![1e-1, 1e-2, 1e-4, 1e-6, 1e-8],
                sweeps: vec![10, 40],
                substeps: vec![0, 16, 64],
            }
        };
        let (variants, budgeted) = budgeted(&laws, &budgets);
        Self {
            label: "",
            time_steps_secs: if quick { vec![1e-3, 5e-3] } else { vec![1e-3, 2e-3, 5e-3] },
            made_as: NewPile::default(),
            duration_secs: 1.0,
            piles: paper_piles(quick),
            variants,
            budgeted,
            laws,
            finest_secs: 1e-4,
            reference: variants::of_method(Method::Newton),
            tolerances: [1e-8, 1e-9],
            repeats: if quick { 1 } else { 2 },
            limit_secs: if quick { 0.8 } else { 10.0 },
        }
    }

    /// 2,000 grains. Coulomb's law is not solved there, so that the references are certified under the bounds of
    /// friction that piles do not tell from it. A quick pass has no time for rain.
    fn of_large(quick: bool) -> Self {
        let laws = vec![Stepper::Moreau];
        let residuals = if quick { vec![1e-2] } else { vec![1e-2, 1e-4] };
        let budgets = Budgets { residuals, sweeps: vec![40], substeps: vec![0] };
        let (variants, budgeted) = budgeted(&laws, &budgets);
        let bonds: &[f64] = if quick { &[0.0, 20.0] } else { &[0.0, 20.0, 50.0] };
        let deposition = if quick { Deposition::DropAndRoll } else { LARGE.deposition };
        Self {
            label: "-large",
            time_steps_secs: if quick { vec![2e-3, 5e-3] } else { vec![1e-3, 5e-3] },
            made_as: NewPile { deposition, ..LARGE },
            duration_secs: if quick { 0.2 } else { 1.0 },
            piles: bonds.iter().map(|&bond| (bond, LARGE.seed)).collect(),
            variants,
            budgeted,
            laws,
            finest_secs: if quick { 2e-3 } else { 1e-3 },
            reference: variants::certified(),
            tolerances: [1e-8, 1e-7],
            repeats: 1,
            limit_secs: if quick { 15.0 } else { 60.0 },
        }
    }

    /// A pile at a time step under a law.
    fn config(&self, pile: usize, time_step_secs: f64, law: Stepper) -> Config {
        let (bond, seed) = self.piles[pile];
        let parameters = ParameterChanges {
            bond: Some(bond),
            time_step_secs: Some(time_step_secs),
            restitution_threshold: Some(THRESHOLD),
            ..ParameterChanges::default()
        };
        let source = SceneSource {
            grains: Some(self.made_as.grains),
            box_width: Some(self.made_as.box_width_in_diameters),
            deposition: Some(self.made_as.deposition),
            seed: Some(seed),
            duration: Some(self.duration_secs),
            ..SceneSource::default()
        };
        Config { source, stepper: Some(law), parameters, ..Config::default() }
    }
}

/// All variants with all their budgets.
fn budgeted(laws: &[Stepper], budgets: &Budgets) -> (Vec<ChartedVariant>, Vec<BudgetedVariant>) {
    let (mut variants, mut budgeted) = (Vec::new(), Vec::new());
    let of_law = |law| variants::all().into_iter().map(move |variant| (law, variant));
    let models = variants::models().into_iter().map(|model| (Stepper::Moreau, model));
    for (law, mut variant) in laws.iter().copied().flat_map(of_law).chain(models) {
        if law == Stepper::Range {
            if variant.method() != Some(Method::Newton) {
                continue;
            }
            variant.stepper = law;
            variant.name.push_str(" (range)");
            variant.look += variants::looks();
        }
        let number = variants.len();
        let mut add = |budget: String, solver, substeps| {
            budgeted.push(BudgetedVariant { variant: number, law, budget, solver, substeps });
        };
        if variant.method().is_some() {
            for &tolerance in &budgets.residuals {
                let solver = variant.to_residual(tolerance, MOST_SWEEPS);
                add(format!("residual {tolerance:e}"), solver, 0);
            }
            for &count in budgets.sweeps.iter().filter(|_| law == Stepper::Moreau) {
                add(format!("{count} sweeps"), variant.sweeps(count), 0);
            }
        } else {
            for &count in &budgets.substeps {
                let budget = match count {
                    0 => "its own substeps".to_owned(),
                    count => format!("{count} substeps"),
                };
                add(budget, variant.sweeps(1), count);
            }
        }
        variants.push(variant);
    }
    (variants, budgeted)
}

/// (Bond, seed) of each pile of 138 grains. Bond numbers are dealt out to the seeds: each is met by several, and each
/// meets several.
fn paper_piles(quick: bool) -> Vec<(f64, u64)> {
    let shared = NewPile::default().seed;
    if quick {
        return vec![(0.0, shared), (20.0, 1), (50.0, 2), (100.0, 3)];
    }
    let bonds = [[0.0, 50.0], [20.0, 100.0]];
    let seeds = [shared, 1, 2, 3, 4, 5];
    let of = |(index, seed): (usize, u64)| bonds[index % 2].map(|bond| (bond, seed));
    seeds.into_iter().enumerate().flat_map(of).collect()
}

/// How a timed run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum TimedEnding {
    /// At its full duration.
    Done,
    /// It took longer than it was given.
    TooSlow,
    /// Its state was no longer finite.
    NotFinite,
}

/// One timed run.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct TimedRun {
    ending: TimedEnding,
    /// Least of its repeats, s.
    least_secs: f64,
    simulated_secs: f64,
    steps: u64,
    unconverged_steps: u64,
    /// Δy_G at the end.
    #[serde(with = "number")]
    slump: f64,
    /// Mean over the steps, in diameters.
    #[serde(with = "number")]
    mean_overlap: f64,
}

/// Runs a scene to its end, `repeats` times for the least time, unless it takes more than `limit_secs` of the wall's
/// time. A run that takes longer than [`LONG_ENOUGH_SECS`] is not repeated. A state that is no longer finite is an
/// ending.
fn timed_run(scene: &Scene, repeats: u32, limit_secs: f64) -> Result<TimedRun> {
    let mut run = timed_once(scene, limit_secs)?;
    for _ in 1..repeats {
        if run.ending != TimedEnding::Done || run.least_secs > LONG_ENOUGH_SECS {
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
    let ending = match ended {
        RunEnding::Done => TimedEnding::Done,
        RunEnding::Stopped => TimedEnding::TooSlow,
        RunEnding::NotFinite(_) => {
            tally.add(simulation.observables());
            TimedEnding::NotFinite
        }
    };
    Ok(TimedRun {
        ending,
        least_secs: started.elapsed().as_secs_f64(),
        simulated_secs: simulation.time_secs(),
        steps: tally.steps,
        unconverged_steps: tally.unconverged_steps,
        slump: simulation.observables().slump,
        mean_overlap: tally.mean_overlap,
    })
}

/// Tells a reference from the others.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ReferenceCase {
    law: Stepper,
    time_step_secs: f64,
    /// Number in `SimulationPlan::piles`.
    pile: usize,
    /// Number in `SimulationPlan::tolerances`.
    tolerance: usize,
}

/// The references, and those that show the floor.
struct References(Vec<(ReferenceCase, TimedRun)>);

impl References {
    /// All references of a plan. The floor is that of the charted Δt alone.
    fn cases(plan: &SimulationPlan) -> Vec<ReferenceCase> {
        let mut cases = Vec::new();
        let is_charted = plan.time_steps_secs.contains(&plan.finest_secs);
        let finest = std::iter::once(plan.finest_secs).filter(|_| !is_charted);
        let steps: Vec<f64> = finest.chain(plan.time_steps_secs.iter().copied()).collect();
        for &law in &plan.laws {
            for &time_step_secs in &steps {
                let has_floor = law == FLOOR_LAW && plan.time_steps_secs.contains(&time_step_secs);
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
            let ((bond, seed), tolerance) = (plan.piles[pile], plan.tolerances[tolerance]);
            let key = format!(
                "reference {tolerance:e}, law {law}, Bond {bond}, seed {seed}, dt {time_step_secs:e}"
            );
            Case { key, cost: 1.0, setup }
        };
        let cases: Vec<_> = Self::cases(plan).into_iter().map(case).collect();
        let runs = runner.run(&cases, Threads::All, |case| {
            let ReferenceCase { law, time_step_secs, pile, tolerance } = *case;
            let mut scene = states.scene(&plan.config(pile, time_step_secs, law))?;
            let tolerance = plan.tolerances[tolerance];
            let stop = StopTest::Residual;
            scene.solver = SolverSettings { stop, tolerance, ..plan.reference.solver };
            timed_run(&scene, 1, f64::INFINITY)
        })?;
        if let Some(run) = runs.iter().find(|run| run.result.ending != TimedEnding::Done) {
            return Err(Error::value(&run.key, "not finite", "finite to compare with it"));
        }
        Ok(Self(cases.iter().zip(runs).map(|(case, run)| (case.setup, run.result)).collect()))
    }

    /// Slump of that reference. There is one for every law, Δt and pile of the plan, and at the finest Δt.
    fn slump(&self, wanted: ReferenceCase) -> f64 {
        self.0.iter().find(|(case, _)| *case == wanted).map_or(f64::NAN, |(_, run)| run.slump)
    }

    /// Mean difference between two references, over all piles and the charted Δt.
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

    /// Steps that were not solved as asked, and all steps.
    fn unsolved(&self) -> [u64; 2] {
        let sum = |number: fn(&TimedRun) -> u64| self.0.iter().map(|(_, run)| number(run)).sum();
        [sum(|run| run.unconverged_steps), sum(|run| run.steps)]
    }
}

/// What one variant with one budget at one Δt comes to.
struct SimulatedPoint<'a> {
    variant: &'a BudgetedVariant,
    time_step_secs: f64,
    /// The runs that reached their end, pile by pile.
    runs: Vec<TimedRun>,
    /// Why there is no point, where there is none.
    failed: Option<&'static str>,
    /// Simulated seconds per second.
    speed: f64,
    /// Mean |slump − reference| at the same Δt, and at the finest.
    errors: [f64; 2],
    /// Share of piles about which it says what the reference at the same Δt says: holds or not.
    verdicts: f64,
}

/// Every variant with every budget at every Δt.
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
            let BudgetedVariant { law, budget, solver, substeps, .. } = variant;
            let charted = &plan.variants[variant.variant];
            let (mut runs, mut failed) = (Vec::new(), None);
            for (pile, (bond, seed)) in plan.piles.iter().enumerate() {
                progress.advance(1);
                if failed.is_some() {
                    continue;
                }
                let name = &charted.name;
                let key =
                    format!("{name}, {budget}, Bond {bond}, seed {seed}, dt {time_step_secs:e}");
                let run = runner.result(&key, || {
                    let mut scene = states.scene(&plan.config(pile, time_step_secs, *law))?;
                    (scene.stepper, scene.solver) = (charted.stepper, *solver);
                    scene.parameters.substeps = *substeps;
                    timed_run(&scene, plan.repeats, plan.limit_secs * plan.duration_secs)
                })?;
                failed = match run.result.ending {
                    TimedEnding::Done => None,
                    TimedEnding::TooSlow => Some("too slow"),
                    TimedEnding::NotFinite => Some("not finite"),
                };
                runs.extend(failed.is_none().then_some(run.result));
            }
            simulated.push(summed_up(plan, references, variant, time_step_secs, runs, failed));
        }
    }
    progress.finish();
    Ok(simulated)
}

fn summed_up<'a>(
    plan: &SimulationPlan,
    references: &References,
    variant: &'a BudgetedVariant,
    time_step_secs: f64,
    runs: Vec<TimedRun>,
    failed: Option<&'static str>,
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
        mean(&errors.collect::<Vec<_>>()).mean
    };
    let agree =
        slumps(time_step_secs).filter(|(slump, right)| (*slump < HOLDS) == (*right < HOLDS));
    SimulatedPoint {
        variant,
        time_step_secs,
        failed,
        speed: sum(|run| run.simulated_secs) / sum(|run| run.least_secs),
        errors: [error(time_step_secs), error(plan.finest_secs)],
        verdicts: agree.count() as f64 / runs.len().max(1) as f64,
        runs,
    }
}

#[cfg(test)]
mod tests;
