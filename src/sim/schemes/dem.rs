//! Smooth discrete elements (P. A. Cundall & O. D. L. Strack, 1979), with the linear cohesive law
//! that S. Luding (2008) starts from: a contact is a spring and a dashpot, and pulls by C₀ as long
//! as the discs overlap. With δ = −gap the overlap,
//!
//! > N = max(k δ − γ v_n, 0) − C₀,  T = −k_t ξ − γ_t v_t with ξ̇ = v_t,  |T| ≤ bound(N + C₀).
//!
//! Spring and dashpot together never pull: N ≥ −C₀, as everywhere here, and the cone is that of the
//! contact laws. Where friction slides, ξ is shortened to what gives T at the bound.
//!
//! **Damping from restitution.** Two discs meet with closing speed v. With ω₀ = √(k/m_ij) and
//! γ = 2ζ m_ij ω₀, δ̈ + 2ζω₀ δ̇ + ω₀² δ = 0 until the force is 0, and from then on they fly. For ζ < 1 write
//! ζ = cos φ, so that δ ∝ e^{−ζω₀t} sin(ω₀ sin φ t). Setting δ̈ = 0 gives ω₀ sin φ t = 2φ, and there
//! the speed is v e^{−ζω₀t}. So
//!
//! > ρ = exp(−2ζ arccos ζ / √(1 − ζ²)),  for ζ > 1  ρ = exp(−2ζ arcosh ζ / √(ζ² − 1)),
//!
//! e^{−2} between the two. It falls with ζ, towards 1/(4ζ²), and reaches 0 at no finite damping:
//! smaller restitutions than [`LEAST_RESTITUTION`] are taken as that.
//!
//! **Critical time step.** Velocities first, then positions, with the forces of the beginning of
//! the substep: a mode of frequency ω and damping ratio ζ has z² − (2 − 2ζωh − ω²h²) z + 1 − 2ζωh = 0,
//! and its first root to leave the unit circle does so at z = −1, where ω²h² + 4ζωh = 4:
//!
//! > h = (2/ω) (√(1 + ζ²) − ζ).
//!
//! If each of the bodies of a contact has z contacts, and each contact its 1/z of their masses, no
//! mode of the whole is faster than the fastest one of a contact by itself, ω² = z k/m_ij, ζ√z.
//! With k_t = k m_t/m_n and γ_t = γ m_t/m_n the tangential mode is as fast as the normal one.

use super::Course;
use crate::contact::{Contact, Impulse, law};
use crate::sim::Simulation;
use crate::sim::detection::detect;
use crate::sim::pull::GRAVITY_IF_NONE;
use crate::solver::{Kinematics, MAX_SUBSTEPS, Model};
use crate::world::World;

/// Overlap that the weight of a whole pile makes, in d. Smaller: stiffer and dearer, h ∝ its root;
/// larger: softer grains, until their overlap shows in the shape of the pile.
const STATIC_OVERLAP: f64 = 1e-3;
/// Restitution below this is taken as this. Smaller: more damping, and h falls as its root.
const LEAST_RESTITUTION: f64 = 0.02;
/// Substeps are this part of the critical step where their number is left to the scheme. Larger:
/// a collision is cut into fewer substeps, and its restitution is less exact; at 1 it may blow up.
const SAFE_FRACTION: f64 = 0.5;
/// Equal discs that fit around one, in the plane and on a line.
const NEIGHBOURS: [f64; 2] = [6.0, 2.0];
/// Halvings of the interval that the damping ratio is looked for in: down to rounding.
const HALVINGS: u32 = 60;

/// Spring and dashpot of the contacts of a world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringDashpot {
    /// k, N/m.
    pub stiffness: f64,
    /// ζ of a contact by itself.
    pub damping_ratio: f64,
}

impl SpringDashpot {
    /// Stiff enough for a pile of the world's grains, damped for restitution ρ.
    ///
    /// The load is the weight of a column as high as the grains are many along an axis, √n in the
    /// plane.
    pub fn of(world: &World, axes: u8, restitution: f64) -> Self {
        let masses = &world.grains.masses;
        let count = masses.len() as f64;
        let column = if axes == 1 { count } else { count.sqrt() };
        let g = match world.gravity.magnitude() {
            0.0 => GRAVITY_IF_NONE,
            magnitude => magnitude,
        };
        let load = column * g * masses.iter().sum::<f64>() / count;
        Self {
            stiffness: load / (STATIC_OVERLAP * world.mean_diameter),
            damping_ratio: damping_ratio(restitution),
        }
    }

    /// γ of a contact, N·s/m.
    pub fn damping(&self, effective_mass: f64) -> f64 {
        2.0 * self.damping_ratio * (self.stiffness * effective_mass).sqrt()
    }

