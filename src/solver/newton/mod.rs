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
//! anew from them, and two Gauss–Seidel sweeps mend what the guesses got wrong.
//!
//! The method is that of an augmented Lagrangian treated by generalised Newton steps (P. Alart,
//! A. Curnier 1991), with ε adapted as in a trust region.

mod block_lu;
mod ordering;

use self::block_lu::BlockMatrix;
use self::ordering::Elimination;
use super::measure::residual;
use super::nsgs::{sweep, tested_sweep};
use super::{Kinematics, Model, Row, SolveReport, SolverSettings, StepProblem};
use crate::contact::law;

/// Compliance of the first step.
const FIRST_COMPLIANCE: f64 = 1e-6;
/// Below this, rounding in the factorisation eats what a smaller compliance would gain.
const SMALLEST_COMPLIANCE: f64 = 1e-7;
/// Above this a Newton step is no better than sweeps, which then take over for a while.
const LARGEST_COMPLIANCE: f64 = 0.1;
/// Factor of the compliance after a step that is accepted.
const AFTER_SUCCESS: f64 = 0.1;
/// Factor of the compliance after a step that is refused.
const AFTER_FAILURE: f64 = 30.0;
/// A step is accepted if its residual is below [`ENOUGH`] times the largest of this many before:
/// the residual may rise for a few steps on the way down.
const MEMORY: usize = 10;
/// See [`MEMORY`].
const ENOUGH: f64 = 0.9;
/// Sweeps before the first factorisation: many steps of a pile at rest need no more.
const SWEEPS_FIRST: u32 = 4;
/// Sweeps where Newton stalls, doubled each time up to [`MOST_SWEEPS_BETWEEN`].
const SWEEPS_BETWEEN: u32 = 20;
/// See [`SWEEPS_BETWEEN`].
const MOST_SWEEPS_BETWEEN: u32 = 200;
/// Factorisations without halving the best residual after which a step is taken to have no better
/// solution.
const PATIENCE: u32 = 40;

/// A workspace for each number of degrees of freedom; those that are not used hold no memory.
#[derive(Clone, Debug, Default)]
pub struct Workspaces {
    one: Workspace<1>,
    two: Workspace<2>,
    three: Workspace<3>,
}

/// What Newton's method keeps from one factorisation to the next.
#[derive(Clone, Debug, Default)]
pub struct Workspace<const D: usize> {
    elimination: Elimination,
    matrix: BlockMatrix<D>,
    vector: Vec<[f64; D]>,
    guesses: Vec<Guess>,
    /// (σ, λ_t) of the rows to go back to.
    saved: Vec<[f64; 2]>,
    /// What `elimination` was made for.
    bodies: usize,
    pairs: Vec<(u32, u32)>,
}

/// Solves a prepared problem.
pub(super) fn solve<M: Model>(
    problem: &mut StepProblem<M::Kinematics>,
    settings: &SolverSettings,
) -> SolveReport {
    if problem.contact_of_row.is_empty() {
        return SolveReport { converged: true, ..SolveReport::default() };
    }
    let mut workspaces = std::mem::take(&mut problem.newton);
    let report = match M::Kinematics::DEGREES {
        1 => Newton::<M, 1> { problem, settings, workspace: &mut workspaces.one }.run(),
        2 => Newton::<M, 2> { problem, settings, workspace: &mut workspaces.two }.run(),
        _ => Newton::<M, 3> { problem, settings, workspace: &mut workspaces.three }.run(),
    };
    problem.newton = workspaces;
    report
}

/// What the present state lets one guess of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Guess {
    Open,
    Stick,
    /// The tangential impulse is at its bound, with this sign.
    Slip(f64),
}

/// One solve.
struct Newton<'a, M: Model, const D: usize> {
    problem: &'a mut StepProblem<M::Kinematics>,
    settings: &'a SolverSettings,
    workspace: &'a mut Workspace<D>,
}

