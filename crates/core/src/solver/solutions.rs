//! The solutions that one step has under Coulomb's law.
//!
//! The law is not convex, so a step of a pile that flows can have several solutions, and where a method starts decides
//! which of them it finds. Here conjugate gradients start from several impulses: those of the step before, none, and
//! random ones that the law allows. Newton's method continues from where they end if that brings it nearer.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::kinematics::Model;
use super::method::Method;
use super::methods::Memory;
use super::problem::{StepProblem, measure, residual};
use super::settings::SolverSettings;
use super::solve::solve;

/// Sweeps of Newton's method at the end of each search at the most.
const NEWTON_STEPS: u32 = 400;

/// Searches end with it up to this number of contacts.
const CONTACTS_FOR_NEWTON: usize = 10_000;

/// How solutions are looked for.
#[derive(Clone, Copy, Debug)]
pub struct SolutionSearch {
    /// From how many starts: the impulses of the step before, none, then random ones.
    pub starts: u32,
    /// Of the random ones.
    pub seed: u64,
    /// Up to so many sweeps from each.
    pub max_sweeps: u32,
    /// The residual at which a search ends.
    pub tolerance: f64,
}

/// What one or more starts led to.
#[derive(Clone, Debug)]
pub struct Solution<M: Model> {
    /// The problem, solved under Coulomb's law.
    pub problem: StepProblem<M>,
    /// The common residual.
    pub residual: f64,
    /// How far its velocities are taken to be from those of a solution, m/s.
    pub velocity_error: f64,
    /// The starts that led there, from 0.
    pub starts: Vec<u32>,
}

impl SolutionSearch {
    /// Looks for solutions. Two results are one solution unless they are farther apart than both are taken to be from
    /// theirs.
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

    /// What one start leads to.
    pub fn from<M: Model>(&self, problem: &StepProblem<M>, start: u32) -> Solution<M> {
        let mut found = problem.clone();
        found.take_coulombs_law();
        self.begin(&mut found, start);
        let mut memory = Memory::default();
        let sweeps = SolverSettings::to_residual(Method::Nncg, self.tolerance, self.max_sweeps);
        let report = solve(&mut found, &mut memory, &sweeps);
        let mut left = residual(&found);
        // Newton's method does not take walls that a force drives.
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

    /// Gives a problem the impulses of a start.
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
            .collect();
        problem.write_impulses(impulses);
    }
}

/// How far the velocities of two solutions of one problem are apart, m/s: the root mean square over the grains that touch
/// something, weighted with mass; spins count with the radius of gyration.
pub fn velocity_distance<M: Model>(one: &StepProblem<M>, other: &StepProblem<M>) -> f64 {
    distance_to_velocities(one, &velocities(other))
}

/// The same, to velocities that were taken down by [`velocities`]: the problem may be laid out for another method.
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

/// The velocities of all grains by the coordinates of the model: m/s, and rad/s for spins.
pub fn velocities<M: Model>(problem: &StepProblem<M>) -> Vec<[f64; 3]> {
    problem.bodies.now.iter().map(M::coordinates).collect()
}
