//! Semi-smooth Newton method for the velocities of bodies, with a sparse direct factorisation.
//!
//! The contact law is a fixed point of projections (`contact::law`). A contact has the impulses σ (normal impulse plus
//! cohesion impulse) and λ_t (tangential), both divided by the effective mass, m/s, the velocities v_n and v_t along
//! its normal n and tangent t, the effective masses m_n and m_t along them, and the friction coefficient μ; u = v_n + ρ
//! v_n^{n−1} is the normal velocity plus the restitution term (restitution ρ times v_n^{n−1}, the normal velocity
//! before the step). Regularised with a dimensionless compliance ε the law for the impulses σ' and λ_t' after a Newton
//! step is
//!
//! > σ' = max(σ − u/ε, 0),  λ_t' = clamp(λ_t − v_t m_t/(m_n ε), ±μσ'),
//!
//! with the impulses σ and λ_t before the step, and the velocities u and v_t at the *end* of the step. From the present
//! impulses and velocities the method predicts the state of each contact: open, stick or slip. With a predicted state
//! the law is linear, so impulses can be eliminated and the velocities V of the bodies remain:
//!
//! > M (V − V_free) = Σ m_ij [ n (σ' − c) + t λ_t' ],
//!
//! with the inertias M of the bodies, their velocities V_free without contacts, the effective mass m_ij of a contact
//! and the capture speed c, m/s (the opening speed that cohesion cancels in one step). This is one sparse system with a
//! block per body, whose size is the body's number of degrees of freedom. Its matrix is the sum of the masses and the
//! contact stiffnesses m_ij/ε. A slipping contact, λ_t' = ±μσ', makes the matrix unsymmetric: its normal velocity
//! (along n) causes an impulse along n ± μt. The exact solution is a fixed point for any ε. With a small ε the method
//! converges in few steps; with a larger ε it also converges for some problems whose predicted states keep changing. A
//! rolling moment is one more clamp, ψ' = clamp(ψ − v_r/(W ε), ±μ_r σ'), with its own predicted state; ψ and ψ' are the
//! reduced rolling impulse before and after the step, m/s, v_r is the rolling velocity, m/s, W the dimensionless
//! compliance of the contact to rolling, and μ_r the coefficient of rolling friction (`problem::rolling`). After each
//! step
//!
//! 1. the impulses are projected on the law, and the velocities are computed from them;
//! 2. a few Gauss–Seidel sweeps correct wrong predictions;
//! 3. after the first factorisations, the contacts that contribute most to the residual are also solved separately
//!    (`nonlinear_elimination`).
//!
//! The unknown is the *change* of the velocities, and the right-hand side is the change of the impulses at the present
//! velocities. If the velocities themselves were the unknown, rounding would leave an error of V·10⁻¹⁶ in them.
//! Multiplied by the stiffness 1/ε twice, this error would stall the residual of a fast pile at 10⁻⁴ … 10⁻⁷.
//!
//! The method is an augmented Lagrangian with generalised Newton steps (P. Alart, A. Curnier 1991). ε is adapted as in
//! a trust region.

use super::contact_system::{BodySystem, WorkVectors};
use super::newton_terms::{Guess, RollingTerms, Terms, guess, guess_rolling};
use super::nncg;
use super::nonlinear_elimination::NonlinearElimination;
use super::pass::{settles_in, sweep};
use super::stopping::SolveReport;
use crate::contact::law::{coulomb, signorini};
use crate::solver::kinematics::Model;
use crate::solver::linear::{BlockMatrix, ContactGraph};
use crate::solver::onlooker::{SolveProgress, is_ended};
use crate::solver::problem::{StepProblem, residual};
use crate::solver::settings::SolverSettings;

