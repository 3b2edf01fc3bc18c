//! The contact problem of one step (find impulses that satisfy the laws of all contacts): its data, its set-up, and the
//! measures of its solution.
//!
//! [`StepProblem::prepare`] sets up a problem in this order: bodies, rows (the data of one contact each) in the order
//! of the sweep, moving surfaces, the velocities due to the initial impulses, and last, for a convex friction model,
//! the number that it keeps fixed at each contact: a friction bound, or an opening speed (an estimate of the speed at
//! which the model would otherwise let a sliding contact open).

mod friction;
mod measures;
mod order;
mod residual;
mod rolling;
mod rolling_rows;
mod row_velocities;
mod rows;
mod solved;
mod velocity_error;
mod walls;

use glam::DVec2;

pub(crate) use self::friction::{
    BoundedFriction, ConeFriction, CoulombFriction, FrictionProjection, LaggedFriction,
    project_by_coulomb, with_projection,
};
pub use self::measures::{Measures, measure, worst};
use self::order::RowOrder;
pub use self::residual::residual;
pub(crate) use self::residual::{
    errors, natural_map, projection_residual, residual_of, squared_impulse, squared_residual_scale,
};
pub use self::rolling::Rolling;
pub use self::row_velocities::{RowVelocities, for_each_row, relative_velocities};
pub(crate) use self::rows::law_of_row;
pub use self::rows::{Bodies, ContactRows, FixedRow, PairRow, Row};
pub(crate) use self::solved::{is_solved, squared_impulses};
pub use self::velocity_error::{VelocityError, velocity_error};
pub(crate) use self::walls::MovingWalls;
pub use self::walls::{DrivenBy, DrivenRow, DrivenWall, MovingSurfaces, Surface};
use super::kinematics::Model;
use super::settings::{FrictionModel, SolverSettings};
use crate::contact::{
    Contact, ContactLaw, ContactList, Impulse, Numbering, Other, RowNumbers, law,
};
use crate::number::Parts;
use crate::threads;
use crate::world::{FrictionCone, World};

/// The contact problem of one step, including its present impulses. The memory is reused for the next step.
///
/// Code outside this crate can read a problem. Only methods change its impulses: the methods of this crate, or a method
/// of your own through [`BodySystem`](crate::solver::BodySystem), which keeps bodies and rows consistent.
#[derive(Clone, Debug, Default)]
pub struct StepProblem<M: Model> {
    /// The grains, with three velocities each: before the step, after the step without contacts, and with the present
    /// contact impulses.
    pub bodies: Bodies<M>,
    /// The data of the contacts, one row per contact.
    pub rows: ContactRows<M>,
    /// The contact law that all contacts share. Contacts with their own friction coefficient and capture speed (the
    /// opening speed that cohesion cancels in one step) modify it ([`StepProblem::law_of`]).
    pub law: ContactLaw,
    /// Moving surfaces of walls and other bodies that are not grains, and walls that a force drives.
    pub(crate) walls: MovingWalls,
    /// The friction model, and for each contact the number, m/s, that the model keeps fixed during a solve: a friction
    /// bound, or an opening speed that is added to the normal velocity.
    pub(crate) friction: LaggedFriction,
    /// Speed to which velocity errors are compared, m/s: √(g d), the speed after a fall by half a mean diameter d in
    /// the gravity g. Without gravity the acceleration by cohesion, C₀/m_ij (cohesion force divided by effective mass),
    /// replaces g.
    pub(crate) fall_speed: f64,
    /// True for each grain that has contacts; empty if all grains have contacts.
    pub(super) touches: Vec<bool>,
    /// Total mass of the grains that have contacts, kg.
    pub(super) touching_mass: f64,
    /// Longest side of the bounding box of the grains with contacts, in mean diameters; 0 if the problem was not set up
    /// by [`StepProblem::prepare`], so that positions are not known.
    pub(super) extent: f64,
    /// Unit vector along the sum of the normals of all contacts with fixed bodies: the mean direction away from these
    /// bodies; 0 if the sum is 0.
    pub(super) way_out: DVec2,
    pub(super) order: RowOrder,
    /// √m_ij, the square root of each contact's effective mass, kg^½, for methods whose unknowns are impulses divided
    /// by √m_ij and velocities multiplied by √m_ij ([`BodySystem`](crate::solver::BodySystem)).
    pub(super) root_masses: Vec<f64>,
}

