//! Estimated distance of the velocities of a step from the velocities of its solution.
//!
//! **The duality gap.** Let p be impulses of all contacts (N·s) that the friction model allows, and V the velocities of
//! the bodies that these impulses cause. The matrix H maps velocities of bodies to velocities w (normal, with
//! restitution term) and v (tangential) of contacts (m/s), as in `problem::friction`. σ and λ are the shifted normal
//! impulse (normal impulse plus the largest impulse of cohesion, so that it is never negative) and the tangential
//! impulse of a contact, divided by its effective mass m_ij (m/s). The shortfall z of a contact (m/s) is the increase
//! of w that it needs to satisfy its law: the least z ≥ 0 with w + z ≥ 0 for a friction model with fixed friction
//! bounds g (m/s), or with w + s + z ≥ μ|v| for a model with a friction cone (μ: friction coefficient, s: opening
//! speed, m/s). A step of a convex model is a minimisation over impulses, which has a dual problem for velocities. In
//! the problem in which z is added to w, p and V satisfy all constraints, and its energy at p and the energy of its
//! dual at V differ by
//!
//! > Σ m_ij (σ (w + z) + g|v| + λv) within bounds,  Σ m_ij (σ (w + s + z) + λv) on the cone,
//!
//! each term ≥ 0. Let p* and V* be the impulses and velocities of the solution, at which no contact has a shortfall,
//! and σ* the shifted normal impulse of a contact in p*. Let ‖·‖²_M be a sum of squares weighted by mass. Since (p −
//! p*)·H(V − V*) = ‖V − V*‖²_M, ‖V − V*‖²_M is at most the difference of the energies plus Σ m_ij z(σ* − σ). σ* is not
//! known. It is assumed to be at most 2σ + z: twice the present impulse plus the impulse that would end the contact's
//! shortfall by itself. With this assumption the bound is the duality gap S (J), for a model with fixed friction bounds
//! (first sum) or with a friction cone (second sum):
//!
//! > S = Σ m_ij (σ(w + 2z) + z² + g|v| + λv),  S = Σ m_ij (σ(w + s + 2z) + z² + λv).
//!
//! √S divided by the root of the mass of the grains with contacts is an error in m/s.
//!
//! **Grains that rest on a contact with a shortfall** have to move as well, and impulses that are still 0 do not show
//! this: when a column has just begun to fall, only its lowest disc approaches another body. So consider one motion of
//! all grains that ends such shortfalls. Its first part is a translation with the speed b along the unit vector u, the
//! mean normal of the contacts with fixed bodies; b is the root mean square of z/(n·u) of these contacts, with the
//! normal n of each. The second part is an expansion from the grains' centre at the rate a/d, with the root mean square
//! a of z at the contacts between grains and the mean diameter d. The end of a pile that is L diameters long then moves
//! with the speed
//!
//! > f = b + L a.
//!
//! **The reported error** is the larger of f and the error from √S, both in m/s. If no contact has a shortfall, √S is a
//! bound for a convex friction model. Otherwise the reported error is an estimate. It was tested (`scene::law_errors`)
//! on 574 solves, accurate and inaccurate, whose velocities had a true error of more than 1e-6 √(g d), with gravity g.
//! For 3.5 % of them the true error was larger than the estimate; in the median the estimate was 4.3 times the true
//! error. True errors below 1e-6 √(g d) are overestimated because S is a product of an error of impulses and an error
//! of velocities: for a pile at rest the estimate can be 1e-4 √(g d) if the true error is 1e-6 √(g d).
//!
//! **Coulomb's law** has no dual problem, because it is not convex. S is then computed with the friction bound of the
//! present impulses as g, which is μσ in the shifted friction cone (the whole σ bounds friction). S is 0 if and only if
//! the law is satisfied. An impulse λ outside the friction cone counts as the nearest allowed impulse λ_c, and adds |λ
//! − λ_c||v| + (λ − λ_c)² to the sum.
//!
//! A wall that a force drives is one more body. Its mass counts in ‖V − V*‖²_M but not in the mass by which S is
//! divided. At its contacts, w and v are relative to the wall's present velocity, without the division by ratios of
//! compliances that the residual uses (`problem::walls`).

use glam::DVec2;

use super::residual::ROUNDING;
use super::row_velocities::{RowVelocities, sum_of_rows};
use super::{Row, StepProblem};
use crate::contact::law;
use crate::number::Parts;
use crate::solver::kinematics::Model;
use crate::solver::settings::FrictionModel;

