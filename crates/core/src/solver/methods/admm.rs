//! Alternating directions of multipliers with a cached sparse factorisation (S. Boyd and others 2011; on contact
//! problems V. Acary, M. Brémond, O. Huber 2018).
//!
//! Body velocities V and contact velocities z, m/s, are separate unknowns. They are coupled by the condition HV = z,
//! with H the map from V to contact velocities, the impulses as multipliers, and a penalty m_ij/ε (effective mass m_ij,
//! kg; compliance ε, dimensionless). The impulses are reduced impulses (divided by the effective mass, m/s;
//! `contact::law`): the shifted normal impulse σ (normal impulse plus the largest impulse of cohesion, so that it is
//! never negative) and the tangential impulse λ_t. A contact has the normal n, the tangent t, the velocities v_n and
//! v_t along them, the effective masses m_n and m_t along them, and the friction bound bound(σ). With the normal
//! velocity plus the restitution term, u = v_n + ρ v_n^{n−1} (restitution ρ times v_n^{n−1}, the normal velocity before
//! the step), computed from V, one iteration computes the impulses σ' and λ_t' by the law,
//!
//! > σ' = max(σ − u/ε, 0),  λ_t' = clamp(λ_t − v_t m_t/(m_n ε), ±bound(σ')),
//!
//! sets z = v_n + ε (σ' − σ) along the normal and z = v_t + (ε m_n/m_t) (λ_t' − λ_t) along the tangent, and then
//! computes the velocities V from the impulses and the penalty for V's distance from z,
//!
//! > (M + Σ m_ij/ε (n nᵀ + m_t/m_n t tᵀ)) V = M V_free + Σ m_ij [n (2σ' − σ − c + v_n/ε) + t (…)],
//!
//! with the inertias M of the bodies, their velocities V_free without contacts, and the capture speed c, m/s (the
//! opening speed that cohesion cancels in one step). The term (…) is 2λ_t' − λ_t + v_t m_t/(m_n ε), the tangential
//! counterpart of the term along n. The matrix depends only on ε, so an iteration is one pass over the contacts and one
//! solve with cached factors. At a fixed point V agrees with the impulses, and the impulses with the law: the natural
//! map is 0. ε determines how fast the impulses and the velocities converge; it is changed if one of two residuals of
//! all contacts, m/s, is much larger than the other. The first residual, ε (σ' − σ) along the normal, is the difference
//! between z and the contact velocities HV. The second residual, (z' − z)/ε with the new z' and the previous z, is the
//! change of the contact velocities in an iteration divided by ε.

use super::contact_system::{BestIterate, BodySystem, ContactSystem, ScaledVector};
use super::stopping::{SolveReport, is_tested};
use crate::contact::law::{coulomb, signorini};
use crate::solver::kinematics::Model;
use crate::solver::linear::{BlockMatrix, Elimination};
use crate::solver::problem::{Row, StepProblem};
use crate::solver::settings::SolverSettings;

/// Compliance ε with which a solve begins, relative to the compliance 1/m_ij of a contact (effective mass m_ij). A
/// penalty proportional to 1/ε couples the velocities of bodies to separate unknowns, the contact velocities; with a
/// smaller ε it keeps the two closer together. The method changes ε during the solve.
const FIRST_COMPLIANCE: f64 = 0.03;
/// Number of iterations between two decisions whether the compliance ε is changed (the inverse of the penalty that
/// couples body velocities and contact velocities). A change requires a new factorisation, which costs as much as about
/// ten iterations.
const BALANCE_INTERVAL: u32 = 24;
/// Minimum ratio of the larger to the smaller of two residuals at which the compliance ε is changed (the inverse of the
/// penalty that couples body velocities and contact velocities). The first residual is the difference between these two
/// velocities; the second is the change of the contact velocities in an iteration, divided by ε.
const OUT_OF_BALANCE: f64 = 4.0;
/// Maximum factor by which one change increases or decreases the compliance ε (the inverse of the penalty that couples
/// body velocities and contact velocities).
const LARGEST_CHANGE: f64 = 10.0;
/// Minimum and maximum of the compliance ε (the inverse of the penalty that couples body velocities and contact
/// velocities), relative to the compliance 1/m_ij of a contact (effective mass m_ij). With a smaller ε rounding errors
/// in the factorisation matter; with a larger ε the effect of an impulse hardly spreads from contact to contact.
const COMPLIANCES: [f64; 2] = [1e-5, 1.0];

