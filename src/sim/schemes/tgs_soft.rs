//! Substeps with soft contacts and a relaxing sweep, as game engines step (E. Catto, *Soft
//! Constraints*, 2011, and *Solver2D*, 2024).
//!
//! Contacts are those of the beginning of the step; there are no speculative ones. In each substep
//! h, with σ = λ_n + Bond·g·h the shifted reduced impulse of the contact laws:
//!
//! 1. gravity accelerates the bodies;
//! 2. the impulses of the substep before are applied (warm start);
//! 3. one sweep over **soft** contacts: v_n + b = −c σ, each an overdamped spring at the gap;
//! 4. the grains move for h, and each gap changes by h v_n;
//! 5. one sweep over **rigid** contacts, v_n = 0: it takes the push-out speed out again, so that
//!    only positions keep it, and no energy comes of it.
//!
//! At the end of the step, contacts that pushed get the speed that restitution asks of them. Its
//! threshold is that of the step's problem: contacts that met at less than `restitution_threshold`
//! g·Δt do not bounce, nor do those that were opening.
//!
//! **Softness.** The spring's force is −k s − γ ṡ at gap s, with ω² = k/m_ij and ζ = γ/(2 m_ij ω). Taken
//! at the end of the substep, s + h v and v, its impulse is σ = −h(ω²(s + h v) + 2ζω v), which with
//! a = 2ζ + hω is σ = −hωa (v + s ω/a). A Gauss–Seidel update asks that of the velocity v + Δσ it makes:
//!
//! > Δσ = −(1 − c)(v + s ω/a) − c σ,  c = 1/(1 + hωa).
//!
//! The spring carries σ, not λ_n: N + C₀ = −k s at rest, as for the smooth discrete elements. Sprung at
//! λ_n, a contact that pulls would rest at a positive gap, where it has no cohesion, and let go.
//!
//! **Cohesion** is the bound λ_n ≥ −Bond·g·h of a contact whose gap is negative when the substep
//! begins, and so a force that depends on neither Δt nor h; with a gap the bound is 0, and the
//! contact only keeps the grains from closing the gap by more than it is.

use super::{Course, Works};
use crate::contact::{ContactMemory, law};
use crate::sim::Simulation;
use crate::sim::pull::GRAVITY_IF_NONE;
use crate::solver::{Kinematics, Model, Row, StepProblem};

/// Substeps where their number is left to the scheme. More: stiffer contacts, better solved.
pub(super) const DEFAULT_SUBSTEPS: u32 = 4;
/// ω/2π of the springs, in units of √(g/d): 30 Hz for discs of 1 m, as engines have it. Higher: less
/// overlap, but beyond [`FREQUENCY_PER_SUBSTEP`] of the substeps' rate it does not go.
const FREQUENCY: f64 = 10.0;
/// Largest h ω/2π. Higher: the contact is all but rigid, and one sweep no longer gets through a pile.
const FREQUENCY_PER_SUBSTEP: f64 = 0.25;
/// ζ of the springs. Lower: overlap leaves in a hurry, and piles jitter.
const DAMPING_RATIO: f64 = 10.0;
/// Fastest push out of an overlap, in units of √(g·d). Higher: deep overlaps explode; lower: they stay.
const PUSH_OUT_SPEED: f64 = 1.0;

/// A contact in the course of a step.
struct SoftContact {
    /// Gap, m.
    gap: f64,
    /// How fast its wall comes, m/s.
    wall_speed: f64,
    /// Bond·g·h where it is cohesive in this substep, else 0, m/s.
    capture_speed: f64,
    /// (λ_n, λ_t) of this substep, m/s.
    impulse: [f64; 2],
    /// (λ_n, λ_t) of the step so far, m/s.
    total: [f64; 2],
}

/// What all contacts of a step share.
struct Softness {
    substep_secs: f64,
    /// ω/a, 1/s.
    rate: f64,
    /// c.
    compliance: f64,
    /// m/s.
    push_out_speed: f64,
    friction: f64,
}

