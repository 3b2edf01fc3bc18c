//! A step under the law `range` (`contact::range`): contacts are found ahead, the step is solved with its bonds
//! (`range::bonds`), in substeps if bonds break or grains move far, and overlaps are pushed out.
//!
//! **Substeps** have two reasons.
//!
//! * A step is long compared with the time √(2δ_c m_ij/C₀) of a break, and bonds are restless. A pile at rest, or
//!   without restless bonds, is stepped at full length. If bonds were restless in the step before, as a whole or in any
//!   of its pieces, or if bonded pairs circle fast ([`circling_looks_like_a_shock`]), the next step is divided without
//!   a trial as a whole. If sixteen substeps are too long for a break, the step reports this, with the longest step
//!   that would not be (`sim::alarm`).
//! * Grains move far. A contact's normal is that of the beginning of the step, so the constraint
//!   v_n + gap/Δt ≥ 0 stops a grain that would have passed another one. Without cohesion, when this is the only reason
//!   for substeps, a pile would otherwise slump too little at a large Δt.

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

/// Search distances, in diameters. Pairs within the first distance that a step could close are contacts; pairs that
/// would meet within the step are contacts up to the second distance.
const AHEAD_IN_DIAMETERS: [f64; 2] = [0.25, 2.0];

/// Longest substep with restless bonds, in times of a break. If larger, weakly bonded piles hold at a large Δt,
/// because a load is transmitted by one bond per step; if smaller, it costs more.
const SUBSTEP_IN_BOND_TIMES: f64 = 0.4;

/// Largest motion of a grain in a substep, in diameters, unless this needs too many substeps. If larger, a pile
/// slumps too little at a large Δt; if smaller, it costs more.
const MOST_TRAVEL: f64 = 0.1;

/// Limit for the substeps. With more, the step would no longer be comparable to the one asked for.
const MOST_SUBSTEPS: f64 = 16.0;

/// Look-ahead of a step that has begun. The speed of the fastest grain bounds what any grain may reach.
fn look_ahead(state: &State, time_step_secs: f64) -> LookAhead {
    let world = &state.world;
    let travel = travel(state, time_step_secs);
    let [near, far] = AHEAD_IN_DIAMETERS.map(|most| most * world.mean_diameter);
    let distance = travel.min(near);
    let reach = (distance + 2.0 * travel).min(far);
    LookAhead { time_step_secs, distance, reach, in_touch: InTouch::Bonded }
}

/// Largest possible motion of a grain in a step that has begun, m.
fn travel(state: &State, time_step_secs: f64) -> f64 {
    (state.fastest() + 2.0 * state.largest_acceleration() * time_step_secs) * time_step_secs
}

/// Division of a step into substeps.
struct StepCut {
    substeps: u32,
    /// True if bonded pairs circle so fast that the step cannot be taken as a whole.
    circling: bool,
    /// True if the step is first tried as a whole.
    whole_first: bool,
    /// The longest step (s) whose substeps resolve a break, if this step is longer.
    longest_step_secs: Option<f64>,
}

impl StepCut {
    /// The division of a step that has begun. `restless` tells if bonds were restless at the end of the last step.
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

/// Takes a step, as a whole or in substeps (see the module).
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
            // Of a rejected step only the work of the solves counts.
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

/// Sets up the first problem that is solved with the loads of the step, after its shocks.
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

/// Detects the contacts and sets up the problem of a step. A gap must not close by more than itself; bounces are part
/// of the shocks.
pub(super) fn prepare<M: Model>(stage: &mut Stage<'_, M>, settings: &Settings) {
    let time_step_secs = settings.parameters.time_step_secs;
    let touch = TOUCH_IN_DIAMETERS * stage.world().mean_diameter;
    let ahead = |state: &State| Some(look_ahead(state, time_step_secs));
    let rebound = |Approach { gap, .. }| (gap - touch).positive_part() / time_step_secs;
    stage.prepare_ahead(settings, ahead, rebound);
}

/// Solves the prepared problem with its bonds and moves the grains. Fails, with the work of the solves, if a bond
/// breaks although none may.
fn try_step<M: Model>(
    stage: &mut Stage<'_, M>,
    settings: &Settings,
    memory: &mut RangeMemory,
    may_break: bool,
) -> Result<StepResult, SolveReport> {
    let mut result = stage.timed(|stage| solve_range(stage, memory, settings, may_break))?;
    let bonds = result.bonds.take();
    result.add(StepResult { bonds, ..stage.move_by(SolveReport::nothing_yet(), settings) });
    memory.shocks.shift(&mut stage.state.world);
    separate::<M>(stage.state);
    Ok(result)
}

/// Passes over the contacts after a step. Each pass moves an overlap on by at least one layer of grains.
const PASSES: u32 = 8;

/// Separates overlapping grains by a few passes, because bonds do not need overlap.
pub(super) fn separate<M: Model>(state: &mut State) {
    let State { world, contacts, candidates, .. } = state;
    let allowed = TOUCH_IN_DIAMETERS * world.mean_diameter;
    for _ in 0..PASSES {
        if !contacts.separate(world, candidates, allowed, M::AXES) {
            break;
        }
    }
}

/// Largest effect of turning in a step, as a fraction of the escape speed. If larger, circling pairs separate too
/// early; if smaller, steps are divided in vain.
const MOST_OF_ESCAPE_SPEED: f64 = 0.5;

/// True if a bonded pair circles so fast that a step of this length would treat the turn of its normal as a shock.
/// `pull` is C₀/m_ij, m/s², and `distance` is δ_c, m.
///
/// **Why such pairs need substeps.** A step takes a contact's normal from its beginning. Two grains that circle each
/// other at a distance L with v_t turn it by v_tΔt/L in a step, and at the beginning of the next step they
/// separate with
///
/// > v = v_t²Δt/L
///
/// along the new normal. This is the load v_t²/L of the circular motion, spread evenly over the step, but it looks
/// like a shock that has thrown them apart, and a bond only stops a shock below its escape speed √(2C₀δ_c/m_ij). So a
/// pair that its bond would hold separates if the step is long. In substeps v decreases with Δt, and the escape speed
/// does not.
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
            // A straight feature has the same normal everywhere.
            Other::Feature(_) => return false,
        };
        let tangential = (grains.velocities[grain] - velocity).perp_dot(contact.normal);
        tangential * tangential > most * (grains.radii[grain] + radius)
    })
}