/// Work memory of the method, one part for each number of degrees of freedom of a body (1 to 3). A part that is not
/// used allocates nothing.
#[derive(Debug, Default)]
pub(crate) struct AdmmMemory {
    one: Directions<1>,
    two: Directions<2>,
    three: Directions<3>,
    /// The impulses with the smallest residual in the present solve, divided by the roots of the effective masses, √J.
    best: ScaledVector,
}

impl Clone for AdmmMemory {
    /// Returns empty memory instead of a copy, because the contents are not needed after a solve.
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// Unknowns and linear equations of one solve: body velocities V, m/s, contact velocities z, m/s, and the matrix of the
/// equations for V, which contains the penalty for the difference between V and z.
#[derive(Debug, Default)]
struct Directions<const D: usize> {
    elimination: Elimination,
    matrix: BlockMatrix<D>,
    /// Right-hand side of the linear equations; after their solution, the body velocities V in elimination order (the
    /// order of the bodies in the factorised matrix), m/s.
    vector: Vec<[f64; D]>,
    /// Contact velocities z (normal, tangential), m/s, which a penalty couples to the body velocities. They do not
    /// contain the restitution term (restitution times the normal velocity before the step).
    targets: ScaledVector,
    impulses: ScaledVector,
    before: ScaledVector,
}

pub(super) fn solve<M: Model>(
    problem: &mut StepProblem<M>,
    memory: &mut AdmmMemory,
    settings: &SolverSettings,
) -> SolveReport {
    let AdmmMemory { one, two, three, best } = memory;
    match M::DEGREES {
        1 => run::<M, 1>(problem, one, best, settings),
        2 => run::<M, 2>(problem, two, best, settings),
        _ => run::<M, 3>(problem, three, best, settings),
    }
}

fn run<M: Model, const D: usize>(
    problem: &mut StepProblem<M>,
    directions: &mut Directions<D>,
    best_impulses: &mut ScaledVector,
    settings: &SolverSettings,
) -> SolveReport {
    let pairs = problem.rows.pairs.iter().map(|row| (row.i, row.j));
    directions.elimination.analyse(problem.bodies.now.len(), pairs);
    let mut best = BestIterate::new(&BodySystem::new(problem), best_impulses);
    let mut report = SolveReport::default();
    let mut compliance = FIRST_COMPLIANCE;
    directions.factorise::<M>(problem, compliance);
    report.factorisations += 1;
    directions.start::<M>(problem);
    while report.sweeps < settings.max_sweeps {
        report.sweeps += 1;
        let is_tested = is_tested(report.sweeps, settings);
        if is_tested {
            BodySystem::new(problem).read(&mut directions.before);
        }
        let balance = directions.apply_law::<M>(problem, compliance);
        if is_tested {
            problem.form_velocities();
            let system = BodySystem::new(problem);
            if system.is_settled(&directions.before, settings) {
                report.converged = true;
                break;
            }
            system.read(&mut directions.impulses);
            if best.look(&system, &directions.impulses, report.sweeps, settings) {
                break;
            }
        }
        if report.sweeps.is_multiple_of(BALANCE_INTERVAL) {
            let wanted = compliance * balance.clamp(1.0 / LARGEST_CHANGE, LARGEST_CHANGE);
            let wanted = wanted.clamp(COMPLIANCES[0], COMPLIANCES[1]);
            let change = wanted / compliance;
            if change.max(1.0 / change) > OUT_OF_BALANCE.sqrt() {
                compliance = wanted;
                directions.factorise::<M>(problem, compliance);
                report.factorisations += 1;
            }
        }
        directions.take_loads::<M>(problem, compliance);
        directions.matrix.solve(&directions.elimination, &mut directions.vector);
    }
    if !report.converged {
        problem.form_velocities();
        report.stalled = best.restore(&mut BodySystem::new(problem), report.sweeps).stalled;
    }
    report
}

impl<const D: usize> Directions<D> {
    /// Factorises the matrix of the linear equations for the body velocities V. `compliance` is the dimensionless
    /// compliance ε, the inverse of the penalty that couples V and the contact velocities.
    fn factorise<M: Model>(&mut self, problem: &StepProblem<M>, compliance: f64) {
        let Self { elimination, matrix, .. } = self;
        matrix.start::<M>(elimination, &problem.bodies.masses);
        let tangential = 1.0 / M::TANGENTIAL_COMPLIANCE;
        let add = |block: &mut [[f64; D]; D], stiffness: f64, a: &Gradients, b: &Gradients| {
            for (row, entries) in block.iter_mut().enumerate() {
                for (column, entry) in entries.iter_mut().enumerate() {
                    *entry += stiffness * a[0][row] * b[0][column];
                    if M::FRICTION {
                        *entry += stiffness * tangential * a[1][row] * b[1][column];
                    }
                }
            }
        };
        for row in &problem.rows.fixed {
            let [on_i, _] = M::gradients(row.normal);
            let i = elimination.place_of[row.i as usize];
            add(matrix.diagonal_mut(i), row.effective_mass / compliance, &on_i, &on_i);
        }
        for row in &problem.rows.pairs {
            let [on_i, on_j] = M::gradients(row.normal);
            let i = elimination.place_of[row.i as usize];
            let j = elimination.place_of[row.j as usize];
            let stiffness = row.effective_mass / compliance;
            add(matrix.diagonal_mut(i), stiffness, &on_i, &on_i);
            add(matrix.diagonal_mut(j), stiffness, &on_j, &on_j);
            let number = elimination.block(i.min(j), i.max(j)) as u32;
            let (i_to_j, j_to_i) = matrix.off_diagonal_mut(number, i < j);
            add(i_to_j, stiffness, &on_i, &on_j);
            add(j_to_i, stiffness, &on_j, &on_i);
        }
        matrix.factorise(elimination);
    }