/// Takes the substeps of one step and returns the sweeps.
pub(super) fn advance<M: Model>(
    simulation: &mut Simulation,
    course: &mut Course<M::Kinematics>,
) -> u32 {
    let softness = Softness::new(simulation, course.substep_secs);
    let gap_tolerance = simulation.candidates.gap_tolerance();
    let mut contacts = soft_contacts::<M>(simulation, course.substep_secs);
    let capture_speed = M::Kinematics::problem(&mut simulation.problems).capture_speed;
    let capture_speed = capture_speed / f64::from(course.substeps);
    for _ in 0..course.substeps {
        course.begin(simulation);
        let problem = M::Kinematics::problem(&mut simulation.problems);
        update(problem, &mut contacts, |_, contact, _| {
            let cohesive = contact.gap < gap_tolerance;
            contact.capture_speed = if cohesive { capture_speed } else { 0.0 };
            softness.warm_start::<M>(contact)
        });
        update(problem, &mut contacts, |_, contact, velocity| {
            softness.solve::<M, true>(contact, velocity)
        });
        course.place::<M>(simulation);
        let problem = M::Kinematics::problem(&mut simulation.problems);
        let velocities = velocities(problem, &problem.bodies);
        for (contact, [normal_velocity, _]) in contacts.iter_mut().zip(velocities) {
            contact.gap += course.substep_secs * (normal_velocity - contact.wall_speed);
        }
        update(problem, &mut contacts, |_, contact, velocity| {
            softness.solve::<M, false>(contact, velocity)
        });
        course.add_gravity_work(&problem.bodies, &simulation.world.grains.masses);
        end_substep(problem, &mut contacts, course);
        // The spring that pulls a grain looks at its velocity.
        course.store(simulation);
    }
    remember::<M>(simulation, &contacts, course.substep_secs);
    let problem = M::Kinematics::problem(&mut simulation.problems);
    restitute(problem, &mut contacts, &mut course.works);
    let capture_speed = problem.capture_speed;
    for (row, contact) in problem.fixed_rows.iter_mut().chain(&mut problem.pair_rows).zip(&contacts)
    {
        row.shifted_impulse = contact.total[0] + capture_speed;
        row.tangential_impulse = contact.total[1];
    }
    course.store(simulation);
    let Simulation { problems, contacts, .. } = simulation;
    M::Kinematics::problem(problems).store_impulses(contacts);
    2 * course.substeps + 1
}

/// The contacts in the order of the rows, with what is remembered of the step before.
fn soft_contacts<M: Model>(simulation: &mut Simulation, substep_secs: f64) -> Vec<SoftContact> {
    let Simulation { contacts, problems, solver, .. } = simulation;
    let problem = M::Kinematics::problem(problems);
    let rows = problem.rows();
    let soft = |((number, row), &index): ((usize, &Row<M::Kinematics>), &u32)| {
        let memory = contacts.memories()[index as usize];
        let per_mass = if solver.warm_start { substep_secs / row.effective_mass } else { 0.0 };
        SoftContact {
            gap: contacts.contacts()[index as usize].gap,
            wall_speed: problem.wall_speed(number),
            capture_speed: 0.0,
            impulse: [per_mass * memory.normal_force, per_mass * memory.tangential_force],
            total: [0.0; 2],
        }
    };
    rows.zip(&problem.contact_of_row).map(soft).collect()
}

/// Hands the forces of the last substep to the contacts' memories.
fn remember<M: Model>(simulation: &mut Simulation, contacts: &[SoftContact], substep_secs: f64) {
    let Simulation { contacts: list, problems, .. } = simulation;
    let problem = M::Kinematics::problem(problems);
    let (_, _, memories) = list.parts_mut();
    let rows = problem.fixed_rows.iter().chain(&problem.pair_rows);
    for ((row, contact), &index) in rows.zip(contacts).zip(&problem.contact_of_row) {
        let per_secs = row.effective_mass / substep_secs;
        memories[index as usize] = ContactMemory {
            normal_force: per_secs * contact.impulse[0],
            tangential_force: per_secs * contact.impulse[1],
            ..ContactMemory::default()
        };
    }
}

/// Sums up impulses and works of a substep.
fn end_substep<K: Kinematics>(
    problem: &StepProblem<K>,
    contacts: &mut [SoftContact],
    course: &mut Course<K>,
) {
    let Course { works, start, .. } = course;
    let start = velocities(problem, start);
    let end = velocities(problem, &problem.bodies);
    let rows = problem.fixed_rows.iter().chain(&problem.pair_rows);
    for (((row, contact), start), end) in rows.zip(contacts).zip(start).zip(end) {
        contact.total[0] += contact.impulse[0];
        contact.total[1] += contact.impulse[1];
        works.add(row.effective_mass, contact.impulse, start, end);
    }
}

/// Gives contacts that met, and pushed, the speed they part with.
fn restitute<K: Kinematics>(
    problem: &mut StepProblem<K>,
    contacts: &mut [SoftContact],
    works: &mut Works,
) {
    update(problem, contacts, |row, contact, [normal_velocity, _]| {
        if row.restitution_velocity >= 0.0 || contact.total[0] <= 0.0 {
            return [0.0; 2];
        }
        let missing = (-row.restitution_velocity - normal_velocity).max(0.0);
        let (push, before, after) = ([missing, 0.0], normal_velocity, normal_velocity + missing);
        contact.total[0] += missing;
        works.add(row.effective_mass, push, [before, 0.0], [after, 0.0]);
        push
    });
}

