//! The shocks at the beginning of a step under the law `range`.
//!
//! Collisions are instantaneous: neither gravity nor a bond, whose forces are finite, does anything in
//! no time. So before the step proper, the grains that run into each other are brought to the
//! velocities after their collisions by a problem of its own, with neither gravity nor cohesion, in
//! which a contact that touches and closes bounces,
//!
//! > 0 ≤ P_n ⟂ v_n⁺ + ρ v_n⁻ ≥ 0,
//!
//! and one that is to meet within the step is slowed down to what closes its gap. The step then goes
//! on from v⁺ and bounces no more.
//!
//! **Why not in one problem.** A bounce that is asked for together with v_n ≥ 0 of contacts that open
//! can be asked for in vain: of two grains that rattle between others each is to be left and none can
//! be. Then no solution is to be had. Asked for alone, v⁺ = −ρ v⁻ of all grains obeys every contact, and so does v = 0 in the step.
//! For this, contacts that open have their term too: they may close by ρ v_n⁻ until the step forbids it.
//!
//! **How tightly.** As the step. Solved less tightly, with what that leaves of approach taken up by the
//! step, shocks cost less, but slump may then depend on Δt.

use super::numbers::StepNumbers;
use crate::solver::{
    Kinematics, Measures, Memory, Model, SolveReport, SolverSettings, StepProblem, for_each_row,
    measure, relative_velocities, residual, solve,
};

/// What the shocks of a step came to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shocks {
    pub report: SolveReport,
    /// Works, and the residual of the shocks' own problem.
    pub measures: Measures,
}

/// Memory that is kept from one step to the next.
#[derive(Clone, Debug, Default)]
pub(super) struct Workspace {
    speeds: Vec<f64>,
    captures: Vec<f64>,
    /// (σ, λ_t) and the restitution velocity of the rows of the step.
    rows: Vec<[f64; 3]>,
    /// Impulses of the shocks, one a row, m/s; empty where nothing collides.
    pub struck: Vec<f64>,
}

/// Takes a prepared problem through the shocks of its step: from then on its bodies begin with v⁺.
pub(super) fn pass<M: Model>(
    problem: &mut StepProblem<M::Kinematics>,
    memory: &mut Memory<M::Kinematics>,
    workspace: &mut Workspace,
    numbers: StepNumbers,
    settings: &SolverSettings,
) -> Option<Shocks> {
    let StepNumbers { restitution, time_step_secs, touch, .. } = numbers;
    workspace.struck.clear();
    relative_velocities(problem, &problem.before, &mut workspace.speeds);
    if !any::<M::Kinematics>(problem, settings.tolerance) {
        return None;
    }
    let Workspace { speeds, captures, rows, struck } = workspace;
    rows.clear();
    // In no time nothing is accelerated: the free velocities are those before.
    std::mem::swap(&mut problem.free, &mut problem.before);
    std::mem::swap(&mut problem.captures, captures);
    problem.captures.clear();
    problem.captures.resize(captures.len(), 0.0);
    for ((row, wall_speed), &speed) in problem.rows_with_walls().zip(&*speeds) {
        // Speeds are those relative to a wall that moves; what a row adds is to v_n itself.
        let closing_gap = row.restitution_velocity + wall_speed;
        rows.push([row.shifted_impulse, row.tangential_impulse, row.restitution_velocity]);
        row.shifted_impulse = 0.0;
        row.tangential_impulse = 0.0;
        let bounce = restitution * speed;
        let touches = closing_gap * time_step_secs <= touch;
        let allowed = if touches { bounce } else { closing_gap.max(bounce) };
        row.restitution_velocity = allowed - wall_speed;
    }
    problem.bodies.clone_from(&problem.free);
    let report = solve::<M>(problem, memory, settings);
    let residual = residual::<M>(problem);
    std::mem::swap(&mut problem.free, &mut problem.before);
    let measures = Measures { residual, ..measure::<M>(problem) };
    std::mem::swap(&mut problem.captures, captures);
    let all = problem.fixed_rows.iter_mut().chain(&mut problem.pair_rows);
    for (row, &[shifted, tangential, restitution_velocity]) in all.zip(&*rows) {
        struck.push(row.shifted_impulse);
        row.shifted_impulse = shifted;
        row.tangential_impulse = tangential;
        row.restitution_velocity = restitution_velocity;
    }
    let StepProblem { bodies, before, free, .. } = problem;
    for ((now, before), free) in bodies.iter().zip(before).zip(free) {
        let coordinates = [now, before, free].map(M::Kinematics::coordinates);
        let [after, was, would_be] = coordinates;
        *free = M::Kinematics::from_coordinates(std::array::from_fn(|axis| {
            after[axis] + (would_be[axis] - was[axis])
        }));
        *before = *now;
    }
    problem.form_velocities();
    Some(Shocks { report, measures })
}

/// Whether any contact closes faster than it may, measured against the step's own scale, as its
/// residual is.
fn any<K: Kinematics>(problem: &StepProblem<K>, tolerance: f64) -> bool {
    let (mut violated, mut scale) = (0.0, 0.0);
    for_each_row(problem, |_, row, motion| {
        let squared_mass = row.effective_mass * row.effective_mass;
        let closing = (motion.before[0] + row.restitution_velocity).min(0.0);
        let free = motion.free[0] + row.restitution_velocity;
        violated += squared_mass * closing * closing;
        scale += squared_mass * free * free;
    });
    violated > tolerance * tolerance * scale
}
