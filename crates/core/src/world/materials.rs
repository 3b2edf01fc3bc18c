//! Materials of grains, fixed discs and boundaries, and the contact laws of pairs of materials.

use serde::{Deserialize, Serialize};

use super::{Parameters, Physics};
use crate::error::{self, Error, Result};

/// Largest allowed number of materials: a round number below 256, the number of values of one byte. The index of a
/// material is stored in one byte per grain.
const MOST_MATERIALS: usize = 100;

/// A material of a scene. If no material is given for a grain, fixed disc or boundary, the body consists of the first
/// material.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Name of the material.
    pub name: String,
    /// Areal density of the grains of this material, kg/m². If it is missing, they have the areal density of the
    /// scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub areal_density: Option<f64>,
    /// Indices of the boundaries that consist of this material.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub boundaries: Vec<usize>,
    /// Indices of the fixed discs that consist of this material.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub fixed_discs: Vec<usize>,
}

/// The contact law of a pair of materials. A missing coefficient is taken from the parameters of the scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialPair {
    /// Names of the two materials, which may be equal.
    pub between: [String; 2],
    /// Friction coefficient μ.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<f64>,
    /// Coefficient of rolling friction μ_r.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rolling_friction: Option<f64>,
    /// Coefficient of restitution ρ, from 0 to 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub restitution: Option<f64>,
    /// Bond number, which gives the cohesion force C₀ = Bond · m_ij · a, as in [`Parameters`] (m_ij: effective mass; a:
    /// gravity of the scene, or the parameter `bond_acceleration` if it is given).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bond: Option<f64>,
    /// Cohesion force C₀, N. It replaces the Bond number: the force is the same for all masses, with and without
    /// gravity.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cohesion_force: Option<f64>,
}

/// Cohesion of a pair of materials: a Bond number or a force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Cohesion {
    /// Bond number, which gives the cohesion force C₀ = Bond · m_ij · a (m_ij: effective mass; a: gravity of the scene,
    /// or the parameter `bond_acceleration` if it is given).
    Bond(f64),
    /// Cohesion force C₀, N.
    Force(f64),
}

/// The coefficients of the contact law of one pair of materials.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PairNumbers {
    /// Friction coefficient μ.
    pub friction: f64,
    /// Coefficient of rolling friction μ_r.
    pub rolling_friction: f64,
    /// Coefficient of restitution ρ.
    pub restitution: f64,
    /// Cohesion, as a Bond number or a force.
    pub cohesion: Cohesion,
}

impl PairNumbers {
    /// Returns the coefficients of the contact law `pair`. A coefficient that this law does not give is taken from
    /// `parameters`. Friction is 0 if `physics` excludes friction, rolling friction is 0 if it excludes rotation, and
    /// cohesion is 0 if it excludes cohesion.
    pub(crate) fn new(
        pair: Option<&MaterialPair>,
        parameters: &Parameters,
        physics: Physics,
    ) -> Self {
        let given = |of: fn(&MaterialPair) -> Option<f64>| pair.and_then(of);
        let cohesion = match given(|pair| pair.cohesion_force) {
            _ if !physics.cohesion => Cohesion::Bond(0.0),
            Some(force) => Cohesion::Force(force),
            None => Cohesion::Bond(given(|pair| pair.bond).unwrap_or(parameters.bond)),
        };
        Self {
            friction: match physics.friction {
                true => given(|pair| pair.friction).unwrap_or(parameters.friction),
                false => 0.0,
            },
            rolling_friction: match physics.rotation {
                true => given(|pair| pair.rolling_friction).unwrap_or(parameters.rolling_friction),
                false => 0.0,
            },
            restitution: given(|pair| pair.restitution).unwrap_or(parameters.restitution),
            cohesion,
        }
    }
}

/// Returns the index of the material with this name. `None` if there is no such material.
pub(super) fn number_of(materials: &[Material], name: &str) -> Option<usize> {
    materials.iter().position(|material| material.name == name)
}

/// Returns, for each of `count` bodies, the index of its material. `listed` selects from a material the list of its
/// boundaries or of its fixed discs. Bodies that no material lists have the index 0.
pub fn materials_of(
    materials: &[Material],
    listed: fn(&Material) -> &Vec<usize>,
    count: usize,
) -> Vec<u8> {
    let mut numbers = vec![0; count];
    for (number, material) in (0..).zip(materials) {
        listed(material).iter().for_each(|&body| numbers[body] = number);
    }
    numbers
}

