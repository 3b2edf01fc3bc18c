//! Substeps with soft contacts and a relaxing sweep, as game engines step (E. Catto, *Soft
//! Constraints*, 2011, and *Solver2D*, 2024).
//!
//! Contacts are those of the beginning of the step; there are no speculative ones. In each substep
//! h, with σ = λ_n + Bond·g·h the shifted reduced impulse of the contact laws:
//!
//! 1. gravity accelerates the bodies;
//! 2. the impulses of the substep before are applied (warm start);
//! 3. one sweep over **soft** contacts: v_n + b = −c σ, each an overdamped spring at the gap;
//! 4. the grains move for h, and each gap changes by h v_n;
//! 5. one sweep over **rigid** contacts, v_n = 0: it takes the push-out speed out again, so that
//!    only positions keep it, and no energy comes of it.
//!
//! At the end of the step, contacts that pushed get the speed that restitution asks of them. Its
//! threshold is that of the step's problem: contacts that met at less than `restitution_threshold`
//! g·Δt do not bounce, nor do those that were opening.
//!
//! **Cohesion** is the bound λ_n ≥ −Bond·g·h of a contact whose gap is negative when the substep
//! begins, and so a force that depends on neither Δt nor h; with a gap the bound is 0, and the
//! contact only keeps the grains from closing the gap by more than it is.

mod driven;
mod softness;

use self::softness::Softness;
use super::StepperInfo;
use super::course::{Course, Works, tell_of_drives};
use super::touching::{self, Touching};
use crate::sim::settings::Settings;
use crate::sim::stepping::{Outcome, Stage};
use crate::solver::{DrivenWall, Kinematics, Model, Row, StepProblem};
use crate::world::Parameters;

/// The row of the registry.
pub(super) const INFO: StepperInfo = StepperInfo {
    solves: "nothing exactly: contacts are damped springs",
    source: "E. Catto, Solver2D (2024)",
    settings: &[
        "bond",
        "dt",
        "tilt",
        "rho",
        "mu",
        "cone",
        "restitution-threshold",
        "warm-start",
        "substeps",
    ],
    takes_drives: true,
    substeps: |_, _, parameters| substeps(parameters),
    ..StepperInfo::WHOLE
};

/// Substeps where their number is left to the scheme. More: stiffer contacts, better solved.
const DEFAULT_SUBSTEPS: u32 = 4;
fn substeps(parameters: &Parameters) -> u32 {
    if parameters.substeps == 0 { DEFAULT_SUBSTEPS } else { parameters.substeps }
}

/// Takes one step.
pub(super) fn advance<M: Model>(stage: &mut Stage<'_, M>, settings: &Settings) -> Outcome {
    let substeps = substeps(&settings.parameters);
    let course = &mut Course::begin_step(stage, settings, substeps);
    let substep_secs = course.substep_secs;
    let softness = Softness::new(&stage.state.world, &settings.parameters, substep_secs);
    let gap_tolerance = stage.state.candidates.gap_tolerance();
    let warm_secs = if settings.solver.warm_start { substep_secs } else { 0.0 };
    let mut contacts = touching::all(stage, warm_secs);
    let capture_speed = stage.problem.capture_speed / f64::from(substeps);
    stage.in_pieces(substeps, settings, Outcome::nothing_yet(), |stage, _, _| {
        course.begin(stage);
        let walls = &mut driven::begin(stage, &mut contacts, substep_secs);
        update(stage.problem, walls, &mut contacts, |_, contact, _| {
            let cohesive = contact.gap < gap_tolerance;
            contact.capture_speed = if cohesive { capture_speed } else { 0.0 };
            softness.warm_start::<M>(contact)
        });
        update(stage.problem, walls, &mut contacts, |_, contact, velocity| {
            softness.solve::<M, true>(contact, velocity)
        });
        driven::take(stage, &mut contacts, walls);
        course.place(stage);
        let problem = &mut *stage.problem;
        touching::follow(problem, &mut contacts, substep_secs);
        update(problem, walls, &mut contacts, |_, contact, velocity| {
            softness.solve::<M, false>(contact, velocity)
        });
        course.add_gravity_work(&problem.bodies, &stage.state.world.grains.masses);
        course.works.add_of_drives(driven::take(stage, &mut contacts, walls));
        touching::end_substep(stage.problem, &mut contacts, course);
        driven::correct_works(stage.problem, &contacts, walls, &mut course.works);
        // The spring that pulls a grain looks at its velocity.
        course.store(stage);
    });
    touching::remember(stage, &contacts, substep_secs);
    let walls = &mut driven::begin(stage, &mut contacts, 0.0);
    restitute(stage.problem, walls, &mut contacts, &mut course.works);
    driven::take(stage, &mut contacts, walls);
    touching::hand_over(stage.problem, &contacts);
    course.store(stage);
    stage.problem.store_impulses(&mut stage.state.contacts);
    tell_of_drives(stage);
    course.end_step(stage, 2 * substeps + 1)
}

/// Gives contacts that met, and pushed, the speed they part with.
fn restitute<K: Kinematics>(
    problem: &mut StepProblem<K>,
    walls: &mut [DrivenWall],
    contacts: &mut [Touching],
    works: &mut Works,
) {
    update(problem, walls, contacts, |row, contact, [normal_velocity, _]| {
        if contact.rebound >= 0.0 || contact.total[0] <= 0.0 {
            return [0.0; 2];
        }
        let parting = contact.wall_speed - contact.rebound;
        let missing = (parting - normal_velocity).max(0.0) / contact.answers[0];
        let (push, before, after) = ([missing, 0.0], normal_velocity, normal_velocity + missing);
        contact.total[0] += missing;
        works.add(row.effective_mass, push, [before, 0.0], [after, 0.0]);
        works.add_of_wall(row.effective_mass, push, contact.wall_velocity());
        // The wall gave way, which takes so much off its mean speed.
        let given_way = (contact.answers[0] - 1.0) * missing;
        works.add_of_driven_wall(-0.5 * row.effective_mass * missing * given_way);
        works.add_of_border::<K>(row.effective_mass, push, row.normal);
        push
    });
}

/// Calls `change` with every row, its contact and its relative velocities, and pushes the bodies by
/// the impulses λ that it returns.
#[inline(always)]
fn update<K: Kinematics>(
    problem: &mut StepProblem<K>,
    walls: &mut [DrivenWall],
    contacts: &mut [Touching],
    mut change: impl FnMut(&Row<K>, &mut Touching, [f64; 2]) -> [f64; 2],
) {
    let StepProblem { bodies, fixed_rows, pair_rows, .. } = problem;
    let (of_fixed, of_pairs) = contacts.split_at_mut(fixed_rows.len());
    for (row, contact) in fixed_rows.iter().zip(of_fixed) {
        let i = &mut bodies[row.i as usize];
        contact.see(walls);
        let impulse = change(row, contact, K::velocity(row.normal, i));
        K::push_single(i, row.normal, impulse);
        contact.push_back(walls, row.effective_mass, impulse);
    }
    for (row, contact) in pair_rows.iter().zip(of_pairs) {
        let (mut i, mut j) = (bodies[row.i as usize], bodies[row.j as usize]);
        let impulse = change(row, contact, K::relative_velocity(row.normal, &i, &j));
        K::push_pair(&mut i, &mut j, row.normal, impulse, row.share());
        bodies[row.i as usize] = i;
        bodies[row.j as usize] = j;
    }
}
