//! Who is tried: every method of the registry, the models of friction that are not Coulomb's law, and settings
//! that mend a known failure.

use std::sync::LazyLock;

use crate::scene::{Preset, Scene};
use crate::sim::Stepper;
use crate::solver::{FrictionModel, METHODS, Method, Ordering};

/// A way to step that is tried.
#[derive(Clone, Copy, Debug)]
pub struct Contender {
    /// Its name in the table.
    pub(crate) name: &'static str,
    way: Way,
}

#[derive(Clone, Copy, Debug)]
enum Way {
    /// The paper's stepper with this method.
    Method(Method),
    /// Gauss–Seidel in an order of its own.
    Order(Ordering),
    /// A model of friction, solved so many times a step by the method that solves it for certain.
    Model(FrictionModel, u32),
    /// A stepper that solves no problem by a method.
    Stepper(Stepper),
    /// Settings that go together.
    Preset(Preset),
}

impl Contender {
    /// Changes a scene to be stepped this way; whatever else it says stays.
    pub(crate) fn apply(&self, scene: &mut Scene) {
        match self.way {
            Way::Method(method) => scene.solver.method = method,
            Way::Order(ordering) => {
                scene.solver.method = Method::Nsgs;
                scene.solver.ordering = ordering;
            }
            Way::Model(friction_model, model_solves) if scene.physics.friction => {
                scene.solver.method = Method::InteriorPoint;
                scene.solver.friction_model = friction_model;
                scene.solver.model_solves = model_solves;
            }
            Way::Model(..) => scene.solver.method = Method::InteriorPoint,
            Way::Stepper(stepper) => scene.stepper = stepper,
            Way::Preset(preset) => preset.apply(scene),
        }
    }

    /// Whether it is a method or a stepper, and not settings of one.
    pub(crate) fn is_of_registry(&self) -> bool {
        matches!(self.way, Way::Method(_) | Way::Stepper(_))
    }

    /// The contender of that name.
    pub(crate) fn named(name: &str) -> Option<&'static Self> {
        CONTENDERS.iter().find(|contender| contender.name == name)
    }
}

/// All contenders: every method, every stepper without one, every model of friction beside Coulomb's law, and
/// settings that mend a known failure.
pub(crate) static CONTENDERS: LazyLock<Vec<Contender>> = LazyLock::new(|| {
    let methods =
        METHODS.iter().map(|info| Contender { name: info.name, way: Way::Method(info.method) });
    let steppers = Stepper::ALL.iter().filter(|stepper| !stepper.uses_method());
    let steppers =
        steppers.map(|&stepper| Contender { name: stepper.name(), way: Way::Stepper(stepper) });
    let models = FrictionModel::ALL.iter().filter(|model| **model != FrictionModel::Coulomb);
    let models = models.map(|&model| Contender { name: model.name(), way: Way::Model(model, 1) });
    let others = [
        Contender { name: "tresca twice", way: Way::Model(FrictionModel::Tresca, 2) },
        Contender { name: "nsgs bottom-up", way: Way::Order(Ordering::BottomUp) },
        Contender { name: "robust", way: Way::Preset(Preset::Robust) },
    ];
    methods.chain(steppers).chain(models).chain(others).collect()
});
