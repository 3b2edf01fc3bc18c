//! Stopping tests of the solver's methods, and the report of a solve.
//!
//! **A stalled solve** must be distinguished from a solve that was stopped too early. The restitution term (restitution
//! times the velocity before the step) can demand velocities of wedged contacts that their neighbours do not allow.
//! Such a problem has no solution: with any method the residual falls to some value and remains there, while impulses
//! keep changing. In a problem that is merely slow to solve, doubling the number of sweeps clearly reduces the
//! residual: if a solve needs 1e5 sweeps to divide the residual by 1e8, the residual still falls by a third from 2,048
//! sweeps to 4,096. So each time the number of sweeps has doubled, the residual is compared with its value at half as
//! many sweeps.
//!
//! A stall is a property of a method: sometimes Newton's method finds a solution although Gauss–Seidel stalls. The
//! problem has no solution only if all methods stall.

use super::sweep::ImpulseChange;
use crate::solver::onlooker::{SolveProgress, is_ended};
use crate::solver::problem::VelocityError;
use crate::solver::settings::{SolverSettings, StopTest};

/// The outcome of one or more solves: work, and success or failure.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolveReport {
    /// Number of sweeps, or of iterations if the method has no sweeps.
    pub sweeps: u32,
    /// Number of factorisations of the matrix of a linear system; 0 for methods without linear systems.
    pub factorisations: u32,
    /// True if the stopping test was met: the error is within the tolerance.
    pub converged: bool,
    /// True if a solve did not converge because its residual stopped decreasing. False if the solve converged, or if a
    /// limit stopped it while the residual still decreased.
    pub stalled: bool,
}

impl SolveReport {
    /// Returns the report of a step in which no solve has been made: no sweeps, and converged, because nothing is
    /// unsolved.
    pub(crate) fn nothing_yet() -> Self {
        Self { converged: true, ..Self::default() }
    }

    /// Adds the report of another solve of the same step. The numbers of sweeps and factorisations are added. The step
    /// has converged only if all of its solves have converged, and it has stalled if one of them has stalled.
    pub fn add(&mut self, other: Self) {
        self.sweeps += other.sweeps;
        self.factorisations += other.factorisations;
        self.converged &= other.converged;
        self.stalled |= other.stalled;
    }

    /// Returns this report with the sweeps and factorisations of earlier solves of the same step added. Whether the
    /// earlier solves converged or stalled is ignored.
    pub(crate) fn after(self, earlier: Self) -> Self {
        Self {
            sweeps: self.sweeps + earlier.sweeps,
            factorisations: self.factorisations + earlier.factorisations,
            ..self
        }
    }
}

/// Number of sweeps at the beginning of a solve that are each followed by a stopping test. Of the later sweeps only
/// every [`TEST_INTERVAL`]th is tested, because a sweep that also measures its change costs more. With a smaller
/// number, steps with good initial impulses would take more sweeps than they need.
const SWEEPS_TESTED_EACH: u32 = 16;
/// Number of sweeps from one stopping test to the next, after the first sweeps of a solve, which are all tested. A
/// solve can end only at a test, so it may perform up to 7 unnecessary sweeps. With a smaller number the tests take
/// more time; with a larger number there are more unnecessary sweeps.
const TEST_INTERVAL: u32 = 8;

/// Returns true if the stopping test is made after sweep (or iteration) number `sweeps`, counted from 1.
pub(super) fn is_tested(sweeps: u32, settings: &SolverSettings) -> bool {
    sweeps <= SWEEPS_TESTED_EACH
        || sweeps.is_multiple_of(TEST_INTERVAL)
        || sweeps == settings.max_sweeps
        || settings.stop == StopTest::ImpulsePerMass
}

/// Calls `sweep` until it returns true (the stopping test is met), until the solve stalls, or up to the maximum number
/// of sweeps. The argument of `sweep` is the number of the sweep, counted from 1. `residual` returns the present
/// residual.
pub(in crate::solver) fn sweep_until_settled<P>(
    problem: &mut P,
    settings: &SolverSettings,
    mut sweep: impl FnMut(&mut P, u32) -> bool,
    residual: impl Fn(&mut P) -> f64,
) -> SolveReport {
    let mut watch = StallWatch::default();
    let mut sweeps = 0;
    while sweeps < settings.max_sweeps {
        sweeps += 1;
        if sweep(problem, sweeps) {
            return SolveReport { sweeps, converged: true, ..SolveReport::default() };
        }
        if watch.look(sweeps, settings, || residual(problem)) {
            break;
        }
    }
    let stalled = watch.has_stalled(sweeps, residual(problem));
    SolveReport { sweeps, stalled, ..SolveReport::default() }
}

/// Returns true if the stopping test of the settings is met after a sweep that changed the impulses by `change`. A test
/// on the relative change of the impulses also needs `squared_impulses`, the sum of the squared impulses of all
/// contacts ((N·s)²). A test on their change per mass needs the mean mass of the grains, `mean_mass` (kg). The two
/// tests on errors need only `residual` or `velocity_error`.
pub(super) fn is_settled<P>(
    problem: &mut P,
    change: ImpulseChange,
    mean_mass: f64,
    settings: &SolverSettings,
    squared_impulses: impl FnOnce(&mut P) -> f64,
    residual: impl FnOnce(&mut P) -> f64,
    velocity_error: impl FnOnce(&mut P) -> VelocityError,
) -> bool {
    let tolerance = settings.tolerance;
    match settings.stop {
        // An infinite change is not converged, although it is not larger than infinite impulses.
        StopTest::RelativeChange => {
            change.squared.is_finite()
                && change.squared <= tolerance * tolerance * squared_impulses(problem)
        }
        StopTest::ImpulsePerMass => change.absolute <= tolerance * mean_mass,
        StopTest::Residual => residual(problem) <= tolerance,
        StopTest::VelocityError => velocity_error(problem).is_within(tolerance),
    }
}