    /// Sets the body velocities V to the present velocities of the problem's bodies, and the contact velocities z to
    /// the relative velocities at the contacts that follow from V.
    fn start<M: Model>(&mut self, problem: &StepProblem<M>) {
        let bodies =
            self.elimination.body_at.iter().map(|&body| &problem.bodies.now[body as usize]);
        self.vector.clear();
        self.vector.extend(bodies.map(|body| {
            let coordinates = M::coordinates(body);
            std::array::from_fn::<f64, D, _>(|axis| coordinates[axis])
        }));
        let mut targets = std::mem::take(&mut self.targets);
        targets.clear();
        targets.extend(
            problem
                .rows()
                .map(|(number, row)| self.velocity::<M>(row, problem.rows.is_pair(number))),
        );
        self.targets = targets;
    }

    /// Returns the normal and tangential velocity (v_n, v_t) at a contact that follow from the body velocities V, m/s.
    #[inline(always)]
    fn velocity<M: Model>(&self, row: &Row<M>, is_pair: bool) -> [f64; 2] {
        let [on_i, on_j] = M::gradients(row.normal);
        let along = |gradient: &[f64; 3], body: u32| -> f64 {
            let velocity = &self.vector[self.elimination.place_of[body as usize] as usize];
            (0..D).map(|axis| gradient[axis] * velocity[axis]).sum()
        };
        let mut velocity = [along(&on_i[0], row.i), along(&on_i[1], row.i)];
        if is_pair {
            velocity[0] += along(&on_j[0], row.j);
            velocity[1] += along(&on_j[1], row.j);
        }
        velocity
    }

