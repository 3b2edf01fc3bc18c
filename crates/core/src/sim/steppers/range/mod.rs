//! Stepper `range`: a step under the contact law `range` (`contact::range`). Pairs that may meet within the step become
//! contacts before they touch. The step is solved with its bonds (`range::bonds`), in substeps if bonds break or grains
//! move far. Then remaining overlaps are removed by moving the grains apart.
//!
//! **Substeps** are needed for two reasons.
//!
//! * The step is long compared with the time √(2δ_c m_ij/C₀) in which the pull of a bond alone would open or close it
//!   by the debonding distance δ_c (cohesion force C₀, effective mass m_ij), and bonds are restless, that is about to
//!   break (`range::bonds`). A pile at rest, or without restless bonds, is solved in one full step. Usually a full step
//!   is tried first, and is solved again in substeps if it finds restless bonds. It is not tried if bonds were restless
//!   in the previous step (or in a substep of that step), or if the two grains of a bond circle each other fast
//!   ([`circling_looks_like_a_shock`]). If even sixteen substeps are too long for a break, the step reports this with
//!   the longest step that would suffice (`sim::alarm`).
//! * Grains move far. A contact keeps its normal from the beginning of the step, so the constraint v_n + gap/Δt ≥ 0
//!   (normal velocity v_n, time step Δt) also stops a grain that would have passed another grain. In piles without
//!   cohesion, this is the only reason for substeps; without them such a pile would slump too little at a large Δt.

mod bonds;
mod shocks;
mod step_numbers;

pub(super) use bonds::RangeMemory;

use glam::DVec2;

use crate::contact::law::cohesion_force;
use crate::contact::range::{TOUCH_IN_DIAMETERS, bond_time_secs};
use crate::contact::{InTouch, LookAhead, Numbering, Other};
use crate::number::Parts;
use crate::sim::settings::Settings;
use crate::sim::state::State;
use crate::sim::steppers::range::bonds::solve_range;
use crate::sim::stepping::{BondEnergies, Stage, StepResult};
use crate::solver::{Approach, Model, SolveReport};

/// Upper limits of the two search distances `distance` and `reach` of [`LookAhead`], in mean diameters. A pair becomes
/// a contact if its gap would fall below `distance` within the step, and is below `reach` at the beginning of the step.
/// Both distances increase with the speed of the fastest body, up to these limits. With larger limits, more pairs that
/// do not meet become contacts.
const AHEAD_IN_DIAMETERS: [f64; 2] = [0.25, 2.0];

/// Longest substep (part of a step) while bonds are restless (about to break), in units of the time in which the pull
/// of a bond alone would open or close it by the debonding distance. With a larger value, weakly bonded piles do not
/// fall at a large time step, because a load reaches only the next bond in each substep; a smaller value costs more.
const SUBSTEP_IN_BOND_TIMES: f64 = 0.4;

/// Longest distance that a grain moves in a substep (part of a step), in mean diameters, unless this needs more than
/// [`MOST_SUBSTEPS`] substeps. With a larger value a pile slumps too little at a large time step; a smaller value costs
/// more.
const MOST_TRAVEL: f64 = 0.1;

/// Largest number of substeps into which a step is divided. With more substeps, a step would be solved so much more
/// finely than requested that its result would no longer be comparable to a step of the requested length.
const MOST_SUBSTEPS: f64 = 16.0;

/// Returns the distances within which the present step searches for contacts. The distances are sufficient if no grain
/// becomes faster than the fastest grain or wall, except by gravity and body forces.
fn look_ahead(state: &State, time_step_secs: f64) -> LookAhead {
    let world = &state.world;
    let travel = travel(state, time_step_secs);
    let [near, far] = AHEAD_IN_DIAMETERS.map(|most| most * world.mean_diameter);
    let distance = travel.min(near);
    let reach = (distance + 2.0 * travel).min(far);
    LookAhead { time_step_secs, distance, reach, in_touch: InTouch::Bonded }
}

/// Returns an upper bound for the distance that any grain moves in a step of length `time_step_secs` (s), m.
fn travel(state: &State, time_step_secs: f64) -> f64 {
    (state.fastest() + 2.0 * state.largest_acceleration() * time_step_secs) * time_step_secs
}

