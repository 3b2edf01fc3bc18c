//! Stepper `tgs-soft`: substeps with soft contacts, each followed by a sweep that removes the velocities of overlap
//! correction, as in game engines (E. Catto, *Soft Constraints*, 2011, and *Solver2D*, 2024).
//!
//! All substeps use the contacts found at the beginning of the step. Only the remedy `speculative` adds pairs that may
//! meet later; without cohesion it also makes contacts nearly rigid. Impulses λ are divided by the effective mass m_ij,
//! and σ = λ_n + Bond·a·h is the normal impulse shifted by the cohesion of a substep of length h (Bond is the Bond
//! number, and a the acceleration in the cohesion force Bond·m_ij·a). Each substep has five parts:
//!
//! 1. Gravity accelerates the grains.
//! 2. The impulses of the previous substep are applied (warm start).
//! 3. One sweep visits all contacts as **soft** contacts, v_n = b − σ c/(1 − c), with the normal velocity v_n, the
//!    speed b at which overlap is pushed out, and the softness c (0 if rigid, near 1 if soft): each is an overdamped
//!    spring that acts on the gap.
//! 4. The grains move for the time h, and each gap changes by h v_n.
//! 5. One sweep visits all contacts as **rigid** contacts, v_n = 0. It removes the speed with which overlaps were
//!    pushed out, so that pushing out changes only positions and adds no energy.
//!
//! At the end of the step, contacts that pushed get the separation speed of restitution. As in the contact problem of
//! the step, contacts do not bounce if they met at less than `restitution_threshold` times g·Δt (gravity g, time step
//! Δt), or if they were opening.
//!
//! **Cohesion** is the bound λ_n ≥ −Bond·a·h of a contact whose gap is below the scene's `gap_tolerance` (0 by default)
//! when the substep begins. So it is a force that depends on neither Δt nor h. For other contacts the bound is 0, and
//! the contact only prevents the gap from closing by more than its size.

use crate::contact::{ContactLaw, law};
use crate::number::Parts;
use crate::sim::pull::acceleration_of_springs;
use crate::sim::settings::Settings;
use crate::sim::state::State;
use crate::sim::steppers::substeps::{self, Substepping, Touching, add_work, set_drive_speeds};
use crate::sim::stepping::{Stage, StepResult};
use crate::solver::{DrivenRow, DrivenWall, Model, Row, StepProblem};
use crate::world::World;

pub(super) fn advance<M: Model>(stage: &mut Stage<'_, M>, settings: &Settings) -> StepResult {
    let substepping = &mut Substepping::begin_step(stage, settings);
    let substeps = substepping.count;
    let substep_secs = substepping.substep_secs;
    let (world, law) = (&stage.state.world, stage.problem.law);
    let softness = Softness::new(world, law, substep_secs, settings);
    let gap_tolerance = stage.state.candidates.gap_tolerance();
    let warm_secs = if settings.solver.warm_start { substep_secs } else { 0.0 };
    let mut contacts = substeps::touching(stage, warm_secs);
    let capture_speed = stage.problem.law.capture_speed() / f64::from(substeps);
    stage.in_pieces(substeps, settings, StepResult::nothing_yet(), |stage, _, _| {
        substepping.begin(stage);
        let walls = &mut begin_walls(stage, &mut contacts, substep_secs);
        update(stage.problem, walls, &mut contacts, |_, contact, _| {
            let cohesive = contact.gap < gap_tolerance;
            contact.capture_speed = if cohesive { capture_speed } else { 0.0 };
            softness.warm_start::<M>(contact)
        });
        update(stage.problem, walls, &mut contacts, |_, contact, velocity| {
            softness.solve::<M, true>(contact, velocity)
        });
        take_walls(stage, &mut contacts, walls);
        substepping.place(stage);
        let problem = &mut *stage.problem;
        substeps::follow_gaps(problem, &mut contacts, substep_secs);
        update(problem, walls, &mut contacts, |_, contact, velocity| {
            softness.solve::<M, false>(contact, velocity)
        });
        substepping.add_gravity_work(&problem.bodies.now, &stage.state.world.grains.masses);
        substepping.works.drive_work += take_walls(stage, &mut contacts, walls);
        substeps::end_substep(stage.problem, &mut contacts, substepping);
        // The contacts used the final speed of walls in the substep for the work. Correct it to the mean speed.
        for (row, contact) in stage.problem.rows.fixed.iter().zip(&contacts) {
            if let Some(DrivenRow { by, .. }) = contact.driven {
                let (wall, along) = (&walls[by.wall as usize], by.part_along(contact.impulse));
                let surplus = -0.5 * row.effective_mass * along * (wall.now - wall.before);
                substepping.works.measures.wall_work += surplus;
            }
        }
        // The user's spring reads the velocity of the grain from the world.
        substepping.store(stage);
    });
    substeps::remember(stage, &contacts, substep_secs);
    let walls = &mut begin_walls(stage, &mut contacts, 0.0);
    restitute(stage.problem, walls, &mut contacts, &mut substepping.works);
    take_walls(stage, &mut contacts, walls);
    substeps::hand_over(stage.problem, &contacts);
    substepping.store(stage);
    stage.problem.store_impulses(&mut stage.state.contacts);
    set_drive_speeds(stage);
    substepping.end_step_of(stage, &contacts, 2 * substeps + 1)
}