/// The estimate of the velocity error assumes a motion of all grains along the mean normal of the contacts with fixed
/// bodies, which gives these contacts the normal velocity that they lack to satisfy their law. Contacts with a cosine
/// below this value, between their own normal and the mean normal, are treated like contacts between grains instead.
/// For such a contact the motion would have to be more than ten times as fast as the lacking velocity, and the estimate
/// would be too large.
const LEAST_ALONG: f64 = 0.1;

/// Estimated error of the velocities of a step, and the speed by which it is divided for the comparison with the
/// tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VelocityError {
    /// Estimated error of the velocities, m/s: root mean square over the grains with contacts, weighted by mass.
    pub told: f64,
    /// Speed, m/s, by which the error is divided for the comparison with the tolerance: √(g d + q), with gravity g
    /// (m/s²) and the mean diameter d (m). q (m²/s²) is the sum, over the contacts, of effective mass times squared
    /// relative velocity without contact impulses, divided by the mass of the grains with contacts.
    pub scale: f64,
}

impl VelocityError {
    /// Returns true if the error is at most `share`, a dimensionless tolerance, times the scale; false if the error is
    /// NaN.
    pub(crate) fn is_within(self, share: f64) -> bool {
        self.told <= share * self.scale
    }
}

/// Estimates the velocity error of a problem with respect to the friction model that it is solved under, which may be
/// Coulomb's law. The error is 0 if there are no contacts.
pub fn velocity_error<M: Model>(problem: &StepProblem<M>) -> VelocityError {
    let add = |sums: &mut ErrorSums, (number, row): (usize, &Row<_>), motion: RowVelocities| {
        sums.add_by_model(problem, number, row, &motion);
    };
    let sums = sum_of_rows(problem, add, ErrorSums::add_all);
    let mass = problem.touching_mass();
    let undone = if mass > 0.0 { sums.undone / mass } else { 0.0 };
    let scale = (problem.fall_speed * problem.fall_speed + undone).sqrt();
    VelocityError { told: sums.error(problem), scale }
}

/// Sums over the contacts of a problem, from which the estimated error of its velocities is computed.
#[derive(Default)]
pub(super) struct ErrorSums {
    /// The duality gap S, J: a sum over the contacts that is 0 at the solution. S estimates the squared velocity error
    /// multiplied by the mass of the grains with contacts.
    gap: f64,
    /// Sum over the contacts, J: effective mass times the square of the relative velocity that the contact would have
    /// without contact impulses, restitution term included.
    undone: f64,
    /// Sum over the contacts, J: squared impulse (cohesion included) of each contact, divided by its effective mass.
    impulses: f64,
    /// Two sums of squared shortfalls, (m/s)². A shortfall is the increase of normal velocity that a contact needs to
    /// satisfy its law. The first sum is over the contacts with fixed bodies, each shortfall divided by the cosine
    /// between the contact's normal and the mean normal of these contacts. The second sum is over the contacts between
    /// grains, and the contacts with fixed bodies whose cosine is below [`LEAST_ALONG`].
    lacks: [f64; 2],
    /// Number of contacts that contribute to the first and to the second sum of squared shortfalls (`lacks`).
    counts: [f64; 2],
}

impl ErrorSums {
    pub(super) fn add_all(&mut self, other: Self) {
        self.gap += other.gap;
        self.undone += other.undone;
        self.impulses += other.impulses;
        for kind in 0..2 {
            self.lacks[kind] += other.lacks[kind];
            self.counts[kind] += other.counts[kind];
        }
    }

    /// Adds a contact's contribution to the sums from which the velocity error is computed, under the friction model
    /// that the problem is solved under.
    #[inline(always)]
    fn add_by_model<M: Model>(
        &mut self,
        problem: &StepProblem<M>,
        number: usize,
        row: &Row<M>,
        motion: &RowVelocities,
    ) {
        let free = motion.free[0] + row.restitution_velocity;
        let mut squared = free * free;
        if M::FRICTION {
            squared += motion.free[1] * motion.free[1] / M::TANGENTIAL_COMPLIANCE;
        }
        if let Some((rolling, free)) = problem.rolling(number, row, &problem.bodies.free) {
            squared += free * free / rolling.compliance;
        }
        self.undone += row.effective_mass * squared;
        let model = problem.friction.model;
        if !M::FRICTION || model == FrictionModel::Coulomb {
            return self.add_by_law(problem, number, row, motion);
        }
        let [shifted, tangential] = row.impulse();
        let [normal, across] = motion.now;
        let lagged = problem.friction.now.get(number).copied().unwrap_or(0.0);
        let (opening, rubbing) = if model.is_on_cone() {
            (normal + row.restitution_velocity + lagged, 0.0)
        } else {
            (normal + row.restitution_velocity, lagged * across.abs())
        };
        let least =
            if model.is_on_cone() { problem.law_of(number).friction * across.abs() } else { 0.0 };
        let lacking = (least - opening).positive_part();
        let of_normal = shifted * (opening + 2.0 * lacking) + lacking * lacking;
        self.add(problem, number, row, of_normal + rubbing + tangential * across, lacking);
    }

