//! When a solve stops, and how it ended.
//!
//! **A solve that has stalled** is to be told from one that was stopped too early.
//! Restitution's term ρ v^{n−1} can ask of wedged contacts what their neighbours forbid. Such a
//! problem has no solution: the residual of any iteration comes down to a floor and stays there,
//! while impulses drift on. A problem that is merely slow to solve shows in twice the sweeps a
//! residual that is clearly smaller: at 1e5 sweeps for eight digits still by a third from 2,048
//! sweeps to 4,096. So the residual is looked at each time the number of sweeps has doubled.
//!
//! A stall is a statement on a method: where Gauss–Seidel stalls, Newton's method finds a solution
//! now and then, and only where all stall is there a floor.

use super::sweep::ImpulseChange;
use crate::solver::onlooker::{SolveProgress, is_ended};
use crate::solver::problem::VelocityError;
use crate::solver::settings::{SolverSettings, StopTest};

/// How a solve ended.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolveReport {
    /// Sweeps done; iterations where the method has no sweeps.
    pub sweeps: u32,
    /// Matrices factorised.
    pub factorisations: u32,
    /// True where the stopping test was met.
    pub converged: bool,
    /// True where a solve that did not converge had stalled, rather than being stopped too early.
    pub stalled: bool,
}

impl SolveReport {
    /// Of solves that are still to come.
    pub(crate) fn nothing_yet() -> Self {
        Self { converged: true, ..Self::default() }
    }

    /// Counts another solve of the same step. The step has stalled where one of them has.
    pub fn add(&mut self, other: Self) {
        self.sweeps += other.sweeps;
        self.factorisations += other.factorisations;
        self.converged &= other.converged;
        self.stalled |= other.stalled;
    }

    /// The same with the work of solves that came before, and of whose outcome nothing is left.
    pub(crate) fn after(self, earlier: Self) -> Self {
        Self {
            sweeps: self.sweeps + earlier.sweeps,
            factorisations: self.factorisations + earlier.factorisations,
            ..self
        }
    }
}

/// After this many sweeps the stopping test is made only after every [`TEST_INTERVAL`]th: a sweep
/// that also measures itself costs more. A smaller number makes well-started steps dearer.
const SWEEPS_TESTED_EACH: u32 = 16;
/// Sweeps between two tests of a long solve; the most that are done in vain.
const TEST_INTERVAL: u32 = 8;

/// True where the stopping test is made after sweep (or iteration) number `sweeps`, counted from 1.
pub(super) fn is_tested(sweeps: u32, settings: &SolverSettings) -> bool {
    sweeps <= SWEEPS_TESTED_EACH
        || sweeps.is_multiple_of(TEST_INTERVAL)
        || sweeps == settings.max_sweeps
        || settings.stop == StopTest::ImpulsePerMass
}

/// Sweeps over `problem` until `sweep`, which is given the number of the sweep from 1, says that the
/// stopping test is met, until nothing is gained any more, or up to the limit.
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

/// True where the stopping test is met after a sweep that made this change, by a mean mass (kg) of the
/// grains, by Σ P² ((N·s)²), by the residual, or by the velocities' error.
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
        // An infinite change is no larger than infinite impulses, and settles nothing.
        StopTest::RelativeChange => {
            change.squared.is_finite()
                && change.squared <= tolerance * tolerance * squared_impulses(problem)
        }
        StopTest::ImpulsePerMass => change.absolute <= tolerance * mean_mass,
        StopTest::Residual => residual(problem) <= tolerance,
        StopTest::VelocityError => velocity_error(problem).is_within(tolerance),
    }
}

/// The first look, in sweeps. Earlier, all problems look alike.
const FIRST_LOOK: u32 = 512;
/// A residual above this share of the one at half as many sweeps has stopped falling.
const FLAT: f64 = 0.95;
/// Looks in a row without a fall after which a solve that aims at a residual ends. With one, a
/// solve that pauses on its way is ended too.
const LOOKS_IN_VAIN: u32 = 2;

/// What is known of the residual along a solve.
#[derive(Clone, Copy, Debug)]
pub(super) struct StallWatch {
    next_look: u32,
    /// Residuals of the last two looks, the older one first.
    looks: [f64; 2],
    in_vain: u32,
}

impl Default for StallWatch {
    fn default() -> Self {
        Self { next_look: FIRST_LOOK, looks: [f64::INFINITY; 2], in_vain: 0 }
    }
}

impl StallWatch {
    /// Looks at the residual after a number of sweeps, now and then only. Tells whether to stop: an onlooker may ask
    /// for it, and a solve that aims at a residual may gain nothing by more sweeps. Other stopping tests are those of
    /// published schemes, which sweep on.
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

    /// True where a solve that was given up after so many sweeps with this residual had stalled.
    /// Compared is the last look at no more than half as many sweeps.
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
