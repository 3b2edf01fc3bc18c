//! Friction models that replace Coulomb's law by a convex problem. Each model keeps one number per contact fixed while
//! a step is solved: the *lagged number*, which is estimated before the solve (0 in `associated`).
//!
//! Let v_n be the normal velocity of a contact and v_n^{n−1} its normal velocity before the step, ρ the coefficient of
//! restitution, w = v_n + ρ v_n^{n−1}, v = v_t the tangential velocity, σ the shifted normal impulse (normal impulse
//! plus the largest impulse of cohesion, so that it is never negative) and λ_t the tangential impulse, all in m/s:
//! impulses are divided by the effective mass (`contact::law`). μ is the friction coefficient, and m_n and m_t are the
//! effective masses along normal and tangent.
//!
//! * `tresca`: 0 ≤ σ ⟂ w ≥ 0 and λ_t = clamp(λ_t − v m_t/m_n, ±g). The lagged number is g, Coulomb's friction bound at
//!   an earlier σ: for the first solve of a step the σ after some sweeps under Coulomb's law, for a further solve of
//!   the step the σ of the solve before (P. D. Panagiotopoulos, 1975, solved Coulomb's law by such problems).
//! * `associated`: K ∋ (σ, λ_t) ⟂ (w, v) ∈ K* with the friction cone K = {|λ_t| ≤ μσ} and its dual cone K* (M.
//!   Anitescu, 2006; A. Tasora and M. Anitescu, 2011). If a contact slides, w = μ|v|: the contact opens although
//!   Coulomb's law keeps it closed.
//! * `desaxce`: like `associated`, with w + s instead of w. With s = μ|v| of the solution this would be Coulomb's law
//!   (G. de Saxcé and Z.-Q. Feng, 1998; V. Acary and others, 2011). The lagged number is s: for the first solve from
//!   the velocities at the beginning of the step, for a further solve from the velocities of the solve before.
//!
//! In each model the impulses of a contact are the point of a convex set that is nearest to (σ − w − s, λ_t − v
//! m_t/m_n) in the metric diag(1, m_n/m_t). This projection is the Gauss–Seidel update of a contact of solid discs,
//! whose Delassus block is diagonal. It also defines the natural map, the measure of error of a solve.

use super::{Row, StepProblem};
use crate::contact::{ContactLaw, Lanes, law};
use crate::solver::kinematics::Model;
use crate::solver::settings::FrictionModel;

/// The friction model of a step, and its *lagged numbers*: one number per contact that stays fixed during a solve,
/// either a friction bound or an opening speed (a speed added to the normal velocity), m/s.
#[derive(Clone, Debug)]
pub(crate) struct LaggedFriction {
    pub model: FrictionModel,
    /// Lagged number of each contact, m/s, which stays fixed during a solve: a friction bound (divided by the effective
    /// mass) or an opening speed (a speed added to the normal velocity). Empty under Coulomb's law.
    pub now: Vec<f64>,
}

impl Default for LaggedFriction {
    fn default() -> Self {
        Self { model: FrictionModel::Coulomb, now: Vec::new() }
    }
}

/// Projection of impulses of a contact onto the impulses that a friction model allows. A Gauss–Seidel update projects
/// the impulses that would stop the relative motion at the contact, except for a rebound by restitution (trial
/// impulses).
pub(crate) trait FrictionProjection: Sized {
    /// True if the model needs a number per contact that stays fixed during a solve: a friction bound or an opening
    /// speed (a speed added to the normal velocity).
    const LAGS: bool;
    /// True if the projection supports contacts with different friction coefficients in one problem.
    const TAKES_PAIRS: bool = false;
    /// True if sweeps with this projection support walls that a force drives.
    const TAKES_DRIVES: bool = true;
    /// Factor by which a sweep multiplies the change from a contact's present impulses to its trial impulses.
    const RELAXATION: f64 = 1.0;

    /// Returns the impulses to which the friction model changes the given impulses `trial`. Both are pairs (σ, λ_t) of
    /// the normal impulse plus cohesion impulse σ and the tangential impulse λ_t, divided by the effective mass, m/s.
    /// Under a convex model the result is the allowed pair that is nearest to `trial` in the metric diag(1, m_n/m_t),
    /// with the effective masses m_n and m_t along normal and tangent. Under Coulomb's law σ becomes at least 0, and
    /// |λ_t| at most the friction bound of this σ. `lagged`, m/s, stays fixed during the solve: the contact's friction
    /// bound (`tresca`), or its opening speed, which is added to the normal velocity (`associated`, `desaxce`).
    /// Coulomb's law ignores `lagged`.
    fn project<M: Model>(law: &ContactLaw, lagged: f64, trial: [f64; 2]) -> [f64; 2];
}