/// The parameters that a step's contact problem is set up with.
#[derive(Clone, Copy, Debug)]
pub struct ProblemNumbers {
    /// Time step Δt, s.
    pub time_step_secs: f64,
    /// Friction coefficient μ; if contacts have their own coefficients ([`RowNumbers`]), the largest coefficient of all
    /// pairs of materials.
    pub friction: f64,
    /// Coefficient of rolling friction μ_r; if contacts have their own coefficients ([`RowNumbers`]), the largest
    /// coefficient of all pairs of materials.
    pub rolling_friction: f64,
    /// Capture speed C₀Δt/m_ij (cohesion force times time step, divided by effective mass), m/s: the opening speed that
    /// cohesion cancels in one step; 0 without cohesion. If contacts have their own coefficients ([`RowNumbers`]), the
    /// largest capture speed of all pairs of materials for grains of the mean mass.
    pub capture_speed: f64,
    /// Friction cone: the bound of friction, which is μ (N + C₀) in the shifted cone and μ max(N, 0) in the compressive
    /// cone (μ: friction coefficient, N: normal force, C₀: cohesion force). Without cohesion both bounds are the same,
    /// and this is the shifted cone.
    pub cone: FrictionCone,
}

/// Function that returns the coefficients of the contact law for a contact with an effective mass m_ij in kg.
pub type NumbersOfContact<'a> = &'a dyn Fn(&Contact, f64) -> RowNumbers;

/// State of a contact before the step, from which the contact law computes its restitution term: normal velocity, gap
/// and coefficient of restitution.
#[derive(Clone, Copy, Debug)]
pub struct Approach {
    /// Normal velocity v_n^{n−1} of the contact at the beginning of the step, relative to the wall if the wall moves,
    /// m/s.
    pub velocity: f64,
    /// Gap between the two bodies, m; a negative gap is an overlap.
    pub gap: f64,
    /// True if the pair touches or is bonded, false if it is only close enough to be detected.
    pub in_touch: bool,
    /// Coefficient of restitution ρ of the contact's pair of materials, if pairs of materials have their own
    /// coefficients.
    pub restitution: Option<f64>,
}

impl<M: Model> StepProblem<M> {
    /// Sets up the contact problem of a step: velocities without contact impulses, and rows (the data of one contact
    /// each) in the order that the method and its settings need. The initial impulses are the impulses of `contacts`
    /// (warm start) or zero. `rebound` returns the term, m/s, that the law adds to the normal velocity of a contact.
    /// `surfaces` are the moving surfaces, if there are any. `numbers_of` returns the coefficients of a contact's law,
    /// if contacts have different coefficients.
    #[expect(clippy::too_many_arguments, reason = "all of a step's problem")]
    pub fn prepare(
        &mut self,
        world: &World,
        contacts: &ContactList,
        numbers: ProblemNumbers,
        settings: &SolverSettings,
        rebound: impl Fn(Approach) -> f64 + Sync,
        surfaces: Option<MovingSurfaces<'_>>,
        numbers_of: Option<NumbersOfContact<'_>>,
    ) {
        let ProblemNumbers { time_step_secs, friction, rolling_friction, capture_speed, cone } =
            numbers;
        self.law = ContactLaw::new(friction, capture_speed, cone);
        // Without gravity, cohesion sets the scale of velocity errors. Without gravity and cohesion the scale is 0.
        let acceleration = match world.gravity.magnitude() {
            0.0 => capture_speed / time_step_secs,
            gravity => gravity,
        };
        self.fall_speed = (acceleration * world.mean_diameter).sqrt();
        self.walls.clear();
        self.place_bodies(world, time_step_secs);
        let ordering = settings.method.info().order.of_rows(settings.ordering);
        let fixed = self.order.sort(ordering, world, contacts.contacts(), &mut self.rows.contacts);
        let ContactRows { captures, frictions, restitutions, .. } = &mut self.rows;
        [captures, frictions, restitutions].into_iter().for_each(Vec::clear);
        if let Some(numbers_of) = numbers_of {
            self.take_numbers(world, contacts, numbers_of, time_step_secs);
        } else if contacts.looks_ahead() && capture_speed > 0.0 {
            let in_touch = |&index: &u32| contacts.is_in_touch(index as usize);
            let capture = |index| if in_touch(index) { capture_speed } else { 0.0 };
            self.rows.captures.extend(self.rows.contacts.iter().map(capture));
        }
        self.fill_rows(world, contacts, fixed, settings.warm_start, &rebound);
        self.fill_rolling(world, contacts, (rolling_friction, numbers_of), settings.warm_start);
        self.find_what_touches();
        self.find_extent(world);
        if let Some(surfaces) = surfaces {
            self.turn_surfaces(contacts.contacts(), &surfaces);
            self.add_surfaces(contacts, &rebound, surfaces);
        }
        self.form_velocities();
        self.begin_friction(settings.friction_model);
    }

