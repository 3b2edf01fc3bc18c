//! Gauss–Seidel sweeps over all contacts of a problem, with or without a stopping test.

use super::stopping::{SolveReport, is_settled};
use super::sweep::ImpulseChange;
use crate::solver::kinematics::Model;
use crate::solver::problem::{
    Bodies, ContactRows, CoulombFriction, DrivenRow, DrivenWall, FixedRow, FrictionProjection,
    PairRow, StepProblem, law_of_row, projection_residual, squared_impulses, velocity_error,
    with_projection,
};
use crate::solver::settings::{FrictionModel, SolverSettings};

/// Performs one sweep under the friction model of a problem. Returns true if the stopping test is met after the sweep.
pub(super) fn sweep_of_model<M: Model>(
    problem: &mut StepProblem<M>,
    settings: &SolverSettings,
    backward: bool,
) -> bool {
    with_projection!(problem, M, P => tested::<M, P>(problem, settings, backward))
}

/// Performs up to `sweeps` sweeps under the friction model of a problem. Returns true if the stopping test is met.
pub(super) fn settles_in<M: Model>(
    problem: &mut StepProblem<M>,
    settings: &SolverSettings,
    sweeps: u32,
    report: &mut SolveReport,
) -> bool {
    for _ in 0..sweeps {
        report.sweeps += 1;
        if sweep_of_model(problem, settings, false) {
            report.converged = true;
            break;
        }
    }
    report.converged
}

/// Performs one sweep under Coulomb's law. Returns true if the stopping test is met after the sweep.
pub(super) fn tested_sweep<M: Model>(
    problem: &mut StepProblem<M>,
    settings: &SolverSettings,
) -> bool {
    if problem.has_one_simple_law() {
        tested::<M, CoulombFriction<true>>(problem, settings, false)
    } else {
        tested::<M, CoulombFriction<false>>(problem, settings, false)
    }
}

fn tested<M: Model, P: FrictionProjection>(
    problem: &mut StepProblem<M>,
    settings: &SolverSettings,
    backward: bool,
) -> bool {
    let change = if settings.stop.judges_solutions() {
        sweep_by::<M, P, false>(problem, backward)
    } else {
        sweep_by::<M, P, true>(problem, backward)
    };
    let mean_mass = problem.bodies.mean_mass;
    let residual = |problem: &mut _| projection_residual::<M, P>(problem);
    let of_velocities = |problem: &mut _| velocity_error(problem);
    let squares = |problem: &mut _| squared_impulses(problem);
    is_settled(problem, change, mean_mass, settings, squares, residual, of_velocities)
}

/// Performs one sweep over all contacts under Coulomb's law. Returns the change of the impulses, which is measured if
/// `MEASURE` is set and otherwise 0.
pub fn sweep<M: Model, const MEASURE: bool>(problem: &mut StepProblem<M>) -> ImpulseChange {
    if problem.has_one_simple_law() {
        sweep_by::<M, CoulombFriction<true>, MEASURE>(problem, false)
    } else {
        sweep_by::<M, CoulombFriction<false>, MEASURE>(problem, false)
    }
}

/// Performs one sweep over all contacts, from the last contact to the first if `backward` is set, otherwise from the
/// first to the last. `P` limits the impulses of a contact to the impulses that the friction model allows. Returns the
/// change of the impulses, which is measured if `MEASURE` is set and otherwise 0.
pub(super) fn sweep_by<M: Model, P: FrictionProjection, const MEASURE: bool>(
    problem: &mut StepProblem<M>,
    backward: bool,
) -> ImpulseChange {
    if P::TAKES_DRIVES && problem.is_driven() {
        return pass::<M, P, MEASURE, true>(problem, backward);
    }
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx") {
        // SAFETY: AVX has just been detected.
        return unsafe { pass_with_avx::<M, P, MEASURE>(problem, backward) };
    }
    pass::<M, P, MEASURE, false>(problem, backward)
}

/// Performs one sweep over all contacts like the function `pass`, whose code is compiled here for the AVX instructions
/// of the processor. The arithmetic operations and their order are the same as without AVX, so the result is bitwise
/// the same. An AVX instruction writes its result to a separate register. Older instructions overwrite one of their
/// operands, which often has to be copied first.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx")]
fn pass_with_avx<M: Model, P: FrictionProjection, const MEASURE: bool>(
    problem: &mut StepProblem<M>,
    backward: bool,
) -> ImpulseChange {
    pass::<M, P, MEASURE, false>(problem, backward)
}

