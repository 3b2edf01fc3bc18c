//! Describes the bodies of a contact problem in a file: the discs and contacts from which its matrix W and its relative
//! velocities q were computed. Solvers that work on bodies need them. The bodies are taken from a simulation, checked,
//! and converted to the contact problem of a step.

use std::collections::BTreeMap;
use std::ops::ControlFlow;

use serde::{Deserialize, Serialize};
use slump_core::with_model;

use super::{Friction, ProblemFile, pairs};
use crate::contact::{ContactLaw, ContactList};
use crate::error::{self, Error, Result};
use crate::scene::Scene;
use crate::sim::{ProblemVisitor, RunEnding, Simulation};
use crate::solver::{Assembled, FixedRow, Model, ModelParts, PairRow, Row, StepProblem};
use crate::world::{FrictionCone, Grains};

/// Largest accepted relative difference between the numbers in a problem file (matrix W, relative velocities q,
/// cohesion impulses c₀) and the values computed from the bodies in the file. It allows for rounding, and for files
/// whose numbers were cut to ten digits.
pub(super) const DISAGREEMENT: f64 = 1e-9;

/// Discs and their contacts, from which the matrix W, the relative velocities q and the cohesion impulses c₀ of a
/// problem file were computed. Each list has one entry per body or one per contact.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyForm {
    /// Number of coordinate axes along which the bodies move: 1 (all bodies are on the x axis) or 2.
    pub axes: u8,
    /// True if the bodies can rotate.
    pub rotation: bool,
    /// Capture speed Bond·g·Δt (Bond number, gravity g, time step Δt), m/s: the opening speed of a contact that
    /// cohesion stops within one step. The cohesion impulse c₀ of a contact is its effective mass times the capture
    /// speed.
    pub capture_speed: f64,
    /// Mass of each body, kg.
    pub mass: Vec<f64>,
    /// Moment of inertia of each body, kg·m². It must be that of a solid disc, ½mr².
    pub inertia: Vec<f64>,
    /// Radius of each body, m. It is also the lever arm of tangential forces at all contacts of the body.
    pub radius: Vec<f64>,
    /// Velocity (v_x, v_y) and angular velocity ω that each body would have at the end of the step without contact
    /// impulses, m/s and rad/s.
    pub free_velocity: Vec<[f64; 3]>,
    /// Indices of the two bodies i and j of each contact; j is null if body i touches a wall or a fixed disc, which no
    /// grain can move.
    pub pair: Vec<(u32, Option<u32>)>,
    /// Unit normal n of each contact, pointing from body j to body i.
    pub normal: Vec<[f64; 2]>,
    /// Term that restitution adds to the normal velocity q of each contact, m/s. For a contact with a gap within the
    /// touch tolerance the term is gap/Δt instead (Δt: time step), so that the gap may close.
    pub restitution_velocity: Vec<f64>,
    /// Tangential velocity of the surface of the touched wall or fixed disc at each contact, m/s. It is positive in the
    /// direction of the normal turned by +90°, and 0 if the contact does not involve a wall or fixed disc. The list is
    /// empty if no wall or fixed disc moves.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub surface_speed: Vec<f64>,
}

impl BodyForm {
    /// Checks the bodies. Also checks that the file's matrix W, relative velocities q and cohesion impulses c₀ follow
    /// from the bodies.
    pub(super) fn check(&self, file: &ProblemFile) -> Result<()> {
        let (bodies, contacts) = (self.mass.len(), file.nc);
        let lengths = [
            ("inertia", self.inertia.len(), bodies),
            ("radius", self.radius.len(), bodies),
            ("free_velocity", self.free_velocity.len(), bodies),
            ("pair", self.pair.len(), contacts),
            ("normal", self.normal.len(), contacts),
            ("restitution_velocity", self.restitution_velocity.len(), contacts),
        ];
        let surface_speeds = self.surface_speed.len();
        let lengths = lengths.into_iter().chain((surface_speeds > 0).then_some((
            "surface_speed",
            surface_speeds,
            contacts,
        )));
        for (field, found, wanted) in lengths {
            if found != wanted {
                let field = format!("the length of bodies.{field}");
                return Err(Error::value(field, found, wanted.to_string()));
            }
        }
        let are_axes = matches!((self.axes, self.rotation), (1, false) | (2, _));
        error::check(are_axes, "bodies.axes", self.axes, "2, or 1 without rotation")?;
        let (speed, allowed) = (self.capture_speed, "a finite number ≥ 0");
        error::check(speed >= 0.0 && speed.is_finite(), "bodies.capture_speed", speed, allowed)?;
        for (body, (&mass, &radius)) in self.mass.iter().zip(&self.radius).enumerate() {
            for (field, value) in [("mass", mass), ("radius", radius)] {
                if !(value > 0.0 && value.is_finite()) {
                    let field = format!("bodies.{field}[{body}]");
                    return Err(Error::value(field, value, "a finite number > 0"));
                }
            }
            let (inertia, solid) = (self.inertia[body], 0.5 * mass * radius * radius);
            if !agree(inertia, solid, solid) {
                let allowed = format!("{solid}, that of a solid disc");
                return Err(Error::value(format!("bodies.inertia[{body}]"), inertia, allowed));
            }
        }
        for (contact, &(i, j)) in self.pair.iter().enumerate() {
            if i as usize >= bodies || j.is_some_and(|j| j as usize >= bodies || i == j) {
                let found = format!("({i}, {})", j.map_or("null".into(), |j| j.to_string()));
                let allowed = format!("two bodies below {bodies}, the second one null if fixed");
                return Err(Error::value(format!("bodies.pair[{contact}]"), found, allowed));
            }
        }
        with_model!(self.parts(file)?, M => self.check_numbers::<M>(file))
    }

