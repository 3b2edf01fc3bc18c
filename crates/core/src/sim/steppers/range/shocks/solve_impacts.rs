//! Solution of one pass (a group of shocks, or collisions, that are computed together): the struck pairs form a contact
//! problem of their own, without the other contacts of the step.

use glam::DVec2;

use super::{NEVER, NextImpact, Role, Shocks, Touch, along_axes, along_normal, grains, scale};
use crate::number::Parts;
use crate::sim::stepping::StepResult;
use crate::solver::{
    FrictionModel, Measures, Memory, Method, Model, SolveReport, SolverSettings, StepProblem,
    StopTest, measure, solve, sweep,
};

/// Number of contacts up to which shocks (collisions) that are computed together are first solved to the small
/// tolerance of [`TIGHTLY`]. With more contacts, or if this does not succeed, they are solved to the tolerance of the
/// step.
const FEW: usize = 16;

/// Solver settings for shocks (collisions) with few contacts, for which a small tolerance costs almost nothing: method
/// `nsgs`, residual 1e-13, at most 500 sweeps.
const TIGHTLY: SolverSettings = SolverSettings::to_residual(Method::Nsgs, 1e-13, 500);

/// Upper limit for the residual (relative error) to which shocks (collisions) are solved, unless the tolerance of the
/// step is larger. The residual is chosen such that a contact's impulse has at most the same absolute error in the
/// shocks as in the step. If the impulses of the shocks are much smaller than those of the step, this residual would
/// allow errors as large as the impulses themselves; this limit prevents that.
const LOOSEST: f64 = 1e-3;

/// Solves the contact problem `part` of shocks (collisions) that share grains: to a smaller tolerance than the step if
/// it has few contacts and this succeeds, otherwise to the tolerance of the step. `least` is the largest error that the
/// impulse of a contact of the step may have, N·s.
fn solve_together<M: Model>(
    part: &mut StepProblem<M>,
    memory: &mut Memory,
    settings: &SolverSettings,
    model: FrictionModel,
    least: f64,
) -> SolveReport {
    let mut earlier = SolveReport::default();
    if part.rows.contacts.len() <= FEW {
        let tolerance = match settings.stop {
            StopTest::Residual => settings.tolerance.min(TIGHTLY.tolerance),
            _ => TIGHTLY.tolerance,
        };
        earlier = solve(part, memory, &SolverSettings { tolerance, ..TIGHTLY });
        if earlier.converged {
            return earlier;
        }
    }
    part.begin_friction(model);
    let of_step = (least / scale(part)).min(LOOSEST);
    let tolerance = match settings.stop {
        StopTest::Residual => settings.tolerance.max(of_step),
        _ => settings.tolerance,
    };
    solve(part, memory, &SolverSettings { tolerance, ..*settings }).after(earlier)
}

impl Shocks {
    /// Fills the contact problem `part` with pairs that are struck in this pass (a group of collisions that are
    /// computed together). If `alone` is true, takes the pairs that share no grain with another struck pair, otherwise
    /// all other struck pairs. Returns true if there are such pairs.
    pub(super) fn set_up<M: Model>(
        &mut self,
        problem: &mut StepProblem<M>,
        part: &mut StepProblem<M>,
        alone: bool,
    ) -> bool {
        part.rows.clear();
        for number in 0..self.pairs.len() {
            let root = self.root(problem.rows.get(number).i as usize);
            let (moment, rows) = self.bodies[root].cluster;
            if self.pairs[number].role == Role::Apart || moment == NEVER || (rows == 1) != alone {
                continue;
            }
            let restitution_velocity = self.strike_row(problem, number);
            part.rows.push_copy(&problem.rows, number, |row| {
                row.restitution_velocity = restitution_velocity;
                (row.shifted_impulse, row.tangential_impulse) = (0.0, 0.0);
            });
            self.pairs[number].struck_at = moment;
        }
        if part.rows.is_empty() {
            return false;
        }
        for copy in [&mut part.bodies.before, &mut part.bodies.free, &mut part.bodies.now] {
            copy.clone_from(&problem.bodies.before);
        }
        part.bodies.masses.clone_from(&problem.bodies.masses);
        part.bodies.mean_mass = problem.bodies.mean_mass;
        part.law = problem.law.with_capture_speed(0.0);
        part.hold_errors_against(problem);
        // Drop the friction bounds in `part`, which belong to the rows of earlier shocks.
        part.forget_bounds();
        true
    }

