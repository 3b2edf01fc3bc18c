//! Stepping schemes: ways to take a step that replace all of it, not only the solution of its
//! problem. Each cuts Δt into substeps h and moves the grains in each of them.
//!
//! The step's Contact Dynamics problem is set up all the same, and judged at the end with the
//! impulses that the scheme summed up over the step and the velocities it ended with: its residual
//! is the common measure of all methods. No scheme iterates to a tolerance, so stopping test,
//! tolerance and sweep limit mean nothing to it.

mod dem;
mod tgs_soft;

pub use dem::SpringDashpot;

use super::step::{Taken, integrate};
use super::{Simulation, pull};
use crate::solver::{Kinematics, Measures, MethodKind, Model, Scheme, SolveReport, measure};

/// Takes one step of Δt whose problem has been prepared.
pub(super) fn advance<M: Model>(simulation: &mut Simulation, scheme: Scheme) -> Taken {
    let problem = M::Kinematics::problem(&mut simulation.problems);
    problem.bodies.clone_from(&problem.before);
    let mut course = Course::<M::Kinematics>::new(simulation);
    let sweeps = match scheme {
        Scheme::TgsSoft => tgs_soft::advance::<M>(simulation, &mut course),
        Scheme::Dem => dem::advance::<M>(simulation, &mut course),
    };
    let Works { normal, tangential, gravity: gravity_work } = course.works;
    let problem = M::Kinematics::problem(&mut simulation.problems);
    let measures =
        Measures { normal_work: normal, tangential_work: tangential, ..measure::<M>(problem) };
    let report = SolveReport { sweeps, converged: true, ..SolveReport::default() };
    Taken { report, measures, gravity_work, bonds: None }
}

/// Substeps of the next step.
pub(super) fn substeps(simulation: &Simulation) -> u32 {
    match (simulation.solver.method.kind(), simulation.solver.substeps) {
        (MethodKind::Problem, _) => 1,
        (MethodKind::Scheme(Scheme::TgsSoft), 0) => tgs_soft::DEFAULT_SUBSTEPS,
        (MethodKind::Scheme(Scheme::Dem), 0) => dem::stable_substeps(simulation),
        (MethodKind::Scheme(_), given) => given,
    }
}

/// The longest substep, s, that is stable whatever the grains do; none where that is no question.
pub(super) fn critical_time_step_secs(simulation: &Simulation) -> Option<f64> {
    let dem = simulation.solver.method.kind() == MethodKind::Scheme(Scheme::Dem);
    dem.then(|| dem::critical_time_step_secs(simulation))
}

/// A step on its way through its substeps. Lives for one step: what a scheme carries on is in the
/// world and in the contacts' memories.
struct Course<K: Kinematics> {
    substeps: u32,
    /// h, s.
    substep_secs: f64,
    /// Bodies at the beginning of the substep.
    start: Vec<K::Body<f64>>,
    /// Bodies at the end of the substep if no contact acted.
    free: Vec<K::Body<f64>>,
    works: Works,
}

/// Works since the beginning of the step, J.
#[derive(Default)]
struct Works {
    normal: f64,
    tangential: f64,
    gravity: f64,
}

impl<K: Kinematics> Course<K> {
    fn new(simulation: &Simulation) -> Self {
        let substeps = simulation.substeps();
        Self {
            substeps,
            substep_secs: simulation.parameters.time_step_secs / f64::from(substeps),
            start: Vec::new(),
            free: Vec::new(),
            works: Works::default(),
        }
    }

    /// Begins a substep: gravity and a spring that pulls act on the bodies.
    fn begin(&mut self, simulation: &mut Simulation) {
        let push = simulation.push_of_pull(K::AXES, self.substep_secs);
        let Simulation { world, problems, .. } = simulation;
        let bodies = &mut K::problem(problems).bodies;
        self.start.clone_from(bodies);
        for (index, body) in bodies.iter_mut().enumerate() {
            if world.grains.feels_gravity[index] {
                *body = K::accelerated(body, world, index, self.substep_secs);
            }
        }
        if let Some(push) = push {
            pull::apply::<K>(bodies, push);
        }
        self.free.clone_from(bodies);
    }

    /// Moves the grains for h with the bodies' velocities.
    fn place<M: Model<Kinematics = K>>(&self, simulation: &mut Simulation) {
        self.store(simulation);
        integrate::<M>(simulation, self.substep_secs);
    }

    /// Hands the bodies' velocities to the world.
    fn store(&self, simulation: &mut Simulation) {
        let Simulation { world, problems, .. } = simulation;
        for (index, body) in K::problem(problems).bodies.iter().enumerate() {
            K::store(body, world, index);
        }
    }

    /// Counts the work of gravity and of the spring in the substep that ends with `bodies`.
    fn add_gravity_work(&mut self, bodies: &[K::Body<f64>], masses: &[f64]) {
        for (index, body) in bodies.iter().enumerate() {
            let (start, free) = (&self.start[index], &self.free[index]);
            self.works.gravity += K::work_of_gravity(start, body, free, masses[index]);
        }
    }
}

impl Works {
    /// Counts the work of one contact's impulses λ (m/s): in each substep, as in a step
    /// (`solver::measure`), impulse times the mean of the velocities at its beginning and its end.
    fn add(&mut self, mass: f64, impulse: [f64; 2], start: [f64; 2], end: [f64; 2]) {
        self.normal += 0.5 * mass * impulse[0] * (start[0] + end[0]);
        self.tangential += 0.5 * mass * impulse[1] * (start[1] + end[1]);
    }
}
