//! Defines named changes of the settings of a scene.

use crate::config::Config;
use crate::scene::Scene;
use crate::setting::Changes;
use crate::sim::Stepper;
use crate::solver::SolverSettings;

/// A named change of a scene: the settings that are given in `config` replace the settings of the scene.
#[derive(Clone, Debug)]
pub(crate) struct Change {
    pub name: String,
    pub config: Config,
}

impl Change {
    pub(crate) fn new(name: impl Into<String>, config: Config) -> Self {
        Self { name: name.into(), config }
    }

    /// Returns a change that replaces the stepper and all settings of the solver.
    pub(crate) fn of_solver(
        name: impl Into<String>,
        stepper: Stepper,
        solver: &SolverSettings,
    ) -> Self {
        let solver = Changes::all_of(solver);
        Self::new(name, Config { stepper: Some(stepper), solver, ..Config::default() })
    }

    /// Applies the change to a scene. Settings that the change does not give remain as they are. The friction model of
    /// a scene without friction also remains as it is.
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

    /// Returns the solver settings after this change is applied to `SolverSettings::SWEEPS`, the settings for
    /// Gauss–Seidel sweeps.
    pub(crate) fn solver(&self) -> SolverSettings {
        let mut solver = SolverSettings::SWEEPS;
        self.config.solver.apply(&mut solver);
        solver
    }
}
