//! Any method, island by island (`problem::islands`).
//!
//! Each island is solved until it passes the test of the settings by itself. Then the whole passes it, too: what is
//! tested is a ratio of roots of sums of squares, or a sum of which each island gets its share.

use rayon::iter::{IntoParallelRefMutIterator, ParallelIterator};

use super::report::SolveReport;
use super::{Memory, interior_point, solve_by_method};
use crate::solver::problem::{Island, Islands, Kinematics, Model, StepProblem, natural_map};
use crate::solver::settings::{SolverSettings, StopTest};
use crate::threads;

/// What is kept from one solve to the next.
#[derive(Clone, Debug)]
pub(super) struct IslandMemory<K: Kinematics> {
    islands: Islands,
    parts: Vec<Part<K>>,
    /// How many of these are of the present problem.
    count: usize,
}

/// An island with the memory of its method.
#[derive(Clone, Debug)]
struct Part<K: Kinematics> {
    island: Island<K>,
    memory: Memory<K>,
    report: SolveReport,
}

impl<K: Kinematics> Default for IslandMemory<K> {
    fn default() -> Self {
        Self { islands: Islands::default(), parts: Vec::new(), count: 0 }
    }
}

impl<K: Kinematics> Part<K> {
    fn new() -> Self {
        Self {
            island: Island::default(),
            memory: Memory::default(),
            report: SolveReport::nothing_yet(),
        }
    }
}

impl<K: Kinematics> IslandMemory<K> {
    /// Divides a problem into its islands. Whether there are several.
    pub(super) fn divide(&mut self, problem: &StepProblem<K>) -> bool {
        self.count = self.islands.find(problem);
        if self.count < 2 {
            return false;
        }
        if self.parts.len() < self.count {
            self.parts.resize_with(self.count, Part::new);
        }
        self.islands.divide(problem, self.parts.iter_mut().map(|part| &mut part.island));
        true
    }

    /// Solves the islands of a problem that was divided.
    pub(super) fn solve<M: Model<Kinematics = K>>(
        &mut self,
        problem: &mut StepProblem<K>,
        settings: &SolverSettings,
    ) -> SolveReport {
        let contacts = problem.contact_of_row.len() as f64;
        let solve = |Part { island, memory, report }: &mut Part<K>| {
            let share = match settings.stop {
                StopTest::ImpulsePerMass => island.problem.contact_of_row.len() as f64 / contacts,
                StopTest::RelativeChange | StopTest::Residual => 1.0,
            };
            let tolerance = share * settings.tolerance;
            let settings = SolverSettings { tolerance, ..*settings };
            *report = solve_by_method::<M>(&mut island.problem, memory, &settings);
        };
        let parts = &mut self.parts[..self.count];
        if threads::are_there() {
            parts.par_iter_mut().for_each(solve);
        } else {
            parts.iter_mut().for_each(solve);
        }
        let mut report = self.join(problem);
        // What is left in a small island may be little beside what moves in the others.
        let of_all = !report.converged && settings.stop == StopTest::Residual;
        report.converged |= of_all && natural_map::<M>(problem) <= settings.tolerance;
        report.stalled &= !report.converged;
        report
    }

    /// Puts in the place of what was not solved the solution under bounds of friction, island by island.
    pub(super) fn fall_back<M: Model<Kinematics = K>>(
        &mut self,
        problem: &mut StepProblem<K>,
    ) -> SolveReport {
        let parts = &mut self.parts[..self.count];
        for Part { island, memory, report } in
            parts.iter_mut().filter(|part| !part.report.converged)
        {
            let memory = &mut memory.interior_point;
            *report = interior_point::fall_back::<M>(&mut island.problem, memory, *report);
        }
        let report = self.join(problem);
        if report.fell_back {
            // What was solved under Coulomb's law is solved under the bounds that it came to itself.
            problem.bound_by_present::<M>();
            self.join(problem);
        }
        report
    }

    /// Gives a problem what became of its islands, and tells how the solve of the whole ended.
    fn join(&self, problem: &mut StepProblem<K>) -> SolveReport {
        let mut all = SolveReport::nothing_yet();
        for Part { island, report, .. } in &self.parts[..self.count] {
            island.join(problem);
            all.add_beside(*report);
        }
        all
    }
}
