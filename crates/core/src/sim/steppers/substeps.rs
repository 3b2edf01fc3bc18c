//! Common parts of steppers without a problem of the whole step: they divide Δt into substeps h and move the grains
//! in each.
//!
//! The step's Contact Dynamics problem is still set up. It is judged at the end with the impulses summed over the
//! step and the final velocities: its residual is the measure common to all steppers. These steppers do not iterate
//! to a tolerance, so stopping test, tolerance and sweep limit have no effect.

use crate::contact::ContactMemory;
use crate::sim::settings::Settings;
use crate::sim::state::State;
use crate::sim::steppers::moreau::set_up;
use crate::sim::stepping::{Stage, StepResult};
use crate::sim::turned_bonds::{is_open_against, is_within_bounds};
use crate::solver::{DrivenRow, Measures, Model, Row, SolveReport, StepProblem, measure};

/// State of a step during its substeps. It lives for one step: persistent data is in the world and in the contacts'
/// memories.
pub(super) struct Substepping<M: Model> {
    /// Number of substeps of the step.
    pub count: u32,
    /// h, s.
    pub substep_secs: f64,
    /// Bodies at the beginning of the substep.
    pub start: Vec<M::Body<f64>>,
    /// Bodies at the end of the substep if no contact acted.
    pub free: Vec<M::Body<f64>>,
    /// Works since the beginning of the step.
    pub works: StepResult,
}

impl<M: Model> Substepping<M> {
    /// Begins a step: sets up its problem with the bodies at their previous velocities. The stepper determines the
    /// number of substeps.
    pub(super) fn begin_step(stage: &mut Stage<'_, M>, settings: &Settings) -> Self {
        let count = stage.state.substeps(settings);
        set_up(stage, settings);
        stage.problem.bodies.now.clone_from(&stage.problem.bodies.before);
        Self {
            count,
            substep_secs: settings.parameters.time_step_secs / f64::from(count),
            start: Vec::new(),
            free: Vec::new(),
            works: StepResult::nothing_yet(),
        }
    }

    /// Ends the step of a stepper whose bonds exist while their gaps are below the touch tolerance, after `sweeps`
    /// passes over the contacts. The contacts are in the state of the last substep.
    pub(super) fn end_step_of(
        &self,
        stage: &Stage<'_, M>,
        contacts: &[Touching],
        sweeps: u32,
    ) -> StepResult {
        let list = stage.state.contacts.contacts();
        let tolerance = stage.state.candidates.gap_tolerance();
        let rows = contacts.iter().zip(&stage.problem.rows.contacts);
        let turned_bonds = rows.filter(|&(touching, &index)| {
            let Touching { impulse, capture_speed, gap, .. } = *touching;
            is_within_bounds(impulse[0], capture_speed)
                && is_open_against(stage.state, &list[index as usize], gap, tolerance, M::AXES)
        });
        let turned_bonds = turned_bonds.count() as u64;
        StepResult { turned_bonds, ..self.end_step(stage, sweeps) }
    }

    /// Ends the step, after `sweeps` passes over its contacts.
    pub(super) fn end_step(&self, stage: &Stage<'_, M>, sweeps: u32) -> StepResult {
        let Measures { normal_work, tangential_work, wall_work, border_work, .. } =
            self.works.measures;
        let measures = Measures {
            normal_work,
            tangential_work,
            wall_work,
            border_work,
            ..measure(stage.problem)
        };
        let report = SolveReport { sweeps, ..self.works.report };
        StepResult { report, measures, ..self.works }
    }

    /// Begins a substep: gravity, body forces and a spring that pulls act on the bodies.
    pub(super) fn begin(&mut self, stage: &mut Stage<'_, M>) {
        let pushes = stage.state.pushes(M::AXES, self.substep_secs);
        let (world, bodies) = (&stage.state.world, &mut stage.problem.bodies.now);
        self.start.clone_from(bodies);
        for (index, body) in bodies.iter_mut().enumerate() {
            if world.grains.feels_gravity[index] {
                *body = M::accelerated(body, world, index, self.substep_secs);
            }
        }
        for push in pushes {
            push.apply::<M>(bodies);
        }
        self.free.clone_from(bodies);
    }

    /// Moves the grains for h with the bodies' velocities.
    pub(super) fn place(&self, stage: &mut Stage<'_, M>) {
        self.store(stage);
        stage.state.integrate::<M>(self.substep_secs);
    }

    /// Writes the bodies' velocities to the world.
    pub(super) fn store(&self, stage: &mut Stage<'_, M>) {
        for (index, body) in stage.problem.bodies.now.iter().enumerate() {
            M::store(body, &mut stage.state.world, index);
        }
    }

    /// Adds the work of gravity, body forces and the spring in the substep that ends with `bodies`.
    pub(super) fn add_gravity_work(&mut self, bodies: &[M::Body<f64>], masses: &[f64]) {
        for (index, body) in bodies.iter().enumerate() {
            let (start, free) = (&self.start[index], &self.free[index]);
            self.works.gravity_work += M::work_of_gravity(start, body, free, masses[index]);
        }
    }
}

