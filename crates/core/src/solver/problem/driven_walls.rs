//! What the impulses of a problem do to walls that a force drives (`driven`).

use super::driven::{DrivenBy, DrivenRow};
use super::kinematics::Kinematics;
use super::step_problem::{Row, StepProblem};

impl<K: Kinematics> StepProblem<K> {
    /// Whether any wall is driven.
    #[inline(always)]
    pub fn is_driven(&self) -> bool {
        !self.driven.is_empty()
    }

    /// Whether the wall of a row is driven.
    #[inline(always)]
    pub(crate) fn gives_way(&self, number: usize) -> bool {
        self.driven.row(number).is_some()
    }

    /// Lets a row close as fast as that relative to its wall, which comes with `wall_speed`, m/s.
    pub(crate) fn let_close(&mut self, number: usize, allowed: f64, wall_speed: f64) {
        self.row_at_mut(number).restitution_velocity = allowed - wall_speed;
        if let Some(known) = self.driven.row_mut(number) {
            known.still[0] = allowed - known.speed;
        }
    }

    /// How fast the wall of a row comes along n as the step begins, and what it gains in the step, m/s.
    pub(crate) fn wall_speed_and_gain(&self, number: usize) -> [f64; 2] {
        let Some(known) = self.driven.row(number) else { return [self.wall_speed(number), 0.0] };
        let DrivenBy { wall, along: [along, _] } = known.by;
        let wall = &self.driven.walls[wall as usize];
        [known.speed + along * wall.before, along * (wall.now - wall.before)]
    }

    /// Where the wall of a row is driven: what part of its (v_n, v_t) is its grain's to undo, ρ's term included, m/s.
    /// Its impulses undo them by as much as those of a row whose body stays undo the whole.
    #[inline(always)]
    pub(super) fn own_part(
        &self,
        number: usize,
        row: &Row<K>,
        [normal, tangential]: [f64; 2],
    ) -> Option<[f64; 2]> {
        let DrivenBy { wall, along } = self.driven.row(number)?.by;
        let answer = self.driven.walls[wall as usize].response * row.effective_mass;
        let [of_normal, of_tangential] = along.map(|along| 1.0 + answer * along * along);
        let added = row.restitution_velocity;
        let of_tangential = 1.0 + (of_tangential - 1.0) / K::TANGENTIAL_COMPLIANCE;
        Some([(normal + added) / of_normal - added, tangential / of_tangential])
    }

    /// The same of a row whose wall goes as if no contact acted, of what it tells for the wall as it goes now.
    #[inline(always)]
    pub(super) fn free_part(
        &self,
        number: usize,
        row: &Row<K>,
        [normal, tangential]: [f64; 2],
    ) -> Option<[f64; 2]> {
        let DrivenBy { wall, along } = self.driven.row(number)?.by;
        let wall = &self.driven.walls[wall as usize];
        let slower = wall.now - wall.free;
        self.own_part(number, row, [normal + along[0] * slower, tangential + along[1] * slower])
    }

    /// Gives driven walls the velocities that the rows' impulses make, and tells the rows.
    pub(super) fn form_wall_velocities(&mut self) {
        for wall in &mut self.driven.walls {
            wall.now = wall.free;
        }
        for known in &self.driven.rows {
            let number = known.number as usize;
            let row = &self.fixed_rows[number];
            let along = known.by.part_along(self.reduced_impulse(number, row));
            let wall = &mut self.driven.walls[known.by.wall as usize];
            wall.now -= wall.response * row.effective_mass * along;
        }
        self.tell_of_walls();
    }

    /// Gives driven walls velocities that were found in another way, one a wall, and tells the rows.
    pub(crate) fn set_wall_velocities(&mut self, velocities: impl Iterator<Item = f64>) {
        for (wall, velocity) in self.driven.walls.iter_mut().zip(velocities) {
            wall.now = velocity;
        }
        self.tell_of_walls();
    }

    /// Tells the rows how their walls go now.
    pub(crate) fn tell_of_walls(&mut self) {
        let Self { driven, fixed_rows, wall_speeds, .. } = self;
        for known in &driven.rows {
            let (number, along) = (known.number as usize, known.by.along);
            let (row, speed) = (&mut fixed_rows[number], driven.walls[known.by.wall as usize].now);
            row.restitution_velocity = known.still[0] - along[0] * speed;
            row.of_other = known.still[1] + along[1] * speed;
            wall_speeds[number] = known.speed + along[0] * speed;
        }
    }

    /// What of the work (J) that rows tell of their walls' present speeds is to be taken away, since the walls had their
    /// mean speeds in the step: Σ P·b ½(V − V⁻).
    pub(super) fn surplus_of_driven_walls(&self) -> f64 {
        let of_row = |known: &DrivenRow| {
            let number = known.number as usize;
            let row = &self.fixed_rows[number];
            let [normal, tangential] = self.reduced_impulse(number, row);
            let wall = &self.driven.walls[known.by.wall as usize];
            let along = known.by.along[0] * normal + known.by.along[1] * tangential;
            0.5 * row.effective_mass * along * (wall.now - wall.before)
        };
        self.driven.rows.iter().map(of_row).sum()
    }

    /// Contacts of the wall of each row, and κ (b_n² + b_t² m_t/m_n) of the row; none where its body is not driven.
    pub(crate) fn wall_compliances(&self) -> impl Iterator<Item = Option<f64>> {
        let Self { driven, fixed_rows, .. } = self;
        let mut counts = vec![0.0; driven.walls.len()];
        driven.rows.iter().for_each(|row| counts[row.by.wall as usize] += 1.0);
        fixed_rows.iter().enumerate().map(move |(number, row)| {
            let DrivenBy { wall, along: [normal, tangential] } = driven.row(number)?.by;
            let squared = normal * normal + tangential * tangential / K::TANGENTIAL_COMPLIANCE;
            let response = driven.walls[wall as usize].response;
            Some(counts[wall as usize] * response * row.effective_mass * squared)
        })
    }
}
