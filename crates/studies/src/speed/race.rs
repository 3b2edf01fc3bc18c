//! One problem, one method: how long it takes to residual after residual.

use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::entrants::Entrant;
use crate::contact::ContactList;
use crate::number;
use crate::performance::Timing;
use crate::sim::ProblemVisitor;
use crate::solver::{
    Measures, Memory, Model, SolverSettings, StepProblem, measure, residual, solve,
};

/// Least number of solves that a time is the minimum of.
const LEAST_REPEATS: usize = 3;
/// Short solves are repeated more often, up to this sum of times, s, or [`MOST_REPEATS`].
const ENOUGH_SECS: f64 = 2e-3;
/// See [`ENOUGH_SECS`].
const MOST_REPEATS: usize = 12;
/// A method's own residual may differ from the one measured here by rounding.
pub(super) const ROUNDING: f64 = 1e-6;

/// What a race runs to.
#[derive(Clone, Debug)]
pub(super) struct Course {
    /// Residuals to reach, falling.
    pub tolerances: Vec<f64>,
    /// Sweeps after which a solve is given up.
    pub max_sweeps: u32,
    /// A solve gets no more sweeps than fit in this time, s.
    pub limit_secs: f64,
}

/// What came of it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Race {
    /// The problem.
    pub problem: String,
    /// The method.
    pub method: String,
    /// Contacts of the problem.
    pub contacts: usize,
    /// Residual of the start, with the impulses of the step before.
    #[serde(with = "number")]
    pub start_residual: f64,
    /// Smallest residual of any of its solves.
    #[serde(with = "number")]
    pub smallest_residual: f64,
    /// (residual asked for, s) of what was reached.
    pub reached: Vec<(f64, f64)>,
    /// How long the solve took that did not reach what was asked for, s.
    pub gave_up_secs: Option<f64>,
}

impl Race {
    /// The time to one of the residuals that were asked for.
    pub(super) fn timing(&self, tolerance: f64) -> Timing {
        let reached = self.reached.iter().find(|(asked, _)| *asked == tolerance);
        match (reached, self.gave_up_secs) {
            (Some(&(_, secs)), _) => Timing { secs, solved: true },
            (None, gave_up) => Timing { secs: gave_up.unwrap_or(f64::INFINITY), solved: false },
        }
    }
}

/// Runs one method over the course, from the same start every time. Copies of the problem are made
/// outside of the clock.
pub(super) struct Runner<'a> {
    /// Name of the problem.
    pub problem: &'a str,
    pub entrant: &'a Entrant,
    pub course: &'a Course,
}

impl ProblemVisitor for Runner<'_> {
    type Output = Race;

    fn visit<M: Model>(
        self,
        problem: &mut StepProblem<M::Kinematics>,
        contacts: &ContactList,
    ) -> Race {
        let mut race = Race {
            problem: self.problem.to_owned(),
            method: self.entrant.name.clone(),
            contacts: contacts.contacts().len(),
            start_residual: residual::<M>(problem),
            smallest_residual: residual::<M>(problem),
            reached: Vec::new(),
            gave_up_secs: None,
        };
        let max_sweeps = self.sweeps_in_time::<M>(problem);
        for &tolerance in &self.course.tolerances {
            let settings = self.entrant.to_residual(tolerance, max_sweeps).solver;
            let (mut least, mut sum) = (f64::INFINITY, 0.0);
            for repeat in 0..MOST_REPEATS {
                if repeat >= LEAST_REPEATS && sum > ENOUGH_SECS {
                    break;
                }
                let memory = &mut Memory::default();
                let (secs, _, Measures { residual: left, .. }) =
                    timed::<M>(problem, memory, &settings);
                race.smallest_residual = race.smallest_residual.min(left);
                // What is not a number has not reached anything.
                if left.is_nan() || left > tolerance * (1.0 + ROUNDING) {
                    race.gave_up_secs = Some(secs);
                    return race;
                }
                least = least.min(secs);
                sum += secs;
            }
            race.reached.push((tolerance, least));
        }
        race
    }
}

impl Runner<'_> {
    /// The sweeps that fit in the time limit, from what a few take.
    fn sweeps_in_time<M: Model>(&self, problem: &StepProblem<M::Kinematics>) -> u32 {
        let of = |sweeps| {
            timed::<M>(problem, &mut Memory::default(), &self.entrant.sweeps(sweeps).solver)
        };
        let (few_secs, few, _) = of(20);
        let (many_secs, many, _) = of(220);
        if many <= few {
            return self.course.max_sweeps;
        }
        let per_sweep = (many_secs - few_secs).max(1e-9) / f64::from(many - few);
        let fitting = self.course.limit_secs / per_sweep;
        (fitting.clamp(1.0, f64::from(self.course.max_sweeps))) as u32
    }
}

/// Seconds and sweeps of one solve of a copy, and what it came to.
pub(super) fn timed<M: Model>(
    problem: &StepProblem<M::Kinematics>,
    memory: &mut Memory<M::Kinematics>,
    settings: &SolverSettings,
) -> (f64, u32, Measures) {
    let mut copy = problem.clone();
    let started = Instant::now();
    let report = solve::<M>(&mut copy, memory, settings);
    let secs = started.elapsed().as_secs_f64();
    (secs, report.sweeps, measure::<M>(&copy))
}
