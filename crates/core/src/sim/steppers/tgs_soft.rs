//! Substeps with soft contacts and a relaxing sweep, as game engines step (E. Catto, *Soft
//! Constraints*, 2011, and *Solver2D*, 2024).
//!
//! Contacts are those of the beginning of the step; there are no speculative ones. In each substep
//! h, with σ = λ_n + Bond·a·h the shifted reduced impulse of the contact laws:
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
//! **Cohesion** is the bound λ_n ≥ −Bond·a·h of a contact whose gap is negative when the substep
//! begins, and so a force that depends on neither Δt nor h; with a gap the bound is 0, and the
//! contact only keeps the grains from closing the gap by more than it is.

use crate::contact::{ContactLaw, law};
use crate::number::Parts;
use crate::sim::pull::acceleration_of_springs;
use crate::sim::settings::Settings;
use crate::sim::state::State;
use crate::sim::steppers::substeps::{self, Substepping, Touching, add_work, set_drive_speeds};
use crate::sim::stepping::{Stage, StepResult};
use crate::solver::{DrivenRow, DrivenWall, Model, Row, StepProblem};
use crate::world::{Parameters, World};

pub(super) fn advance<M: Model>(stage: &mut Stage<'_, M>, settings: &Settings) -> StepResult {
    let substepping = &mut Substepping::begin_step(stage, settings);
    let substeps = substepping.count;
    let substep_secs = substepping.substep_secs;
    let (world, law) = (&stage.state.world, stage.problem.law);
    let softness = Softness::new(world, law, substep_secs, &settings.parameters);
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
        // Contacts told of the work of walls with their last speed in the substep; they had the mean one.
        for (row, contact) in stage.problem.rows.fixed.iter().zip(&contacts) {
            if let Some(DrivenRow { by, .. }) = contact.driven {
                let (wall, along) = (&walls[by.wall as usize], by.part_along(contact.impulse));
                let surplus = -0.5 * row.effective_mass * along * (wall.now - wall.before);
                substepping.works.measures.wall_work += surplus;
            }
        }
        // The spring that pulls a grain looks at its velocity.
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

/// Gives contacts that met, and pushed, the speed they part with.
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
        // The wall gave way, which takes so much off its mean speed.
        let given_way = (contact.answers[0] - 1.0) * missing;
        works.measures.wall_work += -0.5 * row.effective_mass * missing * given_way;
        push
    });
}

/// Calls `change` with every row, its contact and its relative velocities, and pushes the bodies by
/// the impulses λ that it returns.
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

/// ω/2π of the springs, in units of √(g/d): 30 Hz for discs of 1 m, as engines have it. Higher: less
/// overlap, but beyond [`FREQUENCY_PER_SUBSTEP`] of the substeps' rate it does not go.
const FREQUENCY: f64 = 10.0;
/// Largest h ω/2π. Higher: the contact is all but rigid, and one sweep no longer gets through a pile.
const FREQUENCY_PER_SUBSTEP: f64 = 0.25;
/// ζ of the springs. Lower: overlap leaves in a hurry, and piles jitter.
const DAMPING_RATIO: f64 = 10.0;
/// Fastest push out of an overlap, in units of √(g·d). Higher: deep overlaps explode; lower: they stay.
const PUSH_OUT_SPEED: f64 = 1.0;

/// What all contacts of a step share.
///
/// **Softness.** The spring's force is −k s − γ ṡ at gap s, with ω² = k/m_ij and ζ = γ/(2 m_ij ω). Taken
/// at the end of the substep, s + h v and v, its impulse is σ = −h(ω²(s + h v) + 2ζω v), which with
/// a = 2ζ + hω is σ = −hωa (v + s ω/a). A Gauss–Seidel update asks that of the velocity v + Δσ it makes:
///
/// > Δσ = −(1 − c)(v + s ω/a) − c σ,  c = 1/(1 + hωa).
///
/// The spring carries σ, not λ_n: N + C₀ = −k s at rest, as for the smooth discrete elements. Sprung at
/// λ_n, a contact that pulls would rest at a positive gap, where it has no cohesion, and let go.
struct Softness {
    substep_secs: f64,
    /// ω/a, 1/s.
    rate: f64,
    /// c.
    compliance: f64,
    /// m/s.
    push_out_speed: f64,
    law: ContactLaw,
}

impl Softness {
    fn new(world: &World, law: ContactLaw, substep_secs: f64, parameters: &Parameters) -> Self {
        let diameter = world.mean_diameter;
        let g = acceleration_of_springs(world, parameters);
        let highest = FREQUENCY_PER_SUBSTEP / substep_secs;
        let frequency = std::f64::consts::TAU * highest.min(FREQUENCY * (g / diameter).sqrt());
        let damping = 2.0 * DAMPING_RATIO + substep_secs * frequency;
        Self {
            substep_secs,
            rate: frequency / damping,
            compliance: 1.0 / (1.0 + substep_secs * frequency * damping),
            push_out_speed: PUSH_OUT_SPEED * (g * diameter).sqrt(),
            law,
        }
    }

    /// Projects the impulses of the substep before on what the contact allows now.
    #[inline(always)]
    fn warm_start<M: Model>(&self, contact: &mut Touching) -> [f64; 2] {
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

/// Walls that a force drives, among soft contacts: bodies of one speed V each (`solver::problem::walls`).
///
/// In a substep such a wall goes with V_free = r (M V⁻ + hF), r = 1/(M + ch), and an impulse λ of one of its contacts
/// changes it by −r m_i (b_n λ_n + b_t λ_t) at once: the next contact of the sweep finds it as it goes then. With
/// κ = r m_i an impulse changes v_n by d_n λ_n, d_n = 1 + κb_n², and v_t by 3 d_t λ_t, d_t = 1 + κb_t²/3, so that a
/// contact's update is divided by them; its spring is that of its own mass, m_i/d_n.
impl Touching {
    /// Sees how its wall goes now, if that is driven.
    #[inline(always)]
    fn see(&mut self, walls: &[DrivenWall]) {
        if let Some(DrivenRow { by, still, speed, .. }) = self.driven {
            let now = walls[by.wall as usize].now;
            self.wall_speed = speed + by.along[0] * now;
            self.surface_speed = still[1] + by.along[1] * now;
        }
    }

    /// Pushes its wall back by the impulses λ (m/s) on a grain of that mass, if that is driven.
    #[inline(always)]
    fn push_back(&self, walls: &mut [DrivenWall], mass: f64, impulse: [f64; 2]) {
        if let Some(DrivenRow { by, .. }) = self.driven {
            let wall = &mut walls[by.wall as usize];
            wall.now -= wall.response * mass * by.part_along(impulse);
        }
    }
}

/// Begins a substep of such walls, of which contacts know from then on what they answer with. One that takes no time is
/// a blow.
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

/// Has the walls go on as a sweep has left them, and gives the work of what drives them since the substep began, J.
fn take_walls<M: Model>(
    stage: &mut Stage<'_, M>,
    contacts: &mut [Touching],
    driven: &[DrivenWall],
) -> f64 {
    contacts.iter_mut().for_each(|contact| contact.see(driven));
    let State { world, walls, .. } = &mut *stage.state;
    walls.take_driven(world, driven)
}
