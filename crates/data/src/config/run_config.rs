//! The request for a run: the source of the scene, and changes to it. The same structure describes the options of the
//! command line, a run of a study, and the record that is written with results.

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
    Deposition, NewPile, Preset, Scene, SceneInfo, Settling, Sizes, built_in, cradle_from, pile_of,
    put_on_base, settle,
};
use crate::setting::{Changes, Settable, Value};
use crate::sim::{RemedyChanges, Settings, Stepper};
use crate::solver::SolverChanges;
use crate::world::{Grain, ParameterChanges};

/// A scene and changes to it. Values that are not given are those of the scene. Plain data, checked when the scene is
/// made ([`Config::scene`]).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Config {
    /// The source of the scene.
    pub source: SceneSource,
    /// The stepper.
    pub stepper: Option<Stepper>,
    /// Parameters of the contact laws, and Δt.
    pub parameters: ParameterChanges,
    /// Settings of the solver.
    pub solver: SolverChanges,
    /// Remedies for known failures.
    pub remedies: RemedyChanges,
    /// The folder for relative paths; empty for the working directory. It is not a part of the request: a study asks
    /// for the same runs in any folder.
    pub folder: PathBuf,
}

/// Source of a scene: the request apart from its settings.
#[derive(Clone, Debug, Default, PartialEq, Serialize, clap::Args)]
#[serde(rename_all = "kebab-case")]
pub struct SceneSource {
    /// Built-in scene (pile, cradle, collision, …: `slump list`) or a scene file (NAME.toml)
    #[arg(long, value_name = "NAME|FILE", help_heading = "Scene")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scene: Option<String>,
    /// Start the pile from these discs: a CSV (header x,y,radius, optionally vx,vy,omega; metres), a recording (CSV or Parquet), or a saved run
    #[arg(long, value_name = "FILE", help_heading = "Scene", conflicts_with_all = ["grains", "box_width", "seed", "deposition", "sizes"])]
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
    /// Width of the box in which a new pile is made, in mean diameters
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
    /// Deposition: the way to place the grains of a new pile [default: rain]
    #[arg(long, value_name = "WAY", value_parser = parser_of::<Deposition>(), help_heading = "Scene")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub deposition: Option<Deposition>,
    /// Distribution of the diameters of a new pile, such as lognormal:0.2; `slump generate --help` describes all [default: uniform:0.2]
    #[arg(long, value_name = "SIZES", help_heading = "Scene")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sizes: Option<Sizes>,
    /// Start of the ball k of the cradle, in diameters to the left of i, between centres
    #[arg(long, value_name = "D", help_heading = "Scene")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start: Option<f64>,
    /// Preset: a group of settings; other options override it
    #[arg(long, value_name = "NAME", value_parser = parser_of::<Preset>(), help_heading = "Scene")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub preset: Option<Preset>,
    /// Simulated time, seconds
    #[arg(long, value_name = "SECONDS", help_heading = "Scene")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub duration: Option<f64>,
}

impl SceneSource {
    /// Reads the value of the field `name` from a file. Returns false if there is no such field.
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
            "sizes" => self.sizes = map.next_value()?,
            "start" => self.start = map.next_value()?,
            "preset" => self.preset = map.next_value()?,
            "duration" => self.duration = map.next_value()?,
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// The pile that `grains`, `box_width`, `seed`, `deposition` and `sizes` ask for.
    pub fn new_pile(&self) -> NewPile {
        let default = NewPile::default();
        NewPile {
            grains: self.grains.unwrap_or(default.grains),
            box_width_in_diameters: self.box_width.unwrap_or(default.box_width_in_diameters),
            seed: self.seed.unwrap_or(default.seed),
            deposition: self.deposition.unwrap_or(default.deposition),
            sizes: self.sizes.clone().unwrap_or(default.sizes),
        }
    }

    /// Sets the options to those of this pile.
    pub fn set_new_pile(&mut self, pile: &NewPile) {
        let NewPile { grains, box_width_in_diameters, seed, deposition, sizes } = pile.clone();
        (self.grains, self.box_width) = (Some(grains), Some(box_width_in_diameters));
        (self.seed, self.deposition) = (Some(seed), Some(deposition));
        self.sizes = (sizes != Sizes::default()).then_some(sizes);
    }