impl<M: Model, const D: usize> Newton<'_, M, D> {
    fn run(mut self) -> SolveReport {
        let mut report = SolveReport::default();
        for _ in 0..SWEEPS_FIRST.min(self.settings.max_sweeps) {
            report.sweeps += 1;
            if tested_sweep::<M>(self.problem, self.settings) {
                return SolveReport { converged: true, ..report };
            }
        }
        self.analyse();
        let mut history = [0.0; MEMORY];
        let mut accepted = 0;
        history[0] = residual::<M>(self.problem);
        self.save();
        let mut best = history[0];
        let mut since_best = 0;
        let mut compliance = FIRST_COMPLIANCE;
        let mut sweeps_between = SWEEPS_BETWEEN;
        while report.sweeps + 2 <= self.settings.max_sweeps && since_best < PATIENCE {
            self.newton_step(compliance);
            report.factorisations += 1;
            sweep::<M, false>(self.problem);
            report.sweeps += 2;
            if tested_sweep::<M>(self.problem, self.settings) {
                return SolveReport { converged: true, ..report };
            }
            let mut now = residual::<M>(self.problem);
            let bound = ENOUGH * history.iter().copied().fold(0.0, f64::max);
            // Not a number is not below anything.
            if now < bound {
                compliance = (compliance * AFTER_SUCCESS).max(SMALLEST_COMPLIANCE);
            } else {
                self.restore();
                compliance *= AFTER_FAILURE;
                if compliance <= LARGEST_COMPLIANCE {
                    since_best += 1;
                    continue;
                }
                for _ in 0..sweeps_between.min(self.settings.max_sweeps - report.sweeps) {
                    report.sweeps += 1;
                    if tested_sweep::<M>(self.problem, self.settings) {
                        return SolveReport { converged: true, ..report };
                    }
                }
                sweeps_between = (2 * sweeps_between).min(MOST_SWEEPS_BETWEEN);
                compliance = FIRST_COMPLIANCE;
                now = residual::<M>(self.problem);
            }
            self.save();
            accepted += 1;
            history[accepted % MEMORY] = now;
            if now < 0.5 * best {
                best = now;
                since_best = 0;
            } else {
                since_best += 1;
            }
        }
        report
    }

    /// Orders the elimination, unless the contacts between grains are those of the last time.
    fn analyse(&mut self) {
        let pairs = || self.problem.pair_rows.iter().map(|row| (row.i, row.j));
        let bodies = self.problem.bodies.len();
        let workspace = &mut *self.workspace;
        if workspace.bodies == bodies && pairs().eq(workspace.pairs.iter().copied()) {
            return;
        }
        workspace.bodies = bodies;
        workspace.pairs.clear();
        workspace.pairs.extend(pairs());
        workspace.elimination.analyse(bodies, workspace.pairs.iter().copied());
    }

    fn save(&mut self) {
        let rows = self.problem.fixed_rows.iter().chain(&self.problem.pair_rows);
        self.workspace.saved.clear();
        self.workspace.saved.extend(rows.map(|row| [row.shifted_impulse, row.tangential_impulse]));
    }

    fn restore(&mut self) {
        let rows = self.problem.fixed_rows.iter_mut().chain(&mut self.problem.pair_rows);
        for (row, &[shifted, tangential]) in rows.zip(&self.workspace.saved) {
            row.shifted_impulse = shifted;
            row.tangential_impulse = tangential;
        }
        self.problem.form_velocities();
    }

    /// Guesses, solves for velocities, and takes the impulses that go with them.
    fn newton_step(&mut self, compliance: f64) {
        self.assemble(compliance);
        let Workspace { elimination, matrix, vector, .. } = &mut *self.workspace;
        matrix.factorise(elimination);
        matrix.solve(elimination, vector);
        self.take_impulses(compliance);
        self.problem.form_velocities();
    }

    fn assemble(&mut self, compliance: f64) {
        let Workspace { elimination, matrix, vector, guesses, .. } = &mut *self.workspace;
        let problem = &*self.problem;
        matrix.clear(elimination);
        vector.clear();
        vector.resize(problem.bodies.len(), [0.0; D]);
        for (body, &mass) in problem.masses.iter().enumerate() {
            let place = elimination.place_of[body];
            let free = M::Kinematics::coordinates(&problem.free[body]);
            let block = matrix.diagonal_mut(place);
            for axis in 0..D {
                let inertia = mass * M::Kinematics::INERTIA_OVER_MASS[axis];
                block[axis][axis] = inertia;
                vector[place as usize][axis] = inertia * free[axis];
            }
        }
        guesses.clear();
        for row in &problem.fixed_rows {
            let velocity = M::Kinematics::velocity(row.normal, &problem.bodies[row.i as usize]);
            let guess = guess::<M>(problem, row, velocity);
            guesses.push(guess);
            let gradients = M::Kinematics::gradients(row.normal);
            let terms = Terms::<D>::new::<M>(problem, row, guess, compliance, &gradients[0]);
            let place = elimination.place_of[row.i as usize];
            terms.add(matrix.diagonal_mut(place), &terms);
            terms.add_load(&mut vector[place as usize]);
        }
        for row in &problem.pair_rows {
            let (body_i, body_j) =
                (&problem.bodies[row.i as usize], &problem.bodies[row.j as usize]);
            let velocity = M::Kinematics::relative_velocity(row.normal, body_i, body_j);
            let guess = guess::<M>(problem, row, velocity);
            guesses.push(guess);
            let gradients = M::Kinematics::gradients(row.normal);
            let on_i = Terms::<D>::new::<M>(problem, row, guess, compliance, &gradients[0]);
            let on_j = Terms::<D>::new::<M>(problem, row, guess, compliance, &gradients[1]);
            let i = elimination.place_of[row.i as usize];
            let j = elimination.place_of[row.j as usize];
            on_i.add_load(&mut vector[i as usize]);
            on_j.add_load(&mut vector[j as usize]);
            if guess != Guess::Open {
                on_i.add(matrix.diagonal_mut(i), &on_i);
                on_j.add(matrix.diagonal_mut(j), &on_j);
                on_i.add(matrix.block_mut(elimination, i, j), &on_j);
                on_j.add(matrix.block_mut(elimination, j, i), &on_i);
            }
        }
    }

    /// The regularised law at the new velocities, projected on what the law allows.
    fn take_impulses(&mut self, compliance: f64) {
        let Workspace { elimination, vector, guesses, .. } = &*self.workspace;
        let StepProblem { fixed_rows, pair_rows, friction, capture_speed, .. } = &mut *self.problem;
        let along = |gradient: &[f64; 3], body: u32| -> f64 {
            let velocity = &vector[elimination.place_of[body as usize] as usize];
            (0..D).map(|axis| gradient[axis] * velocity[axis]).sum()
        };
        let fixed_count = fixed_rows.len();
        let rows = fixed_rows.iter_mut().chain(pair_rows).enumerate();
        for ((number, row), guess) in rows.zip(guesses) {
            let [[normal_i, tangent_i], [normal_j, tangent_j]] =
                M::Kinematics::gradients(row.normal);
            let mut normal_velocity = along(&normal_i, row.i);
            let mut tangential_velocity = along(&tangent_i, row.i);
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
                let bound = if M::COMPRESSIVE_CONE {
                    law::friction_bound::<true>(*friction, shifted, *capture_speed)
                } else {
                    law::friction_bound::<false>(*friction, shifted, 0.0)
                };
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

/// What a contact would do next, by its law.
fn guess<M: Model>(
    problem: &StepProblem<M::Kinematics>,
    row: &Row<M::Kinematics>,
    [normal_velocity, tangential_velocity]: [f64; 2],
) -> Guess {
    let shifted = row.shifted_impulse - normal_velocity - row.restitution_velocity;
    if shifted <= 0.0 {
        return Guess::Open;
    }
    if !M::FRICTION {
        return Guess::Slip(0.0);
    }
    let bound = problem.friction_bound::<M>(shifted);
    let compliance = 1.0 / M::Kinematics::TANGENTIAL_COMPLIANCE;
    let tangential = row.tangential_impulse - compliance * tangential_velocity;
    if tangential.abs() <= bound { Guess::Stick } else { Guess::Slip(tangential.signum()) }
}

/// A contact's part in the equations of one of its bodies.
struct Terms<const D: usize> {
    /// How the body's velocity enters v_n and v_t.
    normal: [f64; D],
    tangent: [f64; D],
    /// Where the law's answer to v_n acts: n, or n ± μt in slip.
    answer: [f64; D],
    /// Stiffnesses against v_n and v_t, kg.
    normal_stiffness: f64,
    tangential_stiffness: f64,
    /// The impulse at V = 0, kg·m/s.
    load: [f64; D],
}

impl<const D: usize> Terms<D> {
    #[inline(always)]
    fn new<M: Model>(
        problem: &StepProblem<M::Kinematics>,
        row: &Row<M::Kinematics>,
        guess: Guess,
        compliance: f64,
        gradients: &[[f64; 3]; 2],
    ) -> Self {
        let part = |vector: &[f64; 3]| std::array::from_fn::<f64, D, _>(|axis| vector[axis]);
        let (normal, tangent) = (part(&gradients[0]), part(&gradients[1]));
        let mass = row.effective_mass;
        let capture_speed = problem.capture_speed;
        let stiffness = mass / compliance;
        // σ' at V = 0.
        let at_rest = row.shifted_impulse - row.restitution_velocity / compliance;
        let (slope, normal_stiffness, tangential_stiffness, tangential_load) = match guess {
            Guess::Open => (0.0, 0.0, 0.0, 0.0),
            Guess::Stick => {
                let softness = M::Kinematics::TANGENTIAL_COMPLIANCE;
                (0.0, stiffness, stiffness / softness, mass * row.tangential_impulse)
            }
            Guess::Slip(sign) => {
                let slope = sign * problem.friction;
                let rubbing = if M::COMPRESSIVE_CONE { at_rest - capture_speed } else { at_rest };
                (slope, stiffness, 0.0, mass * slope * rubbing)
            }
        };
        let shifted_load = if guess == Guess::Open { 0.0 } else { at_rest };
        let normal_load = mass * (shifted_load - capture_speed);
        Self {
            normal,
            tangent,
            answer: std::array::from_fn(|axis| normal[axis] + slope * tangent[axis]),
            normal_stiffness,
            tangential_stiffness,
            load: std::array::from_fn(|axis| {
                normal_load * normal[axis] + tangential_load * tangent[axis]
            }),
        }
    }

    /// Adds the answer of this body's equations to the velocity of `other` to their block.
    #[inline(always)]
    fn add(&self, block: &mut [[f64; D]; D], other: &Self) {
        for row in 0..D {
            let normal = self.normal_stiffness * self.answer[row];
            let tangential = self.tangential_stiffness * self.tangent[row];
            for column in 0..D {
                block[row][column] +=
                    normal * other.normal[column] + tangential * other.tangent[column];
            }
        }
    }

    #[inline(always)]
    fn add_load(&self, vector: &mut [f64; D]) {
        for axis in 0..D {
            vector[axis] += self.load[axis];
        }
    }
}
