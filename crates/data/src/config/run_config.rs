//! What a user asks of a run: where the scene comes from, and changes to it. The same structure is the
//! command line's options, a run of a study, and what is written beside results.

use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::MapAccess;

use super::SavedState;
use super::option_words::parser_of;
use super::recorded_scene::check_starts_pile;
use super::scene_file::{read_unsettled, unsettled};
use crate::data::{RecordedGrains, read_grains};
use crate::error::{Error, Result};
use crate::scene::{
    Deposition, NewPile, Preset, Scene, SceneInfo, Settling, built_in, cradle_from, pile_of,
    put_on_base, settle,
};
use crate::setting::{Changes, Settable, Value};
use crate::sim::{RemedyChanges, Settings, Stepper};
use crate::solver::SolverChanges;
use crate::world::{Grain, ParameterChanges};

/// A scene and changes to it. What is left out stays as the scene says. Plain data, checked where the
/// scene is made ([`Config::scene`]).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Config {
    /// Where the scene comes from.
    pub source: SceneSource,
    /// The way to step.
    pub stepper: Option<Stepper>,
    /// Numbers of the contact laws, and Δt.
    pub parameters: ParameterChanges,
    /// How well each step is solved.
    pub solver: SolverChanges,
    /// Remedies for known failures.
    pub remedies: RemedyChanges,
    /// The folder that relative paths of files are in; the working directory where it is empty. It is not a part of the
    /// request: a study asks for the same runs in any folder.
    pub folder: PathBuf,
}

/// Where a scene comes from, and what of it is not a setting.
#[derive(Clone, Debug, Default, PartialEq, Serialize, clap::Args)]
#[serde(rename_all = "kebab-case")]
pub struct SceneSource {
    /// Built-in scene (pile, cradle, collision, …: `slump list`) or a scene file (NAME.toml)
    #[arg(long, value_name = "NAME|FILE", help_heading = "Scene")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scene: Option<String>,
    /// Start the pile from discs: a CSV (header x,y,radius, optionally vx,vy,omega; metres), or what --data wrote as CSV or Parquet; or the scene of a saved run from its grains
    #[arg(long, value_name = "FILE", help_heading = "Scene", conflicts_with_all = ["grains", "box_width", "seed", "deposition"])]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub initial: Option<PathBuf>,
    /// The step of the recording that the pile starts from [default: its last]
    #[arg(long, value_name = "N", help_heading = "Scene")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub initial_step: Option<u64>,
    /// Make a new pile of this many grains
    #[arg(long, value_name = "N", help_heading = "Scene")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub grains: Option<usize>,
    /// Width of the box that a new pile is made in, in mean diameters
    #[arg(long, value_name = "D", help_heading = "Scene")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub box_width: Option<f64>,
    /// Width of the rough base under a pile, in mean diameters [default: five heights beyond the box on either side]
    #[arg(long, value_name = "D", help_heading = "Scene")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub base_width: Option<f64>,
    /// Seed of a new pile
    #[arg(long, value_name = "N", help_heading = "Scene")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
    /// How the grains of a new pile are put in place [default: rain]
    #[arg(long, value_name = "WAY", value_parser = parser_of::<Deposition>(), help_heading = "Scene")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub deposition: Option<Deposition>,
    /// Where the cradle's k starts, in diameters left of i, centre to centre
    #[arg(long, value_name = "D", help_heading = "Scene")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start: Option<f64>,
    /// Settings that go together; what else is given changes them
    #[arg(long, value_name = "NAME", value_parser = parser_of::<Preset>(), help_heading = "Scene")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub preset: Option<Preset>,
    /// Simulated time, seconds
    #[arg(long, value_name = "SECONDS", help_heading = "Scene")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub duration: Option<f64>,
}

