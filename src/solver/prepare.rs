//! How a step's problem is set up: what the bodies do by themselves, which row comes when, and what the
//! law adds to each contact's velocity.

use super::{Kinematics, Model, Row, SolverSettings, StepProblem};
use crate::contact::range::TOUCH_IN_DIAMETERS;
use crate::contact::{Contact, ContactList, Impulse, law};
use crate::world::{ContactLaw, Parameters, World};

impl<K: Kinematics> StepProblem<K> {
    /// Sets up the step: free velocities, and rows in the settings' order that carry the impulses of
    /// `contacts` (warm start) or none. `cohesion` tells whether the scene has any.
    pub fn prepare<M: Model<Kinematics = K>>(
        &mut self,
        world: &World,
        contacts: &ContactList,
        parameters: &Parameters,
        cohesion: bool,
        settings: &SolverSettings,
    ) {
        let grains = &world.grains;
        let gravity_magnitude = world.gravity.magnitude();
        self.friction = parameters.friction;
        self.capture_speed =
            if cohesion { parameters.capture_speed(gravity_magnitude) } else { 0.0 };
        self.captures.clear();
        self.wall_speeds.clear();
        self.mean_mass = grains.masses.iter().sum::<f64>() / grains.len() as f64;
        self.masses.clone_from(&grains.masses);
        self.before.clear();
        self.free.clear();
        for index in 0..grains.len() {
            let body = K::body(world, index);
            self.before.push(body);
            self.free.push(if grains.feels_gravity[index] {
                K::accelerated(&body, world, index, parameters.time_step_secs)
            } else {
                body
            });
        }
        let list = contacts.contacts();
        let against_grain = |index: &u32| (list[*index as usize].other as usize) < grains.len();
        let all = 0..list.len() as u32;
        let fixed = all.clone().filter(|index| !against_grain(index));
        let pairs = all.filter(against_grain);
        let ordering = settings.method.ordering(settings.ordering);
        let [fixed_ends, pair_ends] = &mut self.colouring.ends;
        let rows = &mut self.contact_of_row;
        rows.clear();
        self.sorter.append(ordering, (world, list), fixed, rows, fixed_ends);
        let fixed_count = rows.len();
        self.sorter.append(ordering, (world, list), pairs, rows, pair_ends);

        let rebound = |velocity: f64, index: u32, contact: &Contact| {
            let in_touch = contacts.is_in_touch(index as usize);
            rebound(world, parameters, velocity, contact.gap, in_touch)
        };
        if contacts.looks_ahead() && self.capture_speed > 0.0 {
            let capture = |&index: &u32| match contacts.is_in_touch(index as usize) {
                true => self.capture_speed,
                false => 0.0,
            };
            self.captures.extend(self.contact_of_row.iter().map(capture));
        }
        let start = |index: u32| settings.warm_start.then(|| contacts.impulses()[index as usize]);
        self.fixed_rows.clear();
        for at in 0..fixed_count {
            let index = self.contact_of_row[at];
            let contact = &list[index as usize];
            let i = contact.grain as usize;
            let [velocity, _] = K::velocity(K::normal(contact.normal.to_array()), &self.before[i]);
            let masses = (grains.masses[i], 1.0);
            let velocity = rebound(velocity, index, contact);
            let row = self.row::<M>(contact, masses, velocity, self.capture(at), start(index));
            self.fixed_rows.push(row);
        }
        self.pair_rows.clear();
        for at in fixed_count..self.contact_of_row.len() {
            let index = self.contact_of_row[at];
            let contact = &list[index as usize];
            let (i, j) = (contact.grain as usize, contact.other as usize);
            let (before_i, before_j) = (&self.before[i], &self.before[j]);
            let [velocity, _] =
                K::relative_velocity(K::normal(contact.normal.to_array()), before_i, before_j);
            let share = grains.masses[j] / (grains.masses[i] + grains.masses[j]);
            let masses = (grains.masses[i] * share, share);
            let velocity = rebound(velocity, index, contact);
            let row = self.row::<M>(contact, masses, velocity, self.capture(at), start(index));
            self.pair_rows.push(row);
        }
        self.form_velocities();
    }

    /// One row, with the impulses of `start` (N·s) projected on what the contact law allows now.
    fn row<M: Model<Kinematics = K>>(
        &self,
        contact: &Contact,
        (effective_mass, share): (f64, f64),
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
            normal: K::normal(contact.normal.to_array()),
            share,
            restitution_velocity,
            shifted_impulse,
            tangential_impulse,
            effective_mass,
        }
    }

    /// Tells a problem that has just been prepared of walls that move along their normal: `speed` gives
    /// how fast the wall of a contact comes, m/s.
    ///
    /// Relative to a wall of speed V a grain has v_n − V and, since the wall is a plane, the same v_t
    /// as ever. So the law's v_n + ρ v_n^{n−1} becomes v_n − V + ρ (v_n^{n−1} − V): what is added to v_n
    /// is another number, and no method has to know.
    pub fn drive(
        &mut self,
        world: &World,
        contacts: &ContactList,
        parameters: &Parameters,
        speed: impl Fn(&Contact) -> f64,
    ) {
        let Self { fixed_rows, before, contact_of_row, wall_speeds, .. } = self;
        for (row, &index) in fixed_rows.iter_mut().zip(&*contact_of_row) {
            let contact = &contacts.contacts()[index as usize];
            let speed = speed(contact);
            let [velocity, _] = K::velocity(row.normal, &before[row.i as usize]);
            let in_touch = contacts.is_in_touch(index as usize);
            let rebound = rebound(world, parameters, velocity - speed, contact.gap, in_touch);
            row.restitution_velocity = rebound - speed;
            wall_speeds.push(speed);
        }
    }

    /// How fast the wall of a row comes, by the row's number (fixed rows, then pair rows), m/s.
    #[inline(always)]
    pub fn wall_speed(&self, number: usize) -> f64 {
        self.wall_speeds.get(number).copied().unwrap_or(0.0)
    }
}

/// What the law adds to v_n, m/s, where it was `velocity` before the step, the gap is `gap` (m), and
/// the pair is known to touch or not.
#[inline(always)]
fn rebound(world: &World, parameters: &Parameters, velocity: f64, gap: f64, in_touch: bool) -> f64 {
    let gravity_magnitude = world.gravity.magnitude();
    let touch = TOUCH_IN_DIAMETERS * world.mean_diameter;
    if parameters.law != ContactLaw::Range {
        if in_touch {
            return parameters.restitution_velocity(velocity, gravity_magnitude);
        }
        // It lands in touch, so that the next step knows it.
        return (gap + touch) / parameters.time_step_secs;
    }
    // A gap must not close by more than itself. Bounces are part of the shocks (`sim::shocks`).
    (gap - touch).max(0.0) / parameters.time_step_secs
}
