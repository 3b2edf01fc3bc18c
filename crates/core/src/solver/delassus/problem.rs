//! A contact problem in the Delassus operator alone: u = W r + q, with nothing known of bodies.
//!
//! W (1/kg) says how the impulse of one contact changes the velocity of another; q (m/s) is the
//! relative velocity without contact impulses, restitution's term included. Rows and columns come
//! as N0, T0, N1, T1, … and r = (P_n, P_t), in N·s. The law is that of `contact::law`, with a
//! cohesion impulse c₀ = C₀Δt and a friction μ of each contact's own:
//!
//! > 0 ≤ p ⟂ u_n ≥ 0,  |P_t| ≤ μp (shifted cone) or ≤ μ max(p − c₀, 0) (compressive), p = P_n + c₀.
//!
//! W is kept as 2×2 blocks in compressed sparse rows, each contact's own block apart. The state is
//! (p, P_t), so that cohesion is a part of the free velocity and costs nothing: u = W (p, P_t) + q',
//! q' = q − W (c₀, 0).

use super::blocks::{Triplets, blocks, check_each, check_length, check_symmetry, own_blocks};
use super::local::LocalBlock;
use crate::error::{Error, Result};
use crate::world::FrictionCone;

/// What one contact does to another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Neighbour {
    pub block: [[f64; 2]; 2],
    pub contact: u32,
}

/// A contact as its update reads it.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContactRow {
    pub local: LocalBlock,
    /// q', m/s.
    free: [f64; 2],
    /// Its neighbours are those from here to the next contact's.
    start: u32,
}

/// A contact problem in W alone, and the impulses of its contacts.
#[derive(Clone, Debug)]
pub struct DelassusProblem {
    pub(super) rows: Vec<ContactRow>,
    neighbours: Vec<Neighbour>,
    /// (p, P_t), N·s.
    pub(super) impulses: Vec<[f64; 2]>,
    pub(super) compressive_cone: bool,
    /// ‖(m_n q_n, m_t q_t)‖₂, N·s.
    pub(super) scale: f64,
}

impl DelassusProblem {
    /// A problem of `friction.len()` contacts without impulses. `free_velocities` is q (two entries a
    /// contact, m/s), `friction` and `cohesion_impulses` (N·s) have an entry a contact.
    ///
    /// # Errors
    /// Names what is not finite, out of range, of the wrong length, or not symmetric. Each
    /// contact's own 2×2 block has to be positive definite.
    pub fn new(
        matrix: &Triplets,
        free_velocities: &[f64],
        friction: &[f64],
        cohesion_impulses: &[f64],
        cone: FrictionCone,
    ) -> Result<Self> {
        let contacts = friction.len();
        if contacts == 0 {
            return Err(Error::value("nc", 0, "at least 1"));
        }
        check_length("q", free_velocities.len(), 2 * contacts, "2 nc")?;
        check_length("c0", cohesion_impulses.len(), contacts, "nc")?;
        check_each("q", free_velocities, "a finite number", |q| q.is_finite())?;
        let at_least_zero = |value: f64| value >= 0.0 && value.is_finite();
        check_each("mu", friction, "a finite number ≥ 0", at_least_zero)?;
        check_each("c0", cohesion_impulses, "a finite number ≥ 0", at_least_zero)?;
        let blocks = blocks(matrix, contacts)?;
        let own = own_blocks(&blocks, contacts)?;
        check_symmetry(&blocks, &own)?;

        let mut rows = Vec::with_capacity(contacts);
        let mut neighbours = Vec::with_capacity(blocks.len());
        let mut at = 0;
        for contact in 0..contacts {
            let q = [free_velocities[2 * contact], free_velocities[2 * contact + 1]];
            let (friction, cohesion) = (friction[contact], cohesion_impulses[contact]);
            let local = LocalBlock::new(own[contact], friction, cohesion);
            let mut row = ContactRow { local, free: q, start: neighbours.len() as u32 };
            while let Some(&([_, other], block)) =
                blocks.get(at).filter(|([here, _], _)| *here as usize == contact)
            {
                at += 1;
                row.free[0] -= block[0][0] * cohesion_impulses[other as usize];
                row.free[1] -= block[1][0] * cohesion_impulses[other as usize];
                if other as usize != contact {
                    neighbours.push(Neighbour { block, contact: other });
                }
            }
            rows.push(row);
        }
        let scale = rows.iter().zip(free_velocities.chunks_exact(2));
        let scale: f64 = scale.map(|(row, q)| row.squared_scale([q[0], q[1]])).sum();
        Ok(Self {
            impulses: vec![[0.0; 2]; contacts],
            compressive_cone: cone == FrictionCone::Compressive,
            scale: scale.sqrt(),
            rows,
            neighbours,
        })
    }

