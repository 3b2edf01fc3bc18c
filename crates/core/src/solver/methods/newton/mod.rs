//! Semi-smooth Newton in body-velocity space, with a sparse direct factorisation.
//!
//! The contact law is a fixed point of projections (`contact::law`). Regularised with a compliance ε
//! it reads, per contact and in reduced impulses,
//!
//! > σ' = max(σ − u/ε, 0),  λ_t' = clamp(λ_t − v_t m_t/(m_n ε), ±μσ'),
//!
//! u = v_n + ρ v_n^{n−1}, with the velocities at the *end* of the Newton step. Whether a contact is
//! open, sticks or slips is guessed from the present state; each guess makes the law linear, so that
//! impulses can be eliminated and velocities V remain:
//!
//! > M (V − V_free) = Σ m_ij [ n (σ' − c) + t λ_t' ],  c the capture speed,
//!
//! one sparse system with a D × D block a body: masses plus contact stiffnesses m_ij/ε. A slipping
//! contact, λ_t' = ±μσ', brings the unsymmetric n + (±μ) t. The exact solution is a fixed point for
//! any ε: a small one converges in few steps, a larger one is more robust where guesses flip.
//! After each step the impulses are projected on what the law allows, velocities are formed
//! anew from them, and a few Gauss–Seidel sweeps mend what the guesses got wrong.
//!
//! What is solved for is the *change* of the velocities, with the change of the impulses at rest as
//! the load. Solved for the velocities themselves, rounding would leave an error of V·10⁻¹⁶ in them
//! and, times the stiffness 1/ε twice, stall the residual of a fast pile at 10⁻⁴ … 10⁻⁷.
//!
//! The method is that of an augmented Lagrangian treated by generalised Newton steps (P. Alart,
//! A. Curnier 1991), with ε adapted as in a trust region.

mod assembly;
mod descent;
mod memory;

use self::assembly::assemble;
use self::descent::Descent;
pub(super) use self::memory::NewtonMemory;
use self::memory::{Guess, Workspace};
use super::info::{COULOMB, MethodInfo, MethodOrder};
use super::method::Method;
use super::nncg;
use super::nsgs::{sweep, tested_sweep};
use super::report::SolveReport;
use super::shared::body_system::SystemMemory;
use crate::contact::law;
use crate::solver::problem::{Kinematics, Model, StepProblem, residual};
use crate::solver::settings::SolverSettings;

/// What there is to know of it.
pub(super) const INFO: MethodInfo = MethodInfo {
    method: Method::Newton,
    name: "newton",
    summary: "semi-smooth Newton, sparse direct: all contacts together, for tight tolerances",
    solves: COULOMB,
    source: "P. Alart, A. Curnier, generalised Newton methods for contact with friction (1991)",
    order: MethodOrder::OfSettings,
    takes_models: false,
    takes_drives: false,
    takes_shear: true,
};

/// Compliance of the first step.
const FIRST_COMPLIANCE: f64 = 1e-7;
/// Below this, rounding in the factorisation eats what a smaller compliance would gain.
const SMALLEST_COMPLIANCE: f64 = 1e-7;
/// Above this a Newton step is no better than sweeps, which then take over for a while.
const LARGEST_COMPLIANCE: f64 = 0.1;
/// Factor of the compliance after a step that is accepted.
const AFTER_SUCCESS: f64 = 0.2;
/// Factor of the compliance after a step that is refused.
const AFTER_FAILURE: f64 = 10.0;
/// Sweeps before the first factorisation: many steps of a pile at rest need no more.
const SWEEPS_FIRST: u32 = 4;
/// Sweeps after each factorisation: they mend what the guesses got wrong, at a fraction of its cost.
const SWEEPS_AFTER: u32 = 4;
/// Sweeps where Newton stalls, doubled each time up to [`MOST_SWEEPS_BETWEEN`].
const SWEEPS_BETWEEN: u32 = 20;
/// See [`SWEEPS_BETWEEN`].
const MOST_SWEEPS_BETWEEN: u32 = 200;
/// Factorisations without halving the best residual after which the solve is given up.
const PATIENCE: u32 = 100;

/// Solves a prepared problem.
pub(super) fn solve<M: Model>(
    problem: &mut StepProblem<M::Kinematics>,
    memory: &mut NewtonMemory,
    settings: &SolverSettings,
) -> SolveReport {
    let NewtonMemory { one, two, three, gradients } = memory;
    match M::Kinematics::DEGREES {
        1 => Newton::<M, 1> { problem, settings, workspace: one, gradients }.run(),
        2 => Newton::<M, 2> { problem, settings, workspace: two, gradients }.run(),
        _ => Newton::<M, 3> { problem, settings, workspace: three, gradients }.run(),
    }
}

/// One solve.
struct Newton<'a, M: Model, const D: usize> {
    problem: &'a mut StepProblem<M::Kinematics>,
    settings: &'a SolverSettings,
    workspace: &'a mut Workspace<D>,
    gradients: &'a mut SystemMemory,
}