impl Softness {
    fn new(simulation: &Simulation, substep_secs: f64) -> Self {
        let diameter = simulation.world.mean_diameter;
        let g = match simulation.world.gravity.magnitude() {
            0.0 => GRAVITY_IF_NONE,
            magnitude => magnitude,
        };
        let highest = FREQUENCY_PER_SUBSTEP / substep_secs;
        let frequency = std::f64::consts::TAU * highest.min(FREQUENCY * (g / diameter).sqrt());
        let damping = 2.0 * DAMPING_RATIO + substep_secs * frequency;
        Self {
            substep_secs,
            rate: frequency / damping,
            compliance: 1.0 / (1.0 + substep_secs * frequency * damping),
            push_out_speed: PUSH_OUT_SPEED * (g * diameter).sqrt(),
            friction: simulation.parameters.friction,
        }
    }

    /// Projects the impulses of the substep before on what the contact allows now.
    #[inline(always)]
    fn warm_start<M: Model>(&self, contact: &mut SoftContact) -> [f64; 2] {
        let shifted = law::signorini(contact.impulse[0] + contact.capture_speed);
        let bound = self.bound::<M>(shifted, contact.capture_speed);
        contact.impulse =
            [shifted - contact.capture_speed, law::coulomb(contact.impulse[1], bound)];
        contact.impulse
    }

    /// One contact of a sweep, with its relative velocities: the change of its impulses.
    #[inline(always)]
    fn solve<M: Model, const SOFT: bool>(
        &self,
        contact: &mut SoftContact,
        [normal_velocity, tangential_velocity]: [f64; 2],
    ) -> [f64; 2] {
        let (bias, compliance) = if contact.gap > 0.0 {
            (contact.gap / self.substep_secs, 0.0)
        } else if SOFT {
            ((self.rate * contact.gap).max(-self.push_out_speed), self.compliance)
        } else {
            (0.0, 0.0)
        };
        let before = contact.impulse;
        let shifted = before[0] + contact.capture_speed;
        let closing = normal_velocity - contact.wall_speed + bias;
        let change = (1.0 - compliance) * closing + compliance * shifted;
        let shifted = law::signorini(shifted - change);
        contact.impulse[0] = shifted - contact.capture_speed;
        if M::FRICTION {
            let bound = self.bound::<M>(shifted, contact.capture_speed);
            let part = 1.0 / M::Kinematics::TANGENTIAL_COMPLIANCE;
            contact.impulse[1] = law::coulomb(before[1] - part * tangential_velocity, bound);
        }
        [contact.impulse[0] - before[0], contact.impulse[1] - before[1]]
    }

    #[inline(always)]
    fn bound<M: Model>(&self, shifted: f64, capture_speed: f64) -> f64 {
        if !M::FRICTION {
            0.0
        } else if M::COMPRESSIVE_CONE {
            law::friction_bound::<true, _>(self.friction, shifted, capture_speed)
        } else {
            law::friction_bound::<false, _>(self.friction, shifted, 0.0)
        }
    }
}

/// Calls `change` with every row, its contact and its relative velocities, and pushes the bodies by
/// the impulses λ that it returns.
#[inline(always)]
fn update<K: Kinematics>(
    problem: &mut StepProblem<K>,
    contacts: &mut [SoftContact],
    mut change: impl FnMut(&Row<K>, &mut SoftContact, [f64; 2]) -> [f64; 2],
) {
    let StepProblem { bodies, fixed_rows, pair_rows, .. } = problem;
    let (of_fixed, of_pairs) = contacts.split_at_mut(fixed_rows.len());
    for (row, contact) in fixed_rows.iter().zip(of_fixed) {
        let i = &mut bodies[row.i as usize];
        let impulse = change(row, contact, K::velocity(row.normal, i));
        K::push_single(i, row.normal, impulse);
    }
    for (row, contact) in pair_rows.iter().zip(of_pairs) {
        let (mut i, mut j) = (bodies[row.i as usize], bodies[row.j as usize]);
        let impulse = change(row, contact, K::relative_velocity(row.normal, &i, &j));
        K::push_pair(&mut i, &mut j, row.normal, impulse, row.share);
        bodies[row.i as usize] = i;
        bodies[row.j as usize] = j;
    }
}

/// The relative velocities of all rows with the given bodies, m/s.
fn velocities<'a, K: Kinematics>(
    problem: &'a StepProblem<K>,
    bodies: &'a [K::Body<f64>],
) -> impl Iterator<Item = [f64; 2]> + 'a {
    let of_fixed = |row: &Row<K>| K::velocity(row.normal, &bodies[row.i as usize]);
    let of_pair = |row: &Row<K>| {
        K::relative_velocity(row.normal, &bodies[row.i as usize], &bodies[row.j as usize])
    };
    problem.fixed_rows.iter().map(of_fixed).chain(problem.pair_rows.iter().map(of_pair))
}
