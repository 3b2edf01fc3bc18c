//! Where a scene comes from.

use std::path::PathBuf;

use serde::Serialize;
use serde::de::MapAccess;

use super::parser_of;
use crate::scene::{Deposition, NewPile, Preset};

/// Where a scene comes from, and what of it is not a setting.
#[derive(Clone, Debug, Default, PartialEq, Serialize, clap::Args)]
#[serde(rename_all = "kebab-case")]
pub struct Origin {
    /// Built-in scene (pile, cradle, collision, …: `slump list`) or a scene file (NAME.toml)
    #[arg(long, value_name = "NAME|FILE", help_heading = "Scene")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scene: Option<String>,
    /// Start the pile from discs: a CSV (header x,y,radius, optionally vx,vy,omega; metres), or what --data wrote; or the scene of a saved run from its grains
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
    #[arg(long, value_name = "D", help_heading = "Scene", allow_negative_numbers = true)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub box_width: Option<f64>,
    /// Width of the rough base under a pile, in mean diameters [default: five heights beyond the box on either side]
    #[arg(long, value_name = "D", help_heading = "Scene", allow_negative_numbers = true)]
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
    #[arg(long, value_name = "D", help_heading = "Scene", allow_negative_numbers = true)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start: Option<f64>,
    /// Settings that go together; what else is given changes them
    #[arg(long, value_name = "NAME", value_parser = parser_of::<Preset>(), help_heading = "Scene")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub preset: Option<Preset>,
    /// Simulated time, seconds
    #[arg(long, value_name = "SECONDS", help_heading = "Scene", allow_negative_numbers = true)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub duration: Option<f64>,
}

impl Origin {
    /// Reads the value of the field of that name from a file. Whether there is one.
    pub(super) fn read<'de, A: MapAccess<'de>>(
        &mut self,
        name: &str,
        map: &mut A,
    ) -> Result<bool, A::Error> {
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

    /// Whether grains have to be put in place and settled.
    pub fn makes_new_pile(&self) -> bool {
        self.grains.is_some()
            || self.box_width.is_some()
            || self.seed.is_some()
            || self.deposition.is_some()
    }
}
