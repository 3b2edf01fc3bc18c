//! Contacts that a step may come to.

use glam::DVec2;

/// Which pairs with a gap are contacts too, because they may touch within the step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LookAhead {
    /// Δt, s.
    pub time_step_secs: f64,
    /// Pairs that would come nearer than this by themselves are contacts, m.
    pub distance: f64,
    /// Farther pairs are none, m.
    pub reach: f64,
    /// Whether pairs that have touched are bonded from then on, and contacts until the bond breaks.
    pub bonds: bool,
}

impl LookAhead {
    /// The gap that a grain of that velocity (m/s) may close, m: with its own speed, but for bonds, which
    /// may be open however slow their grains are.
    pub(crate) fn way_of_grain(&self, velocity: DVec2) -> f64 {
        /// What rounding makes of a speed.
        const ROUNDING: f64 = 1.0 + 1e-9;
        match self.bonds {
            true => 0.5 * self.reach,
            false => {
                let own = self.time_step_secs * velocity.length() + self.distance;
                ROUNDING * own.min(self.reach)
            }
        }
    }

    /// The gap that what is no grain is to be seen at besides, m.
    pub(crate) fn way_of_others(&self) -> f64 {
        if self.bonds { 0.5 * self.reach } else { 0.0 }
    }
}