impl<M: Model, const D: usize> Newton<'_, M, D> {
    fn run(mut self) -> SolveReport {
        let mut report = SolveReport::default();
        let most_sweeps = self.settings.max_sweeps;
        if self.settles_in(SWEEPS_FIRST.min(most_sweeps), &mut report) {
            return report;
        }
        self.workspace.graph.analyse(self.problem);
        let mut descent = Descent::new(residual::<M>(self.problem));
        save(self.problem, &mut self.workspace.saved);
        self.workspace.best.clone_from(&self.workspace.saved);
        let mut compliance = FIRST_COMPLIANCE;
        let mut sweeps_between = SWEEPS_BETWEEN;
        while report.sweeps + SWEEPS_AFTER <= most_sweeps && descent.since_milestone < PATIENCE {
            self.newton_step(compliance);
            report.factorisations += 1;
            for _ in 1..SWEEPS_AFTER {
                sweep::<M, false>(self.problem);
            }
            report.sweeps += SWEEPS_AFTER - 1;
            if self.settles_in(1, &mut report) {
                return report;
            }
            let mut now = residual::<M>(self.problem);
            descent.since_milestone += 1;
            // Not a number is not below anything.
            if now < descent.bound() {
                compliance = (compliance * AFTER_SUCCESS).max(SMALLEST_COMPLIANCE);
            } else {
                restore(self.problem, &self.workspace.saved);
                compliance *= AFTER_FAILURE;
                if compliance <= LARGEST_COMPLIANCE {
                    continue;
                }
                let sweeps = sweeps_between.min(most_sweeps - report.sweeps);
                if self.settles_in(sweeps, &mut report) {
                    return report;
                }
                sweeps_between = (2 * sweeps_between).min(MOST_SWEEPS_BETWEEN);
                compliance = FIRST_COMPLIANCE;
                now = residual::<M>(self.problem);
            }
            save(self.problem, &mut self.workspace.saved);
            if descent.accept(now) {
                self.workspace.best.clone_from(&self.workspace.saved);
            }
        }
        restore(self.problem, &self.workspace.best);
        self.go_on_without(report)
    }

    /// Sweeps up to so many times; whether the stopping test is met.
    fn settles_in(&mut self, sweeps: u32, report: &mut SolveReport) -> bool {
        for _ in 0..sweeps {
            report.sweeps += 1;
            if tested_sweep::<M>(self.problem, self.settings) {
                report.converged = true;
                break;
            }
        }
        report.converged
    }

    /// Where Newton's method leads nowhere, conjugate gradients use up the sweeps that are left:
    /// they solve some of what it cannot, and tell where there is nothing to be solved.
    fn go_on_without(self, report: SolveReport) -> SolveReport {
        let left = self.settings.max_sweeps - report.sweeps;
        if left == 0 {
            return report;
        }
        let settings = SolverSettings { max_sweeps: left, ..*self.settings };
        let rest = nncg::solve::<M>(self.problem, self.gradients, &settings);
        SolveReport {
            sweeps: report.sweeps + rest.sweeps,
            factorisations: report.factorisations,
            ..rest
        }
    }

    /// Guesses, solves for velocities, and takes the impulses that go with them.
    fn newton_step(&mut self, compliance: f64) {
        assemble::<M, D>(self.problem, self.workspace, compliance);
        let Workspace { graph, matrix, vector, .. } = &mut *self.workspace;
        matrix.factorise(&graph.elimination);
        matrix.solve(&graph.elimination, vector);
        self.take_impulses(compliance);
        self.problem.form_velocities();
    }

    /// The regularised law at the new velocities, projected on what the law allows.
    fn take_impulses(&mut self, compliance: f64) {
        let Workspace { graph, vector, guesses, .. } = &*self.workspace;
        let places = &graph.elimination.place_of;
        let StepProblem { bodies, fixed_rows, pair_rows, friction, capture_speed, .. } =
            &mut *self.problem;
        let along = |gradient: &[f64; 3], body: u32| -> f64 {
            let velocity = &vector[places[body as usize] as usize];
            (0..D).map(|axis| gradient[axis] * velocity[axis]).sum()
        };
        let fixed_count = fixed_rows.len();
        let rows = fixed_rows.iter_mut().chain(pair_rows).enumerate();
        for ((number, row), guess) in rows.zip(guesses) {
            let [[normal_i, tangent_i], [normal_j, tangent_j]] =
                M::Kinematics::gradients(row.normal);
            let body_i = &bodies[row.i as usize];
            let [mut normal_velocity, mut tangential_velocity] = if number < fixed_count {
                row.velocity(body_i)
            } else {
                M::Kinematics::relative_velocity(row.normal, body_i, &bodies[row.j as usize])
            };
            normal_velocity += along(&normal_i, row.i);
            tangential_velocity += along(&tangent_i, row.i);
            if number >= fixed_count {
                normal_velocity += along(&normal_j, row.j);
                tangential_velocity += along(&tangent_j, row.j);
            }
            let u = normal_velocity + row.restitution_velocity;
            let shifted = match guess {
                Guess::Open => 0.0,
                _ => law::signorini(row.shifted_impulse - u / compliance),
            };
            row.shifted_impulse = shifted;
            if M::FRICTION {
                let bound = M::friction_bound(*friction, shifted, *capture_speed);
                let softness = M::Kinematics::TANGENTIAL_COMPLIANCE * compliance;
                row.tangential_impulse = match guess {
                    Guess::Open => 0.0,
                    Guess::Stick => {
                        law::coulomb(row.tangential_impulse - tangential_velocity / softness, bound)
                    }
                    Guess::Slip(sign) => sign * bound,
                };
            }
        }
    }
}

/// Keeps the rows' impulses.
fn save<K: Kinematics>(problem: &StepProblem<K>, impulses: &mut Vec<[f64; 2]>) {
    let rows = problem.fixed_rows.iter().chain(&problem.pair_rows);
    impulses.clear();
    impulses.extend(rows.map(|row| [row.shifted_impulse, row.tangential_impulse]));
}

/// Goes back to kept impulses, and to the velocities that they make.
fn restore<K: Kinematics>(problem: &mut StepProblem<K>, impulses: &[[f64; 2]]) {
    let rows = problem.fixed_rows.iter_mut().chain(&mut problem.pair_rows);
    for (row, &[shifted, tangential]) in rows.zip(impulses) {
        row.shifted_impulse = shifted;
        row.tangential_impulse = tangential;
    }
    problem.form_velocities();
}
