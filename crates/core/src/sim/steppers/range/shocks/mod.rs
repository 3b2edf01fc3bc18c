//! Shocks (instantaneous collisions) of a step under the law `range`.
//!
//! Collisions are instantaneous, so gravity and bonds have no effect on them, because their forces are finite. So each
//! step begins with its shocks: without gravity and cohesion, colliding grains get the velocities that they have after
//! their collisions. A contact that closes with the normal velocity u⁻ bounces with the restitution ρ and ends with u⁺,
//!
//! > 0 ≤ P_n ⟂ u⁺ + ρ u⁻ ≥ 0.
//!
//! The step then continues from the velocities v⁺ after the shocks, without bounces.
//!
//! **A pair that meets within the step** bounces within this step, with its full speed u at the meeting, along its
//! normal at the meeting (`contact::approach`). The alternative would be to slow the pair down so that it closes its
//! gap in this step and bounces in the next step. Its restitution would then be φρ, where φ is the fraction of the step
//! in which the gap closes: any value from 0 to ρ. An impulse at the time t changes a velocity by Δv and moves the
//! grain only for the rest of the step,
//!
//! > x^n = x + Δt v^n − Σ t Δv,
//!
//! so that a grain has straight paths before and after the shock, and meets other grains at its actual place. The field
//! `offset` of a grain is this sum −Σ t Δv. The bond of the pair exists from t on.
//!
//! **Sequence.** A pass takes the meetings that are the first for both grains, because a grain that another collision
//! deflects first does not arrive at its predicted place. The next pass examines the pairs of struck grains again.
//! Contacts that touch at the time of a meeting and are connected to it are struck together with it, all at once, as
//! under `moreau`. So in a row of touching balls at rest all balls fly off together, while balls with gaps transmit the
//! shock and only the last ball flies off. If several meetings at different times reach the same touching grains, all
//! of them are computed at the first of these times.
//!
//! **Gravity.** An unsupported grain falls on the parabola x + v s + ½a s² (time s, acceleration a), into however many
//! steps the fall is divided. The displacement by the last velocity alone would exceed the parabola by Δt v^n − ½aΔt²,
//! so this excess is subtracted. If the grain meets a fixed body at the time t, the closing velocity is u = v_n + a_n
//! t. The step adds the gravity of the whole step to v⁺, but only gravity after the meeting should count. So v⁺ is
//! chosen such that v⁺ + a_n t = −ρu. Works are computed with the speeds at the meeting. A grain that is known to be
//! supported before the step is solved does not fall, so u = v_n.
//!
//! **Bonds.** A bond with the stretch s gives the energy C₀s back before its pair meets: u² = v_n² + 2C₀s/m_ij.
//!
//! **Why shocks are separate from the step.** If a single problem required both bounces and v_n ≥ 0 of opening
//! contacts, it might have no solution: two grains that rattle between other grains may both have to separate, but have
//! no room. In separate problems, v⁺ = −ρ v⁻ of all grains satisfies every contact of the shocks, and v = 0 every
//! contact of the step. For this, opening contacts have a term in the shocks, too: they may close by ρ v_n⁻, and are
//! struck by the next pass if they do.
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

/// Largest number of passes in the calculation of a step's shocks. Contacts that still close after the last pass are
/// stopped by the solution of the step, without a bounce. With a smaller value, too few contacts bounce if many grains
/// meet in a step; with a larger value, a wedge of grains that bounces ever faster costs much time.
const MOST_PASSES: u32 = 24;

/// Closing speed, divided by the fastest shock of the step, above which contacts of grains that were struck before are
/// struck again. With a smaller value, clusters of touching grains need more passes; with a larger value, some of their
/// contacts do not bounce.
const LEAST_AGAIN: f64 = 1e-3;

/// Speed of approach below which a grain rests on a body that it touches, in units of the speed that gravity adds in a
/// step. With a smaller value, grains of a pile at rest would count as falling; with a larger value, a ball that has
/// just come down would not have the speed of its fall.
const RESTS_BELOW: f64 = 2.0;

/// Difference in time, divided by Δt, up to which meetings count as simultaneous, so that symmetric motions stay
/// symmetric.
const SAME_MOMENT: f64 = 1e-6;

/// Value for a time that is never reached.
const NEVER: f64 = f64::INFINITY;

/// Computes the shocks of a step. Afterwards the bodies of the contact problem begin with the velocities v⁺ after the
/// shocks. Returns the works and reports of the shocks, or `None` without shocks. Their `gravity_work` contains, with a
/// minus sign, the work of gravity before meetings, because the solution of the step counts this work again.
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