/// Adds the work of one contact's impulses λ (m/s): in each substep, as in a step (`solver::measure`), impulse times
/// the mean of the velocities at its beginning and its end. `wall` is (V_n, V_t) of its wall, m/s.
#[inline(always)]
pub(super) fn add_work<M: Model>(
    works: &mut StepResult,
    mass: f64,
    normal: M::Normal<f64>,
    impulse: [f64; 2],
    [start, end]: [[f64; 2]; 2],
    wall: [f64; 2],
) {
    let works = &mut works.measures;
    works.normal_work += 0.5 * mass * impulse[0] * (start[0] + end[0]);
    works.tangential_work += 0.5 * mass * impulse[1] * (start[1] + end[1]);
    works.wall_work += mass * (impulse[0] * wall[0] + impulse[1] * wall[1]);
    if M::SLIDES {
        let along = M::slide_along(normal);
        works.border_work += mass * (impulse[0] * along[0] + impulse[1] * along[1]);
    }
}

/// Sets the final speeds of driven walls in the problem by which a step is judged.
pub(super) fn set_drive_speeds<M: Model>(stage: &mut Stage<'_, M>) {
    let drives = stage.state.world.motions.iter().filter_map(|motion| motion.drive.as_ref());
    stage.problem.set_wall_velocities(drives.map(|drive| drive.speed));
}

/// State of a contact during a step.
pub(super) struct Touching {
    /// Gap, m.
    pub gap: f64,
    /// Normal velocity of its wall, m/s.
    pub wall_speed: f64,
    /// Tangential velocity of its wall's surface, m/s.
    pub surface_speed: f64,
    /// Data of its driven wall, if it has one.
    pub driven: Option<DrivenRow>,
    /// Response of v_n and v_t to an impulse, relative to a wall that does not yield: 1 unless the wall is driven.
    pub answers: [f64; 2],
    /// Separation speed required by the law, relative to its wall, m/s; below 0 if the contact was closing.
    pub rebound: f64,
    /// Bond·a·h if it is cohesive in this substep, otherwise 0, m/s.
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

/// The contacts in the order of the rows, with impulses from the forces of the step before, acting for `warm_secs`
/// (s).
pub(super) fn touching<M: Model>(stage: &Stage<'_, M>, warm_secs: f64) -> Vec<Touching> {
    let (contacts, problem) = (&stage.state.contacts, &stage.problem);
    let contact = |((number, row), &index): ((usize, &Row<M>), &u32)| {
        let memory = contacts.memories()[index as usize];
        let per_mass = warm_secs / row.effective_mass;
        let wall_speed = problem.wall_speed(number);
        Touching {
            gap: contacts.contacts()[index as usize].gap,
            wall_speed,
            driven: problem.walls.driven_row(number).copied(),
            answers: [1.0; 2],
            rebound: row.restitution_velocity + wall_speed,
            surface_speed: problem.rows.surface_speed(number),
            capture_speed: 0.0,
            impulse: [per_mass * memory.normal_force, per_mass * memory.tangential_force],
            total: [0.0; 2],
        }
    };
    problem.rows().zip(&problem.rows.contacts).map(contact).collect()
}

/// Updates the gaps by the bodies' velocities for h.
pub(super) fn follow_gaps<M: Model>(
    problem: &StepProblem<M>,
    contacts: &mut [Touching],
    substep_secs: f64,
) {
    let velocities = velocities(problem, &problem.bodies.now);
    for (contact, [normal_velocity, _]) in contacts.iter_mut().zip(velocities) {
        contact.gap += substep_secs * (normal_velocity - contact.wall_speed);
    }
}

/// Adds impulses and works of a substep.
pub(super) fn end_substep<M: Model>(
    problem: &StepProblem<M>,
    contacts: &mut [Touching],
    substepping: &mut Substepping<M>,
) {
    let Substepping { works, start, .. } = substepping;
    let start = velocities(problem, start);
    let end = velocities(problem, &problem.bodies.now);
    let rows = problem.rows.iter();
    for (((row, contact), start), end) in rows.zip(contacts).zip(start).zip(end) {
        contact.total[0] += contact.impulse[0];
        contact.total[1] += contact.impulse[1];
        let velocities = [start, end];
        let wall = contact.wall_velocity();
        add_work::<M>(works, row.effective_mass, row.normal, contact.impulse, velocities, wall);
    }
}

/// Stores the forces of the last substep in the contacts' memories.
pub(super) fn remember<M: Model>(
    stage: &mut Stage<'_, M>,
    contacts: &[Touching],
    substep_secs: f64,
) {
    let Stage { state: State { contacts: list, .. }, problem, .. } = stage;
    let memories = list.parts_mut().memories;
    let rows = problem.rows.iter();
    for ((row, contact), &index) in rows.zip(contacts).zip(&problem.rows.contacts) {
        let per_secs = row.effective_mass / substep_secs;
        memories[index as usize] = ContactMemory {
            normal_force: per_secs * contact.impulse[0],
            tangential_force: per_secs * contact.impulse[1],
            ..ContactMemory::default()
        };
    }
}

/// Gives the step's problem the summed impulses.
pub(super) fn hand_over<M: Model>(problem: &mut StepProblem<M>, contacts: &[Touching]) {
    let capture_speed = problem.law.capture_speed();
    for (row, contact) in problem.rows.iter_mut().zip(contacts) {
        row.shifted_impulse = contact.total[0] + capture_speed;
        row.tangential_impulse = contact.total[1];
    }
}

/// The relative velocities of all rows with the given bodies, m/s.
pub(super) fn velocities<'a, M: Model>(
    problem: &'a StepProblem<M>,
    bodies: &'a [M::Body<f64>],
) -> impl Iterator<Item = [f64; 2]> + 'a {
    let fixed = problem.rows.fixed.iter();
    let of_fixed = fixed.map(|row| M::velocity(row.normal, &bodies[row.i as usize]));
    of_fixed.chain(problem.rows.pairs.iter().map(|row| row.velocity(bodies)))
}
