//! What a user asks of a run: where the scene comes from, and changes to it. The same structure is the
//! command line's options, a run of a study, and what is written beside results.

use super::{
    Origin, Scene, Settling, built_in, cradle_from, pile_of, read_discs, read_scene, settle,
};
use crate::error::{Error, Result};
use crate::setting::{Changes, Value};
use crate::sim::{RemedyChanges, Settings, Stepper};
use crate::solver::SolverChanges;
use crate::world::{Grain, ParameterChanges};

/// A scene and changes to it. What is left out stays as the scene says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Config {
    /// Where the scene comes from.
    pub origin: Origin,
    /// The way to step.
    pub stepper: Option<Stepper>,
    /// Numbers of the contact laws, and Δt.
    pub parameters: ParameterChanges,
    /// How well each step is solved.
    pub solver: SolverChanges,
    /// Remedies for known failures.
    pub remedies: RemedyChanges,
}

impl Config {
    /// The name of the scene that is used where none is given.
    pub(crate) const DEFAULT_SCENE: &str = "pile";

    /// A scene by name or file, as it says itself.
    pub fn of_scene(name: impl Into<String>) -> Self {
        let origin = Origin { scene: Some(name.into()), ..Origin::default() };
        Self { origin, ..Self::default() }
    }

    /// Whether nothing is asked for.
    pub(crate) fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// The same with all settings given.
    pub(crate) fn with_settings(self, settings: &Settings) -> Self {
        Self {
            stepper: Some(settings.stepper),
            parameters: Changes::all_of(&settings.parameters),
            solver: Changes::all_of(&settings.solver),
            remedies: Changes::all_of(&settings.remedies),
            ..self
        }
    }

    /// Gives the setting of that name a value of its kind. Whether there is one of that name and kind.
    pub(crate) fn set(&mut self, name: &str, value: Value) -> bool {
        let Self { stepper, parameters, solver, remedies, .. } = self;
        if name == Settings::STEPPER.name {
            *stepper = crate::setting::Settable::of(value);
            return stepper.is_some();
        }
        parameters.set(name, value) || solver.set(name, value) || remedies.set(name, value)
    }

    /// The scene with the changes made, checked, but for the grains of a new pile: those of the
    /// built-in one stand in for them. Quick, so that a wrong value is told of before long work.
    ///
    /// # Errors
    /// Names the first field that is unknown or outside its range, or the file that cannot be read.
    pub(crate) fn without_settling(&self) -> Result<Scene> {
        let Origin { initial, start, .. } = &self.origin;
        let name = self.origin.scene.as_deref().unwrap_or(Self::DEFAULT_SCENE);
        let pile_alone = |fields: &str| match name {
            Self::DEFAULT_SCENE => Ok(()),
            _ => Err(Error::value("scene", name, format!("pile where {fields} are given"))),
        };
        let mut scene = if let Some(path) = initial {
            pile_alone("initial grains")?;
            pile_of(read_discs(path)?, self.origin.rain().box_width_in_diameters)
        } else if name.ends_with(".toml") {
            read_scene(name.as_ref())?
        } else {
            built_in(name)?
        };
        if self.origin.makes_new_pile() {
            pile_alone("grains, box-width or seed")?;
            self.origin.rain().validate()?;
        }
        if let Some(start) = *start {
            if name != "cradle" {
                return Err(Error::value("scene", name, "cradle where start is given"));
            }
            if !(start >= 1.0 && start.is_finite()) {
                return Err(Error::value("start", start, "a finite number of diameters ≥ 1"));
            }
            scene = cradle_from(start);
        }
        self.change(&mut scene)?;
        Ok(scene)
    }

    /// The scene with the changes made, checked. A new pile is settled here, which takes a while:
    /// `progress` is told, and can end it by returning false.
    ///
    /// # Errors
    /// As [`Config::without_settling`], and where the grains do not come to rest.
    pub fn scene(&self, progress: impl FnMut(Settling) -> bool) -> Result<Scene> {
        let scene = self.without_settling()?;
        if !self.origin.makes_new_pile() {
            return Ok(scene);
        }
        self.scene_from(settle(&self.origin.rain(), progress)?)
    }

    /// The scene of a new pile whose settled grains are at hand.
    ///
    /// # Errors
    /// As [`Config::without_settling`].
    pub(crate) fn scene_from(&self, settled: Vec<Grain>) -> Result<Scene> {
        let mut pile = pile_of(settled, self.origin.rain().box_width_in_diameters);
        self.change(&mut pile)?;
        Ok(pile)
    }

    /// The same asked for, with every number that `scene` fills in.
    pub(crate) fn resolved(&self, scene: &Scene) -> Self {
        let named = self.origin.scene.clone().unwrap_or_else(|| Self::DEFAULT_SCENE.into());
        let origin = Origin {
            scene: Some(named),
            duration: Some(scene.duration_secs),
            ..self.origin.clone()
        };
        Self { origin, ..self.clone() }.with_settings(&scene.settings())
    }

    fn change(&self, scene: &mut Scene) -> Result<()> {
        scene.stepper = self.stepper.unwrap_or(scene.stepper);
        // A preset leaves out what the stepper does not take.
        if let Some(preset) = self.origin.preset {
            preset.apply(scene);
        }
        self.parameters.apply(&mut scene.parameters);
        self.solver.apply(&mut scene.solver);
        self.remedies.apply(&mut scene.remedies);
        scene.duration_secs = self.origin.duration.unwrap_or(scene.duration_secs);
        scene.validate()
    }
}