/// Number of sweeps after which a solve records its residual for the first time, to detect a stall. The residual is
/// recorded again each time the number of sweeps has doubled, and compared with the record before. After fewer sweeps
/// this comparison does not distinguish problems that have a solution from problems that have none.
const FIRST_LOOK: u32 = 512;
/// A residual counts as flat (no longer decreasing) if it is at least this fraction of the residual after half as many
/// sweeps. With 0.9, the residual of a slow solve would count as flat: if a solve needs 1e5 sweeps to divide the
/// residual by 1e8, the residual at 1,024 sweeps is 0.91 of the residual at 512.
const FLAT: f64 = 0.95;
/// Number of consecutive comparisons that end a solve if each finds a flat residual (hardly smaller than at half as
/// many sweeps). This applies to a solve whose stopping test limits the residual or the velocity error. With 1, a solve
/// would also end if its residual pauses and later decreases again.
const LOOKS_IN_VAIN: u32 = 2;

/// History of the residual during a solve, to detect a stall.
#[derive(Clone, Copy, Debug)]
pub(super) struct StallWatch {
    next_look: u32,
    /// The last two residuals that were recorded to detect a stall, the older one first. The newer one was recorded
    /// after twice as many sweeps as the older one. Infinite as long as there is no record.
    looks: [f64; 2],
    in_vain: u32,
}

impl Default for StallWatch {
    fn default() -> Self {
        Self { next_look: FIRST_LOOK, looks: [f64::INFINITY; 2], in_vain: 0 }
    }
}

impl StallWatch {
    /// Computes the residual each time the number of sweeps has doubled. Returns true if the solve should stop: because
    /// an onlooker (a callback that watches the progress) ends it, or because the solve has stalled and its stopping
    /// test limits the residual or the velocity error. The stopping tests that limit the change of the impulses in a
    /// sweep belong to published schemes; with them a stalled solve continues.
    pub(super) fn look(
        &mut self,
        sweeps: u32,
        settings: &SolverSettings,
        residual: impl FnOnce() -> f64,
    ) -> bool {
        if sweeps < self.next_look {
            return is_ended(SolveProgress { sweeps, residual: None });
        }
        self.next_look = 2 * sweeps;
        self.looks = [self.looks[1], residual()];
        if is_ended(SolveProgress { sweeps, residual: Some(self.looks[1]) }) {
            return true;
        }
        let is_flat = self.looks[1] >= FLAT * self.looks[0];
        self.in_vain = if is_flat { self.in_vain + 1 } else { 0 };
        self.in_vain >= LOOKS_IN_VAIN && settings.stop.judges_solutions()
    }

    /// Returns true if a solve has stalled: it ended after `sweeps` sweeps without meeting its stopping test, and
    /// `residual` is hardly smaller than the last residual that was recorded after at most half of these sweeps.
    pub(super) fn has_stalled(&self, sweeps: u32, residual: f64) -> bool {
        let last_look = self.next_look / 2;
        let before = if 2 * last_look <= sweeps { self.looks[1] } else { self.looks[0] };
        sweeps >= 2 * FIRST_LOOK && residual >= FLAT * before
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_one_of_whose_solves_stalled_has_stalled() {
        let solved = SolveReport { sweeps: 3, converged: true, ..SolveReport::default() };
        let stalled = SolveReport { sweeps: 5, stalled: true, ..SolveReport::default() };
        let mut step = solved;
        step.add(stalled);
        step.add(solved);
        assert_eq!(step, SolveReport { sweeps: 11, ..stalled });
    }

    fn watched(stop: StopTest, sweeps: u32, residual: impl Fn(u32) -> f64) -> (u32, bool) {
        let settings = SolverSettings { stop, ..SolverSettings::SWEEPS };
        let mut watch = StallWatch::default();
        for sweep in 1..=sweeps {
            if watch.look(sweep, &settings, || residual(sweep)) {
                return (sweep, watch.has_stalled(sweep, residual(sweep)));
            }
        }
        (sweeps, watch.has_stalled(sweeps, residual(sweeps)))
    }

    #[test]
    fn a_flat_residual_has_stalled_and_a_slow_one_has_not() {
        let flat = |sweep: u32| 1e-4 + (-0.02 * f64::from(sweep)).exp();
        let slow = |sweep: u32| (-18.4e-5 * f64::from(sweep)).exp();
        let paused = |sweep: u32| if sweep < 1500 { 1e-2 } else { slow(sweep - 1500) * 1e-2 };
        assert_eq!(watched(StopTest::Residual, 50_000, flat), (4096, true));
        assert_eq!(watched(StopTest::RelativeChange, 5_000, flat), (5_000, true));
        assert_eq!(watched(StopTest::Residual, 50_000, slow), (50_000, false));
        assert_eq!(watched(StopTest::RelativeChange, 5_000, slow), (5_000, false));
        assert_eq!(watched(StopTest::RelativeChange, 500, flat), (500, false));
        assert_eq!(watched(StopTest::Residual, 50_000, paused), (50_000, false));
    }
}
