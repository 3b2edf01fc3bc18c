//! How the bodies of a problem move relative to each other.

use std::ops::Range;

use super::kinematics::Kinematics;
use super::step_problem::{Row, StepProblem};
use crate::threads;

/// Where nothing would move without contacts, errors of up to this share of the impulses are what
/// rounding left, and no residual. Smaller: methods that scale impulses would not have solved a step in
/// which nothing happens; larger: errors would go unseen.
pub(super) const ROUNDING: f64 = 1e-14;

/// Relative (normal, tangential) velocities of one contact, m/s: along the tangent relative to a surface that
/// moves.
pub struct Motion {
    /// At the end of the step.
    pub now: [f64; 2],
    /// At its beginning.
    pub before: [f64; 2],
    /// At the end if no contact acted.
    pub free: [f64; 2],
}

/// Visits the rows with their numbers and motions.
pub fn for_each_row<K: Kinematics>(
    problem: &StepProblem<K>,
    visit: impl FnMut(usize, &Row<K>, Motion),
) {
    for_each_row_of(problem, 0..problem.fixed_rows.len() + problem.pair_rows.len(), visit);
}

/// Adds up what rows come to, in stretches of one length: `visit` adds a row to the sum of its stretch, `join` that of
/// the next stretch to those before.
pub(super) fn sum_of_rows<K: Kinematics, S: Default + Send>(
    problem: &StepProblem<K>,
    visit: impl Fn(&mut S, (usize, &Row<K>), Motion) + Sync,
    join: impl Fn(&mut S, S),
) -> S {
    let rows = problem.fixed_rows.len() + problem.pair_rows.len();
    let of_stretch = |stretch: Range<usize>| {
        let mut sum = S::default();
        for_each_row_of(problem, stretch, |number, row, motion| {
            visit(&mut sum, (number, row), motion);
        });
        sum
    };
    let mut all = S::default();
    threads::add_up(rows, of_stretch, |sum| join(&mut all, sum));
    all
}

#[inline(always)]
fn for_each_row_of<K: Kinematics>(
    problem: &StepProblem<K>,
    rows: Range<usize>,
    mut visit: impl FnMut(usize, &Row<K>, Motion),
) {
    let fixed = problem.fixed_rows.len();
    for number in rows.start..rows.end.min(fixed) {
        let row = &problem.fixed_rows[number];
        let of = |bodies: &[K::Body<f64>]| row.velocity(&bodies[row.i as usize]);
        let (now, before, free) = (of(&problem.bodies), of(&problem.before), of(&problem.free));
        // Without contacts a driven wall would go otherwise, too.
        let free = problem.free_part(number, row, free).unwrap_or(free);
        visit(number, row, Motion { now, before, free });
    }
    for number in rows.start.max(fixed)..rows.end {
        let row = &problem.pair_rows[number - fixed];
        let of = |bodies: &[K::Body<f64>]| {
            K::relative_velocity(row.normal, &bodies[row.i as usize], &bodies[row.j as usize])
        };
        let (now, before, free) = (of(&problem.bodies), of(&problem.before), of(&problem.free));
        visit(number, row, Motion { now, before, free });
    }
}

/// v_n of every row among `bodies`, relative to a wall that moves, m/s; `speeds` is cleared first.
pub fn relative_velocities<K: Kinematics>(
    problem: &StepProblem<K>,
    bodies: &[K::Body<f64>],
    speeds: &mut Vec<f64>,
) {
    speeds.clear();
    speeds.reserve(problem.contact_of_row.len());
    problem.for_each_velocity(bodies, |_, [normal, _]| speeds.push(normal));
    for (speed, wall_speed) in speeds.iter_mut().zip(&problem.wall_speeds) {
        *speed -= wall_speed;
    }
}
