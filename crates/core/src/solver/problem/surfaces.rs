//! Surfaces that move, as the contacts of a step see them.
//!
//! **Along the normal.** Relative to a surface of speed V a grain has v_n − V. So the law's
//! v_n + ρ v_n^{n−1} becomes v_n − V + ρ (v_n^{n−1} − V): what is added to v_n is another number, and no
//! method has to know.
//!
//! **Along the tangent** the law's v_t becomes v_t − V_t, which no such number can say. A row against a fixed body
//! has room for V_t where a pair has its share of the masses, which is 1 there: a subtraction of what
//! lies in the row's own cache line is all that a sweep has to do besides, and it changes no bit where V_t = 0.
//!
//! **Work.** A grain's own velocity enters the work of its contacts (`problem::measure`), so what a surface does
//! to the grains is in theirs: P_n V + P_t V_t of it is the surface's, and the rest is lost in the contact.

use glam::DVec2;

use super::kinematics::Kinematics;
use super::model::Model;
use super::prepare::Approach;
use super::step_problem::{Row, StepProblem};
use super::surface::Surface;
use crate::contact::{Contact, ContactList};
use crate::solver::friction_model::FrictionModel;

impl<K: Kinematics> StepProblem<K> {
    /// Tells a problem that has just been prepared of surfaces that move. `rebound` is what the law adds to v_n of a
    /// contact, m/s.
    pub(crate) fn drive<M: Model<Kinematics = K>>(
        &mut self,
        contacts: &ContactList,
        rebound: impl Fn(Approach) -> f64,
        surface: impl Fn(&Contact) -> Option<Surface>,
    ) {
        let Self { fixed_rows, before, contact_of_row, wall_speeds, surfaces, driven, .. } = self;
        for (row, &index) in fixed_rows.iter_mut().zip(&*contact_of_row) {
            let contact = &contacts.contacts()[index as usize];
            // What does not rub does not mind what slides.
            let surface = surface(contact).map(|surface| match M::FRICTION {
                true => surface,
                false => surface.smooth(),
            });
            let [speed, slide] = surface.map_or([0.0; 2], |surface| surface.along(contact.normal));
            row.of_other = slide;
            let [velocity, _] = K::velocity(row.normal, &before[row.i as usize]);
            let in_touch = contacts.is_in_touch(index as usize);
            let approach = Approach { velocity: velocity - speed, gap: contact.gap, in_touch };
            row.restitution_velocity = rebound(approach) - speed;
            wall_speeds.push(speed);
            let added = [row.restitution_velocity, row.of_other];
            driven.add(surface.and_then(|surface| surface.driven), speed, added);
            surfaces.push(surface);
        }
        if self.is_driven() {
            self.form_velocities();
        }
        // Of the models that hold something, one holds what a slip has made.
        if self.friction_model == FrictionModel::Desaxce {
            self.hold::<M>(contacts, self.friction_model);
        }
    }

    /// Gives a row, by its number, another normal; how fast its wall comes along that, m/s.
    pub(crate) fn turn_row(&mut self, number: usize, normal: DVec2) -> f64 {
        let surface = self.surfaces.get(number).copied().flatten();
        let row = self.row_at_mut(number);
        row.normal = K::sliding(K::normal(normal.to_array()), K::slide(row.normal));
        let Some(surface) = surface else { return 0.0 };
        let [speed, slide] = surface.along(normal);
        row.of_other = slide;
        self.wall_speeds[number] = speed;
        speed
    }

    /// How fast the wall of a row comes, by the row's number (fixed rows, then pair rows), m/s.
    #[inline(always)]
    pub fn wall_speed(&self, number: usize) -> f64 {
        self.wall_speeds.get(number).copied().unwrap_or(0.0)
    }

    /// How fast the surfaces behind all rows go along t, m/s: 0 between grains; none where no surface moves.
    pub fn surface_speeds(&self) -> Vec<f64> {
        if !self.has_moving_walls() {
            return Vec::new();
        }
        let of_fixed = self.fixed_rows.iter().map(Row::surface_speed);
        of_fixed.chain(self.pair_rows.iter().map(|_| 0.0)).collect()
    }

    /// Whether any surface may move.
    pub(crate) fn has_moving_walls(&self) -> bool {
        !self.wall_speeds.is_empty()
    }

    /// The velocity of the fixed shape of a row that touches along a normal, m/s, as far as it shows in the gap.
    pub(crate) fn shape_velocity(&self, number: usize, normal: DVec2) -> DVec2 {
        match self.surfaces.get(number) {
            Some(Some(surface)) if !surface.is_half_space => surface.velocity,
            _ => self.wall_speed(number) * normal,
        }
    }

    /// The work, J, that moving surfaces do by the rows' impulses; and the part of it along the tangents, which the
    /// rows' own velocities, being relative, leave out.
    pub(crate) fn surface_works(&self) -> [f64; 2] {
        let [whole, along_tangents] = self.surface_works_of(self, |number| number);
        // Rows tell of driven walls as they go at the end.
        let surplus = if self.is_driven() { self.surplus_of_driven_walls() } else { 0.0 };
        [whole - surplus, along_tangents]
    }

    /// The same of a part of this problem's rows, whose row k is row `contact_of_row()[k]` here.
    pub(crate) fn surface_works_in(&self, part: &Self) -> [f64; 2] {
        self.surface_works_of(part, |number| part.contact_of_row[number] as usize)
    }

    fn surface_works_of(&self, part: &Self, number_here: impl Fn(usize) -> usize) -> [f64; 2] {
        let (mut whole, mut along_tangents) = (0.0, 0.0);
        for (number, row) in part.fixed_rows.iter().enumerate() {
            let [normal, tangential] = part.reduced_impulse(number, row);
            let along_tangent = row.effective_mass * tangential * row.surface_speed();
            let speed = self.wall_speed(number_here(number));
            whole += row.effective_mass * normal * speed + along_tangent;
            along_tangents += along_tangent;
        }
        [whole, along_tangents]
    }

    /// Every row, to be changed, with how fast its wall comes, m/s: 0 where that does not move.
    pub(crate) fn rows_with_walls(&mut self) -> impl Iterator<Item = (&mut Row<K>, f64)> {
        let Self { fixed_rows, pair_rows, wall_speeds, .. } = self;
        let walls = wall_speeds.iter().copied().chain(std::iter::repeat(0.0));
        fixed_rows.iter_mut().chain(pair_rows).zip(walls)
    }
}
