//! What ways to step have in common that know no problem of the whole step: they cut Δt into substeps h and
//! move the grains in each of them.
//!
//! The step's Contact Dynamics problem is set up all the same, and judged at the end with the
//! impulses that were summed up over the step and the velocities it ended with: its residual
//! is the common measure of all. None iterates to a tolerance, so stopping test, tolerance and sweep
//! limit mean nothing.

use super::moreau::set_up::set_up;
use crate::sim::pull;
use crate::sim::settings::Settings;
use crate::sim::stepping::{Outcome, Stage};
use crate::solver::{Kinematics, Measures, Model, SolveReport, measure};

/// A step on its way through its substeps. Lives for one step: what is carried on is in the
/// world and in the contacts' memories.
pub(super) struct Course<K: Kinematics> {
    /// h, s.
    pub substep_secs: f64,
    /// Bodies at the beginning of the substep.
    pub start: Vec<K::Body<f64>>,
    /// Bodies at the end of the substep if no contact acted.
    pub free: Vec<K::Body<f64>>,
    pub works: Works,
}

/// Works since the beginning of the step, J.
#[derive(Clone, Copy, Default)]
pub(super) struct Works {
    normal: f64,
    tangential: f64,
    gravity: f64,
    wall: f64,
    border: f64,
    drives: f64,
}

impl<K: Kinematics> Course<K> {
    /// Begins a step in so many substeps: its problem is set up, and the bodies are where they were.
    pub(super) fn begin_step<M: Model<Kinematics = K>>(
        stage: &mut Stage<'_, M>,
        settings: &Settings,
        substeps: u32,
    ) -> Self {
        set_up(stage, settings);
        stage.problem.bodies.clone_from(&stage.problem.before);
        Self {
            substep_secs: settings.parameters.time_step_secs / f64::from(substeps),
            start: Vec::new(),
            free: Vec::new(),
            works: Works::default(),
        }
    }

    /// Ends the step, after so many passes over its contacts.
    pub(super) fn end_step<M: Model<Kinematics = K>>(
        &self,
        stage: &Stage<'_, M>,
        sweeps: u32,
    ) -> Outcome {
        let Works { normal, tangential, gravity, wall, border, drives } = self.works;
        let measures = Measures {
            normal_work: normal,
            tangential_work: tangential,
            wall_work: wall,
            border_work: border,
            ..measure::<M>(stage.problem)
        };
        let report = SolveReport { sweeps, ..SolveReport::nothing_yet() };
        Outcome { report, measures, gravity_work: gravity, drive_work: drives, bonds: None }
    }

    /// Begins a substep: gravity and a spring that pulls act on the bodies.
    pub(super) fn begin<M: Model<Kinematics = K>>(&mut self, stage: &mut Stage<'_, M>) {
        let push = stage.state.push_of_pull(K::AXES, self.substep_secs);
        let (world, bodies) = (&stage.state.world, &mut stage.problem.bodies);
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
    pub(super) fn place<M: Model<Kinematics = K>>(&self, stage: &mut Stage<'_, M>) {
        self.store(stage);
        stage.state.integrate::<M>(self.substep_secs);
    }

    /// Hands the bodies' velocities to the world.
    pub(super) fn store<M: Model<Kinematics = K>>(&self, stage: &mut Stage<'_, M>) {
        for (index, body) in stage.problem.bodies.iter().enumerate() {
            K::store(body, &mut stage.state.world, index);
        }
    }

    /// Counts the work of gravity and of the spring in the substep that ends with `bodies`.
    pub(super) fn add_gravity_work(&mut self, bodies: &[K::Body<f64>], masses: &[f64]) {
        for (index, body) in bodies.iter().enumerate() {
            let (start, free) = (&self.start[index], &self.free[index]);
            self.works.gravity += K::work_of_gravity(start, body, free, masses[index]);
        }
    }
}

impl Works {
    /// Counts the work of one contact's impulses λ (m/s): in each substep, as in a step
    /// (`solver::measure`), impulse times the mean of the velocities at its beginning and its end.
    pub(super) fn add(&mut self, mass: f64, impulse: [f64; 2], start: [f64; 2], end: [f64; 2]) {
        self.normal += 0.5 * mass * impulse[0] * (start[0] + end[0]);
        self.tangential += 0.5 * mass * impulse[1] * (start[1] + end[1]);
    }

    /// Counts what a driven wall did besides, J: its speed changed within the substep.
    pub(super) fn add_of_driven_wall(&mut self, work: f64) {
        self.wall += work;
    }

    /// Counts what an image that slides did besides.
    #[inline(always)]
    pub(super) fn add_of_border<K: Kinematics>(
        &mut self,
        mass: f64,
        impulse: [f64; 2],
        normal: K::Normal<f64>,
    ) {
        if K::SLIDES {
            let along = K::slide_along(normal);
            self.border += mass * (impulse[0] * along[0] + impulse[1] * along[1]);
        }
    }

    /// Counts the work of the forces that drive walls, J.
    pub(super) fn add_of_drives(&mut self, work: f64) {
        self.drives += work;
    }

    /// Counts what of it a wall did that goes with (V_n, V_t), m/s.
    pub(super) fn add_of_wall(&mut self, mass: f64, impulse: [f64; 2], velocity: [f64; 2]) {
        self.wall += mass * (impulse[0] * velocity[0] + impulse[1] * velocity[1]);
    }
}

/// Tells the problem that a step is judged by how walls that a force drives go at its end.
pub(super) fn tell_of_drives<M: Model>(stage: &mut Stage<'_, M>) {
    let drives = stage.state.world.motions.iter().filter_map(|motion| motion.drive.as_ref());
    stage.problem.set_wall_velocities(drives.map(|drive| drive.speed));
}
