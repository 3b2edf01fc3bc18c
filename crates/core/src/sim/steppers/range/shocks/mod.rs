//! The shocks of a step under the law `range`.
//!
//! Collisions are instantaneous: neither gravity nor a bond, whose forces are finite, does anything in
//! no time. So before the step proper, the grains that run into each other are brought to the
//! velocities after their collisions, with neither gravity nor cohesion. A contact that closes with u
//! bounces,
//!
//! > 0 ≤ P_n ⟂ u⁺ + ρ u⁻ ≥ 0.
//!
//! The step then goes on from v⁺ and bounces no more.
//!
//! **A pair that meets within the step** bounces in it, with the whole speed u that it has when it
//! meets, along the normal that it has then (`contact::approach`). Slowed down to what closes its gap, and
//! left to the next step to bounce, it would have the restitution φρ, φ being the part of the step that
//! the gap takes: any number from 0 to ρ. An impulse at the moment t moves a grain for what is left of
//! the step,
//!
//! > x^n = x + Δt v^n − Σ t Δv,
//!
//! so that a grain is on straight ways before and after, and meets others where it then is. The sum is the
//! `offset` of a grain. A bond that a meeting makes lives from t on.
//!
//! **One after the other.** A pass takes those meetings that are the first of both their grains: what
//! another collision deflects is not struck where it would have been. The next pass looks anew at the
//! pairs of grains that were struck. What touches at that time is struck along with it, all at once, as
//! under `moreau`: in a row of balls at rest that touch, all fly off together, while balls with gaps hand
//! the shock on, and the last one alone flies off. Meetings of different moments that reach the same
//! touching grains are struck at the first of these moments.
//!
//! **Gravity.** A grain that rests on nothing falls on the parabola x + v s + ½a s², and does so however it
//! is cut into steps: what the step's last velocity tells too much of it, Δt v^n − ½aΔt², is taken off. Where it
//! meets what is fixed, u = v_n + a_n t, and it is handed v⁺ such that with all of
//! the step's gravity it ends with what it has had since: v⁺ + a_n t = −ρu. The works are those of the speeds at the
//! meeting. What rests on something is held by it, for all that is known before the step is solved, and has u = v_n.
//!
//! **Bonds.** A bond that is stretched by s has C₀s to give back until its pair meets: u² = v_n² + 2C₀s/m_ij.
//!
//! **Why not in one problem with the step.** A bounce that is asked for together with v_n ≥ 0 of contacts that open
//! can be asked for in vain: of two grains that rattle between others each is to be left and none can
//! be. Then no solution is to be had. Asked for alone, v⁺ = −ρ v⁻ of all grains obeys every contact, and so does v = 0 in the step.
//! For this, contacts that open have their term too: they may close by ρ v_n⁻, and are struck by the next pass if they do.
//!
//! **Walls that a force drives** are struck in no shock: what hits such a wall would change its speed, and with that
//! the moments of all that it is still to meet. The step proper stops what comes to it, and its unknown speed takes that
//! up, so momentum and energy balance; but nothing bounces off it.
//!
//! **No energy is gained** by a pass without friction, for the reason that `remedies::sequential_impacts` gives.
//!
//! **How tightly.** As the step. Solved less tightly, with what that leaves of approach taken up by the
//! step, shocks cost less, but slump may then depend on Δt. A pair that shares its grains with no other is solved exactly.

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

/// Passes at the most; what then still closes is stopped by the step. Smaller: where many grains meet in a
/// step, restitution is lost; larger: a wedge of grains that bounces ever faster holds the step up.
const MOST_PASSES: u32 = 24;

/// Contacts that were struck and close again are struck once more above this part of the fastest shock of
/// the step. Smaller: clusters of touching grains take more passes; larger: restitution is lost in them.
const LEAST_AGAIN: f64 = 1e-3;

/// Grains that come to what they touch slower than this many steps of gravity rest on it. Smaller: in a pile
/// at rest grains would be taken to fall; larger: a ball that has just come down would not have the speed of its fall.
const RESTS_BELOW: f64 = 2.0;

/// Meetings that are this part of Δt apart happen at once: symmetric motions stay symmetric.
const SAME_MOMENT: f64 = 1e-6;

/// No moment of the step.
const NEVER: f64 = f64::INFINITY;

/// Takes a prepared problem through the shocks of its step: from then on its bodies begin with v⁺. What the shocks came
/// to, if there were any: `gravity_work` is less what gravity did until meetings, since the step counts it once more.
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

/// A pair on its way through the shocks.
#[derive(Clone, Copy, Debug)]
struct ShockPair {
    contact: Contact,
    is_bonded: bool,
    /// How far its bond is open, m.
    stretch: f64,
    /// n, from j to i: at the beginning of the step, or where it last met.
    normal: DVec2,
    /// The gap along n at the beginning of the step, m; of one that has met, such that it closed then.
    gap: f64,
    /// What offsets have added to it, m.
    shift: f64,
    /// v_n, relative to a wall that moves, m/s.
    speed: f64,
    /// a_n of a grain that falls on what is fixed, m/s²; else 0.
    acceleration: f64,
    touch: Touch,
    next: NextImpact,
    /// What it has to do with the present pass.
    role: Role,
    /// λ_n of its shocks, m/s.
    impulse: f64,
    /// The moment of the last of them, s.
    struck_at: f64,
    /// What gravity had given it by then, m/s.
    gained: f64,
}

