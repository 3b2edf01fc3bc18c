//! One run of a study: what it is made of, and the key that tells it from all others.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use serde::Serialize;

use crate::config::{BaseScene, Config};
use crate::error::{Error, Result};

/// One run of a study.
#[derive(Clone, Debug)]
pub struct PlannedRun {
    /// Names it: hash of all that its result hangs on.
    pub key: String,
    /// What it runs, every number filled in.
    pub config: Config,
    /// How long it may take, in any unit: for the order of work and for progress.
    pub cost: f64,
}

/// A base that has been read.
pub(super) struct Known {
    base: BaseScene,
    /// Hash of all its discs.
    discs: String,
}

impl Known {
    fn of(config: &Config) -> Result<Self> {
        let base = config.base_scene()?;
        let scene = config.change(&base)?;
        let discs = short(&hash(&(&scene.grains, &scene.fixed_discs), &scene.name)?);
        Ok(Self { base, discs })
    }
}

impl PlannedRun {
    /// That of a config. Series have these grains; `kept` is what is kept of the run besides its outcome, and
    /// `bases` what has been read, by name.
    ///
    /// # Errors
    /// Where the config is not sound, or has fewer grains.
    pub(super) fn new(
        config: &Config,
        grains_asked_for: &[usize],
        kept: &impl Serialize,
        bases: &mut HashMap<String, Known>,
    ) -> Result<Self> {
        let known = match bases.entry(config.base_scene_key()) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(place) => place.insert(Known::of(config)?),
        };
        let mut scene = config.change(&known.base)?;
        // What is kept of runs, the study says.
        scene.data = None;
        let config = config.resolved(&scene);
        let grains = config.source.grains.unwrap_or(scene.grains.len());
        if let Some(grain) = grains_asked_for.iter().find(|&&grain| grain >= grains) {
            return Err(Error::value("series.grains", grain, format!("below {grains}")));
        }
        // The scene stands in for the files that it may have been read from, the hash of its discs for them:
        // they are nearly all that it says, and the same in each run.
        scene.grains.clear();
        scene.fixed_discs.clear();
        let said = (env!("CARGO_PKG_VERSION"), &config, &scene, &known.discs, kept);
        let hasher = hash(&said, &scene.name)?;
        let steps = scene.duration_secs / scene.parameters.time_step_secs;
        let digits = 1.0 - scene.solver.tolerance.log10().min(0.0);
        Ok(Self { key: short(&hasher), cost: steps * grains as f64 * digits, config })
    }
}

fn hash(said: &impl Serialize, scene: &str) -> Result<blake3::Hasher> {
    let said = serde_json::to_vec(said)
        .map_err(|error| Error::value("scene", scene, error.to_string()))?;
    let mut hasher = blake3::Hasher::new();
    hasher.update(&said);
    Ok(hasher)
}

/// Half of a hash: 128 bits never meet by chance.
pub(super) fn short(hasher: &blake3::Hasher) -> String {
    hasher.finalize().to_hex()[..32].to_owned()
}
