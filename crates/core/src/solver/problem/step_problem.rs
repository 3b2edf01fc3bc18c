//! The problem of one step: packed bodies and one row a contact, in the order of the sweep.

use glam::DVec2;

use super::driven::Driven;
use super::groups::Groups;
use super::kinematics::Kinematics;
use super::model::Model;
use super::order::Sorter;
use super::surface::Surface;
use crate::contact::{Contact, ContactList, Impulse, Numbering, Other};
use crate::solver::friction_model::FrictionModel;

/// One contact as the sweep sees it: exactly one cache line in the plane. Impulses are reduced ones,
/// λ = P/m_ij (see `problem::kinematics` and `contact::law`).
///
/// Array of structures was measured against structure of arrays before it was chosen
/// (`cargo bench --bench layout`). Plain data: a problem shows its rows and takes none.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Row<K: Kinematics> {
    /// Grain i.
    pub i: u32,
    /// Grain j; unused in a row against a fixed body.
    pub j: u32,
    /// n, from j to i.
    pub normal: K::Normal<f64>,
    /// Of a pair g_i = m_ij/m_i ([`Row::share`]). Against a fixed body, where that is 1, how fast the body's
    /// surface goes along t, m/s ([`Row::surface_speed`]): the law's v_t is relative to it.
    pub of_other: f64,
    /// What is added to v_n in the contact law, m/s: ρ v_n^{n−1}, or 0 below the threshold, and less
    /// the speed of a wall that comes (`problem::surfaces`).
    pub restitution_velocity: f64,
    /// σ = λ_n + capture speed, m/s.
    pub shifted_impulse: f64,
    /// λ_t, m/s.
    pub tangential_impulse: f64,
    /// m_ij, kg.
    pub effective_mass: f64,
}

impl<K: Kinematics> Row<K> {
    /// g_i of a pair.
    #[inline(always)]
    pub fn share(&self) -> f64 {
        self.of_other
    }

    /// How fast the surface of the fixed body goes along t, m/s.
    #[inline(always)]
    pub fn surface_speed(&self) -> f64 {
        self.of_other
    }

    /// (v_n, v_t) of grain i against a fixed body, m/s: v_t relative to the body's surface, v_n to a body at rest,
    /// since the speed of a wall that comes is in `restitution_velocity`.
    #[inline(always)]
    pub fn velocity(&self, i: &K::Body<f64>) -> [f64; 2] {
        let [normal, tangential] = K::velocity(self.normal, i);
        [normal, tangential - self.surface_speed()]
    }
}

/// All contacts of one step. Memory is kept between steps.
///
/// Rows are in the order of the sweep (`problem::order`): first the contacts with fixed bodies, then
/// those between grains. From outside a problem can be looked at; its impulses are changed by the
/// methods, and by one of your own through [`BodySystem`](crate::solver::BodySystem), which keeps bodies
/// and rows in step.
#[derive(Clone, Debug)]
pub struct StepProblem<K: Kinematics> {
    /// Bodies as the sweep moves them.
    pub bodies: Vec<K::Body<f64>>,
    /// Bodies at the beginning of the step.
    pub before: Vec<K::Body<f64>>,
    /// Bodies at the end of the step if no contact acted.
    pub free: Vec<K::Body<f64>>,
    /// Rows against fixed bodies.
    pub fixed_rows: Vec<Row<K>>,
    /// Rows between grains.
    pub pair_rows: Vec<Row<K>>,
    /// The contact behind each row: fixed rows, then pair rows.
    pub contact_of_row: Vec<u32>,
    /// μ.
    pub friction: f64,
    /// C₀Δt/m_ij = Bond·g·Δt, m/s; 0 in a scene without cohesion.
    pub capture_speed: f64,
    /// The same row by row, where rows differ in it (law `range`); else empty. Sweeps need it not:
    /// they see σ alone.
    pub captures: Vec<f64>,
    /// How fast the wall of each fixed row comes along the normal, m/s; empty where no wall moves.
    pub(crate) wall_speeds: Vec<f64>,
    /// How the surface behind each of these goes, if it moves.
    pub(super) surfaces: Vec<Option<Surface>>,
    /// Walls that a force drives.
    pub(crate) driven: Driven,
    /// What is asked of friction.
    pub(crate) friction_model: FrictionModel,
    /// What the model holds row by row as the step begins, m/s (`problem::held`); empty under Coulomb's law.
    pub(crate) held_at_start: Vec<f64>,
    /// The same in the last solve.
    pub(crate) held: Vec<f64>,
    /// Masses of the bodies, kg.
    pub masses: Vec<f64>,
    /// Mean mass of the grains, kg.
    pub mean_mass: f64,
    /// Which rows against fixed bodies, and which between grains, can be solved at the same time; empty
    /// where rows are not coloured.
    pub(crate) groups: [Groups; 2],
    pub(super) sorter: Sorter,
}

