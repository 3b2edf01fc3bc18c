//! A simulation in a file: whole, so that it goes on as if it had never been written.
//!
//! Left out is what every step makes anew: the step's problem, and what methods keep from one solve to the
//! next, on which no result depends (`tests/program/restart/` holds all of them to that).

use std::sync::Arc;

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::Simulation;
use crate::error::{Error, Result};
use crate::sim::alarm::Watch;
use crate::sim::snapshot::Surroundings;
use crate::sim::state::State;
use crate::sim::steady::Steady;
use crate::sim::steppers::{Memory, Stepper};
use crate::sim::{Observables, Settings};
use crate::solver::Slots;

/// All fields of a simulation: one that is forgotten here does not compile.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Simulation", deny_unknown_fields)]
struct Whole {
    state: State,
    settings: Settings,
    steady: Steady,
    #[serde(skip)]
    slots: Slots,
    memory: Memory,
    observables: Observables,
    initial_heights: f64,
    last_stepper: Option<Stepper>,
    watch: Watch,
    surroundings: Arc<Surroundings>,
    edits: u32,
}

impl Serialize for Simulation {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        Whole::serialize(self, serializer)
    }
}

impl<'de> Deserialize<'de> for Simulation {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        Whole::deserialize(deserializer)?.complete().map_err(D::Error::custom)
    }
}

impl Simulation {
    /// One that was read, once its parts are found to go together: none of them is looked for later on.
    fn complete(mut self) -> Result<Self> {
        self.settings.validate()?;
        self.state.physics.validate()?;
        self.state.world.validate(self.state.physics)?;
        self.settings.check_in(&self.state.world, self.state.physics)?;
        self.state.candidates = self.state.candidates.complete(&self.state.world)?;
        let Self { state, watch, .. } = &self;
        let grains = state.world.grains.len();
        let bodies = grains + state.world.fixed_discs.len() + state.candidates.features().len();
        let refuse = |field: &str| Error::value(field, "of other grains", "of those of the state");
        if !state.contacts.is_sound(bodies, grains) {
            return Err(refuse("contacts"));
        }
        if !watch.is_of(grains) {
            return Err(refuse("watch"));
        }
        if state.pull.is_some_and(|pull| pull.grain as usize >= grains) {
            return Err(refuse("pull"));
        }
        if state.is_held && state.world.motions.is_empty() {
            return Err(Error::value("hand", "on no wall", "on the wall of the last motion"));
        }
        Ok(self)
    }
}
