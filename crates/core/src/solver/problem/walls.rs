//! Surfaces that move, and walls that a force drives, as the contacts of a step see them.
//!
//! **Along the normal.** Relative to a surface of speed V a grain has v_n − V. So the law's
//! v_n + ρ v_n^{n−1} becomes v_n − V + ρ (v_n^{n−1} − V⁻): what is added to v_n is another number, and no
//! method has to know. V⁻ is the speed that the surface begins the step with: a grain that rests on a surface which
//! gathers speed has v_n^{n−1} = V⁻, and does not bounce.
//!
//! **Along the tangent** the law's v_t becomes v_t − V_t, which no such number can say. A row against a fixed
//! body has V_t where a pair has its share of the masses, which is 1 there. A sweep subtracts what lies in the
//! row's own cache line, which changes no bit where V_t = 0.
//!
//! **Work.** A grain's own velocity enters the work of its contacts (`problem::residual`), so what a surface does
//! to the grains is in theirs: P_n V + P_t V_t of it is the surface's, and the rest is lost in the contact.
//!
//! **Driven walls.** A wall of mass M goes along a, |a| = 1, with V under a force F and a damping c V. Its
//! contacts push it back, each by P·b with b = (a·n, a·t), so that with the damping taken at the end of the step
//!
//! > M (V − V⁻) = Δt (F − c V) − Σ P·b,  V = V_free − r Σ P·b,
//! > r = 1/(M + cΔt),  V_free = r (M V⁻ + ΔtF).
//!
//! V is as much unknown as the velocities of grains, so a wall lighter than what it presses on never swings up,
//! though its load then goes from contact to contact slowly, by M/m_i a sweep. In reduced impulses λ = P/m_i, and
//! with κ = r m_i, a contact of grain i has
//!
//! > u_n = v_n − b_n V,  ∂u_n/∂λ_n = 1 + κ b_n²,  ∂u_t/∂λ_t = m_n/m_t + κ b_t²,
//!
//! and every other contact of the wall sees V change by −κ (b_n λ_n + b_t λ_t). Rows are told of V once a sweep, so
//! that whatever reads them finds the velocities relative to the wall as it goes now.

use glam::DVec2;

use super::{Approach, Row, StepProblem};
use crate::contact::{Contact, ContactList};
use crate::solver::kinematics::Model;

/// No wall.
const NONE: u32 = u32::MAX;

/// How the surface of a fixed body goes where a contact touches it.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// The velocity of the shape there, m/s.
    pub velocity: DVec2,
    /// The velocity of the shape there as the step begins, m/s.
    pub before: DVec2,
    /// What the surface has besides along t, round the shape that stays, m/s.
    pub round: f64,
    /// True where the shape is a half-space, which looks the same wherever it goes along itself.
    pub is_half_space: bool,
    /// True where the shape goes along its normal and no other way.
    pub is_pushed: bool,
    /// What drives the shape, if a force does.
    pub driven: Option<DrivenBy>,
}

impl Surface {
    /// The same where nothing rubs.
    fn smooth(self) -> Self {
        let smooth = |by: DrivenBy| DrivenBy { along: [by.along[0], 0.0], ..by };
        Self { is_pushed: true, round: 0.0, driven: self.driven.map(smooth), ..self }
    }

    /// How fast it goes along n and t, m/s.
    #[inline]
    pub(crate) fn along(&self, normal: DVec2) -> [f64; 2] {
        let tangential = if self.is_pushed { 0.0 } else { self.velocity.dot(normal.perp()) };
        [self.velocity.dot(normal), tangential + self.round]
    }
}

/// A wall that is driven.
#[derive(Clone, Copy, Debug)]
pub struct DrivenWall {
    /// The motion of that number.
    pub motion: usize,
    /// r, 1/kg.
    pub response: f64,
    /// V⁻, m/s.
    pub before: f64,
    /// V_free, m/s.
    pub free: f64,
    /// V, m/s.
    pub now: f64,
}

/// What drives the wall of a contact, as the contact sees it.
#[derive(Clone, Copy, Debug)]
pub struct DrivenBy {
    /// The wall of that number.
    pub wall: u32,
    /// b.
    pub along: [f64; 2],
}

impl DrivenBy {
    /// P·b of an impulse along n and t, in its unit.
    #[inline(always)]
    pub(crate) fn part_along(&self, [normal, tangential]: [f64; 2]) -> f64 {
        self.along[0] * normal + self.along[1] * tangential
    }
}

