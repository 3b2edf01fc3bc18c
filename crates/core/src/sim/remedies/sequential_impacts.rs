//! Shocks that travel through touching grains one after the other, within one step.
//!
//! **Problem.** The term ρ v_n^{n−1} of the paper's law settles all shocks of a step at once, and depends only on a
//! contact's velocity before the step. A ball that hits a row of balls at rest sends all of them off together,
//! whatever ρ is: contacts within the row do not close before the step, so they may not open after it. In reality the
//! shock travels, and only the last ball flies off.
//!
//! **Remedy.** First the shocks are computed, without friction and without gravity, which has no effect in zero time.
//! A pass takes only the contacts that close, and solves
//!
//! > 0 ≤ P_k ⟂ u_k⁺ + ρ u_k⁻ ≥ 0 for each k with u_k⁻ < 0,  u⁺ = u⁻ + W P.
//!
//! This makes other contacts close, which form the next pass, until no contact closes. With ρ = 1 these are the
//! generalized reflections of B. Smith, D. M. Kaufman, E. Vouga, R. Tamstorf and E. Grinspun, *Reflections on
//! simultaneous impact* (2012). If the contacts of a pass share no grain, they are binary impacts in sequence (A.
//! Chatterjee and A. Ruina, 1998). Contacts that close together are solved together, so that the result is as
//! symmetric as the initial state and does not depend on the numbering of grains, as it would if one contact had to
//! come first.
//!
//! **No energy is gained.** If P_k > 0, u_k⁺ = −ρ u_k⁻, so (WP)_k = u_k⁺ − u_k⁻ = (1+ρ)|u_k⁻| > 0. A pass changes the
//! kinetic energy by
//!
//! > ½P·(u⁺ + u⁻) = −½ (1−ρ) Σ P_k |u_k⁻| = −½ (1−ρ)/(1+ρ) Σ P_k (WP)_k ≤ 0.
//!
//! Contacts that still close after the last pass, at speeds too slow to bounce, are stopped by projecting the
//! velocities onto those that close no contact. This also dissipates energy. Impulses act on pairs, so momentum is
//! conserved.
//!
//! **The step itself** then requires each contact that was struck to open with the speed û_k ≥ 0 given by the shocks:
//! u_k^n − û_k replaces u_k^n + ρ u_k^{n−1} in its law. Without gravity and friction the impulses of the shocks
//! already solve this step: they are ≥ 0, and if they are not 0, u_k^n = û_k. With friction, the bound depends on the
//! whole normal impulse, including shocks. A single contact has û = −ρ u^{n−1}, so nothing changes for it.
//!
//! **Friction.** With friction, bounces may gain energy, here as in the paper's scheme (T. R. Kane, 1984). If the
//! contacts of a step have done positive work, in addition to that of moving walls, its û_k are halved and it is
//! solved again. With û_k = 0 this work is, without gravity, P_t·u_t − ½P·WP ≤ 0, so the process ends.
//!
//! **Not with cohesion.** In the paper's law touching grains are bonded, and bonds take part in a shock. All contacts
//! would then belong to the first pass, which is the unmodified law.

use crate::contact::ContactList;
use crate::number::Parts;
use crate::sim::settings::Settings;
use crate::sim::stepping::Stage;
use crate::solver::{
    Bodies, FrictionModel, Memory, Method, Model, SolveReport, SolverSettings, StepProblem,
    for_each_row, relative_velocities, solve as solve_problem,
};

/// Closing speed below which contacts do not bounce, in g·Δt: a step of gravity alone makes a resting contact close.
/// If smaller, a pile at rest would be shaken in each step.
const LEAST_IN_STEPS_OF_GRAVITY: f64 = 2.0;
/// The same limit relative to the fastest closing speed of the step, for scenes without gravity. For ρ < 1 a chain
/// closes infinitely often. If smaller, more passes are spent on invisible motion.
const LEAST_IN_FASTEST: f64 = 1e-6;
/// Limit for the passes of a step. A row of n balls needs n − 1 passes.
const MOST_PASSES: u32 = 2000;

/// Relative gain of energy that contacts may have because of rounding and the tolerance of a step.
const LEAST_GAIN: f64 = 1e-6;

