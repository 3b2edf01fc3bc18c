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

use self::softness::{SoftContact, Softness};
use super::StepperInfo;
use super::course::{Course, Works, tell_of_drives};
use crate::contact::ContactMemory;
use crate::sim::settings::Settings;
use crate::sim::state::State;
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
    let mut contacts = soft_contacts(stage, warm_secs);
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
        let velocities = velocities(problem, &problem.bodies);
        for (contact, [normal_velocity, _]) in contacts.iter_mut().zip(velocities) {
            contact.gap += substep_secs * (normal_velocity - contact.wall_speed);
        }
        update(problem, walls, &mut contacts, |_, contact, velocity| {
            softness.solve::<M, false>(contact, velocity)
        });
        course.add_gravity_work(&problem.bodies, &stage.state.world.grains.masses);
        course.works.add_of_drives(driven::take(stage, &mut contacts, walls));
        end_substep(stage.problem, walls, &mut contacts, course);
        // The spring that pulls a grain looks at its velocity.
        course.store(stage);
    });
    remember(stage, &contacts, substep_secs);
    let walls = &mut driven::begin(stage, &mut contacts, 0.0);
    restitute(stage.problem, walls, &mut contacts, &mut course.works);
    driven::take(stage, &mut contacts, walls);
    let problem = &mut *stage.problem;
    let capture_speed = problem.capture_speed;
    for (row, contact) in problem.fixed_rows.iter_mut().chain(&mut problem.pair_rows).zip(&contacts)
    {
        row.shifted_impulse = contact.total[0] + capture_speed;
        row.tangential_impulse = contact.total[1];
    }
    course.store(stage);
    stage.problem.store_impulses(&mut stage.state.contacts);
    tell_of_drives(stage);
    course.end_step(stage, 2 * substeps + 1)
}

/// The contacts in the order of the rows, with the forces of the step before for so long (s).
fn soft_contacts<M: Model>(stage: &Stage<'_, M>, warm_secs: f64) -> Vec<SoftContact> {
    let (contacts, problem) = (&stage.state.contacts, &stage.problem);
    let fixed = problem.fixed_rows().len();
    let soft = |((number, row), &index): ((usize, &Row<M::Kinematics>), &u32)| {
        let memory = contacts.memories()[index as usize];
        let per_mass = warm_secs / row.effective_mass;
        let wall_speed = problem.wall_speed(number);
        SoftContact {
            gap: contacts.contacts()[index as usize].gap,
            driven: problem.driven.row(number).copied(),
            answers: [1.0; 2],
            rebound: row.restitution_velocity + wall_speed,
            wall_speed,
            surface_speed: if number < fixed { row.surface_speed() } else { 0.0 },
            capture_speed: 0.0,
            impulse: [per_mass * memory.normal_force, per_mass * memory.tangential_force],
            total: [0.0; 2],
        }
    };
    problem.rows().zip(&problem.contact_of_row).map(soft).collect()
}

/// Hands the forces of the last substep to the contacts' memories.
fn remember<M: Model>(stage: &mut Stage<'_, M>, contacts: &[SoftContact], substep_secs: f64) {
    let Stage { state: State { contacts: list, .. }, problem, .. } = stage;
    let (_, _, memories) = list.parts_mut();
    let rows = problem.fixed_rows.iter().chain(&problem.pair_rows);
    for ((row, contact), &index) in rows.zip(contacts).zip(&problem.contact_of_row) {
        let per_secs = row.effective_mass / substep_secs;
        memories[index as usize] = ContactMemory {
            normal_force: per_secs * contact.impulse[0],
            tangential_force: per_secs * contact.impulse[1],
            ..ContactMemory::default()
        };
    }
}

/// Sums up impulses and works of a substep.
fn end_substep<K: Kinematics>(
    problem: &StepProblem<K>,
    walls: &[DrivenWall],
    contacts: &mut [SoftContact],
    course: &mut Course<K>,
) {
    let Course { works, start, .. } = course;
    let start = velocities(problem, start);
    let end = velocities(problem, &problem.bodies);
    let rows = problem.fixed_rows.iter().chain(&problem.pair_rows);
    for (((row, contact), start), end) in rows.zip(contacts).zip(start).zip(end) {
        contact.total[0] += contact.impulse[0];
        contact.total[1] += contact.impulse[1];
        works.add(row.effective_mass, contact.impulse, start, end);
        works.add_of_wall(row.effective_mass, contact.impulse, contact.wall_velocity());
        driven::correct_work(works, contact, row.effective_mass, contact.impulse, walls);
        works.add_of_border::<K>(row.effective_mass, contact.impulse, row.normal);
    }
}

/// Gives contacts that met, and pushed, the speed they part with.
fn restitute<K: Kinematics>(
    problem: &mut StepProblem<K>,
    walls: &mut [DrivenWall],
    contacts: &mut [SoftContact],
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
    contacts: &mut [SoftContact],
    mut change: impl FnMut(&Row<K>, &mut SoftContact, [f64; 2]) -> [f64; 2],
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

/// The relative velocities of all rows with the given bodies, m/s.
fn velocities<'a, K: Kinematics>(
    problem: &'a StepProblem<K>,
    bodies: &'a [K::Body<f64>],
) -> impl Iterator<Item = [f64; 2]> + 'a {
    let of_fixed = |row: &Row<K>| K::velocity(row.normal, &bodies[row.i as usize]);
    let of_pair = |row: &Row<K>| {
        K::relative_velocity(row.normal, &bodies[row.i as usize], &bodies[row.j as usize])
    };
    problem.fixed_rows.iter().map(of_fixed).chain(problem.pair_rows.iter().map(of_pair))
}
