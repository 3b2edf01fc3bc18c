//! How a step under the law `range` is solved (`contact::range`).
//!
//! A bond's bound depends on two things that only a solution tells: the speed v at which it opens once
//! the shocks of the step have gone through, and the load J on it. So a step is solved more than once,
//! always by the same method and through the same rows.
//!
//! 1. **Shocks** (`range::shocks`), in which a bond, whose force is finite, can do nothing, give v.
//! 2. **The step** from the velocities after them, with gravity, every bond pulling with up to C₀Δt.
//! 3. **Breaks.** The solution tells the loads. Bonds that would have been opened by δ_c before the
//!    end of the step get the impulse of the time that they live, and the step is solved again, from
//!    where it was, until no bond's bound falls. Bounds never rise again, so this ends.
//!
//! **Restless bonds.** One broken bond loads the next, and a step hands a load on by one bond only; a
//! long step tells of loads their mean alone. So a step says whether a bond is seen in it that would
//! break if it were half as strong, and a long one is then given up (`range`). What stands is not restless,
//! whatever load its bonds carry: where nothing moves by more than a part of δ_c, the mean of a load is
//! the load.

use serde::{Deserialize, Serialize};

use crate::contact::range::{Bond, OpeningMotion};
use crate::number::Parts;
use crate::sim::settings::Settings;
use crate::sim::steppers::range::shocks::{self, ClosedBond, Shocks};
use crate::sim::steppers::range::step_numbers::StepNumbers;
use crate::sim::stepping::{BondEnergies, Stage, StepResult};
use crate::solver::{Model, RowVelocities, SolveReport, StepProblem, for_each_row, solve};

/// Solutions of a step after which bounds are left as they are: bonds that still ask for less are few,
/// and the next step looks at them again.
const MOST_ROUNDS: u32 = 8;

/// Strength, in that of a bond, at which a bond that would break is restless.
const STRENGTH_OF_RESTLESS_BONDS: f64 = 0.5;

/// How far what stands may go in a step, in δ_c. Larger: a load that comes slowly is not seen rising; smaller: what a
/// solver's tolerance leaves of motion is taken for motion.
const STANDING_IN_DEBONDING_DISTANCES: f64 = 1e-3;

/// Part of a bound by which it has to fall to be worth another solution.
const FALL: f64 = 1e-6;

/// What the law remembers from one step to the next.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::sim) struct RangeMemory {
    #[serde(skip)]
    pub(super) shocks: Shocks,
    #[serde(skip)]
    lowered: Vec<(usize, f64)>,
    /// True where bonds were about to break in the last step.
    pub restless: bool,
    /// Where a step was too long for the bonds that were about to break in it: the longest that is not, s.
    #[serde(skip)]
    pub longest_step_secs: Option<f64>,
}

/// Solves a prepared problem, and tells the bonds what became of them. Gives what shocks, solves and bonds came to before
/// the grains move, or the work alone where a bond breaks that may not.
pub(super) fn solve_range<M: Model>(
    stage: &mut Stage<'_, M>,
    remembered: &mut RangeMemory,
    settings: &Settings,
    may_break: bool,
) -> Result<StepResult, SolveReport> {
    let passed = shocks::pass(stage, &mut remembered.shocks, settings);
    let mut result = passed.unwrap_or_else(StepResult::nothing_yet);
    let numbers = StepNumbers::of(stage.world(), settings);
    let RangeMemory { shocks, lowered, restless, .. } = remembered;
    let Stage { state, problem, memory, .. } = stage;
    let fastest = state.fastest();
    let contacts = &mut state.contacts;
    let mut round = 0;
    loop {
        round += 1;
        result.report.add(solve(problem, memory, &settings.solver));
        let limits = BondLimits { bonds: contacts.bonds(), shocks, numbers };
        if round == 1 {
            *restless |= limits.is_restless::<M>(problem, fastest, lowered);
            if !may_break && *restless {
                return Err(result.report);
            }
        }
        limits.lowered::<M>(problem, 1.0, lowered);
        if lowered.is_empty() || round == MOST_ROUNDS {
            break;
        }
        shorten(problem, lowered);
    }
    shocks.finish(problem, contacts);
    result.bonds = Some(update_bonds(problem, contacts.bonds_mut(), shocks, numbers));
    Ok(result)
}

/// How a bond opens in a step, or in what a shock that closed it has left of the step.
struct BondOpening {
    /// The part of the step.
    part: f64,
    /// True where a shock closed it.
    is_closed: bool,
    /// v at the beginning, m/s.
    speed: f64,
    /// J, m/s.
    load: f64,
    /// The bond's own impulse, m/s.
    impulse: f64,
}

impl BondOpening {
    /// That of a row which tells of a bond. Other forces are even over the whole step, so that a part of it
    /// has that part of them.
    fn of<M: Model>(
        problem: &StepProblem<M>,
        number: usize,
        motion: &RowVelocities,
        shocks: &Shocks,
    ) -> Self {
        let row = problem.rows.get(number);
        let closed = shocks.closed(number);
        let ClosedBond { part, gained } = closed.unwrap_or(ClosedBond { part: 1.0, gained: 0.0 });
        let [impulse, _] = problem.reduced_impulse(number, row);
        let [now, before] = [motion.now, motion.before].map(|[normal, _]| normal);
        let [wall_before, wall_gained] = problem.wall_speed_and_gain(number);
        Self {
            part,
            is_closed: closed.is_some(),
            speed: before - wall_before + gained,
            load: part * (now - before - impulse - wall_gained),
            impulse,
        }
    }