/// Number of times that bounces with energy gain are halved; the last time they are set to 0.
const HALVINGS: u32 = 5;

/// Solver of a pass, whatever solver the step uses, because few contacts close together.
const PASS: SolverSettings = SolverSettings::to_residual(Method::Nsgs, 1e-12, 1000);

/// Solves a prepared step whose contacts open as its shocks require.
pub(in crate::sim) fn solve<M: Model>(
    stage: &mut Stage<'_, M>,
    settings: &Settings,
) -> SolveReport {
    let followed = follow(stage, settings);
    let mut report = stage.solve(settings);
    let Some(mut earlier) = followed else { return report };
    let mut halvings = 0;
    while M::FRICTION && halvings < HALVINGS && gains_energy(stage.problem) {
        halvings += 1;
        let factor = if halvings < HALVINGS { 0.5 } else { 0.0 };
        for (row, wall_speed) in stage.problem.rows_with_walls() {
            let rebound = row.restitution_velocity + wall_speed;
            if rebound < 0.0 {
                row.restitution_velocity = factor * rebound - wall_speed;
            }
        }
        earlier.add(report);
        report = stage.solve(settings);
    }
    report.after(earlier)
}

/// Computes the shocks of a prepared step and makes its contacts open accordingly. Returns the work of the solves;
/// the caller reports if the step is solved. Returns `None`, and leaves the problem unchanged, with cohesion or
/// without shocks that bounce.
pub(in crate::sim) fn follow<M: Model>(
    stage: &mut Stage<'_, M>,
    settings: &Settings,
) -> Option<SolveReport> {
    let Stage { state, problem, memory, .. } = stage;
    let parameters = &settings.parameters;
    if problem.law.capture_speed() > 0.0 || parameters.restitution == 0.0 {
        return None;
    }
    let mut report = SolveReport::default();
    let mut impacts = ImpactSequence::new(problem, &state.contacts);
    let fastest = impacts.fastest_closing();
    let step_of_gravity = state.world.gravity.magnitude() * parameters.time_step_secs;
    let threshold = parameters.restitution_threshold.max(LEAST_IN_STEPS_OF_GRAVITY);
    let least = (threshold * step_of_gravity).max(LEAST_IN_FASTEST * fastest);
    if fastest <= least {
        return None;
    }
    let mut pass = StepProblem::default();
    for _ in 0..MOST_PASSES {
        if !impacts.select(problem, &mut pass, parameters.restitution, least) {
            break;
        }
        report.add(solve_problem::<M>(&mut pass, memory, &PASS));
        impacts.take(problem, &mut pass);
    }
    if impacts.fastest_closing() > LEAST_IN_FASTEST * fastest {
        report.add(impacts.stop_the_rest(problem, memory, &settings.solver));
    }
    impacts.set_rebounds(problem);
    Some(report)
}

/// True if the contacts of a solved step have done work on the grains, beyond rounding and beyond the work of moving
/// walls. Velocities are relative to those walls.
fn gains_energy<M: Model>(problem: &StepProblem<M>) -> bool {
    let (mut gain, mut scale) = (0.0, 0.0);
    for_each_row(problem, |number, row, motion| {
        let [normal, tangential] =
            problem.reduced_impulse(number, row).map(|impulse| 0.5 * row.effective_mass * impulse);
        let [now, before] =
            [motion.now[0], motion.before[0]].map(|v| v - problem.wall_speed(number));
        gain += normal * (now + before) + tangential * (motion.now[1] + motion.before[1]);
        let [of_now, of_before] = [&problem.bodies.now, &problem.bodies.before]
            .map(|bodies| problem.rolling(number, row, bodies));
        if let (Some((rolling, now)), Some((_, before))) = (of_now, of_before) {
            gain += 0.5 * row.effective_mass * rolling.impulse * (now + before);
        }
        scale += normal.abs() * (now.abs() + before.abs());
    });
    gain > LEAST_GAIN * scale
}

/// Progress of the shocks.
struct ImpactSequence<M: Model> {
    /// Present velocities.
    bodies: Vec<M::Body<f64>>,
    /// u of each row, m/s.
    speeds: Vec<f64>,
    /// P/m_ij of each row so far, m/s.
    impulses: Vec<f64>,
    /// True if a row's pair touches. A pair that will only touch within the step has no shock yet.
    touching: Vec<bool>,
}

