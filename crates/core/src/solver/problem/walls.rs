//! Contacts of a step with moving surfaces, and with walls that a force drives.
//!
//! **Along the normal.** Let v_n and v_t be the normal and tangential velocity of a grain at the contact (m/s),
//! v_n^{n−1} its v_n at the beginning of the step and ρ the restitution. Relative to a surface that moves with the
//! speed V along the normal the grain has the normal velocity v_n − V. So the expression v_n + ρ v_n^{n−1} of the
//! contact law becomes v_n − V + ρ (v_n^{n−1} − V⁻): only the term added to v_n changes, and methods need no change. V⁻
//! is the speed of the surface at the beginning of the step. A grain that rests on an accelerating surface has
//! v_n^{n−1} = V⁻, so it does not bounce.
//!
//! **Along the tangent.** With the speed V_t of the surface along the tangent, the law's v_t becomes v_t − V_t. The
//! term that is added to v_n cannot express this. A row (the data of a contact) against a fixed body stores the surface
//! speed V_t at the address where a pair of grains stores its mass ratio g_i, which is 1 against a fixed body. A sweep
//! always subtracts V_t: V_t is in the row's own cache line, and subtracting 0 changes no bit of the result.
//!
//! **Work.** The work of a contact with the normal and tangential impulses P_n and P_t (N·s) is computed with the
//! grain's own velocity (`problem::measures`). So it contains the work of the surface on the grain, P_n V + P_t V_t;
//! the rest of it is the work that the contact dissipates.
//!
//! **Driven walls.** A wall of mass M (kg) moves along the unit vector a with the speed V under a force F (N) and a
//! damping force c V (c: kg/s). The impulse P = (P_n, P_t) of each contact pushes the wall back by P·b with b = (b_n,
//! b_t) = (a·n, a·t), where n and t are the contact's normal and tangent. With the damping force taken at the end of
//! the step
//!
//! > M (V − V⁻) = Δt (F − c V) − Σ P·b,  V = V_free − r Σ P·b,
//! > r = 1/(M + cΔt),  V_free = r (M V⁻ + ΔtF).
//!
//! V is an unknown like the velocities of grains, so a wall that is lighter than its load does not begin to oscillate.
//! Let m_i be the mass of the contact's grain, κ = r m_i, u_n and u_t the velocities relative to the wall, and m_n and
//! m_t the effective masses along normal and tangent. In reduced impulses λ = P/m_i, the contact has
//!
//! > u_n = v_n − b_n V,  ∂u_n/∂λ_n = 1 + κ b_n²,  ∂u_t/∂λ_t = m_n/m_t + κ b_t²,
//!
//! and its impulses change V, the speed of the wall at all of its contacts, by −κ (b_n λ_n + b_t λ_t). So sweeps
//! converge slowly if the wall is light: the update of a contact changes λ_n only by the fraction 1/(1 + κ b_n²), about
//! M/m_i, of the change that it would make at a fixed wall. V is copied into the rows once per sweep, so that every
//! reader of the rows gets velocities relative to the present motion of the wall.

use glam::DVec2;

use super::{Approach, Row, StepProblem};
use crate::contact::{Contact, ContactList};
use crate::solver::kinematics::Model;

/// Index that marks a contact with a body that is neither a grain nor a wall that a force moves.
const NONE: u32 = u32::MAX;

/// Motion of the surface of a body that is not a grain (wall or disc), at a contact.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Velocity of the body at the contact, m/s: the mean velocity of its prescribed motion over the step, plus, if a
    /// force drives the body, the speed due to this force at the beginning of the step.
    pub velocity: DVec2,
    /// Velocity of the body at the contact at the beginning of the step, m/s.
    pub before: DVec2,
    /// Additional speed of the surface along the tangent relative to the body, m/s, if the surface runs around the
    /// body, as a conveyor belt does; else 0.
    pub round: f64,
    /// Angular velocity at which the surface turns, rad/s: the angular velocity of the body, plus, for a disc whose
    /// surface runs around it like a belt, the surface speed divided by the disc's radius.
    pub spin: f64,
    /// True if the body is a half-space. A motion of a half-space along its own surface does not change the gaps of its
    /// contacts.
    pub is_half_space: bool,
    /// True if the body moves only along the normal of its surface, so that this motion has no component along the
    /// tangent.
    pub is_pushed: bool,
    /// If a force moves the body: its index among the walls that a force moves, and its direction of motion at the
    /// contact; else `None`.
    pub driven: Option<DrivenBy>,
}