    /// Computes the contact impulses and the contact velocities z from the body velocities V. Returns the factor by
    /// which the dimensionless compliance ε (`compliance`) must be multiplied to make two residuals equal. The first is
    /// the difference between z and the contact velocities that follow from V, and is proportional to ε; the second is
    /// the change of z in this iteration divided by ε.
    fn apply_law<M: Model>(&mut self, problem: &mut StepProblem<M>, compliance: f64) -> f64 {
        let (mut of_velocities, mut of_impulses) = (0.0, 0.0);
        let mut targets = std::mem::take(&mut self.targets);
        for (number, target) in targets.iter_mut().enumerate() {
            // The body velocities V contain neither the shear velocity of periodic images nor the speed of surfaces.
            let is_pair = problem.rows.is_pair(number);
            let [away, along] = match is_pair {
                true => M::slide_along(problem.rows.get(number).normal),
                false => [0.0, problem.rows.surface_speed(number)],
            };
            let law = problem.law_of(number);
            let row = problem.rows.get_mut(number);
            let [normal, tangential] = self.velocity::<M>(row, is_pair);
            let opening = normal - away + row.restitution_velocity;
            let shifted = signorini(row.shifted_impulse - opening / compliance);
            let change = compliance * (shifted - row.shifted_impulse);
            row.shifted_impulse = shifted;
            let before = std::mem::replace(&mut target[0], normal + change);
            let mut note = |change: f64, of_target: f64| {
                of_velocities += row.effective_mass * change * change;
                of_impulses += row.effective_mass * of_target * of_target;
            };
            note(change, (target[0] - before) / compliance);
            if M::FRICTION {
                let softness = compliance * M::TANGENTIAL_COMPLIANCE;
                let bound = law.friction_bound(shifted);
                let slip = tangential - along;
                let moved = coulomb(row.tangential_impulse - slip / softness, bound);
                let change = softness * (moved - row.tangential_impulse);
                row.tangential_impulse = moved;
                let before = std::mem::replace(&mut target[1], tangential + change);
                note(change, (target[1] - before) / softness);
            }
        }
        self.targets = targets;
        let balance: f64 = of_impulses / of_velocities;
        // If no impulse or velocity changes, the compliance is kept.
        if balance.is_finite() && balance > 0.0 { balance.sqrt().sqrt() } else { 1.0 }
    }

    /// Computes the right-hand side of the linear equations for the body velocities V from the impulses and the contact
    /// velocities z. `compliance` is the dimensionless compliance ε.
    fn take_loads<M: Model>(&mut self, problem: &StepProblem<M>, compliance: f64) {
        let Self { elimination, vector, targets, .. } = self;
        for (place, &body) in elimination.body_at.iter().enumerate() {
            let free = M::coordinates(&problem.bodies.free[body as usize]);
            let mass = problem.bodies.masses[body as usize];
            for axis in 0..D {
                let inertia = mass * M::INERTIA_OVER_MASS[axis];
                vector[place][axis] = inertia * free[axis];
            }
        }
        let softness = compliance * M::TANGENTIAL_COMPLIANCE;
        for ((number, row), target) in problem.rows().zip(targets) {
            let [normal, tangential] = problem.reduced_impulse(number, row);
            let mass = row.effective_mass;
            let normal = mass * (normal + target[0] / compliance);
            let tangential =
                if M::FRICTION { mass * (tangential + target[1] / softness) } else { 0.0 };
            let [on_i, on_j] = M::gradients(row.normal);
            let mut push = |gradients: &Gradients, body: u32| {
                let load = &mut vector[elimination.place_of[body as usize] as usize];
                for (axis, load) in load.iter_mut().enumerate() {
                    *load += normal * gradients[0][axis] + tangential * gradients[1][axis];
                }
            };
            push(&on_i, row.i);
            if problem.rows.is_pair(number) {
                push(&on_j, row.j);
            }
        }
    }
}

/// Gradients of a contact's normal and tangential velocity (v_n, v_t) with respect to the velocity coordinates of a
/// body.
type Gradients = [[f64; 3]; 2];
