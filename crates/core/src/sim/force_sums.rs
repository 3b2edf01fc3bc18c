//! Sums of contact impulses and grain stresses over many steps, from which mean forces over these steps follow.

use glam::{DMat2, DVec2};
use serde::{Deserialize, Serialize};

use crate::contact::{Impulse, Numbering, Other, Transmitted};
use crate::sim::moment::OtherBody;
use crate::sim::simulation::Simulation;
use crate::sim::state::State;

/// Contact impulses of all pairs of bodies, summed over consecutive steps. If a step computes collisions separately or
/// is divided into shorter pieces, the impulses of all collisions and pieces count.
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
    /// Number of the last step in these sums, and number of interactive edits of the world up to that step; `None`
    /// before the first step.
    come_to: Option<(u64, usize)>,
    /// Total duration of the summed steps, s.
    pub secs: f64,
    /// Sums for each pair of bodies with an impulse other than 0 in at least one step, sorted by grain i and then by
    /// body j.
    pub pairs: Vec<PairSum>,
    /// Stress sum of each grain, J·s: Σ P ⊗ ℓ over its contacts, with the impulse P and the vector ℓ from the contact
    /// point to the centre of the grain.
    pub stresses: Vec<DMat2>,
}

/// Sums of impulses, moments and work for one pair of bodies.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PairSum {
    /// Index of grain i of the pair.
    pub grain: u32,
    /// Body j of the pair.
    pub other: OtherBody,
    /// Index of body j in the list of all grains, then all fixed discs, then all boundary features (parts of
    /// boundaries). Pairs with the same grain i are sorted by this index.
    number: u32,
    /// Number of steps in which the impulse of the pair was not 0.
    pub steps: u64,
    /// Sum of the impulses on grain i, N·s.
    pub impulse: DVec2,
    /// Sum of the normal impulses on grain i, N·s, each along the contact normal of its step; negative if the pair
    /// pulls.
    pub normal: f64,
    /// Sum of the tangential impulses on grain i, N·s, each along the tangent (−n_y, n_x) of its step, with the contact
    /// normal n.
    pub tangential: f64,
    /// Sum of the moments r × P about the origin, N·m·s, with the impulse P on grain i and the touched point r of body
    /// j's surface.
    pub moment: f64,
    /// Work that the moving surface of body j does on grain i, J; 0 if body j is not a moving wall.
    pub work: f64,
}

impl ForceSums {
    /// Adds the impulses of the last step of `simulation`. Call this method once before the first step, and then after
    /// each step. If a step was left out, or an edit of the world has changed the indices of bodies, the sums start
    /// again from zero.
    pub fn follow(&mut self, simulation: &Simulation) {
        let (step, edits) = (simulation.observables().step, simulation.edits());
        match self.come_to.replace((step, edits)) {
            Some(before) if before == (step, edits) => {}
            Some(before) if (before.0 + 1, before.1) == (step, edits) => self.add(simulation),
            _ => *self = Self { come_to: self.come_to, ..Self::default() },
        }
    }

    /// Returns the sums so far, and sets them to zero for the next steps.
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
            // Both lists have the same order, so a single pass over the older list suffices.
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
            // Position of the grain when the forces acted: at the beginning of the step.
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