/// Evaluates an expression in which a type name stands for the projection of the problem's friction model: the rule
/// that limits impulses to the impulses that the model allows (`FrictionProjection`).
macro_rules! with_projection {
    ($problem:expr, $M:ident, $P:ident => $work:expr) => {
        match $problem.friction.model {
            FrictionModel::Tresca if $M::FRICTION => {
                type $P = $crate::solver::problem::BoundedFriction;
                $work
            }
            FrictionModel::Associated | FrictionModel::Desaxce if $M::FRICTION => {
                type $P = $crate::solver::problem::ConeFriction;
                $work
            }
            _ if $problem.has_one_simple_law() => {
                type $P = $crate::solver::problem::CoulombFriction<true>;
                $work
            }
            _ => {
                type $P = $crate::solver::problem::CoulombFriction<false>;
                $work
            }
        }
    };
}
pub(crate) use with_projection;

/// Projection of impulses onto the impulses that Coulomb's law allows. `ALL_RUBS` is true if all contacts have the same
/// friction coefficient, and this coefficient times the sum of normal impulse and cohesion impulse bounds friction
/// ([`ContactLaw::all_rubs`]). In the compressive friction cone only a part of this sum bounds friction: the pushing
/// part of the normal impulse. A sweep is one chain of dependent operations. If the compiler knows that the whole sum
/// bounds friction, it removes two operations of the chain, which saves 11 % of the time of a run.
pub(crate) enum CoulombFriction<const ALL_RUBS: bool> {}

impl<const ALL_RUBS: bool> FrictionProjection for CoulombFriction<ALL_RUBS> {
    const LAGS: bool = false;
    const TAKES_PAIRS: bool = !ALL_RUBS;

    #[inline(always)]
    fn project<M: Model>(law: &ContactLaw, _: f64, trial: [f64; 2]) -> [f64; 2] {
        if !ALL_RUBS || !M::FRICTION {
            return project_by_coulomb::<M, f64>(law, trial);
        }
        let shifted = law::signorini(trial[0]);
        [shifted, law::coulomb(trial[1], law.friction * shifted)]
    }
}

/// Limits the impulses of a contact to the impulses that Coulomb's law allows, and returns them. `normal` is a normal
/// impulse plus cohesion impulse; it is replaced by 0 if it is negative. `tangential` is a tangential impulse; its
/// magnitude is limited to the friction bound that belongs to the returned normal impulse. All impulses are divided by
/// the effective mass, m/s.
#[inline(always)]
pub(crate) fn project_by_coulomb<M: Model, T: Lanes>(
    law: &ContactLaw,
    [normal, tangential]: [T; 2],
) -> [T; 2] {
    let shifted = law::signorini(normal);
    if !M::FRICTION {
        return [shifted, tangential];
    }
    [shifted, law::coulomb(tangential, law.friction_bound(shifted))]
}

/// The projection of the friction model `tresca`: σ ≥ 0 for the normal impulse plus cohesion impulse σ, and |λ_t| at
/// most a friction bound for the tangential impulse λ_t. All are divided by the effective mass, m/s, and the bound
/// stays fixed during a solve.
pub(crate) enum BoundedFriction {}

impl FrictionProjection for BoundedFriction {
    const LAGS: bool = true;

    #[inline(always)]
    fn project<M: Model>(_: &ContactLaw, bound: f64, [normal, tangential]: [f64; 2]) -> [f64; 2] {
        [law::signorini(normal), law::coulomb(tangential, bound)]
    }
}

/// The projection of the friction models `associated` and `desaxce` on the friction cone |λ_t| ≤ μσ: μ is the friction
/// coefficient, σ the normal impulse plus cohesion impulse and λ_t the tangential impulse, both divided by the
/// effective mass, m/s. An opening speed, m/s, which stays fixed during a solve, is added to the normal velocity of a
/// contact; under `associated` it is 0.
pub(crate) enum ConeFriction {}

impl FrictionProjection for ConeFriction {
    const LAGS: bool = true;
    const TAKES_DRIVES: bool = false;

    #[inline(always)]
    fn project<M: Model>(law: &ContactLaw, lagged: f64, trial: [f64; 2]) -> [f64; 2] {
        let compliance = M::TANGENTIAL_COMPLIANCE;
        law::nearest_on_cone(law.friction, compliance, [trial[0] - lagged, trial[1]])
    }
}

impl<M: Model> StepProblem<M> {
    /// Sets the friction model of a problem whose contacts and velocities are already set up. Computes the numbers that
    /// stay fixed during a solve: the friction bounds of `tresca` from the present impulses, or the opening speeds of
    /// `desaxce`, which are added to normal velocities, from the velocities at the beginning of the step.
    pub(crate) fn begin_friction(&mut self, model: FrictionModel) {
        self.friction.model = model;
        self.friction.now.clear();
        match model {
            _ if !M::FRICTION => {}
            FrictionModel::Coulomb => {}
            FrictionModel::Tresca => self.renew_friction(),
            FrictionModel::Associated => self.friction.now.resize(self.rows.len(), 0.0),
            FrictionModel::Desaxce => {
                let mut lagged = std::mem::take(&mut self.friction.now);
                self.for_each_velocity(&self.bodies.before, |row, [_, tangential]| {
                    lagged.push(opening(&self.law_of(lagged.len()), row, tangential));
                });
                self.friction.now = lagged;
            }
        }
    }

