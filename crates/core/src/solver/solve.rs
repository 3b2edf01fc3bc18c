//! Solves a step's problem: as a whole, or island by island.
//!
//! Islands are grains that contacts join, and the contacts of these. What is fixed joins none, so that no island feels
//! another, and the step of each is a problem of its own: what one of them needs, the others need not wait for, and what
//! one of them leaves unsolved is unsolved in it alone.
//!
//! Each island is solved by any method until it passes the test of the settings by itself. Then the whole passes it,
//! too: what is tested is a ratio of roots of sums of squares, or a sum of which each island gets its share.
//!
//! Walls that a force drives feel all that touch them, and join what they touch; such a problem is not divided.

use rayon::iter::{IntoParallelRefMutIterator, ParallelIterator};

use super::kinematics::Model;
use super::methods::{MethodMemory, SolveReport, fall_back, solve_by_method};
use super::problem::{Bodies, Row, StepProblem, is_solved};
use super::settings::{FrictionModel, SolverSettings, StopTest};
use crate::contact::JoinedGrains;
use crate::threads;

/// What is kept from one solve to the next. Results do not depend on it.
#[derive(Clone, Debug, Default)]
pub struct Memory<M: Model> {
    methods: MethodMemory,
    islands: Islands<M>,
}

/// Solves a prepared problem with the method of the settings: moves `problem.bodies` and fills in
/// the rows' impulses.
///
/// ```
/// use slump_core::contact::ContactList;
/// use slump_core::sim::ProblemVisitor;
/// use slump_core::solver::{Memory, Method, Model, SolverSettings, StepProblem, residual, solve};
///
/// /// What one method leaves undone.
/// struct Left(Method);
///
/// impl ProblemVisitor for Left {
///     type Output = f64;
///
///     fn visit<M: Model>(self, problem: &mut StepProblem<M>, _: &ContactList) -> f64 {
///         let settings = SolverSettings { method: self.0, ..SolverSettings::default() };
///         solve(problem, &mut Memory::default(), &settings);
///         residual(problem)
///     }
/// }
///
/// let simulation = slump_core::scene::built_in("column")?.simulation()?;
/// assert!(simulation.next_problem(Left(Method::Newton)) < 1e-3);
/// # Ok::<(), slump_core::error::Error>(())
/// ```
// Compiled once, with the library, for all models there are: who calls it with one of them compiles none of it anew.
#[inline(never)]
pub fn solve<M: Model>(
    problem: &mut StepProblem<M>,
    memory: &mut Memory<M>,
    settings: &SolverSettings,
) -> SolveReport {
    if problem.rows.is_empty() {
        return SolveReport::nothing_yet();
    }
    if settings.falls_back() && problem.friction.model != FrictionModel::Coulomb {
        // An earlier solve of the same problem fell back.
        problem.forget_bounds();
    }
    let Memory { methods, islands } = memory;
    // Walls that a force drives join what they touch.
    let is_divided = settings.islands && !problem.is_driven() && islands.divide(problem);
    let mut report = if is_divided {
        islands.solve(problem, settings)
    } else {
        solve_by_method(problem, methods, settings)
    };
    // What is left in a small island may be little beside what moves in the others.
    let may_be = report.converged || is_divided && settings.stop == StopTest::Residual;
    report.converged = may_be && is_solved(problem, settings);
    report.stalled &= !report.converged;
    // What solves bounds of friction knows of no walls that a force drives.
    let falls_back = M::FRICTION && settings.falls_back() && !problem.is_driven();
    if report.converged || !falls_back {
        return report;
    }
    if is_divided {
        return islands.fall_back(problem);
    }
    fall_back(problem, &mut methods.interior_point, report)
}

/// What has no number yet.
const NONE: u32 = u32::MAX;

/// One island of a problem, with the memory of its method.
#[derive(Clone, Debug, Default)]
struct Island<M: Model> {
    /// Its contacts in the order of the whole, with grains numbered anew; in the place of the contact behind each row
    /// stands the row of the whole.
    problem: StepProblem<M>,
    /// The grains' numbers in the whole.
    grains: Vec<u32>,
    memory: MethodMemory,
    report: SolveReport,
}

/// The islands of a problem. Memory is kept between steps.
#[derive(Clone, Debug, Default)]
struct Islands<M: Model> {
    islands: Vec<Island<M>>,
    /// How many of these are of the present problem.
    count: usize,
    /// Which island each grain is of, and its number there.
    island_of: Vec<u32>,
    numbers: Vec<u32>,
}

impl<M: Model> Islands<M> {
    /// Divides a problem into its islands. Whether there are several.
    fn divide(&mut self, problem: &StepProblem<M>) -> bool {
        self.find(problem);
        if self.count < 2 {
            return false;
        }
        if self.islands.len() < self.count {
            self.islands.resize_with(self.count, Island::default);
        }
        self.islands[..self.count].iter_mut().for_each(|island| island.begin(problem));
        self.numbers.fill(NONE);
        for (number, row) in problem.rows() {
            let island = &mut self.islands[self.island_of[row.i as usize] as usize];
            island.add(number, row, &mut self.numbers, problem);
        }
        true
    }