    /// Checks that the file's matrix W, relative velocities q and cohesion impulses c₀ agree with the values computed
    /// from the bodies. Without friction the tangential rows of W and q have no effect and need not agree.
    fn check_numbers<M: Model>(&self, file: &ProblemFile) -> Result<()> {
        let problem = self.step_problem::<M>(file);
        let assembled = Assembled::of(&problem)?;
        let place = |index: u32| 2 * problem.rows.contacts[index as usize / 2] + index % 2;
        let counts = |index: u32| M::FRICTION || index.is_multiple_of(2);
        let mut difference: BTreeMap<(u32, u32), f64> = BTreeMap::new();
        let mut diagonal = vec![0.0; 2 * file.nc];
        for (row, column, value) in assembled.matrix.entries() {
            let (row, column) = (place(row), place(column));
            *difference.entry((row, column)).or_default() += value;
            if row == column {
                diagonal[row as usize] = value;
            }
        }
        for (row, column, value) in file.matrix.entries() {
            *difference.entry((row, column)).or_default() -= value;
        }
        for (&(row, column), &off) in &difference {
            let scale = (diagonal[row as usize] * diagonal[column as usize]).sqrt();
            if counts(row) && counts(column) && !agree(off, 0.0, scale) {
                let found = format!("{} off what the bodies make it", off.abs());
                return Err(Error::value(format!("W[{row}, {column}]"), found, "theirs"));
            }
        }
        let fastest = file.q.iter().fold(0f64, |most, q| most.max(q.abs()));
        for (index, &q) in (0..).zip(&assembled.free_velocities) {
            let at = place(index);
            let found = file.q[at as usize];
            if counts(index) && !agree(found, q, fastest) {
                return Err(Error::value(format!("q[{at}]"), found, format!("{q}, the bodies'")));
            }
        }
        let cohesion = file.cohesion_impulses();
        let rows = problem.rows.iter();
        for (row, &contact) in rows.zip(&problem.rows.contacts) {
            let expected = row.effective_mass * self.capture_speed;
            let found = cohesion[contact as usize];
            if !agree(found, expected, expected) {
                let allowed = format!("{expected}, the bodies'");
                return Err(Error::value(format!("c0[{contact}]"), found, allowed));
            }
        }
        Ok(())
    }

    /// Returns the physical properties (axes, friction, rotation) of the problem. They select the [`Model`], the
    /// variant of the solvers that can solve the problem on its bodies.
    pub(super) fn parts(&self, file: &ProblemFile) -> Result<ModelParts> {
        let friction = self.friction(file)?;
        Ok(ModelParts {
            axes: self.axes,
            sheared: false,
            friction: self.axes == 2 && friction > 0.0,
            rotation: self.rotation,
            rolling: false,
        })
    }

    fn friction(&self, file: &ProblemFile) -> Result<f64> {
        let friction = file.friction();
        match friction.iter().find(|&mu| *mu != friction[0]) {
            Some(mu) => Err(Error::value("mu", mu, "the same for all contacts of bodies")),
            None => Ok(friction[0]),
        }
    }

    /// Returns the contact problem of the step in the form that solvers on bodies use. Contacts with walls and fixed
    /// discs come first; apart from this, contacts are in the order of the file.
    pub(super) fn step_problem<M: Model>(&self, file: &ProblemFile) -> StepProblem<M> {
        let coordinates = |body: usize| {
            let [x, y, spin] = self.free_velocity[body];
            M::from_coordinates([x, y, self.radius[body] * spin])
        };
        let free: Vec<_> = (0..self.mass.len()).map(coordinates).collect();
        let mut problem = StepProblem::<M>::default();
        problem.bodies.before.clone_from(&free);
        problem.bodies.free = free;
        let cone = if self.capture_speed > 0.0 { file.cone } else { FrictionCone::Shifted };
        problem.law = ContactLaw::new(file.friction()[0], self.capture_speed, cone);
        problem.bodies.masses.clone_from(&self.mass);
        problem.bodies.mean_mass = self.mass.iter().sum::<f64>() / self.mass.len() as f64;
        let starts: Vec<[f64; 2]> = match &file.start {
            Some(start) => pairs(start).collect(),
            None => vec![[0.0; 2]; file.nc],
        };
        for pass in [false, true] {
            for (contact, &(i, j)) in self.pair.iter().enumerate() {
                if j.is_some() != pass {
                    continue;
                }
                let mass = self.mass[i as usize];
                let share = j.map(|j| self.mass[j as usize] / (mass + self.mass[j as usize]));
                let effective_mass = share.map_or(mass, |share| mass * share);
                let surface_speed = self.surface_speed.get(contact).copied().unwrap_or(0.0);
                let [normal, tangential] = starts[contact];
                let row = Row {
                    i,
                    j: j.unwrap_or(0),
                    normal: M::normal(self.normal[contact]),
                    restitution_velocity: self.restitution_velocity[contact],
                    shifted_impulse: normal / effective_mass + self.capture_speed,
                    tangential_impulse: tangential / effective_mass,
                    effective_mass,
                };
                problem.rows.contacts.push(contact as u32);
                match share {
                    Some(share) => problem.rows.pairs.push(PairRow { row, share }),
                    None => problem.rows.fixed.push(FixedRow { row, surface_speed }),
                }
            }
        }
        problem.form_velocities();
        problem
    }
}

