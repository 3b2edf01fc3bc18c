//! Stresses by Love and Weber, compression positive, the fabric of contacts, and invariants of plane tensors.
//!
//! If the forces f_c at the points p_c on a body balance, its mean stress is (1/A) Σ f_c ⊗ p_c. Summed over grains
//! about their centres, each contact contributes f ⊗ ℓ. The branch ℓ joins the two centres, or a centre and the touched
//! point of a wall or a fixed disc, so the stress in walls is not included. f acts on grain i and ℓ points towards its
//! centre, so compressive forces are positive. Weight and inertia are not part of it: their mean is the stress that
//! balances them. In a plane σ is a force per length.

use glam::DVec2;

use super::network::Network;

/// Σ f ⊗ ℓ over all contacts, J.
pub(super) fn stress_of_contacts(network: &Network) -> Tensor {
    let mut sum = Tensor::default();
    for link in &network.links {
        sum.add(link.force, link.branch());
    }
    sum
}

/// The contribution of each grain to this sum, J.
pub(super) fn stress_of_grains(network: &Network) -> Vec<Tensor> {
    let mut sums = vec![Tensor::default(); network.grains.len()];
    for link in &network.links {
        sums[link.grain].add(link.force, link.own_branch);
        if let Some(other) = link.other {
            sums[other].add(link.force, link.other_branch);
        }
    }
    sums
}

/// Mean of n ⊗ n over all contacts, whether they bear a force or not; NaN without contacts.
pub(super) fn fabric(network: &Network) -> Tensor {
    let mut sum = Tensor::default();
    for link in &network.links {
        sum.add(link.normal, link.normal);
    }
    sum.over(network.links.len() as f64)
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Tensor {
    pub xx: f64,
    pub xy: f64,
    pub yx: f64,
    pub yy: f64,
}

impl Tensor {
    /// Adds a ⊗ b.
    pub(super) fn add(&mut self, a: DVec2, b: DVec2) {
        self.xx += a.x * b.x;
        self.xy += a.x * b.y;
        self.yx += a.y * b.x;
        self.yy += a.y * b.y;
    }

    /// Divides by a number.
    pub(super) fn over(self, divisor: f64) -> Self {
        let Self { xx, xy, yx, yy } = self;
        Self { xx: xx / divisor, xy: xy / divisor, yx: yx / divisor, yy: yy / divisor }
    }

    /// Mean of the two principal values.
    pub(super) fn mean(self) -> f64 {
        0.5 * (self.xx + self.yy)
    }

    /// Half the difference of the principal values of the symmetric part.
    pub(super) fn deviator(self) -> f64 {
        self.half_differences().length()
    }

    /// Direction of the larger principal value of the symmetric part, degrees from the x axis, in [0, 180); NaN if it
    /// is undefined.
    pub(super) fn direction(self) -> f64 {
        let differences = self.half_differences();
        if differences.length() > 0.0 {
            axis_degrees(0.5 * differences.to_angle())
        } else {
            f64::NAN
        }
    }

    /// (a, b) of the deviator (a b; b −a), the symmetric part minus its mean.
    fn half_differences(self) -> DVec2 {
        0.5 * DVec2::new(self.xx - self.yy, self.xy + self.yx)
    }
}

/// The direction of an axis, degrees in [0, 180), from an angle in rad.
pub(super) fn axis_degrees(angle: f64) -> f64 {
    let degrees = angle.to_degrees().rem_euclid(180.0);
    // A tiny negative angle is 180 after rounding.
    if degrees < 180.0 { degrees } else { 0.0 }
}
