//! `auto`: chooses a method by the friction model, the stopping test and the size of the problem.
//!
//! Convex problems (the friction models other than Coulomb's law, and grains without friction) are solved by the
//! interior point method, which works at any size. For other problems Newton's method is tried first, or conjugate
//! gradients if a force drives a wall. For a pile at rest Newton's method takes 2 factorisations in the median step,
//! and 22 in the first step of 10,000 grains; sweeps do not solve the steps of such a pile if its cohesion is strong.
//! For a flowing pile Newton's method takes 12 factorisations in the median step at 138 grains and more than 100 at
//! 2,000 grains. At 2,000 flowing grains sweeps leave a smaller error at the same cost, most of all over-relaxed sweeps.
//! So `auto` stops Newton's method after fewer factorisations without progress if a problem is larger, and uses
//! over-relaxed sweeps instead on a large flowing pile. With the stopping test `impulse-per-mass`, `auto` always chooses
//! Gauss–Seidel, because studies with this test are about the error of Gauss–Seidel sweeps.

use super::newton::NewtonEffort;
use super::{Memory, SolveReport, over_relaxed, solve_by, wedged};
use crate::solver::kinematics::Model;
use crate::solver::method::Method;
use crate::solver::problem::StepProblem;
use crate::solver::settings::{FrictionModel, SolverSettings, StopTest};

/// Product of the patience of Newton's method and the number of contacts of a problem: a larger problem has a smaller
/// patience. The *patience* is a number of factorisations: the method stops if the residual does not halve within it.
/// It is limited by [`LEAST_PATIENCE`] and [`MOST_PATIENCE`].
///
/// The value is based on two measurements with a time step Δt of 1e-3 s. At 2,000 flowing grains (3,900 contacts) a
/// patience of 5, 10 and 20 factorisations leaves a velocity error of 1.4e-2, 1.0e-2 and 0.8e-2 √(g d) (gravity g, mean
/// diameter d) in computing times with the ratio 1 : 2 : 3. At 138 grains (260 contacts) and Bond number 100, a
/// patience of 20 does not solve some steps that a patience of 99 solves. Because of these unsolved steps the pile
/// slumps.
const PATIENCE_OF_CONTACTS: usize = 20_000;

/// Minimum patience of Newton's method, first for problems without cohesion, then with cohesion: the method stops if
/// the residual does not halve within this number of factorisations. A cohesive contact that breaks because of an
/// unsolved step stays broken: a pile of 10,000 grains at Bond number 100 and a time step of 5e-3 s falls with a
/// patience of 5, which does not solve the first step. With a patience of 10 the first step is solved in 22
/// factorisations, and the pile does not fall.
const LEAST_PATIENCE: [usize; 2] = [5, 10];
/// Maximum patience of Newton's method: the method stops if the residual does not halve within this number of
/// factorisations. It limits the patience of problems with fewer than 200 contacts ([`PATIENCE_OF_CONTACTS`] divided by
/// this number). With a larger maximum, Newton's method spends more factorisations on problems that it cannot solve.
const MOST_PATIENCE: usize = 100;

/// Minimum number of contacts of a flowing pile that `auto` solves by over-relaxed sweeps. With fewer contacts Newton's
/// method costs less for the same error.
pub const CONTACTS_THAT_FLOW: usize = 500;
/// Fraction of the contacts between grains that must slide faster than [`SLIDING_SPEED`], at the velocities without
/// contact impulses, for a pile to count as flowing. The fraction is 0 for 2,000 grains at rest, and 0.08 to 0.3 for
/// 2,000 falling grains after the first steps.
const SLIDING_SHARE: f64 = 0.05;
/// Minimum tangential speed of a contact that counts as sliding in the decision whether a pile flows, in √(g d)
/// (gravity g, mean diameter d). With a larger speed, fewer piles count as flowing.
const SLIDING_SPEED: f64 = 0.02;

/// Maximum number of sweeps of conjugate gradients after Newton's method has failed. With 200 instead of 400 sweeps, the
/// error at 2,000 flowing grains is 1.5 times as large and the time a tenth shorter.
const SWEEPS_AFTER: u32 = 400;

/// Maximum number of sweeps of a flowing pile, three quarters of them over-relaxed. With 200 sweeps, the reported
/// velocity error is 1.3 to 1.8 times as large in the median at 500 to 2,000 grains. Conjugate gradients with 400 sweeps
/// report 1.0 to 1.5 times this error at 500 to 10,000 grains, and a run with them takes 1.3 to 1.9 times as long.
const SWEEPS_OF_FLOWING: u32 = 400;

/// Maximum number of sweeps of conjugate gradients if a force drives a wall. A larger maximum does not solve every
/// step, either: for 234 cohesive grains under shear, one step in six is still unsolved after 5,000 sweeps.
const SWEEPS_OF_DRIVEN: u32 = 1_000;

