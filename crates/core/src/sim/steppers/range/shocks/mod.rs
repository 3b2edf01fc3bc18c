//! The shocks of a step under the law `range`.
//!
//! Collisions are instantaneous: gravity and bonds have finite forces, and so no effect in zero time. So before the
//! step proper, colliding grains are brought to the velocities after their collisions, without gravity and cohesion.
//! A contact that closes with u bounces,
//!
//! > 0 ≤ P_n ⟂ u⁺ + ρ u⁻ ≥ 0.
//!
//! The step then continues from v⁺, without bounces.
//!
//! **A pair that meets within the step** bounces in it, with its full speed u at the meeting, along its normal at the
//! meeting (`contact::approach`). If it were slowed down to close its gap, and bounced in the next step, it would
//! have the restitution φρ, with φ the fraction of the step that the gap takes: any value from 0 to ρ. An impulse at
//! the time t moves a grain only for the rest of the step,
//!
//! > x^n = x + Δt v^n − Σ t Δv,
//!
//! so that a grain has straight paths before and after, and meets others at its actual place. The sum is the `offset`
//! of a grain. The bond of a meeting exists from t on.
//!
//! **Sequence.** A pass takes the meetings that are the first of both their grains, because a grain deflected by
//! another collision is not struck at its former place. The next pass examines the pairs of struck grains again.
//! Contacts that touch at that time are struck together with the meeting, all at once, as under `moreau`: in a row of
//! touching balls at rest all balls fly off together, while balls with gaps transmit the shock and only the last one
//! flies off. Meetings at different times that reach the same touching grains are struck at the first of these times.
//!
//! **Gravity.** An unsupported grain falls on the parabola x + v s + ½a s², however it is divided into steps: the
//! excess of the displacement by the last velocity, Δt v^n − ½aΔt², is subtracted. If the grain meets a fixed body,
//! u = v_n + a_n t, and it gets v⁺ such that with the gravity of the whole step it ends with the gravity since the
//! meeting: v⁺ + a_n t = −ρu. The works are those at the speeds of the meeting. A supported grain counts as held, as
//! far as is known before the step is solved, and has u = v_n.
//!
//! **Bonds.** A bond with stretch s returns C₀s until its pair meets: u² = v_n² + 2C₀s/m_ij.
//!
//! **Why shocks are separate from the step.** If bounces were required together with v_n ≥ 0 of opening contacts, the
//! problem might have no solution: two grains that rattle between others may each have to separate while neither can.
//! On their own, v⁺ = −ρ v⁻ of all grains satisfies every contact of the shocks, and v = 0 every contact of the step.
//! For this, opening contacts have their term too: they may close by ρ v_n⁻, and are struck by the next pass if they
//! do.
//!
//! **Walls driven by a force** take part in no shock: an impact would change the wall's speed, and so the times of
//! all its later meetings. The step proper stops grains that reach such a wall, and the wall's unknown speed takes up
//! their momentum. So momentum and energy balance, but nothing bounces off such a wall.
//!
//! **No energy is gained** by a pass without friction, for the reason given in `remedies::sequential_impacts`.
//!
//! **Tolerance.** The same as that of the step. With a larger tolerance, and the remaining approach left to the step,
//! shocks cost less, but slump may then depend on Δt. A pair that shares its grains with no other is solved exactly.

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

/// Limit for the passes. Contacts that still close are then stopped by the step. If smaller, restitution is lost when
/// many grains meet in a step; if larger, a wedge of grains that bounces ever faster takes long.
const MOST_PASSES: u32 = 24;

/// Speed, relative to the fastest shock of the step, above which contacts that were struck and close again are struck
/// once more. If smaller, clusters of touching grains need more passes; if larger, restitution is lost in them.
const LEAST_AGAIN: f64 = 1e-3;

/// Approach speed, in steps of gravity, below which grains rest on bodies that they touch. If smaller, grains of a
/// pile at rest would count as falling; if larger, a ball that has just come down would not have the speed of its
/// fall.
const RESTS_BELOW: f64 = 2.0;

/// Meetings within this fraction of Δt happen at once, so that symmetric motions stay symmetric.
const SAME_MOMENT: f64 = 1e-6;

/// A time that is never reached.
const NEVER: f64 = f64::INFINITY;

/// Takes a prepared problem through the shocks of its step; afterwards its bodies begin with v⁺. Returns the results
/// of the shocks, if there were any. Their `gravity_work` subtracts the work of gravity before meetings, because the
/// step counts it again.
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

/// State of a pair during the shocks.
#[derive(Clone, Copy, Debug)]
struct ShockPair {
    contact: Contact,
    is_bonded: bool,
    /// Stretch of its bond, m.
    stretch: f64,
    /// Normal n, from j to i: at the beginning of the step, or at its last meeting.
    normal: DVec2,
    /// The gap along n at the beginning of the step, m. For a pair that has met, the value that makes it close at the
    /// meeting.
    gap: f64,
    /// Change of the gap by offsets, m.
    shift: f64,
    /// Normal velocity v_n, relative to a moving wall, m/s.
    speed: f64,
    /// Acceleration a_n of a grain that falls on a fixed body, m/s²; otherwise 0.
    acceleration: f64,
    touch: Touch,
    next: NextImpact,
    /// Its role in the present pass.
    role: Role,
    /// Total λ_n of its shocks, m/s.
    impulse: f64,
    /// Time of its last shock, s.
    struck_at: f64,
    /// Velocity that gravity had given it by then, m/s.
    gained: f64,
}

