//! Code shared by the steppers `tgs-soft`, `avbd` and `dem`. They do not solve the contact problem of a step as a
//! whole, but divide the time step Δt into substeps of length h and move the grains in each substep.
//!
//! The contact problem of the whole step is still set up. At the end of the step its residual is computed from the
//! impulses summed over the step and the velocities at its end, so that all steppers are compared by the same measure.
//! These steppers do not iterate to a tolerance, so stop criterion, tolerance and sweep limit have no effect.

use crate::contact::ContactMemory;
use crate::sim::settings::Settings;
use crate::sim::state::State;
use crate::sim::steppers::moreau::set_up;
use crate::sim::stepping::{Stage, StepResult};
use crate::sim::turned_bonds::{is_open_against, is_within_bounds};
use crate::solver::{DrivenRow, Measures, Model, Row, SolveReport, StepProblem, measure};

/// Data of a step during its substeps (the equal parts into which the stepper divides it). The data are dropped at the
/// end of the step; the world and the contacts store the data that later steps need.
pub(super) struct Substepping<M: Model> {
    /// Number of substeps (equal parts) of the step.
    pub count: u32,
    /// Length h of a substep (part of a step), s.
    pub substep_secs: f64,
    /// Velocities of the grains at the beginning of the present substep (part of a step).
    pub start: Vec<M::Body<f64>>,
    /// Velocities that the grains would have at the end of the substep (part of a step) if no contact acted.
    pub free: Vec<M::Body<f64>>,
    /// Works of gravity, contacts, walls and borders, J, summed over the substeps since the beginning of the step.
    pub works: StepResult,
}

impl<M: Model> Substepping<M> {
    /// Begins a step: sets up its contact problem, with the grains at their velocities before the step, and divides the
    /// step into as many substeps as the stepper requires.
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

    /// Ends the step of a stepper whose bonds exist while their gaps are below the scene's `gap_tolerance`. Returns the
    /// works and the residual of the step, and the number of bonds that ended because their two grains circled each
    /// other, which opened the gap. `contacts` are in their state after the last substep, and `sweeps` is the number of
    /// passes over all contacts in the step.
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

    /// Ends the step, and returns its works and its residual. `sweeps` is the number of passes over all contacts in the
    /// step.
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

    /// Begins a substep (part of a step): changes the velocities of the grains by gravity, body forces and the user's
    /// spring on a grain.
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

    /// Moves the grains for one substep (part of a step) with their present velocities.
    pub(super) fn place(&self, stage: &mut Stage<'_, M>) {
        self.store(stage);
        stage.state.integrate::<M>(self.substep_secs);
    }

    /// Copies the velocities from the contact problem to the world.
    pub(super) fn store(&self, stage: &mut Stage<'_, M>) {
        for (index, body) in stage.problem.bodies.now.iter().enumerate() {
            M::store(body, &mut stage.state.world, index);
        }
    }

    /// Adds the work of gravity, body forces and the user's spring in a substep (part of a step). `bodies` are the
    /// velocities of the grains at the end of the substep, and `masses` their masses, kg.
    pub(super) fn add_gravity_work(&mut self, bodies: &[M::Body<f64>], masses: &[f64]) {
        for (index, body) in bodies.iter().enumerate() {
            let (start, free) = (&self.start[index], &self.free[index]);
            self.works.gravity_work += M::work_of_gravity(start, body, free, masses[index]);
        }
    }
}

/// Adds the work of one contact in a substep (part of a step). `impulse` contains the impulses λ divided by the
/// effective mass, m/s. As for a whole step (`solver::measure`), the work is the impulse times the mean of the
/// velocities at the beginning and the end. `wall` contains the normal and tangential velocity of the contact's wall,
/// m/s.
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

/// Writes the speeds of force-driven walls at the end of the step to the contact problem from which the residual of the
/// step is computed.
pub(super) fn set_drive_speeds<M: Model>(stage: &mut Stage<'_, M>) {
    let drives = stage.state.world.motions.iter().filter_map(|motion| motion.drive.as_ref());
    stage.problem.set_wall_velocities(drives.map(|drive| drive.speed));
}

/// State of a contact during a step that is divided into substeps.
pub(super) struct Touching {
    /// Present gap of the contact, m; negative for an overlap.
    pub gap: f64,
    /// Velocity of the contact's wall along the normal, m/s.
    pub wall_speed: f64,
    /// Velocity of the wall's surface along the tangent, m/s.
    pub surface_speed: f64,
    /// Data on the contact's wall if a force drives this wall; otherwise `None`.
    pub driven: Option<DrivenRow>,
    /// Change of the contact's normal and tangential velocity by a unit impulse, divided by the change at a wall whose
    /// velocity is prescribed: above 1 if a force drives the wall, because the impulse also changes the speed of such a
    /// wall; otherwise 1.
    pub answers: [f64; 2],
    /// Restitution term, m/s, which the contact law adds to the normal velocity relative to the wall: minus the
    /// separation speed that restitution requires, so below 0 if the contact was closing.
    pub rebound: f64,
    /// Capture speed: the opening speed that cohesion can stop in this substep (part of a step), m/s; 0 without
    /// cohesion.
    pub capture_speed: f64,
    /// Normal and tangential impulses (λ_n, λ_t) of this substep (part of a step) divided by the effective mass, m/s.
    pub impulse: [f64; 2],
    /// Normal and tangential impulses (λ_n, λ_t) since the beginning of the step divided by the effective mass, m/s.
    pub total: [f64; 2],
}

impl Touching {
    /// Returns the normal and the tangential velocity of the contact's wall, m/s.
    pub(super) fn wall_velocity(&self) -> [f64; 2] {
        [self.wall_speed, self.surface_speed]
    }
}

/// Returns the contacts in the order of the rows of the contact problem (a row is the data of one contact). The
/// impulses with which they start are the forces of the previous step times `warm_secs` (s); 0 s gives a cold start
/// (from zero impulses).
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

/// Changes the gaps of the contacts by the motion of grains and walls during one substep (part of a step).
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

/// Adds the impulses and works of all contacts in a substep (part of a step) to the sums of the step.
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

/// Stores the forces of the last substep in the contacts, for the warm start of the next step (a start from these
/// forces).
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

/// Writes the impulses of all contacts, summed over the substeps (equal parts) of a step, to the contact problem of
/// this step.
pub(super) fn hand_over<M: Model>(problem: &mut StepProblem<M>, contacts: &[Touching]) {
    let capture_speed = problem.law.capture_speed();
    for (row, contact) in problem.rows.iter_mut().zip(contacts) {
        row.shifted_impulse = contact.total[0] + capture_speed;
        row.tangential_impulse = contact.total[1];
    }
}

/// Returns the normal and tangential relative velocities of all contacts if the grains have the velocities `bodies`,
/// m/s.
pub(super) fn velocities<'a, M: Model>(
    problem: &'a StepProblem<M>,
    bodies: &'a [M::Body<f64>],
) -> impl Iterator<Item = [f64; 2]> + 'a {
    let fixed = problem.rows.fixed.iter();
    let of_fixed = fixed.map(|row| M::velocity(row.normal, &bodies[row.i as usize]));
    of_fixed.chain(problem.rows.pairs.iter().map(|row| row.velocity(bodies)))
}
