//! One contender on one challenge at one level, and what measures have in common.

use super::Contender;
use crate::contact::Numbering;
use crate::error::Result;
use crate::scene::Scene;
use crate::sim::Simulation;

/// One contender at one level of a challenge.
#[derive(Clone, Copy, Debug)]
pub struct Trial {
    /// Who is tried.
    pub(crate) contender: &'static Contender,
    /// The value of the parameter that drives the scene into failure.
    pub(crate) level: f64,
}

impl Trial {
    /// The scene at t = 0, stepped by the contender.
    pub(super) fn start(&self, mut scene: Scene) -> Result<Simulation> {
        self.contender.apply(&mut scene);
        scene.simulation()
    }

    /// The same with so many sweeps a step, whatever the contender says of them.
    pub(super) fn start_within(&self, sweeps: u32, mut scene: Scene) -> Result<Simulation> {
        self.contender.apply(&mut scene);
        scene.solver.max_sweeps = sweeps;
        scene.simulation()
    }

    /// The level as a count.
    pub(super) fn count(&self) -> usize {
        self.level as usize
    }
}

/// Steps for a simulated time, s.
pub(super) fn advance(simulation: &mut Simulation, secs: f64) -> Result<()> {
    simulation.take_steps(simulation.parameters().steps_in(secs))
}

/// The longest way that any grain has gone since `scene`, in d.
pub(super) fn longest_way(simulation: &Simulation, scene: &Scene) -> f64 {
    let now = &simulation.world().grains.positions;
    let ways = scene.grains.iter().zip(now).map(|(grain, now)| grain.position.distance(*now));
    ways.fold(0.0, f64::max) / scene.mean_diameter
}

/// √(2 E_kin/M), in √(g d).
pub(super) fn jitter(simulation: &Simulation) -> f64 {
    let world = simulation.world();
    let mass: f64 = world.grains.masses.iter().sum();
    let scale = world.gravity.magnitude() * world.mean_diameter;
    (2.0 * simulation.observables().kinetic_energy / (mass * scale)).sqrt()
}

/// The longest way of any grain since `scene`, in d, or the speed that is left, in √(g d), whichever is
/// larger: 0 for what stays at rest.
pub(super) fn unrest(simulation: &Simulation, scene: &Scene) -> f64 {
    longest_way(simulation, scene).max(jitter(simulation))
}

/// What the fixed bodies carry along the y axis, N: the sum of N n_y over their contacts.
pub(super) fn force_on_ground(simulation: &Simulation) -> f64 {
    let numbering = Numbering::of(simulation.world());
    let list = simulation.contacts();
    let pairs = list.contacts().iter().zip(list.impulses());
    let of_ground = pairs.filter(|(contact, _)| numbering.other(contact.other).grain().is_none());
    let impulse: f64 = of_ground.map(|(contact, impulse)| impulse.normal * contact.normal.y).sum();
    impulse / simulation.parameters().time_step_secs
}

/// Where a property that holds above a threshold begins, searched between `low` and `high` in
/// ratio, with so many halvings.
pub(super) fn threshold(
    [mut low, mut high]: [f64; 2],
    halvings: u32,
    mut holds: impl FnMut(f64) -> Result<bool>,
) -> Result<f64> {
    for _ in 0..halvings {
        let middle = (low * high).sqrt();
        if holds(middle)? {
            high = middle;
        } else {
            low = middle;
        }
    }
    Ok((low * high).sqrt())
}