/// State of contact of a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Touch {
    Apart,
    FromStart,
    /// The pair closed a gap within the step.
    Met,
}

/// Next impact of a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
enum NextImpact {
    /// To be found, because its bodies' velocities have changed; or never searched for.
    Unknown,
    Never,
    /// The pair touches, and closes from this time (s) on.
    Closes(f64),
    /// The pair meets.
    Meets {
        secs: f64,
        normal: DVec2,
    },
}

/// Role of a pair in a pass.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Role {
    Apart,
    /// The pair touches, and is connected to a struck pair.
    Joined,
    /// Its impact is the next one of both its grains.
    Struck,
}

/// State of a grain during the shocks.
#[derive(Clone, Copy, Debug)]
struct ShockBody {
    /// Offset −Σ t Δv, one entry per degree of freedom, m.
    offset: [f64; 3],
    /// Change of the offset in the last pass, m.
    shift: DVec2,
    /// Time of its last shock, s.
    since: f64,
    /// Time of its next shock, s, or [`NEVER`].
    next: f64,
    struck_in_step: bool,
    struck_in_pass: bool,
    /// Velocity change by gravity in the step, m/s.
    gain: [f64; 3],
    /// True if it rests on a body or is bonded, and so does not fall freely.
    is_supported: bool,
    /// The part of its displacement that the step's last velocity does not give, m: −½aΔt² for a freely falling
    /// grain, and −Σ tλ of the step's impulses on pairs that met.
    rest_of_way: DVec2,
    /// A grain of its cluster, the grains that are struck together.
    root: u32,
    /// For a root: the time of the cluster's shock, s, and the number of its rows.
    cluster: (f64, u32),
}

/// Data of shocks. Memory is kept from one step to the next.
#[derive(Clone, Debug, Default)]
pub(super) struct Shocks {
    numbers: StepNumbers,
    pairs: Vec<ShockPair>,
    bodies: Vec<ShockBody>,
    /// Impulses of shocks, by row, and of the step, by contact, each along its normal at the time.
    of_shocks: Vec<(usize, (DVec2, Impulse))>,
    of_step: Vec<(DVec2, Impulse)>,
    /// Largest error of a contact in a step that is solved to its residual, N·s.
    least: f64,
    /// Smallest m_ij times closing speed (m/s), and smallest closing speed, for which a touching contact is struck.
    /// Above the remaining error of solves.
    least_momentum: f64,
    least_closing: f64,
    /// Fastest shock of the step so far, m/s.
    fastest: f64,
}

/// Inputs of the shocks.
struct ShockInputs<'a, M: Model> {
    problem: &'a StepProblem<M>,
    world: &'a World,
    candidates: &'a Candidates,
}

/// The grains of row `number`: i, and j unless it is fixed.
fn grains<M: Model>(problem: &StepProblem<M>, number: usize) -> (usize, Option<usize>) {
    let row = problem.rows.get(number);
    let is_pair = number >= problem.rows.fixed.len();
    (row.i as usize, is_pair.then_some(row.j as usize))
}

/// ‖m_n (v_n^free + term of the law)‖ of a problem, N·s, the scale of its residual.
fn scale<M: Model>(problem: &StepProblem<M>) -> f64 {
    let mut squared = 0.0;
    for_each_row(problem, |_, row, motion| {
        let free = row.effective_mass * (motion.free[0] + row.restitution_velocity);
        squared += free * free;
    });
    squared.sqrt()
}

/// The normal of a row, and its impulse from (λ_n, λ_t), m/s.
fn along_normal<M: Model>(row: &Row<M>, reduced: [f64; 2]) -> (DVec2, Impulse) {
    let [normal, tangential] = reduced.map(|along| row.effective_mass * along);
    (M::components(row.normal).into(), Impulse { normal, tangential })
}

/// The components along x and y.
fn along_axes<M: Model>(body: &M::Body<f64>) -> DVec2 {
    let [x, y, _] = M::coordinates(body);
    if M::AXES == 1 { DVec2::new(x, 0.0) } else { DVec2::new(x, y) }
}

impl ShockBody {
    /// A grain without shocks so far, from its velocities before the step and after gravity alone.
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
            // The step proper stops grains that reach a driven wall (see the module).
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
    /// Its time, s, or [`NEVER`].
    fn secs(self) -> f64 {
        match self {
            Self::Unknown | Self::Never => NEVER,
            Self::Closes(secs) | Self::Meets { secs, .. } => secs,
        }
    }
}

impl ShockPair {
    /// The gap along the normal at a time, m. It never exceeds the gap itself.
    fn gap_at(&self, secs: f64) -> f64 {
        self.gap + self.shift + secs * (self.speed + 0.5 * self.acceleration * secs)
    }
}
