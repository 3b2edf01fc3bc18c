//! Shocks (instantaneous collisions) of a step under the law `range`.
//!
//! Collisions are instantaneous, so gravity and bonds have no effect on them, because their forces are finite. So each
//! step begins with its shocks: without gravity and cohesion, colliding grains get the velocities that they have after
//! their collisions. A contact that closes with the normal velocity u⁻ (below 0) bounces with the coefficient of
//! restitution ρ and ends with u⁺, by the normal impulse P_n,
//!
//! > 0 ≤ P_n ⟂ u⁺ + ρ u⁻ ≥ 0.
//!
//! The step then continues from the bodies' velocities v⁺ after the shocks, without bounces.
//!
//! **A pair that meets within the step** bounces within this step, with its full speed u at the meeting (the time when
//! its gap closes), along its normal at the meeting (`contact::approach`). The alternative would be to slow the pair
//! down so that it closes its gap in this step and bounces in the next step. Its restitution would then be φρ, where φ
//! is the fraction of the step in which the gap closes: any value from 0 to ρ. An impulse at the time t changes the
//! velocity of a grain by Δv and moves the grain only for the rest of the step Δt. So the grain moves from x to
//!
//! > x^n = x + Δt v^n − Σ t Δv,
//!
//! with its velocity v^n at the end of the step and the sum over its shocks. It has straight paths before and after a
//! shock, and meets other grains at its actual place. The field `offset` of a grain is the sum −Σ t Δv. The bond of a
//! pair that meets exists from the time t on.
//!
//! **Sequence.** Shocks are computed in passes. A pass takes the meetings that are the first for both grains, because a
//! grain that another collision deflects first does not arrive at its predicted place. The next pass examines the pairs
//! of struck grains again. Contacts that touch at the time of a meeting and are connected to it are struck together
//! with it, all at once, as under `moreau`. So in a row of touching balls at rest all balls fly off together, while
//! balls with gaps transmit the shock and only the last ball flies off. If several meetings at different times reach
//! the same touching grains, all of them are computed at the first of these times.
//!
//! **Gravity.** An unsupported grain falls on the parabola x + v s + ½a s² (position x and velocity v at the beginning,
//! time s, acceleration a), into however many steps the fall is divided. The displacement by the last velocity v^n
//! alone would exceed the parabola by Δt v^n − (Δt v + ½aΔt²) = ½aΔt², so this excess is subtracted. If the grain meets
//! a fixed body at the time t, the closing velocity is u = v_n + a_n t, with the components v_n and a_n of v and a
//! along the normal. The step adds the gravity of the whole step to v⁺, but only gravity after the meeting should
//! count. So v⁺ is chosen such that along the normal v⁺ + a_n t = −ρu. Works are computed with the speeds at the
//! meeting. A grain that rests on a body or is bonded when the step begins does not fall, so u = v_n.
//!
//! **Bonds.** A bond with the cohesion force C₀ that is stretched by s gives the energy C₀s back before its pair meets:
//! u² = v_n² + 2C₀s/m_ij, with the effective mass m_ij.
//!
//! **Why shocks are separate from the step.** If a single problem required bounces of closing contacts and v_n ≥ 0 of
//! opening contacts (normal velocity v_n), it might have no solution: two grains that rattle between other grains may
//! both have to separate, but have no room. Separate problems have a solution: the velocities −ρ v⁻ of all grains (v⁻:
//! velocities before the shocks) satisfy the conditions of all contacts in the shocks, and velocities of 0 satisfy
//! those in the step. This requires that a contact that opens with v_n⁻ > 0 before a shock may close after it at a
//! speed of up to ρ v_n⁻. If it does, the next pass strikes it.
//!
//! **Walls driven by a force** take part in no shock, because an impact would change the speed of the wall, and so the
//! times of all its later meetings. Instead the step itself stops grains that reach such a wall, and the wall's unknown
//! speed takes up their momentum. So momentum and energy balance, but grains do not bounce off such a wall.
//!
//! **A pass without friction creates no energy**, for the reason given in `remedies::sequential_impacts`.
//!
//! **Tolerance.** Shocks are solved to the tolerance of the step. With a larger tolerance the step would have to stop
//! the remaining approach; shocks would cost less, but the slump might depend on Δt. A pair whose grains are in no
//! other shock is solved exactly.