impl<K: Kinematics> Default for StepProblem<K> {
    fn default() -> Self {
        Self {
            bodies: Vec::new(),
            before: Vec::new(),
            free: Vec::new(),
            fixed_rows: Vec::new(),
            pair_rows: Vec::new(),
            contact_of_row: Vec::new(),
            friction: 0.0,
            capture_speed: 0.0,
            captures: Vec::new(),
            wall_speeds: Vec::new(),
            surfaces: Vec::new(),
            driven: Driven::default(),
            friction_model: FrictionModel::Coulomb,
            held_at_start: Vec::new(),
            held: Vec::new(),
            masses: Vec::new(),
            mean_mass: 0.0,
            groups: Default::default(),
            sorter: Sorter::default(),
        }
    }
}

impl<K: Kinematics> StepProblem<K> {
    /// Bodies as the rows' impulses move them, one a grain.
    pub fn bodies(&self) -> &[K::Body<f64>] {
        &self.bodies
    }

    /// Bodies at the end of the step if no contact acted, one a grain.
    pub fn free_bodies(&self) -> &[K::Body<f64>] {
        &self.free
    }

    /// Rows against fixed bodies.
    pub fn fixed_rows(&self) -> &[Row<K>] {
        &self.fixed_rows
    }

    /// Rows between grains.
    pub fn pair_rows(&self) -> &[Row<K>] {
        &self.pair_rows
    }

    /// The contact behind each row: fixed rows, then pair rows.
    pub fn contact_of_row(&self) -> &[u32] {
        &self.contact_of_row
    }

    /// μ.
    pub fn friction(&self) -> f64 {
        self.friction
    }

    /// Moves the bodies from their free velocities by the rows' impulses.
    pub fn form_velocities(&mut self) {
        self.bodies.clone_from(&self.free);
        for (at, row) in self.fixed_rows.iter().enumerate() {
            let impulse = self.reduced_impulse(at, row);
            K::push_single(&mut self.bodies[row.i as usize], row.normal, impulse);
        }
        for (at, row) in (self.fixed_rows.len()..).zip(&self.pair_rows) {
            let impulse = self.reduced_impulse(at, row);
            let (mut i, mut j) = (self.bodies[row.i as usize], self.bodies[row.j as usize]);
            K::push_pair(&mut i, &mut j, row.normal, impulse, row.share());
            self.bodies[row.i as usize] = i;
            self.bodies[row.j as usize] = j;
        }
        if self.is_driven() {
            self.form_wall_velocities();
        }
    }

    /// Puts rows that were not made by [`StepProblem::prepare`] in the order of colours, for the
    /// method that needs it.
    pub fn sort_by_colours(&mut self) {
        let Self { fixed_rows, pair_rows, contact_of_row, groups, sorter, .. } = self;
        let contact = |row: &Row<K>, other: u32| Contact {
            grain: row.i,
            other,
            normal: DVec2::ZERO,
            gap: 0.0,
        };
        let fixed_body = Numbering::of_grains(self.masses.len()).number(Other::Feature(0));
        let contacts: Vec<Contact> = fixed_rows
            .iter()
            .map(|row| contact(row, fixed_body))
            .chain(pair_rows.iter().map(|row| contact(row, row.j)))
            .collect();
        let [of_fixed, of_pairs] = groups;
        let (fixed, all) = (fixed_rows.len() as u32, contacts.len() as u32);
        let mut order = Vec::with_capacity(contacts.len());
        let list = (self.masses.len(), &contacts[..]);
        sorter.append_coloured(list, 0..fixed, &mut order, of_fixed);
        sorter.append_coloured(list, fixed..all, &mut order, of_pairs);
        let (of_fixed, of_pairs) = order.split_at(fixed as usize);
        *fixed_rows = of_fixed.iter().map(|&row| fixed_rows[row as usize]).collect();
        *pair_rows = of_pairs.iter().map(|&row| pair_rows[(row - fixed) as usize]).collect();
        *contact_of_row = order.iter().map(|&row| contact_of_row[row as usize]).collect();
    }

