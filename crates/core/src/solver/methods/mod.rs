//! The registry of methods: a file or folder each, a row each in `methods!`.

#![deny(dead_code, reason = "a method without a row would not be missed")]

mod admm;
mod apgd;
mod auto;
mod info;
mod interior_point;
mod islands;
mod jacobi;
mod method;
mod newton;
mod nncg;
mod nsgs;
mod nsgs_parallel;
mod report;
mod shared;

use std::fmt;

pub(crate) use self::auto::picked;
pub use self::info::{MethodInfo, MethodOrder};
use self::islands::IslandMemory;
pub use self::method::Method;
#[doc(hidden)]
pub use self::nsgs::sweep;
pub use self::report::SolveReport;
pub use self::shared::body_system::BodySystem;
use self::shared::body_system::SystemMemory;
pub(crate) use self::shared::contact_system::Vectors;
pub use self::shared::contact_system::{ContactSystem, Pairs};
pub(super) use self::shared::iterate::sweep_until_settled;
use super::friction_model::FrictionModel;
use super::ordering::Ordering;
use super::problem::{Kinematics, Model, StepProblem};
use super::settings::SolverSettings;
use crate::setting::{Kind, Settable, Value, Word};

/// Makes of a row a method (variant, module, memory) all that goes through the methods one by one.
/// The module has a `const INFO: MethodInfo` and a
/// `fn solve<M: Model>(&mut StepProblem<M::Kinematics>, &mut Memory, &SolverSettings) -> SolveReport`.
macro_rules! methods {
    ($(($variant:ident, $module:ident, $memory:ty)),* $(,)?) => {
        /// All methods, in the order in which they are shown.
        pub const METHODS: [MethodInfo; 9] = [$($module::INFO),*];

        const WORDS: [Word; METHODS.len()] =
            [$(Word { name: $module::INFO.name, hint: $module::INFO.summary }),*];

        /// What the methods keep from one solve to the next, a field a method. Results do not depend
        /// on it.
        #[derive(Clone, Debug, Default)]
        pub struct Memory<K: Kinematics> {
            $($module: $memory,)*
            islands: IslandMemory<K>,
        }

        impl Method {
            /// What there is to know of it.
            pub const fn info(self) -> &'static MethodInfo {
                match self {
                    $(Self::$variant => &$module::INFO,)*
                }
            }
        }

        fn solve_by_method<M: Model>(
            problem: &mut StepProblem<M::Kinematics>,
            memory: &mut Memory<M::Kinematics>,
            settings: &SolverSettings,
        ) -> SolveReport {
            match settings.method {
                $(Method::$variant => $module::solve::<M>(problem, &mut memory.$module, settings),)*
            }
        }
    };
}

methods![
    (Nsgs, nsgs, ()),
    (NsgsParallel, nsgs_parallel, nsgs_parallel::BlockMemory),
    (Newton, newton, newton::NewtonMemory),
    (Nncg, nncg, SystemMemory),
    (Apgd, apgd, SystemMemory),
    (Admm, admm, admm::AdmmMemory),
    (Jacobi, jacobi, SystemMemory),
    (InteriorPoint, interior_point, interior_point::InteriorMemory),
    (Auto, auto, auto::AutoMemory),
];

impl Method {
    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        self.info().name
    }

    /// Whether it can be had island by island: tiles that threads share are laid over all of a problem.
    pub(super) fn takes_islands(self) -> bool {
        self.info().order != MethodOrder::Always(Ordering::Coloured)
    }

    /// Whether the order of the settings tells the method in which order to sweep.
    pub fn sweeps_in_order(self) -> bool {
        self.info().order == MethodOrder::OfSettings
    }
}

impl Settable for Method {
    const KIND: Kind = Kind::Word(&WORDS);

    fn value(self) -> Value {
        Value::Word(self.name())
    }

    fn of(value: Value) -> Option<Self> {
        let Value::Word(word) = value else { return None };
        METHODS.iter().find(|info| info.name == word).map(|info| info.method)
    }
}

impl fmt::Display for Method {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

/// Solves a prepared problem with the method of the settings: moves `problem.bodies` and fills in
/// the rows' impulses.
///
/// ```
/// use slump::contact::ContactList;
/// use slump::sim::ProblemVisitor;
/// use slump::solver::{Memory, Method, Model, SolverSettings, StepProblem, residual, solve};
///
/// /// What one method leaves undone.
/// struct Left(Method);
///
/// impl ProblemVisitor for Left {
///     type Output = f64;
///
///     fn visit<M: Model>(self, problem: &mut StepProblem<M::Kinematics>, _: &ContactList) -> f64 {
///         let settings = SolverSettings { method: self.0, ..SolverSettings::default() };
///         solve::<M>(problem, &mut Memory::default(), &settings);
///         residual::<M>(problem)
///     }
/// }
///
/// let simulation = slump::scene::built_in("column")?.simulation()?;
/// assert!(simulation.next_problem(Left(Method::Newton)) < 1e-3);
/// # Ok::<(), slump::error::Error>(())
/// ```
// Compiled once, with the library, for all models there are: who calls it with one of them compiles none of it anew.
#[inline(never)]
pub fn solve<M: Model>(
    problem: &mut StepProblem<M::Kinematics>,
    memory: &mut Memory<M::Kinematics>,
    settings: &SolverSettings,
) -> SolveReport {
    if problem.contact_of_row.is_empty() {
        return SolveReport::nothing_yet();
    }
    if settings.falls_back() && problem.friction_model != FrictionModel::Coulomb {
        // An earlier solve of the same problem fell back.
        problem.forget_bounds();
    }
    // Walls that a force drives join what they touch.
    let islands = settings.islands && !problem.is_driven() && memory.islands.divide(problem);
    let report = if islands {
        memory.islands.solve::<M>(problem, settings)
    } else {
        solve_by_method::<M>(problem, memory, settings)
    };
    // What solves bounds of friction knows of no walls that a force drives.
    let falls_back = M::FRICTION && settings.falls_back() && !problem.is_driven();
    if report.converged || !falls_back {
        return report;
    }
    if islands {
        return memory.islands.fall_back::<M>(problem);
    }
    interior_point::fall_back::<M>(problem, &mut memory.interior_point, report)
}

/// Solves any contact system, from its present impulses, with the method of the settings. Gives
/// nothing where that method needs bodies.
pub(crate) fn solve_system<S: ContactSystem>(
    system: &mut S,
    settings: &SolverSettings,
    vectors: &mut Vectors,
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_method_is_called_the_same_in_its_file_in_the_registry_and_in_scene_files() {
        for info in METHODS {
            assert_eq!(info.method.name(), info.name);
            let written = serde_json::to_string(&info.method).expect("a name");
            assert_eq!(written, format!("\"{}\"", info.name));
        }
    }
}