mod hand_over;
mod next_impacts;
mod solve_impacts;

pub(super) use hand_over::ClosedBond;

use glam::DVec2;

use crate::contact::{Candidates, Contact, ContactList, Impulse};
use crate::sim::settings::Settings;
use crate::sim::state::State;
use crate::sim::steppers::range::step_numbers::StepNumbers;
use crate::sim::stepping::{Stage, StepResult};
use crate::solver::{
    Model, Row, SolverSettings, StepProblem, StopTest, for_each_row, velocity_error,
};
use crate::world::World;

/// Largest number of passes in the calculation of a step's shocks. A pass computes a group of collisions that are the
/// next for their grains. Contacts that still close after the last pass are stopped by the solution of the step,
/// without a bounce. With a smaller value, too few contacts bounce if many grains meet in a step; with a larger value,
/// grains that bounce to and fro in a narrowing gap, ever more often, cost much time.
const MOST_PASSES: u32 = 24;

/// Closing speed above which a touching contact is struck in a further shock (collision) if one of its grains has
/// already been struck in the step, divided by the closing speed of the fastest shock of the step. With a smaller
/// value, clusters of touching grains need more passes; with a larger value, some of their contacts do not bounce.
const LEAST_AGAIN: f64 = 1e-3;

/// Speed of approach below which a grain rests on a body that it touches, in units of the speed that gravity adds in a
/// step. With a smaller value, grains of a pile at rest would count as falling; with a larger value, a ball that has
/// just come down would not have the speed of its fall.
const RESTS_BELOW: f64 = 2.0;

/// Difference in time, divided by the time step, up to which collisions count as simultaneous, so that symmetric
/// motions stay symmetric.
const SAME_MOMENT: f64 = 1e-6;

/// Value for a time that is never reached.
const NEVER: f64 = f64::INFINITY;

/// Computes the shocks (instantaneous collisions) of a step. Afterwards the bodies of the contact problem begin with
/// the velocities after the shocks. Returns the works and reports of the shocks, or `None` without shocks. The field
/// `gravity_work` of the result is a correction: the solution of the step counts the work of gravity as if grains had
/// their velocities after the shocks from the beginning of the step, although they moved with other velocities until
/// their shocks.
pub(super) fn pass<M: Model>(
    stage: &mut Stage<'_, M>,
    shocks: &mut Shocks,
    settings: &Settings,
) -> Option<StepResult> {
    shocks.numbers = StepNumbers::of(stage.world(), settings);
    let settings = &settings.solver;
    let Stage { state, problem, part, memory } = stage;
    let State { world, candidates, contacts, .. } = &**state;
    shocks.begin(problem, contacts, settings);
    let mut result: Option<StepResult> = None;
    for _ in 0..MOST_PASSES {
        let first_secs = shocks.find_next(&ShockInputs { problem, world, candidates });
        if first_secs == NEVER {
            break;
        }
        shocks.choose(problem, first_secs);
        shocks.refine(&ShockInputs { problem, world, candidates });
        let all = result.get_or_insert_with(StepResult::nothing_yet);
        for alone in [true, false] {
            if shocks.set_up(problem, part, alone) {
                shocks.solve::<M>(problem, part, memory, settings, alone, all);
            }
        }
        shocks.move_on(problem);
    }
    shocks.hand_over(problem, world, candidates);
    result
}

