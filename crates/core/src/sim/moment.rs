//! Full copy of a simulation's state at one simulated time, for tables and measurements: every grain, and every contact
//! with its forces.

use std::sync::Arc;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::contact::law::cohesion_force;
use crate::contact::range::{Bond, TOUCH_IN_DIAMETERS};
use crate::contact::{
    Candidates, Contact, Impulse, Numbering, Other, PairLaws, RowNumbers, Transmitted,
};
use crate::number::Parts;
use crate::setting::words;
use crate::sim::observables::Observables;
use crate::sim::settings::{Settings, Stepper};
use crate::sim::simulation::Simulation;
use crate::sim::state::State;
use crate::sim::surroundings::Surroundings;
use crate::world::{FrictionCone, Parameters, World};

/// Relative distance of a friction force from the friction bound below which the contact counts as slipping. With a
/// smaller value, slipping contacts would count as sticking if the solver ends slightly below the bound; with a larger
/// value, sticking contacts near the bound would count as slipping.
const SLIPS_WITHIN: f64 = 1e-6;
/// Relative difference between the pull of a contact and the cohesion force below which the contact counts as pulling
/// with the full cohesion force; it allows for rounding.
const OPENS_WITHIN: f64 = 1e-9;

/// Full copy of a simulation's state at one simulated time. It remains valid while the simulation continues.
#[derive(Clone, Debug)]
pub struct Moment {
    /// Measurements after the last step.
    pub observables: Observables,
    /// Settings of the next step, which usually are also the settings of the last step.
    pub settings: Settings,
    /// All grains. The grain with the index k is `grains[k]`.
    pub grains: Vec<GrainState>,
    /// The contacts of the last step, sorted by the index of the grain and then by the other body.
    pub contacts: Vec<ContactState>,
    /// Boundaries, fixed discs and other parts of a picture that are not grains, at their positions at this time.
    pub surroundings: Arc<Surroundings>,
    /// Identifier of the first fixed disc. Fixed discs have the identifiers after those of the grains of the initial
    /// state.
    pub first_fixed_id: u32,
}

impl Moment {
    /// Returns the identifier of a grain from its present index in the list of grains. Unlike the index, the identifier
    /// never changes.
    pub fn id(&self, grain: u32) -> u32 {
        // Sums over steps may name a grain that has been removed since. Then only its index is known.
        self.grains.get(grain as usize).map_or(grain, |state| state.id)
    }
}

/// State of a grain at one simulated time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GrainState {
    /// Identifier of the grain, which never changes; the index of a grain changes if a grain before it is removed.
    pub id: u32,
    /// Centre of the grain, m.
    pub position: DVec2,
    /// Initial position plus all displacements since, m. Unlike `position`, it does not jump at periodic borders.
    pub unwrapped: DVec2,
    /// Angle by which the grain has turned since the start, rad.
    pub angle: f64,
    /// Velocity of the grain's centre, m/s.
    pub velocity: DVec2,
    /// Angular velocity of the grain, rad/s, positive anticlockwise.
    pub angular_velocity: f64,
    /// Radius of the grain, m.
    pub radius: f64,
    /// Mass of the grain, kg.
    pub mass: f64,
    /// True if gravity acts on the grain.
    pub feels_gravity: bool,
    /// Grey value with which the grain is drawn: 0 is black, 255 white.
    pub tone: u8,
    /// Index of the grain's material in [`Surroundings::materials`].
    pub material: u8,
    /// True if the grain went through a wall or left the world.
    pub lost: bool,
}

/// Pair of bodies that touched in the last step, or between which an impulse acted in it. Forces are means over the
/// step, including all collisions and all pieces into which the step was divided. Normal and gap belong to the
/// positions at the beginning of the step, or of the piece of the step in which the pair was found. Since then, grains
/// have moved by the length of this step or piece times their velocities.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactState {
    /// Index of grain i of the pair.
    pub grain: u32,
    /// Body j of the pair.
    pub other: OtherBody,
    /// Unit normal n, from body j to grain i.
    pub normal: DVec2,
    /// Gap between the surfaces, m; negative for an overlap.
    pub gap: f64,
    /// Point half-way between the two surfaces, m, computed from the present position of grain i.
    pub point: DVec2,
    /// Vector to the centre of grain i, m: from the centre of disc j, or from the touched point of boundary j.
    pub branch: DVec2,
    /// Force on grain i, newton.
    pub force: DVec2,
    /// Normal force N on grain i along the normal n, newton; negative if the contact pulls. If n turns within the step,
    /// N is the mean of the components along the normal at each time.
    pub normal_force: f64,
    /// Tangential force T on grain i along (−n_y, n_x), newton. If the normal n turns within the step, T is the mean of
    /// the components along the tangent at each time. T times the radius of a grain is the torque on that grain.
    pub tangential_force: f64,
    /// Status under the contact law: open, sticking or slipping.
    pub status: ContactStatus,
    /// Stretch s of the pair's bond, m; `None` if the pair has no bond, and under contact laws other than `range`.
    pub bond_stretch: Option<f64>,
    /// Number of steps for which the pair has touched without interruption.
    pub age_steps: u64,
}