/// True if `found` and `expected`, two computed values of the same number, agree up to rounding: their difference is at
/// most [`DISAGREEMENT`] times `scale`. The result is false if a value is NaN.
fn agree(found: f64, expected: f64, scale: f64) -> bool {
    (found - expected).abs() <= DISAGREEMENT * scale
}

/// Runs the simulation of `scene` up to the time `at_secs` (s), and returns the contact problem of the step that begins
/// at that time. `progress` is called with the simulated time, s.
///
/// # Errors
/// If the time is before the start, if there are no contacts at that time, if a file cannot represent the problem
/// ([`problem_file_of`]), or if the state or a number of the problem is not finite.
pub fn problem_file_at(scene: &Scene, at_secs: f64, progress: impl Fn(f64)) -> Result<ProblemFile> {
    let is_time = at_secs >= 0.0 && at_secs.is_finite();
    error::check(is_time, "at", at_secs, "a finite number of seconds ≥ 0")?;
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
    error::check(file.nc != 0, "at", at_secs, "a time at which there are contacts")?;
    // Contact laws of a finite scene can still overflow, and a file cannot contain infinite numbers.
    file.delassus()?;
    file.bodies.as_ref().map_or(Ok(()), |bodies| bodies.check(&file))?;
    Ok(ProblemFile {
        comment: Some(format!("{}: the step that begins at t = {at_secs} s", scene.name)),
        ..file
    })
}

/// Returns the contact problem of a simulation's next step. The simulation does not change.
///
/// # Errors
/// If a file cannot represent the problem (walls driven by a force, rolling friction, or shearing periodic borders), or
/// if its matrix W would have too many entries.
pub fn problem_file_of(simulation: &Simulation) -> Result<ProblemFile> {
    let grains = &simulation.world().grains;
    simulation.next_problem(ProblemFileVisitor { grains })
}

struct ProblemFileVisitor<'a> {
    grains: &'a Grains,
}

impl ProblemVisitor for ProblemFileVisitor<'_> {
    type Output = Result<ProblemFile>;

    fn visit<M: Model>(self, problem: &mut StepProblem<M>, _: &ContactList) -> Result<ProblemFile> {
        check_can_be_held(problem)?;
        let Assembled { matrix, free_velocities } = Assembled::of(problem)?;
        let grains = self.grains;
        let rows = || problem.rows.iter();
        let fixed = problem.rows.fixed.len();
        let free_velocity = |(body, radius): (_, &f64)| {
            let [x, y, spin] = M::coordinates(body);
            [x, y, spin / radius]
        };
        let bodies = BodyForm {
            axes: M::AXES as u8,
            rotation: M::ROTATION,
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
                    let [[[x, y, _], _], _] = M::gradients(row.normal);
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
            mu: match &*problem.rows.frictions {
                _ if !M::FRICTION => Friction::Same(0.0),
                [] => Friction::Same(problem.law.friction),
                each => Friction::Each(each.to_vec()),
            },
            cone: problem.law.cone(),
            q: free_velocities,
            c0: (problem.law.capture_speed() > 0.0).then(|| cohesions().collect()),
            start: Some(starts.collect()),
            // `BodyForm` has only a single capture speed, so it is left out if contacts have different capture speeds.
            bodies: problem.rows.captures.is_empty().then_some(bodies),
            matrix,
        })
    }
}

/// Fails if a file cannot represent the problem, because of walls driven by a force, rolling friction, or shearing
/// periodic borders.
fn check_can_be_held<M: Model>(problem: &StepProblem<M>) -> Result<()> {
    let refuse = |field: &str, holds: &str| {
        Err(Error::value(field, "given", format!("left out: files hold problems of {holds}")))
    };
    if problem.is_driven() {
        return refuse("motions.drive", "grains alone");
    }
    if !problem.rows.rolling.is_empty() {
        return refuse("rolling-friction", "contacts without rolling friction");
    }
    if M::SLIDES {
        return refuse("periodic.shear_rate", "grains whose images stay");
    }
    Ok(())
}
