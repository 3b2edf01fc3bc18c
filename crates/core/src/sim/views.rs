//! How a simulation shows its present moment.

use std::sync::Arc;

use glam::DVec2;

use super::simulation::Simulation;
use super::snapshot::{ContactView, GrainView, Snapshot, Surroundings};
use super::state::State;
use crate::contact::{Numbering, Other};
use crate::world::Periodic;

impl Simulation {
    /// This moment, for pictures.
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
                view.overlap = view.overlap.max(-contact.gap);
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

    /// What no grain moves, where it is now.
    pub(super) fn surroundings(&self) -> Arc<Surroundings> {
        let world = &self.state.world;
        if !world.has_motion() && !world.periodic.is_some_and(Periodic::is_sheared) {
            return Arc::clone(&self.surroundings);
        }
        Arc::new(Surroundings::of(world, self.parameters().time_step_secs))
    }

    /// Centre of another disc, or the nearest point of another shape, m: of the nearest image of either.
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
