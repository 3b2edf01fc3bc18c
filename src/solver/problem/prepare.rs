//! How a step's problem is set up: what the bodies do by themselves, which row comes when, and what the
//! law adds to each contact's velocity.

use super::kinematics::Kinematics;
use super::model::Model;
use super::step_problem::{Row, StepProblem};
use crate::contact::{Contact, ContactList, Impulse, Numbering, law};
use crate::solver::settings::SolverSettings;
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
        rebound: impl Fn(Approach) -> f64,
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
        let numbering = Numbering::of(world);
        self.order_rows(world, contacts.contacts(), settings);
        if contacts.looks_ahead() && self.capture_speed > 0.0 {
            let capture = |&index: &u32| match contacts.is_in_touch(index as usize) {
                true => self.capture_speed,
                false => 0.0,
            };
            self.captures.extend(self.contact_of_row.iter().map(capture));
        }
        self.fixed_rows.clear();
        self.pair_rows.clear();
        for at in 0..self.contact_of_row.len() {
            let index = self.contact_of_row[at] as usize;
            let contact = &contacts.contacts()[index];
            let (i, normal) = (contact.grain as usize, K::normal_of(world, contact));
            let j = numbering.other(contact.other).grain();
            let ([velocity, _], mass, of_other) = match j {
                None => (K::velocity(normal, &self.before[i]), grains.masses[i], 0.0),
                Some(j) => {
                    let share = grains.masses[j] / (grains.masses[i] + grains.masses[j]);
                    let velocity = K::relative_velocity(normal, &self.before[i], &self.before[j]);
                    (velocity, grains.masses[i] * share, share)
                }
            };
            let in_touch = contacts.is_in_touch(index);
            let rebound = rebound(Approach { velocity, gap: contact.gap, in_touch });
            let start = settings.warm_start.then(|| contacts.impulses()[index]);
            let (known, capture) = ((contact, normal), self.capture(at));
            let row = self.row::<M>(known, (mass, of_other), rebound, capture, start);
            match j {
                None => self.fixed_rows.push(row),
                Some(_) => self.pair_rows.push(row),
            }
        }
        self.form_velocities();
        self.hold::<M>(contacts, settings.friction_model);
    }

    /// Packs the bodies as they are, and as gravity alone would leave them.
    fn place_bodies(&mut self, world: &World, time_step_secs: f64) {
        self.before.clear();
        self.free.clear();
        for (index, &feels_gravity) in world.grains.feels_gravity.iter().enumerate() {
            let body = K::body(world, index);
            self.before.push(body);
            self.free.push(if feels_gravity {
                K::accelerated(&body, world, index, time_step_secs)
            } else {
                body
            });
        }
    }

    /// Tells which contact stands behind which row.
    fn order_rows(&mut self, world: &World, contacts: &[Contact], settings: &SolverSettings) {
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
        self.sorter.append(ordering, (world, contacts), pairs, rows, of_pairs);
    }

    /// One row, with the impulses of `start` (N·s) projected on what the contact law allows now.
    fn row<M: Model<Kinematics = K>>(
        &self,
        (contact, normal): (&Contact, K::Normal<f64>),
        (effective_mass, of_other): (f64, f64),
        restitution_velocity: f64,
        capture_speed: f64,
        start: Option<Impulse>,
    ) -> Row<K> {
        let start = start.unwrap_or_default();
        let normal_impulse = start.normal / effective_mass;
        let shifted_impulse = law::signorini(normal_impulse + capture_speed);
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