/// Gives contacts that closed before the step and pushed in it the separation speed of restitution, by an additional
/// impulse at the end of the step.
fn restitute<M: Model>(
    problem: &mut StepProblem<M>,
    walls: &mut [DrivenWall],
    contacts: &mut [Touching],
    works: &mut StepResult,
) {
    update(problem, walls, contacts, |row, contact, [normal_velocity, _]| {
        if contact.rebound >= 0.0 || contact.total[0] <= 0.0 {
            return [0.0; 2];
        }
        let parting = contact.wall_speed - contact.rebound;
        let missing = (parting - normal_velocity).positive_part() / contact.answers[0];
        let (push, before, after) = ([missing, 0.0], normal_velocity, normal_velocity + missing);
        contact.total[0] += missing;
        let (velocities, wall) = ([[before, 0.0], [after, 0.0]], contact.wall_velocity());
        add_work::<M>(works, row.effective_mass, row.normal, push, velocities, wall);
        // The wall yielded, which reduces its mean speed and so its work.
        let given_way = (contact.answers[0] - 1.0) * missing;
        works.measures.wall_work += -0.5 * row.effective_mass * missing * given_way;
        push
    });
}

/// Calls the closure `change` for every contact with the contact's relative velocities (normal and tangential, m/s).
/// The closure returns impulses divided by the effective mass (m/s), which are then applied to the two bodies.
#[inline(always)]
fn update<M: Model>(
    problem: &mut StepProblem<M>,
    walls: &mut [DrivenWall],
    contacts: &mut [Touching],
    mut change: impl FnMut(&Row<M>, &mut Touching, [f64; 2]) -> [f64; 2],
) {
    let (bodies, rows) = (&mut problem.bodies.now, &problem.rows);
    let (of_fixed, of_pairs) = contacts.split_at_mut(rows.fixed.len());
    for (row, contact) in rows.fixed.iter().zip(of_fixed) {
        let i = &mut bodies[row.i as usize];
        contact.see(walls);
        let impulse = change(row, contact, M::velocity(row.normal, i));
        M::push_single(i, row.normal, impulse);
        contact.push_back(walls, row.effective_mass, impulse);
    }
    for (row, contact) in rows.pairs.iter().zip(of_pairs) {
        let (mut i, mut j) = (bodies[row.i as usize], bodies[row.j as usize]);
        let impulse = change(row, contact, M::relative_velocity(row.normal, &i, &j));
        M::push_pair(&mut i, &mut j, row.normal, impulse, row.share);
        bodies[row.i as usize] = i;
        bodies[row.j as usize] = j;
    }
}

/// Frequency of the contact springs, in units of √(g/d) with gravity g and the mean diameter d: 30 Hz for discs of 1 m,
/// as in game engines. A higher frequency makes overlaps smaller. [`FREQUENCY_PER_SUBSTEP`] limits it.
const FREQUENCY: f64 = 10.0;
/// Largest product of the frequency ω/2π of the contact springs and the length h of a substep (part of a step). With a
/// larger value contacts are nearly rigid, and one sweep no longer transmits forces through a pile.
const FREQUENCY_PER_SUBSTEP: f64 = 0.25;
/// The same product with the remedy `speculative` and without cohesion. With a smaller value, overlaps are larger.
/// Without the remedy grains that meet would be thrown apart; with cohesion, bonds that turn would break sooner.
const RIGID: f64 = 1.0;
/// Damping ratio ζ of the contact springs, dimensionless; 1 is critical damping. With a smaller value overlap is
/// removed too fast, and piles jitter.
const DAMPING_RATIO: f64 = 10.0;
/// Largest speed with which an overlap is pushed out, in units of √(g·d) with gravity g and the mean diameter d. With a
/// larger value, grains with a deep overlap are thrown apart; with a smaller value, deep overlaps persist.
const PUSH_OUT_SPEED: f64 = 1.0;

