//! Measures how long solver methods take to solve a single step, with an increasing number of sweeps, and how far the
//! resulting velocities are from a solution under Coulomb friction.

use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::performance::Timing;
use crate::contact::ContactList;
use crate::error::Result;
use crate::harness::Change;
use crate::number;
use crate::sim::{ProblemVisitor, Simulation};
use crate::solver::{
    Memory, Model, Solution, SolutionSearch, SolverSettings, StepProblem, distance_to_velocities,
    measure, solve, velocities, velocity_error, worst,
};

/// Least number of times that a solve of a step is timed, unless it takes longer than [`LONG_SOLVE_SECS`]. The shortest
/// time counts.
pub(super) const LEAST_REPEATS: usize = 3;
/// Total computing time of all repetitions of a solve, s, after which its timing is not repeated again. A short solve
/// is timed at most [`MOST_REPEATS`] times.
const ENOUGH_SECS: f64 = 2e-3;
/// Largest number of times that a short solve of a step is timed.
const MOST_REPEATS: usize = 12;
/// Computing time of a solve, s, above which its timing is not repeated, because disturbances average out within the
/// solve.
pub(super) const LONG_SOLVE_SECS: f64 = 0.1;
/// Largest number of sweeps with which a step is solved, even if the limit on the time of a solve is not reached.
const MOST_SWEEPS: u32 = 1 << 20;
/// Factor by which the number of sweeps is increased from one timed solve of a step to the next.
const GROWTH: u32 = 2;

/// The known solutions of a step under Coulomb friction. The error of a solver is the distance of its velocities from
/// those of the nearest known solution.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct References {
    /// Velocities of all grains in each known solution, m/s: the components along the axes of the scene, and, if grains
    /// turn, the radius times the angular velocity.
    #[serde(skip)]
    velocities: Vec<Vec<[f64; 3]>>,
    pub found: usize,
    /// Largest distance between the velocities of two known solutions of the step, in units of √(g d), with gravity g
    /// and mean diameter d; 0 for a single solution.
    pub spread: f64,
    /// Estimated distance between the velocities of the least accurate known solution and those of an exact solution,
    /// in units of √(g d), with gravity g and mean diameter d.
    #[serde(with = "number")]
    pub told: f64,
    /// Largest residual of the known solutions of the step, dimensionless.
    #[serde(with = "number")]
    pub residual: f64,
}

/// A search for the solutions of the next step of a simulation under Coulomb friction, with its settings.
pub(super) struct ReferenceSearch(pub SolutionSearch);

impl References {
    /// Returns the error of velocities, in √(g d) with gravity g and mean diameter d, below which solver methods cannot
    /// be compared: the larger of the distance between known solutions and their estimated distance from exact
    /// solutions.
    pub(super) fn floor(&self) -> f64 {
        self.spread.max(self.told)
    }
}

impl ProblemVisitor for ReferenceSearch {
    type Output = References;

    fn visit<M: Model>(self, problem: &mut StepProblem<M>, _: &ContactList) -> References {
        let solutions = self.0.find(problem);
        let all: Vec<_> = solutions.iter().map(|solution| velocities(&solution.problem)).collect();
        let apart = solutions.iter().flat_map(|solution| {
            all.iter().map(|other| distance_to_velocities(&solution.problem, other))
        });
        let worst = |number: fn(&Solution<M>) -> f64| solutions.iter().map(number).fold(0.0, worst);
        let unit = velocity_error(problem).scale;
        References {
            spread: apart.fold(0.0, f64::max) / unit,
            found: all.len(),
            told: worst(|solution| solution.velocity_error) / unit,
            residual: worst(|solution| solution.residual),
            velocities: all,
        }
    }
}

/// Computing time and error of a solve of a step with a limited number of sweeps.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct TimedSolve {
    pub sweeps: u32,
    /// Computing time of the solve, s: the shortest among its repetitions.
    pub secs: f64,
    /// Distance of the velocities to the nearest known solution under Coulomb friction, in units of √(g d), with
    /// gravity g and mean diameter d.
    #[serde(with = "number")]
    pub error: f64,
    /// Velocity error against Coulomb friction that a run reports for this solve, in units of √(g d), with gravity g
    /// and mean diameter d.
    #[serde(with = "number")]
    pub reported: f64,
}

/// Computing times and errors of one solver method on one step, by increasing number of sweeps.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct TimedSolves(pub Vec<TimedSolve>);

impl TimedSolves {
    /// Returns the computing time of the first solve whose error is at most `error`. If there is no such solve, returns
    /// the time of the last solve, marked as not solved.
    pub(super) fn timing(&self, error: f64) -> Timing {
        let reached = self.0.iter().find(|effort| effort.error <= error);
        let secs = |solve: &TimedSolve| solve.secs;
        match reached {
            Some(effort) => Timing { secs: effort.secs, solved: true },
            None => Timing { secs: self.0.last().map_or(f64::INFINITY, secs), solved: false },
        }
    }

    /// Returns solve number `number`, counted from 0 by increasing number of sweeps, or the last solve if there are
    /// fewer solves.
    pub(super) fn effort(&self, number: usize) -> Option<TimedSolve> {
        self.0.get(number).or(self.0.last()).copied()
    }
}

/// Measures the computing times and errors of solves of one step by one solver variant, with an increasing number of
/// sweeps. All solves begin with the same initial guess. The series ends with the first solve that stops before its
/// limit of sweeps or takes too long. The time to copy the problem does not count.
pub(super) struct SolveTimer<'a> {
    pub variant: &'a Change,
    pub references: &'a References,
    /// Computing time of a solve, s, above which no solve with more sweeps follows.
    pub limit_secs: f64,
}

