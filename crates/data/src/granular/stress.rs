//! Computes stresses by the formula of Love and Weber (compression positive), the fabric tensor of contacts, and
//! invariants of plane tensors.
//!
//! If the forces f_c that act on a body at the points p_c balance, the mean stress in the body is (1/A) Σ f_c ⊗ p_c,
//! with the area A of the body. Summed over grains, with points relative to the centres of the grains, each contact
//! contributes f ⊗ ℓ. The branch vector ℓ joins the two centres, or a centre and the touched point of a wall or a fixed
//! disc, so the stress in walls is not included. The force f acts on grain i and ℓ points towards the centre of grain
//! i, so compressive stresses are positive. Weight and inertia act at the centres and add no term; the mean contact
//! stress is the stress that balances them. In a plane a stress σ is a force per length.

use glam::DVec2;

use super::network::Network;

/// Computes Σ f ⊗ ℓ over all contacts, N·m, with the contact force f (N) and the branch vector ℓ (m), which leads to
/// the centre of grain i from the centre of grain j or from the touched point of a wall or fixed disc.
pub(super) fn stress_of_contacts(network: &Network) -> Tensor {
    let mut sum = Tensor::default();
    for link in &network.links {
        sum.add(link.force, link.branch());
    }
    sum
}

/// Computes the contribution of each grain to the sum Σ f ⊗ ℓ of contact forces f (N) times branch vectors ℓ (m), N·m,
/// in the order of the grains. The sum of all contributions is [`stress_of_contacts`].
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

/// Computes the fabric tensor, the mean of n ⊗ n over all contacts with the unit normals n. Contacts without a force
/// count, too. The tensor is NaN without contacts.
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
    /// Adds the tensor product a ⊗ b to this tensor.
    pub(super) fn add(&mut self, a: DVec2, b: DVec2) {
        self.xx += a.x * b.x;
        self.xy += a.x * b.y;
        self.yx += a.y * b.x;
        self.yy += a.y * b.y;
    }

    /// Divides all components by a number.
    pub(super) fn over(self, divisor: f64) -> Self {
        let Self { xx, xy, yx, yy } = self;
        Self { xx: xx / divisor, xy: xy / divisor, yx: yx / divisor, yy: yy / divisor }
    }

    /// Returns the mean of the tensor's two principal values, which is half the trace.
    pub(super) fn mean(self) -> f64 {
        0.5 * (self.xx + self.yy)
    }

    /// Returns half the difference between the two principal values of the tensor's symmetric part.
    pub(super) fn deviator(self) -> f64 {
        self.half_differences().length()
    }

    /// Returns the direction of the larger principal value of the tensor's symmetric part, degrees anticlockwise from
    /// the x axis, in [0, 180). It is NaN if the principal values are equal.
    pub(super) fn direction(self) -> f64 {
        let differences = self.half_differences();
        if differences.length() > 0.0 {
            axis_degrees(0.5 * differences.to_angle())
        } else {
            f64::NAN
        }
    }

    /// Returns the components a and b of the tensor's deviator, the matrix (a b; b −a), which is the symmetric part
    /// minus the mean of its principal values.
    fn half_differences(self) -> DVec2 {
        0.5 * DVec2::new(self.xx - self.yy, self.xy + self.yx)
    }
}

/// Converts the angle of an axis, rad, to degrees in [0, 180).
pub(super) fn axis_degrees(angle: f64) -> f64 {
    let degrees = angle.to_degrees().rem_euclid(180.0);
    // Rounding turns a tiny negative angle into 180.
    if degrees < 180.0 { degrees } else { 0.0 }
}