/// Performs one sweep over all contacts. Returns the change of the impulses, which is measured if `MEASURE` is set and
/// otherwise 0. If a force drives walls (`problem::walls`), the impulse of a contact changes the velocity of its wall
/// at once, and each contact is solved with the compliance of its wall as well as of its grain.
#[inline(always)]
fn pass<M: Model, P: FrictionProjection, const MEASURE: bool, const DRIVEN: bool>(
    problem: &mut StepProblem<M>,
    backward: bool,
) -> ImpulseChange {
    let law = problem.law;
    let lagged = &problem.friction.now;
    let Bodies { now: bodies, .. } = &mut problem.bodies;
    let ContactRows { fixed, pairs, frictions, captures, rolling, .. } = &mut problem.rows;
    let own_numbers = [&**frictions, captures];
    let walls = &mut problem.walls;
    let first_pair = fixed.len();
    // Without rolling friction the list of rolling resistances is empty.
    let fixed_count = first_pair.min(rolling.len());
    let (rolling_fixed, rolling_pairs) = rolling.split_at_mut(fixed_count);
    let law_of = |number| if P::TAKES_PAIRS { law_of_row(own_numbers, number, &law) } else { law };
    let project = |number: usize, before: [f64; 2]| {
        let lagged = if P::LAGS { lagged[number] } else { 0.0 };
        let law = law_of(number);
        move |trial| P::project::<M>(&law, lagged, relaxed::<P>(before, trial))
    };
    let mut change = ImpulseChange::default();
    let mut solve_fixed =
        |number: usize, row: &mut FixedRow<M>, bodies: &mut [_], change: &mut _| {
            if DRIVEN && let Some(known) = walls.driven_row(number).copied() {
                let wall = &mut walls.driven[known.by.wall as usize];
                let i = &mut bodies[row.i as usize];
                let impulse = solve_driven(project(number, [0.0; 2]), row, &known, i, wall);
                ImpulseChange::add::<M, MEASURE>(change, row.effective_mass, impulse);
            } else {
                row.solve::<MEASURE>(bodies, change, project(number, row.impulse()));
            }
            if M::ROLLING
                && let Some(rolling) = rolling_fixed.get_mut(number)
            {
                row.solve_rolling::<MEASURE>(rolling, None, &law_of(number), bodies, change);
            }
        };
    let mut roll_pair = |number: usize, row: &PairRow<M>, bodies: &mut [_], change: &mut _| {
        if M::ROLLING
            && let Some(rolling) = rolling_pairs.get_mut(number)
        {
            let law = law_of(first_pair + number);
            row.solve_rolling::<MEASURE>(rolling, Some(row.share), &law, bodies, change);
        }
    };
    if backward {
        for (number, row) in pairs.iter_mut().enumerate().rev() {
            let project = project(first_pair + number, row.impulse());
            row.solve::<MEASURE>(bodies, &mut change, project);
            roll_pair(number, row, bodies, &mut change);
        }
        for (number, row) in fixed.iter_mut().enumerate().rev() {
            solve_fixed(number, row, bodies, &mut change);
        }
    } else {
        for (number, row) in fixed.iter_mut().enumerate() {
            solve_fixed(number, row, bodies, &mut change);
        }
        for (number, row) in pairs.iter_mut().enumerate() {
            let project = project(first_pair + number, row.impulse());
            row.solve::<MEASURE>(bodies, &mut change, project);
            roll_pair(number, row, bodies, &mut change);
        }
    }
    if DRIVEN {
        problem.tell_of_walls();
    }
    change
}

/// Returns trial impulses that are over-relaxed: from the present impulses `before` they are as far as the impulses
/// `trial` times the relaxation factor of the projection.
#[inline(always)]
fn relaxed<P: FrictionProjection>(before: [f64; 2], trial: [f64; 2]) -> [f64; 2] {
    if P::RELAXATION == 1.0 {
        return trial;
    }
    [0, 1].map(|axis| before[axis] + P::RELAXATION * (trial[axis] - before[axis]))
}

/// Solves the contact of a grain with a wall that a force drives. Returns the change of the normal and tangential
/// impulse divided by the effective mass, m/s. If the wall moves obliquely to the contact's normal, a normal impulse
/// also changes the wall's speed along the tangent, so the tangential velocity is computed after the normal update.
fn solve_driven<M: Model>(
    project: impl Fn([f64; 2]) -> [f64; 2],
    row: &mut FixedRow<M>,
    known: &DrivenRow,
    i: &mut M::Body<f64>,
    wall: &mut DrivenWall,
) -> [f64; 2] {
    let [along_normal, along_tangent] = known.by.along;
    let answer = wall.response * row.effective_mass;
    let [normal_velocity, _] = M::velocity(row.normal, i);
    let closing = normal_velocity + known.still[0] - along_normal * wall.now;
    let before = row.shifted_impulse;
    let compliance = 1.0 + answer * along_normal * along_normal;
    [row.shifted_impulse, _] = project([before - closing / compliance, 0.0]);
    let normal = row.shifted_impulse - before;
    M::push_single(i, row.normal, [normal, 0.0]);
    wall.now -= answer * along_normal * normal;
    if !M::FRICTION {
        return [normal, 0.0];
    }
    let [_, tangential_velocity] = M::velocity(row.normal, i);
    let slip = tangential_velocity - known.still[1] - along_tangent * wall.now;
    let before = row.tangential_impulse;
    let compliance = M::TANGENTIAL_COMPLIANCE + answer * along_tangent * along_tangent;
    [_, row.tangential_impulse] = project([row.shifted_impulse, before - slip / compliance]);
    let tangential = row.tangential_impulse - before;
    M::push_single(i, row.normal, [0.0, tangential]);
    wall.now -= answer * along_tangent * tangential;
    [normal, tangential]
}
