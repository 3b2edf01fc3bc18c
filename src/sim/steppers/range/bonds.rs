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
//! break if it were half as strong, and a long one is then given up (`range`).

use serde::{Deserialize, Serialize};

use super::numbers::StepNumbers;
use super::shocks;
use crate::contact::range::{Bond, Opening};
use crate::sim::settings::Settings;
use crate::sim::stepping::{BondEnergies, Stage};
use crate::solver::{
    Kinematics, Measures, Model, SolveReport, StepProblem, for_each_row, relative_velocities, solve,
};

/// Solutions of a step after which bounds are left as they are: bonds that still ask for less are few,
/// and the next step looks at them again.
const MOST_ROUNDS: u32 = 8;

/// Strength, in that of a bond, at which a bond that would break is restless.
const STRENGTH_OF_RESTLESS_BONDS: f64 = 0.5;

/// Part of a bound by which it has to fall to be worth another solution.
const FALL: f64 = 1e-6;

/// What the law remembers from one step to the next.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::sim) struct Memory {
    #[serde(skip)]
    shocks: shocks::Workspace,
    #[serde(skip)]
    speeds: Vec<f64>,
    #[serde(skip)]
    lowered: Vec<(usize, f64)>,
    /// Whether bonds were about to break in the last step.
    pub restless: bool,
}

/// What solving a step came to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solved {
    pub report: SolveReport,
    /// Works of the shocks, and the residual of theirs.
    pub of_shocks: Measures,
    pub bonds: BondEnergies,
    /// False where a bond breaks that may not.
    pub done: bool,
}

/// Solves a prepared problem, and tells the bonds what became of them; or gives up where a bond breaks
/// that may not.
pub(super) fn solve_range<M: Model>(
    stage: &mut Stage<'_, M>,
    remembered: &mut Memory,
    settings: &Settings,
    may_break: bool,
) -> Solved {
    let mut report = SolveReport::nothing_yet();
    let of_shocks = pass_shocks(stage, remembered, settings, &mut report);
    let numbers = StepNumbers::of(stage.world(), settings);
    let StepNumbers { time_step_secs, debonding_distance, .. } = numbers;
    let Memory { shocks, speeds, lowered, restless } = remembered;
    let Stage { state, problem, memory } = stage;
    let contacts = &mut state.contacts;
    let mut round = 0;
    loop {
        round += 1;
        report.add(solve::<M>(problem, memory, &settings.solver));
        let bonds = contacts.bonds();
        let limits = Limits { bonds, speeds, debonding_distance, time_step_secs };
        if round == 1 {
            limits.lowered::<M>(problem, STRENGTH_OF_RESTLESS_BONDS, lowered);
            *restless |= !lowered.is_empty();
            if !may_break && *restless {
                let bonds = BondEnergies::default();
                return Solved { report, of_shocks, bonds, done: false };
            }
        }
        limits.lowered::<M>(problem, 1.0, lowered);
        if lowered.is_empty() || round == MOST_ROUNDS {
            break;
        }
        shorten(problem, lowered);
    }
    let bonds = update_bonds(problem, contacts.bonds_mut(), shocks, speeds, numbers);
    Solved { report, of_shocks, bonds, done: true }
}

