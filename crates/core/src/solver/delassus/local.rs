//! Exact solution of one contact in a contact problem that is given by the Delassus operator W (changes of contact
//! velocities per contact impulse, 1/kg), without data on bodies.
//!
//! At a contact of a grain that is not a disc, a normal impulse also changes the tangential velocity (W_nt ≠ 0). So the
//! two separate projections, of normal and tangential impulse, that solve a contact between discs become an enumeration
//! of cases. Let p = P_n + c₀ be the shifted normal impulse: the normal impulse P_n plus the largest impulse c₀ of
//! cohesion, so that it is never negative. Let P_t be the tangential impulse (all three in N·s), μ the friction
//! coefficient, W_kk the contact's own 2×2 block of W with the entries W_nn, W_nt and W_tt, u = (u_n, u_t) its
//! velocity, and b = (b_n, b_t) its velocity at p = P_t = 0 (m/s). The law in the shifted friction cone, in which the
//! whole p bounds friction, is
//!
//! > u = W_kk (p, P_t) + b,  0 ≤ p ⟂ u_n ≥ 0,  |P_t| ≤ μp, sliding opposes u_t,
//!
//! and the three cases are
//!
//! > open: p = P_t = 0 if b_n ≥ 0;
//! > stick: (p, P_t) = −W_kk⁻¹ b if that is in the cone;
//! > slip: P_t = sμp with s = ±1, so that p = −b_n / (W_nn + sμW_nt), if s·u_t ≤ 0.
//!
//! If μ|W_nt| < W_nn, there is exactly one solution; otherwise the first case that satisfies its condition is taken. In
//! the compressive cone, in which only the pushing part of the normal impulse bounds friction, the bound is μ max(p −
//! c₀, 0), so a contact with p ≤ c₀ has no friction. A contact with p > c₀ is solved in a shifted cone with p − c₀
//! instead of p and b + c₀(W_nn, W_nt) instead of b.

/// Data of one contact that its update in a sweep reads: its own block of the Delassus operator, quantities derived
/// from this block, friction coefficient and cohesion impulse. They are computed once before the sweeps.
#[derive(Clone, Copy, Debug)]
pub(super) struct LocalBlock {
    /// Entry W_nn of the Delassus operator: change of the contact's normal velocity per normal impulse of the same
    /// contact, 1/kg.
    pub normal: f64,
    /// Entry W_nt of the Delassus operator: change of the contact's normal velocity per tangential impulse of the same
    /// contact, 1/kg.
    pub mixed: f64,
    /// Entry W_tt of the Delassus operator: change of the contact's tangential velocity per tangential impulse of the
    /// same contact, 1/kg.
    pub tangential: f64,
    /// Three entries, kg, of the inverse of the contact's own block of the Delassus operator: normal–normal,
    /// normal–tangential and tangential–tangential.
    inverse: [f64; 3],
    /// Effective masses, kg, of slip in the direction s = −1 and s = +1: 1/(W_nn + sμW_nt), with the friction
    /// coefficient μ and the entries W_nn and W_nt of the contact's own block of the Delassus operator. A mass times
    /// the closing speed is the shifted normal impulse p (normal impulse plus the largest impulse of cohesion, so that
    /// it is never negative). If a mass is not positive, slip in that direction would give a closing contact an impulse
    /// p < 0, which the law forbids.
    slip_masses: [f64; 2],
    /// Friction coefficient μ.
    pub friction: f64,
    /// Cohesion impulse c₀ = C₀Δt, the cohesion force times the time step, N·s.
    pub cohesion_impulse: f64,
}

impl LocalBlock {
    /// Computes the data of a contact from its own 2×2 block of the Delassus operator (`block`, 1/kg), which must be
    /// positive definite.
    pub(super) fn new(block: [[f64; 2]; 2], friction: f64, cohesion_impulse: f64) -> Self {
        let [[normal, mixed], [_, tangential]] = block;
        let determinant = normal * tangential - mixed * mixed;
        Self {
            normal,
            mixed,
            tangential,
            inverse: [tangential / determinant, -mixed / determinant, normal / determinant],
            slip_masses: [-1.0, 1.0].map(|side| 1.0 / (normal + side * friction * mixed)),
            friction,
            cohesion_impulse,
        }
    }

    /// Returns the shifted normal impulse (normal impulse plus the largest impulse of cohesion, so that it is never
    /// negative) and the tangential impulse, N·s, that satisfy the contact's law. The arguments (`normal`,
    /// `tangential`) are the velocity that the contact would have if both results were 0, m/s.
    #[inline(always)]
    pub(super) fn solve(&self, [normal, tangential]: [f64; 2], compressive_cone: bool) -> [f64; 2] {
        if normal >= 0.0 {
            return [0.0, 0.0];
        }
        if !compressive_cone {
            return self.pressed([normal, tangential]);
        }
        let cohesion = self.cohesion_impulse;
        let rest = normal + cohesion * self.normal;
        if rest >= 0.0 {
            return [-normal / self.normal, 0.0];
        }
        let [pressure, rubbing] = self.pressed([rest, tangential + cohesion * self.mixed]);
        [pressure + cohesion, rubbing]
    }