    /// True if a new pile is to be made, whose grains must settle.
    pub fn makes_new_pile(&self) -> bool {
        self.grains.is_some()
            || self.box_width.is_some()
            || self.seed.is_some()
            || self.deposition.is_some()
            || self.sizes.is_some()
    }
}

/// A scene before any changes.
#[derive(Clone, Debug)]
pub struct BaseScene {
    scene: Scene,
    /// The new pile, if the scene's grains are its unsettled grains.
    new_pile: Option<NewPile>,
}

impl BaseScene {
    /// Uses an existing scene. If the scene names a file of discs, the file is looked up in `folder`.
    ///
    /// # Errors
    /// Names the first field outside its range, or the file that cannot be read.
    pub fn of(scene: Scene, folder: &Path) -> Result<Self> {
        let (scene, new_pile) = unsettled(scene, folder)?;
        Ok(Self { scene, new_pile })
    }
}

impl Config {
    /// The name of the scene that is used if none is given.
    pub const DEFAULT_SCENE: &str = "pile";
    /// The only scene with a `start` option.
    const CRADLE: &str = "cradle";

    /// A scene by name or file, without changes.
    pub fn of_scene(name: impl Into<String>) -> Self {
        let source = SceneSource { scene: Some(name.into()), ..SceneSource::default() };
        Self { source, ..Self::default() }
    }

    /// True if nothing is requested.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// The names of given settings that a stepper does not read. A remedy that the stepper lacks is not listed: it is
    /// refused.
    pub fn unread_by(&self, stepper: Stepper) -> Vec<String> {
        let (source, remedies) = (SceneSource::default(), RemedyChanges::default());
        let given = Self { source, stepper: None, remedies, ..self.clone() };
        // Plain data with names can always be written as JSON.
        let given = serde_json::to_value(&given).unwrap_or_default();
        let names = given.as_object().into_iter().flat_map(|given| given.keys());
        names.filter(|name| !stepper.reads(name)).cloned().collect()
    }

    /// This request with all settings given.
    pub fn with_settings(self, settings: &Settings) -> Self {
        Self {
            stepper: Some(settings.stepper),
            parameters: Changes::all_of(&settings.parameters),
            solver: Changes::all_of(&settings.solver),
            remedies: Changes::all_of(&settings.remedies),
            ..self
        }
    }

    /// Sets the setting `name`. Returns false if there is no such setting or the value is of another kind.
    pub fn set(&mut self, name: &str, value: Value) -> bool {
        let Self { stepper, parameters, solver, remedies, .. } = self;
        if name == Settings::STEPPER.name {
            *stepper = Settable::of(value);
            return stepper.is_some();
        }
        parameters.set(name, value) || solver.set(name, value) || remedies.set(name, value)
    }

    /// Makes the scene with the changes and checks it, without settling a new pile: the scene has the built-in grains,
    /// or the grains in their first positions, instead. This takes little time, so that a wrong value is reported
    /// before long work begins.
    ///
    /// # Errors
    /// Names the first field that is unknown or outside its range, or the file that cannot be read.
    pub fn without_settling(&self) -> Result<Scene> {
        self.change(&self.base_scene()?)
    }

    /// Makes the scene with the changes and checks it. A new pile takes a while: `progress` is called repeatedly and
    /// stops the work by returning false.
    ///
    /// # Errors
    /// Names the first field that is unknown or outside its range, or the file that cannot be read. Also fails if the
    /// grains do not come to rest.
    pub fn scene(&self, progress: impl FnMut(Settling) -> bool) -> Result<Scene> {
        self.scene_on(self.base_scene()?, progress)
    }

    /// Like [`Config::scene`], but for the scene `base`, whatever scene the request names.
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

    /// The scene with a new pile whose settled grains are given.
    ///
    /// # Errors
    /// As [`Config::without_settling`].
    pub fn scene_from(&self, settled: Vec<Grain>) -> Result<Scene> {
        self.settled_on(self.base_scene()?, settled)
    }

    /// The scene with these discs as its initial state, as if `initial` were a file of them.
    ///
    /// # Errors
    /// As [`Config::without_settling`].
    pub fn scene_of_discs(&self, discs: RecordedGrains) -> Result<Scene> {
        self.check_source()?;
        let scene = self.pile_of_recorded("initial".as_ref(), discs)?;
        self.change(&BaseScene { scene, new_pile: None })
    }