/// Whether a pair touches.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Touch {
    Apart,
    FromStart,
    /// It has closed a gap within the step.
    Met,
}

/// When a pair is struck next.
#[derive(Clone, Copy, Debug, PartialEq)]
enum NextImpact {
    /// To be found: its bodies go otherwise than before, or it is never looked for.
    Unknown,
    Never,
    /// It touches, and closes from this moment (s) on.
    Closes(f64),
    /// It meets.
    Meets {
        secs: f64,
        normal: DVec2,
    },
}

/// What a pair has to do with a pass.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Role {
    Apart,
    /// It touches, and is joined to what is struck.
    Joined,
    /// Its own impact is the next one of both its grains.
    Struck,
}

/// A grain on its way through the shocks.
#[derive(Clone, Copy, Debug)]
struct ShockBody {
    /// −Σ t Δv, an entry a degree of freedom, m.
    offset: [f64; 3],
    /// What the last pass added to that, m.
    shift: DVec2,
    /// The moment of its last shock, s.
    since: f64,
    /// The moment of its next one, s, or [`NEVER`].
    next: f64,
    struck_in_step: bool,
    struck_in_pass: bool,
    /// What gravity gives it in the step, m/s.
    gain: [f64; 3],
    /// True where it rests against something or is bonded, and so does not fall freely.
    is_supported: bool,
    /// What the step's last velocity tells too little of its way, m: −½aΔt² of one that falls freely, and
    /// −Σ tλ of the impulses that the step has for pairs that met.
    rest_of_way: DVec2,
    /// A grain of the cluster that it is struck with.
    root: u32,
    /// Of a root: the moment of the cluster's shock, s, and its rows.
    cluster: (f64, u32),
}

/// What is known of shocks. Memory is kept from one step to the next.
#[derive(Clone, Debug, Default)]
pub(super) struct Shocks {
    numbers: StepNumbers,
    pairs: Vec<ShockPair>,
    bodies: Vec<ShockBody>,
    /// The impulses of shocks, by their rows, and of the step, by its contacts, along their normals of then.
    of_shocks: Vec<(usize, (DVec2, Impulse))>,
    of_step: Vec<(DVec2, Impulse)>,
    /// How far a contact may err in a step that is solved to a residual, N·s.
    least: f64,
    /// m_ij times the speed (m/s) and the speed that a contact which touches has to close with to be struck: above
    /// what solves leave.
    least_momentum: f64,
    least_closing: f64,
    /// The fastest shock of the step so far, m/s.
    fastest: f64,
}

/// Where shocks happen.
struct ShockInputs<'a, M: Model> {
    problem: &'a StepProblem<M>,
    world: &'a World,
    candidates: &'a Candidates,
}

/// The grains of a row by its number: i, and j unless that is fixed.
fn grains<M: Model>(problem: &StepProblem<M>, number: usize) -> (usize, Option<usize>) {
    let row = problem.rows.get(number);
    let is_pair = number >= problem.rows.fixed.len();
    (row.i as usize, is_pair.then_some(row.j as usize))
}

/// ‖m_n (v_n^free + what the law adds)‖ of a problem, N·s, which its residual is measured by.
fn scale<M: Model>(problem: &StepProblem<M>) -> f64 {
    let mut squared = 0.0;
    for_each_row(problem, |_, row, motion| {
        let free = row.effective_mass * (motion.free[0] + row.restitution_velocity);
        squared += free * free;
    });
    squared.sqrt()
}

/// The normal of a row, and the impulse of its (λ_n, λ_t), m/s.
fn along_normal<M: Model>(row: &Row<M>, reduced: [f64; 2]) -> (DVec2, Impulse) {
    let [normal, tangential] = reduced.map(|along| row.effective_mass * along);
    (M::components(row.normal).into(), Impulse { normal, tangential })
}

/// Along x and y.
fn along_axes<M: Model>(body: &M::Body<f64>) -> DVec2 {
    let [x, y, _] = M::coordinates(body);
    if M::AXES == 1 { DVec2::new(x, 0.0) } else { DVec2::new(x, y) }
}

impl ShockBody {
    /// One of which nothing has happened yet, as it begins and as gravity alone would leave it.
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
            // The step proper stops what comes to a wall that gives way (see the module).
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
    /// Its moment, s, or [`NEVER`].
    fn secs(self) -> f64 {
        match self {
            Self::Unknown | Self::Never => NEVER,
            Self::Closes(secs) | Self::Meets { secs, .. } => secs,
        }
    }
}

impl ShockPair {
    /// The gap along the normal at a moment, m: never above the gap itself.
    fn gap_at(&self, secs: f64) -> f64 {
        self.gap + self.shift + secs * (self.speed + 0.5 * self.acceleration * secs)
    }
}
