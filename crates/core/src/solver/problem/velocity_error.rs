//! How far the velocities of a step are from those that are asked for.
//!
//! **The gap.** With impulses p that are allowed and the velocities V that they make, let w and v of each contact be those
//! of `problem::friction` and z ≥ 0 what w lacks of the allowed ones: w + z ≥ 0 within bounds of friction g,
//! w + s + z ≥ μ|v| on the cone. V solves the dual of a problem in which z is added to w, and there the two energies differ
//! by
//!
//! > Σ m_ij (σ (w + z) + g|v| + λv) within bounds,  Σ m_ij (σ (w + s + z) + λv) on the cone,
//!
//! each term ≥ 0. Since (p − p*)·H(V − V*) is ‖V − V*‖²_M, with p* and V* those of the solution, and no contact there lacks
//! anything, ‖V − V*‖²_M is at most that sum and Σ m_ij z(σ* − σ). Nobody knows σ*. It is taken for no more than 2σ + z, twice
//! the present impulse and what would end the lack of the contact by itself. With this the gap is
//!
//! > S = Σ m_ij (σ(w + 2z) + z² + g|v| + λv)
//!
//! within bounds, and √S over the root of the mass of the grains that touch something is in m/s.
//!
//! **What lies on a contact that lacks something** has to move as well, and impulses that are still 0 do not show it: where
//! a column has just begun to fall, only its lowest disc closes on anything. So let all grains move in one way that ends
//! such lacks: by b along the mean normal u of the contacts with fixed bodies, b the root mean square of their z/(n·u), and
//! away from their centre at the rate a/d, a the root mean square of z among grains. The end of what is L diameters long moves by
//!
//! > f = b + L a.
//!
//! **The error that is told** is the larger of √S and f. Where nothing lacks anything, √S is a bound for a model of
//! friction. Otherwise it is an estimate, which was tried (`scene::law_errors`): of 574 solves of all kinds, good and bad
//! ones, whose velocities were off by more than 1e-6 √(g d), 3.5 % were farther off than that, and it was 4.3 times their
//! distance in the median. Smaller errors are told too large, since S is a product of an error of impulses and one of
//! velocities: on a pile at rest 1e-4 may stand for 1e-6.
//!
//! **Coulomb's law** has no dual. There g is the bound μσ of the impulses themselves: S is 0 where the law is solved and
//! nowhere else. Impulses outside of their cone count by how far they are from it, λ − λ_c, with |λ − λ_c||v| + (λ − λ_c)².
//!
//! A wall that a force drives is one more body, whose mass counts in ‖V − V*‖²_M and not in the mean: w and v are relative to
//! it as it goes now, whatever of them is its own to undo (`problem::walls`).

use glam::DVec2;

use super::residual::ROUNDING;
use super::row_velocities::{RowVelocities, sum_of_rows};
use super::{Row, StepProblem};
use crate::contact::law;
use crate::number::Parts;
use crate::solver::kinematics::Model;
use crate::solver::settings::FrictionModel;

/// Contacts with fixed bodies whose normals are less along the mean one are not opened by a way along that: the way
/// would be ten times as long as the lack.
const LEAST_ALONG: f64 = 0.1;

/// How far velocities are from those that are asked for, and what that is held against.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VelocityError {
    /// Of the root mean square of the velocities of the grains that touch something, weighted with mass, m/s.
    pub told: f64,
    /// The root of g d, d the mean diameter, and of the mean square of what contacts undo, together, m/s.
    pub scale: f64,
}

impl VelocityError {
    /// True where the error is no larger than a share of the scale. Not a number is not.
    pub(crate) fn is_within(self, share: f64) -> bool {
        self.told <= share * self.scale
    }
}

/// The error against what a problem is solved for: its model of friction, or Coulomb's law. 0 where nothing touches.
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

/// What errors of velocities are made of.
#[derive(Default)]
pub(super) struct ErrorSums {
    /// S, J.
    gap: f64,
    /// Σ m_ij (v^free)² with v^free as in the residual, J.
    undone: f64,
    /// Σ m_ij |λ|², J.
    impulses: f64,
    /// Σ (z/(n·u))² of contacts with fixed bodies and Σ z² of the others, (m/s)², and how many there are of each.
    lacks: [f64; 2],
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

    /// Adds a row as the model of friction judges it that the problem is solved under.
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
        let least = if model.is_on_cone() { problem.law.friction * across.abs() } else { 0.0 };
        let lacking = (least - opening).positive_part();
        let of_normal = shifted * (opening + 2.0 * lacking) + lacking * lacking;
        self.add(problem, number, row, of_normal + rubbing + tangential * across, lacking);
    }

    /// Adds a row as Coulomb's law judges it.
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
            let bound = problem.law.friction_bound(shifted);
            let allowed = law::coulomb(tangential, bound);
            let outside = (tangential - allowed).abs();
            of_contact += bound * across.abs() + allowed * across;
            of_contact += outside * (across.abs() + outside);
        }
        self.add(problem, number, row, of_contact, lacking);
    }

    /// Adds what a row has of S over its effective mass, (m/s)², and what it lacks, m/s.
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

    /// The larger of √S over the root of the mass and of f, m/s; NaN where S is NaN.
    pub(super) fn error<M: Model>(&self, problem: &StepProblem<M>) -> f64 {
        // What rounding left of the impulses is no gap.
        let is_rounding = self.gap.abs() <= ROUNDING * ROUNDING * self.impulses;
        let squared = if is_rounding { 0.0 } else { self.gap / problem.touching_mass() };
        // What rounding leaves of a gap of 0 may be negative; not a number stays none.
        let of_gap = if squared < 0.0 { 0.0 } else { squared.sqrt() };
        let [along, between] =
            [0, 1].map(|kind| (self.lacks[kind] / self.counts[kind].max(1.0)).sqrt());
        let way = along + problem.grains_in_a_row() * between;
        if way > of_gap { way } else { of_gap }
    }
}