    /// The new pile that must be made for this scene, if any.
    ///
    /// # Errors
    /// As [`Config::without_settling`].
    pub fn new_pile(&self) -> Result<Option<NewPile>> {
        if self.source.makes_new_pile() {
            return Ok(Some(self.source.new_pile()));
        }
        Ok(self.base_scene()?.new_pile)
    }

    /// The scene in its file or by its name, without changes.
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

    /// A key that is equal for all requests with the same [`Config::base_scene`].
    pub fn base_scene_key(&self) -> String {
        let SceneSource { scene, initial, initial_step, box_width, start, .. } = &self.source;
        let box_width = box_width.filter(|_| initial.is_some());
        let is_named = scene.is_some();
        format!("{:?}", (self.named(), is_named, initial, initial_step, box_width, start))
    }

    /// Like [`Config::without_settling`], for a base scene that was already made.
    ///
    /// # Errors
    /// As [`Config::without_settling`].
    pub fn change(&self, base: &BaseScene) -> Result<Scene> {
        self.check_source()?;
        let mut scene = base.scene.clone();
        self.change_scene(&mut scene)?;
        Ok(scene)
    }

    /// The canonical name of a built-in scene; for a file, its name as given.
    pub fn named(&self) -> &str {
        let asked = self.source.scene.as_deref().unwrap_or(Self::DEFAULT_SCENE);
        SceneInfo::named(asked).map_or(asked, |info| info.name)
    }

    /// Fails if the options for the scene's source contradict each other.
    fn check_source(&self) -> Result<()> {
        let name = self.named();
        if let (None, Some(step)) = (&self.source.initial, self.source.initial_step) {
            let allowed = "left out where no initial grains are given";
            return Err(Error::value("initial-step", step, allowed));
        }
        if self.source.makes_new_pile() {
            self.check_pile_alone("grains, box-width, seed, deposition or sizes")?;
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
        if !discs.fixed_discs.is_empty() {
            // The rough base of the recording, with its width.
            discs.place_fixed_discs(&mut pile, path)?;
        }
        Ok(pile.without_implied_masses())
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

    /// This request with every default filled in from `scene`.
    pub fn resolved(&self, scene: &Scene) -> Self {
        // An initial state may include its own scene.
        let name = if self.source.initial.is_some() { &scene.name } else { self.named() };
        let source = SceneSource {
            scene: Some(name.into()),
            duration: Some(scene.duration_secs),
            ..self.source.clone()
        };
        Self { source, ..self.clone() }.with_settings(&scene.settings())
    }

    /// Applies the given settings. A preset is not a setting and is not applied.
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
        // A preset skips the settings that the stepper does not have.
        if let Some(preset) = self.source.preset {
            preset.apply(scene);
        }
        let mut settings = scene.settings();
        self.change_settings(&mut settings);
        scene.set_settings(settings);
        scene.duration_secs = self.source.duration.unwrap_or(scene.duration_secs);
        scene.validate()
    }

    /// The scene of a saved state, with the state's grains as initial state.
    fn scene_of_state(&self, path: &Path) -> Result<Scene> {
        if let Some(step) = self.source.initial_step {
            let allowed =
                "left out where the initial state is a saved run, which has one step alone";
            return Err(Error::value("initial-step", step, allowed));
        }
        let scene = SavedState::open(path)?.as_start();
        match &self.source.scene {
            // The scene of a file may have the same name as a challenge.
            Some(name) if *name != scene.name && self.named() != scene.name => {
                let allowed =
                    format!("left out, or {}, the scene of the initial state", scene.name);
                Err(Error::value("scene", name, allowed))
            }
            _ => Ok(scene),
        }
    }

    /// Applies the requested changes to a resumed run, from now on.
    ///
    /// # Errors
    /// Names the first setting that is outside its range or contradicts the others, or says that the request asks for
    /// another initial state.
    pub fn change_state(&self, state: &mut SavedState) -> Result<()> {
        let kept = SceneSource { duration: self.source.duration, ..SceneSource::default() };
        if self.source != kept {
            let allowed = "left out where scene, initial, initial-step, grains, box-width, base-width, \
                           seed, deposition, sizes, start or preset is given: a continued run has its own";
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
