//! What pairs transmit over many steps, and with which stress: for means over the time between two moments.

use glam::{DMat2, DVec2};
use serde::{Deserialize, Serialize};

use crate::contact::{Impulse, Numbering, Other, Transmitted};
use crate::sim::moment::OtherBody;
use crate::sim::simulation::Simulation;
use crate::sim::state::State;

/// What pairs have transmitted over some steps in a row, all shocks and pieces of steps included.
///
/// ```
/// use slump_core::sim::ForceSums;
///
/// let mut simulation = slump_core::scene::built_in("pile")?.simulation()?;
/// let mut sums = ForceSums::default();
/// sums.follow(&simulation);
/// for _ in 0..5 {
///     simulation.step()?;
///     sums.follow(&simulation);
/// }
/// let sums = sums.take();
/// let force = sums.pairs[0].impulse / sums.secs;
/// # assert!(force.is_finite());
/// # Ok::<(), slump_core::error::Error>(())
/// ```
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForceSums {
    /// The step and the edits of the run that it has come to; none before it has seen one.
    come_to: Option<(u64, usize)>,
    /// The time of the steps that are in it, s.
    pub secs: f64,
    /// The pairs that transmitted anything, sorted as contacts are.
    pub pairs: Vec<PairSum>,
    /// Σ P ⊗ ℓ of each grain over its contacts, J·s: ℓ from the contact point to its centre.
    pub stresses: Vec<DMat2>,
}

/// What one pair has transmitted.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PairSum {
    /// Grain i.
    pub grain: u32,
    /// Body j.
    pub other: OtherBody,
    /// Body j, as contacts are sorted by it.
    number: u32,
    /// Steps in which it transmitted anything.
    pub steps: u64,
    /// On grain i, N·s.
    pub impulse: DVec2,
    /// Along the normals as they were, on grain i, N·s; negative pulls.
    pub normal: f64,
    /// Along (−n_y, n_x) as they were, on grain i, N·s.
    pub tangential: f64,
    /// r × P about the origin, r where it touches grain i, N·m·s.
    pub moment: f64,
    /// What a surface of body j that moves did on grain i, J.
    pub work: f64,
}

impl ForceSums {
    /// Adds the last step of a run. To be called at the start and after each step; where one is missing or a hand has
    /// changed the numbers of bodies, it begins anew.
    pub fn follow(&mut self, simulation: &Simulation) {
        let (step, edits) = (simulation.observables().step, simulation.edits());
        match self.come_to.replace((step, edits)) {
            Some(before) if before == (step, edits) => {}
            Some(before) if (before.0 + 1, before.1) == (step, edits) => self.add(simulation),
            _ => *self = Self { come_to: self.come_to, ..Self::default() },
        }
    }

    /// Gives what there is, and begins anew.
    pub fn take(&mut self) -> Self {
        let fresh = Self { come_to: self.come_to, ..Self::default() };
        std::mem::replace(self, fresh)
    }

    fn add(&mut self, simulation: &Simulation) {
        let State { world, candidates, contacts, walls, .. } = &simulation.state;
        let numbering = Numbering::of(world);
        let radii = &world.grains.radii;
        let Self { secs, pairs, stresses, .. } = self;
        let step_secs = simulation.observables().time_step_secs;
        *secs += step_secs;
        stresses.resize(radii.len(), DMat2::ZERO);
        let (known, mut place) = (pairs.len(), 0);
        for Transmitted { contact, sums, vector, .. } in contacts.transmitted_in_step() {
            if sums == Impulse::default() {
                continue;
            }
            let (pair, other) = (contact.pair(), numbering.other(contact.other));
            // Both lists are sorted alike, so one walk over the old one serves all.
            while place < known && pairs[place].key() < pair {
                place += 1;
            }
            let is_known = place < known && pairs[place].key() == pair;
            if !is_known {
                pairs.push(PairSum::none(pair, OtherBody::of(other, candidates)));
            }
            let at = if is_known { place } else { pairs.len() - 1 };
            let sum = &mut pairs[at];
            sum.steps += 1;
            sum.impulse += vector;
            sum.normal += sums.normal;
            sum.tangential += sums.tangential;
            let i = contact.grain as usize;
            // Where the grain was when the forces were.
            let centre = world.grains.positions[i] - step_secs * world.grains.velocities[i];
            sum.moment += (centre - (radii[i] + contact.gap) * contact.normal).perp_dot(vector);
            if let Some(surface) = walls.surface_at(world, &contact, centre) {
                let [normal_speed, tangential_speed] = surface.along(contact.normal);
                sum.work += sums.normal * normal_speed + sums.tangential * tangential_speed;
            }
            let mut add_stress = |grain: usize, gap: f64| {
                let branch = (radii[grain] + gap) * contact.normal;
                stresses[grain] += DMat2::from_cols(branch.x * vector, branch.y * vector);
            };
            match other {
                Other::Grain(j) => {
                    add_stress(contact.grain as usize, 0.5 * contact.gap);
                    add_stress(j, 0.5 * contact.gap);
                }
                _ => add_stress(contact.grain as usize, contact.gap),
            }
        }
        if pairs.len() > known {
            pairs.sort_by_key(PairSum::key);
        }
    }
}

impl PairSum {
    fn none((grain, number): (u32, u32), other: OtherBody) -> Self {
        let impulse = DVec2::ZERO;
        let (normal, tangential, moment, work) = (0.0, 0.0, 0.0, 0.0);
        Self { grain, other, number, steps: 0, impulse, normal, tangential, moment, work }
    }

    fn key(&self) -> (u32, u32) {
        (self.grain, self.number)
    }
}