/// A row against a wall that is driven.
#[derive(Clone, Copy, Debug)]
pub struct DrivenRow {
    /// Its number among those against fixed bodies.
    pub number: u32,
    /// How it hangs on its wall.
    pub by: DrivenBy,
    /// What is added to v_n and taken from v_t where V = 0, m/s.
    pub still: [f64; 2],
    /// How fast the wall comes along n where V = 0, m/s.
    pub speed: f64,
}

/// Fixed bodies of a problem whose surfaces move. Memory is kept between steps.
#[derive(Clone, Debug, Default)]
pub(crate) struct MovingWalls {
    /// How fast the wall of each fixed row comes along the normal, m/s; empty where no wall moves.
    pub speeds: Vec<f64>,
    /// How the surface behind each fixed row goes, if it moves.
    surfaces: Vec<Option<Surface>>,
    /// Walls that a force drives.
    pub driven: Vec<DrivenWall>,
    /// The rows against these.
    pub driven_rows: Vec<DrivenRow>,
    /// The place of each fixed row among those, or [`NONE`]; empty where nothing is driven.
    driven_row_of: Vec<u32>,
}

/// The surfaces that a problem is prepared among.
pub struct MovingSurfaces<'a> {
    /// Walls that a force drives.
    pub driven: Vec<DrivenWall>,
    /// The surface that a contact touches, if it moves.
    pub of: &'a dyn Fn(&Contact) -> Option<Surface>,
}

impl MovingWalls {
    /// Begins a step.
    pub(super) fn clear(&mut self) {
        self.speeds.clear();
        self.surfaces.clear();
        self.driven.clear();
        self.driven_rows.clear();
        self.driven_row_of.clear();
    }

    /// What is known of a row against a fixed body, by its number, if that is driven.
    #[inline(always)]
    pub(crate) fn driven_row(&self, number: usize) -> Option<&DrivenRow> {
        self.driven_rows.get(*self.driven_row_of.get(number)? as usize)
    }

    /// Takes note of the next row against a fixed body, of which is told what drives that, how fast it comes along n,
    /// and what is added to v_n and taken from v_t: all with the speed before the step, m/s.
    fn add_row(&mut self, by: Option<DrivenBy>, wall_speed: f64, [added, slide]: [f64; 2]) {
        if self.driven.is_empty() {
            return;
        }
        let Some(by) = by else { return self.driven_row_of.push(NONE) };
        let before = self.driven[by.wall as usize].before;
        let number = self.driven_row_of.len() as u32;
        self.driven_row_of.push(self.driven_rows.len() as u32);
        let still = [added + by.along[0] * before, slide - by.along[1] * before];
        let speed = wall_speed - by.along[0] * before;
        self.driven_rows.push(DrivenRow { number, by, still, speed });
    }
}

impl<M: Model> StepProblem<M> {
    /// Tells the rows, which have just been made, of surfaces that move.
    pub(super) fn add_surfaces(
        &mut self,
        contacts: &ContactList,
        rebound: &impl Fn(Approach) -> f64,
        surfaces: MovingSurfaces<'_>,
    ) {
        let Self { rows, bodies, walls, .. } = self;
        walls.driven.extend(surfaces.driven);
        for (row, &index) in rows.fixed.iter_mut().zip(&rows.contacts) {
            let contact = &contacts.contacts()[index as usize];
            // What does not rub does not mind what slides.
            let surface = (surfaces.of)(contact).map(|surface| match M::FRICTION {
                true => surface,
                false => surface.smooth(),
            });
            let [speed, slide] = surface.map_or([0.0; 2], |surface| surface.along(contact.normal));
            row.surface_speed = slide;
            let [velocity, _] = M::velocity(row.normal, &bodies.before[row.i as usize]);
            let in_touch = contacts.is_in_touch(index as usize);
            let speed_before = surface.map_or(0.0, |surface| surface.before.dot(contact.normal));
            let velocity = velocity - speed_before;
            let approach = Approach { velocity, gap: contact.gap, in_touch };
            row.restitution_velocity = rebound(approach) - speed;
            walls.speeds.push(speed);
            let added = [row.restitution_velocity, row.surface_speed];
            walls.add_row(surface.and_then(|surface| surface.driven), speed, added);
            walls.surfaces.push(surface);
        }
    }

    /// Gives a row, by its number, another normal; how fast its wall comes along that, m/s.
    pub(crate) fn turn_row(&mut self, number: usize, normal: DVec2) -> f64 {
        let row = self.rows.get_mut(number);
        row.normal = M::sliding(M::normal(normal.to_array()), M::slide(row.normal));
        let Some(surface) = self.walls.surfaces.get(number).copied().flatten() else { return 0.0 };
        let [speed, slide] = surface.along(normal);
        self.rows.fixed[number].surface_speed = slide;
        self.walls.speeds[number] = speed;
        speed
    }