    /// Tells which islands the contacts of a problem make.
    fn find(&mut self, problem: &StepProblem<M>) {
        let grains = problem.bodies.now.len();
        let mut sets = JoinedGrains::apart(grains);
        for row in &problem.rows.pairs {
            sets.join(row.i, row.j);
        }
        // Islands are numbered as rows first meet them, whichever grain stands for one.
        self.numbers.clear();
        self.numbers.resize(grains, NONE);
        self.count = 0;
        for row in problem.rows.iter() {
            let number = &mut self.numbers[sets.of(row.i) as usize];
            if *number == NONE {
                *number = self.count as u32;
                self.count += 1;
            }
        }
        self.island_of.clear();
        self.island_of
            .extend((0..grains as u32).map(|grain| self.numbers[sets.of(grain) as usize]));
    }

    /// Solves the islands of a problem that was divided.
    fn solve(&mut self, problem: &mut StepProblem<M>, settings: &SolverSettings) -> SolveReport {
        let contacts = problem.rows.len() as f64;
        let solve = |island: &mut Island<M>| {
            let share = match settings.stop {
                StopTest::ImpulsePerMass => island.problem.rows.len() as f64 / contacts,
                StopTest::RelativeChange | StopTest::Residual | StopTest::VelocityError => 1.0,
            };
            let tolerance = share * settings.tolerance;
            let settings = SolverSettings { tolerance, ..*settings };
            island.report = solve_by_method(&mut island.problem, &mut island.memory, &settings);
        };
        let islands = &mut self.islands[..self.count];
        if threads::are_there() {
            islands.par_iter_mut().for_each(solve);
        } else {
            islands.iter_mut().for_each(solve);
        }
        self.join(problem)
    }

    /// Puts in the place of what was not solved the solution under bounds of friction, island by island.
    fn fall_back(&mut self, problem: &mut StepProblem<M>) -> SolveReport {
        let islands = &mut self.islands[..self.count];
        for island in islands.iter_mut().filter(|island| !island.report.converged) {
            let Island { problem, memory, report, .. } = island;
            *report = fall_back(problem, &mut memory.interior_point, *report);
        }
        let report = self.join(problem);
        if report.fell_back {
            // What was solved under Coulomb's law is solved under the bounds that it came to itself.
            problem.bound_by_present();
            self.join(problem);
        }
        report
    }

    /// Gives a problem what became of its islands, and tells how the solve of the whole ended.
    fn join(&self, problem: &mut StepProblem<M>) -> SolveReport {
        let mut all = SolveReport::nothing_yet();
        for island in &self.islands[..self.count] {
            island.join(problem);
            all.add_beside(island.report);
        }
        all
    }
}

impl<M: Model> Island<M> {
    /// Nothing of a problem yet but what all of its contacts share.
    fn begin(&mut self, whole: &StepProblem<M>) {
        let Self { problem, grains, .. } = self;
        grains.clear();
        let Bodies { now, before, free, masses, mean_mass } = &mut problem.bodies;
        for bodies in [now, before, free] {
            bodies.clear();
        }
        masses.clear();
        *mean_mass = whole.bodies.mean_mass;
        problem.rows.clear();
        problem.walls.speeds.clear();
        problem.friction.at_start.clear();
        problem.friction.now.clear();
        problem.friction.model = whole.friction.model;
        problem.law = whole.law;
        problem.fall_speed = whole.fall_speed;
    }

    /// Adds a row of the whole, with what there is beside it.
    fn add(&mut self, number: usize, row: &Row<M>, numbers: &mut [u32], whole: &StepProblem<M>) {
        let i = self.number_of(row.i, numbers, whole);
        let j = match whole.rows.is_pair(number) {
            true => self.number_of(row.j, numbers, whole),
            false => row.j,
        };
        let problem = &mut self.problem;
        problem.rows.push_copy(&whole.rows, number, |row| (row.i, row.j) = (i, j));
        problem.rows.captures.extend(whole.rows.captures.get(number));
        problem.walls.speeds.extend(whole.walls.speeds.get(number));
        problem.friction.at_start.extend(whole.friction.at_start.get(number));
        problem.friction.now.extend(whole.friction.now.get(number));
    }

    /// The number that a grain has here, and a new one where it has none.
    fn number_of(&mut self, grain: u32, numbers: &mut [u32], whole: &StepProblem<M>) -> u32 {
        let number = &mut numbers[grain as usize];
        if *number == NONE {
            *number = self.grains.len() as u32;
            self.grains.push(grain);
            let (bodies, at) = (&mut self.problem.bodies, grain as usize);
            bodies.now.push(whole.bodies.now[at]);
            bodies.before.push(whole.bodies.before[at]);
            bodies.free.push(whole.bodies.free[at]);
            bodies.masses.push(whole.bodies.masses[at]);
        }
        *number
    }

    /// Gives the whole what became of this part of it. Where friction lags in the whole, it lags as in this part.
    fn join(&self, whole: &mut StepProblem<M>) {
        let Self { problem, grains, .. } = self;
        for (&grain, body) in grains.iter().zip(&problem.bodies.now) {
            whole.bodies.now[grain as usize] = *body;
        }
        let lags = problem.friction.model != FrictionModel::Coulomb;
        for ((at, row), &number) in problem.rows().zip(&problem.rows.contacts) {
            let of_whole = whole.rows.get_mut(number as usize);
            of_whole.shifted_impulse = row.shifted_impulse;
            of_whole.tangential_impulse = row.tangential_impulse;
            if let (true, Some(lagged)) = (lags, whole.friction.now.get_mut(number as usize)) {
                *lagged = problem.friction.now[at];
            }
        }
    }
}