/// Initial value of the compliance ε, with which Newton's method regularises the contact law, relative to the
/// compliance 1/m_ij of a contact (effective mass m_ij).
const FIRST_COMPLIANCE: f64 = 1e-7;
/// Minimum of the compliance ε, with which Newton's method regularises the contact law, relative to the compliance
/// 1/m_ij of a contact (effective mass m_ij). With a smaller ε, rounding errors in the factorisation cost as much
/// accuracy as the smaller ε gains.
const SMALLEST_COMPLIANCE: f64 = 1e-7;
/// Maximum of the compliance ε, with which Newton's method regularises the contact law, relative to the compliance
/// 1/m_ij of a contact (effective mass m_ij). With a larger ε a Newton step is no better than sweeps, so a few sweeps
/// replace the next Newton step.
const LARGEST_COMPLIANCE: f64 = 0.1;
/// Factor by which the compliance ε, with which Newton's method regularises the contact law, is multiplied after a
/// Newton step whose result is kept.
const AFTER_SUCCESS: f64 = 0.2;
/// Factor by which the compliance ε, with which Newton's method regularises the contact law, is multiplied after a
/// Newton step whose result is dropped because its residual is too large.
const AFTER_FAILURE: f64 = 10.0;
/// Number of sweeps before the first factorisation: many time steps of a pile at rest are solved by these sweeps and
/// need no factorisation.
const SWEEPS_FIRST: u32 = 4;
/// Number of sweeps after each factorisation. The sweeps correct wrongly predicted contact states (open, stick, slip)
/// at a fraction of the cost of a factorisation.
const SWEEPS_AFTER: u32 = 4;
/// Number of sweeps that replace a Newton step if even the largest compliance ε, with which Newton's method regularises
/// the contact law, gives no improvement. The number is doubled each time, up to [`MOST_SWEEPS_BETWEEN`].
const SWEEPS_BETWEEN: u32 = 20;
const MOST_SWEEPS_BETWEEN: u32 = 200;
/// Number of factorisations at the beginning of a solve that are not followed by non-linear elimination (a separate
/// solution of the contacts that contribute most to the residual). If elimination begins with the first factorisation,
/// easy steps, which need few factorisations, take twice as long. Of 21,600 steps of 138 grains, solved to 1e-6, 1,339
/// are unsolved without elimination, in a computing time of 60 s. With elimination after 0, 4, 8, 16 and 32
/// factorisations, 878, 961, 875, 893 and 921 steps are unsolved, in computing times of 136, 124, 121, 120 and 100 s.
const FACTORISATIONS_FIRST: u32 = 8;

/// Limits of Newton's method, and of the conjugate gradients that follow if it fails.
#[derive(Clone, Copy, Debug)]
pub(super) struct NewtonEffort {
    /// Newton's method stops if the residual does not halve within this number of factorisations.
    pub patience: u32,
    /// Maximum number of sweeps of conjugate gradients after Newton's method has failed. The maximum number of sweeps
    /// of the settings applies, too.
    pub sweeps_after: u32,
}

impl NewtonEffort {
    /// Limits of a solve that may use all sweeps of the settings. Newton's method stops if the residual does not halve
    /// within 100 factorisations. Then conjugate gradients may use all remaining sweeps.
    pub(super) const FULL: Self = Self { patience: 100, sweeps_after: u32::MAX };
}

/// Number of previous residuals that limit the residual of the next Newton step: the result of the step is kept if its
/// residual is below [`ENOUGH`] times the largest of these previous residuals. So the residual may rise for a few steps
/// before it falls. With 1 previous residual, useful steps are rejected; with 15, many useless steps are accepted.
const HISTORY: usize = 6;
/// Maximum residual of a Newton step whose result is kept, divided by the largest of the last [`HISTORY`] residuals.
const ENOUGH: f64 = 0.99;

/// Work memory of Newton's method, one part for each number of degrees of freedom of a body (1 to 3). A part that is
/// not used allocates nothing.
#[derive(Clone, Debug, Default)]
pub(crate) struct NewtonMemory {
    one: NewtonWorkspace<1>,
    two: NewtonWorkspace<2>,
    three: NewtonWorkspace<3>,
}

/// Work memory of a solve whose bodies have `D` degrees of freedom.
#[derive(Clone, Debug, Default)]
struct NewtonWorkspace<const D: usize> {
    graph: ContactGraph,
    matrix: BlockMatrix<D>,
    vector: Vec<[f64; D]>,
    guesses: Vec<Guess>,
    /// For each contact, the predicted state of its rolling moment: below its bound, at its bound, or 0 because the
    /// contact is open. Empty without rolling friction.
    rolling_guesses: Vec<Guess>,
    alone: NonlinearElimination,
    /// Impulses of all contacts after the last step whose result was kept: normal impulse plus cohesion impulse, and
    /// tangential impulse, divided by the effective mass, m/s.
    saved: Vec<[f64; 2]>,
    /// The impulses of all contacts that gave the smallest residual so far: normal impulse plus cohesion impulse, and
    /// tangential impulse, divided by the effective mass, m/s.
    best: Vec<[f64; 2]>,
}

