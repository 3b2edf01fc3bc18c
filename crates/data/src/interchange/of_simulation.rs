//! A problem file from a running simulation.

use std::ops::ControlFlow;

use super::{BodyForm, Friction, ProblemFile};
use crate::contact::ContactList;
use crate::error::{Error, Result};
use crate::scene::Scene;
use crate::sim::{ProblemVisitor, RunEnding, Simulation};
use crate::solver::{Assembled, Kinematics, Model, StepProblem};
use crate::world::Grains;

/// The problem of the step that begins at `at_secs`, the simulation of `scene` having got there by
/// itself. `progress` is told the simulated time, s.
///
/// # Errors
/// Where the time is before the start, there is no contact at it, so many that a file would not hold
/// their matrix, the state is not finite, or a number of the problem is not.
pub fn problem_file_at(scene: &Scene, at_secs: f64, progress: impl Fn(f64)) -> Result<ProblemFile> {
    if !(at_secs >= 0.0 && at_secs.is_finite()) {
        return Err(Error::value("at", at_secs, "a finite number of seconds ≥ 0"));
    }
    scene.parameters.check_steps("at", at_secs)?;
    let mut simulation = scene.simulation()?;
    let ended = simulation.run(scene.parameters.steps_in(at_secs), |simulation| {
        progress(simulation.time_secs());
        Ok(ControlFlow::Continue(()))
    })?;
    if let RunEnding::NotFinite(failure) = ended {
        return Err(failure);
    }
    let file = problem_file_of(&simulation)?;
    if file.nc == 0 {
        return Err(Error::value("at", at_secs, "a time at which there are contacts"));
    }
    // A finite scene can have contact laws whose numbers overflow, which no file can hold.
    file.delassus()?;
    file.bodies.as_ref().map_or(Ok(()), |bodies| bodies.check(&file))?;
    Ok(ProblemFile {
        comment: Some(format!("{}: the step that begins at t = {at_secs} s", scene.name)),
        ..file
    })
}

/// The problem of a simulation's next step. The simulation stays as it is.
///
/// # Errors
/// Where it has so many contacts that a file would not hold their matrix.
pub fn problem_file_of(simulation: &Simulation) -> Result<ProblemFile> {
    let grains = &simulation.world().grains;
    simulation.next_problem(ProblemFileVisitor { grains })
}

struct ProblemFileVisitor<'a> {
    grains: &'a Grains,
}

impl ProblemVisitor for ProblemFileVisitor<'_> {
    type Output = Result<ProblemFile>;

    fn visit<M: Model>(
        self,
        problem: &mut StepProblem<M::Kinematics>,
        _: &ContactList,
    ) -> Result<ProblemFile> {
        check(problem)?;
        let Assembled { matrix, free_velocities } = Assembled::of(problem)?;
        let grains = self.grains;
        let rows = || problem.rows.iter();
        let fixed = problem.rows.fixed.len();
        let free_velocity = |(body, radius): (_, &f64)| {
            let [x, y, spin] = M::Kinematics::coordinates(body);
            [x, y, spin / radius]
        };
        let bodies = BodyForm {
            axes: M::Kinematics::AXES as u8,
            rotation: M::Kinematics::ROTATION,
            capture_speed: problem.law.capture_speed(),
            mass: grains.masses.clone(),
            inertia: (0..grains.len()).map(|body| grains.inertia(body)).collect(),
            radius: grains.radii.clone(),
            free_velocity: problem
                .bodies
                .free
                .iter()
                .zip(&grains.radii)
                .map(free_velocity)
                .collect(),
            pair: (0..)
                .zip(rows())
                .map(|(at, row)| (row.i, (at >= fixed).then_some(row.j)))
                .collect(),
            normal: rows()
                .map(|row| {
                    let [[[x, y, _], _], _] = M::Kinematics::gradients(row.normal);
                    [x, y]
                })
                .collect(),
            restitution_velocity: rows().map(|row| row.restitution_velocity).collect(),
            surface_speed: problem.surface_speeds(),
        };
        let cohesions = || problem.rows().map(|(at, row)| row.effective_mass * problem.capture(at));
        let starts = problem.rows().flat_map(|(at, row)| {
            problem.reduced_impulse(at, row).map(|impulse| row.effective_mass * impulse)
        });
        Ok(ProblemFile {
            comment: None,
            nc: problem.rows.contacts.len(),
            mu: Friction::Same(if M::FRICTION { problem.law.friction } else { 0.0 }),
            cone: problem.law.cone(),
            q: free_velocities,
            c0: (problem.law.capture_speed() > 0.0).then(|| cohesions().collect()),
            start: Some(starts.collect()),
            // Bodies know of one capture speed alone.
            bodies: problem.rows.captures.is_empty().then_some(bodies),
            matrix,
        })
    }
}

/// Whether a file can hold a problem.
fn check<K: Kinematics>(problem: &StepProblem<K>) -> Result<()> {
    let refuse = |field: &str, holds: &str| {
        Err(Error::value(field, "given", format!("left out: files hold problems of {holds}")))
    };
    if problem.is_driven() {
        return refuse("motions.drive", "grains alone");
    }
    if K::SLIDES {
        return refuse("periodic.shear_rate", "grains whose images stay");
    }
    Ok(())
}
