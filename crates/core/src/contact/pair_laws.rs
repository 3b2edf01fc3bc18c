//! The contact laws of a world with several materials, and the choice of the law for a contact from the materials of
//! its two bodies.

use super::{Candidates, Contact, Numbering, Other, law};
use crate::world::{
    Cohesion, Grains, Material, PairNumbers, Parameters, Physics, World, materials_of,
};

/// The coefficients of the contact law of one contact.
#[derive(Clone, Copy, Debug)]
pub struct RowNumbers {
    /// Friction coefficient μ.
    pub friction: f64,
    /// Coefficient of rolling friction μ_r.
    pub rolling_friction: f64,
    /// Coefficient of restitution ρ.
    pub restitution: f64,
    /// Cohesion force divided by effective mass, m/s².
    pub cohesion_per_mass: f64,
}

/// Contact laws, one for each pair of materials. They exist only if the scene gives coefficients for some pairs of
/// materials. All other pairs have the parameters of the run.
#[derive(Clone, Debug)]
pub(crate) struct PairLaws {
    /// Number of materials of the world.
    count: usize,
    /// Coefficients of the contact laws. The coefficients of the pair of materials with the indices a and b are at
    /// index a · `count` + b, with the number of materials `count`.
    numbers: Vec<PairNumbers>,
    /// Index of the material of each fixed disc. `of_boundary` lists the index for each boundary.
    of_disc: Vec<u8>,
    of_boundary: Vec<u8>,
    /// Acceleration that defines the cohesion force, m/s²: the force is this acceleration times Bond number times
    /// effective mass.
    acceleration: f64,
}

impl PairLaws {
    /// Returns the contact laws of the pairs of materials of a world. `None` if all contacts have the coefficients in
    /// `parameters`.
    pub(crate) fn of(world: &World, parameters: &Parameters, physics: Physics) -> Option<Self> {
        let World { materials, pairs, .. } = world;
        if pairs.is_empty() {
            return None;
        }
        let numbers = |one: &Material, other: &Material| {
            let between = [one.name.clone(), other.name.clone()];
            let pair = pairs.iter().find(|pair| pair.is_between(&between));
            PairNumbers::new(pair, parameters, physics)
        };
        let of_pairs =
            materials.iter().flat_map(|one| materials.iter().map(move |other| numbers(one, other)));
        Some(Self {
            count: materials.len(),
            numbers: of_pairs.collect(),
            of_disc: materials_of(materials, |it| &it.fixed_discs, world.fixed_discs.len()),
            of_boundary: materials_of(materials, |it| &it.boundaries, world.boundaries.len()),
            acceleration: parameters.cohesion_acceleration(world.gravity.magnitude()),
        })
    }

    /// Returns the coefficients of the contact law that holds for the materials of a contact. `effective_mass` is the
    /// effective mass of the contact, kg.
    pub(crate) fn numbers(
        &self,
        world: &World,
        candidates: &Candidates,
        contact: &Contact,
        effective_mass: f64,
    ) -> RowNumbers {
        let one = world.grains.material(contact.grain as usize);
        let other = match Numbering::of(world).other(contact.other) {
            Other::Grain(grain) => world.grains.material(grain),
            Other::FixedDisc(disc) => self.of_disc[disc],
            Other::Feature(feature) => self.of_boundary[candidates.boundary_of(feature)],
        };
        let pair = self.numbers[self.count * usize::from(one) + usize::from(other)];
        self.at_mass(pair, effective_mass)
    }

    fn at_mass(&self, pair: PairNumbers, effective_mass: f64) -> RowNumbers {
        let PairNumbers { friction, rolling_friction, restitution, cohesion } = pair;
        let cohesion_per_mass = match cohesion {
            Cohesion::Bond(bond) => law::cohesion_force(bond, 1.0, self.acceleration),
            Cohesion::Force(force) => force / effective_mass,
        };
        RowNumbers { friction, rolling_friction, restitution, cohesion_per_mass }
    }

    /// Returns three maxima over all pairs of materials: of the friction coefficient, of the coefficient of rolling
    /// friction, and of the cohesion per effective mass C₀/m_ij (m/s²) between two grains of the mean mass.
    pub(crate) fn largest(&self, grains: &Grains) -> [f64; 3] {
        let effective_mass = 0.5 * grains.masses.iter().sum::<f64>() / grains.len() as f64;
        self.numbers.iter().fold([0.0; 3], |[friction, rolling, cohesion], &pair| {
            let numbers = self.at_mass(pair, effective_mass);
            [
                numbers.friction.max(friction),
                numbers.rolling_friction.max(rolling),
                numbers.cohesion_per_mass.max(cohesion),
            ]
        })
    }
}