/// Returns the method that solves a problem: the method that the settings name, or if that is `auto`, the method that
/// `auto` tries first. `rubs` is true if the problem has friction or rolling friction, and `is_driven` if a force
/// drives a wall.
pub(crate) fn picked(
    settings: &SolverSettings,
    model: FrictionModel,
    rubs: bool,
    is_driven: bool,
) -> Method {
    match (settings.method, settings.stop) {
        (Method::Auto, StopTest::ImpulsePerMass) => Method::Nsgs,
        (Method::Auto, _) if model != FrictionModel::Coulomb || !rubs => Method::InteriorPoint,
        // Newton's method does not support walls that a force drives.
        (Method::Auto, _) if is_driven => Method::Nncg,
        (Method::Auto, _) => Method::Newton,
        (method, _) => method,
    }
}

/// Solves a problem with the method that `auto` chooses for it.
pub(super) fn solve<M: Model>(
    problem: &mut StepProblem<M>,
    memory: &mut Memory,
    settings: &SolverSettings,
) -> SolveReport {
    let rubs = M::FRICTION && (problem.law.friction > 0.0 || !problem.rows.rolling.is_empty());
    let method = picked(settings, problem.friction.model, rubs, problem.is_driven());
    let within =
        |sweeps: u32| SolverSettings { max_sweeps: settings.max_sweeps.min(sweeps), ..*settings };
    let (method, settings) = match method {
        Method::Newton if flows(problem) => {
            return over_relaxed::solve(problem, &within(SWEEPS_OF_FLOWING));
        }
        Method::Nncg => (method, within(SWEEPS_OF_DRIVEN)),
        _ => (method, *settings),
    };
    if method == Method::Newton && wedged::is_wedged(problem) {
        wedged::start_cold(problem);
    }
    let effort = effort(problem.rows.len(), problem.law.capture_speed() > 0.0);
    solve_by(method, problem, memory, &settings, effort)
}

/// Returns true if the problem belongs to a large flowing pile, whose problems Newton's method does not solve: the
/// problem has at least [`CONTACTS_THAT_FLOW`] contacts, and more than the fraction [`SLIDING_SHARE`] of its contacts
/// between grains would slide faster than [`SLIDING_SPEED`] without contact impulses.
fn flows<M: Model>(problem: &StepProblem<M>) -> bool {
    if problem.rows.len() < CONTACTS_THAT_FLOW {
        return false;
    }
    let fast = SLIDING_SPEED * problem.fall_speed;
    let pairs = &problem.rows.pairs;
    let sliding = pairs.iter().filter(|row| row.velocity(&problem.bodies.free)[1].abs() > fast);
    sliding.count() as f64 > SLIDING_SHARE * pairs.len() as f64
}

/// Returns the limits for a solve by Newton's method that `auto` has chosen: its patience, which depends on the number
/// of contacts, and the maximum number of sweeps of conjugate gradients if it fails. `coheres` is true if the problem
/// has cohesion.
fn effort(contacts: usize, coheres: bool) -> NewtonEffort {
    let least = LEAST_PATIENCE[usize::from(coheres)];
    let patience = (PATIENCE_OF_CONTACTS / contacts.max(1)).clamp(least, MOST_PATIENCE);
    NewtonEffort { patience: patience as u32, sweeps_after: SWEEPS_AFTER }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn auto_picks_by_model_stop_friction_and_drives_and_nothing_else_is_changed() {
        let auto = SolverSettings::default();
        let coulomb = |rubs, is_driven| picked(&auto, FrictionModel::Coulomb, rubs, is_driven);
        assert_eq!(coulomb(true, false), Method::Newton);
        assert_eq!(coulomb(true, true), Method::Nncg);
        assert_eq!(coulomb(false, false), Method::InteriorPoint);
        assert_eq!(coulomb(false, true), Method::InteriorPoint);
        let of = |settings| picked(&settings, FrictionModel::Tresca, true, false);
        assert_eq!(of(auto), Method::InteriorPoint);
        let of_a_sweep = SolverSettings { stop: StopTest::ImpulsePerMass, ..auto };
        assert_eq!(of(of_a_sweep), Method::Nsgs);
        let said = SolverSettings { method: Method::Jacobi, ..auto };
        assert_eq!(of(said), Method::Jacobi);
    }

    #[test]
    fn newtons_method_is_given_up_earlier_on_large_problems() {
        let dry = |contacts| effort(contacts, false).patience;
        assert_eq!([0, 3, 260, 1_000, 4_000, 200_000].map(dry), [100, 100, 76, 20, 5, 5]);
        let cohesive = |contacts| effort(contacts, true).patience;
        assert_eq!([260, 1_000, 4_000, 200_000].map(cohesive), [76, 20, 10, 10]);
    }
}
