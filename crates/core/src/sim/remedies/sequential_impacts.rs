//! Remedy (optional correction of a step) `sequential-impacts`: lets shocks (collisions) travel through touching grains
//! one after the other, within one step.
//!
//! **Problem.** The term ρ v_n^{n−1} of the contact law of Abramian & Staron (2020) (restitution ρ, normal velocity
//! v_n^{n−1} before step number n) treats all shocks of a step at once, and depends only on a contact's velocity before
//! the step. If a ball hits a row of balls at rest, all of these balls fly off together, at any ρ: contacts within the
//! row do not close before the step, so the law does not let them open after it. In reality the shock travels through
//! the row, and only the last ball flies off.
//!
//! **Remedy.** First the shocks are computed, without friction, and without gravity because it has no effect in zero
//! time. A pass takes only the contacts k that close, with their normal velocities u_k⁻ before and u_k⁺ after the pass,
//! their impulses P_k and the Delassus operator W, and solves
//!
//! > 0 ≤ P_k ⟂ u_k⁺ + ρ u_k⁻ ≥ 0 for each k with u_k⁻ < 0,  u⁺ = u⁻ + W P.
//!
//! The result makes other contacts close. These form the next pass, until no contact closes. With ρ = 1 the passes are
//! the generalized reflections of B. Smith, D. M. Kaufman, E. Vouga, R. Tamstorf and E. Grinspun, *Reflections on
//! simultaneous impact* (2012). If the contacts of a pass share no grain, they are binary impacts in sequence (A.
//! Chatterjee and A. Ruina, 1998). Contacts that close together are solved together. So the result is as symmetric as
//! the initial state, and does not depend on the numbering of grains, as it would if one contact came first.
//!
//! **The shocks create no energy.** If P_k > 0, then u_k⁺ = −ρ u_k⁻, so (WP)_k = u_k⁺ − u_k⁻ = (1+ρ)|u_k⁻| > 0. A pass
//! changes the kinetic energy by
//!
//! > ½P·(u⁺ + u⁻) = −½ (1−ρ) Σ P_k |u_k⁻| = −½ (1−ρ)/(1+ρ) Σ P_k (WP)_k ≤ 0.
//!
//! Contacts that still close after the last pass, at speeds too slow to bounce, are stopped: the velocities are
//! projected onto those velocities at which no contact closes. This also dissipates energy. Impulses act on pairs, so
//! momentum is conserved.
//!
//! **The step itself** then requires each struck contact k to open with the speed û_k ≥ 0 that the shocks have given
//! it: in its law, u_k^n − û_k replaces u_k^n + ρ u_k^{n−1} (normal velocities u_k^{n−1} before and u_k^n after step
//! number n). Without gravity and friction the impulses of the shocks already solve this step: they are ≥ 0, and u_k^n
//! = û_k if an impulse is not 0. With friction, the friction bound depends on the whole normal impulse, including
//! shocks. A single contact has û = −ρ u^{n−1}, so the law of a single contact does not change.
//!
//! **Friction.** With friction, bounces may create energy, here as in the scheme of Abramian & Staron (T. R. Kane,
//! 1984). If the contacts of a step have done positive work, in addition to the work of moving walls, all û_k of the
//! step are halved and the step is solved again. With û_k = 0 this work is, without gravity, P_t·u_t − ½P·WP ≤ 0 (P_t
//! and u_t are the tangential impulses and velocities), so the process ends.
//!
//! **Not with cohesion.** In the contact law of Abramian & Staron touching grains are bonded, and bonds take part in a
//! shock. So all contacts would belong to the first pass, and the remedy would change nothing.

use crate::contact::ContactList;
use crate::number::Parts;
use crate::sim::settings::Settings;
use crate::sim::stepping::Stage;
use crate::solver::{
    Bodies, FrictionModel, Memory, Method, Model, SolveReport, SolverSettings, StepProblem,
    for_each_row, relative_velocities, solve as solve_problem,
};