    /// How fast the wall of a row comes, by the row's number, m/s.
    #[inline(always)]
    pub fn wall_speed(&self, number: usize) -> f64 {
        self.walls.speeds.get(number).copied().unwrap_or(0.0)
    }

    /// How fast the wall of a row came as the step began, by the row's number, m/s.
    pub(crate) fn wall_speed_before(&self, number: usize) -> f64 {
        if self.gives_way(number) {
            return self.wall_speed(number);
        }
        let Some(surface) = self.walls.surfaces.get(number).copied().flatten() else { return 0.0 };
        let [x, y] = M::components(self.rows.fixed[number].normal);
        surface.before.dot(DVec2::new(x, y))
    }

    /// How fast the surfaces behind all rows go along t, m/s: 0 between grains; none where no surface moves.
    pub fn surface_speeds(&self) -> Vec<f64> {
        if !self.has_moving_walls() {
            return Vec::new();
        }
        (0..self.rows.len()).map(|number| self.rows.surface_speed(number)).collect()
    }

    /// True where any surface may move.
    pub(crate) fn has_moving_walls(&self) -> bool {
        !self.walls.speeds.is_empty()
    }

    /// The velocity of the fixed shape of a row that touches along a normal, m/s, as far as it shows in the gap.
    pub(crate) fn shape_velocity(&self, number: usize, normal: DVec2) -> DVec2 {
        match self.walls.surfaces.get(number) {
            Some(Some(surface)) if !surface.is_half_space => surface.velocity,
            _ => self.wall_speed(number) * normal,
        }
    }

    /// The work, J, that moving surfaces do by the rows' impulses; and the part of it along the tangents, which the
    /// rows' own velocities, being relative, leave out.
    pub(crate) fn surface_works(&self) -> [f64; 2] {
        let [whole, along_tangents] = self.surface_works_of(self, |number| number);
        // Rows tell of driven walls as they go at the end, but these had their mean speeds: Σ P·b ½(V − V⁻) too much.
        let surplus = |known: &DrivenRow| {
            let number = known.number as usize;
            let row = &self.rows.fixed[number];
            let along = known.by.part_along(self.reduced_impulse(number, row));
            let wall = &self.walls.driven[known.by.wall as usize];
            0.5 * row.effective_mass * along * (wall.now - wall.before)
        };
        let surplus = match self.is_driven() {
            true => self.walls.driven_rows.iter().map(surplus).sum(),
            false => 0.0,
        };
        [whole - surplus, along_tangents]
    }

    /// The same of rows of a part of this problem, whose numbers here `number_here` gives.
    pub(crate) fn surface_works_of(
        &self,
        part: &Self,
        number_here: impl Fn(usize) -> usize,
    ) -> [f64; 2] {
        let (mut whole, mut along_tangents) = (0.0, 0.0);
        for (number, row) in part.rows.fixed.iter().enumerate() {
            let [normal, tangential] = part.reduced_impulse(number, row);
            let along_tangent = row.effective_mass * tangential * row.surface_speed;
            let speed = self.wall_speed(number_here(number));
            whole += row.effective_mass * normal * speed + along_tangent;
            along_tangents += along_tangent;
        }
        [whole, along_tangents]
    }

    /// Every row, to be changed, with how fast its wall comes, m/s: 0 where that does not move.
    pub(crate) fn rows_with_walls(&mut self) -> impl Iterator<Item = (&mut Row<M>, f64)> {
        let walls = self.walls.speeds.iter().copied().chain(std::iter::repeat(0.0));
        self.rows.iter_mut().zip(walls)
    }

    /// True where any wall is driven.
    #[inline(always)]
    pub fn is_driven(&self) -> bool {
        !self.walls.driven.is_empty()
    }

    /// True where the wall of a row is driven.
    #[inline(always)]
    pub(crate) fn gives_way(&self, number: usize) -> bool {
        self.walls.driven_row(number).is_some()
    }

    /// Lets a row close as fast as that relative to its wall, which comes with `wall_speed`, m/s.
    pub(crate) fn let_close(&mut self, number: usize, allowed: f64, wall_speed: f64) {
        self.rows.get_mut(number).restitution_velocity = allowed - wall_speed;
        let MovingWalls { driven_rows, driven_row_of, .. } = &mut self.walls;
        let place = driven_row_of.get(number).map(|&place| place as usize);
        if let Some(known) = place.and_then(|place| driven_rows.get_mut(place)) {
            known.still[0] = allowed - known.speed;
        }
    }

