//! What a user asks of a run: where the scene comes from, and changes to it. The same structure is the
//! command line's options, a run of a study, and what is written beside results.

use std::path::Path;

use super::file::read_unsettled;
use super::{
    Origin, Rain, SavedState, Scene, Settling, built_in, cradle_from, pile_of, read_discs, settle,
};
use crate::error::{Error, Result};
use crate::setting::{Changes, Value};
use crate::sim::{RemedyChanges, Settings, Stepper};
use crate::solver::SolverChanges;
use crate::world::{Grain, ParameterChanges};

/// A scene and changes to it. What is left out stays as the scene says. Plain data, checked where the
/// scene is made ([`Config::scene`]).
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

/// A scene before anything of it is changed.
#[derive(Clone, Debug)]
pub struct Ground {
    scene: Scene,
    /// What its grains are the start of, where they have to settle.
    rain: Option<Rain>,
}

impl Config {
    /// The name of the scene that is used where none is given.
    pub const DEFAULT_SCENE: &str = "pile";
    /// The scene whose start can be chosen.
    const CRADLE: &str = "cradle";

    /// A scene by name or file, as it says itself.
    pub fn of_scene(name: impl Into<String>) -> Self {
        let origin = Origin { scene: Some(name.into()), ..Origin::default() };
        Self { origin, ..Self::default() }
    }

    /// Whether nothing is asked for.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// The same with all settings given.
    pub fn with_settings(self, settings: &Settings) -> Self {
        Self {
            stepper: Some(settings.stepper),
            parameters: Changes::all_of(&settings.parameters),
            solver: Changes::all_of(&settings.solver),
            remedies: Changes::all_of(&settings.remedies),
            ..self
        }
    }

    /// Gives the setting of that name a value of its kind. Whether there is one of that name and kind.
    pub fn set(&mut self, name: &str, value: Value) -> bool {
        let Self { stepper, parameters, solver, remedies, .. } = self;
        if name == Settings::STEPPER.name {
            *stepper = crate::setting::Settable::of(value);
            return stepper.is_some();
        }
        parameters.set(name, value) || solver.set(name, value) || remedies.set(name, value)
    }

    /// The scene with the changes made, checked, but for grains that are rained: those of the built-in
    /// pile, or of the start of the rain, stand in for them. Quick, so that a wrong value is told of
    /// before long work.
    ///
    /// # Errors
    /// Names the first field that is unknown or outside its range, or the file that cannot be read.
    pub fn without_settling(&self) -> Result<Scene> {
        self.change(&self.ground()?)
    }

    /// The scene with the changes made, checked. Rained grains are settled here, which takes a while:
    /// `progress` is told, and can end it by returning false.
    ///
    /// # Errors
    /// Names the first field that is unknown or outside its range, or the file that cannot be read; and
    /// where the grains do not come to rest.
    pub fn scene(&self, progress: impl FnMut(Settling) -> bool) -> Result<Scene> {
        let ground = self.ground()?;
        let scene = self.change(&ground)?;
        match self.rain_on(&ground) {
            None => Ok(scene),
            Some(rain) => self.settled_on(ground, settle(&rain, progress)?),
        }
    }

    /// The scene whose settled grains are at hand.
    ///
    /// # Errors
    /// As [`Config::without_settling`].
    pub fn scene_from(&self, settled: Vec<Grain>) -> Result<Scene> {
        self.settled_on(self.ground()?, settled)
    }

    /// What has to be rained for this scene, if anything.
    ///
    /// # Errors
    /// As [`Config::without_settling`].
    pub fn rain(&self) -> Result<Option<Rain>> {
        if self.origin.makes_new_pile() {
            return Ok(Some(self.origin.rain()));
        }
        Ok(self.ground()?.rain)
    }

    /// The scene as its file or its name says it.
    ///
    /// # Errors
    /// As [`Config::without_settling`].
    pub fn ground(&self) -> Result<Ground> {
        self.check_origin()?;
        let Origin { initial, start, .. } = &self.origin;
        let name = self.named();
        let (scene, rain) =
            if let Some(path) = initial.as_deref().filter(|path| SavedState::is_in(path)) {
                (self.scene_of_state(path)?, None)
            } else if let Some(path) = initial {
                self.check_pile_alone("initial grains")?;
                (pile_of(read_discs(path)?, self.origin.rain().box_width_in_diameters)?, None)
            } else if name.ends_with(".toml") {
                read_unsettled(name.as_ref())?
            } else if let (Self::CRADLE, Some(start)) = (name, *start) {
                (cradle_from(start), None)
            } else {
                (built_in(name)?, None)
            };
        Ok(Ground { scene, rain })
    }