    /// Records the coefficients of each contact's law: friction, restitution and capture speed (the opening speed that
    /// cohesion cancels in one step, m/s). The capture speed is 0 for a pair of bodies that does not touch yet.
    fn take_numbers(
        &mut self,
        world: &World,
        list: &ContactList,
        numbers_of: NumbersOfContact<'_>,
        time_step_secs: f64,
    ) {
        let ContactRows { contacts, captures, frictions, restitutions, .. } = &mut self.rows;
        let masses = &world.grains.masses;
        for index in contacts.iter().map(|&index| index as usize) {
            let contact = &list.contacts()[index];
            let mass = masses[contact.grain as usize];
            // Body indices count the grains first. So the index of a fixed body is past the end of the list of masses.
            let other = masses.get(contact.other as usize);
            let effective_mass = other.map_or(mass, |other| mass * (other / (mass + other)));
            let numbers = numbers_of(contact, effective_mass);
            frictions.push(numbers.friction);
            restitutions.push(numbers.restitution);
            let capture_speed = numbers.cohesion_per_mass * time_step_secs;
            captures.push(if list.is_in_touch(index) { capture_speed } else { 0.0 });
        }
    }

    /// Stores the grains' velocities at the beginning of the step, and their velocities at its end under gravity
    /// without contacts.
    fn place_bodies(&mut self, world: &World, time_step_secs: f64) {
        let grains = &world.grains;
        let Bodies { before, free, masses, mean_mass, .. } = &mut self.bodies;
        *mean_mass = grains.masses.iter().sum::<f64>() / grains.len() as f64;
        masses.clone_from(&grains.masses);
        threads::fill(before, grains.len(), |index| M::body(world, index));
        threads::fill(free, grains.len(), |index| match grains.feels_gravity[index] {
            true => M::accelerated(&before[index], world, index, time_step_secs),
            false => before[index],
        });
    }

