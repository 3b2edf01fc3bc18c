//! What the tests of stepping schemes share: two discs that meet, and what their meeting keeps.

use glam::DVec2;
use slump::scene::Scene;
use slump::sim::{Simulation, Stepper};
use slump::world::{Grain, Physics};

use super::{G, moving, parameters, scene};

/// The steppers that solve no problem of the whole step, and whose impulses are what moves the grains.
pub const SCHEMES: [Stepper; 2] = [Stepper::TgsSoft, Stepper::Dem];

/// Those, and the one whose bodies are moved a little past their impulses.
pub const ALL_SCHEMES: [Stepper; 3] = [Stepper::TgsSoft, Stepper::Avbd, Stepper::Dem];

/// The same scene, stepped this way with so many substeps.
pub fn by(stepper: Stepper, substeps: u32, mut scene: Scene) -> Scene {
    scene.parameters.substeps = substeps;
    Scene { stepper, ..scene }
}

/// Two unequal discs that are about to meet, tilted against the axes unless they are on a line.
pub fn meeting(physics: Physics, restitution: f64, dt: f64) -> Scene {
    let direction = if physics.axes == 1 { DVec2::X } else { DVec2::new(0.6, 0.8) };
    let grains = [(0.0, 0.15, 0.7), (0.25 + 1e-9, 0.1, -0.3)].map(|(place, radius, speed)| Grain {
        feels_gravity: false,
        ..moving(place * direction, radius, speed * direction)
    });
    scene(physics, -G * direction, parameters(0.0, dt, restitution, 0.5), grains.into())
}

/// Velocity of the second grain relative to the first, m/s.
pub fn relative_velocity(simulation: &Simulation) -> DVec2 {
    let velocities = &simulation.world().grains.velocities;
    velocities[1] - velocities[0]
}

/// Sum of all grains' momenta, kg·m/s.
pub fn momentum(simulation: &Simulation) -> DVec2 {
    let grains = &simulation.world().grains;
    grains.masses.iter().zip(&grains.velocities).map(|(&mass, &velocity)| mass * velocity).sum()
}

/// m_ij of the first two grains.
pub fn effective_mass(simulation: &Simulation) -> f64 {
    let masses = &simulation.world().grains.masses;
    1.0 / (1.0 / masses[0] + 1.0 / masses[1])
}
