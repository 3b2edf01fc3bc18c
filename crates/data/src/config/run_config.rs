//! Defines the configuration of a run: the source of the scene, and changes to the scene. The same structure is used
//! for the options of the command line, for one run of a study (a list of runs), and for the configuration that is
//! stored with results.

use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::MapAccess;

use super::SavedState;
use super::option_words::parser_of;
use super::recorded_scene::check_starts_pile;
use super::scene_file::{read_unsettled, unsettled};
use crate::data::{RecordedGrains, read_grains};
use crate::error::{self, Error, Result};
use crate::scene::{
    Deposition, NewPile, Preset, Scene, SceneInfo, Settling, Sizes, built_in, cradle_from, pile_of,
    put_on_base, settle,
};
use crate::setting::{Changes, Settable, Value};
use crate::sim::{RemedyChanges, Settings, Stepper};
use crate::solver::SolverChanges;
use crate::world::{Grain, ParameterChanges};

/// Configuration of a run: a scene and changes to it. Values that are not given are those of the scene. Wrong values
/// are possible here: they are found when the scene is made ([`Config::scene`]).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Config {
    /// Source of the scene: its name or file, and the options of a new pile.
    pub source: SceneSource,
    /// Stepper, the rule that advances the simulation by one time step Δt; `None` for the scene's own stepper.
    pub stepper: Option<Stepper>,
    /// Changes to the parameters of the contact laws and to the time step Δt.
    pub parameters: ParameterChanges,
    /// Changes to the settings of the solver.
    pub solver: SolverChanges,
    /// Changes to the remedies, which are optional corrections for known failures of a stepper, such as overlap.
    pub remedies: RemedyChanges,
    /// Folder to which relative paths in the configuration refer; empty for the working directory. It is not stored
    /// with the configuration, because a study (a list of runs) defines the same runs in any folder.
    pub folder: PathBuf,
}

/// Source of a scene: the configuration of a run apart from its settings.
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
    /// Width of the rough base under a pile, in mean diameters [default: box width plus 5 pile heights on either side]
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
    /// Initial distance of the moving ball of the cradle from the ball that it hits, between centres, in diameters
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
    /// Reads the value of the option `name` from serialised data (`map`) into the field of this option. Returns false
    /// if no option has this name.
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

    /// Returns the new pile that `grains`, `box_width`, `seed`, `deposition` and `sizes` describe. Options that are not
    /// given have their defaults.
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

    /// Sets `grains`, `box_width`, `seed`, `deposition` and `sizes` to the values of `pile`.
    pub fn set_new_pile(&mut self, pile: &NewPile) {
        let NewPile { grains, box_width_in_diameters, seed, deposition, sizes } = pile.clone();
        (self.grains, self.box_width) = (Some(grains), Some(box_width_in_diameters));
        (self.seed, self.deposition) = (Some(seed), Some(deposition));
        self.sizes = (sizes != Sizes::default()).then_some(sizes);
    }

    /// True if one of the options describes a new pile, whose grains must settle before the run.
    pub fn makes_new_pile(&self) -> bool {
        self.grains.is_some()
            || self.box_width.is_some()
            || self.seed.is_some()
            || self.deposition.is_some()
            || self.sizes.is_some()
    }
}

/// A scene to which the changes of a [`Config`] have not been applied yet.
#[derive(Clone, Debug)]
pub struct BaseScene {
    scene: Scene,
    /// Description of the new pile, if the scene has the grains of a new pile that has not settled yet.
    new_pile: Option<NewPile>,
}

impl BaseScene {
    /// Creates a base scene from an existing scene. If the scene names a file of discs, the file is read; relative
    /// paths refer to `folder`.
    ///
    /// # Errors
    /// The error names the first field that is outside its range, or the file that cannot be read.
    pub fn of(scene: Scene, folder: &Path) -> Result<Self> {
        let (scene, new_pile) = unsettled(scene, folder)?;
        Ok(Self { scene, new_pile })
    }
}

impl Config {
    /// Name of the scene for a configuration that names no scene.
    pub const DEFAULT_SCENE: &str = "pile";
    /// Name of Newton's cradle, the only scene with the option `start`: the initial distance of the moving ball from
    /// the ball that it hits.
    const CRADLE: &str = "cradle";

