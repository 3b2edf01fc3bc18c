//! Solves of single steps against the clock: how long a solver variant takes from goal to goal.

use std::time::Instant;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::Bench;
use super::collection::{CollectionPlan, collect};
use super::performance::Timing;
use super::variants::ChartedVariant;
use crate::contact::ContactList;
use crate::error::Result;
use crate::number;
use crate::runner::{Case, Runner, Threads};
use crate::sim::{ProblemVisitor, Simulation};
use crate::solver::{Measures, Memory, Model, SolverSettings, StepProblem, measure, solve};

/// Least number of solves that a time is the minimum of.
pub(super) const LEAST_REPEATS: usize = 5;
/// Short solves are repeated more often, up to this sum of times, s, or [`MOST_REPEATS`].
const ENOUGH_SECS: f64 = 2e-3;
/// See [`ENOUGH_SECS`].
const MOST_REPEATS: usize = 12;
/// A solve that takes longer is not repeated, s: what disturbs it averages out.
pub(super) const LONG_SOLVE_SECS: f64 = 0.3;
/// A method's own residual may differ from the one measured here by rounding.
pub(super) const ROUNDING: f64 = 1e-6;
/// Most sweeps of a solve, whatever its time.
pub(super) const MOST_SWEEPS: u32 = 200_000;
/// Sweeps of the first try of how long they take.
const FIRST_SWEEPS: u32 = 16;
/// Share of the time limit from which on a try shows how many sweeps fit into the limit.
const LONG_TRY: f64 = 0.125;

/// A goal that was reached.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct ReachedGoal {
    /// What was asked for.
    pub goal: f64,
    /// Least time of a solve, s.
    pub solve_secs: f64,
    /// What the solve came to: the natural map of what was solved.
    pub left: f64,
    /// The duality gap, where there is one.
    pub duality_gap: Option<f64>,
}

/// The solves of one step by one variant.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct TimedSolves {
    /// Contacts of the step.
    pub contacts: usize,
    /// Natural map of the start, with the impulses of the step before.
    #[serde(with = "number")]
    pub start: f64,
    /// Smallest natural map of any of the solves.
    #[serde(with = "number")]
    pub smallest: f64,
    /// By falling goal.
    pub reached: Vec<ReachedGoal>,
    /// How long the solve took that did not reach its goal in time, s.
    pub gave_up_secs: Option<f64>,
}

impl TimedSolves {
    /// The goal, if it was reached.
    pub(super) fn reached(&self, goal: f64) -> Option<&ReachedGoal> {
        self.reached.iter().find(|reached| reached.goal == goal)
    }

    /// The time to one of the goals.
    pub(super) fn timing(&self, goal: f64) -> Timing {
        match self.reached(goal) {
            Some(reached) => Timing { secs: reached.solve_secs, solved: true },
            None => Timing { secs: self.gave_up_secs.unwrap_or(f64::INFINITY), solved: false },
        }
    }
}

/// The simulation with other settings of the solver.
///
/// # Errors
/// Where the settings do not fit the simulation.
pub(super) fn solved_by(simulation: &Simulation, solver: SolverSettings) -> Result<Simulation> {
    let mut simulation = simulation.clone();
    simulation.set_solver(solver)?;
    Ok(simulation)
}

/// Times every variant on every step of a collection, one after the other, but for what the runner's journal has:
/// results by variant, then by step.
///
/// # Errors
/// Those of `time`, and where a collection or the journal cannot be made.
pub(super) fn time_collection<T>(
    bench: &Bench,
    runner: &Runner<T>,
    plan: &CollectionPlan,
    variants: &[ChartedVariant],
    time: impl Fn(&Simulation, &ChartedVariant) -> Result<T> + Sync,
) -> Result<Vec<Vec<T>>>
where
    T: Clone + Send + Sync + Serialize + DeserializeOwned,
{
    let cases: Vec<Case<(usize, &ChartedVariant)>> = plan
        .names()
        .iter()
        .enumerate()
        .flat_map(|(step, name)| {
            variants.iter().map(move |variant| {
                let key = format!("{name}, {}", variant.name);
                Case { key, cost: 1.0, setup: (step, variant) }
            })
        })
        .collect();
    let steps = if cases.iter().all(|case| runner.has(&case.key)) {
        Vec::new()
    } else {
        collect(plan, &bench.states_folder())?
    };
    let results =
        runner.run(&cases, Threads::One, |&(step, variant)| time(&steps[step], variant))?;
    let mut by_variant: Vec<Vec<T>> = variants.iter().map(|_| Vec::new()).collect();
    for (index, case) in results.into_iter().enumerate() {
        by_variant[index % variants.len()].push(case.result);
    }
    Ok(by_variant)
}

