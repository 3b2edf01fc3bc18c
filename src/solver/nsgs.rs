//! Non-linear Gauss–Seidel (M. Jean, 1999): one contact after the other, each solved exactly with
//! the velocities that the ones before it left.
//!
//! For solid discs the local Delassus block is diagonal (W_nt = 0), so a contact's solution is two
//! scalar projections. In reduced impulses (`contact::law`, `solver::kinematics`):
//!
//! > σ ← max(σ − (v_n + ρ v_n^{n−1}), 0),  λ_t ← clamp(λ_t − v_t · m_t/m_n, ±bound(σ)).
//!
//! The normal impulse does not change v_t, so both velocities are read once.

use super::iterate::{is_tested, sweep_until_settled};
use super::measure::residual;
use super::{Kinematics, Model, Ordering, Row, SolveReport, SolverSettings, StepProblem, StopTest};
use crate::contact::law;

/// Solves a prepared problem by sweeps.
pub(super) fn solve<M: Model>(
    problem: &mut StepProblem<M::Kinematics>,
    settings: &SolverSettings,
) -> SolveReport {
    let sweep = |problem: &mut StepProblem<M::Kinematics>, sweeps| {
        let backward = settings.ordering == Ordering::Symmetric && sweeps % 2 == 0;
        match (is_tested(sweeps, settings), backward) {
            (true, false) => return tested::<M, false>(problem, settings),
            (true, true) => return tested::<M, true>(problem, settings),
            (false, false) => sweep::<M, false>(problem),
            (false, true) => directed_sweep::<M, false, true>(problem),
        };
        false
    };
    sweep_until_settled(problem, settings, sweep, residual::<M>)
}

/// One sweep, and whether the stopping test is met after it.
pub(super) fn tested_sweep<M: Model>(
    problem: &mut StepProblem<M::Kinematics>,
    settings: &SolverSettings,
) -> bool {
    tested::<M, false>(problem, settings)
}

fn tested<M: Model, const BACKWARD: bool>(
    problem: &mut StepProblem<M::Kinematics>,
    settings: &SolverSettings,
) -> bool {
    let change = if settings.stop == StopTest::Residual {
        directed_sweep::<M, false, BACKWARD>(problem)
    } else {
        directed_sweep::<M, true, BACKWARD>(problem)
    };
    is_settled::<M>(problem, change, settings)
}

/// Whether the stopping test is met after a sweep that made this change.
pub(super) fn is_settled<M: Model>(
    problem: &StepProblem<M::Kinematics>,
    change: Change,
    settings: &SolverSettings,
) -> bool {
    let tolerance = settings.tolerance;
    match settings.stop {
        StopTest::RelativeChange => {
            change.squared <= tolerance * tolerance * squared_impulses(problem)
        }
        StopTest::ImpulsePerMass => change.absolute <= tolerance * problem.mean_mass,
        StopTest::Residual => residual::<M>(problem) <= tolerance,
    }
}

/// How much a sweep changed the impulses; zero where it was not asked to measure.
#[derive(Clone, Copy, Debug, Default)]
pub struct Change {
    /// Σ ΔP², (N·s)².
    pub squared: f64,
    /// Σ |ΔP|, N·s.
    pub absolute: f64,
}

/// One pass over all contacts.
pub fn sweep<M: Model, const MEASURE: bool>(problem: &mut StepProblem<M::Kinematics>) -> Change {
    directed_sweep::<M, MEASURE, false>(problem)
}

fn directed_sweep<M: Model, const MEASURE: bool, const BACKWARD: bool>(
    problem: &mut StepProblem<M::Kinematics>,
) -> Change {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx") {
        // SAFETY: the processor has just been asked.
        return unsafe { sweep_with_avx::<M, MEASURE, BACKWARD>(problem) };
    }
    pass::<M, MEASURE, BACKWARD>(problem)
}

/// The same operations in the same order, and so bitwise the same result, in the three-operand
/// encoding, which saves the copies that the older one needs.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx")]
fn sweep_with_avx<M: Model, const MEASURE: bool, const BACKWARD: bool>(
    problem: &mut StepProblem<M::Kinematics>,
) -> Change {
    pass::<M, MEASURE, BACKWARD>(problem)
}

#[inline(always)]
fn pass<M: Model, const MEASURE: bool, const BACKWARD: bool>(
    problem: &mut StepProblem<M::Kinematics>,
) -> Change {
    let law = Law::of(problem);
    let StepProblem { bodies, fixed_rows, pair_rows, .. } = problem;
    let mut change = Change::default();
    if BACKWARD {
        for row in pair_rows.iter_mut().rev() {
            law.solve_pair_of::<M, MEASURE>(row, bodies, &mut change);
        }
        for row in fixed_rows.iter_mut().rev() {
            law.solve_single::<M, MEASURE>(row, &mut bodies[row.i as usize], &mut change);
        }
        return change;
    }
    for row in fixed_rows {
        law.solve_single::<M, MEASURE>(row, &mut bodies[row.i as usize], &mut change);
    }
    for row in pair_rows {
        law.solve_pair_of::<M, MEASURE>(row, bodies, &mut change);
    }
    change
}