    /// Number of contacts.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether there is no contact; never so.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// (P_n, P_t) of each contact, N·s.
    pub fn impulses(&self) -> impl ExactSizeIterator<Item = [f64; 2]> {
        self.impulses
            .iter()
            .zip(&self.rows)
            .map(|(impulse, row)| [impulse[0] - row.local.cohesion_impulse, impulse[1]])
    }

    /// Sets (P_n, P_t) of each contact, N·s, as they are.
    pub fn set_impulses(&mut self, impulses: impl IntoIterator<Item = [f64; 2]>) {
        let places = self.impulses.iter_mut().zip(&self.rows);
        for ((place, row), [normal, tangential]) in places.zip(impulses) {
            *place = [normal + row.local.cohesion_impulse, tangential];
        }
    }

    /// u of each contact at the present impulses, m/s.
    pub fn velocities(&self) -> impl ExactSizeIterator<Item = [f64; 2]> {
        (0..self.len()).map(|contact| self.velocity(contact))
    }

    /// The natural map's residual, as `solver::residual` has it of bodies, with m_n = 1/W_nn and
    /// m_t = 1/W_tt, and all of u and v^free from W and q. A W_nt that is not zero changes nothing of
    /// it: the map is zero just where the law holds, whatever the positive numbers m_n and m_t. Where
    /// μ = 0, a contact's tangential part has no place in the scale.
    pub fn residual(&self) -> f64 {
        let errors = self.rows.iter().enumerate().map(|(contact, row)| {
            row.squared_error(self.impulses[contact], self.velocity(contact), self.compressive_cone)
        });
        let error = errors.sum::<f64>().sqrt();
        if error > 0.0 { error / self.scale } else { error }
    }

    #[inline(always)]
    pub(super) fn velocity(&self, contact: usize) -> [f64; 2] {
        let row = &self.rows[contact];
        let mut velocity = self.velocity_of_others(contact);
        let [normal, tangential] = self.impulses[contact];
        velocity[0] += row.local.normal * normal + row.local.mixed * tangential;
        velocity[1] += row.local.mixed * normal + row.local.tangential * tangential;
        velocity
    }

    #[inline(always)]
    pub(super) fn neighbours_of(&self, contact: usize) -> &[Neighbour] {
        let start = self.rows[contact].start as usize;
        let end =
            self.rows.get(contact + 1).map_or(self.neighbours.len(), |row| row.start as usize);
        &self.neighbours[start..end]
    }

    /// The velocity that a contact would have without its own impulse, m/s.
    #[inline(always)]
    pub(super) fn velocity_of_others(&self, contact: usize) -> [f64; 2] {
        let mut velocity = self.rows[contact].free;
        for Neighbour { block, contact: other } in self.neighbours_of(contact) {
            let [normal, tangential] = self.impulses[*other as usize];
            velocity[0] += block[0][0] * normal + block[0][1] * tangential;
            velocity[1] += block[1][0] * normal + block[1][1] * tangential;
        }
        velocity
    }
}

impl ContactRow {
    /// e_n² + e_t², (N·s)².
    fn squared_error(&self, [p, rubbing]: [f64; 2], u: [f64; 2], compressive: bool) -> f64 {
        let LocalBlock { normal, tangential, friction, cohesion_impulse, .. } = self.local;
        let rubs = if compressive { (p - cohesion_impulse).max(0.0) } else { p.max(0.0) };
        let bound = friction * rubs;
        // Impulses that have outgrown all numbers have none where there is no friction.
        if bound.is_nan() {
            return f64::NAN;
        }
        let normal_error = p - (p - u[0] / normal).max(0.0);
        let tangential_error = rubbing - (rubbing - u[1] / tangential).clamp(-bound, bound);
        normal_error * normal_error + tangential_error * tangential_error
    }

    /// (m_n q_n)² + (m_t q_t)², (N·s)².
    fn squared_scale(&self, q: [f64; 2]) -> f64 {
        let normal = q[0] / self.local.normal;
        let tangential = if self.local.friction > 0.0 { q[1] / self.local.tangential } else { 0.0 };
        normal * normal + tangential * tangential
    }
}
