//! How normal forces are distributed about their mean: P(f), f = N/⟨|N|⟩, over the contacts that bear a force.
//!
//! The mean is of |N|, since with cohesion the pulls may be as large as the pushes. Without cohesion it is the usual one.

use super::network::Network;

pub(super) struct Forces {
    /// ⟨|N|⟩, N.
    pub mean: f64,
    /// f of each contact that bears a force.
    pub over_mean: Vec<f64>,
}

impl Forces {
    pub(super) fn of(network: &Network) -> Self {
        let bearing = network.links.iter().filter(|link| link.bears);
        let forces: Vec<f64> = bearing.map(|link| link.normal_force).collect();
        let mean = mean(&forces, f64::abs);
        Self { mean, over_mean: forces.iter().map(|force| force / mean).collect() }
    }

    /// ⟨|f|^power⟩; NaN without forces.
    pub(super) fn moment(&self, power: i32) -> f64 {
        mean(&self.over_mean, |force| force.abs().powi(power))
    }

    /// Largest |f|; NaN without forces.
    pub(super) fn largest(&self) -> f64 {
        self.over_mean.iter().map(|force| force.abs()).fold(f64::NAN, f64::max)
    }

    /// Part of the forces with |f| > 1; NaN without forces.
    pub(super) fn strong_share(&self) -> f64 {
        mean(&self.over_mean, |force| f64::from(force.abs() > 1.0))
    }
}

fn mean(values: &[f64], of: impl Fn(f64) -> f64) -> f64 {
    values.iter().map(|&value| of(value)).sum::<f64>() / values.len() as f64
}