/// Checks that a material with the name `name`, which a grain or a contact law uses, exists. `field` returns the name
/// of the setting for error messages.
pub(crate) fn check_name(
    field: impl FnOnce() -> String,
    name: &str,
    materials: &[Material],
) -> Result<()> {
    if number_of(materials, name).is_some() {
        return Ok(());
    }
    let names: Vec<_> = materials.iter().map(|material| material.name.as_str()).collect();
    let allowed = match &*names {
        [] => "left out where the scene lists no materials".to_owned(),
        names => format!("a material of the scene: {}", names.join(" or ")),
    };
    Err(Error::value(field(), name, allowed))
}

/// Checks the materials of a world and the contact laws of pairs of materials. `boundaries` and `fixed_discs` are the
/// numbers of these bodies in the world, which limit the indices that a material may list.
pub(super) fn check_materials(
    materials: &[Material],
    pairs: &[MaterialPair],
    [boundaries, fixed_discs]: [usize; 2],
    physics: Physics,
) -> Result<()> {
    let (count, allowed) = (materials.len(), format!("at most {MOST_MATERIALS}"));
    error::check(count <= MOST_MATERIALS, "the number of materials", count, allowed)?;
    for (index, material) in materials.iter().enumerate() {
        let Material { name, areal_density, .. } = material;
        let field = |name: &str| format!("materials[{index}].{name}");
        let is_new = !name.is_empty() && number_of(materials, name) == Some(index);
        error::check(is_new, field("name"), name, "a name that no other material has")?;
        if let Some(density) = areal_density {
            let is_sound = *density > 0.0 && density.is_finite();
            error::check(is_sound, field("areal_density"), density, "a finite number > 0 kg/m²")?;
        }
    }
    check_bodies("boundaries", materials, |material| &material.boundaries, boundaries)?;
    check_bodies("fixed_discs", materials, |material| &material.fixed_discs, fixed_discs)?;
    for (index, pair) in pairs.iter().enumerate() {
        pair.check(index, materials, physics)?;
        if let Some(other) = pairs[..index].iter().position(|other| other.is_between(&pair.between))
        {
            let between = pair.between.join(" and ");
            let allowed = format!("another pair than that of pairs[{other}]");
            return Err(Error::value(format!("pairs[{index}].between"), between, allowed));
        }
    }
    Ok(())
}

/// Checks the lists of boundaries, or of fixed discs, of all materials: each listed index must be below `count`, the
/// number of these bodies, and no body may be listed twice.
fn check_bodies(
    list: &str,
    materials: &[Material],
    listed: fn(&Material) -> &Vec<usize>,
    count: usize,
) -> Result<()> {
    let mut is_taken = vec![false; count];
    for (index, material) in materials.iter().enumerate() {
        for &body in listed(material) {
            let is_free =
                is_taken.get_mut(body).is_some_and(|taken| !std::mem::replace(taken, true));
            let allowed = format!("below {count}, the number of {list}, and listed once");
            error::check(is_free, format!("materials[{index}].{list}"), body, allowed)?;
        }
    }
    Ok(())
}

impl MaterialPair {
    /// True if this is the contact law between the materials with these two names, in either order.
    pub(crate) fn is_between(&self, [one, other]: &[String; 2]) -> bool {
        let [first, second] = &self.between;
        (first, second) == (one, other) || (first, second) == (other, one)
    }

    fn check(&self, index: usize, materials: &[Material], physics: Physics) -> Result<()> {
        let field = |name: &str| format!("pairs[{index}].{name}");
        for name in &self.between {
            check_name(|| field("between"), name, materials)?;
        }
        let Self { friction, rolling_friction, restitution, bond, cohesion_force, .. } = *self;
        let numbers = [
            ("friction", friction, physics.friction, "physics.friction"),
            ("rolling_friction", rolling_friction, physics.rotation, "physics.rotation"),
            ("bond", bond, physics.cohesion, "physics.cohesion"),
            ("cohesion_force", cohesion_force, physics.cohesion, "physics.cohesion"),
        ];
        for (name, value, is_computed, switch) in numbers {
            let value = value.unwrap_or(0.0);
            let is_size = value >= 0.0 && value.is_finite();
            error::check(is_size, field(name), value, "a finite number ≥ 0")?;
            let allowed = format!("left out or 0 where {switch} is false");
            error::check(is_computed || value == 0.0, field(name), value, allowed)?;
        }
        let restitution = restitution.unwrap_or(0.0);
        let is_sound = (0.0..=1.0).contains(&restitution);
        error::check(is_sound, field("restitution"), restitution, "between 0 and 1")?;
        match (bond, cohesion_force) {
            (Some(_), Some(force)) => {
                let allowed = "left out where the pair has a bond";
                Err(Error::value(field("cohesion_force"), force, allowed))
            }
            _ => Ok(()),
        }
    }
}