/// State of a pair of bodies in the calculation of a step's shocks (collisions).
#[derive(Clone, Copy, Debug)]
struct ShockPair {
    contact: Contact,
    is_bonded: bool,
    /// Stretch of the pair's bond, m.
    stretch: f64,
    /// Unit normal from the second body of the pair to the first body, which is a grain: at the beginning of the step,
    /// or, if a gap of the pair has closed within the step, at the last time when it closed.
    normal: DVec2,
    /// Gap along `normal` at the beginning of the step, m. If the gap has closed within the step, instead the value for
    /// which [`ShockPair::gap_at`] is 0 at the time when it closed.
    gap: f64,
    /// Change of the gap because shocks (collisions) have changed the paths of the two bodies, m.
    shift: f64,
    /// Relative velocity of the pair along `normal`, m/s, relative to the wall if the other body is a moving wall;
    /// below 0 if the gap closes.
    speed: f64,
    /// Acceleration along `normal` of a grain that falls on a fixed disc or a boundary, m/s²; 0 for other pairs.
    acceleration: f64,
    touch: Touch,
    next: NextImpact,
    /// Role of the pair in the present pass (group of collisions that are computed together): struck, connected to a
    /// struck pair, or neither.
    role: Role,
    /// Sum of the normal impulses of the pair's shocks (collisions) in this step so far, divided by the effective mass,
    /// m/s.
    impulse: f64,
    /// Time of the pair's last shock (collision), counted from the beginning of the step, s; 0 before its first shock.
    struck_at: f64,
    /// Normal velocity that gravity and other external forces had added, between the beginning of the step and the
    /// pair's last shock (collision), to a grain that falls on a fixed body, m/s; 0 for other pairs.
    gained: f64,
}

/// Contact state of a pair: apart, touching since the beginning of the step, or touching since its gap closed within
/// the step.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Touch {
    Apart,
    FromStart,
    /// The pair had a gap, which closed within the step.
    Met,
}

/// Next impact of a pair in the present step.
#[derive(Clone, Copy, Debug, PartialEq)]
enum NextImpact {
    /// The next impact is not known: it was not searched for yet, or the velocities of the two bodies have changed
    /// since.
    Unknown,
    Never,
    /// The pair touches, and its two bodies approach each other from this time (s) on.
    Closes(f64),
    /// The pair has a gap that closes: it meets at the time `secs` (s) with the normal `normal`.
    Meets {
        secs: f64,
        normal: DVec2,
    },
}

/// Role of a pair in a pass: a group of shocks (collisions) of a step that are computed together.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Role {
    Apart,
    /// The pair touches, and touching pairs connect it to a struck pair, one that collides in this pass.
    Joined,
    /// The pair is struck: the next impact of each of its grains is the impact of this pair.
    Struck,
}

/// State of a grain in the calculation of a step's shocks (collisions).
#[derive(Clone, Copy, Debug)]
struct ShockBody {
    /// Change of the grain's path by its shocks (collisions), extrapolated back to the beginning of the step, m: −Σ t
    /// Δv, where Δv (m/s) is the change of velocity by a shock at the time t (s). The entries are for x, y and rotation
    /// (arc length: angle times radius).
    offset: [f64; 3],
    /// Change of the grain's `offset` along x and y by the last pass (group of collisions that are computed together)
    /// that struck the grain, m.
    shift: DVec2,
    /// Time of the grain's last shock (collision), counted from the beginning of the step, s; 0 before its first shock.
    since: f64,
    /// Time of the grain's next shock (collision), counted from the beginning of the step, s; [`NEVER`] if no shock
    /// follows.
    next: f64,
    struck_in_step: bool,
    struck_in_pass: bool,
    /// Change of the grain's velocity by gravity and other external forces in the whole step, m/s. The entries are for
    /// x, y and rotation (angular velocity times radius).
    gain: [f64; 3],
    /// True if the grain does not fall freely, because it rests on a body or is bonded.
    is_supported: bool,
    /// Displacement of the grain in the step minus the time step Δt times its velocity at the end of the step, m,
    /// without the part `offset` that is due to shocks (collisions). For a grain that falls freely with the
    /// acceleration a it is −½aΔt². For each of the grain's pairs that met within the step, at the time t (s), and
    /// whose grains were not struck afterwards, −t Δv is added. Here Δv (m/s) is the change of the grain's velocity by
    /// the impulse that the solution of the step gives this pair: it acts only after t.
    rest_of_way: DVec2,
    /// Parent of this grain in a union–find structure: following `root` from grain to grain leads to the representative
    /// grain of the cluster. A cluster is a set of grains that are struck together.
    root: u32,
    /// Only for the representative grain of a cluster (a set of grains that are struck together): the time of the
    /// cluster's shock (collision), s, and the number of the cluster's contacts.
    cluster: (f64, u32),
}

