//! What a user asks of a run: a scene and changes to it. The same structure is the command line's
//! options, and what is written beside results.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::{
    Preset, Rain, Scene, Settling, built_in, cradle_from, pile_of, read_discs, read_scene, settle,
};
use crate::error::{Error, Result};
use crate::solver::{Method, Ordering, StopTest};
use crate::world::{ContactLaw, FrictionCone, Grain, Parameters};

/// A scene and changes to it. What is left out stays as the scene says.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, clap::Args)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct Config {
    /// Built-in scene (pile, cradle, collision, …: `slump list`) or a scene file (NAME.toml)
    #[arg(long, value_name = "NAME|FILE", help_heading = "Scene")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scene: Option<String>,
    /// Start the pile from a CSV of discs (header x,y,radius, optionally vx,vy,omega; metres)
    #[arg(long, value_name = "FILE", help_heading = "Scene", conflicts_with_all = ["grains", "box_width", "seed"])]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub initial: Option<PathBuf>,
    /// Rain a new pile of this many grains
    #[arg(long, value_name = "N", help_heading = "Scene")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub grains: Option<usize>,
    /// Width of the box that a new pile is rained into, in mean diameters
    #[arg(long, value_name = "D", help_heading = "Scene", allow_negative_numbers = true)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub box_width: Option<f64>,
    /// Seed of a new pile
    #[arg(long, value_name = "N", help_heading = "Scene")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
    /// Where the cradle's k starts, in diameters left of i, centre to centre
    #[arg(long, value_name = "D", help_heading = "Scene", allow_negative_numbers = true)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start: Option<f64>,
    /// Settings that go together; what else is given changes them
    #[arg(long, value_name = "NAME", help_heading = "Scene")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub preset: Option<Preset>,
    /// Bond number: cohesion force over effective weight, at least 0
    #[arg(long, value_name = "BOND", help_heading = "Physics", allow_negative_numbers = true)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bond: Option<f64>,
    /// Time step, seconds
    #[arg(long, value_name = "SECONDS", help_heading = "Physics", allow_negative_numbers = true)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dt: Option<f64>,
    /// Restitution, 0 to 1
    #[arg(long, value_name = "RHO", help_heading = "Physics", allow_negative_numbers = true)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rho: Option<f64>,
    /// Friction, at least 0
    #[arg(long, value_name = "MU", help_heading = "Physics", allow_negative_numbers = true)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mu: Option<f64>,
    /// Which part of the normal force bounds friction
    #[arg(long, value_name = "CONE", help_heading = "Physics")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cone: Option<FrictionCone>,
    /// Contacts slower than this many g·dt do not bounce; 0 in the paper's scheme, 2 lets nearly every step be solved
    #[arg(long, value_name = "X", help_heading = "Physics", allow_negative_numbers = true)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub restitution_threshold: Option<f64>,
    /// How long a bond lives: moreau is the paper's, while the gap is negative; range, until it has been stretched by the debonding distance
    #[arg(long, value_name = "LAW", help_heading = "Physics")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub law: Option<ContactLaw>,
    /// Debonding distance of the law range, in mean diameters
    #[arg(long, value_name = "D", help_heading = "Physics", allow_negative_numbers = true)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub debonding_distance: Option<f64>,
    /// Simulated time, seconds
    #[arg(long, value_name = "SECONDS", help_heading = "Physics", allow_negative_numbers = true)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub duration: Option<f64>,
    /// Method that solves each step
    #[arg(long, value_name = "NAME", help_heading = "Solver")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub solver: Option<Method>,
    /// In which order a sweep visits the contacts
    #[arg(long, value_name = "ORDER", help_heading = "Solver")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ordering: Option<Ordering>,
    /// What the tolerance refers to
    #[arg(long, value_name = "TEST", help_heading = "Solver")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stop: Option<StopTest>,
    /// How well each step is solved, in the unit of the stopping test
    #[arg(long, value_name = "X", help_heading = "Solver", allow_negative_numbers = true)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
    /// A step that needs more sweeps is reported as not converged
    #[arg(long, value_name = "N", help_heading = "Solver")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_sweeps: Option<u32>,
    /// Whether each step starts from the impulses of the one before
    #[arg(long, value_name = "BOOL", help_heading = "Solver")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub warm_start: Option<bool>,
    /// Substeps of a stepping scheme; 0 takes 4 for tgs-soft, and as many as keep dem stable
    #[arg(long, value_name = "N", help_heading = "Solver")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub substeps: Option<u32>,
    /// Push overlap out by moving grains apart after each step, without giving them speed
    #[arg(long, value_name = "BOOL", help_heading = "Solver")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub push_out: Option<bool>,
    /// Cut steps into pieces in which no grain moves further than this, in diameters; 0 never does
    #[arg(long, value_name = "D", help_heading = "Solver", allow_negative_numbers = true)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_travel: Option<f64>,
    /// Solve a step that did not converge once more without bounces, which may contradict each other
    #[arg(long, value_name = "BOOL", help_heading = "Solver")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub calm_unsolved: Option<bool>,
    /// Have shocks run through touching grains one after the other, as in Newton's cradle; not with cohesion
    #[arg(long, value_name = "BOOL", help_heading = "Solver")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sequential_impacts: Option<bool>,
    /// Let pairs that would close their gap within a step close it and no more, so that nothing tunnels; it costs bounces
    #[arg(long, value_name = "BOOL", help_heading = "Solver")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speculative: Option<bool>,
}

