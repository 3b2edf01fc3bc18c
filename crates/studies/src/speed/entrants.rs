//! Who takes part: every method of the registry.

use crate::scene::Scene;
use crate::sim::{Settings, Stepper};
use crate::solver::{FrictionModel, METHODS, Method, Ordering, SolverSettings, StopTest};

/// Looks of models of friction, from the number of looks on: `newton` has the second one there, under the law
/// `range`.
const OTHER_LOOKS: [usize; 3] = [0, 1, 3];

/// A method, or a way to step that has none, as it is charted.
#[derive(Clone, Debug)]
pub(super) struct Entrant {
    /// Its name on charts.
    pub name: String,
    /// Its number among all looks.
    pub look: usize,
    pub stepper: Stepper,
    pub solver: SolverSettings,
}

/// How an entrant steps, with an effort.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    pub stepper: Stepper,
    pub solver: SolverSettings,
    pub substeps: u32,
}

/// Steppers that solve no problem by a method: entrants by themselves.
fn without_method() -> impl Iterator<Item = Stepper> {
    Stepper::ALL.iter().copied().filter(|stepper| !stepper.uses_method())
}

/// How many looks there are, but for those of entrants that come twice.
pub(super) fn looks() -> usize {
    METHODS.len() + without_method().count()
}

/// Every method of the registry, in its order, and every way to step without one; `auto` is one of the
/// others.
pub(super) fn all() -> Vec<Entrant> {
    let mut entrants = of_problems(false);
    entrants.extend((METHODS.len()..).zip(without_method()).map(|(look, stepper)| {
        let name = stepper.name().to_owned();
        Entrant { name, look, stepper, solver: SolverSettings::default() }
    }));
    entrants
}

/// A method that solves the problem of a step.
pub(super) fn of_method(method: Method) -> Entrant {
    let look = METHODS.iter().position(|info| info.method == method).unwrap_or_default();
    of_model(method, FrictionModel::Coulomb, look)
}

/// Those that solve the problem of a step, and Gauss–Seidel in its other orders where `orders` are
/// asked for.
pub(super) fn of_problems(orders: bool) -> Vec<Entrant> {
    let entrant = |name: String, look, method, ordering| {
        let solver = SolverSettings { method, ordering, ..SolverSettings::default() };
        Entrant { name, look, stepper: Stepper::Moreau, solver }
    };
    let own = METHODS.iter().enumerate().filter(|(_, info)| info.method != Method::Auto);
    let mut entrants: Vec<Entrant> = own
        .map(|(look, info)| entrant(info.name.to_owned(), look, info.method, Ordering::default()))
        .collect();
    if orders {
        for ordering in [Ordering::BottomUp, Ordering::Detected, Ordering::Symmetric] {
            let look = looks() + entrants.len();
            entrants.push(entrant(format!("nsgs {ordering}"), look, Method::Nsgs, ordering));
        }
    }
    entrants
}

/// Models of friction in the place of Coulomb's law, by sweeps, and the one that piles do not tell from it by the
/// method that certifies it: they solve another problem, so that whole simulations alone can tell what they are
/// worth.
pub(super) fn models() -> Vec<Entrant> {
    let models = FrictionModel::ALL.iter().filter(|model| **model != FrictionModel::Coulomb);
    let by_sweeps = OTHER_LOOKS.into_iter().zip(models);
    let mut entrants: Vec<Entrant> =
        by_sweeps.map(|(look, &model)| of_model(Method::Nsgs, model, looks() + look)).collect();
    entrants.push(certified());
    entrants
}

/// The convex model that piles do not tell from Coulomb's law, by the method that certifies it. `auto`, which is
/// on no chart, leaves it its look.
pub(super) fn certified() -> Entrant {
    of_model(Method::InteriorPoint, FrictionModel::Tresca, of_method(Method::Auto).look)
}

fn of_model(method: Method, friction_model: FrictionModel, look: usize) -> Entrant {
    let solver = SolverSettings { method, friction_model, ..SolverSettings::default() };
    let name = match friction_model {
        FrictionModel::Coulomb => method.to_string(),
        _ => format!("{method} {friction_model}"),
    };
    Entrant { name, look, stepper: Stepper::Moreau, solver }
}

impl Entrant {
    /// Its method, if it has one.
    pub(super) fn method(&self) -> Option<Method> {
        self.stepper.uses_method().then_some(self.solver.method)
    }

    /// Whether it solves another problem than Coulomb's law poses.
    pub(super) fn is_of_model(&self) -> bool {
        self.solver.friction_model != FrictionModel::Coulomb
    }

    /// Warm-started, down to a residual.
    pub(super) fn to_residual(&self, tolerance: f64, max_sweeps: u32) -> Way {
        let solver = SolverSettings {
            stop: StopTest::Residual,
            tolerance,
            max_sweeps,
            warm_start: true,
            ..self.solver
        };
        Way { stepper: self.stepper, solver, substeps: 0 }
    }

    /// With so many sweeps, whatever they come to.
    pub(super) fn sweeps(&self, count: u32) -> Way {
        self.to_residual(f64::MIN_POSITIVE, count)
    }

    /// With so many substeps; its own number where that is 0.
    pub(super) fn substeps(&self, count: u32) -> Way {
        Way { substeps: count, ..self.sweeps(1) }
    }
}

impl Way {
    /// The settings, stepped this way.
    pub(super) fn over(&self, settings: &Settings) -> Settings {
        let Self { stepper, solver, substeps } = *self;
        let mut settings = Settings { stepper, solver, ..*settings };
        settings.parameters.substeps = substeps;
        settings
    }

    /// Has a scene stepped this way.
    pub(super) fn take(&self, scene: &mut Scene) {
        scene.set_settings(self.over(&scene.settings()));
    }
}