/// A body of a model.
type Body<M> = <<M as Model>::Kinematics as Kinematics>::Body;

/// The numbers of the contact law that all rows share.
pub(super) struct Law {
    friction: f64,
    capture_speed: f64,
}

impl Law {
    /// Those of a problem.
    pub fn of<K: Kinematics>(problem: &StepProblem<K>) -> Self {
        Self { friction: problem.friction, capture_speed: problem.capture_speed }
    }

    /// Solves a contact of grain i with a fixed body.
    #[inline(always)]
    pub fn solve_single<M: Model, const MEASURE: bool>(
        &self,
        row: &mut Row<M::Kinematics>,
        i: &mut Body<M>,
        change: &mut Change,
    ) {
        let velocity = M::Kinematics::velocity(row.normal, i);
        let impulse = self.update::<M>(row, velocity);
        M::Kinematics::push_single(i, row.normal, impulse);
        change.add::<M, MEASURE>(row.effective_mass, impulse);
    }

    /// Solves a contact between grains i and j.
    #[inline(always)]
    pub fn solve_pair<M: Model, const MEASURE: bool>(
        &self,
        row: &mut Row<M::Kinematics>,
        i: &mut Body<M>,
        j: &mut Body<M>,
        change: &mut Change,
    ) {
        let velocity = M::Kinematics::relative_velocity(row.normal, i, j);
        let impulse = self.update::<M>(row, velocity);
        M::Kinematics::push_pair(i, j, row.normal, impulse, row.share);
        change.add::<M, MEASURE>(row.effective_mass, impulse);
    }

    /// Solves a contact between two of the bodies.
    #[inline(always)]
    fn solve_pair_of<M: Model, const MEASURE: bool>(
        &self,
        row: &mut Row<M::Kinematics>,
        bodies: &mut [Body<M>],
        change: &mut Change,
    ) {
        let (mut i, mut j) = (bodies[row.i as usize], bodies[row.j as usize]);
        self.solve_pair::<M, MEASURE>(row, &mut i, &mut j, change);
        bodies[row.i as usize] = i;
        bodies[row.j as usize] = j;
    }

    /// Solves one contact at the given (v_n, v_t) and returns the change of (λ_n, λ_t).
    #[inline(always)]
    fn update<M: Model>(
        &self,
        row: &mut Row<M::Kinematics>,
        [normal_velocity, tangential_velocity]: [f64; 2],
    ) -> [f64; 2] {
        let normal_before = row.shifted_impulse;
        let closing = normal_velocity + row.restitution_velocity;
        row.shifted_impulse = law::signorini(normal_before - closing);
        let normal_change = row.shifted_impulse - normal_before;
        if !M::FRICTION {
            return [normal_change, 0.0];
        }
        let shifted = row.shifted_impulse;
        let bound = if M::COMPRESSIVE_CONE {
            law::friction_bound::<true>(self.friction, shifted, self.capture_speed)
        } else {
            law::friction_bound::<false>(self.friction, shifted, 0.0)
        };
        let tangential_before = row.tangential_impulse;
        let compliance = 1.0 / M::Kinematics::TANGENTIAL_COMPLIANCE;
        let tangential = tangential_before - compliance * tangential_velocity;
        row.tangential_impulse = law::coulomb(tangential, bound);
        [normal_change, row.tangential_impulse - tangential_before]
    }
}

impl Change {
    /// Adds the change of other contacts.
    pub fn add_all(&mut self, other: Self) {
        self.squared += other.squared;
        self.absolute += other.absolute;
    }

    #[inline(always)]
    fn add<M: Model, const MEASURE: bool>(&mut self, mass: f64, [normal, tangential]: [f64; 2]) {
        if MEASURE {
            let normal = mass * normal;
            self.squared += normal * normal;
            self.absolute += normal.abs();
            if M::FRICTION {
                let tangential = mass * tangential;
                self.squared += tangential * tangential;
                self.absolute += tangential.abs();
            }
        }
    }
}

/// Σ P², (N·s)².
fn squared_impulses<K: Kinematics>(problem: &StepProblem<K>) -> f64 {
    let squared = |(number, row): (usize, &Row<K>)| {
        let [normal, tangential] = problem.reduced_impulse(number, row);
        row.effective_mass * row.effective_mass * (normal * normal + tangential * tangential)
    };
    let fixed_count = problem.fixed_rows.len();
    problem.rows().take(fixed_count).map(squared).sum::<f64>()
        + problem.rows().skip(fixed_count).map(squared).sum::<f64>()
}
