//! Stepper `dem`: smooth discrete elements (P. A. Cundall & O. D. L. Strack, 1979), with the linear cohesive law from
//! which S. Luding (2008) starts. A contact is a spring (stiffness k) and a dashpot (damping γ), and pulls with the
//! cohesion force C₀ while the discs overlap. With the overlap δ = −gap, the normal and tangential velocities v_n and
//! v_t, the stretch ξ, stiffness k_t and damping γ_t of the tangential spring, and the largest friction force F, the
//! normal force N and the tangential force T are
//!
//! > N = max(k δ − γ v_n, 0) − C₀,  T = −k_t ξ − γ_t v_t with ξ̇ = v_t,  |T| ≤ F.
//!
//! Spring and dashpot together never pull: N ≥ −C₀, as in all contact laws of this program. The largest friction force
//! is the same as in the other contact laws: F = μ(N + C₀) with the shifted friction cone, and F = μ max(N, 0) with the
//! compressive cone (friction coefficient μ). If a contact slides, ξ is shortened so that |T| = F.

use crate::contact::{Contact, ContactLaw, ContactMemory, ContactParts, Impulse, Transmitted, law};
use crate::number::Parts;
use crate::sim::settings::Settings;
use crate::sim::settings::SpringDashpot;
use crate::sim::state::State;
use crate::sim::steppers::substeps::{Substepping, add_work, set_drive_speeds};
use crate::sim::stepping::{Stage, StepResult};
use crate::solver::{DrivenWall, Model, cone_of};

/// Takes one step, and detects the contacts in each substep (part of the step). The contact problem of the step, from
/// which its residual is computed, contains the contacts at the beginning of the step. At the end of the step, each of
/// these contacts receives the impulse that its pair has transmitted in all substeps.
pub(super) fn advance<M: Model>(stage: &mut Stage<'_, M>, settings: &Settings) -> StepResult {
    let (world, physics) = (&stage.state.world, stage.state.physics);
    let parameters = &settings.parameters;
    let cohesion = if physics.cohesion { parameters.bond } else { 0.0 };
    let elements = Elements {
        springs: SpringDashpot::of(world, physics.axes, parameters),
        cohesive_acceleration: cohesion
            * parameters.cohesion_acceleration(world.gravity.magnitude()),
        law: ContactLaw::new(parameters.friction, 0.0, cone_of(physics, parameters)),
        substep_secs: parameters.time_step_secs / f64::from(stage.state.substeps(settings)),
    };
    let substepping = &mut Substepping::begin_step(stage, settings);
    let substeps = substepping.count;
    stage.state.walls.divide(substeps);
    let of_step = stage.state.contacts.contacts().to_vec();
    stage.state.contacts.impulses_mut().fill(Impulse::default());
    let mut pushes = Vec::new();
    let mut is_first = true;
    stage.in_pieces(substeps, settings, StepResult::nothing_yet(), |stage, _, _| {
        if !std::mem::take(&mut is_first) {
            stage.state.detect::<M>(None);
        }
        substepping.begin(stage);
        elements.push(stage, &substepping.start, &mut pushes);
        let bodies = &stage.problem.bodies.now;
        let list = stage.state.contacts.contacts();
        for (contact, &(mass, impulse, of_wall)) in list.iter().zip(&pushes) {
            let normal = M::normal_of(&stage.state.world, contact);
            let of = |bodies: &[_]| velocity::<M>(normal, contact, bodies);
            let velocities = [of(&substepping.start), of(bodies)];
            let works = &mut substepping.works;
            add_work::<M>(works, mass, normal, impulse, velocities, of_wall);
        }
        substepping.add_gravity_work(bodies, &stage.state.world.grains.masses);
        drive_walls(stage, substepping.substep_secs, &pushes, &mut substepping.works);
        substepping.place(stage);
    });
    let sum = |contact: &Contact| stage.state.contacts.sum_of(contact);
    let impulses: Vec<Impulse> = of_step.iter().map(sum).collect();
    stage.problem.set_impulses(&impulses);
    set_drive_speeds(stage);
    substepping.end_step(stage, substeps)
}

/// Returns the normal and tangential relative velocities (v_n, v_t) of a contact, m/s.
#[inline(always)]
fn velocity<M: Model>(
    normal: M::Normal<f64>,
    contact: &Contact,
    bodies: &[M::Body<f64>],
) -> [f64; 2] {
    let i = &bodies[contact.grain as usize];
    match bodies.get(contact.other as usize) {
        Some(j) => M::relative_velocity(normal, i, j),
        None => M::velocity(normal, i),
    }
}

/// Contact law of a substep (part of a step): springs, dashpots, cohesion and friction.
struct Elements {
    springs: SpringDashpot,
    /// Cohesion force divided by the effective mass, m/s²: the Bond number times an acceleration (the parameter
    /// `bond_acceleration`, or the gravity of the scene if this parameter is 0).
    cohesive_acceleration: f64,
    law: ContactLaw,
    substep_secs: f64,
}

