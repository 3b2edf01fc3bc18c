//! Blocks of contacts: a block contains four contacts that share no grain, one per SIMD lane, as a structure of arrays.
//!
//! All four contacts are solved at once with the arithmetic of one contact (`methods::sweep`), in the vector registers
//! of the processor. The result is bitwise the same as one contact after the other. If a colour (a group of contacts
//! that share no grain) does not fill a block, the idle lanes act on a placeholder body and change nothing.

use fearless_simd::{Simd, SimdBase, SimdFrom, f64x4};

use crate::contact::{ContactLaw, Lanes};
use crate::solver::kinematics::Model;
use crate::solver::methods::sweep::{ImpulseChange, Local};
use crate::solver::problem::{Row, errors, project_by_coulomb, squared_impulse};

/// Number of contacts per block: the number of f64 in a register of AVX2. Wider blocks would leave more lanes idle.
pub(super) const LANES: usize = 4;

/// The velocity of a body as blocks of contacts store it: one entry for each degree of freedom of the body, of which
/// there are at most three. The remaining entries are not used. The alignment keeps the velocity within one cache line.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(32))]
pub(super) struct BodySlot([f64; LANES]);

impl BodySlot {
    /// Copies the velocity of a body to a new memory slot.
    pub(super) fn of<M: Model>(body: &M::Body<f64>) -> Self {
        let [x, y, spin] = M::coordinates(body);
        Self([x, y, spin, 0.0])
    }

    /// Copies the velocity from this memory slot to a body.
    pub(super) fn store<M: Model>(&self, body: &mut M::Body<f64>) {
        let [x, y, spin, _] = self.0;
        M::set(body, [x, y, spin]);
    }
}

/// Four contacts, one per SIMD lane: each field of [`Row`] (the data of a contact) is an array of four numbers. A block
/// fills four cache lines, of which a sweep writes one.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct ContactBlock {
    i: [u32; LANES],
    j: [u32; LANES],
    /// For contacts between grains i and j, the mass ratio m_ij/m_i (effective mass divided by the mass of grain i);
    /// for contacts with fixed bodies, the speed of the fixed body's surface along the tangent, m/s.
    share_or_speed: [f64; LANES],
    normal: [[f64; LANES]; 2],
    shifted_impulse: [f64; LANES],
    tangential_impulse: [f64; LANES],
    restitution_velocity: [f64; LANES],
    effective_mass: [f64; LANES],
}

impl ContactBlock {
    /// Creates the block of up to four rows (the data of one contact each). Each row is given with the indices of the
    /// memory slots that store the velocities of its grains. It is also given with its mass ratio (effective mass
    /// divided by the mass of the first grain) or, for a contact with a fixed body, the speed of the body's surface,
    /// m/s. Idle lanes use the first slot.
    pub(super) fn of<'a, M: Model>(
        rows: impl Iterator<Item = (&'a Row<M>, [u32; 2], f64)>,
    ) -> Self {
        let mut block = Self {
            i: [0; LANES],
            j: [0; LANES],
            share_or_speed: [0.0; LANES],
            normal: [[0.0; LANES]; 2],
            shifted_impulse: [0.0; LANES],
            tangential_impulse: [0.0; LANES],
            restitution_velocity: [0.0; LANES],
            effective_mass: [0.0; LANES],
        };
        for (lane, (row, slots, share_or_speed)) in rows.enumerate() {
            [block.i[lane], block.j[lane]] = slots;
            block.share_or_speed[lane] = share_or_speed;
            [block.normal[0][lane], block.normal[1][lane]] = M::components(row.normal);
            block.shifted_impulse[lane] = row.shifted_impulse;
            block.tangential_impulse[lane] = row.tangential_impulse;
            block.restitution_velocity[lane] = row.restitution_velocity;
            block.effective_mass[lane] = row.effective_mass;
        }
        block
    }

    /// Copies the impulses from the block to the rows (the data of one contact each) of its contacts.
    pub(super) fn store<'a, M: Model>(&self, rows: impl Iterator<Item = &'a mut Row<M>>) {
        for (lane, row) in rows.enumerate() {
            row.shifted_impulse = self.shifted_impulse[lane];
            if M::FRICTION {
                row.tangential_impulse = self.tangential_impulse[lane];
            }
        }
    }

    /// Returns the sum of the squared impulses of the block's contacts, (N·s)². The cohesion impulse, which the block
    /// stores as part of the normal impulse, is subtracted: `captures` contains the capture speeds of the contacts, m/s
    /// (cohesion impulse divided by effective mass, the opening speed that cohesion cancels in one step).
    #[inline(always)]
    pub(super) fn squared_impulses(&self, captures: [f64; LANES]) -> f64 {
        sum(std::array::from_fn(|lane| {
            let normal = self.shifted_impulse[lane] - captures[lane];
            let impulse = [normal, self.tangential_impulse[lane]];
            squared_impulse(self.effective_mass[lane], impulse)
        }))
    }

    #[inline(always)]
    fn local<M: Model, S: Simd>(&self, simd: S) -> Local<M, f64x4<S>> {
        let [x, y] = self.normal;
        Local {
            normal: M::normal([f64x4::simd_from(simd, x), f64x4::simd_from(simd, y)]),
            restitution_velocity: f64x4::simd_from(simd, self.restitution_velocity),
            effective_mass: f64x4::simd_from(simd, self.effective_mass),
        }
    }

    #[inline(always)]
    fn impulse<S: Simd>(&self, simd: S) -> [f64x4<S>; 2] {
        [self.shifted_impulse, self.tangential_impulse].map(|it| f64x4::simd_from(simd, it))
    }

    #[inline(always)]
    fn set_impulse<S: Simd, M: Model>(&mut self, [shifted, tangential]: [f64x4<S>; 2]) {
        self.shifted_impulse = shifted.to_array();
        if M::FRICTION {
            self.tangential_impulse = tangential.to_array();
        }
    }
}

