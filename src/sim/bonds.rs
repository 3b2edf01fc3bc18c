//! How a step under the law `range` is solved (`contact::range`).
//!
//! A bond's bound depends on two things that only a solution tells: the speed v at which it opens once
//! the shocks of the step have gone through, and the load J on it. So a step is solved more than once,
//! always by the same method and through the same rows.
//!
//! 1. **Shocks.** Collisions are instantaneous, and in no time a bond, whose force is finite, can do
//!    nothing. The problem without cohesion and without gravity, from the velocities of the step
//!    before, gives v. Where nothing collides, v is the speed of the step before, and nothing is solved.
//! 2. **The step** from the same velocities with gravity, every bond pulling with up to C₀Δt.
//! 3. **Breaks.** The solution tells the loads. Bonds that would have been opened by δ_c before the
//!    end of the step get the impulse of the time that they live, and the step is solved again, from
//!    where it was, until no bond's bound falls. Bounds never rise again, so this ends.
//!
//! **Substeps.** One broken bond loads the next, and a step hands a load on by one bond only. Where a
//! step is long against the time √(2δ_c m_ij/C₀) of a break, it is therefore given up as soon as a bond
//! is seen in it that would break if it were half as strong, and taken in substeps. A pile that holds
//! is stepped at full length. Measured at Δt = 5e-3 s over six initial states: slump at Bond 10 and 15
//! without substeps 0.24 and 0.11, with substeps of a whole such time 0.26 and 0.12, of 0.4 of it 0.28
//! and 0.17; at Δt = 5e-5 s it is 0.31 and 0.20 (± 0.02). Without the shocks it is 0.23 at Bond 10.

use crate::contact::ContactList;
use crate::contact::range::{Bond, Opening, bond_time_secs};
use crate::error::Result;
use crate::solver::{
    Kinematics, Model, SolveReport, SolverSettings, StepProblem, for_each_row, relative_velocities,
    solve,
};
use crate::world::Parameters;

/// Solutions of a step after which bounds are left as they are: bonds that still ask for less are few,
/// and the next step looks at them again.
const MOST_ROUNDS: u32 = 8;

/// Longest substep, in times of a break.
const SUBSTEP_IN_BOND_TIMES: f64 = 0.4;

/// Strength, in that of a bond, at which no bond may break in a step that is taken as a whole. A long
/// step tells of loads their mean alone.
const STRENGTH_OF_WHOLE_STEPS: f64 = 0.5;

/// More would be a step of another order than the one asked for.
const MOST_SUBSTEPS: f64 = 16.0;

/// Part of a bound by which it has to fall to be worth another solution.
const FALL: f64 = 1e-6;

/// Substeps into which a step is cut where a bond breaks in it.
pub(super) fn substeps(parameters: &Parameters, gravity_magnitude: f64, distance: f64) -> u32 {
    let bond_time = bond_time_secs(parameters.bond, gravity_magnitude, distance);
    let substeps = parameters.time_step_secs / (SUBSTEP_IN_BOND_TIMES * bond_time);
    substeps.ceil().clamp(1.0, MOST_SUBSTEPS) as u32
}

/// Solves a prepared problem, and tells the bonds what became of them; or gives up where a bond breaks
/// and `may_break` is false. `debonding_distance` is δ_c, m.
pub(super) fn solve_range<M: Model>(
    problem: &mut StepProblem<M::Kinematics>,
    contacts: &mut ContactList,
    parameters: &Parameters,
    debonding_distance: f64,
    settings: &SolverSettings,
    may_break: bool,
) -> Result<(SolveReport, bool)> {
    let time_step_secs = parameters.time_step_secs;
    let mut report = SolveReport { converged: true, ..SolveReport::default() };
    let mut speeds = Vec::new();
    if problem.captures.is_empty() {
        relative_velocities(problem, &problem.before, &mut speeds);
    } else {
        report.add(shocks::<M>(problem, settings, &mut speeds)?);
    }
    for _ in 0..MOST_ROUNDS {
        report.add(solve::<M>(problem, settings)?);
        let bonds = contacts.bonds();
        let limits = Limits { bonds, speeds: &speeds, debonding_distance, time_step_secs };
        if !may_break {
            if limits.falls::<M>(problem, STRENGTH_OF_WHOLE_STEPS).is_empty() {
                break;
            }
            return Ok((report, false));
        }
        if !shorten(problem, &limits.falls::<M>(problem, 1.0)) {
            break;
        }
    }
    let bonds = contacts.bonds_mut();
    for_each_row(problem, |number, row, motion| {
        let bond = &mut bonds[problem.contact_of_row[number] as usize];
        if row.shifted_impulse > 0.0 {
            *bond = Bond { alive: true, stretch: 0.0 };
        } else if bond.alive {
            let now = motion.now[0] - problem.wall_speed(number);
            let opened = 0.5 * (speeds[number] + now) * time_step_secs;
            bond.stretch = (bond.stretch + opened).max(0.0);
            let broken = problem.capture(number) < problem.capture_speed;
            bond.alive = !broken && bond.stretch < debonding_distance;
        }
    });
    Ok((report, true))
}

/// Works out at what speed (m/s) each contact opens after the shocks of the step.
fn shocks<M: Model>(
    problem: &mut StepProblem<M::Kinematics>,
    settings: &SolverSettings,
    speeds: &mut Vec<f64>,
) -> Result<SolveReport> {
    relative_velocities(problem, &problem.before, speeds);
    // Against the step's own scale, as its residual is.
    let (mut violated, mut scale) = (0.0, 0.0);
    for_each_row(problem, |number, row, motion| {
        let squared_mass = row.effective_mass * row.effective_mass;
        let closing = (speeds[number] + row.restitution_velocity).min(0.0);
        let free = motion.free[0] + row.restitution_velocity;
        violated += squared_mass * closing * closing;
        scale += squared_mass * free * free;
    });
    if violated <= settings.tolerance * settings.tolerance * scale {
        return Ok(SolveReport { converged: true, ..SolveReport::default() });
    }
    let fixed = problem.fixed_rows.clone();
    let pairs = problem.pair_rows.clone();
    let captures = std::mem::replace(&mut problem.captures, vec![0.0; speeds.len()]);
    let free = std::mem::replace(&mut problem.free, problem.before.clone());
    for row in problem.fixed_rows.iter_mut().chain(&mut problem.pair_rows) {
        row.shifted_impulse = 0.0;
        row.tangential_impulse = 0.0;
    }
    problem.form_velocities();
    let report = solve::<M>(problem, settings);
    relative_velocities(problem, &problem.bodies, speeds);
    problem.free = free;
    problem.captures = captures;
    problem.fixed_rows = fixed;
    problem.pair_rows = pairs;
    problem.form_velocities();
    report
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
    /// Rows with bounds (m/s) below those that they have: bonds that do not live to the end of the
    /// step, were they of `strength` times their own.
    fn falls<M: Model>(
        &self,
        problem: &StepProblem<M::Kinematics>,
        strength: f64,
    ) -> Vec<(usize, f64)> {
        let mut falls = Vec::new();
        if problem.captures.is_empty() {
            return falls;
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
        falls
    }
}

/// Lowers the bounds of bonds that do not live to the end of the step. Whether there were any.
fn shorten<K: Kinematics>(problem: &mut StepProblem<K>, falls: &[(usize, f64)]) -> bool {
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
    if !falls.is_empty() {
        problem.form_velocities();
    }
    !falls.is_empty()
}
