//! Named changes of the settings of scenes.

use crate::config::Config;
use crate::scene::Scene;
use crate::setting::Changes;
use crate::sim::Stepper;
use crate::solver::SolverSettings;

/// A named change of settings.
#[derive(Clone, Debug)]
pub(crate) struct Change {
    pub name: String,
    pub config: Config,
}

impl Change {
    pub(crate) fn new(name: impl Into<String>, config: Config) -> Self {
        Self { name: name.into(), config }
    }

    /// A change to a stepper, with all settings of its solver.
    pub(crate) fn of_solver(
        name: impl Into<String>,
        stepper: Stepper,
        solver: &SolverSettings,
    ) -> Self {
        let solver = Changes::all_of(solver);
        Self::new(name, Config { stepper: Some(stepper), solver, ..Config::default() })
    }

    /// Changes the settings of a scene that are given, and no others. A scene without friction ignores a friction
    /// model.
    pub(crate) fn apply(&self, scene: &mut Scene) {
        if let Some(preset) = self.config.source.preset {
            preset.apply(scene);
        }
        let mut settings = scene.settings();
        self.config.change_settings(&mut settings);
        if !scene.physics.friction {
            settings.solver.friction_model = scene.solver.friction_model;
        }
        scene.set_settings(settings);
    }

    pub(crate) fn stepper(&self) -> Stepper {
        self.config.stepper.unwrap_or(Stepper::Moreau)
    }

    /// The settings of the solver after this change, starting from those for sweeps.
    pub(crate) fn solver(&self) -> SolverSettings {
        let mut solver = SolverSettings::SWEEPS;
        self.config.solver.apply(&mut solver);
        solver
    }
}