    /// Makes Coulomb's law the friction model again, and deletes the friction bounds or opening speeds (added to normal
    /// velocities) of the previous friction model.
    pub(crate) fn forget_bounds(&mut self) {
        self.friction.model = FrictionModel::Coulomb;
        self.friction.now.clear();
    }

    /// Recomputes the friction bounds of `tresca` or the opening speeds of `desaxce`, which are added to normal
    /// velocities, from the present impulses and velocities.
    pub(crate) fn renew_friction(&mut self) {
        match self.friction.model {
            FrictionModel::Tresca => self.lag_by(bound),
            FrictionModel::Desaxce => self.lag_by(opening),
            _ => {}
        }
    }

    /// Sets the number of each contact that stays fixed during a solve, m/s (a friction bound, or an opening speed that
    /// is added to the normal velocity), to the result of `lagged_of`: a function of the contact law, the row (data of
    /// the contact) and its tangential velocity, m/s.
    fn lag_by(&mut self, lagged_of: impl Fn(&ContactLaw, &Row<M>, f64) -> f64) {
        let mut lagged = std::mem::take(&mut self.friction.now);
        lagged.clear();
        self.for_each_velocity(&self.bodies.now, |row, [_, tangential]| {
            lagged.push(lagged_of(&self.law_of(lagged.len()), row, tangential));
        });
        self.friction.now = lagged;
    }
}

/// Returns the friction bound of a contact under `tresca`, divided by the effective mass, m/s: the bound of Coulomb's
/// law for the contact's present normal impulse plus cohesion impulse.
fn bound<M: Model>(law: &ContactLaw, row: &Row<M>, _: f64) -> f64 {
    law.friction_bound(row.shifted_impulse)
}

/// Returns the opening speed of a contact under `desaxce`, m/s, which is added to its normal velocity: the friction
/// coefficient times the magnitude of the tangential velocity.
fn opening<M: Model>(law: &ContactLaw, _: &Row<M>, tangential_velocity: f64) -> f64 {
    law.friction * tangential_velocity.abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::{Plane, SpinningPlane};
    use crate::world::FrictionCone;

    fn law(friction: f64) -> ContactLaw {
        ContactLaw::new(friction, 0.0, FrictionCone::Shifted)
    }

    /// Returns half of a squared distance, (m/s)², between the impulses `point` = (σ, λ) and `trial` = (a, b): it is
    /// ½(σ − a)² + ½c(λ − b)². The projection on the friction cone finds the nearest point by this distance. σ and a
    /// are normal impulses, λ and b tangential impulses, all divided by the effective mass, m/s, and c = m_n/m_t is the
    /// ratio of the effective masses along normal and tangent.
    fn distance<M: Model>(point: [f64; 2], trial: [f64; 2]) -> f64 {
        let across = M::TANGENTIAL_COMPLIANCE * (point[1] - trial[1]).powi(2);
        0.5 * ((point[0] - trial[0]).powi(2) + across)
    }

    fn no_point_of_the_cone_is_nearer<M: Model>() {
        let law = law(0.7);
        for step in 0..48 {
            let angle = std::f64::consts::TAU * (f64::from(step) + 0.5) / 48.0;
            let trial = [angle.cos(), angle.sin()];
            let found = ConeFriction::project::<M>(&law, 0.0, trial);
            assert!(found[1].abs() <= law.friction * found[0] + 1e-15, "{trial:?}: {found:?}");
            let least = distance::<M>(found, trial);
            for up in 0..200 {
                let shifted = 0.02 * f64::from(up);
                for share in -20..=20 {
                    let point = [shifted, law.friction * shifted * f64::from(share) / 20.0];
                    let other = distance::<M>(point, trial);
                    assert!(other >= least - 1e-15, "{trial:?}: {point:?} beats {found:?}");
                }
            }
        }
    }

    #[test]
    fn the_projection_on_the_cone_is_the_nearest_point_in_its_metric() {
        no_point_of_the_cone_is_nearer::<SpinningPlane>();
        no_point_of_the_cone_is_nearer::<Plane>();
    }

    #[test]
    fn a_bound_lags() {
        let project =
            |bound, trial| BoundedFriction::project::<SpinningPlane>(&law(0.5), bound, trial);
        assert_eq!(project(0.3, [4.0, -9.0]), [4.0, -0.3]);
        assert_eq!(project(0.3, [-4.0, 9.0]), [0.0, 0.3]);
    }
}
