//! One step, one method: how long it takes to goal after goal.

use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::super::entrants::Entrant;
use super::super::race::{ROUNDING, timed};
use super::plan::{Plan, UNIT_SWEEPS, goals};
use crate::collection::CollectedStep;
use crate::contact::ContactList;
use crate::error::Result;
use crate::number;
use crate::sim::{ProblemVisitor, Simulation};
use crate::solver::{Measures, Memory, Model, SolverSettings, StepProblem, measure};

/// What is timed is the least of so many.
const REPEATS: usize = 5;
/// A solve that takes longer is not repeated, s: what disturbs it averages out.
const LONG_ENOUGH_SECS: f64 = 0.3;
/// Most sweeps of a solve, whatever its time.
const MOST_SWEEPS: u32 = 200_000;
/// Sweeps of the first try of how long they take.
const FIRST_SWEEPS: u32 = 16;
/// Part of the limit from which on a try tells how many sweeps fit into it.
const TELLING: f64 = 0.125;

/// A goal that was reached.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Reached {
    /// What was asked for.
    pub goal: f64,
    /// Time of the solve, s.
    pub solve_secs: f64,
    /// What it came to, the natural map of what was solved.
    pub left: f64,
    /// The duality gap, where there is one.
    pub duality_gap: Option<f64>,
}

/// What came of the solves of one method.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Course {
    /// Contacts of the step.
    pub contacts: usize,
    /// Natural map of the start, with the impulses of the step before.
    #[serde(with = "number")]
    pub start: f64,
    /// Smallest natural map of any of its solves.
    #[serde(with = "number")]
    pub smallest: f64,
    /// By falling goal.
    pub reached: Vec<Reached>,
    /// How long the solve took that did not reach its goal in time, s.
    pub gave_up_secs: Option<f64>,
}

/// A method on a step.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Race {
    /// The step.
    pub problem: String,
    /// The method.
    pub method: String,
    /// Time of a whole step of [`UNIT_SWEEPS`] sweeps of `nsgs`, just before, s.
    pub unit_secs: f64,
    /// Time of a step of this method but for its solve, s.
    pub besides_secs: f64,
    /// Its solves.
    pub course: Course,
}

impl Race {
    /// What tells it apart from others.
    pub(super) fn key(&self) -> (String, String) {
        (self.problem.clone(), self.method.clone())
    }

    /// The goal, if it was reached.
    pub(super) fn reached(&self, goal: f64) -> Option<&Reached> {
        self.course.reached.iter().find(|reached| reached.goal == goal)
    }

    /// Time of a whole step to that goal, s; longer than any where it was not reached. A solve that went further has
    /// reached it too.
    pub(super) fn step_secs(&self, goal: f64) -> f64 {
        let as_far = self.course.reached.iter().filter(|reached| reached.goal <= goal);
        let solves = as_far.map(|reached| reached.solve_secs);
        self.besides_secs + solves.fold(f64::INFINITY, f64::min)
    }
}

/// Runs an entrant from goal to goal, until one is not reached in time.
///
/// # Errors
/// Where the entrant's settings do not fit the simulation.
pub(super) fn race(step: &CollectedStep, entrant: &Entrant, plan: &Plan) -> Result<Race> {
    let CollectedStep { name, simulation } = step;
    let unit = plan.unit.sweeps(UNIT_SWEEPS).solver;
    let unit_secs = besides_secs(simulation, &plan.unit)?
        + solved_by(simulation, unit)?.next_problem(Solves { settings: &unit });
    let besides_secs = besides_secs(simulation, entrant)?;
    let runner = Runner { entrant, limit_secs: plan.limit * unit_secs - besides_secs };
    // The method decides on the order of the problem's rows.
    let course = solved_by(simulation, entrant.sweeps(1).solver)?.next_problem(runner);
    Ok(Race {
        problem: name.clone(),
        method: entrant.name.clone(),
        unit_secs,
        besides_secs,
        course,
    })
}

/// The simulation with other settings of the solver.
fn solved_by(simulation: &Simulation, solver: SolverSettings) -> Result<Simulation> {
    let mut simulation = simulation.clone();
    simulation.set_solver(solver)?;
    Ok(simulation)
}

/// What a step takes but for its solve: contacts, their order, motion, and what is observed.
fn besides_secs(simulation: &Simulation, entrant: &Entrant) -> Result<f64> {
    // Met by whatever the first test looks at.
    let at_once = entrant.to_residual(f64::MAX, 1).solver;
    let start = solved_by(simulation, at_once)?;
    let mut least = f64::INFINITY;
    for _ in 0..REPEATS {
        let mut simulation = start.clone();
        let started = Instant::now();
        simulation.step()?;
        least = least.min(started.elapsed().as_secs_f64());
    }
    Ok((least - start.next_problem(Solves { settings: &at_once })).max(0.0))
}

/// How long a solve takes, s.
struct Solves<'a> {
    settings: &'a SolverSettings,
}

