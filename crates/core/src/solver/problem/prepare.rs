//! How a step's problem is set up: what the bodies do by themselves, which row comes when, and what the
//! law adds to each contact's velocity.

use super::kinematics::Kinematics;
use super::model::Model;
use super::step_problem::{Row, StepProblem};
use crate::contact::{Contact, ContactList, Impulse, Numbering, law};
use crate::solver::settings::SolverSettings;
use crate::threads;
use crate::world::World;

/// The numbers that a problem is set up with.
#[derive(Clone, Copy, Debug)]
pub struct ProblemNumbers {
    /// Δt, s.
    pub time_step_secs: f64,
    /// μ.
    pub friction: f64,
    /// C₀Δt/m_ij, m/s; 0 without cohesion.
    pub capture_speed: f64,
}

/// How a contact's bodies come to each other before the step.
#[derive(Clone, Copy, Debug)]
pub struct Approach {
    /// v_n^{n−1}, relative to a wall that moves, m/s.
    pub velocity: f64,
    /// m; negative is overlap.
    pub gap: f64,
    /// Whether the pair touches or is bonded, and does not just come near.
    pub in_touch: bool,
}

impl<K: Kinematics> StepProblem<K> {
    /// Sets up the step: free velocities, and rows in the order of the method and its settings that
    /// carry the impulses of `contacts` (warm start) or none. `rebound` gives what the law adds to v_n
    /// of a contact, m/s.
    pub fn prepare<M: Model<Kinematics = K>>(
        &mut self,
        world: &World,
        contacts: &ContactList,
        numbers: ProblemNumbers,
        settings: &SolverSettings,
        rebound: impl Fn(Approach) -> f64 + Sync,
    ) {
        let grains = &world.grains;
        self.friction = numbers.friction;
        self.capture_speed = numbers.capture_speed;
        self.captures.clear();
        self.wall_speeds.clear();
        self.surfaces.clear();
        self.driven.clear();
        self.mean_mass = grains.masses.iter().sum::<f64>() / grains.len() as f64;
        self.masses.clone_from(&grains.masses);
        self.place_bodies(world, numbers.time_step_secs);
        let fixed = self.order_rows(world, contacts.contacts(), settings);
        if contacts.looks_ahead() && self.capture_speed > 0.0 {
            let capture = |&index: &u32| match contacts.is_in_touch(index as usize) {
                true => self.capture_speed,
                false => 0.0,
            };
            self.captures.extend(self.contact_of_row.iter().map(capture));
        }
        let [mut fixed_rows, mut pair_rows] =
            [&mut self.fixed_rows, &mut self.pair_rows].map(std::mem::take);
        let row = |at: usize| {
            let index = self.contact_of_row[at] as usize;
            let start = settings.warm_start.then(|| contacts.impulses()[index]);
            self.row::<M>(world, contacts, (at, index), &rebound, start)
        };
        threads::fill(&mut fixed_rows, fixed, row);
        threads::fill(&mut pair_rows, self.contact_of_row.len() - fixed, |at| row(fixed + at));
        (self.fixed_rows, self.pair_rows) = (fixed_rows, pair_rows);
        self.form_velocities();
        self.hold::<M>(contacts, settings.friction_model);
    }

    /// Packs the bodies as they are, and as gravity alone would leave them.
    fn place_bodies(&mut self, world: &World, time_step_secs: f64) {
        let grains = &world.grains;
        let Self { before, free, .. } = self;
        threads::fill(before, grains.len(), |index| K::body(world, index));
        threads::fill(free, grains.len(), |index| match grains.feels_gravity[index] {
            true => K::accelerated(&before[index], world, index, time_step_secs),
            false => before[index],
        });
    }

    /// Tells which contact stands behind which row, and how many, the first, are with fixed bodies.
    fn order_rows(
        &mut self,
        world: &World,
        contacts: &[Contact],
        settings: &SolverSettings,
    ) -> usize {
        let numbering = Numbering::of(world);
        let other = |index: &u32| numbering.other(contacts[*index as usize].other);
        let is_pair = |index: &u32| other(index).grain().is_some();
        let all = 0..contacts.len() as u32;
        let fixed = all.clone().filter(|index| !is_pair(index));
        let pairs = all.filter(is_pair);
        let ordering = settings.method.info().order.of_rows(settings.ordering);
        let [of_fixed, of_pairs] = &mut self.groups;
        let rows = &mut self.contact_of_row;
        rows.clear();
        self.sorter.begin(ordering, world);
        self.sorter.append(ordering, (world, contacts), fixed, rows, of_fixed);
        let fixed = rows.len();
        self.sorter.append(ordering, (world, contacts), pairs, rows, of_pairs);
        fixed
    }

    /// The row of a contact by the numbers of both, with the impulses of `start` (N·s) projected on what the contact law
    /// allows now.
    #[inline(always)]
    fn row<M: Model<Kinematics = K>>(
        &self,
        world: &World,
        contacts: &ContactList,
        (at, index): (usize, usize),
        rebound: &impl Fn(Approach) -> f64,
        start: Option<Impulse>,
    ) -> Row<K> {
        let (masses, before) = (&world.grains.masses, &self.before);
        let contact = &contacts.contacts()[index];
        let (i, normal) = (contact.grain as usize, K::normal_of(world, contact));
        let (velocity, effective_mass, of_other) =
            match Numbering::of(world).other(contact.other).grain() {
                None => (K::velocity(normal, &before[i]), masses[i], 0.0),
                Some(j) => {
                    let share = masses[j] / (masses[i] + masses[j]);
                    let velocity = K::relative_velocity(normal, &before[i], &before[j]);
                    (velocity, masses[i] * share, share)
                }
            };
        let in_touch = contacts.is_in_touch(index);
        let restitution_velocity =
            rebound(Approach { velocity: velocity[0], gap: contact.gap, in_touch });
        let start = start.unwrap_or_default();
        let shifted_impulse = law::signorini(start.normal / effective_mass + self.capture(at));
        let tangential_impulse = if M::FRICTION {
            let bound = self.friction_bound::<M>(shifted_impulse);
            law::coulomb(start.tangential / effective_mass, bound)
        } else {
            0.0
        };
        Row {
            i: contact.grain,
            j: contact.other,
            normal,
            of_other,
            restitution_velocity,
            shifted_impulse,
            tangential_impulse,
            effective_mass,
        }
    }
}
