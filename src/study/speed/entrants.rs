//! Who takes part: every method of the registry.

use crate::solver::{METHODS, Method, MethodKind, Ordering, Remedies, SolverSettings, StopTest};

/// A method as it is charted.
#[derive(Clone, Debug)]
pub(super) struct Entrant {
    /// Its name on charts.
    pub name: String,
    /// Its number among all looks.
    pub look: usize,
    pub method: Method,
    pub ordering: Ordering,
}

/// Every method of the registry, in its order; `auto` is one of the others.
pub(super) fn all() -> Vec<Entrant> {
    let entrant = |(look, info): (usize, &crate::solver::MethodInfo)| Entrant {
        name: info.name.to_owned(),
        look,
        method: info.method,
        ordering: Ordering::default(),
    };
    let own = METHODS.iter().enumerate().filter(|(_, info)| info.method != Method::Auto);
    own.map(entrant).collect()
}

/// Those that solve the problem of a step, and Gauss–Seidel in its other orders where `orders` are
/// asked for.
pub(super) fn of_problems(orders: bool) -> Vec<Entrant> {
    let mut entrants = all();
    entrants.retain(|entrant| entrant.method.kind() == MethodKind::Problem);
    if orders {
        for (name, ordering) in [
            ("bottom-up", Ordering::BottomUp),
            ("detected", Ordering::Detected),
            ("symmetric", Ordering::Symmetric),
        ] {
            entrants.push(Entrant {
                name: format!("nsgs {name}"),
                look: METHODS.len() + entrants.len(),
                method: Method::Nsgs,
                ordering,
            });
        }
    }
    entrants
}

impl Entrant {
    /// Its settings, warm-started, down to a residual.
    pub fn to_residual(&self, tolerance: f64, max_sweeps: u32) -> SolverSettings {
        SolverSettings {
            method: self.method,
            ordering: self.ordering,
            stop: StopTest::Residual,
            tolerance,
            max_sweeps,
            warm_start: true,
            substeps: 0,
            remedies: Remedies::default(),
        }
    }

    /// Its settings with so many sweeps, whatever they come to.
    pub fn sweeps(&self, count: u32) -> SolverSettings {
        self.to_residual(f64::MIN_POSITIVE, count)
    }

    /// Its settings with so many substeps; its own number where that is 0.
    pub fn substeps(&self, count: u32) -> SolverSettings {
        SolverSettings { substeps: count, ..self.to_residual(f64::MIN_POSITIVE, 1) }
    }
}