/// Times the solves of one step from goal to goal, each from the same start, until one is not reached in time. Copies
/// of the problem are made outside of the clock.
pub(super) struct SolveTimer<'a> {
    pub variant: &'a ChartedVariant,
    /// Natural maps to reach, falling.
    pub goals: &'a [f64],
    /// Most time of a solve, s.
    pub limit_secs: f64,
    /// Whether orders and memory are there from the second solve on, as in a run whose contacts stay.
    pub keeps_memory: bool,
}

impl SolveTimer<'_> {
    /// Times a simulation's next step.
    ///
    /// # Errors
    /// Where the variant does not fit the simulation.
    pub(super) fn time(self, simulation: &Simulation) -> Result<TimedSolves> {
        // The method decides on the order of the problem's rows.
        Ok(solved_by(simulation, self.variant.sweeps(1))?.next_problem(self))
    }

    /// The sweeps that fit in the time limit, from what so many take that it can be told.
    fn sweeps_in_time<M: Model>(&self, problem: &StepProblem<M>, memory: &mut Memory<M>) -> u32 {
        let mut sweeps = FIRST_SWEEPS;
        loop {
            let (secs, _) = timed::<M>(problem, memory, &self.variant.sweeps(sweeps));
            if secs > LONG_TRY * self.limit_secs || sweeps >= MOST_SWEEPS {
                let fitting = f64::from(sweeps) * self.limit_secs / secs;
                return fitting.clamp(1.0, f64::from(MOST_SWEEPS)) as u32;
            }
            sweeps *= 4;
        }
    }
}

impl ProblemVisitor for SolveTimer<'_> {
    type Output = TimedSolves;

    fn visit<M: Model>(self, problem: &mut StepProblem<M>, contacts: &ContactList) -> TimedSolves {
        let start = left(&measure(problem));
        let mut solves = TimedSolves {
            contacts: contacts.contacts().len(),
            start,
            smallest: start,
            reached: Vec::new(),
            gave_up_secs: None,
        };
        let mut memory = Memory::default();
        let max_sweeps = self.sweeps_in_time::<M>(problem, &mut memory);
        for &goal in self.goals {
            let settings = self.variant.to_residual(goal, max_sweeps);
            let mut reached =
                ReachedGoal { goal, solve_secs: f64::INFINITY, left: f64::NAN, duality_gap: None };
            let mut sum_secs = 0.0;
            for repeat in 0..MOST_REPEATS {
                if repeat >= LEAST_REPEATS && sum_secs > ENOUGH_SECS {
                    break;
                }
                if !self.keeps_memory {
                    memory = Memory::default();
                }
                let (secs, measures) = timed::<M>(problem, &mut memory, &settings);
                reached.left = left(&measures);
                reached.duality_gap = measures.duality_gap;
                solves.smallest = solves.smallest.min(reached.left);
                // What is not a number has not reached anything.
                let is_reached = reached.left <= goal * (1.0 + ROUNDING);
                if !is_reached || secs > self.limit_secs {
                    solves.gave_up_secs = Some(secs);
                    return solves;
                }
                reached.solve_secs = reached.solve_secs.min(secs);
                sum_secs += secs;
                if secs > LONG_SOLVE_SECS {
                    break;
                }
            }
            solves.reached.push(reached);
        }
        solves
    }
}

/// Seconds of one solve of a copy, and what it came to.
pub(super) fn timed<M: Model>(
    problem: &StepProblem<M>,
    memory: &mut Memory<M>,
    settings: &SolverSettings,
) -> (f64, Measures) {
    let mut copy = problem.clone();
    let started = Instant::now();
    solve(&mut copy, memory, settings);
    let secs = started.elapsed().as_secs_f64();
    (secs, measure(&copy))
}

/// The natural map of what was solved.
fn left(measures: &Measures) -> f64 {
    measures.model_residual.unwrap_or(measures.residual)
}
