//! Non-linear Gauss–Seidel (M. Jean, 1999): one contact after the other, each solved exactly with
//! the velocities that the ones before it left.
//!
//! For solid discs the local Delassus block is diagonal (W_nt = 0), so a contact's solution is two
//! scalar projections. In reduced impulses (`contact::law`, `solver::kinematics`):
//!
//! > σ ← max(σ − (v_n + ρ v_n^{n−1}), 0),  λ_t ← clamp(λ_t − v_t · m_t/m_n, ±bound(σ)).
//!
//! The normal impulse does not change v_t, so both velocities are read once.

use super::measure::residual;
use super::{Kinematics, Model, Row, SolveReport, SolverSettings, StepProblem, StopTest};
use crate::contact::law;

/// After this many sweeps the stopping test is made only after every [`TEST_INTERVAL`]th: a sweep
/// that also measures itself costs more. A smaller number makes well-started steps dearer.
const SWEEPS_TESTED_EACH: u32 = 16;
/// Sweeps between two tests of a long solve; the most that are done in vain.
const TEST_INTERVAL: u32 = 8;

/// Solves a prepared problem by sweeps.
pub(super) fn solve<M: Model>(
    problem: &mut StepProblem<M::Kinematics>,
    settings: &SolverSettings,
) -> SolveReport {
    for sweeps in 1..=settings.max_sweeps {
        let tested = sweeps <= SWEEPS_TESTED_EACH
            || sweeps % TEST_INTERVAL == 0
            || sweeps == settings.max_sweeps
            || settings.stop == StopTest::ImpulsePerMass;
        if !tested {
            sweep::<M, false>(problem);
            continue;
        }
        let converged = tested_sweep::<M>(problem, settings);
        if converged {
            return SolveReport { sweeps, converged, ..SolveReport::default() };
        }
    }
    SolveReport { sweeps: settings.max_sweeps, ..SolveReport::default() }
}

/// One sweep, and whether the stopping test is met after it.
pub(super) fn tested_sweep<M: Model>(
    problem: &mut StepProblem<M::Kinematics>,
    settings: &SolverSettings,
) -> bool {
    let tolerance = settings.tolerance;
    match settings.stop {
        StopTest::RelativeChange => {
            let change = sweep::<M, true>(problem);
            change.squared <= tolerance * tolerance * squared_impulses(problem)
        }
        StopTest::ImpulsePerMass => {
            sweep::<M, true>(problem).absolute <= tolerance * problem.mean_mass
        }
        StopTest::Residual => {
            sweep::<M, false>(problem);
            residual::<M>(problem) <= tolerance
        }
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
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx") {
        // SAFETY: the processor has just been asked.
        return unsafe { sweep_with_avx::<M, MEASURE>(problem) };
    }
    pass::<M, MEASURE>(problem)
}

/// The same operations in the same order, and so bitwise the same result, in the three-operand
/// encoding, which saves the copies that the older one needs.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx")]
fn sweep_with_avx<M: Model, const MEASURE: bool>(
    problem: &mut StepProblem<M::Kinematics>,
) -> Change {
    pass::<M, MEASURE>(problem)
}

#[inline(always)]
fn pass<M: Model, const MEASURE: bool>(problem: &mut StepProblem<M::Kinematics>) -> Change {
    let StepProblem { bodies, fixed_rows, pair_rows, friction, capture_speed, .. } = problem;
    let law = Law { friction: *friction, capture_speed: *capture_speed };
    let mut change = Change::default();
    for row in fixed_rows {
        let i = &mut bodies[row.i as usize];
        let velocity = M::Kinematics::velocity(row.normal, i);
        let impulse = law.update::<M>(row, velocity);
        M::Kinematics::push_single(i, row.normal, impulse);
        change.add::<M, MEASURE>(row.effective_mass, impulse);
    }
    for row in pair_rows {
        let (mut i, mut j) = (bodies[row.i as usize], bodies[row.j as usize]);
        let velocity = M::Kinematics::relative_velocity(row.normal, &i, &j);
        let impulse = law.update::<M>(row, velocity);
        M::Kinematics::push_pair(&mut i, &mut j, row.normal, impulse, row.share);
        bodies[row.i as usize] = i;
        bodies[row.j as usize] = j;
        change.add::<M, MEASURE>(row.effective_mass, impulse);
    }
    change
}

/// The numbers of the contact law that all rows share.
struct Law {
    friction: f64,
    capture_speed: f64,
}

impl Law {
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
    let squared = |row: &Row<K>| {
        let [normal, tangential] = problem.reduced_impulse(row);
        row.effective_mass * row.effective_mass * (normal * normal + tangential * tangential)
    };
    problem.fixed_rows.iter().map(squared).sum::<f64>()
        + problem.pair_rows.iter().map(squared).sum::<f64>()
}