impl<M: Model> ImpactSequence<M> {
    fn new(problem: &StepProblem<M>, contacts: &ContactList) -> Self {
        let bodies = problem.bodies.before.clone();
        let mut speeds = Vec::new();
        relative_velocities(problem, &bodies, &mut speeds);
        let impulses = vec![0.0; speeds.len()];
        let touches = |&index: &u32| contacts.is_in_touch(index as usize);
        let touching = problem.rows.contacts.iter().map(touches).collect();
        Self { bodies, speeds, impulses, touching }
    }

    /// Fastest closing speed max(−u), m/s, or 0.
    fn fastest_closing(&self) -> f64 {
        let all = self.speeds.iter().zip(&self.touching);
        all.filter(|(_, touches)| **touches)
            .fold(0.0, |fastest, (speed, _)| fastest.max((-speed).positive_part()))
    }

    /// Fills `pass` with the rows that close faster than `least` (m/s). Returns false if there are none.
    fn select(
        &self,
        problem: &StepProblem<M>,
        pass: &mut StepProblem<M>,
        restitution: f64,
        least: f64,
    ) -> bool {
        pass.rows.clear();
        for number in 0..problem.rows.len() {
            let speed = self.speeds[number];
            if speed >= -least || !self.touching[number] {
                continue;
            }
            pass.rows.push_copy(&problem.rows, number, |row| {
                row.restitution_velocity = restitution * speed - problem.wall_speed(number);
                (row.shifted_impulse, row.tangential_impulse) = (0.0, 0.0);
            });
        }
        let Bodies { now: bodies, before, free, .. } = &mut pass.bodies;
        for copy in [before, free, bodies] {
            copy.clone_from(&self.bodies);
        }
        !pass.rows.is_empty()
    }

    /// Adds the result of a pass.
    fn take(&mut self, problem: &StepProblem<M>, pass: &mut StepProblem<M>) {
        for ((_, row), &number) in pass.rows().zip(&pass.rows.contacts) {
            self.impulses[number as usize] += row.shifted_impulse;
        }
        std::mem::swap(&mut self.bodies, &mut pass.bodies.now);
        relative_velocities(problem, &self.bodies, &mut self.speeds);
    }

    /// Stops all contacts that still close, without friction, with the step's own solver, because there may be many.
    fn stop_the_rest(
        &mut self,
        problem: &StepProblem<M>,
        memory: &mut Memory,
        settings: &SolverSettings,
    ) -> SolveReport {
        let mut rest = problem.clone();
        rest.bodies.free.clone_from(&self.bodies);
        rest.law.friction = 0.0;
        rest.rows.rolling.clear();
        rest.friction.model = FrictionModel::Coulomb;
        for ((row, wall_speed), &touches) in rest.rows_with_walls().zip(&self.touching) {
            if touches {
                row.restitution_velocity = -wall_speed;
            }
            row.shifted_impulse = 0.0;
            row.tangential_impulse = 0.0;
        }
        rest.form_velocities();
        let report = solve_problem::<M>(&mut rest, memory, settings);
        for (number, row) in rest.rows() {
            self.impulses[number] += row.shifted_impulse;
        }
        self.bodies = rest.bodies.now;
        relative_velocities(problem, &self.bodies, &mut self.speeds);
        report
    }

    /// Requires of each contact that was struck the speed it has reached. A contact that was not struck may not
    /// bounce. The step starts from the impulses of the impacts.
    fn set_rebounds(&self, problem: &mut StepProblem<M>) {
        for (number, (row, wall_speed)) in problem.rows_with_walls().enumerate() {
            let impulse = self.impulses[number];
            // The law uses velocities relative to a moving wall.
            row.restitution_velocity = if !self.touching[number] {
                row.restitution_velocity
            } else if impulse > 0.0 {
                -self.speeds[number].positive_part() - wall_speed
            } else {
                (row.restitution_velocity + wall_speed).positive_part() - wall_speed
            };
            row.shifted_impulse += impulse;
        }
        problem.form_velocities();
    }
}