/// State of a pair of bodies in the calculation of a step's shocks.
#[derive(Clone, Copy, Debug)]
struct ShockPair {
    contact: Contact,
    is_bonded: bool,
    /// Stretch of the pair's bond, m.
    stretch: f64,
    /// Unit normal n, from j to i: at the beginning of the step, or at the last meeting of the pair.
    normal: DVec2,
    /// Gap along n at the beginning of the step, m. After a meeting: the value for which [`ShockPair::gap_at`] is 0 at
    /// the time of the meeting.
    gap: f64,
    /// Change of the gap because shocks have changed the paths of the two grains, m.
    shift: f64,
    /// Normal velocity v_n of the pair, relative to the wall if the other body is a moving wall, m/s.
    speed: f64,
    /// Acceleration a_n along n of a grain that falls on a fixed disc or a boundary, m/s²; 0 for other pairs.
    acceleration: f64,
    touch: Touch,
    next: NextImpact,
    /// Role of the pair in the present pass: struck, connected to a struck pair, or neither.
    role: Role,
    /// Sum of the normal impulses of the pair's shocks so far, divided by the effective mass, m/s.
    impulse: f64,
    /// Time of the pair's last shock, counted from the beginning of the step, s.
    struck_at: f64,
    /// Velocity that gravity had given the pair by the time of its last shock, m/s.
    gained: f64,
}

/// Contact state of a pair: apart, touching since the beginning of the step, or touching since a meeting within the
/// step.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Touch {
    Apart,
    FromStart,
    /// The pair had a gap, and met within the step.
    Met,
}

/// Next impact of a pair in the present step.
#[derive(Clone, Copy, Debug, PartialEq)]
enum NextImpact {
    /// The next impact is not known: it was not searched for yet, or the velocities of the two bodies have changed
    /// since.
    Unknown,
    Never,
    /// The pair touches, and closes from this time (s) on.
    Closes(f64),
    /// The pair has a gap that closes: it meets at the time `secs` (s) with the normal `normal`.
    Meets {
        secs: f64,
        normal: DVec2,
    },
}

/// Role of a pair in a pass of the calculation of shocks.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Role {
    Apart,
    /// The pair touches, and is connected through touching pairs to a struck pair.
    Joined,
    /// The pair is struck: its impact is the next impact of both its grains.
    Struck,
}

/// State of a grain in the calculation of a step's shocks.
#[derive(Clone, Copy, Debug)]
struct ShockBody {
    /// Offset −Σ t Δv of the grain's path by its shocks, each a change of velocity Δv at a time t, m. One entry per
    /// degree of freedom.
    offset: [f64; 3],
    /// Change of the grain's `offset` in the last pass along x and y, m.
    shift: DVec2,
    /// Time of the grain's last shock, s.
    since: f64,
    /// Time of the grain's next shock, s, or [`NEVER`].
    next: f64,
    struck_in_step: bool,
    struck_in_pass: bool,
    /// Change of the grain's velocity by gravity in the whole step, m/s.
    gain: [f64; 3],
    /// True if the grain does not fall freely, because it rests on a body or is bonded.
    is_supported: bool,
    /// Displacement of the grain in the step minus Δt times its velocity at the end, m: −½aΔt² for a freely falling
    /// grain with the acceleration a, and −Σ tλ for the impulses λ of the step on pairs that met at a time t.
    rest_of_way: DVec2,
    /// Next grain on the path to the representative grain of this grain's cluster. A cluster is a set of grains that
    /// are struck together.
    root: u32,
    /// Only for the representative grain of a cluster: the time of the cluster's shock, s, and the number of the
    /// cluster's contacts.
    cluster: (f64, u32),
}

/// Data of the shocks of a step. The vectors keep their memory from one step to the next.
#[derive(Clone, Debug, Default)]
pub(super) struct Shocks {
    numbers: StepNumbers,
    pairs: Vec<ShockPair>,
    bodies: Vec<ShockBody>,
    /// Impulses of the shocks, N·s, each with the number of its contact and the contact normal.
    of_shocks: Vec<(usize, (DVec2, Impulse))>,
    /// Impulses from the solution of the step after the shocks, N·s, one for each contact, with the contact normals.
    of_step: Vec<(DVec2, Impulse)>,
    /// Largest error of a contact's impulse in a step that is solved to its residual tolerance, N·s.
    least: f64,
    /// Smallest product of effective mass and closing speed with which a touching contact is struck, N·s. It exceeds
    /// the errors of solves.
    least_momentum: f64,
    /// Smallest closing speed with which a touching contact is struck, m/s. It exceeds the errors of solves.
    least_closing: f64,
    /// Closing speed of the fastest shock of the step so far, m/s.
    fastest: f64,
}

/// Inputs for the calculation of shocks.
struct ShockInputs<'a, M: Model> {
    problem: &'a StepProblem<M>,
    world: &'a World,
    candidates: &'a Candidates,
}

/// Returns the grains of contact `number`: grain i, and grain j unless the other body is a fixed disc or a boundary.
fn grains<M: Model>(problem: &StepProblem<M>, number: usize) -> (usize, Option<usize>) {
    let row = problem.rows.get(number);
    let is_pair = number >= problem.rows.fixed.len();
    (row.i as usize, is_pair.then_some(row.j as usize))
}

/// Returns the number by which the residual of a contact problem is divided, N·s: the norm of the normal impulses that
/// would stop the contacts' normal velocities without contact impulses, including the term that the contact law adds to
/// the normal velocity.
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
    /// Creates the state of a grain that no shock has struck yet. `before` is its velocity at the beginning of the
    /// step, and `free` its velocity after the gravity of the whole step.
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
    /// Returns the gap of the pair along its normal at the time `secs` (s), m. The true gap is never smaller.
    fn gap_at(&self, secs: f64) -> f64 {
        self.gap + self.shift + secs * (self.speed + 0.5 * self.acceleration * secs)
    }
}