impl Config {
    /// The name of the scene that is used where none is given.
    pub const DEFAULT_SCENE: &str = "pile";

    /// Whether nothing is asked for.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// The scene with the changes made, checked, but for the grains of a new pile: those of the
    /// built-in one stand in for them. Quick, so that a wrong value is told of before long work.
    ///
    /// # Errors
    /// Names the first field that is unknown or outside its range, or the file that cannot be read.
    pub fn without_settling(&self) -> Result<Scene> {
        let name = self.scene.as_deref().unwrap_or(Self::DEFAULT_SCENE);
        let pile_alone = |fields: &str| match name {
            Self::DEFAULT_SCENE => Ok(()),
            _ => Err(Error::value("scene", name, format!("pile where {fields} are given"))),
        };
        let mut scene = if let Some(path) = &self.initial {
            pile_alone("initial grains")?;
            pile_of(read_discs(path)?, Rain::default().box_width_in_diameters)
        } else if name.ends_with(".toml") {
            read_scene(name.as_ref())?
        } else {
            built_in(name)?
        };
        if self.makes_new_pile() {
            pile_alone("grains, box-width or seed")?;
            self.rain().validate()?;
        }
        if let Some(start) = self.start {
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
        if !self.makes_new_pile() {
            return Ok(scene);
        }
        self.scene_from(settle(&self.rain(), progress)?)
    }

    /// The scene of a new pile whose settled grains are at hand.
    ///
    /// # Errors
    /// As [`Config::without_settling`].
    pub fn scene_from(&self, settled: Vec<Grain>) -> Result<Scene> {
        let mut pile = pile_of(settled, self.rain().box_width_in_diameters);
        self.change(&mut pile)?;
        Ok(pile)
    }

    /// The same asked for, with every number that `scene` fills in.
    pub fn resolved(&self, scene: &Scene) -> Self {
        let Parameters {
            bond,
            time_step_secs,
            restitution,
            friction,
            cone,
            restitution_threshold,
            law,
            debonding_distance,
        } = scene.parameters;
        Self {
            scene: Some(self.scene.clone().unwrap_or_else(|| Self::DEFAULT_SCENE.into())),
            bond: Some(bond),
            dt: Some(time_step_secs),
            rho: Some(restitution),
            mu: Some(friction),
            cone: Some(cone),
            restitution_threshold: Some(restitution_threshold),
            law: Some(law),
            debonding_distance: Some(debonding_distance),
            duration: Some(scene.duration_secs),
            solver: Some(scene.solver.method),
            ordering: Some(scene.solver.ordering),
            stop: Some(scene.solver.stop),
            tolerance: Some(scene.solver.tolerance),
            max_sweeps: Some(scene.solver.max_sweeps),
            warm_start: Some(scene.solver.warm_start),
            substeps: Some(scene.solver.substeps),
            push_out: Some(scene.solver.remedies.push_out),
            max_travel: Some(scene.solver.remedies.max_travel),
            calm_unsolved: Some(scene.solver.remedies.calm_unsolved),
            sequential_impacts: Some(scene.solver.remedies.sequential_impacts),
            speculative: Some(scene.solver.remedies.speculative),
            ..self.clone()
        }
    }

    /// The rain that `grains`, `box_width` and `seed` ask for.
    pub fn rain(&self) -> Rain {
        let default = Rain::default();
        Rain {
            grains: self.grains.unwrap_or(default.grains),
            box_width_in_diameters: self.box_width.unwrap_or(default.box_width_in_diameters),
            seed: self.seed.unwrap_or(default.seed),
        }
    }

    /// Whether grains have to be rained and settled.
    pub fn makes_new_pile(&self) -> bool {
        self.grains.is_some() || self.box_width.is_some() || self.seed.is_some()
    }

    fn change(&self, scene: &mut Scene) -> Result<()> {
        fn set<T: Copy>(place: &mut T, value: Option<T>) {
            if let Some(value) = value {
                *place = value;
            }
        }
        // A preset leaves out what the law does not take.
        set(&mut scene.parameters.law, self.law);
        if let Some(preset) = self.preset {
            preset.apply(scene);
        }
        set(&mut scene.parameters.bond, self.bond);
        set(&mut scene.parameters.time_step_secs, self.dt);
        set(&mut scene.parameters.restitution, self.rho);
        set(&mut scene.parameters.friction, self.mu);
        set(&mut scene.parameters.cone, self.cone);
        set(&mut scene.parameters.restitution_threshold, self.restitution_threshold);
        set(&mut scene.parameters.debonding_distance, self.debonding_distance);
        set(&mut scene.duration_secs, self.duration);
        set(&mut scene.solver.method, self.solver);
        set(&mut scene.solver.ordering, self.ordering);
        set(&mut scene.solver.stop, self.stop);
        set(&mut scene.solver.tolerance, self.tolerance);
        set(&mut scene.solver.max_sweeps, self.max_sweeps);
        set(&mut scene.solver.warm_start, self.warm_start);
        set(&mut scene.solver.substeps, self.substeps);
        set(&mut scene.solver.remedies.push_out, self.push_out);
        set(&mut scene.solver.remedies.max_travel, self.max_travel);
        set(&mut scene.solver.remedies.calm_unsolved, self.calm_unsolved);
        set(&mut scene.solver.remedies.sequential_impacts, self.sequential_impacts);
        set(&mut scene.solver.remedies.speculative, self.speculative);
        scene.validate()
    }
}