    /// The critical time step, s, of contacts of that effective mass (kg) whose bodies have
    /// `neighbours` contacts each: exact for 1, a lower bound for more.
    pub fn critical_time_step_secs(&self, effective_mass: f64, neighbours: f64) -> f64 {
        let frequency = (neighbours * self.stiffness / effective_mass).sqrt();
        let damping_ratio = self.damping_ratio * neighbours.sqrt();
        2.0 / frequency / (damping_ratio.hypot(1.0) + damping_ratio)
    }
}

/// The ζ that gives a restitution.
fn damping_ratio(restitution: f64) -> f64 {
    let wanted = restitution.max(LEAST_RESTITUTION);
    // At ζ = 1/√ρ it is below ρ for every ρ < 1.
    let (mut low, mut high) = (0.0, 1.0 / wanted.sqrt());
    if wanted == 1.0 {
        return low;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if restitution_of(middle) > wanted {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// The restitution that a damping ratio gives.
fn restitution_of(damping_ratio: f64) -> f64 {
    // As a product: near 1 the difference of squares would lose its digits.
    let root = ((1.0 - damping_ratio) * (1.0 + damping_ratio)).abs().sqrt();
    if root == 0.0 {
        return (-2f64).exp();
    }
    // arccos ζ and arcosh ζ, from the root for the same reason.
    let angle = if damping_ratio < 1.0 { root.atan2(damping_ratio) } else { root.asinh() };
    (-2.0 * damping_ratio * angle / root).exp()
}

/// The longest stable substep, s, when the smallest grains have as many neighbours as fit.
pub(super) fn critical_time_step_secs(simulation: &Simulation) -> f64 {
    let Simulation { world, physics, parameters, .. } = simulation;
    let springs = SpringDashpot::of(world, physics.axes, parameters.restitution);
    let mut smallest = [f64::INFINITY; 2];
    for &mass in &world.grains.masses {
        smallest[1] = smallest[1].min(mass.max(smallest[0]));
        smallest[0] = smallest[0].min(mass);
    }
    let effective_mass = 1.0 / (1.0 / smallest[0] + 1.0 / smallest[1]);
    let neighbours = NEIGHBOURS[usize::from(physics.axes == 1)];
    springs.critical_time_step_secs(effective_mass, neighbours)
}

/// As many substeps as keep h at the safe fraction of the critical step.
pub(super) fn stable_substeps(simulation: &Simulation) -> u32 {
    let longest_secs = SAFE_FRACTION * critical_time_step_secs(simulation);
    let count = (simulation.parameters.time_step_secs / longest_secs).ceil();
    (count as u32).clamp(1, MAX_SUBSTEPS)
}

/// Takes the substeps of one step and returns their number. Contacts are detected in each; the
/// problem's rows, those of the beginning of the step, get what their pairs transmitted in all.
pub(super) fn advance<M: Model>(
    simulation: &mut Simulation,
    course: &mut Course<M::Kinematics>,
) -> u32 {
    let Simulation { world, physics, parameters, contacts, .. } = &mut *simulation;
    let springs = SpringDashpot::of(world, physics.axes, parameters.restitution);
    let cohesion = if physics.cohesion { parameters.bond } else { 0.0 };
    let elements = Elements {
        springs,
        cohesive_acceleration: cohesion * world.gravity.magnitude(),
        friction: parameters.friction,
        substep_secs: course.substep_secs,
    };
    let mut totals = Totals::new(contacts.contacts());
    contacts.impulses_mut().fill(Impulse::default());
    let mut pushes = Vec::new();
    for substep in 0..course.substeps {
        if substep > 0 {
            // A step too long blows up: that is for the caller to see, not for detection.
            if !simulation.is_finite() {
                break;
            }
            detect::<M>(simulation);
        }
        course.begin(simulation);
        elements.push::<M>(simulation, &course.start, &mut totals, &mut pushes);
        let Simulation { world, contacts, problems, .. } = &mut *simulation;
        let bodies = &M::Kinematics::problem(problems).bodies;
        for (contact, &(mass, impulse)) in contacts.contacts().iter().zip(&pushes) {
            let of = |bodies: &[_]| velocity::<M::Kinematics>(contact, bodies);
            course.works.add(mass, impulse, of(&course.start), of(bodies));
        }
        course.add_gravity_work(bodies, &world.grains.masses);
        course.place::<M>(simulation);
    }
    M::Kinematics::problem(&mut simulation.problems).set_impulses(&totals.impulses);
    course.substeps
}

/// (v_n, v_t) of a contact, m/s.
#[inline(always)]
fn velocity<K: Kinematics>(contact: &Contact, bodies: &[K::Body<f64>]) -> [f64; 2] {
    let (normal, i) = (K::normal(contact.normal.to_array()), &bodies[contact.grain as usize]);
    match bodies.get(contact.other as usize) {
        Some(j) => K::relative_velocity(normal, i, j),
        None => K::velocity(normal, i),
    }
}

/// The law of the contacts.
struct Elements {
    springs: SpringDashpot,
    /// C₀/m_ij = Bond·g, m/s².
    cohesive_acceleration: f64,
    friction: f64,
    substep_secs: f64,
}

impl Elements {
    /// Pushes the bodies by the forces that the present overlaps and the velocities `start` make.
    /// `pushes` gets m_ij and the impulses λ (m/s) of each contact.
    fn push<M: Model>(
        &self,
        simulation: &mut Simulation,
        start: &[<M::Kinematics as Kinematics>::Body<f64>],
        totals: &mut Totals,
        pushes: &mut Vec<(f64, [f64; 2])>,
    ) {
        let h = self.substep_secs;
        let Simulation { world, contacts, problems, walls, .. } = simulation;
        let bodies = &mut M::Kinematics::problem(problems).bodies;
        let masses = &world.grains.masses;
        let (list, impulses, memories) = contacts.parts_mut();
        pushes.clear();
        totals.rewind();
        for ((contact, sum), memory) in list.iter().zip(impulses).zip(memories) {
            let (i, j) = (contact.grain as usize, contact.other as usize);
            let share = masses.get(j).map_or(1.0, |other| other / (masses[i] + other));
            let mass = masses[i] * share;
            let [normal_velocity, tangential_velocity] = velocity::<M::Kinematics>(contact, start);
            let normal_velocity = normal_velocity - walls.speed(world, contact);

            let stiffness = self.springs.stiffness;
            let damping = self.springs.damping(mass);
            let push = (-stiffness * contact.gap - damping * normal_velocity).max(0.0);
            let cohesion = mass * self.cohesive_acceleration;
            memory.normal_force = push - cohesion;
            if M::FRICTION {
                let part = 1.0 / M::Kinematics::TANGENTIAL_COMPLIANCE;
                let bound = if M::COMPRESSIVE_CONE {
                    law::friction_bound::<true, _>(self.friction, push, cohesion)
                } else {
                    law::friction_bound::<false, _>(self.friction, push, 0.0)
                };
                let dashpot = part * damping * tangential_velocity;
                let spring = part * stiffness;
                let stretch = memory.tangential_displacement + h * tangential_velocity;
                let force = law::coulomb(-spring * stretch - dashpot, bound);
                memory.tangential_displacement = -(force + dashpot) / spring;
                memory.tangential_force = force;
            }

            let impulse = Impulse {
                normal: h * memory.normal_force,
                tangential: h * memory.tangential_force,
            };
            sum.normal += impulse.normal;
            sum.tangential += impulse.tangential;
            totals.add(contact, impulse);
            let reduced = [impulse.normal / mass, impulse.tangential / mass];
            pushes.push((mass, reduced));
            let normal = M::Kinematics::normal(contact.normal.to_array());
            if j < bodies.len() {
                let (mut one, mut other) = (bodies[i], bodies[j]);
                M::Kinematics::push_pair(&mut one, &mut other, normal, reduced, share);
                bodies[i] = one;
                bodies[j] = other;
            } else {
                M::Kinematics::push_single(&mut bodies[i], normal, reduced);
            }
        }
    }
}

/// What the contacts of the beginning of a step transmit in its course, N·s.
struct Totals {
    contacts: Vec<Contact>,
    impulses: Vec<Impulse>,
    next: usize,
}

impl Totals {
    fn new(contacts: &[Contact]) -> Self {
        let impulses = vec![Impulse::default(); contacts.len()];
        Self { contacts: contacts.to_vec(), impulses, next: 0 }
    }

    /// Before the contacts of another substep.
    fn rewind(&mut self) {
        self.next = 0;
    }

    /// Adds to the contact of that pair, if it is one of them. Both lists are sorted alike.
    fn add(&mut self, contact: &Contact, impulse: Impulse) {
        let behind = |then: &Contact| then.pair() < contact.pair();
        while self.contacts.get(self.next).is_some_and(behind) {
            self.next += 1;
        }
        if self.contacts.get(self.next).is_some_and(|then| then.pair() == contact.pair()) {
            self.impulses[self.next].normal += impulse.normal;
            self.impulses[self.next].tangential += impulse.tangential;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_damping_ratio_inverts_the_restitution() {
        for restitution in [LEAST_RESTITUTION, 0.1, (-2f64).exp(), 0.2, 0.5, 0.9, 0.999] {
            let found = restitution_of(damping_ratio(restitution));
            assert!((found - restitution).abs() < 1e-12, "{restitution} gave {found}");
        }
        assert_eq!(damping_ratio(1.0), 0.0);
        assert_eq!(damping_ratio(0.0), damping_ratio(LEAST_RESTITUTION));
    }
}