impl ProblemVisitor for Solves<'_> {
    type Output = f64;

    fn visit<M: Model>(self, problem: &mut StepProblem<M::Kinematics>, _: &ContactList) -> f64 {
        let once = |_| timed::<M>(problem, &mut Memory::default(), self.settings).0;
        (0..REPEATS).map(once).fold(f64::INFINITY, f64::min)
    }
}

/// Runs one method over the course, from the same start every time.
struct Runner<'a> {
    entrant: &'a Entrant,
    /// Time of a solve, s.
    limit_secs: f64,
}

impl ProblemVisitor for Runner<'_> {
    type Output = Course;

    fn visit<M: Model>(
        self,
        problem: &mut StepProblem<M::Kinematics>,
        contacts: &ContactList,
    ) -> Course {
        let start = left(&measure::<M>(problem));
        let mut course = Course {
            contacts: contacts.contacts().len(),
            start,
            smallest: start,
            reached: Vec::new(),
            gave_up_secs: None,
        };
        // As in a run whose contacts stay: from the second solve on, orders and memory are there.
        let memory = &mut Memory::default();
        let max_sweeps = self.sweeps_in_time::<M>(problem, memory);
        for &goal in goals(self.entrant) {
            let settings = self.entrant.to_residual(goal, max_sweeps).solver;
            let mut reached =
                Reached { goal, solve_secs: f64::INFINITY, left: f64::NAN, duality_gap: None };
            for _ in 0..REPEATS {
                let (secs, _, measures) = timed::<M>(problem, memory, &settings);
                reached.left = left(&measures);
                reached.duality_gap = measures.duality_gap;
                course.smallest = course.smallest.min(reached.left);
                // What is not a number has not reached anything.
                let is_reached = reached.left <= goal * (1.0 + ROUNDING);
                if !is_reached || secs > self.limit_secs {
                    course.gave_up_secs = Some(secs);
                    return course;
                }
                reached.solve_secs = reached.solve_secs.min(secs);
                if secs > LONG_ENOUGH_SECS {
                    break;
                }
            }
            course.reached.push(reached);
        }
        course
    }
}

impl Runner<'_> {
    /// The sweeps that fit in the time limit, from what so many take that it tells.
    fn sweeps_in_time<M: Model>(
        &self,
        problem: &StepProblem<M::Kinematics>,
        memory: &mut Memory<M::Kinematics>,
    ) -> u32 {
        let mut sweeps = FIRST_SWEEPS;
        loop {
            let secs = timed::<M>(problem, memory, &self.entrant.sweeps(sweeps).solver).0;
            if secs > TELLING * self.limit_secs || sweeps >= MOST_SWEEPS {
                let fitting = f64::from(sweeps) * self.limit_secs / secs;
                return fitting.clamp(1.0, f64::from(MOST_SWEEPS)) as u32;
            }
            sweeps *= 4;
        }
    }
}

/// The natural map of what was solved.
fn left(measures: &Measures) -> f64 {
    measures.model_residual.unwrap_or(measures.residual)
}

#[cfg(test)]
mod tests {
    use super::super::plan::{CERTIFIED, RESIDUALS, SIZES, steps};
    use super::*;
    use crate::collection::collect;

    #[test]
    fn a_certificate_has_a_gap_and_a_race_ends_at_its_limit() {
        let folder = tempfile::tempdir().expect("a folder");
        let collected =
            collect(&steps(SIZES[0], false, true), folder.path()).expect("a collection");
        let (ample, short) = (Plan::new(false), Plan { limit: 1e-3, ..Plan::new(false) });
        let certified = ample.entrants.last().expect("an entrant");
        for step in &collected {
            let raced = race(step, certified, &ample).expect("a race");
            let reached = raced.reached(CERTIFIED).expect("it is certified");
            assert!(reached.left <= CERTIFIED * (1.0 + ROUNDING));
            assert!(reached.duality_gap.is_some_and(|gap| gap.abs() < 1e-4));
            assert!(raced.step_secs(CERTIFIED) > raced.besides_secs);
            let raced = race(step, &short.unit, &short).expect("a race");
            assert!(raced.course.start > RESIDUALS[0], "there is something to be solved");
            assert!(raced.course.reached.is_empty() && raced.course.gave_up_secs.is_some());
            assert_eq!(raced.step_secs(RESIDUALS[0]), f64::INFINITY);
        }
    }

    #[test]
    fn what_is_solved_too_late_is_not_reached() {
        let folder = tempfile::tempdir().expect("a folder");
        let collected = collect(&steps(60, false, true), folder.path()).expect("a collection");
        // So few grains hold at this Bond number.
        let step = collected.last().expect("a step");
        let (ample, short) = (Plan::new(false), Plan { limit: 1e-9, ..Plan::new(false) });
        let raced = race(step, &ample.unit, &ample).expect("a race");
        assert!(raced.course.start <= RESIDUALS[0] && raced.reached(RESIDUALS[0]).is_some());
        let raced = race(step, &short.unit, &short).expect("a race");
        assert!(raced.course.smallest <= RESIDUALS[0], "a sweep does it");
        assert!(raced.course.reached.is_empty());
    }
}