pub(super) fn solve<M: Model>(
    problem: &mut StepProblem<M>,
    memory: &mut NewtonMemory,
    vectors: &mut WorkVectors,
    settings: &SolverSettings,
    effort: NewtonEffort,
) -> SolveReport {
    let NewtonMemory { one, two, three } = memory;
    match M::DEGREES {
        1 => Newton::<M, 1> { problem, settings, effort, workspace: one, vectors }.run(),
        2 => Newton::<M, 2> { problem, settings, effort, workspace: two, vectors }.run(),
        _ => Newton::<M, 3> { problem, settings, effort, workspace: three, vectors }.run(),
    }
}

struct Newton<'a, M: Model, const D: usize> {
    problem: &'a mut StepProblem<M>,
    settings: &'a SolverSettings,
    effort: NewtonEffort,
    workspace: &'a mut NewtonWorkspace<D>,
    /// Work memory of the conjugate gradients that follow if Newton's method fails.
    vectors: &'a mut WorkVectors,
}

impl<M: Model, const D: usize> Newton<'_, M, D> {
    fn run(mut self) -> SolveReport {
        let mut report = SolveReport::default();
        let most_sweeps = self.settings.max_sweeps;
        if self.settles_in(SWEEPS_FIRST.min(most_sweeps), &mut report) {
            return report;
        }
        self.workspace.graph.analyse(self.problem);
        let mut history = ResidualHistory::new(residual(self.problem));
        self.problem.rows.read_impulses(&mut self.workspace.saved);
        self.workspace.best.clone_from(&self.workspace.saved);
        let mut compliance = FIRST_COMPLIANCE;
        let mut sweeps_between = SWEEPS_BETWEEN;
        let patience = self.effort.patience;
        while report.sweeps + SWEEPS_AFTER <= most_sweeps && history.since_milestone < patience {
            if is_ended(SolveProgress { sweeps: report.sweeps, residual: None }) {
                break;
            }
            self.newton_step(compliance);
            report.factorisations += 1;
            for _ in 1..SWEEPS_AFTER {
                sweep::<M, false>(self.problem);
            }
            report.sweeps += SWEEPS_AFTER - 1;
            if report.factorisations > FACTORISATIONS_FIRST {
                self.workspace.alone.apply(self.problem);
            }
            if self.settles_in(1, &mut report) {
                return report;
            }
            let mut now = residual(self.problem);
            history.since_milestone += 1;
            // NaN compares false, so the step is rejected.
            if now < history.bound() {
                compliance = (compliance * AFTER_SUCCESS).max(SMALLEST_COMPLIANCE);
            } else {
                self.problem.write_impulses(self.workspace.saved.iter().copied());
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
                now = residual(self.problem);
            }
            self.problem.rows.read_impulses(&mut self.workspace.saved);
            if history.accept(now) {
                self.workspace.best.clone_from(&self.workspace.saved);
            }
        }
        self.problem.write_impulses(self.workspace.best.iter().copied());
        self.go_on_without(report)
    }

    /// Performs up to `sweeps` Gauss–Seidel sweeps and adds them to `report`. Returns true if the stopping test is met.
    fn settles_in(&mut self, sweeps: u32, report: &mut SolveReport) -> bool {
        settles_in(self.problem, self.settings, sweeps, report)
    }

    /// Continues with conjugate gradients after Newton's method has failed, up to the maximum number of sweeps.
    /// Conjugate gradients solve some of the problems that Newton's method cannot solve, and show whether a problem has
    /// no solution.
    fn go_on_without(self, report: SolveReport) -> SolveReport {
        let left = (self.settings.max_sweeps - report.sweeps).min(self.effort.sweeps_after);
        if left == 0 {
            return report;
        }
        let settings = SolverSettings { max_sweeps: left, ..*self.settings };
        let rest = nncg::solve(&mut BodySystem::new(self.problem), &settings, self.vectors);
        SolveReport {
            sweeps: report.sweeps + rest.sweeps,
            factorisations: report.factorisations,
            ..rest
        }
    }

    /// Takes one Newton step: predicts the states of the contacts, solves the linear equations for the velocities, and
    /// sets the impulses that belong to these velocities.
    fn newton_step(&mut self, compliance: f64) {
        assemble::<M, D>(self.problem, self.workspace, compliance);
        let NewtonWorkspace { graph, matrix, vector, .. } = &mut *self.workspace;
        matrix.factorise(&graph.elimination);
        matrix.solve(&graph.elimination, vector);
        self.take_impulses(compliance);
        self.problem.form_velocities();
    }

    /// Computes the impulses of all contacts by the contact law that is regularised with the dimensionless compliance
    /// `compliance`, from the velocities that the linear equations give. Projects these impulses on the bounds of the
    /// contact law.
    fn take_impulses(&mut self, compliance: f64) {
        let NewtonWorkspace { graph, vector, guesses, rolling_guesses, .. } = &*self.workspace;
        let places = &graph.elimination.place_of;
        let StepProblem { bodies, rows, law, .. } = &mut *self.problem;
        let along = |gradient: &[f64; 3], body: u32| -> f64 {
            let velocity = &vector[places[body as usize] as usize];
            (0..D).map(|axis| gradient[axis] * velocity[axis]).sum()
        };
        let fixed_count = rows.fixed.len();
        for (number, guess) in guesses.iter().enumerate() {
            let is_pair = number >= fixed_count;
            let [mut normal_velocity, mut tangential_velocity] = match is_pair {
                true => rows.pairs[number - fixed_count].velocity(&bodies.now),
                false => rows.fixed[number].velocity(&bodies.now),
            };
            let law = rows.law(number, law);
            let row = rows.get(number);
            let rolling_velocity = if M::ROLLING { rows.rolling.get(number) } else { None };
            let rolling_velocity = rolling_velocity.map(|rolling| {
                let j = is_pair.then(|| &bodies.now[row.j as usize]);
                let of_i = along(&rolling.gradient(false), row.i);
                let of_j = j.map_or(0.0, |_| along(&rolling.gradient(true), row.j));
                rolling.velocity::<M>(&bodies.now[row.i as usize], j) + of_i + of_j
            });
            let row = rows.get_mut(number);
            let [[normal_i, tangent_i], [normal_j, tangent_j]] = M::gradients(row.normal);
            normal_velocity += along(&normal_i, row.i);
            tangential_velocity += along(&tangent_i, row.i);
            if is_pair {
                normal_velocity += along(&normal_j, row.j);
                tangential_velocity += along(&tangent_j, row.j);
            }
            let u = normal_velocity + row.restitution_velocity;
            let shifted = match guess {
                Guess::Open => 0.0,
                _ => signorini(row.shifted_impulse - u / compliance),
            };
            row.shifted_impulse = shifted;
            if M::FRICTION {
                let bound = law.friction_bound(shifted);
                let softness = M::TANGENTIAL_COMPLIANCE * compliance;
                row.tangential_impulse = match guess {
                    Guess::Open => 0.0,
                    Guess::Stick => {
                        coulomb(row.tangential_impulse - tangential_velocity / softness, bound)
                    }
                    Guess::Slip(sign) => sign * bound,
                };
            }
            if let Some(velocity) = rolling_velocity {
                let rolling = &mut rows.rolling[number];
                let bound = rolling.bound(&law, shifted);
                rolling.impulse = match rolling_guesses[number] {
                    Guess::Open => 0.0,
                    Guess::Stick => {
                        let softness = rolling.compliance * compliance;
                        coulomb(rolling.impulse - velocity / softness, bound)
                    }
                    Guess::Slip(sign) => sign * bound,
                };
            }
        }
    }
}

