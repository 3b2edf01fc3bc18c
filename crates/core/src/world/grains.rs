//! The grains: discs that move under gravity and contact forces.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::materials::{Material, number_of};
use crate::error::{self, Error, Result};

/// One grain (a moving disc) of a scene. The fields are public, and their values are checked together with the scene.
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
    /// True if gravity accelerates this disc.
    #[serde(default = "yes")]
    pub feels_gravity: bool,
    /// Grey level of the disc in pictures in the style of Abramian & Staron (2020): 0 is black, 255 is white.
    #[serde(default = "light_grey")]
    pub tone: u8,
    /// Name of the material of the disc. Default: the first material of the scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
    /// Mass, kg. Default: areal density times the area πr² (r: radius).
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
    /// Grey level of a grain for which the scene does not give a grey level: 0 is black, 255 is white.
    pub(crate) const DEFAULT_TONE: u8 = 205;

    /// Returns a disc at rest on which gravity acts. `position` and `radius` in m.
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

    /// Returns the index of the material and the mass (kg) of the disc. If the disc has no given mass, its mass is the
    /// area πr² (r: radius) times the areal density (kg/m²). The areal density is given by the material, or is
    /// `density` if the material does not give one.
    pub(crate) fn material_and_mass(&self, density: f64, materials: &[Material]) -> (usize, f64) {
        let number = self.material.as_ref().and_then(|name| number_of(materials, name));
        let number = number.unwrap_or(0);
        let own_density = materials.get(number).and_then(|material| material.areal_density);
        let density = own_density.unwrap_or(density);
        let implied = density * std::f64::consts::PI * self.radius * self.radius;
        (number, self.mass.unwrap_or(implied))
    }
}

/// The discs of a world, as lists with one entry per disc.
///
/// The lists are separate because each pass over all grains (prediction, integration, detection) needs only a few of
/// them. A sweep over the contacts needs all velocities of a body at random indices, so it works on a packed copy
/// (`solver::problem`).
///
/// The fields are public, and a simulation checks them when it takes over the world. The data of a running simulation
/// can be read but not changed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Grains {
    /// Centres, m.
    pub positions: Vec<DVec2>,
    /// Velocities of the centres, m/s.
    pub velocities: Vec<DVec2>,
    /// Angles of rotation since the start of the run, rad.
    pub angles: Vec<f64>,
    /// Angular velocities, rad/s.
    pub angular_velocities: Vec<f64>,
    /// Radii, m.
    pub radii: Vec<f64>,
    /// Masses, kg. A grain without a given mass has the areal density times the area πr² (r: radius).
    pub masses: Vec<f64>,
    /// For each disc, true if gravity acts on it.
    pub feels_gravity: Vec<bool>,
    /// Grey levels for pictures in the style of Abramian & Staron (2020): 0 is black, 255 is white.
    pub tones: Vec<u8>,
    /// Index of the material of each disc. Empty in a world without materials.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub materials: Vec<u8>,
    /// For each disc, the total displacement, m, by which it has been moved back into the periodic cell since the
    /// start. The centre plus this displacement is the position without such jumps.
    pub brought_back: Vec<DVec2>,
    /// Permanent number of each grain, which stays the same if other grains are removed: the index of the grain in the
    /// scene. The fixed discs and boundaries have the numbers after the grains of the scene, and grains that are added
    /// later the numbers after these.
    pub ids: Vec<u32>,
    /// Number of grains at the start.
    pub count_at_start: u32,
    /// Number of grains added since the start.
    pub added: u32,
}

impl Grains {
    /// Builds the lists from `grains`. A grain without a given mass gets the mass `areal_density` (kg/m²) times its
    /// area.
    pub fn new(grains: &[Grain], areal_density: f64) -> Self {
        Self::of_materials(grains, areal_density, &[])
    }

    /// Builds the lists from `grains`, which consist of `materials`. `density` (kg/m²) is the areal density of
    /// materials that do not give their own.
    pub(crate) fn of_materials(grains: &[Grain], density: f64, materials: &[Material]) -> Self {
        let mut lists = Self::default();
        let ids = grains.iter().zip(0..);
        ids.for_each(|(grain, id)| lists.push(grain, density, materials, id));
        lists.count_at_start = lists.len() as u32;
        lists
    }

    /// Appends a grain with the permanent number `id`. `density` (kg/m²) is the areal density of materials that do not
    /// give their own.
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

    /// Removes the grain at `index`. The indices of the grains after it decrease by one.
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

    /// Returns the index of a grain's material; 0 in a world without materials.
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

    /// Returns the moment of inertia of the grain `index`, kg·m²: ½mr² for a solid disc (m: mass, r: radius).
    pub fn inertia(&self, index: usize) -> f64 {
        0.5 * self.masses[index] * self.radii[index] * self.radii[index]
    }

    /// Returns the present data of the grain `index` as a disc of a scene, without material and mass.
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