/// Data of the shocks (instantaneous collisions) of a step. The vectors keep their memory from one step to the next.
#[derive(Clone, Debug, Default)]
pub(super) struct Shocks {
    numbers: StepNumbers,
    pairs: Vec<ShockPair>,
    bodies: Vec<ShockBody>,
    /// Impulses of the shocks (collisions) of the step, N·s, each with the number of its contact and the contact
    /// normal.
    of_shocks: Vec<(usize, (DVec2, Impulse))>,
    /// Impulses from the solution of the step after its shocks (collisions), N·s, one for each contact, with the
    /// contact normals.
    of_step: Vec<(DVec2, Impulse)>,
    /// Largest error that a contact's impulse has in a step that is solved to its residual tolerance, N·s.
    least: f64,
    /// Smallest product of effective mass and closing speed at which a touching contact is struck, N·s. It exceeds the
    /// errors that the solver's tolerance allows.
    least_momentum: f64,
    /// Smallest closing speed at which a touching contact is struck, m/s. It exceeds the errors that the solver's
    /// tolerance allows.
    least_closing: f64,
    /// Closing speed of the fastest shock (collision) of the step so far, m/s.
    fastest: f64,
}

/// Inputs for the calculation of the shocks (collisions) of a step.
struct ShockInputs<'a, M: Model> {
    problem: &'a StepProblem<M>,
    world: &'a World,
    candidates: &'a Candidates,
}

/// Returns the grains of contact `number`: the first body, which is always a grain, and the second body unless it is a
/// fixed disc or a boundary.
fn grains<M: Model>(problem: &StepProblem<M>, number: usize) -> (usize, Option<usize>) {
    let row = problem.rows.get(number);
    let is_pair = number >= problem.rows.fixed.len();
    (row.i as usize, is_pair.then_some(row.j as usize))
}

/// Returns the denominator of the residual of a contact problem, N·s: the Euclidean norm of a vector with one entry per
/// contact, its effective mass times the sum of two velocities. These are the normal velocity without contact impulses
/// and the term that the contact law adds to the normal velocity (for restitution).
fn scale<M: Model>(problem: &StepProblem<M>) -> f64 {
    let mut squared = 0.0;
    for_each_row(problem, |_, row, motion| {
        let free = row.effective_mass * (motion.free[0] + row.restitution_velocity);
        squared += free * free;
    });
    squared.sqrt()
}

/// Returns the normal of a contact, and its impulses (N·s). `reduced` contains these impulses divided by the effective
/// mass, m/s.
fn along_normal<M: Model>(row: &Row<M>, reduced: [f64; 2]) -> (DVec2, Impulse) {
    let [normal, tangential] = reduced.map(|along| row.effective_mass * along);
    (M::components(row.normal).into(), Impulse { normal, tangential })
}

/// Returns the components of a body's velocity along x and y.
fn along_axes<M: Model>(body: &M::Body<f64>) -> DVec2 {
    let [x, y, _] = M::coordinates(body);
    if M::AXES == 1 { DVec2::new(x, 0.0) } else { DVec2::new(x, y) }
}