    /// Creates a configuration for a scene, given by its name or file, without changes.
    pub fn of_scene(name: impl Into<String>) -> Self {
        let source = SceneSource { scene: Some(name.into()), ..SceneSource::default() };
        Self { source, ..Self::default() }
    }

    /// True if the configuration is empty: it neither names a scene nor changes anything.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Returns the names of the settings that the configuration gives but the stepper does not use. Remedies (optional
    /// corrections of a stepper) are not listed, because giving a remedy that the stepper lacks is an error.
    pub fn unread_by(&self, stepper: Stepper) -> Vec<String> {
        let (source, remedies) = (SceneSource::default(), RemedyChanges::default());
        let given = Self { source, stepper: None, remedies, ..self.clone() };
        // A configuration has only named values, which can always be written as JSON.
        let given = serde_json::to_value(&given).unwrap_or_default();
        let names = given.as_object().into_iter().flat_map(|given| given.keys());
        names.filter(|name| !stepper.reads(name)).cloned().collect()
    }

    /// Returns this configuration with every setting given explicitly, with its value in `settings`.
    pub fn with_settings(self, settings: &Settings) -> Self {
        Self {
            stepper: Some(settings.stepper),
            parameters: Changes::all_of(&settings.parameters),
            solver: Changes::all_of(&settings.solver),
            remedies: Changes::all_of(&settings.remedies),
            ..self
        }
    }

    /// Sets the setting `name`. Returns false if no setting has this name or the value has the wrong type.
    pub fn set(&mut self, name: &str, value: Value) -> bool {
        let Self { stepper, parameters, solver, remedies, .. } = self;
        if name == Settings::STEPPER.name {
            *stepper = Settable::of(value);
            return stepper.is_some();
        }
        parameters.set(name, value) || solver.set(name, value) || remedies.set(name, value)
    }

    /// Makes the scene that this configuration names, applies the configuration's changes to it, and checks the result,
    /// but does not simulate how the grains of a new pile come to rest. If a scene file describes the new pile, its
    /// grains are at the positions from which they would fall. If options of the configuration describe the new pile
    /// (such as its number of grains), the scene has instead the grains of the pile that is shipped with Slump. This
    /// takes little time, so that a wrong value is reported before long work begins.
    ///
    /// # Errors
    /// The error names the first field that is unknown or outside its range, or the file that cannot be read.
    pub fn without_settling(&self) -> Result<Scene> {
        self.change(&self.base_scene()?)
    }

    /// Makes the scene that this configuration names, applies the configuration's changes to it, and checks the result.
    /// If the grains of a new pile must settle, this takes a while: `progress` is called repeatedly and stops the work
    /// by returning false.
    ///
    /// # Errors
    /// The error names the first field that is unknown or outside its range, or the file that cannot be read. Making
    /// the scene also fails if the grains do not come to rest.
    pub fn scene(&self, progress: impl FnMut(Settling) -> bool) -> Result<Scene> {
        self.scene_on(self.base_scene()?, progress)
    }

    /// Applies the changes of this configuration to the scene `base`, which is used instead of the scene that the
    /// configuration names, and checks the result. If the grains of a new pile must settle, this takes a while:
    /// `progress` is called repeatedly and stops the work by returning false.
    ///
    /// # Errors
    /// The error names the first field that is unknown or outside its range. Also fails if the grains do not come to
    /// rest.
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

    /// Makes the scene that this configuration names, applies the configuration's changes to it, and checks the result.
    /// The grains of the scene are `settled`: the grains of the new pile that the configuration describes, after they
    /// have come to rest.
    ///
    /// # Errors
    /// The error names the first field that is unknown or outside its range, or the file that cannot be read.
    pub fn scene_from(&self, settled: Vec<Grain>) -> Result<Scene> {
        self.settled_on(self.base_scene()?, settled)
    }

    /// Makes a pile from `discs`, applies this configuration's changes to it, and checks the result. The result is the
    /// same as if the option `initial` named a file with these discs.
    ///
    /// # Errors
    /// The error names the first field that is unknown or outside its range, or the file that cannot be read.
    pub fn scene_of_discs(&self, discs: RecordedGrains) -> Result<Scene> {
        self.check_source()?;
        let scene = self.pile_of_recorded("initial".as_ref(), discs)?;
        self.change(&BaseScene { scene, new_pile: None })
    }