    /// How fast the wall of a row comes along n as the step begins, and what it gains in the step, m/s.
    pub(crate) fn wall_speed_and_gain(&self, number: usize) -> [f64; 2] {
        let Some(known) = self.walls.driven_row(number) else {
            let before = self.wall_speed_before(number);
            return [before, self.wall_speed(number) - before];
        };
        let DrivenBy { wall, along: [along, _] } = known.by;
        let wall = &self.walls.driven[wall as usize];
        [known.speed + along * wall.before, along * (wall.now - wall.before)]
    }

    /// Where the wall of a row is driven: what part of its (v_n, v_t) is its grain's to undo, ρ's term included, m/s.
    /// Its impulses undo them by as much as those of a row whose body stays undo the whole.
    #[inline(always)]
    pub(super) fn own_part(
        &self,
        number: usize,
        row: &Row<M>,
        [normal, tangential]: [f64; 2],
    ) -> Option<[f64; 2]> {
        let DrivenBy { wall, along } = self.walls.driven_row(number)?.by;
        let answer = self.walls.driven[wall as usize].response * row.effective_mass;
        let [of_normal, of_tangential] = along.map(|along| 1.0 + answer * along * along);
        let added = row.restitution_velocity;
        let of_tangential = 1.0 + (of_tangential - 1.0) / M::TANGENTIAL_COMPLIANCE;
        Some([(normal + added) / of_normal - added, tangential / of_tangential])
    }

    /// The same of a row whose wall goes as if no contact acted, of what it tells for the wall as it goes now.
    #[inline(always)]
    pub(super) fn free_part(
        &self,
        number: usize,
        row: &Row<M>,
        [normal, tangential]: [f64; 2],
    ) -> Option<[f64; 2]> {
        let DrivenBy { wall, along } = self.walls.driven_row(number)?.by;
        let wall = &self.walls.driven[wall as usize];
        let slower = wall.now - wall.free;
        self.own_part(number, row, [normal + along[0] * slower, tangential + along[1] * slower])
    }

    /// Gives driven walls the velocities that the rows' impulses make, and tells the rows.
    pub(super) fn form_wall_velocities(&mut self) {
        for wall in &mut self.walls.driven {
            wall.now = wall.free;
        }
        for at in 0..self.walls.driven_rows.len() {
            let DrivenRow { number, by, .. } = self.walls.driven_rows[at];
            let row = &self.rows.fixed[number as usize];
            let along = by.part_along(self.reduced_impulse(number as usize, row));
            let wall = &mut self.walls.driven[by.wall as usize];
            wall.now -= wall.response * row.effective_mass * along;
        }
        self.tell_of_walls();
    }

    /// Gives driven walls velocities that were found in another way, one a wall, and tells the rows.
    pub(crate) fn set_wall_velocities(&mut self, velocities: impl Iterator<Item = f64>) {
        for (wall, velocity) in self.walls.driven.iter_mut().zip(velocities) {
            wall.now = velocity;
        }
        self.tell_of_walls();
    }

    /// Tells the rows how their walls go now.
    pub(crate) fn tell_of_walls(&mut self) {
        let MovingWalls { driven, driven_rows, speeds, .. } = &mut self.walls;
        for known in driven_rows {
            let (number, along) = (known.number as usize, known.by.along);
            let (row, speed) = (&mut self.rows.fixed[number], driven[known.by.wall as usize].now);
            row.restitution_velocity = known.still[0] - along[0] * speed;
            row.surface_speed = known.still[1] + along[1] * speed;
            speeds[number] = known.speed + along[0] * speed;
        }
    }

    /// Contacts of the wall of each row, and κ (b_n² + b_t² m_t/m_n) of the row; none where its body is not driven.
    pub(crate) fn wall_compliances(&self) -> impl Iterator<Item = Option<f64>> {
        let MovingWalls { driven, driven_rows, .. } = &self.walls;
        let mut counts = vec![0.0; driven.len()];
        driven_rows.iter().for_each(|row| counts[row.by.wall as usize] += 1.0);
        self.rows.fixed.iter().enumerate().map(move |(number, row)| {
            let DrivenBy { wall, along: [normal, tangential] } = self.walls.driven_row(number)?.by;
            let squared = normal * normal + tangential * tangential / M::TANGENTIAL_COMPLIANCE;
            let response = driven[wall as usize].response;
            Some(counts[wall as usize] * response * row.effective_mass * squared)
        })
    }
}