    /// Adds a contact's contribution to the sums from which the velocity error is computed, under Coulomb's law.
    #[inline(always)]
    pub(super) fn add_by_law<M: Model>(
        &mut self,
        problem: &StepProblem<M>,
        number: usize,
        row: &Row<M>,
        motion: &RowVelocities,
    ) {
        let [shifted, tangential] = row.impulse();
        let [normal, across] = motion.now;
        let opening = normal + row.restitution_velocity;
        let lacking = (-opening).positive_part();
        let mut of_contact = shifted * (opening + 2.0 * lacking) + lacking * lacking;
        if M::FRICTION {
            let bound = problem.law_of(number).friction_bound(shifted);
            let allowed = law::coulomb(tangential, bound);
            let outside = (tangential - allowed).abs();
            of_contact += bound * across.abs() + allowed * across;
            of_contact += outside * (across.abs() + outside);
        }
        if let Some((rolling, velocity)) = problem.rolling(number, row, &problem.bodies.now) {
            let bound = rolling.bound(&problem.law_of(number), shifted);
            let allowed = law::coulomb(rolling.impulse, bound);
            let outside = (rolling.impulse - allowed).abs();
            of_contact += bound * velocity.abs() + allowed * velocity;
            of_contact += outside * (velocity.abs() + outside);
        }
        self.add(problem, number, row, of_contact, lacking);
    }

    /// Adds a contact's contribution to the sums from which the velocity error is computed. The sum S, which is 0 at
    /// the solution, increases by the effective mass times `of_contact`, (m/s)². The sums of squared shortfalls
    /// increase by the square of `lacking`, m/s: the increase of normal velocity that the contact needs to satisfy its
    /// law. A motion of all grains along `way_out`, the mean direction away from the fixed bodies, can open a contact
    /// with a fixed body. `lacking` of such a contact is first divided by the cosine between `way_out` and the
    /// contact's normal, which gives the speed of the motion. If the cosine is below [`LEAST_ALONG`], and for contacts
    /// between grains, `lacking` is not divided.
    #[inline(always)]
    fn add<M: Model>(
        &mut self,
        problem: &StepProblem<M>,
        number: usize,
        row: &Row<M>,
        of_contact: f64,
        lacking: f64,
    ) {
        let [shifted, tangential] = row.impulse();
        self.gap += row.effective_mass * of_contact;
        self.impulses += row.effective_mass * (shifted * shifted + tangential * tangential);
        let along = DVec2::from(M::components(row.normal)).dot(problem.way_out);
        let is_opened = !problem.rows.is_pair(number) && along >= LEAST_ALONG;
        let (kind, way) = if is_opened { (0, lacking / along) } else { (1, lacking) };
        self.lacks[kind] += way * way;
        self.counts[kind] += 1.0;
    }

    /// Returns the estimated velocity error, m/s, the larger of two numbers; NaN if S is NaN. The first is √(S/m), with
    /// the mass m of the grains with contacts, kg, and the sum S over the contacts, J, which is 0 at the solution. The
    /// second is the speed of a motion of all grains that gives each contact the normal velocity that it lacks to
    /// satisfy its law.
    pub(super) fn error<M: Model>(&self, problem: &StepProblem<M>) -> f64 {
        // A gap S within the rounding of the impulses counts as 0.
        let is_rounding = self.gap.abs() <= ROUNDING * ROUNDING * self.impulses;
        let squared = if is_rounding { 0.0 } else { self.gap / problem.touching_mass() };
        // Rounding may make a gap of 0 negative; NaN stays NaN.
        let of_gap = if squared < 0.0 { 0.0 } else { squared.sqrt() };
        let [along, between] =
            [0, 1].map(|kind| (self.lacks[kind] / self.counts[kind].max(1.0)).sqrt());
        let way = along + problem.grains_in_a_row() * between;
        if way > of_gap { way } else { of_gap }
    }
}