impl Elements {
    /// Computes the forces of a contact with the effective mass `mass` (kg) from its gap (m) and its relative
    /// velocities (m/s), and stores them in `memory`, the data that the contact keeps.
    #[inline(always)]
    fn force<M: Model>(
        &self,
        memory: &mut ContactMemory,
        gap: f64,
        mass: f64,
        [normal_velocity, tangential_velocity]: [f64; 2],
    ) {
        let stiffness = self.springs.stiffness;
        let damping = self.springs.damping(mass);
        let push = (-stiffness * gap - damping * normal_velocity).positive_part();
        let cohesion = mass * self.cohesive_acceleration;
        memory.normal_force = push - cohesion;
        if M::FRICTION {
            let part = 1.0 / M::TANGENTIAL_COMPLIANCE;
            let bound = self.law.with_capture_speed(cohesion).friction_bound(push);
            let dashpot = part * damping * tangential_velocity;
            let spring = part * stiffness;
            let stretch = memory.tangential_displacement + self.substep_secs * tangential_velocity;
            let force = law::coulomb(-spring * stretch - dashpot, bound);
            memory.tangential_displacement = -(force + dashpot) / spring;
            memory.tangential_force = force;
        }
    }

    /// Changes the velocities of the grains by the forces of a substep (part of a step), computed from the present
    /// overlaps and from the velocities `start` at the beginning of the substep. Fills `pushes` with three values for
    /// each contact: the effective mass (kg), the impulses divided by this mass (m/s), and the velocity of the
    /// contact's wall (m/s).
    fn push<M: Model>(
        &self,
        stage: &mut Stage<'_, M>,
        start: &[M::Body<f64>],
        pushes: &mut Vec<(f64, [f64; 2], [f64; 2])>,
    ) {
        let h = self.substep_secs;
        let State { world, contacts, walls, .. } = &mut *stage.state;
        let bodies = &mut stage.problem.bodies.now;
        let masses = &world.grains.masses;
        let ContactParts { contacts: list, found_in, impulses, memories, sums } =
            contacts.parts_mut();
        pushes.clear();
        let columns = list.iter().zip(found_in).zip(impulses).zip(memories);
        for (((contact, &found_in), sum), memory) in columns {
            let (i, j) = (contact.grain as usize, contact.other as usize);
            let share = masses.get(j).map_or(1.0, |other| other / (masses[i] + other));
            let mass = masses[i] * share;
            let normal = M::normal_of(world, contact);
            let [normal_velocity, tangential_velocity] = velocity::<M>(normal, contact, start);
            let of_wall = walls.velocity(world, contact);
            let slip = [normal_velocity - of_wall[0], tangential_velocity - of_wall[1]];
            self.force::<M>(memory, contact.gap, mass, slip);
            let impulse = Impulse {
                normal: h * memory.normal_force,
                tangential: h * memory.tangential_force,
            };
            sum.normal += impulse.normal;
            sum.tangential += impulse.tangential;
            sums.add(Transmitted::of(*contact, found_in, contact.normal, impulse));
            let reduced = [impulse.normal / mass, impulse.tangential / mass];
            pushes.push((mass, reduced, of_wall));
            if j < bodies.len() {
                let (mut one, mut other) = (bodies[i], bodies[j]);
                M::push_pair(&mut one, &mut other, normal, reduced, share);
                bodies[i] = one;
                bodies[j] = other;
            } else {
                M::push_single(&mut bodies[i], normal, reduced);
            }
        }
    }
}

/// Ends a substep (part of a step) of walls driven by a force. Like grains, these walls move with the forces at the
/// beginning of the substep. `pushes` contains for each contact the effective mass (kg), the impulses divided by this
/// mass (m/s), and the velocity of the contact's wall (m/s).
///
/// The motion of a wall of mass M with n contacts of stiffness k is stable if the substep h is below 2 √(M/(nk)). This
/// is guaranteed if M is at least the mass of n of the lightest grains, because substeps are short enough for these
/// grains.
fn drive_walls<M: Model>(
    stage: &mut Stage<'_, M>,
    substep_secs: f64,
    pushes: &[(f64, [f64; 2], [f64; 2])],
    works: &mut StepResult,
) {
    let State { world, walls, contacts, .. } = &mut *stage.state;
    let mut driven: Vec<DrivenWall> = walls.driven(world, substep_secs).collect();
    if driven.is_empty() {
        return;
    }
    driven.iter_mut().for_each(|wall| wall.now = wall.free);
    let pushed = || {
        contacts.contacts().iter().zip(pushes).filter_map(|(contact, &(mass, impulse, _))| {
            let by = walls.surface(world, contact)?.driven?;
            Some((by.wall as usize, mass * by.part_along(impulse)))
        })
    };
    for (wall, along) in pushed() {
        driven[wall].now -= driven[wall].response * along;
    }
    for (wall, along) in pushed() {
        works.measures.wall_work += 0.5 * along * (driven[wall].now - driven[wall].before);
    }
    works.drive_work += walls.take_driven(world, &driven);
}
