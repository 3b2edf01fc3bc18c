//! Visits the contacts of a problem in the order of its rows (the data of one contact each), with the relative
//! velocities of each contact, and adds up sums over the contacts.

use std::ops::Range;

use super::{Row, StepProblem};
use crate::solver::kinematics::Model;
use crate::threads;

/// Relative (normal, tangential) velocities of one contact, m/s. If the grain touches a moving surface, the tangential
/// velocity is relative to that surface.
pub struct RowVelocities {
    /// Normal and tangential velocity at the end of the step, m/s.
    pub now: [f64; 2],
    /// Normal and tangential velocity at the beginning of the step, m/s.
    pub before: [f64; 2],
    /// Normal and tangential velocity at the end of the step if no contact acted, m/s.
    pub free: [f64; 2],
}

/// Calls `visit` for each contact of a problem with the number of its row, the row (data of the contact) and its
/// relative velocities.
pub fn for_each_row<M: Model>(
    problem: &StepProblem<M>,
    visit: impl FnMut(usize, &Row<M>, RowVelocities),
) {
    for_each_row_of(problem, 0..problem.rows.len(), visit);
}

/// Computes a sum over the contacts, in chunks of fixed length, so that the result is the same for any number of
/// threads: `visit` adds a row (data of one contact) to the sum of its chunk, and `join` adds the sum of the next chunk
/// to the total.
pub(super) fn sum_of_rows<M: Model, S: Default + Send>(
    problem: &StepProblem<M>,
    visit: impl Fn(&mut S, (usize, &Row<M>), RowVelocities) + Sync,
    join: impl Fn(&mut S, S),
) -> S {
    let of_stretch = |stretch: Range<usize>| {
        let mut sum = S::default();
        for_each_row_of(problem, stretch, |number, row, motion| {
            visit(&mut sum, (number, row), motion);
        });
        sum
    };
    let mut all = S::default();
    threads::add_up(problem.rows.len(), of_stretch, |sum| join(&mut all, sum));
    all
}

#[inline(always)]
fn for_each_row_of<M: Model>(
    problem: &StepProblem<M>,
    rows: Range<usize>,
    mut visit: impl FnMut(usize, &Row<M>, RowVelocities),
) {
    let (bodies, fixed) = (&problem.bodies, problem.rows.fixed.len());
    for number in rows.start..rows.end.min(fixed) {
        let row = &problem.rows.fixed[number];
        let [now, before, free] =
            [&bodies.now, &bodies.before, &bodies.free].map(|bodies| row.velocity(bodies));
        // Without contacts a driven wall, too, would have another speed, and v^free is relative to that speed.
        let free = problem.free_part(number, row, free).unwrap_or(free);
        visit(number, row, RowVelocities { now, before, free });
    }
    for number in rows.start.max(fixed)..rows.end {
        let row = &problem.rows.pairs[number - fixed];
        let [now, before, free] =
            [&bodies.now, &bodies.before, &bodies.free].map(|bodies| row.velocity(bodies));
        visit(number, row, RowVelocities { now, before, free });
    }
}

/// Writes the normal velocity of every contact, m/s, to `speeds`, which is cleared first. The velocities follow from
/// the body velocities `bodies`, and are relative to the wall if it moves.
pub fn relative_velocities<M: Model>(
    problem: &StepProblem<M>,
    bodies: &[M::Body<f64>],
    speeds: &mut Vec<f64>,
) {
    speeds.clear();
    speeds.reserve(problem.rows.len());
    problem.for_each_velocity(bodies, |_, [normal, _]| speeds.push(normal));
    for (speed, wall_speed) in speeds.iter_mut().zip(&problem.walls.speeds) {
        *speed -= wall_speed;
    }
}
