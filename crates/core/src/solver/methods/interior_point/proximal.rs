//! Proximal multipliers with a semi-smooth Newton method and exact line search. They finish a solve if the steps of the
//! interior point method become short, and are tried if the path of that method does not lead to a solution.
//!
//! A contact has the present impulses p (normal impulse plus cohesion impulse, and tangential impulse, divided by the
//! effective mass, m/s), the velocities (w, v), m/s (w: normal velocity plus restitution term and, under `desaxce`,
//! plus a fixed opening speed; v: tangential velocity), and the effective mass m, kg; m_n = m and m_t are its effective
//! masses along normal and tangent. Let ε be a dimensionless compliance, relative to the compliance 1/m of the contact,
//! R the diagonal matrix diag(1, m_n/m_t), ‖y‖²_R = y·Ry, Π the projection on the allowed impulses in the metric R, and
//! y = p − R⁻¹(w, v)/ε the trial impulses. The bodies have the velocities V, the inertias M, and the velocities V_free
//! without contacts; H maps V to contact velocities, and ‖V‖²_M = V·MV. The function
//!
//! > F(V) = ½‖V − V_free‖²_M + Σ (m ε/2) (‖y‖²_R − ‖y − Π(y)‖²_R)
//!
//! is convex and once differentiable, with gradient and Hessian
//!
//! > ∇F = M(V − V_free) − Σ Hᵀ m Π(y),  M + Σ (m/ε) Hᵀ J R⁻¹ H,
//!
//! where J is the derivative of Π. The Hessian is positive definite. Like the matrix of the interior point method it
//! has a block for each body and for each pair of bodies in contact. At the minimum of F, V agrees with the impulses
//! Π(y), and the update p ← Π(y) brings the impulses nearer to the solution (R. T. Rockafellar, 1976; with Newton's
//! method inside X. Li, D. Sun, K.-C. Toh, 2018; for contacts A. Castro and others, 2022). Π is piecewise linear, so F
//! is quadratic as long as no contact changes its piece of Π, and a full step without such a change reaches the
//! minimum. Along a Newton step the derivative F′ is piecewise linear and increasing; its root, the step length, is
//! found by Newton's method.
//!
//! V is not recomputed from the impulses: each step adds its changes to the velocities of contacts and to M(V −
//! V_free), because a small ε magnifies rounding errors.

use super::contact::Shape;
use super::point::{InteriorPoint, PathWorkspace};
use super::proximal_contact::ProximalContact;
use super::system::{all_inertias, for_each_change, push_all};
use crate::solver::kinematics::Model;
use crate::solver::problem::natural_map;

/// Initial value of the compliance ε with which proximal multipliers regularise each contact, relative to the
/// compliance 1/m_ij of a contact (effective mass m_ij), in a solve that starts far from a solution.
const FAR: f64 = 0.1;
/// Initial value of the compliance ε with which proximal multipliers regularise each contact, relative to the
/// compliance 1/m_ij of a contact (effective mass m_ij), in a solve that starts near the end of the central path of the
/// interior point method.
const CLOSE: f64 = 1e-5;
/// Minimum of the compliance ε with which proximal multipliers regularise each contact, relative to the compliance
/// 1/m_ij of a contact (effective mass m_ij). With a smaller ε, rounding errors would grow more than the error of the
/// impulses would fall.
const LEAST: f64 = 1e-10;
/// Factor by which the compliance ε, with which proximal multipliers regularise each contact, is multiplied each time
/// the minimum of the objective function of the bodies' velocities has been found.
const FACTOR: f64 = 0.1;
/// Limit of a solve by proximal multipliers that started far from a solution: it ends if the residual does not halve
/// within this number of factorisations.
const PATIENCE: u32 = 40;
/// Maximum number of factorisations of a solve by proximal multipliers that starts near the end of the central path of
/// the interior point method.
const FEW: u32 = 16;
/// Limit at or below which the minimum of the objective function counts as found, and the compliance is reduced. The
/// limit is for the squared norm of the gradient (in the metric of the inverse inertias), divided by its first value at
/// the present compliance.
const NEAR_MINIMUM: f64 = 1e-4;
/// Maximum number of evaluations in a line search. Each evaluation computes the derivative of the objective function by
/// the step length along the Newton step.
const TRIALS: u32 = 40;
/// Fraction of the initial derivative of the objective function along the Newton step, at or below which the derivative
/// counts as 0 in a line search.
const ROOT: f64 = 1e-9;