    /// Returns the shifted normal impulse (normal impulse plus the largest impulse of cohesion, so that it is never
    /// negative) and the tangential impulse, N·s, of a contact that would close if its impulses were 0: the impulses of
    /// stick if the friction cone allows them, otherwise the impulses of slip.
    #[inline(always)]
    fn pressed(&self, free @ [normal, tangential]: [f64; 2]) -> [f64; 2] {
        let [inverse_normal, inverse_mixed, inverse_tangential] = self.inverse;
        let stuck = [
            -(inverse_normal * normal + inverse_mixed * tangential),
            -(inverse_mixed * normal + inverse_tangential * tangential),
        ];
        if stuck[1].abs() <= self.friction * stuck[0] {
            return stuck;
        }
        let (impulse, pushed_along) = self.slip(free, stuck[1] > 0.0);
        if pushed_along <= 0.0 {
            return impulse;
        }
        let (other, pushed_along_other) = self.slip(free, stuck[1] <= 0.0);
        // Because of rounding it is possible that no case satisfies the law. Then the slip with the smaller
        // violation is taken.
        if pushed_along_other < pushed_along { other } else { impulse }
    }

    /// Returns the shifted normal impulse p (normal impulse plus the largest impulse of cohesion, so that it is never
    /// negative) and the tangential impulse P_t, N·s, if the contact slips with P_t = sμp (μ: friction coefficient),
    /// and the velocity s·u_t, m/s (u_t: tangential velocity). The sign s is +1 if `positive`, otherwise −1. The
    /// impulses satisfy the law if s·u_t ≤ 0. Instead of s·u_t returns infinity if p is not positive.
    #[inline(always)]
    fn slip(&self, [normal, tangential]: [f64; 2], positive: bool) -> ([f64; 2], f64) {
        let side = if positive { 1.0 } else { -1.0 };
        let pressure = -normal * self.slip_masses[usize::from(positive)];
        let rubbing = side * self.friction * pressure;
        let velocity = tangential + self.mixed * pressure + self.tangential * rubbing;
        ([pressure, rubbing], if pressure > 0.0 { side * velocity } else { f64::INFINITY })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::Parts;

    /// Returns the relative error of the impulses that `solve` computes for a contact, dimensionless. It is the largest
    /// violation of the contact's law, as a velocity, divided by the sum of the magnitudes of the normal and tangential
    /// velocity that the contact has at zero impulses. Under the compressive friction cone (only the pushing part of
    /// the normal force bounds friction), this sum also contains the velocity that the cohesion impulse causes.
    fn fault(block: &LocalBlock, compressive: bool, free: [f64; 2]) -> f64 {
        let [p, t] = block.solve(free, compressive);
        let u = [
            block.normal * p + block.mixed * t + free[0],
            block.mixed * p + block.tangential * t + free[1],
        ];
        let cohesion = if compressive { block.cohesion_impulse } else { 0.0 };
        let bound = block.friction * (p - cohesion).positive_part();
        let scale = free[0].abs() + free[1].abs() + block.normal * cohesion;
        let normal = p - (p - u[0] / block.normal).positive_part();
        let tangential = t - (t - u[1] / block.tangential).clamp(-bound, bound);
        (normal.abs() * block.normal).max(tangential.abs() * block.tangential) / scale
    }

    #[test]
    fn the_enumeration_solves_every_coupled_contact() {
        let mut kinds = [0; 4];
        for mixed in [-1.2, -0.4, 0.0, 0.7, 1.3] {
            for friction in [0.0, 0.3, 0.7] {
                for cohesion in [0.0, 0.5] {
                    let block = LocalBlock::new([[1.0, mixed], [mixed, 3.0]], friction, cohesion);
                    for turn in 0..48 {
                        let angle = f64::from(turn) * std::f64::consts::TAU / 48.0;
                        let free = [angle.cos(), angle.sin()];
                        for compressive in [false, true] {
                            let fault = fault(&block, compressive, free);
                            assert!(fault < 1e-14, "{block:?} at {free:?} errs by {fault:e}");
                        }
                        let [p, t] = block.solve(free, false);
                        let kind = match () {
                            () if p == 0.0 => 0,
                            () if t.abs() < 0.999 * friction * p => 1,
                            () if t < 0.0 => 2,
                            () => 3,
                        };
                        kinds[kind] += 1;
                    }
                }
            }
        }
        assert!(kinds.iter().all(|&count| count > 50), "each kind arose: {kinds:?}");
    }

    /// Checks a sliding contact that only cohesion keeps closed: it has friction in the shifted cone, which includes
    /// the cohesion force in the friction bound, and no friction in the compressive cone, which does not.
    #[test]
    fn a_pulling_contact_rubs_in_the_shifted_cone_alone() {
        let block = LocalBlock::new([[2.0, 0.0], [0.0, 6.0]], 0.5, 1.0);
        assert_eq!(block.solve([-1.0, -9.0], false), [0.5, 0.25]);
        assert_eq!(block.solve([-1.0, -9.0], true), [0.5, 0.0]);
    }
}
