//! Provides the initial states of an error budget, which the unchanged and the changed scenes share, and runs scenes
//! from these states.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

use super::causes::Variant;
use super::quantity::{BudgetQuantity, QuantityWatch, Window};
use crate::config::{BaseScene, Config};
use crate::error::{Error, Result};
use crate::number;
use crate::output::check_writable;
use crate::scene::{NewPile, Scene};
use crate::sim::{RunEnding, Settings, Tally};
use crate::states::settled_pile;

/// Largest displacement of a grain along an axis, in mean diameters, with which another initial state of the same scene
/// is made. In a chaotic scene, runs from such initial states move apart.
const MOVED_IN_DIAMETERS: f64 = 1e-9;

/// Results of a run of an error budget.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct RunValues {
    /// Values of the examined quantities, in the order in which the user lists them; `None` if the run has no finite
    /// value of a quantity.
    pub values: Vec<Option<f64>>,
    /// Reason why the values are invalid, in words: positions or velocities became NaN or infinite, or grains left the
    /// scene. `None` if the values are valid.
    pub failure: Option<String>,
    /// Fraction of the steps of the run that were not solved to their tolerance.
    #[serde(with = "number")]
    pub unsolved: f64,
    /// Computing time of the run, without the time to make its initial state, s.
    #[serde(with = "number")]
    pub run_secs: f64,
}

/// The initial states of an error budget: piles with different seeds if the scene generates its grains, otherwise the
/// scene itself and copies of the scene whose grains are displaced by at most 1e-9 diameters.
pub(crate) struct Starts {
    config: Config,
    base: BaseScene,
    /// The scene that the user described, without changes.
    pub scene: Scene,
    pub pile: Option<NewPile>,
    states: PathBuf,
}

impl Starts {
    /// Returns the initial states of the scene that the user describes in `config`. Initial states of piles are stored
    /// in the folder `states`.
    pub(crate) fn of(config: &Config, states: &Path) -> Result<Self> {
        let base = config.base_scene()?;
        let scene = config.change(&base)?;
        let pile = config.new_pile()?;
        let mut starts =
            Self { config: config.clone(), base, scene, pile, states: states.to_owned() };
        if starts.is_default_scene() && config.source.initial.is_none() {
            starts.pile.get_or_insert_default();
        }
        if starts.pile.is_some() {
            check_writable("out", states)?;
        }
        Ok(starts)
    }

    /// True if the scene is a pile that can also be made with another number of grains.
    pub(super) fn resizes(&self) -> bool {
        self.pile.is_some() && self.is_default_scene()
    }

    fn is_default_scene(&self) -> bool {
        self.config.named() == Config::DEFAULT_SCENE
    }

    /// Returns the seed with which the pile of initial state number `start` is made; `None` if initial states differ by
    /// displaced grains and not by a seed. The seed of the pile that is shipped with the program is never used, because
    /// that pile was chosen for illustration and is not a random sample.
    fn seed(&self, start: u64) -> Option<u64> {
        let chosen = NewPile::default().seed;
        self.pile.as_ref().map(|_| if start < chosen { start } else { start + 1 })
    }

    /// Returns the scene with initial state number `start`, counted from 1, and with the changed settings and the
    /// changed pile of a variant, if any.
    pub(crate) fn scene(&self, start: u64, variant: Option<&Variant>) -> Result<Scene> {
        let settings = variant.map_or_else(|| self.scene.settings(), |variant| variant.settings);
        let pile = variant.and_then(|variant| variant.pile.as_ref()).or(self.pile.as_ref());
        let mut scene = match (pile, self.seed(start)) {
            (Some(pile), Some(seed)) => {
                let pile = NewPile { seed, ..pile.clone() };
                let grains = settled_pile(&self.states, &pile, |_| true)?;
                let mut config = self.config.clone();
                if self.is_default_scene() {
                    config.source.set_new_pile(&pile);
                }
                config.scene_from(grains)?
            }
            _ => self.moved(start),
        };
        scene.set_settings(settings);
        scene.data = None;
        Ok(scene)
    }

    /// Returns the user's scene without changes, with its own initial state.
    pub(super) fn itself(&self) -> Result<Scene> {
        self.config.scene_on(self.base.clone(), |_| true)
    }

    /// Returns the key of a run: a hash of everything that affects the result of the run. `start` is the number of the
    /// initial state; `None` for the user's scene with its own initial state.
    pub(crate) fn key(
        &self,
        start: Option<u64>,
        variant: Option<&Variant>,
        quantities: &[BudgetQuantity],
        window: Window,
    ) -> Result<String> {
        let names: Vec<&str> = quantities.iter().map(|quantity| &*quantity.name).collect();
        let settings = variant.map_or_else(|| self.scene.settings(), |variant| variant.settings);
        let pile = variant.and_then(|variant| variant.pile.as_ref()).or(self.pile.as_ref());
        let source = &self.config.source;
        let made_of = (env!("CARGO_PKG_VERSION"), &self.scene, source, start, settings, pile);
        let said = serde_json::to_vec(&(made_of, names, [window.from_secs, window.to_secs]))
            .map_err(|error| Error::value("scene", &self.scene.name, error.to_string()))?;
        Ok(blake3::hash(&said).to_hex()[..32].to_owned())
    }

    fn moved(&self, start: u64) -> Scene {
        let mut scene = self.scene.clone();
        if start > 1 {
            let mut random = Pcg64::seed_from_u64(start);
            let reach = MOVED_IN_DIAMETERS * scene.mean_diameter;
            for grain in &mut scene.grains {
                grain.position.x += random.random_range(-reach..reach);
                let along_y = random.random_range(-reach..reach);
                if scene.physics.axes == 2 {
                    grain.position.y += along_y;
                }
            }
        }
        scene
    }
}

/// Runs a scene from time 0 to the end of `window`, an interval of simulated time, and returns the values of the
/// quantities in this interval.
pub(crate) fn run(
    scene: &Scene,
    quantities: &[BudgetQuantity],
    window: Window,
) -> Result<RunValues> {
    let begun = Instant::now();
    let mut simulation = scene.simulation()?;
    let mut watch = QuantityWatch::new(quantities, window, &simulation);
    let mut tally = Tally::default();
    let steps = watch.steps();
    let ended = simulation.run(steps, |simulation| {
        tally.add(simulation.observables());
        watch.add(simulation);
        Ok(ControlFlow::Continue(()))
    })?;
    let lost = simulation.observables().lost_grains;
    let failure = match ended {
        RunEnding::NotFinite(_) => Some("its state was no longer finite".to_owned()),
        _ if lost > 0 => Some(format!("{lost} grains were lost")),
        _ => None,
    };
    let unsolved = tally.unconverged_steps as f64 / tally.steps.max(1) as f64;
    let finite = |value: f64| Some(value).filter(|value| value.is_finite());
    let values = watch.values().into_iter().map(finite).collect();
    Ok(RunValues { values, failure, unsolved, run_secs: begun.elapsed().as_secs_f64() })
}

/// Returns a short description of the stepper, the Bond number, the time step, the restitution and the friction.
pub(super) fn said_of(settings: &Settings) -> String {
    let parameters = &settings.parameters;
    format!(
        "{}, Bond {}, Δt {} s, ρ {}, μ {}",
        settings.stepper,
        parameters.bond,
        super::causes::short(parameters.time_step_secs),
        parameters.restitution,
        parameters.friction
    )
}
