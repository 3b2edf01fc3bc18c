//! An independent check of a solved step. It computes the natural map (the error of the contact laws) from positions,
//! velocities and impulses by the equations of the documentation, and shares no arithmetic with the solver.

use glam::DVec2;
use slump::sim::Simulation;
use slump::world::{FrictionCone, Grains, Motion, MotionCourse, Parameters};

/// Quantities of one contact that the contact law needs, computed only from positions and velocities of the bodies.
/// Masses are in kg, the cohesion impulse in N·s.
pub struct Judged {
    pub normal_mass: f64,
    pub tangential_mass: f64,
    pub cohesion_impulse: f64,
    /// Relative velocity (v_n, v_t) (normal and tangential) at the beginning of the step, m/s.
    pub before: [f64; 2],
    /// Relative velocity (v_n, v_t) (normal and tangential) at the end of the step, m/s.
    pub after: [f64; 2],
    /// Relative velocity (v_n, v_t) (normal and tangential) at the end of the step if no contact impulse acted, m/s.
    pub free: [f64; 2],
    /// Velocity that the contact law adds to the normal velocity v_n at the end of the step, m/s: the restitution ρ
    /// times the initial v_n or, for an open gap within the touch tolerance, the speed that closes the gap in one step.
    pub rebound: f64,
}

/// Upper limit, in mean diameters, for the gap at which grains already push each other. Grains push up to half the
/// touch tolerance or up to this limit, whichever is smaller, because rounding makes gaps between touching grains.
const ROUNDING: f64 = 1e-4;

/// Velocities (m/s) and angular velocities (rad/s) of the grains.
type Velocities = (Vec<DVec2>, Vec<f64>);

const NONE: (DVec2, f64) = (DVec2::ZERO, 0.0);

/// Returns the velocity of a body that is not a grain, and the speed of its surface relative to the body, m/s. Supports
/// only half-spaces and straight motions.
fn wall_velocity(simulation: &Simulation, other: u32) -> (DVec2, f64) {
    let world = simulation.world();
    let body = other as usize - world.grains.len();
    let (fixed, discs) = (world.fixed_discs.len(), body < world.fixed_discs.len());
    let moves = |motion: &&Motion| match discs {
        true => motion.fixed_discs.contains(&body),
        false => motion.boundaries.contains(&(body - fixed)),
    };
    let Some(motion) = world.motions.iter().find(moves) else { return NONE };
    let velocity = match &motion.course {
        Some(MotionCourse::Straight { direction, speed, travel: None }) => {
            *speed * direction.normalize()
        }
        Some(course) => panic!("a course that is not judged: {course:?}"),
        None => DVec2::ZERO,
    };
    (velocity, motion.surface_speed)
}

pub fn judge(simulation: &Simulation, before: &Grains) -> Vec<Judged> {
    let world = simulation.world();
    let grains = &world.grains;
    let Parameters {
        time_step_secs: dt, restitution, restitution_threshold, touch_tolerance, ..
    } = *simulation.parameters();
    let least_closing = restitution_threshold * dt * world.gravity.magnitude();
    let touching = (0.5 * touch_tolerance).min(ROUNDING) * world.mean_diameter;
    let turning = simulation.physics().rotation;
    let motion = |grains: &Grains| (grains.velocities.clone(), grains.angular_velocities.clone());
    let (start, end) = (motion(before), motion(grains));
    let mut free = start.clone();
    for (k, velocity) in free.0.iter_mut().enumerate() {
        let falls = f64::from(u8::from(before.feels_gravity[k]));
        *velocity += falls * dt * world.gravity.acceleration(before.positions[k]);
    }
    let list = simulation.contacts().contacts().iter();
    list.map(|contact| {
        let (i, j) = (contact.grain as usize, contact.other as usize);
        let j = (j < grains.len()).then_some(j);
        let (wall, surface) =
            if j.is_none() { wall_velocity(simulation, contact.other) } else { NONE };
        let mobility = |f: &dyn Fn(usize) -> f64| f(i) + j.map_or(0.0, f);
        let normal_mobility = mobility(&|k| 1.0 / grains.masses[k]);
        let spin_mobility = mobility(&|k| grains.radii[k].powi(2) / grains.inertia(k));
        let relative = |(velocities, spins): &Velocities| {
            let velocity = velocities[i] - j.map_or(wall, |j| velocities[j]);
            let rim = grains.radii[i] * spins[i] + j.map_or(0.0, |j| grains.radii[j] * spins[j]);
            let tangent = DVec2::new(-contact.normal.y, contact.normal.x);
            let rim = if turning { rim } else { 0.0 };
            [contact.normal.dot(velocity), tangent.dot(velocity) - rim - surface]
        };
        let normal_mass = 1.0 / normal_mobility;
        let (before, gap) = (relative(&start), contact.gap);
        let bounces = before[0].abs() >= least_closing;
        let bounce = if bounces { restitution * before[0] } else { 0.0 };
        let comes_there = bounce < 0.0 && gap + dt * before[0] < 0.0;
        let rebound = if gap <= touching || comes_there { bounce } else { gap / dt };
        let spin_mobility = if turning { spin_mobility } else { 0.0 };
        let cohesion_force = simulation.parameters().bond * normal_mass * world.gravity.magnitude();
        Judged {
            normal_mass,
            tangential_mass: 1.0 / (normal_mobility + spin_mobility),
            cohesion_impulse: dt * cohesion_force,
            before,
            after: relative(&end),
            free: relative(&free),
            rebound,
        }
    })
    .collect()
}

/// Returns three numbers, all in N·s: the norm of the natural map (the differences between the impulses and those that
/// an update of each contact by its law would give), the norm by which it is divided to give the residual, and the
/// largest amount by which an impulse breaks the contact law: by which a tangential impulse exceeds its friction bound,
/// or the sum of normal impulse and cohesion impulse is below 0. `before` contains the grains before the step.
pub fn natural_map(simulation: &Simulation, before: &Grains) -> (f64, f64, f64) {
    let Parameters { friction, cone, .. } = *simulation.parameters();
    let (mut error, mut scale, mut outside) = (0.0, 0.0, 0f64);
    let judged = judge(simulation, before);
    for (contact, impulse) in judged.iter().zip(simulation.contacts().impulses()) {
        let p = impulse.normal + contact.cohesion_impulse;
        let formal = |velocity: f64| velocity + contact.rebound;
        let bound = friction
            * match cone {
                FrictionCone::Shifted => p.max(0.0),
                FrictionCone::Compressive => impulse.normal.max(0.0),
            };
        let (m_n, m_t) = (contact.normal_mass, contact.tangential_mass);
        let normal = p - (p - m_n * formal(contact.after[0])).max(0.0);
        error += normal * normal;
        scale += (m_n * formal(contact.free[0])).powi(2);
        outside = outside.max(-p).max(impulse.tangential.abs() - bound);
        if friction > 0.0 && simulation.physics().friction {
            let stuck = impulse.tangential - m_t * contact.after[1];
            let tangential = impulse.tangential - stuck.clamp(-bound, bound);
            error += tangential * tangential;
            scale += (m_t * contact.free[1]).powi(2);
        }
    }
    (error.sqrt(), scale.sqrt(), outside)
}
