//! Solves of single steps against the clock: how long a solver variant takes from goal to goal.

use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::performance::Timing;
use super::variants::ChartedVariant;
use crate::contact::ContactList;
use crate::error::Result;
use crate::number;
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

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct ReachedGoal {
    pub goal: f64,
    /// Least time of a solve, s.
    pub solve_secs: f64,
    /// What the solve came to: the natural map of what was solved.
    pub left: f64,
    /// An estimate of the velocities' error, m/s.
    pub velocity_error: f64,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct TimedSolves {
    pub contacts: usize,
    /// Natural map of the start, with the impulses of the step before.
    #[serde(with = "number")]
    pub start: f64,
    /// Smallest natural map of any of the solves.
    #[serde(with = "number")]
    pub smallest: f64,
    pub reached: Vec<ReachedGoal>,
    /// How long the solve took that did not reach its goal in time, s.
    pub gave_up_secs: Option<f64>,
}

impl TimedSolves {
    pub(super) fn reached(&self, goal: f64) -> Option<&ReachedGoal> {
        self.reached.iter().find(|reached| reached.goal == goal)
    }

    pub(super) fn timing(&self, goal: f64) -> Timing {
        match self.reached(goal) {
            Some(reached) => Timing { secs: reached.solve_secs, solved: true },
            None => Timing { secs: self.gave_up_secs.unwrap_or(f64::INFINITY), solved: false },
        }
    }
}

/// Times the solves of one step from goal to goal, each from the same start, until one is not reached in time. Copies
/// of the problem are made outside of the clock.
pub(super) struct SolveTimer<'a> {
    pub variant: &'a ChartedVariant,
    /// Natural maps to reach, falling.
    pub goals: &'a [f64],
    /// Most time of a solve, s.
    pub limit_secs: f64,
}

impl SolveTimer<'_> {
    pub(super) fn time(self, simulation: &Simulation) -> Result<TimedSolves> {
        // The method decides on the order of the problem's rows.
        let mut simulation = simulation.clone();
        simulation.set_solver(self.variant.sweeps(1))?;
        Ok(simulation.next_problem(self))
    }

    /// The sweeps that fit in the time limit, from what so many take that it can be told.
    fn sweeps_in_time<M: Model>(&self, problem: &StepProblem<M>) -> u32 {
        let mut sweeps = FIRST_SWEEPS;
        loop {
            let (secs, _) = timed::<M>(problem, &self.variant.sweeps(sweeps));
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
        let max_sweeps = self.sweeps_in_time::<M>(problem);
        for &goal in self.goals {
            let settings = self.variant.to_residual(goal, max_sweeps);
            let mut reached = ReachedGoal {
                goal,
                solve_secs: f64::INFINITY,
                left: f64::NAN,
                velocity_error: f64::NAN,
            };
            let mut sum_secs = 0.0;
            for repeat in 0..MOST_REPEATS {
                if repeat >= LEAST_REPEATS && sum_secs > ENOUGH_SECS {
                    break;
                }
                let (secs, measures) = timed::<M>(problem, &settings);
                reached.left = left(&measures);
                reached.velocity_error = measures.velocity_error;
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
fn timed<M: Model>(problem: &StepProblem<M>, settings: &SolverSettings) -> (f64, Measures) {
    let (mut copy, mut memory) = (problem.clone(), Memory::default());
    let started = Instant::now();
    solve(&mut copy, &mut memory, settings);
    let secs = started.elapsed().as_secs_f64();
    (secs, measure(&copy))
}

/// The natural map of what was solved.
fn left(measures: &Measures) -> f64 {
    measures.model_residual.unwrap_or(measures.residual)
}

#[cfg(test)]
mod tests {
    use super::super::collection::{CollectionPlan, collect};
    use super::super::variants;
    use super::*;
    use crate::solver::Method;

    fn collected(grains: usize, in_a_box: bool) -> Vec<Simulation> {
        let folder = tempfile::tempdir().expect("a folder");
        let plan = CollectionPlan::of_size(grains, in_a_box, true);
        collect(&plan, folder.path()).expect("a collection")
    }

    fn time(
        step: &Simulation,
        variant: &ChartedVariant,
        goals: &[f64],
        limit_secs: f64,
    ) -> TimedSolves {
        SolveTimer { variant, goals, limit_secs }.time(step).expect("times")
    }

    #[test]
    fn a_pile_in_a_box_is_at_rest_and_one_without_slumps_each_step_certified() {
        let speeds = [true, false].map(|in_a_box| {
            let collected = collected(500, in_a_box);
            assert_eq!(collected.len(), 2);
            collected.into_iter().map(|step| {
                let told = step.observables();
                assert!(told.converged && told.model_residual.is_some_and(|left| left <= 1e-8));
                let velocities = step.world().grains.velocities.iter();
                velocities.map(|velocity| velocity.length()).fold(0.0, f64::max)
            })
        });
        let [at_rest, moving] = speeds.map(Vec::from_iter);
        assert!(at_rest.iter().all(|speed| *speed < 0.01), "{at_rest:?} m/s");
        assert!(moving.iter().all(|speed| *speed > 0.1), "{moving:?} m/s");
    }

    #[test]
    fn solves_end_at_their_limit() {
        for step in collected(500, false) {
            let solves = time(&step, &variants::certified(), &[1e-8], 100.0);
            let reached = solves.reached(1e-8).expect("it is solved");
            assert!(reached.left <= 1e-8 * (1.0 + ROUNDING));
            let solves = time(&step, &variants::of_method(Method::Nsgs), &[1e-3, 1e-8], 1e-7);
            assert!(solves.start > 1e-3, "there is something to be solved");
            assert!(solves.reached.is_empty() && solves.gave_up_secs.is_some());
            assert!(!solves.timing(1e-3).solved);
        }
    }

    #[test]
    fn what_is_solved_too_late_is_not_reached() {
        // So few grains hold at this Bond number.
        let step = collected(60, false).pop().expect("a step");
        let unit = variants::of_method(Method::Nsgs);
        let ample = time(&step, &unit, &[1e-3], 100.0);
        assert!(ample.start <= 1e-3 && ample.reached(1e-3).is_some());
        let short = time(&step, &unit, &[1e-3], 1e-12);
        assert!(short.smallest <= 1e-3, "a sweep does it");
        assert!(short.reached.is_empty());
    }
}