/// Decision on how a step is divided into substeps.
struct StepCut {
    substeps: u32,
    /// True if the two grains of a bond circle each other so fast that an undivided step would separate them.
    circling: bool,
    /// True if the step is first tried undivided; if bonds turn out to be about to break, it is then solved in
    /// substeps.
    whole_first: bool,
    /// Longest time step, s, for which [`MOST_SUBSTEPS`] substeps are enough to follow a bond that breaks; `None` if
    /// the present time step is at most this long.
    longest_step_secs: Option<f64>,
}

impl StepCut {
    /// Decides into how many substeps the present step is divided. `restless` is true if bonds were about to break in
    /// the previous step.
    fn of(state: &State, settings: &Settings, restless: bool) -> Self {
        let State { world, .. } = state;
        let parameters = &settings.parameters;
        let whole = parameters.time_step_secs;
        let distance = parameters.debonding_distance * world.mean_diameter;
        let travel = travel(state, whole);
        let of_travel = (travel / (MOST_TRAVEL * world.mean_diameter)).ceil();
        let acceleration = parameters.cohesion_acceleration(world.gravity.magnitude());
        let bond_time = bond_time_secs(parameters.bond, acceleration, distance);
        let of_bonds = (whole / (SUBSTEP_IN_BOND_TIMES * bond_time)).ceil();
        let pull = cohesion_force(parameters.bond, 1.0, acceleration);
        let circling = of_bonds > 1.0 && circling_looks_like_a_shock(state, whole, pull, distance);
        let substeps = of_travel.max(of_bonds).clamp(1.0, MOST_SUBSTEPS) as u32;
        let longest_secs = MOST_SUBSTEPS * SUBSTEP_IN_BOND_TIMES * bond_time;
        Self {
            substeps,
            circling,
            whole_first: substeps == 1 || (of_travel <= 1.0 && !restless && !circling),
            longest_step_secs: (of_bonds > MOST_SUBSTEPS).then_some(longest_secs),
        }
    }
}

/// Takes a step: undivided, or in substeps if bonds are about to break or grains move far.
pub(super) fn advance<M: Model>(
    stage: &mut Stage<'_, M>,
    settings: &Settings,
    memory: &mut RangeMemory,
) -> StepResult {
    prepare(stage, settings);
    let restless = std::mem::take(&mut memory.restless);
    let StepCut { substeps, circling, whole_first, longest_step_secs } =
        StepCut::of(stage.state, settings, restless);
    let mut result =
        StepResult { bonds: Some(BondEnergies::default()), ..StepResult::nothing_yet() };
    if whole_first {
        match try_step(stage, settings, memory, substeps == 1) {
            Ok(result) => return result,
            // A rejected step contributes only the sweeps of its solves to the result.
            Err(given_up) => result.report = result.report.after(given_up),
        }
    }
    let result = stage.in_pieces(substeps, settings, result, |stage, settings, result| {
        prepare(stage, settings);
        if let Ok(piece) = try_step(stage, settings, memory, true) {
            result.add(piece);
        }
    });
    if circling || memory.restless {
        memory.longest_step_secs = longest_step_secs.or(memory.longest_step_secs);
    }
    result
}

/// Computes the shocks (collisions) with which the next step begins. Then sets up the first contact problem after these
/// shocks, with gravity and bonds.
pub(super) fn set_up<M: Model>(
    stage: &mut Stage<'_, M>,
    settings: &Settings,
    memory: &mut RangeMemory,
) {
    prepare(stage, settings);
    let StepCut { substeps, whole_first, .. } = StepCut::of(stage.state, settings, memory.restless);
    let first = settings.over(settings.parameters.time_step_secs / f64::from(substeps));
    let first = if whole_first { *settings } else { first };
    prepare(stage, &first);
    shocks::pass(stage, &mut memory.shocks, &first);
}

/// Detects the contacts and sets up the contact problem of a step, in which a gap may close by no more than its size.
/// Bounces are computed separately, with the shocks (collisions).
pub(super) fn prepare<M: Model>(stage: &mut Stage<'_, M>, settings: &Settings) {
    let time_step_secs = settings.parameters.time_step_secs;
    let touch = TOUCH_IN_DIAMETERS * stage.world().mean_diameter;
    let ahead = |state: &State| Some(look_ahead(state, time_step_secs));
    let rebound = |Approach { gap, .. }| (gap - touch).positive_part() / time_step_secs;
    stage.prepare_ahead(settings, ahead, rebound);
}