/// Predicts the state of every contact, and assembles the resulting linear equations for the velocities.
fn assemble<M: Model, const D: usize>(
    problem: &StepProblem<M>,
    workspace: &mut NewtonWorkspace<D>,
    compliance: f64,
) {
    let NewtonWorkspace { graph, matrix, vector, guesses, rolling_guesses, .. } = workspace;
    let (elimination, pair_blocks) = (&graph.elimination, &graph.pair_blocks);
    matrix.start::<M>(elimination, &problem.bodies.masses);
    vector.clear();
    vector.resize(problem.bodies.now.len(), [0.0; D]);
    guesses.clear();
    rolling_guesses.clear();
    for (number, row) in problem.rows.fixed.iter().enumerate() {
        let velocity = row.velocity(&problem.bodies.now);
        let law = problem.law_of(number);
        let guess = guess::<M>(&law, row, velocity);
        guesses.push(guess);
        let gradients = M::gradients(row.normal);
        let mut terms = Terms::<D>::new::<M>(&law, row, velocity, guess, compliance, &gradients[0]);
        if let Some((rolling, speed)) = problem.rolling(number, row, &problem.bodies.now) {
            let guess = guess_rolling(&law, row, velocity[0], rolling, speed);
            rolling_guesses.push(guess);
            let added = RollingTerms { rolling, speed, guess, compliance };
            terms.add_rolling(&law, row, velocity[0], &added, false);
        }
        let place = elimination.place_of[row.i as usize];
        terms.add::<M>(matrix.diagonal_mut(place), &terms);
        terms.add_load(&mut vector[place as usize]);
    }
    let pairs = problem.rows.pairs.iter().zip(pair_blocks);
    for (number, (row, &block)) in (problem.rows.fixed.len()..).zip(pairs) {
        let velocity = row.velocity(&problem.bodies.now);
        let law = problem.law_of(number);
        let guess = guess::<M>(&law, row, velocity);
        guesses.push(guess);
        let gradients = M::gradients(row.normal);
        let [mut on_i, mut on_j] = gradients.map(|gradients| {
            Terms::<D>::new::<M>(&law, row, velocity, guess, compliance, &gradients)
        });
        if let Some((rolling, speed)) = problem.rolling(number, row, &problem.bodies.now) {
            let guess = guess_rolling(&law, row, velocity[0], rolling, speed);
            rolling_guesses.push(guess);
            let added = RollingTerms { rolling, speed, guess, compliance };
            on_i.add_rolling(&law, row, velocity[0], &added, false);
            on_j.add_rolling(&law, row, velocity[0], &added, true);
        }
        let i = elimination.place_of[row.i as usize];
        let j = elimination.place_of[row.j as usize];
        on_i.add_load(&mut vector[i as usize]);
        on_j.add_load(&mut vector[j as usize]);
        if guess != Guess::Open {
            on_i.add::<M>(matrix.diagonal_mut(i), &on_i);
            on_j.add::<M>(matrix.diagonal_mut(j), &on_j);
            let (i_to_j, j_to_i) = matrix.off_diagonal_mut(block, i < j);
            on_i.add::<M>(i_to_j, &on_j);
            on_j.add::<M>(j_to_i, &on_i);
        }
    }
}

