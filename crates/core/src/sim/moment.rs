//! One moment of a run in full, as tables and measures need it: every grain, and every contact with its forces.

use std::sync::Arc;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::contact::law::cohesion_force;
use crate::contact::range::{Bond, TOUCH_IN_DIAMETERS};
use crate::contact::{Candidates, Contact, Impulse, Numbering, Other, Transmitted};
use crate::number::Parts;
use crate::setting::words;
use crate::sim::observables::Observables;
use crate::sim::settings::{Settings, Stepper};
use crate::sim::simulation::Simulation;
use crate::sim::state::State;
use crate::sim::surroundings::Surroundings;
use crate::world::{FrictionCone, Parameters, World};

/// How close to its bound a friction force slips, as a part of the bound. Smaller: contacts that slip stick
/// where a method ends near the bound and not on it; larger: contacts that nearly slip do.
const SLIPS_WITHIN: f64 = 1e-6;
/// How close to its cohesion a contact's pull is all that it can bear, as a part of the cohesion: rounding.
const OPENS_WITHIN: f64 = 1e-9;

/// One moment of a run. Plain data: it outlives the simulation.
#[derive(Clone, Debug)]
pub struct Moment {
    /// What the last step measured.
    pub observables: Observables,
    /// How the next step is taken, and as a rule how the last one was.
    pub settings: Settings,
    /// The moving discs; grain k is `grains[k]`.
    pub grains: Vec<GrainState>,
    /// The contacts of the last step, sorted by (grain, other).
    pub contacts: Vec<ContactState>,
    /// What no grain moves, where it is now.
    pub surroundings: Arc<Surroundings>,
    /// The number of the first fixed disc, which follows those of the grains that the run began with.
    pub first_fixed_id: u32,
}

impl Moment {
    /// The number that a grain keeps for the whole run. `grain` is its place in the list.
    pub fn id(&self, grain: u32) -> u32 {
        // What sums have of a grain that was taken out since is of its place alone.
        self.grains.get(grain as usize).map_or(grain, |state| state.id)
    }
}

/// One grain at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GrainState {
    /// The number that it keeps for the whole run.
    pub id: u32,
    /// Centre, m.
    pub position: DVec2,
    /// Where it was at the start, and all its ways since, m: borders that wrap have no part in it.
    pub unwrapped: DVec2,
    /// Angle turned since the start, rad.
    pub angle: f64,
    /// Velocity of the centre, m/s.
    pub velocity: DVec2,
    /// Angular velocity, rad/s, positive anticlockwise.
    pub angular_velocity: f64,
    /// m.
    pub radius: f64,
    /// kg.
    pub mass: f64,
    /// True where the gravity field acts on it.
    pub feels_gravity: bool,
    /// Grey that the scene gives it: 0 black … 255 white.
    pub tone: u8,
    /// True where it went through a wall or left the world.
    pub lost: bool,
}

/// A pair that touches since the last step, or transmitted anything in it. Forces are the means over that step, all its
/// shocks and pieces included. Normal and gap are those that the step began with, or the piece of it in which the pair was
/// found; they go with the positions before it: grains have moved by Δt·v since.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactState {
    /// Grain i.
    pub grain: u32,
    /// Body j.
    pub other: OtherBody,
    /// n, from j to i.
    pub normal: DVec2,
    /// m; negative is overlap.
    pub gap: f64,
    /// Half-way between the two surfaces, m, as grain i is now.
    pub point: DVec2,
    /// From the centre of j, or from the touched point of a boundary, to the centre of i, m.
    pub branch: DVec2,
    /// On grain i, newton.
    pub force: DVec2,
    /// N, newton, along n on grain i; negative pulls. Where n turns within the step, the mean of what is along it.
    pub normal_force: f64,
    /// T, newton, along (−n_y, n_x) on grain i, likewise: times its radius it is the torque on each grain.
    pub tangential_force: f64,
    /// What the friction law makes of it.
    pub status: ContactStatus,
    /// s: how far its bond is stretched, m; none where no bond lives, and but under the law `range`.
    pub bond_stretch: Option<f64>,
    /// Steps since the pair was first found to touch without a break.
    pub age_steps: u64,
}

/// The other body of a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum OtherBody {
    /// A grain, by its number.
    Grain(u32),
    /// A fixed disc, by its number among those.
    FixedDisc(u32),
    /// A boundary, by its number among those.
    Boundary(u32),
}

impl OtherBody {
    pub(super) fn of(other: Other, candidates: &Candidates) -> Self {
        match other {
            Other::Grain(index) => Self::Grain(index as u32),
            Other::FixedDisc(index) => Self::FixedDisc(index as u32),
            Other::Feature(feature) => Self::Boundary(candidates.boundary_of(feature) as u32),
        }
    }
}

words! {
    /// What a contact does under Signorini's and Coulomb's laws.
    pub enum ContactStatus {
        Open = "open", "pulls as hard as it can, and opens";
        Stick = "stick", "friction is below its bound";
        Slip = "slip", "friction is at its bound";
    }
}