    /// What of a config its [`Config::ground`] hangs on: equal for all that share one.
    pub fn name_of_ground(&self) -> String {
        let Origin { initial, box_width, start, .. } = &self.origin;
        let box_width = box_width.filter(|_| initial.is_some());
        format!("{:?}", (self.named(), initial, box_width, start))
    }

    /// The scene of [`Config::without_settling`] where its ground is at hand.
    ///
    /// # Errors
    /// As there.
    pub fn change(&self, ground: &Ground) -> Result<Scene> {
        self.check_origin()?;
        let mut scene = ground.scene.clone();
        self.change_scene(&mut scene)?;
        Ok(scene)
    }

    fn named(&self) -> &str {
        self.origin.scene.as_deref().unwrap_or(Self::DEFAULT_SCENE)
    }

    /// Whether what is said of the scene's origin goes together.
    fn check_origin(&self) -> Result<()> {
        let name = self.named();
        if self.origin.makes_new_pile() {
            self.check_pile_alone("grains, box-width or seed")?;
            self.origin.rain().validate()?;
        }
        match self.origin.start {
            Some(_) if name != Self::CRADLE => {
                Err(Error::value("scene", name, "cradle where start is given"))
            }
            Some(start) if !(start >= 1.0 && start.is_finite()) => {
                Err(Error::value("start", start, "a finite number of diameters ≥ 1"))
            }
            _ => Ok(()),
        }
    }

    fn check_pile_alone(&self, fields: &str) -> Result<()> {
        match self.named() {
            Self::DEFAULT_SCENE => Ok(()),
            name => Err(Error::value("scene", name, format!("pile where {fields} are given"))),
        }
    }

    /// The scene of a saved state, which begins with the state's grains.
    fn scene_of_state(&self, path: &Path) -> Result<Scene> {
        let scene = SavedState::open(path)?.as_start();
        match &self.origin.scene {
            Some(name) if *name != scene.name => {
                let allowed =
                    format!("left out, or {}, the scene of the initial state", scene.name);
                Err(Error::value("scene", name, allowed))
            }
            _ => Ok(scene),
        }
    }

    /// Makes the changes asked for to a run that goes on: from here on, while all that has been stays.
    ///
    /// # Errors
    /// Names the first setting that is outside its range or does not go with the others, or says that
    /// another start is asked for.
    pub fn change_state(&self, state: &mut SavedState) -> Result<()> {
        let kept = Origin { duration: self.origin.duration, ..Origin::default() };
        if self.origin != kept {
            let allowed = "left out where scene, initial, grains, box-width, seed, start or preset is \
                           given: a run that goes on has its own";
            return Err(Error::value("restart", "given", allowed));
        }
        let mut scene = state.scene.clone();
        self.change_scene(&mut scene)?;
        state.simulation.change(scene.settings())?;
        state.scene = scene;
        Ok(())
    }

    fn rain_on(&self, ground: &Ground) -> Option<Rain> {
        let new_pile = self.origin.makes_new_pile();
        if new_pile { Some(self.origin.rain()) } else { ground.rain.clone() }
    }

    fn settled_on(&self, ground: Ground, settled: Vec<Grain>) -> Result<Scene> {
        let mut scene = if self.origin.makes_new_pile() {
            pile_of(settled, self.origin.rain().box_width_in_diameters)?
        } else {
            ground.scene.with_settled(settled)
        };
        self.change_scene(&mut scene)?;
        Ok(scene)
    }

    /// The same asked for, with every number that `scene` fills in.
    pub fn resolved(&self, scene: &Scene) -> Self {
        // An initial state may have a scene of its own.
        let name = if self.origin.initial.is_some() { &scene.name } else { self.named() };
        let origin = Origin {
            scene: Some(name.into()),
            duration: Some(scene.duration_secs),
            ..self.origin.clone()
        };
        Self { origin, ..self.clone() }.with_settings(&scene.settings())
    }

    fn change_scene(&self, scene: &mut Scene) -> Result<()> {
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
