//! `auto`: a method by what a step is solved under, how its solve is stopped, and how large it is.
//!
//! Convex problems (the models of friction, and grains without friction) are solved by the interior point, which solves
//! them at any size. Under Coulomb's law Newton's method is tried first: a pile at rest takes it 2 factorisations in the
//! median step, and 22 in the first of 10,000 grains, and sweeps do not solve such a pile if its bonds are strong. A
//! flowing pile takes it 12 factorisations in the median at 138 grains and more than 100 at 2,000. There conjugate
//! gradients give a smaller error for their cost, so Newton's method is given up the earlier the larger a problem is, and
//! not tried if the pile is large and flows.
//! A stop by the impulses of one sweep belongs to Gauss–Seidel, whose error is the subject of such a study.

use super::newton::NewtonEffort;
use super::{Memory, SolveReport, solve_by, wedged};
use crate::solver::kinematics::Model;
use crate::solver::method::Method;
use crate::solver::problem::StepProblem;
use crate::solver::settings::{FrictionModel, SolverSettings, StopTest};

/// Newton's method is given up after this number over the number of contacts, in factorisations that did not halve the
/// residual, within [`LEAST_PATIENCE`] and [`MOST_PATIENCE`].
///
/// Measured at Δt of 1e-3 s: at 2,000 flowing grains (3,900 contacts) a patience of 5, 10 and 20 factorisations leaves an error
/// of 1.4e-2, 1.0e-2 and 0.8e-2 √(g d) in relative times of 1, 2 and 3. At 138 grains (260 contacts) and Bond 100 a patience
/// of 20 leaves steps unsolved that one of 99 solves, and the pile slumps for it.
const PATIENCE_OF_CONTACTS: usize = 20_000;

/// The least patience without cohesion and with it, and the most. A bond that an unsolved step breaks stays broken: a pile of 10,000 grains
/// at Bond 100 and 5e-3 s falls with a patience of 5, which gives up its first step, and stands with 10, which solves that by 22
/// factorisations.
const LEAST_PATIENCE: [usize; 2] = [5, 10];
const MOST_PATIENCE: usize = 100;

/// `auto` sweeps a pile that flows from this number of contacts on. Below it Newton's method costs less for the same error.
pub const CONTACTS_THAT_FLOW: usize = 500;
/// A pile flows if more than this share of the contacts between grains slide faster than [`SLIDING_SPEED`] when its step
/// begins. Of 2,000 standing grains none do, of 2,000 falling grains 0.08 to 0.3 after the first steps.
const SLIDING_SHARE: f64 = 0.05;
/// The speed of a sliding contact, in √(g d).
const SLIDING_SPEED: f64 = 0.02;

/// Sweeps of conjugate gradients if Newton's method did not solve a step. 200 instead of 400 leave 1.5 times the error at 2,000
/// flowing grains, and save a tenth of the time.
const SWEEPS_AFTER: u32 = 400;

/// Sweeps of conjugate gradients if a force drives a wall: 234 cohesive grains under shear leave one step in six unsolved after
/// 5,000 of them.
const SWEEPS_OF_DRIVEN: u32 = 1_000;

/// The method that solves a problem under a model of friction, with friction (`rubs`) or without, with walls that a force
/// drives or without: that of the settings, unless they leave it to `auto`.
pub(crate) fn picked(
    settings: &SolverSettings,
    model: FrictionModel,
    rubs: bool,
    is_driven: bool,
) -> Method {
    match (settings.method, settings.stop) {
        (Method::Auto, StopTest::ImpulsePerMass) => Method::Nsgs,
        (Method::Auto, _) if model != FrictionModel::Coulomb || !rubs => Method::InteriorPoint,
        // Newton's method does not take walls that a force drives.
        (Method::Auto, _) if is_driven => Method::Nncg,
        (Method::Auto, _) => Method::Newton,
        (method, _) => method,
    }
}

/// Solves a problem by the method that is picked for it.
pub(super) fn solve<M: Model>(
    problem: &mut StepProblem<M>,
    memory: &mut Memory,
    settings: &SolverSettings,
) -> SolveReport {
    let rubs = M::FRICTION && problem.law.friction > 0.0;
    let method = picked(settings, problem.friction.model, rubs, problem.is_driven());
    let within =
        |sweeps: u32| SolverSettings { max_sweeps: settings.max_sweeps.min(sweeps), ..*settings };
    let (method, settings) = match method {
        Method::Newton if flows(problem) => (Method::Nncg, within(SWEEPS_AFTER)),
        Method::Nncg => (method, within(SWEEPS_OF_DRIVEN)),
        _ => (method, *settings),
    };
    if method == Method::Newton && wedged::is_wedged(problem) {
        wedged::start_cold(problem);
    }
    let effort = effort(problem.rows.len(), problem.law.capture_speed() > 0.0);
    solve_by(method, problem, memory, &settings, effort)
}

/// True of a large pile that flows, whose step Newton's method does not solve.
fn flows<M: Model>(problem: &StepProblem<M>) -> bool {
    if problem.rows.len() < CONTACTS_THAT_FLOW {
        return false;
    }
    let fast = SLIDING_SPEED * problem.fall_speed;
    let pairs = &problem.rows.pairs;
    let sliding = pairs.iter().filter(|row| row.velocity(&problem.bodies.free)[1].abs() > fast);
    sliding.count() as f64 > SLIDING_SHARE * pairs.len() as f64
}

/// How long `auto` tries to solve a problem of this number of contacts, with cohesion or without.
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
