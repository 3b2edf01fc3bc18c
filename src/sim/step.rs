//! One step of Contact Dynamics: detect, solve, integrate (paper §2.1, scheme of Moreau).

use super::bonds::BondEnergies;
use super::detection::detect;
use super::{Observables, Simulation, bounces, pull, push_out, range_step, schemes};
use crate::contact::ContactList;
use crate::error::Result;
use crate::solver::{
    Kinematics, Measures, MethodKind, Model, ModelVisitor, SolveReport, SolverSettings,
    StepProblem, measure, visit_leanest,
};
use crate::world::{ContactLaw, Parameters};

/// Takes one step of Δt, compiled for the leanest model that the scene and its parameters allow.
pub(super) fn take(simulation: &mut Simulation) -> Result<()> {
    let (physics, parameters) = (simulation.physics, simulation.parameters);
    visit_leanest(physics, &parameters, Step(simulation))
}

/// What a way to step tells of the step that it took.
pub(super) struct Taken {
    pub report: SolveReport,
    pub measures: Measures,
    /// Work of gravity and of a spring, J.
    pub gravity_work: f64,
    /// Of the law `range`.
    pub bonds: Option<BondEnergies>,
}

/// Measures the initial state: energies, and the contacts that are there before any impulse.
pub(super) fn measure_start(simulation: &mut Simulation) {
    let (physics, parameters) = (simulation.physics, simulation.parameters);
    visit_leanest(physics, &parameters, Start(simulation));
}

/// Something to be done with a step's problem, before it is solved.
pub trait ProblemVisitor {
    /// What it gives.
    type Output;
    /// Does it; row `k` of the problem is contact `problem.contact_of_row[k]` of `contacts`.
    fn visit<M: Model>(
        self,
        problem: &mut StepProblem<M::Kinematics>,
        contacts: &ContactList,
    ) -> Self::Output;
}

/// Shows the next step's problem to `visitor`. The simulation is then between detection and
/// solution, and good for nothing else.
pub(super) fn show_problem<V: ProblemVisitor>(
    simulation: &mut Simulation,
    visitor: V,
) -> V::Output {
    let (physics, parameters) = (simulation.physics, simulation.parameters);
    visit_leanest(physics, &parameters, Show { simulation, visitor })
}

struct Show<'a, V> {
    simulation: &'a mut Simulation,
    visitor: V,
}

impl<V: ProblemVisitor> ModelVisitor for Show<'_, V> {
    type Output = V::Output;

    fn visit<M: Model>(self) -> V::Output {
        prepare::<M>(self.simulation);
        // A scheme, which alone could be refused, has none.
        let _ = bounces::follow_impacts::<M>(self.simulation);
        let Simulation { problems, contacts, .. } = self.simulation;
        self.visitor.visit::<M>(M::Kinematics::problem(problems), contacts)
    }
}

/// Detects the contacts and sets up the problem of the next step.
pub(super) fn prepare<M: Model>(simulation: &mut Simulation) {
    let time_step_secs = simulation.parameters.time_step_secs;
    let time_step_before = simulation.time_step_of_impulses_secs;
    if time_step_secs != time_step_before {
        simulation.contacts.scale_impulses(time_step_secs / time_step_before);
        simulation.time_step_of_impulses_secs = time_step_secs;
    }
    simulation.walls.begin(&simulation.world, &simulation.candidates, time_step_secs);
    detect::<M>(simulation);
    let push = simulation.push_of_pull(M::Kinematics::AXES, time_step_secs);
    let Simulation { world, physics, parameters, solver, contacts, problems, walls, .. } =
        simulation;
    let problem = M::Kinematics::problem(problems);
    let parameters = Parameters { law: law(parameters, solver), ..*parameters };
    problem.prepare::<M>(world, contacts, &parameters, physics.cohesion, solver);
    if walls.any_move() {
        problem.drive(world, contacts, &parameters, |contact| walls.speed(world, contact));
    }
    if let Some(push) = push {
        pull::apply::<M::Kinematics>(&mut problem.free, push);
        pull::apply::<M::Kinematics>(&mut problem.bodies, push);
    }
}

/// The law of a step: a scheme has its own.
pub(super) fn law(parameters: &Parameters, solver: &SolverSettings) -> ContactLaw {
    match solver.method.kind() {
        MethodKind::Problem => parameters.law,
        MethodKind::Scheme(_) => ContactLaw::Moreau,
    }
}

struct Step<'a>(&'a mut Simulation);

impl ModelVisitor for Step<'_> {
    type Output = Result<()>;

    fn visit<M: Model>(self) -> Result<()> {
        let simulation = self.0;
        let method = simulation.solver.method;
        prepare::<M>(simulation);
        if simulation.method_of_memories != Some(method) {
            simulation.contacts.forget();
            simulation.method_of_memories = Some(method);
        }
        let Taken { report, measures, gravity_work, bonds } = match method.kind() {
            MethodKind::Problem => solve_and_move::<M>(simulation)?,
            MethodKind::Scheme(scheme) => schemes::advance::<M>(simulation, scheme),
        };

        let problem = M::Kinematics::problem(&mut simulation.problems);
        let masses = &simulation.world.grains.masses;
        let moving = problem.bodies.iter().zip(masses);
        let kinetic_energy =
            moving.map(|(body, &mass)| M::Kinematics::kinetic_energy(body, mass)).sum();
        let time_step_secs = simulation.parameters.time_step_secs;
        let before = simulation.observables;
        simulation.observables = Observables {
            step: before.step + 1,
            time_secs: before.time_secs + time_step_secs,
            time_step_secs,
            sweeps: report.sweeps,
            factorisations: report.factorisations,
            converged: report.converged,
            stalled: report.stalled,
            residual: measures.residual,
            compressive_contacts: measures.compressive_contacts,
            tensile_contacts: measures.tensile_contacts,
            normal_work: measures.normal_work,
            tangential_work: measures.tangential_work,
            gravity_work,
            kinetic_energy,
            bond_work: bonds.map(|bonds| bonds.work),
            bond_energy: bonds.map(|bonds| bonds.stored),
            broken_bond_energy: bonds
                .map(|bonds| before.broken_bond_energy.unwrap_or(0.0) + bonds.broken),
            ..geometry::<M>(simulation)
        };
        Ok(())
    }
}

