//! A sweep where walls are driven (`problem::driven`): what a contact does to its wall is told to the wall at once, and
//! each contact is solved for its wall's answer as for its grain's.

use crate::contact::law;
use crate::solver::methods::shared::update::{Body, Change, Law};
use crate::solver::problem::{DrivenRow, DrivenWall, Kinematics, Model, Row, StepProblem};

/// One pass over all contacts, from the last to the first where it goes backward.
pub(super) fn pass<M: Model, const MEASURE: bool, const BACKWARD: bool>(
    problem: &mut StepProblem<M::Kinematics>,
) -> Change {
    let law = Law::of(problem);
    let mut change = Change::default();
    if BACKWARD {
        for row in problem.pair_rows.iter_mut().rev() {
            law.solve_pair_among::<M, MEASURE>(row, &mut problem.bodies, &mut change);
        }
        for number in (0..problem.fixed_rows.len()).rev() {
            solve_single::<M, MEASURE>(&law, problem, number, &mut change);
        }
    } else {
        for number in 0..problem.fixed_rows.len() {
            solve_single::<M, MEASURE>(&law, problem, number, &mut change);
        }
        for row in &mut problem.pair_rows {
            law.solve_pair_among::<M, MEASURE>(row, &mut problem.bodies, &mut change);
        }
    }
    problem.tell_of_walls();
    change
}

fn solve_single<M: Model, const MEASURE: bool>(
    law: &Law,
    problem: &mut StepProblem<M::Kinematics>,
    number: usize,
    change: &mut Change,
) {
    let row = &mut problem.fixed_rows[number];
    let i = &mut problem.bodies[row.i as usize];
    match problem.driven.row(number).copied() {
        None => law.solve_single_row::<M, MEASURE>(row, i, change),
        Some(known) => {
            let wall = &mut problem.driven.walls[known.by.wall as usize];
            let impulse = solve_driven::<M>(law, (row, &known), i, wall);
            change.add::<M, MEASURE>(row.effective_mass, impulse);
        }
    }
}

/// Solves the contact of a grain with a driven wall, and returns the change of (λ_n, λ_t). A normal impulse moves the
/// wall along the tangent, too, where it goes askew, so the tangential velocity is read after it.
fn solve_driven<M: Model>(
    law: &Law,
    (row, known): (&mut Row<M::Kinematics>, &DrivenRow),
    i: &mut Body<M, f64>,
    wall: &mut DrivenWall,
) -> [f64; 2] {
    let [along_normal, along_tangent] = known.by.along;
    let answer = wall.response * row.effective_mass;
    let [normal_velocity, _] = M::Kinematics::velocity(row.normal, i);
    let closing = normal_velocity + known.still[0] - along_normal * wall.now;
    let before = row.shifted_impulse;
    let compliance = 1.0 + answer * along_normal * along_normal;
    row.shifted_impulse = law::signorini(before - closing / compliance);
    let normal = row.shifted_impulse - before;
    M::Kinematics::push_single(i, row.normal, [normal, 0.0]);
    wall.now -= answer * along_normal * normal;
    if !M::FRICTION {
        return [normal, 0.0];
    }
    let [_, tangential_velocity] = M::Kinematics::velocity(row.normal, i);
    let slip = tangential_velocity - known.still[1] - along_tangent * wall.now;
    let before = row.tangential_impulse;
    let compliance = M::Kinematics::TANGENTIAL_COMPLIANCE + answer * along_tangent * along_tangent;
    let bound = law.friction_bound::<M>(row.shifted_impulse);
    row.tangential_impulse = law::coulomb(before - slip / compliance, bound);
    let tangential = row.tangential_impulse - before;
    M::Kinematics::push_single(i, row.normal, [0.0, tangential]);
    wall.now -= answer * along_tangent * tangential;
    [normal, tangential]
}
