//! Search for several solutions of one step under Coulomb's law.
//!
//! Coulomb's law is not convex, so a step of a flowing pile can have several solutions, and the initial impulses decide
//! which solution a method finds. This search starts conjugate gradients from several sets of initial impulses: the
//! impulses of the previous step, zero, and random impulses that the law allows. If the conjugate gradients do not
//! reach the tolerance, Newton's method continues from their result, in problems of at most 10,000 contacts without
//! walls that a force drives. Of the two results, the search returns the result with the smaller residual.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::kinematics::Model;
use super::method::Method;
use super::methods::Memory;
use super::problem::{StepProblem, measure, residual};
use super::settings::SolverSettings;
use super::solve::solve;

/// Maximum number of iterations of Newton's method, which continues from the result of the conjugate gradients if they
/// do not reach the tolerance of a search. With a larger number, a search in a step without a solution takes longer;
/// with a smaller number, Newton's method may stop before it reaches a solution.
const NEWTON_STEPS: u32 = 400;

/// Maximum number of contacts of a problem for which Newton's method continues from the result of the conjugate
/// gradients in a search. It limits the computing time, because an iteration of Newton's method factorises a matrix for
/// all bodies.
const CONTACTS_FOR_NEWTON: usize = 10_000;

/// Settings of a search for several solutions of one step.
#[derive(Clone, Copy, Debug)]
pub struct SolutionSearch {
    /// Number of searches. Search 0 starts from the impulses of the previous step, search 1 from zero impulses, and
    /// further searches start from random impulses.
    pub starts: u32,
    /// Seed of the random initial impulses.
    pub seed: u64,
    /// Maximum number of sweeps of conjugate gradients in each search.
    pub max_sweeps: u32,
    /// The residual, dimensionless, at which a search ends.
    pub tolerance: f64,
}

/// A solution of the contact problem of a step, found by one or more searches.
#[derive(Clone, Debug)]
pub struct Solution<M: Model> {
    /// The contact problem with the impulses and velocities of this solution. Its friction model is Coulomb's law.
    pub problem: StepProblem<M>,
    /// Residual, dimensionless: relative error of the impulses in the contact laws ([`super::residual`]).
    pub residual: f64,
    /// Estimated distance of the solution's velocities from the velocities of an exact solution, m/s.
    pub velocity_error: f64,
    /// Numbers of the searches that found this solution, counted from 0.
    pub starts: Vec<u32>,
}

impl SolutionSearch {
    /// Runs all searches and returns the distinct solutions. Two results count as one solution if the distance between
    /// their velocities is at most the sum of their estimated velocity errors.
    pub fn find<M: Model>(&self, problem: &StepProblem<M>) -> Vec<Solution<M>> {
        let mut found: Vec<Solution<M>> = Vec::new();
        for start in 0..self.starts {
            let next = self.from(problem, start);
            let same = found.iter_mut().find(|other| {
                let apart = velocity_distance(&next.problem, &other.problem);
                apart <= next.velocity_error + other.velocity_error
            });
            match same {
                Some(other) if other.residual <= next.residual => other.starts.push(start),
                Some(other) => {
                    let starts = other.starts.iter().copied().chain([start]).collect();
                    *other = Solution { starts, ..next };
                }
                None => found.push(next),
            }
        }
        found
    }

    /// Runs search number `start` on a copy of the problem and returns its result. The residual of the result may be
    /// above the tolerance.
    pub fn from<M: Model>(&self, problem: &StepProblem<M>, start: u32) -> Solution<M> {
        let mut found = problem.clone();
        found.take_coulombs_law();
        self.begin(&mut found, start);
        let mut memory = Memory::default();
        let sweeps = SolverSettings::to_residual(Method::Nncg, self.tolerance, self.max_sweeps);
        let report = solve(&mut found, &mut memory, &sweeps);
        let mut left = residual(&found);
        // Newton's method does not support walls that a force drives.
        if !report.converged && found.rows.len() <= CONTACTS_FOR_NEWTON && !found.is_driven() {
            let mut nearer = found.clone();
            let by_it = SolverSettings::to_residual(Method::Newton, self.tolerance, NEWTON_STEPS);
            solve(&mut nearer, &mut memory, &by_it);
            let of_nearer = residual(&nearer);
            if of_nearer < left {
                (found, left) = (nearer, of_nearer);
            }
        }
        let velocity_error = measure(&found).velocity_error;
        Solution { problem: found, residual: left, velocity_error, starts: vec![start] }
    }

    /// Writes the initial impulses of search number `start` to a problem. Search 0 keeps the present impulses, search 1
    /// starts from zero impulses, and further searches start from random impulses.
    fn begin<M: Model>(&self, problem: &mut StepProblem<M>, start: u32) {
        if start == 0 {
            return;
        }
        let mut random = Pcg64::seed_from_u64(self.seed.wrapping_add(u64::from(start)));
        let mut sum = 0.0;
        problem.for_each_velocity(&problem.bodies.free, |row, [normal, _]| {
            sum += row.shifted_impulse + normal.abs();
        });
        let mean = sum / problem.rows.len().max(1) as f64;
        let impulses: Vec<[f64; 2]> = (0..problem.rows.len())
            .map(|number| {
                if start == 1 {
                    return [problem.capture(number), 0.0];
                }
                let shifted = mean * random.random_range(0.0..2.0);
                let bound = if M::FRICTION { problem.law.friction_bound(shifted) } else { 0.0 };
                [shifted, bound * random.random_range(-1.0..=1.0)]
            })
            .chain(problem.rows.rolling.iter().map(|_| [0.0; 2]))
            .collect();
        problem.write_impulses(impulses);
    }
}

/// Returns the distance between the velocities of two solutions of one problem, m/s: the root mean square of the
/// velocity difference over the grains with contacts, weighted by mass. The spin of a grain counts as angular velocity
/// times radius of gyration.
pub fn velocity_distance<M: Model>(one: &StepProblem<M>, other: &StepProblem<M>) -> f64 {
    distance_to_velocities(one, &velocities(other))
}

/// Returns the distance, m/s, between the present velocities of a problem and `others`, earlier velocities of the same
/// grains that [`velocities`] returned. The distance is defined as in [`velocity_distance`]. The contacts of the
/// problem may have been sorted in another order in the meantime.
pub fn distance_to_velocities<M: Model>(problem: &StepProblem<M>, others: &[[f64; 3]]) -> f64 {
    let grains = problem.bodies.now.iter().zip(others).zip(&problem.bodies.masses);
    let squares = grains.map(|((one, other), mass)| {
        let one = M::coordinates(one);
        let along = |axis: usize| M::INERTIA_OVER_MASS[axis] * (one[axis] - other[axis]).powi(2);
        mass * (0..M::DEGREES).map(along).sum::<f64>()
    });
    let (squares, mass) = (squares.sum::<f64>(), problem.touching_mass());
    if mass > 0.0 { (squares / mass).sqrt() } else { 0.0 }
}

/// Returns the velocities of all grains, m/s: first the components along the axes of the model, then, if grains turn,
/// the spin r·ω (radius times angular velocity).
pub fn velocities<M: Model>(problem: &StepProblem<M>) -> Vec<[f64; 3]> {
    problem.bodies.now.iter().map(M::coordinates).collect()
}