/// History of the residual during a solve, which decides whether the result of a Newton step is kept.
struct ResidualHistory {
    /// Residuals after the last steps whose results were kept.
    history: [f64; HISTORY],
    accepted: usize,
    best: f64,
    /// Smallest residual at the last progress of the solve. A solve makes progress when its smallest residual falls
    /// below half of this value; a slower decrease does not count as progress.
    milestone: f64,
    /// Number of factorisations since the last progress, when `milestone` was lowered.
    since_milestone: u32,
}

impl ResidualHistory {
    fn new(residual: f64) -> Self {
        let mut history = [0.0; HISTORY];
        history[0] = residual;
        Self { history, accepted: 0, best: residual, milestone: residual, since_milestone: 0 }
    }

    /// Returns the upper bound for the residual of a step: the result of a step with a larger residual is dropped.
    fn bound(&self) -> f64 {
        ENOUGH * self.history.iter().copied().fold(0.0, f64::max)
    }

    /// Records the residual of a step whose result is kept. Returns true if it is the smallest residual so far.
    fn accept(&mut self, residual: f64) -> bool {
        self.accepted += 1;
        self.history[self.accepted % HISTORY] = residual;
        let is_best = residual < self.best;
        if is_best {
            self.best = residual;
        }
        if self.best < 0.5 * self.milestone {
            self.milestone = self.best;
            self.since_milestone = 0;
        }
        is_best
    }
}