impl ShockBody {
    /// Creates the state of a grain that no shock (collision) has struck yet. `before` is its velocity at the beginning
    /// of the step, and `free` its velocity at the end of the step if only gravity and other external forces, but no
    /// contacts, acted on it.
    fn untouched<M: Model>(before: &M::Body<f64>, free: &M::Body<f64>) -> Self {
        let [before, free] = [before, free].map(M::coordinates);
        Self {
            offset: [0.0; 3],
            shift: DVec2::ZERO,
            since: 0.0,
            next: NEVER,
            struck_in_step: false,
            struck_in_pass: false,
            gain: std::array::from_fn(|axis| free[axis] - before[axis]),
            is_supported: false,
            rest_of_way: DVec2::ZERO,
            root: 0,
            cluster: (NEVER, 0),
        }
    }
}

impl Shocks {
    fn begin<M: Model>(
        &mut self,
        problem: &StepProblem<M>,
        contacts: &ContactList,
        settings: &SolverSettings,
    ) {
        let Self { pairs, bodies, numbers, .. } = self;
        bodies.clear();
        let ends = problem.bodies.before.iter().zip(&problem.bodies.free);
        bodies.extend(ends.map(|(before, free)| ShockBody::untouched::<M>(before, free)));
        pairs.clear();
        let is_cohesive = problem.law.capture_speed() > 0.0;
        for_each_row(problem, |number, _, motion| {
            let index = problem.rows.contacts[number] as usize;
            let contact = contacts.contacts()[index];
            let (is_bonded, bond) = (contacts.is_in_touch(index), contacts.bonds()[index]);
            let touches = contact.gap <= numbers.touch;
            let speed = motion.before[0] - problem.wall_speed_before(number);
            let (i, j) = grains(problem, number);
            for grain in std::iter::once(i).chain(j) {
                let [x, y, _] = bodies[grain].gain;
                let rests = touches && speed.abs() <= RESTS_BELOW * libm::hypot(x, y);
                bodies[grain].is_supported |= rests || is_cohesive && is_bonded;
            }
            // Contacts with driven walls take no part in shocks; the step itself stops grains that reach such a wall.
            let touches = touches && !problem.gives_way(number);
            pairs.push(ShockPair {
                contact,
                is_bonded,
                stretch: if bond.alive { bond.stretch } else { 0.0 },
                normal: contact.normal,
                gap: contact.gap,
                shift: 0.0,
                speed,
                acceleration: 0.0,
                touch: if touches { Touch::FromStart } else { Touch::Apart },
                next: NextImpact::Unknown,
                role: Role::Apart,
                impulse: 0.0,
                struck_at: 0.0,
                gained: 0.0,
            });
        });
        for body in bodies.iter_mut().filter(|body| !body.is_supported) {
            let fallen = along_axes::<M>(&M::from_coordinates(body.gain));
            body.rest_of_way = -0.5 * numbers.time_step_secs * fallen;
        }
        self.of_shocks.clear();
        self.least = settings.tolerance * scale(problem);
        (self.least_momentum, self.least_closing) = match settings.stop {
            StopTest::VelocityError => (0.0, settings.tolerance * velocity_error(problem).scale),
            _ => (self.least, 0.0),
        };
        self.fastest = 0.0;
    }
}

impl NextImpact {
    /// Returns the time of the next impact, s, or [`NEVER`].
    fn secs(self) -> f64 {
        match self {
            Self::Unknown | Self::Never => NEVER,
            Self::Closes(secs) | Self::Meets { secs, .. } => secs,
        }
    }
}

impl ShockPair {
    /// Returns the gap of the pair along its stored normal at the time `secs` (s), m. The true gap is at least this
    /// large, because a distance is never smaller than its component along a fixed direction.
    fn gap_at(&self, secs: f64) -> f64 {
        self.gap + self.shift + secs * (self.speed + 0.5 * self.acceleration * secs)
    }
}