impl Surface {
    /// Returns this surface without its speeds along the tangent, which have no effect on contacts without friction.
    fn smooth(self) -> Self {
        let smooth = |by: DrivenBy| DrivenBy { along: [by.along[0], 0.0], ..by };
        Self { is_pushed: true, round: 0.0, driven: self.driven.map(smooth), ..self }
    }

    /// Returns the speeds of the surface along the unit normal n and the tangent t, m/s.
    #[inline]
    pub(crate) fn along(&self, normal: DVec2) -> [f64; 2] {
        let tangential = if self.is_pushed { 0.0 } else { self.velocity.dot(normal.perp()) };
        [self.velocity.dot(normal), tangential + self.round]
    }
}

/// A wall that a force drives, in a step's problem.
#[derive(Clone, Copy, Debug)]
pub struct DrivenWall {
    /// Index of the wall's motion in the scene's list of motions.
    pub motion: usize,
    /// Response r = 1/(M + cΔt) of the wall's speed to an impulse on the wall, 1/kg, with the wall's mass M (kg), its
    /// damping coefficient c (kg/s) and the time step Δt (s).
    pub response: f64,
    /// Speed V⁻ of the wall at the beginning of the step, m/s.
    pub before: f64,
    /// Speed V_free that the wall would have at the end of the step if no contact acted, m/s.
    pub free: f64,
    /// Speed V of the wall that follows from the present contact impulses, m/s.
    pub now: f64,
}

/// The wall that a contact touches and that a force moves (driven wall), and the wall's direction of motion at the
/// contact.
#[derive(Clone, Copy, Debug)]
pub struct DrivenBy {
    /// Index of the wall in the list of walls that a force moves.
    pub wall: u32,
    /// Components b of the wall's unit direction of motion along the contact's normal and tangent.
    pub along: [f64; 2],
}

impl DrivenBy {
    /// Returns the component of a contact impulse along the wall's direction of motion, in the unit of the given
    /// impulse. The impulse is given by its normal and tangential components.
    #[inline(always)]
    pub(crate) fn part_along(&self, [normal, tangential]: [f64; 2]) -> f64 {
        self.along[0] * normal + self.along[1] * tangential
    }
}

/// The data of a contact with a wall that a force drives.
#[derive(Clone, Copy, Debug)]
pub struct DrivenRow {
    /// Number of the contact's row among the rows of contacts with fixed bodies.
    pub number: u32,
    /// The wall, and its direction of motion at the contact.
    pub by: DrivenBy,
    /// The fields `restitution_velocity` and `surface_speed` of the contact's data (its row), m/s, as they would be if
    /// the force-driven speed V of the wall was 0.
    pub still: [f64; 2],
    /// Speed of the wall along the contact's normal that is due to a prescribed motion, m/s. The force-driven speed V
    /// of the wall is not part of it.
    pub speed: f64,
}

/// Moving surfaces of the walls and other bodies of a step's problem that are not grains. The memory is reused for the
/// next step.
#[derive(Clone, Debug, Default)]
pub(crate) struct MovingWalls {
    /// For each contact with a body that is not a grain, the speed of that body along the normal, m/s; empty if no such
    /// body moves.
    pub speeds: Vec<f64>,
    /// For each contact with a body that is not a grain, the motion of that body's surface, or `None` if the surface
    /// does not move.
    surfaces: Vec<Option<Surface>>,
    /// Walls that a force drives.
    pub driven: Vec<DrivenWall>,
    /// Data of the contacts with walls that a force moves.
    pub driven_rows: Vec<DrivenRow>,
    /// For each contact with a body that is not a grain, its index in `driven_rows`, or [`NONE`] if no force moves that
    /// body; empty if no force moves any wall.
    driven_row_of: Vec<u32>,
}