impl<M: Model, S: Shape, const D: usize> InteriorPoint<'_, M, S, D> {
    /// Finishes a solve by proximal multipliers, from the present impulses of the central path, which are near a
    /// solution. Returns true if the problem is then solved.
    pub(super) fn polish(&mut self) -> bool {
        self.approach(CLOSE, FEW, FEW)
    }

    /// Solves the problem by proximal multipliers, from the impulses with the smallest residual so far. Returns true if
    /// the problem is then solved.
    pub(super) fn solve_from_far(&mut self) -> bool {
        let PathWorkspace { contacts, best, .. } = &mut *self.workspace;
        for (contact, &impulse) in contacts.iter_mut().zip(&*best) {
            contact.impulse = impulse;
        }
        self.approach(FAR, u32::MAX, PATIENCE)
    }

    fn approach(&mut self, mut compliance: f64, most: u32, patience: u32) -> bool {
        self.begin_near();
        let (mut factorisations, mut milestone, mut since_milestone) = (0, f64::INFINITY, 0);
        loop {
            let mut steps = 0;
            let mut left_of_minimum = self.gradient(compliance);
            let enough = NEAR_MINIMUM * left_of_minimum;
            while left_of_minimum > enough {
                if factorisations >= most || since_milestone >= patience || self.is_spent() {
                    return false;
                }
                self.step_near(compliance);
                (steps, factorisations) = (steps + 1, factorisations + 1);
                self.report.factorisations += 1;
                let left = self.take_allowed(compliance);
                if left.is_nan() {
                    return false;
                }
                let is_bounded = self.has_bounded_rows();
                if left < self.best && is_bounded {
                    self.keep(left);
                }
                if is_bounded && self.is_within(left, 1.0) && self.settles_in(1) {
                    return true;
                }
                since_milestone += 1;
                if left < 0.5 * milestone {
                    (milestone, since_milestone) = (left, 0);
                }
                left_of_minimum = self.gradient(compliance);
            }
            if steps == 0 {
                return false;
            }
            let Self { workspace, numbers, .. } = self;
            for contact in &mut workspace.near {
                let trial = contact.trial(*numbers, compliance, 0.0);
                contact.impulse = contact.allowed::<S>(*numbers, trial);
            }
            compliance = (FACTOR * compliance).max(LEAST);
        }
    }

    /// Sets the initial impulses and velocities of the proximal multiplier method to the present impulses of the
    /// central path, projected on the allowed impulses.
    fn begin_near(&mut self) {
        let numbers = self.numbers;
        let PathWorkspace { near, contacts, .. } = &mut *self.workspace;
        near.clear();
        near.extend(contacts.iter().map(|contact| {
            let near = ProximalContact { bound: contact.bound, ..ProximalContact::default() };
            ProximalContact { impulse: near.allowed::<S>(numbers, contact.impulse), ..near }
        }));
        self.take_near(|contact| contact.impulse);
        let Self { problem, workspace, .. } = self;
        let PathWorkspace { near, contacts, momenta, graph, .. } = &mut **workspace;
        let mut of_contacts = near.iter_mut().zip(&*contacts);
        problem.for_each_velocity(&problem.bodies.now, |row, [normal, tangential]| {
            let Some((near, contact)) = of_contacts.next() else { return };
            near.velocity = [normal + (row.restitution_velocity + contact.lag), tangential];
        });
        momenta.clear();
        momenta.resize(graph.elimination.body_at.len(), [0.0; D]);
        let impulses = near.iter().map(|contact| contact.impulse);
        push_all(problem, &graph.elimination, impulses, momenta);
    }

    /// Sets the impulses of the problem to the result of `impulse` for each contact, and recomputes the velocities of
    /// the bodies. The result is the normal impulse plus cohesion impulse, and the tangential impulse, divided by the
    /// effective mass, m/s.
    fn take_near(&mut self, impulse: impl Fn(&ProximalContact) -> [f64; 2]) {
        let Self { problem, workspace, .. } = self;
        problem.write_impulses(workspace.near.iter().map(impulse));
    }

    /// Sets the impulses of the problem to the trial impulses, projected on the allowed impulses. A trial impulse, m/s,
    /// is the present impulse divided by the effective mass, minus the contact velocity (m/s) divided by the
    /// dimensionless compliance `compliance`. Along the tangent this quotient is multiplied by m_t/m_n, with the
    /// effective masses m_n and m_t along normal and tangent. Returns the residual of the new impulses under the
    /// friction model of the solve, dimensionless.
    fn take_allowed(&mut self, compliance: f64) -> f64 {
        let numbers = self.numbers;
        self.take_near(|contact| {
            contact.allowed::<S>(numbers, contact.trial(numbers, compliance, 0.0))
        });
        natural_map(self.problem)
    }

    /// Writes −∇F to the right-hand side of the linear system: the negative gradient of the objective function F (J) of
    /// the proximal multipliers with respect to the velocities of the bodies. Returns the squared norm ∇F·M⁻¹∇F of the
    /// gradient, in joules, with M the inertias of the bodies.
    fn gradient(&mut self, compliance: f64) -> f64 {
        let Self { problem, workspace, numbers, .. } = self;
        let PathWorkspace { graph, vector, near, momenta, .. } = &mut **workspace;
        let (numbers, elimination) = (*numbers, &graph.elimination);
        vector.clear();
        vector.extend(momenta.iter().map(|of_body| of_body.map(|momentum| -momentum)));
        let impulses = near
            .iter()
            .map(|contact| contact.allowed::<S>(numbers, contact.trial(numbers, compliance, 0.0)));
        push_all(problem, elimination, impulses, vector);
        let mut squared = 0.0;
        for (inertia, momenta) in all_inertias::<M, D>(problem, elimination).zip(&*vector) {
            for (momentum, inertia) in momenta.iter().zip(inertia) {
                squared += momentum * momentum / inertia;
            }
        }
        squared
    }

    /// Takes a Newton step of the bodies' velocities towards the minimum of the objective function of the proximal
    /// multipliers, from its present gradient. A line search determines the step length.
    fn step_near(&mut self, compliance: f64) {
        let Self { problem, workspace, numbers, .. } = self;
        let PathWorkspace { graph, system, vector, near, .. } = &mut **workspace;
        let (numbers, elimination) = (*numbers, &graph.elimination);
        let answers = near.iter().map(|contact| {
            let trial = contact.trial(numbers, compliance, 0.0);
            contact.piece::<S>(numbers, trial).stiffness(numbers, compliance)
        });
        system.assemble::<M, S>(problem, graph, answers);
        system.solve::<S>(elimination, vector);
        for_each_change(problem, elimination, vector, |number, change| {
            near[number].change = change;
        });
        let share = self.least_on_line(compliance);
        let Self { problem, workspace, .. } = self;
        let PathWorkspace { graph, vector, near, momenta, .. } = &mut **workspace;
        let all = all_inertias::<M, D>(problem, &graph.elimination).zip(momenta).zip(vector);
        for ((inertia, momenta), change) in all {
            for axis in 0..D {
                momenta[axis] += share * inertia[axis] * change[axis];
            }
        }
        for contact in near {
            for (velocity, change) in contact.velocity.iter_mut().zip(contact.change) {
                *velocity += share * change;
            }
        }
    }

    /// Returns the step length at which the objective function of the proximal multipliers has its minimum along the
    /// Newton step (exact line search).
    fn least_on_line(&self, compliance: f64) -> f64 {
        let Self { problem, workspace, numbers, .. } = self;
        let PathWorkspace { graph, vector, near, momenta, .. } = &**workspace;
        let (mut of_masses, mut at_start) = (0.0, 0.0);
        let all = all_inertias::<M, D>(problem, &graph.elimination).zip(momenta).zip(vector);
        for ((inertia, momenta), change) in all {
            for axis in 0..D {
                of_masses += inertia[axis] * change[axis] * change[axis];
                at_start += momenta[axis] * change[axis];
            }
        }
        // Derivatives F′ and F″ along the Newton step at step length `share`.
        let slopes = |share: f64| {
            let mut slopes = [at_start + share * of_masses, of_masses];
            for ((_, row), contact) in problem.rows().zip(near) {
                let trial = contact.trial(*numbers, compliance, share);
                let allowed = contact.allowed::<S>(*numbers, trial);
                let stiffness = contact.piece::<S>(*numbers, trial).stiffness(*numbers, compliance);
                let [normal, tangential] = contact.change;
                let along = |of: [f64; 2]| normal * of[0] + tangential * of[1];
                slopes[0] -= row.effective_mass * along(allowed);
                slopes[1] += row.effective_mass * along(stiffness.map(along));
            }
            slopes
        };
        let small = ROOT * slopes(0.0)[0].abs();
        let (mut before, mut behind, mut share) = (0.0, f64::INFINITY, 1.0);
        for _ in 0..TRIALS {
            let [slope, curvature] = slopes(share);
            if slope.abs() <= small {
                break;
            }
            if slope > 0.0 {
                behind = share;
            } else {
                before = share;
            }
            let next = share - slope / curvature;
            let halfway = if behind.is_finite() { 0.5 * (before + behind) } else { 2.0 * share };
            share = if next > before && next < behind { next } else { halfway };
        }
        share
    }
}