/// Loads the velocities of four bodies, one per SIMD lane.
#[inline(always)]
fn gather<S: Simd, M: Model>(
    simd: S,
    slots: &[BodySlot],
    indices: [u32; LANES],
) -> M::Body<f64x4<S>> {
    let bodies = indices.map(|index| f64x4::simd_from(simd, slots[index as usize].0));
    let [x, y, spin, _] = transposed(bodies);
    M::from_coordinates([x, y, spin])
}

/// Transposes four vectors of four numbers: turns the memory slots with the velocities of four bodies into one vector
/// for each velocity component, and back. Slots are read and written whole, in one access each: a read of a single
/// number would have to wait until the previous block has written the whole slot.
#[inline(always)]
fn transposed<S: Simd>([a, b, c, d]: [f64x4<S>; LANES]) -> [f64x4<S>; LANES] {
    let (ac, bd) = (a.zip_low(c), b.zip_low(d));
    let (other_ac, other_bd) = (a.zip_high(c), b.zip_high(d));
    [ac.zip_low(bd), ac.zip_high(bd), other_ac.zip_low(other_bd), other_ac.zip_high(other_bd)]
}

/// Stores the velocities of four bodies, one per SIMD lane, in their memory slots.
#[inline(always)]
fn scatter<S: Simd, M: Model>(
    slots: &mut [BodySlot],
    indices: [u32; LANES],
    bodies: &M::Body<f64x4<S>>,
) {
    let [x, y, spin] = M::coordinates(bodies);
    let bodies = transposed([x, y, spin, spin.same(0.0)]);
    for (index, body) in indices.into_iter().zip(bodies) {
        slots[index as usize] = BodySlot(body.to_array());
    }
}

/// Blocks of the contacts of a tile (a group of contacts that shares no grain with another tile), or of the contacts
/// between tiles. Blocks of contacts with fixed bodies come first.
pub(super) struct Blocks<'a> {
    pub all: &'a mut [ContactBlock],
    /// Number of blocks of contacts with fixed bodies.
    pub fixed: usize,
}

/// Solves blocks of four contacts one after the other: first contacts with fixed bodies, then contacts between grains.
/// Returns the change of the impulses, which is measured if `MEASURE` is set and otherwise 0.
#[inline(always)]
pub(super) fn solve_blocks<S: Simd, M: Model, const MEASURE: bool>(
    simd: S,
    law: &ContactLaw,
    blocks: Blocks<'_>,
    slots: &mut [BodySlot],
) -> ImpulseChange {
    let none = f64x4::splat(simd, 0.0);
    let mut change = ImpulseChange { squared: none, absolute: none };
    let (fixed, pairs) = blocks.all.split_at_mut(blocks.fixed);
    let project = |trial| project_by_coulomb::<M, f64x4<S>>(law, trial);
    for block in fixed {
        let local = block.local::<M, S>(simd);
        let surface_speed = f64x4::simd_from(simd, block.share_or_speed);
        let mut impulse = block.impulse(simd);
        let mut i = gather::<S, M>(simd, slots, block.i);
        local.solve_fixed::<MEASURE>(surface_speed, &mut impulse, &mut i, &mut change, project);
        scatter::<S, M>(slots, block.i, &i);
        block.set_impulse::<S, M>(impulse);
    }
    for block in pairs {
        let local = block.local::<M, S>(simd);
        let share = f64x4::simd_from(simd, block.share_or_speed);
        let mut impulse = block.impulse(simd);
        let mut i = gather::<S, M>(simd, slots, block.i);
        let mut j = gather::<S, M>(simd, slots, block.j);
        let both = [&mut i, &mut j];
        local.solve_pair::<MEASURE>(share, &mut impulse, both, &mut change, project);
        scatter::<S, M>(slots, block.i, &i);
        scatter::<S, M>(slots, block.j, &j);
        block.set_impulse::<S, M>(impulse);
    }
    let ImpulseChange { squared, absolute } = change;
    ImpulseChange { squared: sum(squared.to_array()), absolute: sum(absolute.to_array()) }
}

/// Returns the squared numerator of the residual (`problem::residual`): the sum of the squared errors of the normal and
/// tangential impulse over the contacts of the blocks, (N·s)².
#[inline(always)]
pub(super) fn squared_error<S: Simd, M: Model>(
    simd: S,
    law: &ContactLaw,
    blocks: Blocks<'_>,
    slots: &[BodySlot],
) -> f64 {
    let mut sum_of_lanes = f64x4::splat(simd, 0.0);
    for (at, block) in blocks.all.iter().enumerate() {
        let local = block.local::<M, S>(simd);
        let i = gather::<S, M>(simd, slots, block.i);
        let velocity = if at < blocks.fixed {
            local.velocity(f64x4::simd_from(simd, block.share_or_speed), &i)
        } else {
            let j = gather::<S, M>(simd, slots, block.j);
            M::relative_velocity(local.normal, &i, &j)
        };
        let impulse = block.impulse(simd);
        let [normal, tangential] =
            errors::<M, _>(law, impulse, local.restitution_velocity, velocity)
                .map(|error| local.effective_mass * error);
        sum_of_lanes += normal * normal + tangential * tangential;
    }
    sum(sum_of_lanes.to_array())
}

/// Returns the sum of the numbers of all SIMD lanes.
#[inline(always)]
pub(super) fn sum([a, b, c, d]: [f64; LANES]) -> f64 {
    (a + b) + (c + d)
}