    /// Creates the rows (the data of one contact each); the first `fixed` rows are contacts with fixed bodies.
    fn fill_rows(
        &mut self,
        world: &World,
        contacts: &ContactList,
        fixed: usize,
        warm_start: bool,
        rebound: &(impl Fn(Approach) -> f64 + Sync),
    ) {
        let mut fixed_rows = std::mem::take(&mut self.rows.fixed);
        let mut pair_rows = std::mem::take(&mut self.rows.pairs);
        let (masses, before) = (&world.grains.masses, &self.bodies.before);
        let row = |number: usize, velocity: f64, effective_mass: f64| {
            let index = self.rows.contacts[number] as usize;
            let contact = &contacts.contacts()[index];
            let restitution = self.rows.restitutions.get(number).copied();
            let in_touch = contacts.is_in_touch(index);
            let approach = Approach { velocity, gap: contact.gap, in_touch, restitution };
            let start = if warm_start { contacts.impulses()[index] } else { Impulse::default() };
            let shifted_impulse =
                law::signorini(start.normal / effective_mass + self.capture(number));
            let tangential_impulse = if M::FRICTION {
                let bound = self.law_of(number).friction_bound(shifted_impulse);
                law::coulomb(start.tangential / effective_mass, bound)
            } else {
                0.0
            };
            Row {
                i: contact.grain,
                j: contact.other,
                normal: M::normal_of(world, contact),
                restitution_velocity: rebound(approach),
                shifted_impulse,
                tangential_impulse,
                effective_mass,
            }
        };
        let contact = |number: usize| &contacts.contacts()[self.rows.contacts[number] as usize];
        threads::fill(&mut fixed_rows, fixed, |number| {
            let contact = contact(number);
            let i = contact.grain as usize;
            let [velocity, _] = M::velocity(M::normal_of(world, contact), &before[i]);
            FixedRow { row: row(number, velocity, masses[i]), surface_speed: 0.0 }
        });
        threads::fill(&mut pair_rows, self.rows.contacts.len() - fixed, |number| {
            let number = fixed + number;
            let contact = contact(number);
            // Body indices count the grains first, so both are indices of grains.
            let (i, j) = (contact.grain as usize, contact.other as usize);
            let share = masses[j] / (masses[i] + masses[j]);
            let normal = M::normal_of(world, contact);
            let [velocity, _] = M::relative_velocity(normal, &before[i], &before[j]);
            PairRow { row: row(number, velocity, masses[i] * share), share }
        });
        (self.rows.fixed, self.rows.pairs) = (fixed_rows, pair_rows);
    }

    /// Records which grains have contacts, and the total mass of these grains.
    fn find_what_touches(&mut self) {
        let Self { bodies, rows, touches, touching_mass, .. } = self;
        touches.clear();
        touches.resize(bodies.masses.len(), false);
        rows.fixed.iter().for_each(|row| touches[row.i as usize] = true);
        for row in &rows.pairs {
            touches[row.i as usize] = true;
            touches[row.j as usize] = true;
        }
        let masses = bodies.masses.iter().zip(&*touches);
        *touching_mass = masses.map(|(mass, touches)| if *touches { *mass } else { 0.0 }).sum();
    }

    /// Makes Coulomb's law the friction model: limits the tangential impulses to the friction bounds of Coulomb's law
    /// and recomputes the velocities.
    pub fn take_coulombs_law(&mut self) {
        self.friction.model = FrictionModel::Coulomb;
        self.friction.now.clear();
        if M::FRICTION {
            for number in 0..self.rows.len() {
                let law = self.law_of(number);
                let row = self.rows.get_mut(number);
                let bound = law.friction_bound(row.shifted_impulse);
                row.tangential_impulse = law::coulomb(row.tangential_impulse, bound);
            }
            self.form_velocities();
        }
    }

    /// Computes `extent`, the size of the region of the grains with contacts in mean diameters, and `way_out`, the mean
    /// direction away from the fixed bodies.
    fn find_extent(&mut self, world: &World) {
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for (&place, touches) in world.grains.positions.iter().zip(&self.touches) {
            if *touches {
                (low, high) = (low.min(place), high.max(place));
            }
        }
        let longest = (high - low).max_element().positive_part();
        self.extent = 1.0 + longest / world.mean_diameter;
        let normals = self.rows.fixed.iter().map(|row| DVec2::from(M::components(row.normal)));
        self.way_out = normals.sum::<DVec2>().normalize_or_zero();
    }

    /// Estimates the number of grains in the longest chain of touching grains: the size `extent` of the region of the
    /// grains with contacts in mean diameters, or the square root of the number of grains if `extent` is 0 because the
    /// problem was set up without positions.
    fn grains_in_a_row(&self) -> f64 {
        let grains = self.bodies.masses.len() as f64;
        if self.extent > 0.0 { self.extent.min(grains) } else { grains.sqrt() }
    }

