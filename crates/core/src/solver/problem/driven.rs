//! Walls that a force drives along one axis, as bodies of a step's problem.
//!
//! A wall of mass M goes along a, |a| = 1, with V under a force F and a damping c V. Its contacts push it back, each by
//! P·b with b = (a·n, a·t), so that with the damping taken at the end of the step
//!
//! > M (V − V⁻) = Δt (F − c V) − Σ P·b,  V = V_free − r Σ P·b,
//! > r = 1/(M + cΔt),  V_free = r (M V⁻ + ΔtF).
//!
//! V is no number that the step is given: it is as much unknown as the velocities of grains, so a wall lighter than what
//! it presses on never swings up, though its load then goes from contact to contact slowly, by M/m_i a sweep. In reduced impulses λ = P/m_i, and with κ = r m_i, a contact of grain i has
//!
//! > u_n = v_n − b_n V,  ∂u_n/∂λ_n = 1 + κ b_n²,  ∂u_t/∂λ_t = m_n/m_t + κ b_t²,
//!
//! and every other contact of the wall sees V change by −κ (b_n λ_n + b_t λ_t). Rows are told of V once a sweep, so that
//! whatever reads them finds the velocities relative to the wall as it goes now.

/// No wall.
const NONE: u32 = u32::MAX;

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

/// The walls of a problem that are driven, and the rows against them. Memory is kept between steps.
#[derive(Clone, Debug, Default)]
pub(crate) struct Driven {
    pub walls: Vec<DrivenWall>,
    pub rows: Vec<DrivenRow>,
    /// The place in `rows` of each row against a fixed body, or [`NONE`]; empty where nothing is driven.
    of_row: Vec<u32>,
}

impl Driven {
    /// Begins a step.
    pub(super) fn clear(&mut self) {
        self.walls.clear();
        self.rows.clear();
        self.of_row.clear();
    }

    /// Whether there is no such wall.
    #[inline(always)]
    pub(crate) fn is_empty(&self) -> bool {
        self.walls.is_empty()
    }

    /// Takes note of the next row against a fixed body, of which is told what drives that, how fast it comes along n,
    /// and what is added to v_n and taken from v_t: all with the speed before the step, m/s.
    pub(super) fn add(&mut self, by: Option<DrivenBy>, wall_speed: f64, [added, slide]: [f64; 2]) {
        if self.is_empty() {
            return;
        }
        let Some(by) = by else { return self.of_row.push(NONE) };
        let before = self.walls[by.wall as usize].before;
        let number = self.of_row.len() as u32;
        self.of_row.push(self.rows.len() as u32);
        let still = [added + by.along[0] * before, slide - by.along[1] * before];
        self.rows.push(DrivenRow { number, by, still, speed: wall_speed - by.along[0] * before });
    }

    /// The same as [`Self::row`], to be changed.
    pub(super) fn row_mut(&mut self, number: usize) -> Option<&mut DrivenRow> {
        self.rows.get_mut(*self.of_row.get(number)? as usize)
    }

    /// What is known of a row against a fixed body, by its number, if that is driven.
    #[inline(always)]
    pub(crate) fn row(&self, number: usize) -> Option<&DrivenRow> {
        self.rows.get(*self.of_row.get(number)? as usize)
    }
}
