//! What solves a step's problem: a file or folder a method. `method` says what there is to know of each.

mod admm;
mod apgd;
mod auto;
mod contact_system;
mod interior_point;
mod jacobi;
mod newton;
mod nncg;
mod nsgs;
mod nsgs_parallel;
mod stopping;
mod sweep;

pub(crate) use self::auto::picked;
use self::contact_system::SystemMemory;
pub(crate) use self::contact_system::WorkVectors;
pub use self::contact_system::{BodySystem, ContactSystem, ScaledVector};
pub(super) use self::interior_point::fall_back;
pub use self::nsgs::sweep;
pub use self::stopping::SolveReport;
pub(super) use self::stopping::sweep_until_settled;
use super::kinematics::Model;
use super::method::Method;
use super::problem::StepProblem;
use super::settings::SolverSettings;

/// What the methods keep from one solve to the next. Results do not depend on it.
#[derive(Clone, Debug, Default)]
pub(super) struct MethodMemory {
    nsgs_parallel: nsgs_parallel::BlockMemory,
    newton: newton::NewtonMemory,
    nncg: SystemMemory,
    apgd: SystemMemory,
    admm: admm::AdmmMemory,
    jacobi: SystemMemory,
    pub(super) interior_point: interior_point::InteriorMemory,
    auto: auto::AutoMemory,
}

/// Solves a prepared problem with the method of the settings.
pub(super) fn solve_by_method<M: Model>(
    problem: &mut StepProblem<M>,
    memory: &mut MethodMemory,
    settings: &SolverSettings,
) -> SolveReport {
    match settings.method {
        Method::Nsgs => nsgs::solve::<M>(problem, settings),
        Method::NsgsParallel => {
            nsgs_parallel::solve::<M>(problem, &mut memory.nsgs_parallel, settings)
        }
        Method::Newton => newton::solve::<M>(problem, &mut memory.newton, settings),
        Method::Nncg => nncg::solve::<M>(problem, &mut memory.nncg, settings),
        Method::Apgd => apgd::solve::<M>(problem, &mut memory.apgd, settings),
        Method::Admm => admm::solve::<M>(problem, &mut memory.admm, settings),
        Method::Jacobi => jacobi::solve::<M>(problem, &mut memory.jacobi, settings),
        Method::InteriorPoint => {
            interior_point::solve::<M>(problem, &mut memory.interior_point, settings)
        }
        Method::Auto => auto::solve::<M>(problem, &mut memory.auto, settings),
    }
}

/// Solves any contact system, from its present impulses, with the method of the settings. Gives
/// nothing where that method needs bodies.
pub(crate) fn solve_system<S: ContactSystem>(
    system: &mut S,
    settings: &SolverSettings,
    vectors: &mut WorkVectors,
) -> Option<SolveReport> {
    if system.is_empty() {
        return Some(SolveReport::nothing_yet());
    }
    match settings.method {
        // Without bodies there is nothing to factorise.
        Method::Nncg | Method::Auto => Some(nncg::solve_system(system, settings, vectors)),
        Method::Apgd => Some(apgd::solve_system(system, settings, vectors)),
        Method::Jacobi => Some(jacobi::solve_system(system, settings, vectors)),
        Method::Nsgs
        | Method::NsgsParallel
        | Method::Newton
        | Method::InteriorPoint
        | Method::Admm => None,
    }
}