/// Tells the bonds, one a contact, what the solved step has made of them. `speeds` are those after the
/// shocks.
fn update_bonds<K: Kinematics>(
    problem: &StepProblem<K>,
    bonds: &mut [Bond],
    shocks: &shocks::Workspace,
    speeds: &[f64],
    numbers: StepNumbers,
) -> BondEnergies {
    let StepNumbers { time_step_secs, debonding_distance, touch, .. } = numbers;
    let mut energies = BondEnergies::default();
    for_each_row(problem, |number, row, motion| {
        let bond = &mut bonds[problem.contact_of_row[number] as usize];
        let cohesion_force = row.effective_mass * problem.capture_speed / time_step_secs;
        let now = motion.now[0] - problem.wall_speed(number);
        let opening_speed = 0.5 * (speeds[number] + now);
        let was_alive = bond.alive;
        let before = if was_alive { cohesion_force * bond.stretch } else { 0.0 };
        // A pair that was to meet may have been kept apart by the step after all.
        let gap_left = (motion.now[0] + row.restitution_velocity) * time_step_secs;
        let was_struck = shocks.struck.get(number).is_some_and(|&impulse| impulse > 0.0);
        let meets = was_struck && gap_left <= touch;
        if row.shifted_impulse > 0.0 || (meets && !was_alive) {
            *bond = Bond { alive: true, stretch: 0.0 };
        } else if bond.alive {
            bond.stretch = (bond.stretch + opening_speed * time_step_secs).max(0.0);
            let broken = problem.capture(number) < problem.capture_speed;
            bond.alive = !broken && bond.stretch < debonding_distance;
        }
        if bond.alive {
            let stored = cohesion_force * bond.stretch;
            energies.stored += stored;
            energies.work -= stored - before;
        } else if was_alive {
            let taken = row.effective_mass * problem.capture(number) * opening_speed;
            energies.broken += before + taken;
            energies.work -= taken;
        }
    });
    energies
}

/// Takes a prepared problem through its shocks, and notes the speeds after them.
pub(super) fn pass_shocks<M: Model>(
    stage: &mut Stage<'_, M>,
    remembered: &mut Memory,
    settings: &Settings,
    report: &mut SolveReport,
) -> Measures {
    let numbers = StepNumbers::of(stage.world(), settings);
    let Stage { problem, memory, .. } = stage;
    let Memory { shocks, speeds, .. } = remembered;
    let passed = shocks::pass::<M>(problem, memory, shocks, numbers, &settings.solver);
    relative_velocities(problem, &problem.before, speeds);
    let Some(passed) = passed else { return Measures::default() };
    report.add(passed.report);
    passed.measures
}

/// What the bounds of a step hang on.
struct Limits<'a> {
    /// One a contact.
    bonds: &'a [Bond],
    /// Speeds after the shocks, m/s, one a row.
    speeds: &'a [f64],
    /// δ_c, m.
    debonding_distance: f64,
    time_step_secs: f64,
}

impl Limits<'_> {
    /// Finds rows with bounds (m/s) below those that they have: bonds that do not live to the end of the
    /// step, were they of `strength` times their own.
    fn lowered<M: Model>(
        &self,
        problem: &StepProblem<M::Kinematics>,
        strength: f64,
        lowered: &mut Vec<(usize, f64)>,
    ) {
        lowered.clear();
        if problem.captures.is_empty() {
            return;
        }
        for_each_row(problem, |number, row, motion| {
            let before = strength * problem.capture(number);
            let speed = self.speeds[number];
            let [impulse, _] = problem.reduced_impulse(number, row);
            let stretch = self.bonds[problem.contact_of_row[number] as usize].stretch;
            let left = (self.debonding_distance - stretch).max(0.0);
            let now = motion.now[0] - problem.wall_speed(number);
            let opening = Opening { left, speed, load: now - speed - impulse };
            let bound = opening.bound(strength * problem.capture_speed, self.time_step_secs);
            if before > 0.0 && bound < (1.0 - FALL) * before {
                lowered.push((number, bound));
            }
        });
    }
}

/// Lowers the bounds of bonds that do not live to the end of the step.
fn shorten<K: Kinematics>(problem: &mut StepProblem<K>, lowered: &[(usize, f64)]) {
    let fixed_count = problem.fixed_rows.len();
    for &(number, bound) in lowered {
        let before = std::mem::replace(&mut problem.captures[number], bound);
        let row = if number < fixed_count {
            &mut problem.fixed_rows[number]
        } else {
            &mut problem.pair_rows[number - fixed_count]
        };
        row.shifted_impulse = (row.shifted_impulse - before + bound).max(0.0);
    }
    problem.form_velocities();
}