/// Closing speed below which contacts do not bounce, in units of g·Δt, the speed that gravity adds in a step. Gravity
/// alone makes a resting contact close by g·Δt in a step, so with a smaller value a pile at rest would be shaken in
/// each step.
const LEAST_IN_STEPS_OF_GRAVITY: f64 = 2.0;
/// Closing speed below which contacts do not bounce, divided by the fastest closing speed of the step. This limit
/// serves scenes without gravity: with a coefficient of restitution below 1, the contacts of a chain close infinitely
/// often, ever more slowly. With a smaller value, more passes are spent on invisible motion.
const LEAST_IN_FASTEST: f64 = 1e-6;
/// Largest number of passes in the calculation of a step's shocks (collisions). A pass solves all contacts that close
/// at the same time. A shock through a row of n balls needs n − 1 passes.
const MOST_PASSES: u32 = 2000;

/// Ratio of two works in a step above which contacts count as creating energy: the total work of all contacts, divided
/// by the sum of the absolute works of the normal impulses. Rounding and the tolerance of a step cause smaller values.
const LEAST_GAIN: f64 = 1e-6;

/// Largest number of times that the opening speeds after shocks (collisions) are reduced in a step because bounces
/// create energy. Each of the first four times the speeds are halved, and the fifth time they are set to 0.
const HALVINGS: u32 = 5;

/// Solver settings for a pass of shocks (collisions), which solves the contacts that close at the same time. They do
/// not depend on the solver of the step: only few contacts close at the same time, so the solver `nsgs` reaches this
/// small residual at little cost.
const PASS: SolverSettings = SolverSettings::to_residual(Method::Nsgs, 1e-12, 1000);

/// Computes the shocks (collisions) of a step whose contact problem has been set up, and solves the step so that its
/// contacts open with the speeds that the shocks have given them. As long as bounces create energy, reduces these
/// speeds and solves the step again.
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

/// Computes the shocks (collisions) of a step whose contact problem has been set up, and changes this problem so that
/// its contacts open with the resulting speeds. Returns a report with the sweeps for the shocks; the report of the step
/// itself shows if the step is solved. With cohesion, or without shocks that bounce, returns `None` and does not change
/// the problem.
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

/// True if the contacts of a solved step have done positive work on the grains, beyond rounding. The work of moving
/// walls does not count: velocities are taken relative to the walls.
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

/// State of the calculation of a step's shocks (collisions), between two passes. A pass solves all contacts that close
/// at the same time.
struct ImpactSequence<M: Model> {
    /// Velocities of the grains after the shocks (collisions) computed so far.
    bodies: Vec<M::Body<f64>>,
    /// Normal velocity u of each contact after the shocks (collisions) computed so far, m/s.
    speeds: Vec<f64>,
    /// Normal impulse of each contact, summed over the shocks (collisions) computed so far and divided by the effective
    /// mass, m/s.
    impulses: Vec<f64>,
    /// True for each contact whose pair touches. A pair that will only touch later in the step takes no part in shocks
    /// (collisions).
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

    /// Returns the fastest closing speed of touching contacts, m/s: the largest −u, with the normal velocity u of a
    /// contact. Returns 0 if no contact closes.
    fn fastest_closing(&self) -> f64 {
        let all = self.speeds.iter().zip(&self.touching);
        all.filter(|(_, touches)| **touches)
            .fold(0.0, |fastest, (speed, _)| fastest.max((-speed).positive_part()))
    }

    /// Fills `pass`, the contact problem of the next pass of shocks (collisions), with the contacts that close faster
    /// than `least` (m/s). Returns false if no contact closes faster.
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

    /// Adds the impulses of `pass`, the solved contact problem of the contacts that close at the same time, to the
    /// impulses of the shocks (collisions) so far, and updates the velocities.
    fn take(&mut self, problem: &StepProblem<M>, pass: &mut StepProblem<M>) {
        for ((_, row), &number) in pass.rows().zip(&pass.rows.contacts) {
            self.impulses[number as usize] += row.shifted_impulse;
        }
        std::mem::swap(&mut self.bodies, &mut pass.bodies.now);
        relative_velocities(problem, &self.bodies, &mut self.speeds);
    }

    /// Stops all contacts that still close after the last computed shock (collision), without friction. Uses the solver
    /// of the step, because many contacts may close.
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

    /// Changes the law of each struck contact so that it opens with the speed that the shocks (collisions) have given
    /// it. A touching contact without such a shock may not bounce. The impulses of the shocks become the starting
    /// values of the solver.
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