    /// Takes from the complete problem `whole` of a step the data on which its velocity error depends: the speed scale,
    /// the grains with contacts, their mass and extent, and the direction away from fixed bodies. `self` is a problem
    /// with some of the contacts of `whole`. Afterwards the velocity errors of `self` and `whole` can be compared.
    pub(crate) fn hold_errors_against(&mut self, whole: &Self) {
        self.fall_speed = whole.fall_speed;
        self.touches.clone_from(&whole.touches);
        self.touching_mass = whole.touching_mass;
        (self.extent, self.way_out) = (whole.extent, whole.way_out);
    }

    /// Returns the total mass of the grains that have contacts, kg.
    pub(super) fn touching_mass(&self) -> f64 {
        if self.touches.is_empty() { self.bodies.masses.iter().sum() } else { self.touching_mass }
    }

    /// Sets the bodies' velocities to their velocities without contacts plus the changes due to the present impulses of
    /// all contacts.
    pub fn form_velocities(&mut self) {
        let Bodies { now, free, .. } = &mut self.bodies;
        now.clone_from(free);
        let impulse = |number: usize, row: &Row<M>| {
            let capture = self.rows.capture(number, &self.law);
            [row.shifted_impulse - capture, row.tangential_impulse]
        };
        for (number, row) in self.rows.fixed.iter().enumerate() {
            M::push_single(&mut now[row.i as usize], row.normal, impulse(number, row));
        }
        for (number, row) in (self.rows.fixed.len()..).zip(&self.rows.pairs) {
            let (mut i, mut j) = (now[row.i as usize], now[row.j as usize]);
            M::push_pair(&mut i, &mut j, row.normal, impulse(number, row), row.share);
            now[row.i as usize] = i;
            now[row.j as usize] = j;
        }
        for (number, rolling) in self.rows.rolling.iter().enumerate() {
            let (row, share) = (self.rows.get(number), self.rows.share(number));
            rolling.turn_i::<M>(&mut now[row.i as usize], share, rolling.impulse);
            if self.rows.is_pair(number) {
                rolling.turn_j::<M>(&mut now[row.j as usize], share, rolling.impulse);
            }
        }
        if self.is_driven() {
            self.form_wall_velocities();
        }
    }

    /// Sorts the contacts by colours (groups of contacts that share no grain) for the method `nsgs-parallel`. Only
    /// problems that [`StepProblem::prepare`] has not set up need this.
    pub fn sort_by_colours(&mut self) {
        let Self { rows, order, bodies, .. } = self;
        let contact = |row: &Row<M>, other: u32| Contact {
            grain: row.i,
            other,
            normal: DVec2::ZERO,
            gap: 0.0,
        };
        let grains = bodies.masses.len();
        let fixed_body = Numbering::of_grains(grains).number(Other::Feature(0));
        let fixed = rows.fixed.iter().map(|row| contact(row, fixed_body));
        let all = fixed.chain(rows.pairs.iter().map(|row| contact(row, row.j)));
        let sorted = order.sort_by_colours(grains, &all.collect::<Vec<_>>(), rows.fixed.len());
        let (of_fixed, of_pairs) = sorted.split_at(rows.fixed.len());
        let first_pair = rows.fixed.len();
        rows.fixed = of_fixed.iter().map(|&row| rows.fixed[row as usize]).collect();
        rows.pairs = of_pairs.iter().map(|&row| rows.pairs[row as usize - first_pair]).collect();
        rows.contacts = sorted.iter().map(|&row| rows.contacts[row as usize]).collect();
    }

    /// Returns the capture speed (the opening speed that cohesion cancels in one step) of the contact in row `number`,
    /// C₀Δt/m_ij (cohesion force times time step, divided by effective mass), m/s.
    #[inline(always)]
    pub fn capture(&self, number: usize) -> f64 {
        self.rows.capture(number, &self.law)
    }

