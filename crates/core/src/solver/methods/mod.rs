//! The methods that find the impulses of a step's contact problem, one file or folder per method. `method` lists their
//! properties.

mod admm;
mod apgd;
mod auto;
mod contact_system;
mod interior_point;
mod jacobi;
mod model_solves;
mod newton;
mod newton_terms;
mod nncg;
mod nonlinear_elimination;
mod nsgs;
mod nsgs_parallel;
mod over_relaxed;
mod pass;
#[cfg(test)]
mod random_problem;
mod stopping;
mod sweep;
mod wedged;

pub use self::auto::CONTACTS_THAT_FLOW;
pub(crate) use self::auto::picked;
pub(crate) use self::contact_system::WorkVectors;
pub use self::contact_system::{BodySystem, ContactSystem, ScaledVector};
#[cfg(test)]
pub(crate) use self::interior_point::solve_within_bounds;
use self::newton::NewtonEffort;
pub use self::pass::sweep;
pub use self::stopping::SolveReport;
pub(super) use self::stopping::sweep_until_settled;
use super::kinematics::Model;
use super::method::Method;
use super::problem::StepProblem;
use super::settings::{FrictionModel, SolverSettings};

/// Work memory of the methods, reused from one solve to the next. It has no effect on results.
#[derive(Clone, Debug, Default)]
pub struct Memory {
    nsgs_parallel: nsgs_parallel::BlockMemory,
    newton: newton::NewtonMemory,
    admm: admm::AdmmMemory,
    pub(super) interior_point: interior_point::InteriorMemory,
    vectors: WorkVectors,
}

/// Solves a prepared contact problem with the method of the settings.
pub(super) fn solve_by_method<M: Model>(
    problem: &mut StepProblem<M>,
    memory: &mut Memory,
    settings: &SolverSettings,
) -> SolveReport {
    match settings.method {
        Method::Auto => auto::solve(problem, memory, settings),
        method => solve_by(method, problem, memory, settings, NewtonEffort::FULL),
    }
}

/// Solves a contact problem with `method`, which may differ from the method of the settings; `effort` limits Newton's
/// method and the conjugate gradients that follow if it fails.
fn solve_by<M: Model>(
    method: Method,
    problem: &mut StepProblem<M>,
    memory: &mut Memory,
    settings: &SolverSettings,
    effort: NewtonEffort,
) -> SolveReport {
    let Memory { nsgs_parallel: blocks, newton, admm, interior_point: path, vectors } = memory;
    match method {
        Method::Nsgs | Method::Auto => nsgs::solve(problem, settings),
        Method::NsgsParallel => nsgs_parallel::solve(problem, blocks, settings),
        Method::Newton => newton::solve(problem, newton, vectors, settings, effort),
        Method::Admm => admm::solve(problem, admm, settings),
        Method::InteriorPoint
            if M::FRICTION
                && problem.law.friction == 0.0
                && problem.friction.model == FrictionModel::Coulomb =>
        {
            // With friction bounds of 0 the problem is convex, and its solution is the solution under Coulomb's law.
            problem.begin_friction(FrictionModel::Tresca);
            let report =
                interior_point::solve(problem, path, settings, |_, _| SolveReport::default());
            problem.forget_bounds();
            report
        }
        Method::InteriorPoint => interior_point::solve(problem, path, settings, |problem, rest| {
            // Newton's method does not support walls that a force drives.
            match problem.is_driven() {
                true => nncg::solve(&mut BodySystem::new(problem), rest, vectors),
                false => newton::solve(problem, newton, vectors, rest, NewtonEffort::FULL),
            }
        }),
        Method::Nncg => nncg::solve(&mut BodySystem::new(problem), settings, vectors),
        Method::Apgd => apgd::solve(&mut BodySystem::new(problem), settings, vectors),
        Method::Jacobi => jacobi::solve(&mut BodySystem::new(problem), settings, vectors),
    }
}

/// Solves a contact system from its present impulses with the method of the settings. Returns `None` if that method
/// needs the bodies of the problem, which a contact system does not provide.
pub(crate) fn solve_system<S: ContactSystem>(
    system: &mut S,
    settings: &SolverSettings,
    vectors: &mut WorkVectors,
) -> Option<SolveReport> {
    match settings.method {
        _ if system.is_empty() => Some(SolveReport::nothing_yet()),
        // Without bodies there is no matrix that Newton's method could factorise.
        Method::Nncg | Method::Auto => Some(nncg::solve(system, settings, vectors)),
        Method::Apgd => Some(apgd::solve(system, settings, vectors)),
        Method::Jacobi => Some(jacobi::solve(system, settings, vectors)),
        Method::Nsgs
        | Method::NsgsParallel
        | Method::Newton
        | Method::InteriorPoint
        | Method::Admm => None,
    }
}