    /// Returns the term, m/s, that the law of collisions adds to the normal velocity of contact `number` at the end of
    /// the collision. It is the sum of the restitution term, the velocity that gravity adds until the gap of the pair
    /// closes (0 for two grains, and for a pair that already touches), and minus the velocity of a moving wall. If the
    /// gap closes within the step, also sets the contact normal to the normal at the time when it closes.
    fn strike_row<M: Model>(&mut self, problem: &mut StepProblem<M>, number: usize) -> f64 {
        let numbers = self.numbers;
        let mut wall_speed = problem.wall_speed(number);
        let (i, j) = grains(problem, number);
        let pair = &mut self.pairs[number];
        let (mut gained, mut closing) = (0.0, pair.speed);
        if let (Role::Struck, NextImpact::Meets { secs, normal }) = (pair.role, pair.next) {
            wall_speed = problem.turn_row(number, normal);
            let (row, before) = (problem.rows.get(number), &problem.bodies.before);
            let [speed, _] = j.map_or_else(
                || M::velocity(row.normal, &before[i]),
                |j| M::relative_velocity(row.normal, &before[i], &before[j]),
            );
            pair.speed = speed - wall_speed;
            pair.normal = normal;
            gained = pair.acceleration * secs;
            (pair.gap, pair.shift) = (0.0, 0.0);
            pair.gap = -pair.gap_at(secs);
            pair.touch = Touch::Met;
            let stored = pair.stretch * problem.law.capture_speed();
            let squared = (pair.speed + gained).powi(2) + 2.0 * stored / numbers.time_step_secs;
            closing = -squared.sqrt();
        }
        pair.gained = gained;
        self.fastest = self.fastest.max((-closing).positive_part());
        let bounce = if closing < 0.0 {
            numbers.rebound(closing)
        } else {
            numbers.parameters.restitution * closing
        };
        bounce + gained - wall_speed
    }

    /// Solves the contact problem in `part`, and stores its impulses and velocities as results of the shocks
    /// (collisions). If `alone` is true, the pairs share no grain, so a single sweep over the contacts is exact.
    pub(super) fn solve<M: Model>(
        &mut self,
        problem: &mut StepProblem<M>,
        part: &mut StepProblem<M>,
        memory: &mut Memory,
        settings: &SolverSettings,
        alone: bool,
        result: &mut StepResult,
    ) {
        let mut report = if alone {
            sweep::<M, false>(part);
            SolveReport::nothing_yet()
        } else {
            solve_together::<M>(part, memory, settings, problem.friction.model, self.least)
        };
        let measures = measure(part);
        let Measures { residual, normal_work, mut tangential_work, border_work, .. } = measures;
        let [wall_work, of_surfaces] =
            problem.surface_works_of(part, |number| part.rows.contacts[number] as usize);
        tangential_work += of_surfaces;
        // The residual of the shocks has the scale (denominator) of their own problem. This makes it relative to the
        // scale of the step if that is larger.
        let residual = residual * (settings.tolerance * scale(part) / self.least).min(1.0);
        if alone && settings.stop == StopTest::Residual {
            // A single sweep is exact except for rounding, which may exceed the tolerance.
            report.converged = residual <= settings.tolerance;
        }
        let mut measures = Measures {
            residual,
            normal_work,
            tangential_work,
            wall_work,
            border_work,
            ..Measures::default()
        };
        for ((_, row), &number) in part.rows().zip(&part.rows.contacts) {
            let pair = &mut self.pairs[number as usize];
            pair.impulse += row.shifted_impulse;
            self.of_shocks.push((number as usize, along_normal(row, row.impulse())));
            let of_gravity = row.effective_mass * row.shifted_impulse * pair.gained;
            measures.normal_work += of_gravity;
            result.gravity_work -= of_gravity;
        }
        result.add(StepResult { report, measures, ..StepResult::default() });
        for (grain, after) in part.bodies.now.iter().enumerate() {
            let root = self.root(grain);
            let (moment, rows) = self.bodies[root].cluster;
            if moment == NEVER || (rows == 1) != alone {
                continue;
            }
            let [before, after] = [&problem.bodies.before[grain], after].map(M::coordinates);
            if before == after {
                continue;
            }
            let shift = std::array::from_fn(|axis| -moment * (after[axis] - before[axis]));
            let body = &mut self.bodies[grain];
            body.offset = std::array::from_fn(|axis| body.offset[axis] + shift[axis]);
            body.shift = along_axes::<M>(&M::from_coordinates(shift));
            body.since = body.since.max(moment);
            body.struck_in_step = true;
            body.struck_in_pass = true;
            M::set(&mut problem.bodies.before[grain], after);
        }
    }

    /// Updates the gaps and normal velocities of all pairs with a grain that was struck in this pass (the group of
    /// collisions computed last), and marks their next impacts as unknown.
    pub(super) fn move_on<M: Model>(&mut self, problem: &StepProblem<M>) {
        let bodies = &self.bodies;
        let shift = |grain: usize| {
            if bodies[grain].struck_in_pass { bodies[grain].shift } else { DVec2::ZERO }
        };
        for (number, row) in problem.rows() {
            let (i, j) = grains(problem, number);
            let is_struck = |grain: usize| bodies[grain].struck_in_pass;
            if !is_struck(i) && !j.is_some_and(is_struck) {
                continue;
            }
            let before = &problem.bodies.before;
            let [speed, _] = j.map_or_else(
                || M::velocity(row.normal, &before[i]),
                |j| M::relative_velocity(row.normal, &before[i], &before[j]),
            );
            let pair = &mut self.pairs[number];
            pair.speed = speed - problem.wall_speed(number);
            pair.shift += pair.normal.dot(shift(i) - j.map_or(DVec2::ZERO, shift));
            pair.next = NextImpact::Unknown;
        }
        for body in &mut self.bodies {
            body.struck_in_pass = false;
        }
    }
}