    /// (v + v^n)/2, m/s.
    fn opening_speed(&self) -> f64 {
        self.speed + 0.5 * (self.load + self.impulse)
    }
}

/// Tells the bonds, one a contact, what the solved step has made of them.
fn update_bonds<M: Model>(
    problem: &StepProblem<M>,
    bonds: &mut [Bond],
    shocks: &Shocks,
    numbers: StepNumbers,
) -> BondEnergies {
    let StepNumbers { time_step_secs, debonding_distance, .. } = numbers;
    let mut energies = BondEnergies::default();
    for_each_row(problem, |number, row, motion| {
        let bond = &mut bonds[problem.rows.contacts[number] as usize];
        let cohesion_force = row.effective_mass * problem.law.capture_speed() / time_step_secs;
        let opens = BondOpening::of(problem, number, &motion, shocks);
        let opening_speed = opens.opening_speed();
        let before = if bond.alive { cohesion_force * bond.stretch } else { 0.0 };
        if opens.is_closed || row.shifted_impulse > 0.0 {
            *bond = Bond { alive: true, stretch: 0.0 };
        }
        let was_alive = bond.alive;
        if bond.alive && row.shifted_impulse <= 0.0 {
            let opened = bond.stretch + opens.part * opening_speed * time_step_secs;
            bond.stretch = opened.positive_part();
            let broken = problem.capture(number) < opens.part * problem.law.capture_speed();
            bond.alive = !broken && bond.stretch < debonding_distance;
        }
        if bond.alive {
            let stored = cohesion_force * bond.stretch;
            energies.stored += stored;
            energies.work -= stored - before;
        } else if was_alive {
            let taken = row.effective_mass * problem.capture(number) * opening_speed;
            let kept = if opens.is_closed { 0.0 } else { before };
            energies.broken += kept + taken;
            energies.work -= taken + kept - before;
        }
    });
    energies
}

/// What the bounds of a step hang on.
struct BondLimits<'a> {
    /// One a contact.
    bonds: &'a [Bond],
    shocks: &'a Shocks,
    numbers: StepNumbers,
}

impl BondLimits<'_> {
    /// True where bonds are about to break in a step that has been solved, at whose beginning the fastest grain or
    /// wall had that speed (m/s).
    fn is_restless<M: Model>(
        &self,
        problem: &StepProblem<M>,
        fastest: f64,
        lowered: &mut Vec<(usize, f64)>,
    ) -> bool {
        self.lowered::<M>(problem, STRENGTH_OF_RESTLESS_BONDS, lowered);
        if lowered.is_empty() || !self.stands(problem, fastest) {
            return !lowered.is_empty();
        }
        self.lowered::<M>(problem, 1.0, lowered);
        !lowered.is_empty()
    }

    /// True where nothing moved when the step began, and no pair moves apart or along in it.
    fn stands<M: Model>(&self, problem: &StepProblem<M>, fastest: f64) -> bool {
        let StepNumbers { time_step_secs, debonding_distance, .. } = self.numbers;
        let still = STANDING_IN_DEBONDING_DISTANCES * debonding_distance / time_step_secs;
        let mut speed = fastest;
        for_each_row(problem, |_, _, motion| {
            speed = motion.now.into_iter().fold(speed, |most, now| most.max(now.abs()));
        });
        speed <= still
    }

    /// Finds rows with bounds (m/s) below those that they have: bonds that do not live to the end of the
    /// step, were they of `strength` times their own.
    fn lowered<M: Model>(
        &self,
        problem: &StepProblem<M>,
        strength: f64,
        lowered: &mut Vec<(usize, f64)>,
    ) {
        lowered.clear();
        if problem.rows.captures.is_empty() {
            return;
        }
        let StepNumbers { time_step_secs, debonding_distance, .. } = self.numbers;
        for_each_row(problem, |number, _, motion| {
            let before = strength * problem.capture(number);
            if before <= 0.0 {
                return;
            }
            let bond = self.bonds[problem.rows.contacts[number] as usize];
            let opens = BondOpening::of(problem, number, &motion, self.shocks);
            let stretch = if opens.is_closed { 0.0 } else { bond.stretch };
            let left = (debonding_distance - stretch).positive_part();
            let opening = OpeningMotion { left, speed: opens.speed, load: opens.load };
            let capture_speed = strength * opens.part * problem.law.capture_speed();
            let bound = opening.bound(capture_speed, opens.part * time_step_secs);
            if bound < (1.0 - FALL) * before {
                lowered.push((number, bound));
            }
        });
    }
}

/// Lowers the bounds of bonds that do not live to the end of the step.
fn shorten<M: Model>(problem: &mut StepProblem<M>, lowered: &[(usize, f64)]) {
    for &(number, bound) in lowered {
        let before = std::mem::replace(&mut problem.rows.captures[number], bound);
        let row = problem.rows.get_mut(number);
        row.shifted_impulse = (row.shifted_impulse - before + bound).positive_part();
    }
    problem.form_velocities();
}