impl SolveTimer<'_> {
    pub(super) fn time(self, simulation: &Simulation) -> Result<TimedSolves> {
        // The rows of the problem are in the order that the method needs, so the method is set before the problem is
        // built.
        let mut simulation = simulation.clone();
        simulation.set_solver(self.variant.sweeps(1))?;
        Ok(simulation.next_problem(self))
    }

    fn effort<M: Model>(&self, problem: &StepProblem<M>, sweeps: u32) -> (TimedSolve, bool) {
        let settings = self.variant.sweeps(sweeps);
        let mut effort =
            TimedSolve { sweeps, secs: f64::INFINITY, error: f64::NAN, reported: f64::NAN };
        let (mut sum_secs, mut has_ended) = (0.0, false);
        for repeat in 0..MOST_REPEATS {
            if repeat >= LEAST_REPEATS && sum_secs > ENOUGH_SECS {
                break;
            }
            let (secs, solved, ended) = timed::<M>(problem, &settings);
            effort.secs = effort.secs.min(secs);
            if repeat == 0 {
                has_ended = ended < sweeps;
                effort.error = self.error(&solved);
                effort.reported = measure(&solved).velocity_error / velocity_error(&solved).scale;
            }
            sum_secs += secs;
            if secs > LONG_SOLVE_SECS {
                break;
            }
        }
        (effort, has_ended)
    }

    /// Returns the error of a solved step, in units of √(g d), with gravity g and mean diameter d: the distance of its
    /// velocities from those of the nearest known solution.
    fn error<M: Model>(&self, solved: &StepProblem<M>) -> f64 {
        let all = self.references.velocities.iter();
        let distances = all.map(|reference| distance_to_velocities(solved, reference));
        distances.fold(f64::INFINITY, f64::min) / velocity_error(solved).scale
    }
}

impl ProblemVisitor for SolveTimer<'_> {
    type Output = TimedSolves;

    fn visit<M: Model>(self, problem: &mut StepProblem<M>, _: &ContactList) -> TimedSolves {
        let mut solves = Vec::new();
        let mut sweeps = if self.variant.is_default() { MOST_SWEEPS } else { 1 };
        loop {
            let (effort, has_ended) = self.effort(problem, sweeps);
            solves.push(effort);
            if has_ended || effort.secs > self.limit_secs || sweeps >= MOST_SWEEPS {
                return TimedSolves(solves);
            }
            sweeps *= GROWTH;
        }
    }
}

/// Solves a copy of the contact problem of a step. Returns the computing time, s, the solved copy, and the number of
/// sweeps.
fn timed<M: Model>(
    problem: &StepProblem<M>,
    settings: &SolverSettings,
) -> (f64, StepProblem<M>, u32) {
    let (mut copy, mut memory) = (problem.clone(), Memory::default());
    let started = Instant::now();
    let report = solve(&mut copy, &mut memory, settings);
    (started.elapsed().as_secs_f64(), copy, report.sweeps)
}

#[cfg(test)]
mod tests {
    use super::super::collection::{CollectionPlan, collect};
    use super::super::variants;
    use super::*;
    use crate::harness::Effort;
    use crate::solver::Method;

    fn collected(grains: usize, in_a_box: bool) -> Vec<Simulation> {
        let folder = tempfile::tempdir().expect("a folder");
        let plan = CollectionPlan::of_size(grains, in_a_box, Effort::Quick);
        collect(&plan, folder.path()).expect("a collection")
    }

    const SEARCH: SolutionSearch =
        SolutionSearch { starts: 3, seed: 1, max_sweeps: 20_000, tolerance: 1e-12 };

    fn time(
        step: &Simulation,
        variant: &Change,
        references: &References,
        limit_secs: f64,
    ) -> TimedSolves {
        SolveTimer { variant, references, limit_secs }.time(step).expect("times")
    }

    #[test]
    fn a_pile_in_a_box_is_at_rest_and_one_without_slumps_each_step_solved_within_bounds() {
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
    fn errors_are_against_coulombs_law_and_fall_with_sweeps_where_a_method_solves_it() {
        // The first collected step has no cohesion, so that its pile flows.
        let step = &collected(138, false)[0];
        let references = &step.next_problem(ReferenceSearch(SEARCH));
        assert!(references.found > 0 && references.residual < 1e-8, "{references:?}");
        let last = |variant: &Change| {
            let solves = time(step, variant, references, 0.2);
            (solves.0[0].error, solves.0.last().expect("a solve").error)
        };
        let (first, solved) = last(&variants::of_method(Method::Nncg));
        assert!(first > 1e-3 && solved < 1e-6, "{first} {solved}");
        let (_, bounded) = last(&variants::bounded());
        assert!(bounded > 1e-3, "another law's solution is no solution: {bounded}");
        let (_, by_default) = last(&variants::default());
        assert!(by_default < 1e-3, "{by_default}");
    }

    #[test]
    fn solves_end_at_their_limit_and_an_error_that_was_not_reached_is_told() {
        let step = &collected(500, false)[0];
        let references = &step.next_problem(ReferenceSearch(SEARCH));
        let unit = variants::of_method(Method::Nsgs);
        let solves = time(step, &unit, references, 1e-12);
        assert_eq!(solves.0.len(), 1);
        let TimedSolve { secs, error, .. } = solves.0[0];
        assert_eq!(solves.timing(1.01 * error), Timing { secs, solved: true });
        assert_eq!(solves.timing(0.99 * error), Timing { secs, solved: false });
    }
}