impl SceneSource {
    /// Reads the value of the field of that name from a file. Whether there is one.
    pub(super) fn read<'de, A: MapAccess<'de>>(
        &mut self,
        name: &str,
        map: &mut A,
    ) -> std::result::Result<bool, A::Error> {
        match name {
            "scene" => self.scene = map.next_value()?,
            "initial" => self.initial = map.next_value()?,
            "initial-step" => self.initial_step = map.next_value()?,
            "grains" => self.grains = map.next_value()?,
            "box-width" => self.box_width = map.next_value()?,
            "base-width" => self.base_width = map.next_value()?,
            "seed" => self.seed = map.next_value()?,
            "deposition" => self.deposition = map.next_value()?,
            "start" => self.start = map.next_value()?,
            "preset" => self.preset = map.next_value()?,
            "duration" => self.duration = map.next_value()?,
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// The pile that `grains`, `box_width`, `seed` and `deposition` ask for.
    pub fn new_pile(&self) -> NewPile {
        let default = NewPile::default();
        NewPile {
            grains: self.grains.unwrap_or(default.grains),
            box_width_in_diameters: self.box_width.unwrap_or(default.box_width_in_diameters),
            seed: self.seed.unwrap_or(default.seed),
            deposition: self.deposition.unwrap_or(default.deposition),
        }
    }

    /// Asks for this pile.
    pub fn set_new_pile(&mut self, pile: &NewPile) {
        let NewPile { grains, box_width_in_diameters, seed, deposition } = *pile;
        (self.grains, self.box_width) = (Some(grains), Some(box_width_in_diameters));
        (self.seed, self.deposition) = (Some(seed), Some(deposition));
    }

    /// True if grains have to be put in place and settled.
    pub fn makes_new_pile(&self) -> bool {
        self.grains.is_some()
            || self.box_width.is_some()
            || self.seed.is_some()
            || self.deposition.is_some()
    }
}

/// A scene before anything of it is changed.
#[derive(Clone, Debug)]
pub struct BaseScene {
    scene: Scene,
    /// What its grains are the start of, where they have to settle.
    new_pile: Option<NewPile>,
}

impl BaseScene {
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
        let source = SceneSource { scene: Some(name.into()), ..SceneSource::default() };
        Self { source, ..Self::default() }
    }

    /// True if nothing is asked for.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// The names of settings that are given and that a stepper does not read. A remedy that it does not take is refused.
    pub fn unread_by(&self, stepper: Stepper) -> Vec<String> {
        let (source, remedies) = (SceneSource::default(), RemedyChanges::default());
        let given = Self { source, stepper: None, remedies, ..self.clone() };
        // Plain data by names: there is nothing that JSON cannot say.
        let given = serde_json::to_value(&given).unwrap_or_default();
        let names = given.as_object().into_iter().flat_map(|given| given.keys());
        names.filter(|name| !stepper.reads(name)).cloned().collect()
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
            *stepper = Settable::of(value);
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
        self.change(&self.base_scene()?)
    }

    /// The scene with the changes made, checked. A new pile is made here, which takes a while:
    /// `progress` is told, and can end it by returning false.
    ///
    /// # Errors
    /// Names the first field that is unknown or outside its range, or the file that cannot be read; and
    /// where the grains do not come to rest.
    pub fn scene(&self, progress: impl FnMut(Settling) -> bool) -> Result<Scene> {
        self.scene_on(self.base_scene()?, progress)
    }

    /// The same of a scene that is at hand, whatever scene is named.
    ///
    /// # Errors
    /// As [`Config::scene`].
    pub fn scene_on(
        &self,
        base: BaseScene,
        progress: impl FnMut(Settling) -> bool,
    ) -> Result<Scene> {
        let scene = self.change(&base)?;
        match self.new_pile_on(&base) {
            None => Ok(scene),
            Some(pile) => self.settled_on(base, settle(&pile, progress)?),
        }
    }

    /// The scene whose settled grains are at hand.
    ///
    /// # Errors
    /// As [`Config::without_settling`].
    pub fn scene_from(&self, settled: Vec<Grain>) -> Result<Scene> {
        self.settled_on(self.base_scene()?, settled)
    }

    /// The scene that starts from these discs, as if `initial` were a file of them.
    ///
    /// # Errors
    /// As [`Config::without_settling`].
    pub fn scene_of_discs(&self, discs: RecordedGrains) -> Result<Scene> {
        self.check_source()?;
        let scene = self.pile_of_recorded("initial".as_ref(), discs)?;
        self.change(&BaseScene { scene, new_pile: None })
    }

    /// The pile that has to be made for this scene, if any.
    ///
    /// # Errors
    /// As [`Config::without_settling`].
    pub fn new_pile(&self) -> Result<Option<NewPile>> {
        if self.source.makes_new_pile() {
            return Ok(Some(self.source.new_pile()));
        }
        Ok(self.base_scene()?.new_pile)
    }

    /// The scene as its file or its name says it.
    ///
    /// # Errors
    /// As [`Config::without_settling`].
    pub fn base_scene(&self) -> Result<BaseScene> {
        self.check_source()?;
        let SceneSource { initial, initial_step, start, .. } = &self.source;
        let name = self.named();
        let initial = initial.as_ref().map(|path| self.folder.join(path));
        let (scene, new_pile) =
            if let Some(path) = initial.as_deref().filter(|path| SavedState::is_in(path)) {
                (self.scene_of_state(path)?, None)
            } else if let Some(path) = &initial {
                self.check_pile_alone("initial grains")?;
                let pile = built_in(Self::DEFAULT_SCENE)?;
                check_starts_pile(path, &pile, self.source.scene.is_some())?;
                (self.pile_of_recorded(path, read_grains(path, *initial_step)?)?, None)
            } else if name.ends_with(".toml") {
                read_unsettled(&self.folder.join(name))?
            } else if let (Self::CRADLE, Some(start)) = (name, *start) {
                (cradle_from(start), None)
            } else {
                (built_in(name)?, None)
            };
        Ok(BaseScene { scene, new_pile })
    }

    /// What of a config its [`Config::base_scene`] hangs on: equal for all that share one.
    pub fn base_scene_key(&self) -> String {
        let SceneSource { scene, initial, initial_step, box_width, start, .. } = &self.source;
        let box_width = box_width.filter(|_| initial.is_some());
        let is_named = scene.is_some();
        format!("{:?}", (self.named(), is_named, initial, initial_step, box_width, start))
    }

    /// The scene of [`Config::without_settling`] where its base scene is at hand.
    ///
    /// # Errors
    /// As there.
    pub fn change(&self, base: &BaseScene) -> Result<Scene> {
        self.check_source()?;
        let mut scene = base.scene.clone();
        self.change_scene(&mut scene)?;
        Ok(scene)
    }

    /// The scene's own name, however it was asked for; a file's name as it is.
    pub fn named(&self) -> &str {
        let asked = self.source.scene.as_deref().unwrap_or(Self::DEFAULT_SCENE);
        SceneInfo::named(asked).map_or(asked, |info| info.name)
    }

    /// Fails where what is said of the scene's source does not go together.
    fn check_source(&self) -> Result<()> {
        let name = self.named();
        if let (None, Some(step)) = (&self.source.initial, self.source.initial_step) {
            let allowed = "left out where no initial grains are given";
            return Err(Error::value("initial-step", step, allowed));
        }
        if self.source.makes_new_pile() {
            self.check_pile_alone("grains, box-width, seed or deposition")?;
            self.source.new_pile().validate()?;
        }
        match self.source.start {
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
        let way_out = match self.source.initial {
            Some(_) => "; a saved run (--save) starts with the scene that it was saved in",
            None => "",
        };
        match self.named() {
            Self::DEFAULT_SCENE => Ok(()),
            name => {
                Err(Error::value("scene", name, format!("pile where {fields} are given{way_out}")))
            }
        }
    }

    fn pile_of_recorded(&self, path: &Path, discs: RecordedGrains) -> Result<Scene> {
        let width = self.source.new_pile().box_width_in_diameters;
        let mut pile = pile_of(discs.grains.clone(), width)?;
        discs.check_masses(path, pile.areal_density)?;
        let RecordedGrains { fixed_discs, .. } = discs;
        if !fixed_discs.is_empty() {
            // The base that the grains lie on, as wide as it was.
            pile.fixed_discs = fixed_discs;
        }
        Ok(pile)
    }

    fn new_pile_on(&self, base: &BaseScene) -> Option<NewPile> {
        let new_pile = self.source.makes_new_pile();
        if new_pile { Some(self.source.new_pile()) } else { base.new_pile.clone() }
    }

    fn settled_on(&self, base: BaseScene, settled: Vec<Grain>) -> Result<Scene> {
        let mut scene = if self.source.makes_new_pile() {
            pile_of(settled, self.source.new_pile().box_width_in_diameters)?
        } else {
            base.scene.with_settled(settled)
        };
        self.change_scene(&mut scene)?;
        Ok(scene)
    }

    /// The same asked for, with every number that `scene` fills in.
    pub fn resolved(&self, scene: &Scene) -> Self {
        // An initial state may have a scene of its own.
        let name = if self.source.initial.is_some() { &scene.name } else { self.named() };
        let source = SceneSource {
            scene: Some(name.into()),
            duration: Some(scene.duration_secs),
            ..self.source.clone()
        };
        Self { source, ..self.clone() }.with_settings(&scene.settings())
    }

    /// Changes what is given of settings. A preset, which is no setting, is left out.
    pub fn change_settings(&self, settings: &mut Settings) {
        settings.stepper = self.stepper.unwrap_or(settings.stepper);
        self.parameters.apply(&mut settings.parameters);
        self.solver.apply(&mut settings.solver);
        self.remedies.apply(&mut settings.remedies);
    }

    fn change_scene(&self, scene: &mut Scene) -> Result<()> {
        if let Some(width) = self.source.base_width {
            put_on_base(scene, width)?;
        }
        scene.stepper = self.stepper.unwrap_or(scene.stepper);
        // A preset leaves out what the stepper does not take.
        if let Some(preset) = self.source.preset {
            preset.apply(scene);
        }
        let mut settings = scene.settings();
        self.change_settings(&mut settings);
        scene.set_settings(settings);
        scene.duration_secs = self.source.duration.unwrap_or(scene.duration_secs);
        scene.validate()
    }

    /// The scene of a saved state, which begins with the state's grains.
    fn scene_of_state(&self, path: &Path) -> Result<Scene> {
        if let Some(step) = self.source.initial_step {
            let allowed =
                "left out where the initial state is a saved run, which has one step alone";
            return Err(Error::value("initial-step", step, allowed));
        }
        let scene = SavedState::open(path)?.as_start();
        match &self.source.scene {
            // A file's scene may be called as a challenge is.
            Some(name) if *name != scene.name && self.named() != scene.name => {
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
        let kept = SceneSource { duration: self.source.duration, ..SceneSource::default() };
        if self.source != kept {
            let allowed = "left out where scene, initial, initial-step, grains, box-width, base-width, \
                           seed, deposition, start or preset is given: a run that goes on has its own";
            return Err(Error::value("restart", "given", allowed));
        }
        let mut scene = state.scene.clone();
        self.change_scene(&mut scene)?;
        if scene.settings() != *state.simulation.settings() {
            state.simulation.forget_alarms();
        }
        state.simulation.change(scene.settings())?;
        state.scene = scene;
        Ok(())
    }
}
