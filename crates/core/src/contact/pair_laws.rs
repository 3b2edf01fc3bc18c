//! The contact laws of all pairs of materials of a world, and the pair of a contact.

use super::{Candidates, Contact, Numbering, Other, law};
use crate::world::{
    Cohesion, Grains, Material, PairNumbers, Parameters, Physics, World, materials_of,
};

/// The numbers of the law of one contact.
#[derive(Clone, Copy, Debug)]
pub struct RowNumbers {
    /// Friction coefficient μ.
    pub friction: f64,
    /// Restitution ρ.
    pub restitution: f64,
    /// C₀/m_ij, m/s².
    pub cohesion_per_mass: f64,
}

/// Contact laws by pairs of materials, for worlds whose pairs have numbers of their own.
#[derive(Clone, Debug)]
pub(crate) struct PairLaws {
    /// Number of materials.
    count: usize,
    /// The numbers of materials a and b are at `count` · a + b.
    numbers: Vec<PairNumbers>,
    /// The material of each fixed disc and of each boundary.
    of_disc: Vec<u8>,
    of_boundary: Vec<u8>,
    /// a in C₀ = Bond · m_ij · a, m/s².
    acceleration: f64,
}

impl PairLaws {
    /// The laws of a world; `None` if all contacts have the numbers of the parameters.
    pub(crate) fn of(world: &World, parameters: &Parameters, physics: Physics) -> Option<Self> {
        let World { materials, pairs, .. } = world;
        if pairs.is_empty() {
            return None;
        }
        let numbers = |one: &Material, other: &Material| {
            let between = [one.name.clone(), other.name.clone()];
            let pair = pairs.iter().find(|pair| pair.is_between(&between));
            PairNumbers::new(pair, parameters, [physics.friction, physics.cohesion])
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

    /// The numbers of a contact with this effective mass, kg.
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
        let PairNumbers { friction, restitution, cohesion } = pair;
        let cohesion_per_mass = match cohesion {
            Cohesion::Bond(bond) => law::cohesion_force(bond, 1.0, self.acceleration),
            Cohesion::Force(force) => force / effective_mass,
        };
        RowNumbers { friction, restitution, cohesion_per_mass }
    }

    /// The largest μ of all pairs, and the largest C₀/m_ij, m/s², for two grains of the mean mass.
    pub(crate) fn largest(&self, grains: &Grains) -> [f64; 2] {
        let effective_mass = 0.5 * grains.masses.iter().sum::<f64>() / grains.len() as f64;
        self.numbers.iter().fold([0.0; 2], |[friction, cohesion], &pair| {
            let numbers = self.at_mass(pair, effective_mass);
            [numbers.friction.max(friction), numbers.cohesion_per_mass.max(cohesion)]
        })
    }
}