    /// Returns the contact law of the contact in row `number`.
    #[inline(always)]
    pub fn law_of(&self, number: usize) -> ContactLaw {
        self.rows.law(number, &self.law)
    }

    /// Returns true if all contacts have the same friction coefficient, and this coefficient times the sum of normal
    /// impulse and cohesion impulse bounds the friction impulse. This is the law of the shifted friction cone, and of a
    /// scene without cohesion.
    pub(crate) fn has_one_simple_law(&self) -> bool {
        self.law.all_rubs() && self.rows.frictions.is_empty()
    }

    /// Returns the normal and the tangential impulse of the contact in row `number`, divided by its effective mass,
    /// m/s. The row stores the sum of the normal and the cohesion impulse; the returned normal impulse is without the
    /// cohesion impulse.
    #[inline(always)]
    pub fn reduced_impulse(&self, number: usize, row: &Row<M>) -> [f64; 2] {
        [row.shifted_impulse - self.capture(number), row.tangential_impulse]
    }

    /// Iterates over the rows (the data of the contacts) and their numbers.
    pub fn rows(&self) -> impl Iterator<Item = (usize, &Row<M>)> {
        self.rows.iter().enumerate()
    }

    /// Calls `visit` for each row (the data of one contact) in order, with the normal and tangential relative
    /// velocities (v_n, v_t) of the contact, m/s, that follow from the body velocities `bodies`. If the grain touches a
    /// moving surface, v_t is relative to that surface.
    #[inline(always)]
    pub(crate) fn for_each_velocity(
        &self,
        bodies: &[M::Body<f64>],
        mut visit: impl FnMut(&Row<M>, [f64; 2]),
    ) {
        for row in &self.rows.fixed {
            visit(row, row.velocity(bodies));
        }
        for row in &self.rows.pairs {
            visit(row, row.velocity(bodies));
        }
    }

    /// Writes the present impulses of the problem back to the list of contacts, in N·s.
    pub(crate) fn store_impulses(&self, contacts: &mut ContactList) {
        self.store_rolling(contacts);
        let impulses = contacts.impulses_mut();
        for ((number, row), &index) in self.rows().zip(&self.rows.contacts) {
            let [normal, tangential] = self.reduced_impulse(number, row);
            let mass = row.effective_mass;
            impulses[index as usize] =
                Impulse { normal: mass * normal, tangential: mass * tangential };
        }
    }

    /// Replaces the impulses of all contacts by impulses of another algorithm for the same step, N·s, in the order of
    /// the list of contacts. The velocities are not recomputed.
    pub(crate) fn set_impulses(&mut self, impulses: &[Impulse]) {
        for number in 0..self.rows.len() {
            let Impulse { normal, tangential } = impulses[self.rows.contacts[number] as usize];
            let capture_speed = self.capture(number);
            let row = self.rows.get_mut(number);
            row.shifted_impulse = normal / row.effective_mass + capture_speed;
            row.tangential_impulse = tangential / row.effective_mass;
        }
    }

    /// Sets the impulses of all contacts and recomputes the velocities. `impulses` contains a pair for each contact:
    /// normal impulse plus cohesion impulse, and tangential impulse, both divided by the effective mass, m/s. If the
    /// problem has rolling resistance, a second pair for each contact follows: the reduced rolling impulse (rolling
    /// moment times time step, divided by reduced radius and effective mass, m/s) and 0.
    pub(crate) fn write_impulses(&mut self, impulses: impl IntoIterator<Item = [f64; 2]>) {
        let mut impulses = impulses.into_iter();
        for (row, impulse) in self.rows.iter_mut().zip(&mut impulses) {
            [row.shifted_impulse, row.tangential_impulse] = impulse;
        }
        for (rolling, [impulse, _]) in self.rows.rolling.iter_mut().zip(impulses) {
            rolling.impulse = impulse;
        }
        self.form_velocities();
    }
}