    /// The capture speed of a row by its number (fixed rows, then pair rows), m/s.
    #[inline(always)]
    pub fn capture(&self, number: usize) -> f64 {
        if self.captures.is_empty() { self.capture_speed } else { self.captures[number] }
    }

    /// (λ_n, λ_t) of a row with its number, m/s.
    #[inline(always)]
    pub fn reduced_impulse(&self, number: usize, row: &Row<K>) -> [f64; 2] {
        [row.shifted_impulse - self.capture(number), row.tangential_impulse]
    }

    /// The rows with their numbers: fixed rows, then pair rows.
    pub fn rows(&self) -> impl Iterator<Item = (usize, &Row<K>)> {
        self.fixed_rows.iter().chain(&self.pair_rows).enumerate()
    }

    /// A row by its number (fixed rows, then pair rows).
    pub(crate) fn row_at(&self, number: usize) -> &Row<K> {
        let fixed = self.fixed_rows.len();
        if number < fixed { &self.fixed_rows[number] } else { &self.pair_rows[number - fixed] }
    }

    /// The same, to be changed.
    pub(crate) fn row_at_mut(&mut self, number: usize) -> &mut Row<K> {
        let fixed = self.fixed_rows.len();
        if number < fixed {
            &mut self.fixed_rows[number]
        } else {
            &mut self.pair_rows[number - fixed]
        }
    }

    /// Visits the rows, fixed rows first, with (v_n, v_t) among these bodies, m/s; v_t relative to surfaces that
    /// move.
    #[inline(always)]
    pub(crate) fn for_each_velocity(
        &self,
        bodies: &[K::Body<f64>],
        mut visit: impl FnMut(&Row<K>, [f64; 2]),
    ) {
        for row in &self.fixed_rows {
            visit(row, row.velocity(&bodies[row.i as usize]));
        }
        for row in &self.pair_rows {
            let (i, j) = (&bodies[row.i as usize], &bodies[row.j as usize]);
            visit(row, K::relative_velocity(row.normal, i, j));
        }
    }

    /// The largest |λ_t| that a shifted normal impulse allows, m/s.
    #[inline(always)]
    pub fn friction_bound<M: Model>(&self, shifted_impulse: f64) -> f64 {
        M::friction_bound(self.friction, shifted_impulse, self.capture_speed)
    }

    /// Hands the rows' impulses back to the contacts, in N·s.
    pub(crate) fn store_impulses(&self, contacts: &mut ContactList) {
        let impulses = contacts.impulses_mut();
        for ((number, row), &index) in self.rows().zip(&self.contact_of_row) {
            let [normal, tangential] = self.reduced_impulse(number, row);
            let mass = row.effective_mass;
            impulses[index as usize] =
                Impulse { normal: mass * normal, tangential: mass * tangential };
        }
    }

    /// Gives the rows the impulses of a step that was taken in another way, one a contact, N·s.
    pub(crate) fn set_impulses(&mut self, impulses: &[Impulse]) {
        let Self { fixed_rows, pair_rows, contact_of_row, capture_speed, captures, .. } = self;
        let rows = fixed_rows.iter_mut().chain(pair_rows).enumerate();
        for ((number, row), &index) in rows.zip(&*contact_of_row) {
            let Impulse { normal, tangential } = impulses[index as usize];
            let capture_speed = captures.get(number).unwrap_or(capture_speed);
            row.shifted_impulse = normal / row.effective_mass + capture_speed;
            row.tangential_impulse = tangential / row.effective_mass;
        }
    }
}
