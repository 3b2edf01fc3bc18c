//! Copy of a simulation's state at one simulated time, from which Slump draws pictures and its interactive window. The
//! copy does not change while the simulation continues.

use std::sync::Arc;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::contact::{Numbering, Other};
use crate::number::{Parts, is_zero};
use crate::sim::observables::Observables;
use crate::sim::simulation::Simulation;
use crate::sim::state::State;
use crate::sim::surroundings::Surroundings;
use crate::world::Periodic;

/// Copy of a simulation's state at one simulated time, for pictures.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Snapshot {
    /// Measurements of the whole pile after the last step: one row of the CSV file of observables.
    pub observables: Observables,
    /// All grains, in the order of their indices.
    pub grains: Vec<GrainView>,
    /// Contacts whose bodies touched or were bonded in the last step.
    pub contacts: Vec<ContactView>,
    /// All parts of the picture other than grains: boundaries (walls and other shapes), fixed discs, periodic borders,
    /// gravity and materials.
    pub surroundings: Arc<Surroundings>,
}

impl Snapshot {
    /// Returns a hash of the bits of all grains' positions, velocities, angles and angular velocities. Equal hashes
    /// mean, with near certainty, equal bits.
    pub fn state_hash(&self) -> String {
        hash_of_bits(self.grains.iter().flat_map(|grain| {
            let GrainView { position, velocity, angle, angular_velocity, .. } = *grain;
            [position.x, position.y, velocity.x, velocity.y, angle, angular_velocity]
        }))
    }
}

/// Returns the 64-bit FNV-1a hash (section 5 of the internet draft draft-eastlake-fnv) of the bits of all numbers, as
/// 16 hexadecimal digits.
pub fn hash_of_bits(numbers: impl IntoIterator<Item = f64>) -> String {
    let bytes = numbers.into_iter().flat_map(f64::to_le_bytes);
    let hash = bytes.fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3)
    });
    format!("{hash:016x}")
}

/// State of a grain at one simulated time, for pictures.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GrainView {
    /// Centre of the grain, m.
    pub position: DVec2,
    /// Radius of the grain, m.
    pub radius: f64,
    /// Angle by which the grain has turned since the start, rad.
    pub angle: f64,
    /// Velocity of the grain's centre, m/s.
    pub velocity: DVec2,
    /// Angular velocity of the grain, rad/s.
    pub angular_velocity: f64,
    /// Largest overlap over the contacts of the grain, m; 0 without contacts.
    pub overlap: f64,
    /// Sum of the absolute values of the normal forces at the contacts of the grain, in newtons.
    pub force: f64,
    /// Number of contacts of the grain.
    pub coordination: u32,
    /// Grey value with which the grain is drawn: 0 is black, 255 white.
    pub tone: u8,
    /// Index of the grain's material in [`Surroundings::materials`].
    #[serde(default, skip_serializing_if = "is_zero")]
    pub material: u8,
}

/// A contact of the last step, for pictures: its bodies touched or were bonded.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactView {
    /// Index of the contact's first body, which is always a grain.
    pub grain: u32,
    /// Index of the contact's second body if it is a grain; `None` if it is a fixed disc or a boundary.
    pub other_grain: Option<u32>,
    /// Centre of the contact's first body, a grain, m.
    pub from: DVec2,
    /// Centre of the contact's second body if it is a grain or a fixed disc; the touched point if it is a boundary, m.
    pub to: DVec2,
    /// Normal force N, newton; negative if the contact pulls.
    pub normal_force: f64,
    /// Tangential force T, newton.
    pub tangential_force: f64,
    /// Gap between the two surfaces when the contact was found in the last step, m; negative for an overlap.
    pub gap: f64,
}

impl Simulation {
    /// Returns a copy of the present state for pictures.
    pub fn snapshot(&self) -> Snapshot {
        let (grains, numbering) = (&self.state.world.grains, Numbering::of(&self.state.world));
        let mut views: Vec<GrainView> = (0..grains.len())
            .map(|index| GrainView {
                position: grains.positions[index],
                radius: grains.radii[index],
                angle: grains.angles[index],
                velocity: grains.velocities[index],
                angular_velocity: grains.angular_velocities[index],
                overlap: 0.0,
                force: 0.0,
                coordination: 0,
                tone: grains.tones[index],
                material: grains.material(index),
            })
            .collect();
        let per_time_step = 1.0 / self.state.time_step_of_impulses_secs;
        let list = self.state.contacts.contacts().iter().zip(self.state.contacts.impulses());
        let shown = list.enumerate().filter(|&(index, _)| self.state.contacts.is_in_touch(index));
        let contacts = shown.map(|(_, (contact, impulse))| {
            let normal_force = impulse.normal * per_time_step;
            let other = numbering.other(contact.other);
            for index in [Some(contact.grain as usize), other.grain()].into_iter().flatten() {
                let view = &mut views[index];
                view.overlap = view.overlap.max((-contact.gap).positive_part());
                view.force += normal_force.abs();
                view.coordination += 1;
            }
            ContactView {
                grain: contact.grain,
                other_grain: other.grain().map(|_| contact.other),
                from: grains.positions[contact.grain as usize],
                to: self.far_end(contact.grain as usize, other),
                normal_force,
                tangential_force: impulse.tangential * per_time_step,
                gap: contact.gap,
            }
        });
        let contacts = contacts.collect();
        Snapshot {
            observables: *self.observables(),
            grains: views,
            contacts,
            surroundings: self.surroundings(),
        }
    }

    /// Returns a copy of the boundaries, fixed discs and other parts of a picture that are not grains, at their present
    /// positions.
    pub(super) fn surroundings(&self) -> Arc<Surroundings> {
        let world = &self.state.world;
        if !world.has_motion() && !world.periodic.is_some_and(Periodic::is_sheared) {
            return Arc::clone(&self.surroundings);
        }
        Arc::new(Surroundings::of(world, self.parameters().time_step_secs))
    }

    /// Returns the centre of the second body of a contact, m, if that body is a grain or a fixed disc, or the nearest
    /// point of a boundary. The first body is `grain`. With periodic borders, the result belongs to the periodic image
    /// that is nearest to the grain.
    fn far_end(&self, grain: usize, other: Other) -> DVec2 {
        let State { world, candidates, .. } = &self.state;
        let centre = world.grains.positions[grain];
        let near = |place| world.periodic.map_or(place, |periodic| periodic.near(place, centre));
        match other {
            Other::Grain(index) => near(world.grains.positions[index]),
            Other::FixedDisc(index) => near(world.fixed_discs[index].position),
            Other::Feature(index) => {
                let nearest = candidates.distance(world, index, centre);
                nearest.map_or(centre, |(normal, distance)| centre - distance * normal)
            }
        }
    }
}
