//! What a user asks of a run: where the scene comes from, and changes to it. The same structure is the
//! command line's options, a run of a study, and what is written beside results.

use std::path::Path;

use super::file::{read_unsettled, unsettled};
use super::{Origin, SavedState};
use crate::data::{RecordedGrains, read_grains};
use crate::error::{Error, Result};
use crate::scene::{NewPile, Scene, Settling, built_in, cradle_from, pile_of, put_on_base, settle};
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
    new_pile: Option<NewPile>,
}

impl Ground {
    /// A scene that is at hand, but for a file of discs that it names: that lies in `folder`.
    ///
    /// # Errors
    /// Names the first field outside its range, or the file that cannot be read.
    pub fn of(scene: Scene, folder: &Path) -> Result<Self> {
        let (scene, new_pile) = unsettled(scene, folder)?;
        Ok(Self { scene, new_pile })
    }
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

    /// The scene with the changes made, checked, but for a new pile: the grains of the built-in
    /// one, or where they start from, stand in for it. Quick, so that a wrong value is told of
    /// before long work.
    ///
    /// # Errors
    /// Names the first field that is unknown or outside its range, or the file that cannot be read.
    pub fn without_settling(&self) -> Result<Scene> {
        self.change(&self.ground()?)
    }

    /// The scene with the changes made, checked. A new pile is made here, which takes a while:
    /// `progress` is told, and can end it by returning false.
    ///
    /// # Errors
    /// Names the first field that is unknown or outside its range, or the file that cannot be read; and
    /// where the grains do not come to rest.
    pub fn scene(&self, progress: impl FnMut(Settling) -> bool) -> Result<Scene> {
        self.scene_on(self.ground()?, progress)
    }

    /// The same of a scene that is at hand, whatever scene is named.
    ///
    /// # Errors
    /// As [`Config::scene`].
    pub fn scene_on(
        &self,
        ground: Ground,
        progress: impl FnMut(Settling) -> bool,
    ) -> Result<Scene> {
        let scene = self.change(&ground)?;
        match self.new_pile_on(&ground) {
            None => Ok(scene),
            Some(pile) => self.settled_on(ground, settle(&pile, progress)?),
        }
    }

    /// The scene whose settled grains are at hand.
    ///
    /// # Errors
    /// As [`Config::without_settling`].
    pub fn scene_from(&self, settled: Vec<Grain>) -> Result<Scene> {
        self.settled_on(self.ground()?, settled)
    }

    /// The scene that starts from these discs, as if `initial` were a file of them.
    ///
    /// # Errors
    /// As [`Config::without_settling`].
    pub fn scene_of_discs(&self, discs: RecordedGrains) -> Result<Scene> {
        self.check_origin()?;
        self.change(&Ground { scene: self.pile_of_recorded(discs)?, new_pile: None })
    }

    /// The pile that has to be made for this scene, if any.
    ///
    /// # Errors
    /// As [`Config::without_settling`].
    pub fn new_pile(&self) -> Result<Option<NewPile>> {
        if self.origin.makes_new_pile() {
            return Ok(Some(self.origin.new_pile()));
        }
        Ok(self.ground()?.new_pile)
    }

    /// The scene as its file or its name says it.
    ///
    /// # Errors
    /// As [`Config::without_settling`].
    pub fn ground(&self) -> Result<Ground> {
        self.check_origin()?;
        let Origin { initial, initial_step, start, .. } = &self.origin;
        let name = self.named();
        let (scene, new_pile) =
            if let Some(path) = initial.as_deref().filter(|path| SavedState::is_in(path)) {
                (self.scene_of_state(path)?, None)
            } else if let Some(path) = initial {
                self.check_pile_alone("initial grains")?;
                (self.pile_of_recorded(read_grains(path, *initial_step)?)?, None)
            } else if name.ends_with(".toml") {
                read_unsettled(name.as_ref())?
            } else if let (Self::CRADLE, Some(start)) = (name, *start) {
                (cradle_from(start), None)
            } else {
                (built_in(name)?, None)
            };
        Ok(Ground { scene, new_pile })
    }

    /// What of a config its [`Config::ground`] hangs on: equal for all that share one.
    pub fn name_of_ground(&self) -> String {
        let Origin { initial, initial_step, box_width, start, .. } = &self.origin;
        let box_width = box_width.filter(|_| initial.is_some());
        format!("{:?}", (self.named(), initial, initial_step, box_width, start))
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
        if let (None, Some(step)) = (&self.origin.initial, self.origin.initial_step) {
            let allowed = "left out where no initial grains are given";
            return Err(Error::value("initial-step", step, allowed));
        }
        if self.origin.makes_new_pile() {
            self.check_pile_alone("grains, box-width, seed or deposition")?;
            self.origin.new_pile().validate()?;
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

    fn pile_of_recorded(&self, discs: RecordedGrains) -> Result<Scene> {
        let RecordedGrains { grains, fixed_discs } = discs;
        let mut pile = pile_of(grains, self.origin.new_pile().box_width_in_diameters)?;
        if !fixed_discs.is_empty() {
            // The base that the grains lie on, as wide as it was.
            pile.fixed_discs = fixed_discs;
        }
        Ok(pile)
    }

    fn new_pile_on(&self, ground: &Ground) -> Option<NewPile> {
        let new_pile = self.origin.makes_new_pile();
        if new_pile { Some(self.origin.new_pile()) } else { ground.new_pile.clone() }
    }

    fn settled_on(&self, ground: Ground, settled: Vec<Grain>) -> Result<Scene> {
        let mut scene = if self.origin.makes_new_pile() {
            pile_of(settled, self.origin.new_pile().box_width_in_diameters)?
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

    /// Changes what is given of settings. A preset, which is no setting, is left out.
    pub fn change_settings(&self, settings: &mut Settings) {
        settings.stepper = self.stepper.unwrap_or(settings.stepper);
        self.parameters.apply(&mut settings.parameters);
        self.solver.apply(&mut settings.solver);
        self.remedies.apply(&mut settings.remedies);
    }

    pub(super) fn change_scene(&self, scene: &mut Scene) -> Result<()> {
        if let Some(width) = self.origin.base_width {
            put_on_base(scene, width)?;
        }
        scene.stepper = self.stepper.unwrap_or(scene.stepper);
        // A preset leaves out what the stepper does not take.
        if let Some(preset) = self.origin.preset {
            preset.apply(scene);
        }
        let mut settings = scene.settings();
        self.change_settings(&mut settings);
        scene.set_settings(settings);
        scene.duration_secs = self.origin.duration.unwrap_or(scene.duration_secs);
        scene.validate()
    }
}
