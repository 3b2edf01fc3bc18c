//! How a step under the law `range` is solved (`contact::range`).
//!
//! A bond's bound depends on two things that only a solution tells: the speed v at which it opens once
//! the shocks of the step have gone through, and the load J on it. So a step is solved more than once,
//! always by the same method and through the same rows.
//!
//! 1. **Shocks** (`sim::shocks`), in which a bond, whose force is finite, can do nothing, give v.
//! 2. **The step** from the velocities after them, with gravity, every bond pulling with up to C₀Δt.
//! 3. **Breaks.** The solution tells the loads. Bonds that would have been opened by δ_c before the
//!    end of the step get the impulse of the time that they live, and the step is solved again, from
//!    where it was, until no bond's bound falls. Bounds never rise again, so this ends.
//!
//! **Restless bonds.** One broken bond loads the next, and a step hands a load on by one bond only; a
//! long step tells of loads their mean alone. So a step says whether a bond is seen in it that would
//! break if it were half as strong, and a long one is then given up (`sim::range_step`).

use super::shocks;
use crate::contact::ContactList;
use crate::contact::range::{Bond, Opening};
use crate::error::Result;
use crate::solver::{
    Kinematics, Measures, Model, SolveReport, SolverSettings, StepProblem, for_each_row,
    relative_velocities, solve,
};

/// Solutions of a step after which bounds are left as they are: bonds that still ask for less are few,
/// and the next step looks at them again.
const MOST_ROUNDS: u32 = 8;

/// Strength, in that of a bond, at which a bond that would break is restless.
const STRENGTH_OF_RESTLESS_BONDS: f64 = 0.5;

/// Part of a bound by which it has to fall to be worth another solution.
const FALL: f64 = 1e-6;

/// Memory that is kept from one step to the next.
#[derive(Clone, Debug, Default)]
pub(super) struct Workspace {
    shocks: shocks::Workspace,
    speeds: Vec<f64>,
    falls: Vec<(usize, f64)>,
    /// Whether bonds were about to break in the last step.
    pub restless: bool,
}

/// The numbers of a step that its bonds hang on.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepNumbers {
    pub time_step_secs: f64,
    /// ρ.
    pub restitution: f64,
    /// δ_c, m.
    pub debonding_distance: f64,
    /// Gaps below this are none, m.
    pub touch: f64,
    /// Whether bonds may break in it.
    pub may_break: bool,
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

/// What bonds took and gave, J.
///
/// A bond that is opened by s has taken C₀ s. It gives that back where it closes, and keeps it where
/// it breaks. So its work is −Δ(C₀ s), and that of its last step −C₀ (opening) until then, with the
/// impulse b m_ij of the time that it lived: −b m_ij ½(v⁺ + v^n), which leaves C₀δ_c in all. What a
/// contact does beyond that is the work of the grains' push on each other.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BondEnergies {
    /// Work of this step.
    pub work: f64,
    /// Σ C₀ s of the bonds that live.
    pub stored: f64,
    /// What the bonds took that broke in this step.
    pub broken: f64,
}

impl BondEnergies {
    /// Counts another substep.
    pub fn add(&mut self, other: Self) {
        let Self { work, broken, .. } = *self;
        *self = Self { work: work + other.work, broken: broken + other.broken, ..other };
    }
}

/// Solves a prepared problem, and tells the bonds what became of them; or gives up where a bond breaks
/// that may not.
pub(super) fn solve_range<M: Model>(
    problem: &mut StepProblem<M::Kinematics>,
    contacts: &mut ContactList,
    workspace: &mut Workspace,
    numbers: StepNumbers,
    settings: &SolverSettings,
) -> Result<Solved> {
    let Workspace { shocks, speeds, falls, restless } = workspace;
    let StepNumbers { time_step_secs, restitution, debonding_distance, touch, may_break } = numbers;
    let mut report = SolveReport { converged: true, ..SolveReport::default() };
    let mut of_shocks = Measures::default();
    if let Some(passed) =
        shocks::pass::<M>(problem, shocks, restitution, time_step_secs, touch, settings)?
    {
        report.add(passed.report);
        of_shocks = passed.measures;
    }
    relative_velocities(problem, &problem.before, speeds);
    let mut round = 0;
    loop {
        round += 1;
        report.add(solve::<M>(problem, settings)?);
        let bonds = contacts.bonds();
        let limits = Limits { bonds, speeds, debonding_distance, time_step_secs };
        if round == 1 {
            limits.falls::<M>(problem, STRENGTH_OF_RESTLESS_BONDS, falls);
            *restless |= !falls.is_empty();
            if !may_break && *restless {
                let bonds = BondEnergies::default();
                return Ok(Solved { report, of_shocks, bonds, done: false });
            }
        }
        limits.falls::<M>(problem, 1.0, falls);
        if falls.is_empty() || round == MOST_ROUNDS {
            break;
        }
        shorten(problem, falls);
    }
    let bonds = contacts.bonds_mut();
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
    Ok(Solved { report, of_shocks, bonds: energies, done: true })
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
    fn falls<M: Model>(
        &self,
        problem: &StepProblem<M::Kinematics>,
        strength: f64,
        falls: &mut Vec<(usize, f64)>,
    ) {
        falls.clear();
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
                falls.push((number, bound));
            }
        });
    }
}

/// Lowers the bounds of bonds that do not live to the end of the step.
fn shorten<K: Kinematics>(problem: &mut StepProblem<K>, falls: &[(usize, f64)]) {
    let fixed_count = problem.fixed_rows.len();
    for &(number, bound) in falls {
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