/// The other body of a contact: a grain, a fixed disc or a boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum OtherBody {
    /// The grain with this index.
    Grain(u32),
    /// The fixed disc with this index.
    FixedDisc(u32),
    /// The boundary with this index.
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
    /// Status of a contact under Signorini's and Coulomb's laws.
    pub enum ContactStatus {
        Open = "open", "pulls as hard as it can, and opens";
        Stick = "stick", "friction is below its bound";
        Slip = "slip", "friction is at its bound";
    }
}

impl Simulation {
    /// Returns a full copy of the present state, with all grains and contacts.
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
            // If bonds have no strength, an open pair counts as separated.
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
            // A boundary is touched at a point, so it adds no radius to the branch.
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
            material: grains.material(index),
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

/// Inputs for the status (open, sticking or slipping) of a contact.
struct Laws<'a> {
    world: &'a World,
    candidates: &'a Candidates,
    parameters: &'a Parameters,
    /// Contact laws for pairs of materials; `None` if all contacts have the coefficients of `parameters`, whatever
    /// their materials are.
    pairs: Option<PairLaws>,
    has_cohesion: bool,
    has_bonds: bool,
    friction: f64,
}

impl<'a> Laws<'a> {
    fn of(simulation: &'a Simulation) -> Self {
        let State { world, candidates, physics, .. } = &simulation.state;
        let settings = simulation.settings();
        let parameters = &settings.parameters;
        Self {
            world,
            candidates,
            parameters,
            pairs: simulation.state.pair_laws(parameters),
            has_cohesion: physics.cohesion,
            has_bonds: settings.stepper == Stepper::Range,
            friction: if physics.friction { parameters.friction } else { 0.0 },
        }
    }

    /// False if the contact law has bonds that cannot pull, because the Bond number is 0 or cohesion is off. True if
    /// bonds can pull, or if the contact law has no bonds.
    fn has_strength(&self) -> bool {
        !self.has_bonds || (self.has_cohesion && self.parameters.bond > 0.0)
    }

    /// Returns the status of a contact with the normal and tangential forces N and T, newton. `bonded` is true if its
    /// pair has a bond.
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
        let numbers = self.numbers(contact, 1.0);
        let friction = numbers.map_or(self.friction, |numbers| numbers.friction);
        if tangential.abs() >= (1.0 - SLIPS_WITHIN) * friction * rubbing {
            ContactStatus::Slip
        } else {
            ContactStatus::Stick
        }
    }

    /// Returns the friction and cohesion coefficients of a contact with this effective mass (kg) if the contact laws
    /// depend on pairs of materials; otherwise `None`.
    fn numbers(&self, contact: &Contact, effective_mass: f64) -> Option<RowNumbers> {
        let pairs = self.pairs.as_ref()?;
        Some(pairs.numbers(self.world, self.candidates, contact, effective_mass))
    }

    /// Returns the cohesion force C₀, newton; 0 for a pair without a bond under a law that requires a bond.
    fn cohesion(&self, contact: &Contact, other: Other, bonded: bool) -> f64 {
        if !self.has_cohesion || (self.has_bonds && !bonded) {
            return 0.0;
        }
        let masses = &self.world.grains.masses;
        let mass = masses[contact.grain as usize];
        let per_mass = 1.0 / mass + other.grain().map_or(0.0, |index| 1.0 / masses[index]);
        if let Some(numbers) = self.numbers(contact, 1.0 / per_mass) {
            return numbers.cohesion_per_mass / per_mass;
        }
        let g = self.world.gravity.magnitude();
        let acceleration = self.parameters.cohesion_acceleration(g);
        cohesion_force(self.parameters.bond, 1.0 / per_mass, acceleration)
    }
}