/// Solves the contact problem that [`prepare`] has set up, with its bonds, and moves the grains. If `may_break` is
/// false and a bond is about to break, moves no grain and returns the report of the solves as an error.
fn try_step<M: Model>(
    stage: &mut Stage<'_, M>,
    settings: &Settings,
    memory: &mut RangeMemory,
    may_break: bool,
) -> Result<StepResult, SolveReport> {
    let mut result = solve_range(stage, memory, settings, may_break)?;
    let bonds = result.bonds.take();
    result.add(StepResult { bonds, ..stage.move_by(SolveReport::nothing_yet(), settings) });
    memory.shocks.shift(&mut stage.state.world);
    separate::<M>(stage.state);
    Ok(result)
}

/// Largest number of passes over the contacts that move overlapping grains apart after a step. A pass that separates a
/// pair may push its grains into other grains, so an overlap moves through the pile, by at least one layer of grains
/// per pass.
const PASSES: u32 = 8;

/// Moves grains apart that overlap by more than [`TOUCH_IN_DIAMETERS`] mean diameters, in at most [`PASSES`] passes
/// over the contacts. No larger overlap needs to remain, because under the contact law `range` bonds exist without
/// overlap.
pub(super) fn separate<M: Model>(state: &mut State) {
    let State { world, contacts, candidates, .. } = state;
    let allowed = TOUCH_IN_DIAMETERS * world.mean_diameter;
    for _ in 0..PASSES {
        if !contacts.separate(world, candidates, allowed, M::AXES) {
            break;
        }
    }
}

/// Opening speed that the rotation of a bonded pair causes in a step, divided by the escape speed of the bond (the
/// smallest opening speed after a collision at which the bond breaks), above which the step is divided into substeps.
/// With a larger value, grains that circle each other separate too early; with a smaller value, steps are divided
/// without need.
const MOST_OF_ESCAPE_SPEED: f64 = 0.5;

/// True if the two grains of a bond circle each other so fast that a step of this length would treat the rotation of
/// the contact normal as a shock (a sudden change of velocity). `pull` is the cohesion force divided by the effective
/// mass, C₀/m_ij, m/s², and `distance` is the debonding distance δ_c, m.
///
/// **Why such pairs need substeps.** A step takes the contact normal from its beginning. If two grains circle each
/// other with the tangential velocity v_t, with their centres at the distance L, the normal turns by v_tΔt/L in a step.
/// At the beginning of the next step the grains separate with the speed
///
/// > v = v_t²Δt/L
///
/// along the new normal. In reality, the circular motion is a load v_t²/L on the bond, spread evenly over the step. But
/// in the next step the speed v looks like the result of a shock, and a bond only stops a shock below its escape speed
/// √(2C₀δ_c/m_ij). So in a long step a pair separates although its bond would hold it. In substeps v decreases with Δt,
/// and the escape speed stays the same.
pub(super) fn circling_looks_like_a_shock(
    state: &State,
    time_step_secs: f64,
    pull: f64,
    distance: f64,
) -> bool {
    let most = MOST_OF_ESCAPE_SPEED * (2.0 * pull * distance).sqrt() / time_step_secs;
    let fixed_discs = &state.world.fixed_discs;
    let grains = &state.world.grains;
    let numbering = Numbering::of(&state.world);
    let bonds = state.contacts.contacts().iter().zip(state.contacts.bonds());
    bonds.filter(|(_, bond)| bond.alive).any(|(contact, _)| {
        let grain = contact.grain as usize;
        let (velocity, radius) = match numbering.other(contact.other) {
            Other::Grain(other) => {
                let slide = state.world.speed_of_image(grain, other) * DVec2::X;
                (grains.velocities[other] + slide, grains.radii[other])
            }
            Other::FixedDisc(disc) => {
                let surface = state.walls.surface(&state.world, contact);
                let velocity = surface.map_or(DVec2::ZERO, |surface| surface.velocity);
                (velocity, fixed_discs[disc].radius)
            }
            // A straight wall has the same normal everywhere, so a grain cannot circle it.
            Other::Feature(_) => return false,
        };
        let tangential = (grains.velocities[grain] - velocity).perp_dot(contact.normal);
        tangential * tangential > most * (grains.radii[grain] + radius)
    })
}