/// The moving surfaces of a step, from which its contact problem is set up.
pub struct MovingSurfaces<'a> {
    /// Walls that a force drives.
    pub driven: Vec<DrivenWall>,
    /// Returns the motion of the surface that a contact touches, or `None` if that surface does not move.
    pub of: &'a dyn Fn(&Contact) -> Option<Surface>,
}

impl MovingWalls {
    /// Removes all moving surfaces, at the beginning of a step.
    pub(super) fn clear(&mut self) {
        self.speeds.clear();
        self.surfaces.clear();
        self.driven.clear();
        self.driven_rows.clear();
        self.driven_row_of.clear();
    }

    /// Returns the data of the contact in row `number` if its fixed body is a wall that a force moves, else `None`.
    #[inline(always)]
    pub(crate) fn driven_row(&self, number: usize) -> Option<&DrivenRow> {
        self.driven_rows.get(*self.driven_row_of.get(number)? as usize)
    }

    /// Records the next contact with a body that is not a grain; does nothing if no force drives any wall. `by` is the
    /// wall of the contact if a force moves it, or `None`. The other arguments, m/s, contain the speed that the
    /// force-driven wall has at the beginning of the step: `wall_speed` is the speed of the wall along the contact's
    /// normal, and `added` and `slide` are the fields `restitution_velocity` and `surface_speed` of the contact's data.
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
    /// Includes the motion of surfaces in the data (rows) of all contacts with fixed bodies: their speeds along the
    /// tangent, and along the normal as part of the term that the contact law adds to the normal velocity. Must be
    /// called once, directly after the rows have been created.
    pub(super) fn add_surfaces(
        &mut self,
        contacts: &ContactList,
        rebound: &impl Fn(Approach) -> f64,
        surfaces: MovingSurfaces<'_>,
    ) {
        let Self { rows, bodies, walls, .. } = self;
        walls.driven.extend(surfaces.driven);
        for (number, (row, &index)) in rows.fixed.iter_mut().zip(&rows.contacts).enumerate() {
            let contact = &contacts.contacts()[index as usize];
            // Without friction, the speed of a surface along the tangent has no effect.
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
            let restitution = rows.restitutions.get(number).copied();
            let approach = Approach { velocity, gap: contact.gap, in_touch, restitution };
            row.restitution_velocity = rebound(approach) - speed;
            walls.speeds.push(speed);
            let added = [row.restitution_velocity, row.surface_speed];
            walls.add_row(surface.and_then(|surface| surface.driven), speed, added);
            walls.surfaces.push(surface);
        }
    }

    /// Replaces the unit normal of the contact in row `number`, and updates the speeds of its moving surface. Returns
    /// the speed of the wall (or other body that is not a grain) along the new normal, m/s.
    pub(crate) fn turn_row(&mut self, number: usize, normal: DVec2) -> f64 {
        let row = self.rows.get_mut(number);
        row.normal = M::sliding(M::normal(normal.to_array()), M::slide(row.normal));
        let Some(surface) = self.walls.surfaces.get(number).copied().flatten() else { return 0.0 };
        let [speed, slide] = surface.along(normal);
        self.rows.fixed[number].surface_speed = slide;
        self.walls.speeds[number] = speed;
        speed
    }

    /// Returns the speed along the normal, m/s, of the wall (or other body that is not a grain) at the contact in row
    /// `number`; 0 if it does not move.
    #[inline(always)]
    pub fn wall_speed(&self, number: usize) -> f64 {
        self.walls.speeds.get(number).copied().unwrap_or(0.0)
    }

    /// Returns the speed along the normal, m/s, at the beginning of the step, of the wall (or other body that is not a
    /// grain) at the contact in row `number`. For a wall that a force moves, the result is instead its speed under the
    /// present contact impulses; [`Self::wall_speed_and_gain`] returns the speed at the beginning of the step for such
    /// a wall, too.
    pub(crate) fn wall_speed_before(&self, number: usize) -> f64 {
        if self.gives_way(number) {
            return self.wall_speed(number);
        }
        let Some(surface) = self.walls.surfaces.get(number).copied().flatten() else { return 0.0 };
        let [x, y] = M::components(self.rows.fixed[number].normal);
        surface.before.dot(DVec2::new(x, y))
    }

