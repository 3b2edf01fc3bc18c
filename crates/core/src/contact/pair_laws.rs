//! The contact laws of all pairs of materials of a world, and the pair of a contact.

use super::{Candidates, Contact, Numbering, Other, law};
use crate::world::{
    Cohesion, Grains, Material, PairNumbers, Parameters, Physics, World, materials_of,
};

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

    /// The numbers of a contact.
    pub(crate) fn numbers(
        &self,
        world: &World,
        candidates: &Candidates,
        contact: &Contact,
    ) -> PairNumbers {
        let one = world.grains.material(contact.grain as usize);
        let other = match Numbering::of(world).other(contact.other) {
            Other::Grain(grain) => world.grains.material(grain),
            Other::FixedDisc(disc) => self.of_disc[disc],
            Other::Feature(feature) => self.of_boundary[candidates.boundary_of(feature)],
        };
        self.numbers[self.count * usize::from(one) + usize::from(other)]
    }

    /// C₀/m_ij, m/s².
    pub(crate) fn cohesion_per_mass(&self, numbers: PairNumbers, effective_mass: f64) -> f64 {
        match numbers.cohesion {
            Cohesion::Bond(bond) => law::cohesion_force(bond, 1.0, self.acceleration),
            Cohesion::Force(force) => force / effective_mass,
        }
    }

    /// The largest μ and μ_r of all pairs, and the largest C₀/m_ij, m/s², for two grains of the mean mass.
    pub(crate) fn largest(&self, grains: &Grains) -> [f64; 3] {
        let effective_mass = 0.5 * grains.masses.iter().sum::<f64>() / grains.len() as f64;
        let numbers = |it: &PairNumbers| {
            [it.friction, it.rolling_friction, self.cohesion_per_mass(*it, effective_mass)]
        };
        let larger =
            |most: [f64; 3], it: [f64; 3]| std::array::from_fn(|at| f64::max(most[at], it[at]));
        self.numbers.iter().map(numbers).fold([0.0; 3], larger)
    }
}