impl Simulation {
    /// This moment in full.
    pub fn moment(&self) -> Moment {
        let State { world, candidates, contacts, .. } = &self.state;
        let laws = Laws::of(self);
        let per_time_step = match contacts.has_sums() {
            true => 1.0 / self.observables().time_step_secs,
            false => 1.0 / self.state.time_step_of_impulses_secs,
        };
        let numbering = Numbering::of(world);
        let touch = TOUCH_IN_DIAMETERS * world.mean_diameter;
        let states = contacts.transmitted().into_iter().filter_map(|(transmitted, index)| {
            let Transmitted { contact, found_in, sums, vector } = transmitted;
            let bond = index.map_or_else(Bond::default, |index| contacts.bonds()[index]);
            let is_in_touch = index.is_some_and(|index| contacts.is_in_touch(index));
            // A bond that has no strength holds nothing that is open.
            let is_held = is_in_touch && (contact.gap <= touch || laws.has_strength());
            if !is_held && sums == Impulse::default() {
                return None;
            }
            let other = numbering.other(contact.other);
            let normal_force = sums.normal * per_time_step;
            let tangential_force = sums.tangential * per_time_step;
            let alive = laws.has_bonds && bond.alive;
            let status = laws.status(&contact, other, alive, [normal_force, tangential_force]);
            let grain = contact.grain as usize;
            let (centre, radius) = (world.grains.positions[grain], world.grains.radii[grain]);
            // A boundary is touched in a point.
            let radius_of_other = match other {
                Other::Grain(index) => world.grains.radii[index],
                Other::FixedDisc(index) => world.fixed_discs[index].radius,
                Other::Feature(_) => 0.0,
            };
            Some(ContactState {
                grain: contact.grain,
                other: OtherBody::of(other, candidates),
                normal: contact.normal,
                gap: contact.gap,
                point: centre - (radius + 0.5 * contact.gap) * contact.normal,
                branch: (radius + contact.gap + radius_of_other) * contact.normal,
                force: per_time_step * vector,
                normal_force,
                tangential_force,
                status,
                bond_stretch: alive.then_some(bond.stretch),
                age_steps: self.observables().step.saturating_sub(found_in),
            })
        });
        let grains = &world.grains;
        let grain_state = |index: usize| GrainState {
            id: grains.ids[index],
            position: grains.positions[index],
            unwrapped: grains.positions[index] + grains.brought_back[index],
            angle: grains.angles[index],
            velocity: grains.velocities[index],
            angular_velocity: grains.angular_velocities[index],
            radius: grains.radii[index],
            mass: grains.masses[index],
            feels_gravity: grains.feels_gravity[index],
            tone: grains.tones[index],
            lost: self.is_lost(index),
        };
        Moment {
            observables: *self.observables(),
            settings: *self.settings(),
            contacts: states.collect(),
            grains: (0..world.grains.len()).map(grain_state).collect(),
            surroundings: self.surroundings(),
            first_fixed_id: grains.count_at_start,
        }
    }
}

/// What tells a contact's status from its impulses.
struct Laws<'a> {
    world: &'a World,
    parameters: &'a Parameters,
    has_cohesion: bool,
    has_bonds: bool,
    friction: f64,
}

impl<'a> Laws<'a> {
    fn of(simulation: &'a Simulation) -> Self {
        let State { world, physics, .. } = &simulation.state;
        let settings = simulation.settings();
        let parameters = &settings.parameters;
        Self {
            world,
            parameters,
            has_cohesion: physics.cohesion,
            has_bonds: settings.stepper == Stepper::Range,
            friction: if physics.friction { parameters.friction } else { 0.0 },
        }
    }

    /// True where bonds pull, if the law has any.
    fn has_strength(&self) -> bool {
        !self.has_bonds || (self.has_cohesion && self.parameters.bond > 0.0)
    }

    /// Of a contact with the forces N and T.
    fn status(
        &self,
        contact: &Contact,
        other: Other,
        bonded: bool,
        [normal, tangential]: [f64; 2],
    ) -> ContactStatus {
        let cohesion = self.cohesion(contact, other, bonded);
        let pushed_together = normal + cohesion;
        if pushed_together <= OPENS_WITHIN * cohesion {
            return ContactStatus::Open;
        }
        let rubbing = match self.parameters.cone {
            FrictionCone::Shifted => pushed_together,
            FrictionCone::Compressive => normal.positive_part(),
        };
        if tangential.abs() >= (1.0 - SLIPS_WITHIN) * self.friction * rubbing {
            ContactStatus::Slip
        } else {
            ContactStatus::Stick
        }
    }

    /// C₀, newton; none for a pair that has no bond under a law that asks for one.
    fn cohesion(&self, contact: &Contact, other: Other, bonded: bool) -> f64 {
        if !self.has_cohesion || (self.has_bonds && !bonded) {
            return 0.0;
        }
        let masses = &self.world.grains.masses;
        let mass = masses[contact.grain as usize];
        let per_mass = 1.0 / mass + other.grain().map_or(0.0, |index| 1.0 / masses[index]);
        let g = self.world.gravity.magnitude();
        let acceleration = self.parameters.cohesion_acceleration(g);
        cohesion_force(self.parameters.bond, 1.0 / per_mass, acceleration)
    }
}