    /// Returns for each contact the speed along the tangent, m/s, of the surface that the grain touches; 0 for contacts
    /// between grains. The list is empty if no surface moves.
    pub fn surface_speeds(&self) -> Vec<f64> {
        if !self.has_moving_walls() {
            return Vec::new();
        }
        (0..self.rows.len()).map(|number| self.rows.surface_speed(number)).collect()
    }

    /// Returns true if the problem was set up with moving surfaces.
    pub(crate) fn has_moving_walls(&self) -> bool {
        !self.walls.speeds.is_empty()
    }

    /// Returns the velocity, m/s, with which the wall (or other body that is not a grain) at the contact in row
    /// `number` changes the gap. For a half-space this is the component of its velocity along `normal`, for other
    /// bodies the whole velocity.
    pub(crate) fn shape_velocity(&self, number: usize, normal: DVec2) -> DVec2 {
        match self.walls.surfaces.get(number) {
            Some(Some(surface)) if !surface.is_half_space => surface.velocity,
            _ => self.wall_speed(number) * normal,
        }
    }

    /// Returns two works, J: the work that moving surfaces do on the grains in a step, and the part of this work that
    /// is done along the tangents. The tangential part is needed separately: the tangential velocities of a problem are
    /// relative to the surfaces, so a work that is computed from them lacks this part.
    pub(crate) fn surface_works(&self) -> [f64; 2] {
        let [whole, along_tangents] = self.surface_works_of(self, |number| number);
        // The rows contain the final speed V of a driven wall, but the wall does work at its mean speed ½(V + V⁻). V⁻
        // is its speed at the beginning of the step. So the sum is too large by ½(V − V⁻) times the impulses P·b on the
        // wall.
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

    /// Returns the work of moving surfaces and its tangential part, J, for the contacts of `part`, a problem with a
    /// subset of the contacts of this problem. `number_here` translates the row numbers of `part` to row numbers of
    /// this problem. The work of a wall that a force moves is computed with the wall's speed at the end of the step,
    /// although the wall does work at the mean of its speeds at the beginning and the end of the step.
    /// [`Self::surface_works`] corrects this.
    pub(crate) fn surface_works_of(
        &self,
        part: &Self,
        number_here: impl Fn(usize) -> usize,
    ) -> [f64; 2] {
        let (mut whole, mut along_tangents) = (0.0, 0.0);
        for (number, row) in part.rows.fixed.iter().enumerate() {
            let [normal, tangential] = part.reduced_impulse(number, row);
            let mut along_tangent = row.effective_mass * tangential * row.surface_speed;
            if M::ROLLING
                && let Some(rolling) = part.rows.rolling.get(number)
            {
                along_tangent += row.effective_mass * rolling.impulse * rolling.surface_speed;
            }
            let speed = self.wall_speed(number_here(number));
            whole += row.effective_mass * normal * speed + along_tangent;
            along_tangents += along_tangent;
        }
        [whole, along_tangents]
    }

    /// Iterates over all contacts: a mutable reference to the contact's data, and the speed along the normal, m/s, of
    /// its wall (or other body that is not a grain); 0 between grains or if that body does not move.
    pub(crate) fn rows_with_walls(&mut self) -> impl Iterator<Item = (&mut Row<M>, f64)> {
        let walls = self.walls.speeds.iter().copied().chain(std::iter::repeat(0.0));
        self.rows.iter_mut().zip(walls)
    }

    /// Returns true if a force drives any wall.
    #[inline(always)]
    pub fn is_driven(&self) -> bool {
        !self.walls.driven.is_empty()
    }

    /// Returns true if the contact in row `number` is with a wall that a force drives.
    #[inline(always)]
    pub(crate) fn gives_way(&self, number: usize) -> bool {
        self.walls.driven_row(number).is_some()
    }

    /// Changes the law of the contact in row `number` so that its bodies may approach each other with a speed of up to
    /// `allowed`, m/s. `wall_speed` is the speed of the wall along the normal, m/s; 0 if the contact is between grains.
    pub(crate) fn let_close(&mut self, number: usize, allowed: f64, wall_speed: f64) {
        self.rows.get_mut(number).restitution_velocity = allowed - wall_speed;
        let MovingWalls { driven_rows, driven_row_of, .. } = &mut self.walls;
        let place = driven_row_of.get(number).map(|&place| place as usize);
        if let Some(known) = place.and_then(|place| driven_rows.get_mut(place)) {
            known.still[0] = allowed - known.speed;
        }
    }

    /// Returns two speeds along the normal, m/s, of the wall (or other body that is not a grain) at the contact in row
    /// `number`: the speed at the beginning of the step, and its increase in the step.
    pub(crate) fn wall_speed_and_gain(&self, number: usize) -> [f64; 2] {
        let Some(known) = self.walls.driven_row(number) else {
            let before = self.wall_speed_before(number);
            return [before, self.wall_speed(number) - before];
        };
        let DrivenBy { wall, along: [along, _] } = known.by;
        let wall = &self.walls.driven[wall as usize];
        [known.speed + along * wall.before, along * (wall.now - wall.before)]
    }

    /// Scales the normal and tangential relative velocity (v_n, v_t), m/s, of a contact with a driven wall (a wall that
    /// a force moves) for the residual (relative error of the impulses in the contact laws); `None` if the contact is
    /// not with a driven wall.
    ///
    /// A contact with a driven wall has larger compliances than a contact with a fixed wall, because the wall gives
    /// way. v_n, with its restitution term, is divided by the ratio of these compliances 1 + κ b_n², and v_t by 1 + κ
    /// b_t² m_t/m_n (κ is the product of the contact's effective mass, kg, and the response of the wall's speed to an
    /// impulse, 1/kg; m_n and m_t are the effective masses along normal and tangent; b_n and b_t are the components of
    /// the wall's direction of motion along the normal and the tangent). So an impulse changes the scaled velocity as
    /// much as it would change the velocity at a fixed wall.
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

    /// Converts the normal and tangential velocity of a contact relative to the present speed of a driven wall (a wall
    /// that a force moves) to the velocity relative to the speed that the wall has without contact impulses, m/s. Then
    /// divides the normal velocity, with its restitution term, and the tangential velocity by a ratio, as
    /// [`Self::own_part`] does for the residual (relative error of the impulses in the contact laws): the compliance
    /// (velocity per impulse) of the contact in this direction at the driven wall, divided by its compliance at a fixed
    /// wall. An impulse then changes the result as much as it would change the velocity at a fixed wall. Returns `None`
    /// if the contact is not with a driven wall.
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

    /// Sets the walls that a force moves to the speeds that follow from the present contact impulses, and updates the
    /// contacts with these walls.
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

    /// Sets the walls that a force moves to given speeds, one per wall, m/s, and updates the contacts with these walls.
    pub(crate) fn set_wall_velocities(&mut self, velocities: impl Iterator<Item = f64>) {
        for (wall, velocity) in self.walls.driven.iter_mut().zip(velocities) {
            wall.now = velocity;
        }
        self.tell_of_walls();
    }

    /// Recomputes the terms in the contacts' data that depend on the present speeds of walls that a force moves.
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

    /// Iterates over the contacts with bodies that are not grains. Returns for each contact an upper bound for the
    /// compliance of its driven wall (a wall that a force moves), dimensionless, or `None` if no force moves the body.
    /// Methods that update all contacts at once need this bound. It is κ (b_n² + b_t² m_t/m_n) times the number of
    /// contacts of the wall. κ is the product of the contact's effective mass, kg, and the response of the wall's speed
    /// to an impulse, 1/kg; m_n and m_t are the effective masses along normal and tangent; b_n and b_t are the
    /// components of the wall's direction of motion along the normal and the tangent.
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
