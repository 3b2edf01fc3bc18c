//! Contacts in the course of a step that is cut into substeps, for ways to step that detect them once.

use super::course::Course;
use crate::contact::ContactMemory;
use crate::sim::state::State;
use crate::sim::stepping::Stage;
use crate::solver::{DrivenRow, Kinematics, Model, Row, StepProblem};

/// A contact in the course of a step.
pub(super) struct Touching {
    /// Gap, m.
    pub gap: f64,
    /// How fast its wall comes, m/s.
    pub wall_speed: f64,
    /// How fast its surface goes along the tangent, m/s.
    pub surface_speed: f64,
    /// What it knows of a wall that a force drives, if its own is one.
    pub driven: Option<DrivenRow>,
    /// 1 but where a wall gives way: how much an impulse changes v_n and v_t, over how much it would if the wall did
    /// not.
    pub answers: [f64; 2],
    /// What the law asks it to part with, relative to its wall, m/s; below 0 where it closed.
    pub rebound: f64,
    /// Bond·g·h where it is cohesive in this substep, else 0, m/s.
    pub capture_speed: f64,
    /// (λ_n, λ_t) of this substep, m/s.
    pub impulse: [f64; 2],
    /// (λ_n, λ_t) of the step so far, m/s.
    pub total: [f64; 2],
}

impl Touching {
    /// (V_n, V_t) of its wall, m/s.
    pub(super) fn wall_velocity(&self) -> [f64; 2] {
        [self.wall_speed, self.surface_speed]
    }
}

/// The contacts in the order of the rows, with the forces of the step before for so long (s).
pub(super) fn all<M: Model>(stage: &Stage<'_, M>, warm_secs: f64) -> Vec<Touching> {
    let (contacts, problem) = (&stage.state.contacts, &stage.problem);
    let fixed = problem.fixed_rows().len();
    let touching = |((number, row), &index): ((usize, &Row<M::Kinematics>), &u32)| {
        let memory = contacts.memories()[index as usize];
        let per_mass = warm_secs / row.effective_mass;
        let wall_speed = problem.wall_speed(number);
        Touching {
            gap: contacts.contacts()[index as usize].gap,
            wall_speed,
            driven: problem.driven.row(number).copied(),
            answers: [1.0; 2],
            rebound: row.restitution_velocity + wall_speed,
            surface_speed: if number < fixed { row.surface_speed() } else { 0.0 },
            capture_speed: 0.0,
            impulse: [per_mass * memory.normal_force, per_mass * memory.tangential_force],
            total: [0.0; 2],
        }
    };
    problem.rows().zip(&problem.contact_of_row).map(touching).collect()
}

/// Has the gaps follow the bodies' velocities for h.
pub(super) fn follow<K: Kinematics>(
    problem: &StepProblem<K>,
    contacts: &mut [Touching],
    substep_secs: f64,
) {
    let velocities = velocities(problem, &problem.bodies);
    for (contact, [normal_velocity, _]) in contacts.iter_mut().zip(velocities) {
        contact.gap += substep_secs * (normal_velocity - contact.wall_speed);
    }
}

/// Sums up impulses and works of a substep.
pub(super) fn end_substep<K: Kinematics>(
    problem: &StepProblem<K>,
    contacts: &mut [Touching],
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
        works.add_of_border::<K>(row.effective_mass, contact.impulse, row.normal);
    }
}

/// Hands the forces of the last substep to the contacts' memories.
pub(super) fn remember<M: Model>(
    stage: &mut Stage<'_, M>,
    contacts: &[Touching],
    substep_secs: f64,
) {
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

/// Gives the problem of the step the impulses that were summed up.
pub(super) fn hand_over<K: Kinematics>(problem: &mut StepProblem<K>, contacts: &[Touching]) {
    let capture_speed = problem.capture_speed;
    for (row, contact) in problem.fixed_rows.iter_mut().chain(&mut problem.pair_rows).zip(contacts)
    {
        row.shifted_impulse = contact.total[0] + capture_speed;
        row.tangential_impulse = contact.total[1];
    }
}

/// The relative velocities of all rows with the given bodies, m/s.
pub(super) fn velocities<'a, K: Kinematics>(
    problem: &'a StepProblem<K>,
    bodies: &'a [K::Body<f64>],
) -> impl Iterator<Item = [f64; 2]> + 'a {
    let of_fixed = |row: &Row<K>| K::velocity(row.normal, &bodies[row.i as usize]);
    let of_pair = |row: &Row<K>| {
        K::relative_velocity(row.normal, &bodies[row.i as usize], &bodies[row.j as usize])
    };
    problem.fixed_rows.iter().map(of_fixed).chain(problem.pair_rows.iter().map(of_pair))
}