/// Constants of soft contacts that are the same for all contacts of a step.
///
/// **Softness.** At the gap s (m), which changes at the normal velocity v (m/s), the spring's force is −k s − γ v
/// (stiffness k, N/m; damping γ, N·s/m). For the effective mass m_ij it has the angular frequency ω, with ω² = k/m_ij,
/// and the damping ratio ζ = γ/(2 m_ij ω). The force is evaluated at the end of a substep of length h, with the gap s +
/// h v and the normal velocity v reached there. Then its impulse divided by m_ij is σ = −h(ω²(s + h v) + 2ζω v). With a
/// = 2ζ + hω this is σ = −hωa (v + s ω/a). A Gauss–Seidel update changes σ by Δσ, and so v by Δσ, such that this
/// equation is satisfied afterwards:
///
/// > Δσ = −(1 − c)(v + s ω/a) − c σ,  c = 1/(1 + hωa).
///
/// The contact's normal impulse λ_n (also divided by m_ij) is σ minus the impulse of the cohesion force C₀. So the
/// spring's force is N + C₀, with the normal force N: at rest N + C₀ = −k s, as for smooth discrete elements (`dem`).
/// If the spring's force were N, a pulling contact would rest at a positive gap, at which it has no cohesion, and would
/// break.
struct Softness {
    substep_secs: f64,
    /// Rate at which a contact spring removes an overlap, 1/s: the speed with which the overlap decreases, divided by
    /// the overlap. It is ω/(2ζ + hω), with the spring's angular frequency ω, its damping ratio ζ and the length h of a
    /// substep (part of a step).
    rate: f64,
    /// Softness c of a contact, dimensionless: 0 for a rigid contact, near 1 for a soft contact ([`Softness`]).
    compliance: f64,
    /// Largest speed with which an overlap is pushed out, m/s.
    push_out_speed: f64,
    law: ContactLaw,
}

impl Softness {
    fn new(world: &World, law: ContactLaw, substep_secs: f64, settings: &Settings) -> Self {
        let diameter = world.mean_diameter;
        let g = acceleration_of_springs(world, &settings.parameters);
        let highest = FREQUENCY_PER_SUBSTEP / substep_secs;
        let usual = highest.min(FREQUENCY * (g / diameter).sqrt());
        let is_rigid = settings.remedies.speculative && law.capture_speed() == 0.0;
        let frequency = if is_rigid { RIGID / substep_secs } else { usual } * std::f64::consts::TAU;
        let damping = 2.0 * DAMPING_RATIO + substep_secs * frequency;
        Self {
            substep_secs,
            rate: frequency / damping,
            compliance: 1.0 / (1.0 + substep_secs * frequency * damping),
            push_out_speed: PUSH_OUT_SPEED * (g * diameter).sqrt(),
            law,
        }
    }

    /// Limits the impulses of the previous substep to the range that the contact law allows now, and returns them.
    #[inline(always)]
    fn warm_start<M: Model>(&self, contact: &mut Touching) -> [f64; 2] {
        let shifted = law::signorini(contact.impulse[0] + contact.capture_speed);
        let bound = self.bound::<M>(shifted, contact.capture_speed);
        contact.impulse =
            [shifted - contact.capture_speed, law::coulomb(contact.impulse[1], bound)];
        contact.impulse
    }

    /// Updates the impulses of one contact in a sweep, as a soft contact (a spring) or as a rigid contact. The
    /// arguments are the contact and its relative normal and tangential velocities, m/s. Returns the changes of the
    /// impulses divided by the effective mass, m/s.
    #[inline(always)]
    fn solve<M: Model, const SOFT: bool>(
        &self,
        contact: &mut Touching,
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
        let [answer, tangential_answer] = contact.answers;
        let change = (1.0 - compliance) * closing / answer + compliance * shifted;
        let shifted = law::signorini(shifted - change);
        contact.impulse[0] = shifted - contact.capture_speed;
        if M::FRICTION {
            let bound = self.bound::<M>(shifted, contact.capture_speed);
            let part = 1.0 / M::TANGENTIAL_COMPLIANCE;
            let slip = tangential_velocity - contact.surface_speed;
            contact.impulse[1] = law::coulomb(before[1] - part * slip / tangential_answer, bound);
        }
        [contact.impulse[0] - before[0], contact.impulse[1] - before[1]]
    }

