//! The moving discs.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::materials::{Material, number_of};
use crate::error::{self, Error, Result};

/// One disc of a scene. Plain data, checked with the scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Grain {
    /// Centre, m.
    pub position: DVec2,
    /// Radius, m.
    pub radius: f64,
    /// Velocity of the centre, m/s.
    #[serde(default)]
    pub velocity: DVec2,
    /// Angular velocity, rad/s, positive anticlockwise.
    #[serde(default)]
    pub angular_velocity: f64,
    /// True if gravity acts on this disc.
    #[serde(default = "yes")]
    pub feels_gravity: bool,
    /// Grey of the disc in pictures in the style of the paper: 0 is black, 255 white.
    #[serde(default = "light_grey")]
    pub tone: u8,
    /// Name of its material. Default: the first material of the scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
    /// Mass, kg. Default: areal density × πr².
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mass: Option<f64>,
}

fn yes() -> bool {
    true
}

fn light_grey() -> u8 {
    Grain::DEFAULT_TONE
}

impl Grain {
    /// The grey of a grain without a colour in its scene.
    pub(crate) const DEFAULT_TONE: u8 = 205;

    /// A disc at rest that feels gravity.
    pub fn at_rest(position: DVec2, radius: f64) -> Self {
        Self {
            position,
            radius,
            velocity: DVec2::ZERO,
            angular_velocity: 0.0,
            feels_gravity: true,
            tone: Self::DEFAULT_TONE,
            material: None,
            mass: None,
        }
    }

    /// The number of its material, and its mass, kg: its own, or πr² times the areal density of its material, or
    /// `density`, kg/m².
    pub(crate) fn material_and_mass(&self, density: f64, materials: &[Material]) -> (usize, f64) {
        let number = self.material.as_ref().and_then(|name| number_of(materials, name));
        let number = number.unwrap_or(0);
        let own_density = materials.get(number).and_then(|material| material.areal_density);
        let density = own_density.unwrap_or(density);
        let implied = density * std::f64::consts::PI * self.radius * self.radius;
        (number, self.mass.unwrap_or(implied))
    }
}

/// The discs of a world. Each list has one entry per disc.
///
/// The lists are separate because the passes over all grains (prediction, integration, detection) need few of them
/// each. The sweep needs a body's whole motion at random indices and works on a packed copy (`solver::problem`).
///
/// Plain data, checked when a simulation takes it over. A running simulation shows its own data but lends no mutable
/// access.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Grains {
    /// Centres, m.
    pub positions: Vec<DVec2>,
    /// Velocities of the centres, m/s.
    pub velocities: Vec<DVec2>,
    /// Rotation angles since the start, rad.
    pub angles: Vec<f64>,
    /// Angular velocities, rad/s.
    pub angular_velocities: Vec<f64>,
    /// Radii, m.
    pub radii: Vec<f64>,
    /// Masses, kg: areal density × πr², unless the scene gives them.
    pub masses: Vec<f64>,
    /// True if gravity acts on the disc.
    pub feels_gravity: Vec<bool>,
    /// Greys for pictures in the style of the paper.
    pub tones: Vec<u8>,
    /// The number of each disc's material; empty in a world without materials.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub materials: Vec<u8>,
    /// Displacement that periodic borders have subtracted from each centre since the start, m. Added to the centre,
    /// it gives the unwrapped position.
    pub brought_back: Vec<DVec2>,
    /// Permanent numbers: a grain's index in the scene. Grains added later have numbers above those of all other
    /// bodies.
    pub ids: Vec<u32>,
    /// Number of grains at the start.
    pub count_at_start: u32,
    /// Number of grains added since.
    pub added: u32,
}

impl Grains {
    /// Builds the lists from `grains`. `areal_density` in kg/m².
    pub fn new(grains: &[Grain], areal_density: f64) -> Self {
        Self::of_materials(grains, areal_density, &[])
    }

    /// Builds the lists from `grains` of these materials. `density` in kg/m², for materials without their own.
    pub(crate) fn of_materials(grains: &[Grain], density: f64, materials: &[Material]) -> Self {
        let mut lists = Self::default();
        let ids = grains.iter().zip(0..);
        ids.for_each(|(grain, id)| lists.push(grain, density, materials, id));
        lists.count_at_start = lists.len() as u32;
        lists
    }

    /// Appends a grain of one of `materials` with number `id`. `density` as in [`Self::of_materials`].
    pub(crate) fn push(&mut self, grain: &Grain, density: f64, materials: &[Material], id: u32) {
        let (material, mass) = grain.material_and_mass(density, materials);
        if !materials.is_empty() {
            self.materials.push(material as u8);
        }
        self.ids.push(id);
        self.positions.push(grain.position);
        self.velocities.push(grain.velocity);
        self.angles.push(0.0);
        self.angular_velocities.push(grain.angular_velocity);
        self.radii.push(grain.radius);
        self.masses.push(mass);
        self.feels_gravity.push(grain.feels_gravity);
        self.tones.push(grain.tone);
        self.brought_back.push(DVec2::ZERO);
    }

    pub(crate) fn validate(&self) -> Result<()> {
        let count = self.len();
        error::check(count != 0, "grains", 0, "at least one disc")?;
        let lengths = [
            ("velocities", self.velocities.len()),
            ("angles", self.angles.len()),
            ("angular_velocities", self.angular_velocities.len()),
            ("radii", self.radii.len()),
            ("masses", self.masses.len()),
            ("feels_gravity", self.feels_gravity.len()),
            ("tones", self.tones.len()),
            ("brought_back", self.brought_back.len()),
            ("ids", self.ids.len()),
            ("materials", if self.materials.is_empty() { count } else { self.materials.len() }),
        ];
        match lengths.into_iter().find(|&(_, length)| length != count) {
            None => Ok(()),
            Some((list, length)) => {
                let field = format!("the length of grains.{list}");
                Err(Error::value(field, length, format!("{count}, one a disc")))
            }
        }
    }

    /// Removes a grain; the grains after it move up.
    pub(crate) fn remove(&mut self, index: usize) {
        self.positions.remove(index);
        self.velocities.remove(index);
        self.angles.remove(index);
        self.angular_velocities.remove(index);
        self.radii.remove(index);
        self.masses.remove(index);
        self.feels_gravity.remove(index);
        self.tones.remove(index);
        if !self.materials.is_empty() {
            self.materials.remove(index);
        }
        self.brought_back.remove(index);
        self.ids.remove(index);
    }

    /// The number of a grain's material; 0 in a world without materials.
    pub fn material(&self, index: usize) -> u8 {
        self.materials.get(index).copied().unwrap_or(0)
    }

    /// Number of discs.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// True if there are no discs.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Moment of inertia of a solid disc, ½mr², kg·m².
    pub fn inertia(&self, index: usize) -> f64 {
        0.5 * self.masses[index] * self.radii[index] * self.radii[index]
    }

    /// Grain `index` as a scene would describe it now, except its material and mass.
    pub fn grain(&self, index: usize) -> Grain {
        Grain {
            position: self.positions[index],
            radius: self.radii[index],
            velocity: self.velocities[index],
            angular_velocity: self.angular_velocities[index],
            feels_gravity: self.feels_gravity[index],
            tone: self.tones[index],
            material: None,
            mass: None,
        }
    }
}