/// Solves the prepared problem and moves the grains.
fn solve_and_move<M: Model>(simulation: &mut Simulation) -> Result<Taken> {
    if simulation.parameters.law == ContactLaw::Range {
        return range_step::take::<M>(simulation);
    }
    let report = bounces::solve_step::<M>(simulation)?;
    let taken = move_by::<M>(simulation, report);
    if simulation.solver.remedies.push_out {
        push_out::push_out(simulation, simulation.parameters.time_step_secs);
    }
    Ok(taken)
}

/// Moves the grains by the solution of a problem.
pub(super) fn move_by<M: Model>(simulation: &mut Simulation, report: SolveReport) -> Taken {
    let Simulation { world, contacts, problems, .. } = simulation;
    let problem = M::Kinematics::problem(problems);
    let measures = measure::<M>(problem);
    problem.store_impulses(contacts);
    let mut gravity_work = 0.0;
    for (index, body) in problem.bodies.iter().enumerate() {
        M::Kinematics::store(body, world, index);
        let (before, free) = (&problem.before[index], &problem.free[index]);
        let mass = world.grains.masses[index];
        gravity_work += M::Kinematics::work_of_gravity(before, body, free, mass);
    }
    integrate::<M>(simulation, simulation.parameters.time_step_secs);
    Taken { report, measures, gravity_work, bonds: None }
}

struct Start<'a>(&'a mut Simulation);

impl ModelVisitor for Start<'_> {
    type Output = ();

    fn visit<M: Model>(self) {
        let simulation = self.0;
        detect::<M>(simulation);
        let bodies = 0..simulation.world.grains.len();
        let energy = |index: usize| {
            let body = M::Kinematics::body(&simulation.world, index);
            M::Kinematics::kinetic_energy(&body, simulation.world.grains.masses[index])
        };
        let law = law(&simulation.parameters, &simulation.solver);
        let none_yet = (law == ContactLaw::Range).then_some(0.0);
        simulation.observables = Observables {
            time_step_secs: simulation.parameters.time_step_secs,
            converged: true,
            kinetic_energy: bodies.map(energy).sum(),
            bond_work: none_yet,
            bond_energy: none_yet,
            broken_bond_energy: none_yet,
            ..geometry::<M>(simulation)
        };
    }
}

/// x^n = x^{n−1} + Δt v^n (paper eq. 12), and the angles where grains turn.
pub(super) fn integrate<M: Model>(simulation: &mut Simulation, time_step_secs: f64) {
    let grains = &mut simulation.world.grains;
    for (position, velocity) in grains.positions.iter_mut().zip(&grains.velocities) {
        if M::Kinematics::AXES == 1 {
            position.x += time_step_secs * velocity.x;
        } else {
            *position += time_step_secs * *velocity;
        }
    }
    // Grains go on turning where friction is switched off for the moment.
    if simulation.physics.rotation {
        for (angle, spin) in grains.angles.iter_mut().zip(&grains.angular_velocities) {
            *angle += time_step_secs * spin;
        }
    }
    let Simulation { world, candidates, walls, .. } = simulation;
    if walls.any_move() {
        walls.advance(world, candidates, time_step_secs);
    }
}

/// The observables that positions and contacts alone tell.
fn geometry<M: Model>(simulation: &Simulation) -> Observables {
    let world = &simulation.world;
    let grains = &world.grains;
    let contacts = simulation.contacts.contacts();
    let mut overlap_of_pairs = 0.0;
    let mut pairs = 0u32;
    let mut smallest_gap = 0f64;
    let ranges = law(&simulation.parameters, &simulation.solver) == ContactLaw::Range;
    let mut in_touch = 0;
    for (index, contact) in contacts.iter().enumerate() {
        if !simulation.contacts.is_in_touch(index) {
            continue;
        }
        in_touch += 1;
        smallest_gap = smallest_gap.min(contact.gap);
        if (contact.other as usize) < grains.len() {
            // A bond may be stretched; what is not overlap does not count as such.
            overlap_of_pairs += if ranges { (-contact.gap).max(0.0) } else { contact.gap.abs() };
            pairs += 1;
        }
    }
    let mut heights = 0.0;
    let mut potential_energy = 0.0;
    for index in 0..grains.len() {
        let position = grains.positions[index];
        heights += position.y;
        if grains.feels_gravity[index] {
            potential_energy += grains.masses[index] * world.gravity.potential(position);
        }
    }
    let dropped = simulation.initial_heights - heights;
    Observables {
        contacts: in_touch,
        mean_overlap: overlap_of_pairs / f64::from(pairs.max(1)) / world.mean_diameter,
        max_overlap: -smallest_gap / world.mean_diameter,
        potential_energy,
        // On a line nothing can slump, and about a mean height of 0 a relative drop says nothing.
        slump: if M::Kinematics::AXES == 1 || simulation.initial_heights == 0.0 {
            0.0
        } else {
            dropped / simulation.initial_heights
        },
        ..Observables::default()
    }
}