    /// Returns the description of the new pile whose grains must settle before this run, if there is a new pile.
    ///
    /// # Errors
    /// The error names the first field that is unknown or outside its range, or the file that cannot be read.
    pub fn new_pile(&self) -> Result<Option<NewPile>> {
        if self.source.makes_new_pile() {
            return Ok(Some(self.source.new_pile()));
        }
        Ok(self.base_scene()?.new_pile)
    }

    /// Makes the scene that the configuration names, or the scene that starts from the grains in its option `initial`,
    /// without any of the other changes.
    ///
    /// # Errors
    /// The error names the first field that is unknown or outside its range, or the file that cannot be read.
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

    /// Returns a key by which scenes can be reused: configurations with the same key have the same
    /// [`Config::base_scene`].
    pub fn base_scene_key(&self) -> String {
        let SceneSource { scene, initial, initial_step, box_width, start, .. } = &self.source;
        let box_width = box_width.filter(|_| initial.is_some());
        let is_named = scene.is_some();
        format!("{:?}", (self.named(), is_named, initial, initial_step, box_width, start))
    }

    /// Applies all changes of this configuration to the scene `base` and checks the result, but does not let the grains
    /// of a new pile settle.
    ///
    /// # Errors
    /// The error names the first field that is unknown or outside its range, or the file that cannot be read.
    pub fn change(&self, base: &BaseScene) -> Result<Scene> {
        self.check_source()?;
        let mut scene = base.scene.clone();
        self.change_scene(&mut scene)?;
        Ok(scene)
    }

    /// Returns the canonical name of the built-in scene that the configuration names, perhaps by an alias or in other
    /// capitals. For a scene file, returns the name of the file as given.
    pub fn named(&self) -> &str {
        let asked = self.source.scene.as_deref().unwrap_or(Self::DEFAULT_SCENE);
        SceneInfo::named(asked).map_or(asked, |info| info.name)
    }

    /// Fails if the options for the source of the scene contradict each other or are outside their ranges.
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
            // The pile has the rough base of the recording, including its width.
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

    /// Returns this configuration with every missing value filled in from `scene`.
    pub fn resolved(&self, scene: &Scene) -> Self {
        // An initial state that is a saved run contains its own scene.
        let name = if self.source.initial.is_some() { &scene.name } else { self.named() };
        let source = SceneSource {
            scene: Some(name.into()),
            duration: Some(scene.duration_secs),
            ..self.source.clone()
        };
        Self { source, ..self.clone() }.with_settings(&scene.settings())
    }

    /// Changes `settings` to the values that the configuration gives. Its preset (a group of settings) is not applied.
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
        // The stepper is set first, because a preset skips settings that the stepper does not have.
        if let Some(preset) = self.source.preset {
            preset.apply(scene);
        }
        let mut settings = scene.settings();
        self.change_settings(&mut settings);
        scene.set_settings(settings);
        scene.duration_secs = self.source.duration.unwrap_or(scene.duration_secs);
        scene.validate()
    }

    /// Makes a scene from the file of a saved run. The scene starts from the grains as they were when the run was
    /// saved.
    fn scene_of_state(&self, path: &Path) -> Result<Scene> {
        if let Some(step) = self.source.initial_step {
            let allowed =
                "left out where the initial state is a saved run, which has one step alone";
            return Err(Error::value("initial-step", step, allowed));
        }
        let scene = SavedState::open(path)?.as_start();
        match &self.source.scene {
            // Both names are compared, because a saved scene may have the name of a challenge (a task in the window),
            // and [`Config::named`] replaces that name by the name of the challenge's scene.
            Some(name) if *name != scene.name && self.named() != scene.name => {
                let allowed =
                    format!("left out, or {}, the scene of the initial state", scene.name);
                Err(Error::value("scene", name, allowed))
            }
            _ => Ok(scene),
        }
    }

    /// Applies the changes of this configuration to a resumed run. They take effect from its next step on.
    ///
    /// # Errors
    /// The error names the first setting that is outside its range or contradicts the other settings, or says that
    /// options for another scene or initial state are not allowed.
    pub fn change_state(&self, state: &mut SavedState) -> Result<()> {
        let kept = SceneSource { duration: self.source.duration, ..SceneSource::default() };
        let allowed = "left out where scene, initial, initial-step, grains, box-width, base-width, \
                       seed, deposition, sizes, start or preset is given: a continued run has its own";
        error::check(self.source == kept, "restart", "given", allowed)?;
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
