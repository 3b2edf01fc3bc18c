//! Telling a solve that has stalled from one that was stopped too early.
//!
//! Restitution's term ρ v^{n−1} can ask of wedged contacts what their neighbours forbid. Such a
//! problem has no solution: the residual of any iteration comes down to a floor and stays there,
//! while impulses drift on. A problem that is merely slow to solve shows in twice the sweeps a
//! residual that is clearly smaller: at 1e5 sweeps for eight digits still by a third from 2,048
//! sweeps to 4,096. So the residual is looked at each time the number of sweeps has doubled.
//!
//! A stall is a statement on a method: where Gauss–Seidel stalls, Newton's method finds a solution
//! now and then, and only where all stall is there a floor.

use crate::solver::settings::{SolverSettings, StopTest};

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
    /// Looks at the residual after a number of sweeps, now and then only. Tells whether to stop:
    /// where a residual is aimed at, nothing is gained by more sweeps. Other stopping tests are
    /// those of published schemes, which sweep on.
    pub(super) fn look(
        &mut self,
        sweeps: u32,
        settings: &SolverSettings,
        residual: impl FnOnce() -> f64,
    ) -> bool {
        if sweeps < self.next_look {
            return false;
        }
        self.next_look = 2 * sweeps;
        self.looks = [self.looks[1], residual()];
        let is_flat = self.looks[1] >= FLAT * self.looks[0];
        self.in_vain = if is_flat { self.in_vain + 1 } else { 0 };
        self.in_vain >= LOOKS_IN_VAIN && settings.stop == StopTest::Residual
    }

    /// Whether a solve that was given up after so many sweeps with this residual had stalled.
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

    fn watched(stop: StopTest, sweeps: u32, residual: impl Fn(u32) -> f64) -> (u32, bool) {
        let settings = SolverSettings { stop, ..SolverSettings::default() };
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