    #[inline(always)]
    fn bound<M: Model>(&self, shifted: f64, capture_speed: f64) -> f64 {
        if !M::FRICTION {
            return 0.0;
        }
        self.law.with_capture_speed(capture_speed).friction_bound(shifted)
    }
}

/// Soft contacts with walls driven by a force. Such a wall is a body with a single speed V, along its direction of
/// motion (`solver::problem::walls`).
///
/// In a substep of length h a wall with the mass M, the driving force F and the damping c moves with the speed V_free =
/// r (M V⁻ + hF), r = 1/(M + ch), as long as no contact pushes it; V⁻ is its speed before the substep. Let λ_n and λ_t
/// (m/s) be the normal and tangential impulses of a contact with a grain of mass m_i, divided by m_i. They change V at
/// once by −κ (b_n λ_n + b_t λ_t), with κ = r m_i and the components b_n and b_t of the wall's direction of motion (a
/// unit vector) along normal and tangent. So the next contact of the sweep uses the new speed.
///
/// The relative velocity of grain and wall thus changes by more than at a wall of prescribed speed. Along the normal it
/// changes by d_n λ_n with d_n = 1 + κb_n²: 1 from the grain, and the rest from the wall. Along the tangent it changes
/// by (q + κb_t²) λ_t = q d_t λ_t, with d_t = 1 + κb_t²/q. Here q λ_t is the change of the grain's surface velocity: q
/// is 1 if grains do not rotate, and 3 for a solid disc that rotates, because λ_t then adds λ_t to the velocity of its
/// centre and 2 λ_t by rotation. So an update that is computed for a wall of prescribed speed is divided by d_n or d_t.
/// Along the normal, grain and wall together respond like a grain of mass m_i/d_n, the effective mass of the contact.
/// The contact spring has the same frequency and damping ratio as all contact springs, so its stiffness and damping are
/// those for the mass m_i/d_n.
impl Touching {
    /// Copies the present velocity of the contact's wall into the contact, if a force drives the wall.
    #[inline(always)]
    fn see(&mut self, walls: &[DrivenWall]) {
        if let Some(DrivenRow { by, still, speed, .. }) = self.driven {
            let now = walls[by.wall as usize].now;
            self.wall_speed = speed + by.along[0] * now;
            self.surface_speed = still[1] + by.along[1] * now;
        }
    }

    /// Applies the reaction to an impulse on the grain to the contact's wall, if a force drives the wall. `impulse` is
    /// divided by `mass`, the mass of the grain (kg), and has the unit m/s.
    #[inline(always)]
    fn push_back(&self, walls: &mut [DrivenWall], mass: f64, impulse: [f64; 2]) {
        if let Some(DrivenRow { by, .. }) = self.driven {
            let wall = &mut walls[by.wall as usize];
            wall.now -= wall.response * mass * by.part_along(impulse);
        }
    }
}

/// Returns the walls driven by a force, with their speeds at the beginning of a substep (part of a step). Sets
/// `answers` (the changes of relative velocity by unit impulses) of the contacts with these walls. With `substep_secs`
/// = 0 the walls are prepared for impulses that act in zero time.
fn begin_walls<M: Model>(
    stage: &Stage<'_, M>,
    contacts: &mut [Touching],
    substep_secs: f64,
) -> Vec<DrivenWall> {
    let State { world, walls, .. } = &*stage.state;
    let mut driven: Vec<DrivenWall> = walls.driven(world, substep_secs).collect();
    driven.iter_mut().for_each(|wall| wall.now = wall.free);
    for (row, contact) in stage.problem.rows.fixed.iter().zip(contacts) {
        if let Some(DrivenRow { by, .. }) = contact.driven {
            let share = driven[by.wall as usize].response * row.effective_mass;
            let [normal, tangential] = by.along.map(|along| share * along * along);
            contact.answers = [1.0 + normal, 1.0 + tangential / M::TANGENTIAL_COMPLIANCE];
        }
    }
    driven
}

/// Stores the speeds of the walls driven by a force after a sweep. Returns the work of the driving forces since the
/// substep (part of a step) began, minus the loss in the walls' damping, J.
fn take_walls<M: Model>(
    stage: &mut Stage<'_, M>,
    contacts: &mut [Touching],
    driven: &[DrivenWall],
) -> f64 {
    contacts.iter_mut().for_each(|contact| contact.see(driven));
    let State { world, walls, .. } = &mut *stage.state;
    walls.take_driven(world, driven)
}
