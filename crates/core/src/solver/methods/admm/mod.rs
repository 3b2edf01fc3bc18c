//! Alternating directions of multipliers with a cached sparse factorisation (S. Boyd and others
//! 2011; on contact problems V. Acary, M. Brémond, O. Huber 2018).
//!
//! Body velocities V and contact velocities z are two unknowns, tied by HV = z with the impulses as
//! multipliers and a penalty m_ij/ε. In reduced impulses (`contact::law`), with u = v_n + ρ v_n^{n−1}
//! of V, one iteration takes the impulses from V by the law,
//!
//! > σ' = max(σ − u/ε, 0),  λ_t' = clamp(λ_t − v_t m_t/(m_n ε), ±bound(σ')),
//!
//! sets z = u + ε (σ' − σ), and then V from the impulses, pulled towards z,
//!
//! > (M + Σ m_ij/ε (n nᵀ + m_t/m_n t tᵀ)) V = M V_free + Σ m_ij [n (2σ' − σ − c + v_n/ε) + t (…)],
//!
//! c the capture speed. The matrix stays while ε does, so an iteration is one pass over the contacts
//! and one solve with factors at hand. Where it rests, V obeys the impulses and the impulses obey
//! the law: the common natural map is 0. Penalty and law pull against each other; ε is changed where
//! one of σ' − σ and (z' − z)/ε is much the larger.

mod directions;

pub(super) use self::directions::AdmmMemory;
use self::directions::Directions;
use super::info::{BOUND_BY_BOUND, MethodInfo, MethodOrder};
use super::method::Method;
use super::report::SolveReport;
use super::shared::body_system::BodySystem;
use super::shared::contact_system::{ContactSystem, Pairs};
use super::shared::iterate::{Best, is_tested};
use crate::solver::problem::{Kinematics, Model, StepProblem};
use crate::solver::settings::SolverSettings;

/// What there is to know of it.
pub(super) const INFO: MethodInfo = MethodInfo {
    method: Method::Admm,
    name: "admm",
    summary: "alternating directions of multipliers: one cached factorisation, many solves",
    solves: BOUND_BY_BOUND,
    source: "S. Boyd and others (2011); for contact V. Acary, M. Bremond, O. Huber (2018)",
    order: MethodOrder::AllAtOnce,
    takes_models: false,
    takes_drives: false,
    takes_shear: true,
};

/// ε at first.
const FIRST_COMPLIANCE: f64 = 0.03;
/// Iterations between two looks at ε: a factorisation costs as much as some ten iterations.
const BALANCE_INTERVAL: u32 = 24;
/// How much larger one of the two residuals must be for ε to change.
const OUT_OF_BALANCE: f64 = 4.0;
/// The most that ε changes at a time.
const LARGEST_CHANGE: f64 = 10.0;
/// Below, rounding in the factorisation tells; above, impulses hardly spread.
const COMPLIANCES: [f64; 2] = [1e-5, 1.0];

/// Solves a prepared problem.
pub(super) fn solve<M: Model>(
    problem: &mut StepProblem<M::Kinematics>,
    memory: &mut AdmmMemory,
    settings: &SolverSettings,
) -> SolveReport {
    let AdmmMemory { one, two, three, best, root_masses } = memory;
    match M::Kinematics::DEGREES {
        1 => run::<M, 1>(problem, one, (best, root_masses), settings),
        2 => run::<M, 2>(problem, two, (best, root_masses), settings),
        _ => run::<M, 3>(problem, three, (best, root_masses), settings),
    }
}

fn run<M: Model, const D: usize>(
    problem: &mut StepProblem<M::Kinematics>,
    directions: &mut Directions<D>,
    (best_impulses, roots): (&mut Pairs, &mut Vec<f64>),
    settings: &SolverSettings,
) -> SolveReport {
    let pairs = problem.pair_rows.iter().map(|row| (row.i, row.j));
    directions.elimination.analyse(problem.bodies.len(), pairs);
    let mut best = Best::new(&BodySystem::<M>::new(problem, roots), best_impulses);
    let mut report = SolveReport::default();
    let mut compliance = FIRST_COMPLIANCE;
    directions.factorise::<M>(problem, compliance);
    report.factorisations += 1;
    directions.start::<M>(problem);
    while report.sweeps < settings.max_sweeps {
        report.sweeps += 1;
        let is_tested = is_tested(report.sweeps, settings);
        if is_tested {
            BodySystem::<M>::new(problem, roots).read(&mut directions.before);
        }
        let balance = directions.apply_law::<M>(problem, compliance);
        if is_tested {
            problem.form_velocities();
            let system = BodySystem::<M>::new(problem, roots);
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
        report.stalled =
            best.restore(&mut BodySystem::<M>::new(problem, roots), report.sweeps).stalled;
    }
    report
}
