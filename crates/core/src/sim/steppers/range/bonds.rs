//! Solution of a step with bonds, under the law `range` (`contact::range`).
//!
//! The largest impulse of a bond (its bound) depends on two quantities of the solution: the speed v at which the bond
//! opens after the shocks (collisions) of the step, and the load J, the change of this speed in the step by all forces
//! except the force of the bond itself. So a step is solved several times, always with the same solver and the same
//! contacts.
//!
//! 1. **Shocks** (collisions, `range::shocks`) give v. Bonds have no effect in a shock, because it takes no time and
//!    their force is finite.
//! 2. **The step** is solved from the velocities after the shocks, with gravity. Each bond may pull at most with the
//!    impulse C₀Δt (cohesion force C₀, time step Δt).
//! 3. **Breaks.** The solution gives the loads. A bond that would open by the debonding distance δ_c before the end of
//!    the step breaks: its bound becomes the impulse of its force C₀ until it breaks. The step is solved again,
//!    starting from the present solution, until no bound decreases any more. Bounds never increase, so this process
//!    ends.
//!
//! **Restless bonds.** If a bond breaks, the neighbouring bonds have to bear its load. But a step passes this load on
//! only to the neighbouring bonds and no farther, and a long step computes only the mean of a load. So a step looks for
//! bonds that would break if their cohesion force were half as large. Such bonds are called restless. A long step with
//! restless bonds is rejected, and solved again in substeps (`range`). Bonds between resting grains are not restless,
//! whatever load they carry: if no grain moves by more than a small fraction of δ_c, loads are constant and equal their
//! means.

use serde::{Deserialize, Serialize};

use crate::contact::range::{Bond, OpeningMotion};
use crate::number::Parts;
use crate::sim::settings::Settings;
use crate::sim::steppers::range::shocks::{self, ClosedBond, Shocks};
use crate::sim::steppers::range::step_numbers::StepNumbers;
use crate::sim::stepping::{BondEnergies, Stage, StepResult};
use crate::solver::{Model, RowVelocities, SolveReport, StepProblem, for_each_row, solve};

/// Largest number of times that a step is solved while the bounds of its bonds (the largest impulses that they may
/// exert) are searched. After these solutions only few bonds still need a smaller bound, and the next step examines
/// them again.
const MOST_ROUNDS: u32 = 8;

/// Fraction of the cohesion force of bonds in the search for restless bonds: a bond counts as restless (about to break)
/// if it would break in the step with only this fraction of its force. With a larger value, fewer bonds count as
/// restless, so fewer steps are divided.
const STRENGTH_OF_RESTLESS_BONDS: f64 = 0.5;

/// Largest motion of a grain in a step that counts as rest, in debonding distances δ_c. With a larger value, the slow
/// increase of a load is missed; with a smaller value, errors within the solver's tolerance count as motion.
const STANDING_IN_DEBONDING_DISTANCES: f64 = 1e-3;

/// Smallest relative decrease of a bond's bound (its largest impulse) for which the step is solved again.
const FALL: f64 = 1e-6;

/// Data that the stepper `range` keeps from one step to the next.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::sim) struct RangeMemory {
    #[serde(skip)]
    pub(super) shocks: Shocks,
    #[serde(skip)]
    lowered: Vec<(usize, f64)>,
    /// True if bonds were about to break in the last step.
    pub restless: bool,
    /// Longest time step, s, for which the largest number of substeps (sixteen parts of a step) is enough to follow the
    /// bonds that were about to break; `None` if the last step was not longer than this time.
    #[serde(skip)]
    pub longest_step_secs: Option<f64>,
}

/// Solves the contact problem that `range::prepare` has set up: first its shocks (collisions), then the step with its
/// bonds. Updates the bonds, but does not move the grains, and returns the results. If `may_break` is false and a bond
/// is about to break, returns only the report of the solves, as an error.
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

/// Opening (change of the gap) of a bonded pair in a step. If a shock (collision) in the step has formed the bond, or
/// has made a stretched bond close, it is the opening in the rest of the step after that shock.
struct BondOpening {
    /// Fraction of the step that this opening covers: 1, or less if a shock (collision) within the step has formed the
    /// bond or has made its gap close; then it is the fraction after that shock.
    part: f64,
    /// True if a shock (collision) in this step has formed the bond, or has made its gap close. The stretch of the bond
    /// is then 0 after the shock.
    is_closed: bool,
    /// Opening speed v at the beginning of the step, m/s, or just after a shock (collision) in the step that has formed
    /// the bond or has made its gap close.
    speed: f64,
    /// Load J: change of the opening speed by all forces except the force of the bond itself, m/s.
    load: f64,
    /// Impulse of the bond itself, divided by the effective mass, m/s.
    impulse: f64,
}

impl BondOpening {
    /// Computes the opening of the bond of contact `number` in a solved step. All forces except the force of the bond
    /// itself are constant over the step, so their impulse in a fraction of the step is that fraction of their whole
    /// impulse.
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

    /// Returns the mean (v + v^n)/2 of the opening speeds v at the beginning and v^n at the end of this opening, m/s.
    fn opening_speed(&self) -> f64 {
        self.speed + 0.5 * (self.load + self.impulse)
    }
}

/// Updates the stretch of all bonds, and whether they exist, after a solved step. Returns the energies of the bonds.
/// `bonds` contains one bond per contact.
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

/// Data from which the bounds (largest impulses) of the bonds in a step are computed.
struct BondLimits<'a> {
    /// Bonds, one per contact.
    bonds: &'a [Bond],
    shocks: &'a Shocks,
    numbers: StepNumbers,
}

impl BondLimits<'_> {
    /// True if bonds are about to break in a solved step. `fastest` is the speed of the fastest grain or wall at the
    /// beginning of the step, m/s. The function overwrites `lowered`, which it uses as work space.
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

    /// True if no grain or wall moves at the beginning of the step, and no pair separates or slides at the end of the
    /// step, apart from motions below [`STANDING_IN_DEBONDING_DISTANCES`].
    fn stands<M: Model>(&self, problem: &StepProblem<M>, fastest: f64) -> bool {
        let StepNumbers { time_step_secs, debonding_distance, .. } = self.numbers;
        let still = STANDING_IN_DEBONDING_DISTANCES * debonding_distance / time_step_secs;
        let mut speed = fastest;
        for_each_row(problem, |_, _, motion| {
            speed = motion.now.into_iter().fold(speed, |most, now| most.max(now.abs()));
        });
        speed <= still
    }

    /// Finds the bonds that would break before the end of the step if their cohesion force were multiplied by
    /// `strength` (a number up to 1). Fills `lowered` with the numbers of their contacts and the new bounds (largest
    /// impulses) of the bonds, divided by the effective mass (m/s).
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

/// Lowers the bounds (largest impulses) of the bonds that break before the end of the step to the values in `lowered`,
/// m/s: impulses divided by the effective mass.
fn shorten<M: Model>(problem: &mut StepProblem<M>, lowered: &[(usize, f64)]) {
    for &(number, bound) in lowered {
        let before = std::mem::replace(&mut problem.rows.captures[number], bound);
        let row = problem.rows.get_mut(number);
        row.shifted_impulse = (row.shifted_impulse - before + bound).positive_part();
    }
    problem.form_velocities();
}
