//! Contacts side by side: a block holds four that share no grain, one a lane, as structure of arrays.
//!
//! All four are solved at once by the arithmetic of one (`shared::update`), in the vector registers
//! that the processor turns out to have: to the last bit what they give one after the other. Rows
//! that fill no block are solved one by one, so no lane is idle or needs a body to stand in.

use fearless_simd::{Level, Simd, SimdBase, SimdFrom, dispatch, f64x4};

use crate::solver::methods::shared::update::{Body, Change, Law, Local, squared_impulse};
use crate::solver::problem::{Kinematics, Model, Row};

/// Contacts in a block: the numbers in a register of AVX2. Wider blocks would leave more rows over.
pub(super) const LANES: usize = 4;

/// Four contacts, lane by lane as in [`Row`]: four cache lines.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Block {
    i: [u32; LANES],
    j: [u32; LANES],
    normal: [[f64; LANES]; 2],
    share: [f64; LANES],
    restitution_velocity: [f64; LANES],
    shifted_impulse: [f64; LANES],
    tangential_impulse: [f64; LANES],
    effective_mass: [f64; LANES],
}

impl Block {
    /// The block of these rows.
    pub(super) fn of<K: Kinematics>(rows: &[Row<K>; LANES]) -> Self {
        let rows = rows.each_ref();
        Self {
            i: rows.map(|row| row.i),
            j: rows.map(|row| row.j),
            normal: [0, 1].map(|axis| rows.map(|row| K::components(row.normal)[axis])),
            share: rows.map(|row| row.share),
            restitution_velocity: rows.map(|row| row.restitution_velocity),
            shifted_impulse: rows.map(|row| row.shifted_impulse),
            tangential_impulse: rows.map(|row| row.tangential_impulse),
            effective_mass: rows.map(|row| row.effective_mass),
        }
    }

    /// Gives the rows their impulses.
    pub(super) fn store<M: Model>(&self, rows: &mut [Row<M::Kinematics>; LANES]) {
        for (lane, row) in rows.iter_mut().enumerate() {
            row.shifted_impulse = self.shifted_impulse[lane];
            if M::FRICTION {
                row.tangential_impulse = self.tangential_impulse[lane];
            }
        }
    }

    /// P² of each contact, (N·s)², given the capture speeds.
    #[inline(always)]
    pub(super) fn squared_impulses(&self, captures: [f64; LANES]) -> [f64; LANES] {
        std::array::from_fn(|lane| {
            let normal = self.shifted_impulse[lane] - captures[lane];
            let impulse = [normal, self.tangential_impulse[lane]];
            squared_impulse(self.effective_mass[lane], impulse)
        })
    }

    #[inline(always)]
    fn local<K: Kinematics, S: Simd>(&self, simd: S) -> Local<K, f64x4<S>> {
        let [x, y] = self.normal;
        Local {
            normal: K::normal([f64x4::simd_from(simd, x), f64x4::simd_from(simd, y)]),
            share: f64x4::simd_from(simd, self.share),
            restitution_velocity: f64x4::simd_from(simd, self.restitution_velocity),
            effective_mass: f64x4::simd_from(simd, self.effective_mass),
        }
    }
}

/// The bodies of a problem, to be reached from several threads.
///
/// Who solves contacts on it answers for two things: their grains are among the bodies, and no body
/// is touched from two places at a time.
pub(super) struct Bodies<M: Model>(*mut Body<M, f64>);

impl<M: Model> Clone for Bodies<M> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<M: Model> Copy for Bodies<M> {}

// SAFETY: bodies are plain numbers (`Kinematics::Body` is `Send`), and no two threads touch the same
// one (see the type).
unsafe impl<M: Model> Send for Bodies<M> {}
// SAFETY: as for `Send`.
unsafe impl<M: Model> Sync for Bodies<M> {}

impl<M: Model> Bodies<M> {
    /// These bodies.
    pub(super) fn new(bodies: &mut [Body<M, f64>]) -> Self {
        Self(bodies.as_mut_ptr())
    }

    /// One body.
    ///
    /// # Safety
    /// It must be among the bodies, and nothing else may touch it meanwhile.
    #[inline(always)]
    unsafe fn at<'a>(self, index: u32) -> &'a mut Body<M, f64> {
        // SAFETY: as for this function.
        unsafe { &mut *self.0.add(index as usize) }
    }

    /// Bodies, one a lane.
    ///
    /// # Safety
    /// As for [`Bodies::at`].
    #[inline(always)]
    unsafe fn gather<S: Simd>(self, simd: S, [a, b, c, d]: [u32; LANES]) -> Body<M, f64x4<S>> {
        // SAFETY: as for this function.
        let of = |index| unsafe { M::Kinematics::coordinates(self.at(index)) };
        let (a, b, c, d) = (of(a), of(b), of(c), of(d));
        M::Kinematics::from_coordinates([
            f64x4::simd_from(simd, [a[0], b[0], c[0], d[0]]),
            f64x4::simd_from(simd, [a[1], b[1], c[1], d[1]]),
            f64x4::simd_from(simd, [a[2], b[2], c[2], d[2]]),
        ])
    }

    /// Puts gathered bodies back.
    ///
    /// # Safety
    /// As for [`Bodies::at`].
    #[inline(always)]
    unsafe fn scatter<S: Simd>(self, indices: [u32; LANES], bodies: &Body<M, f64x4<S>>) {
        let [x, y, spin] = M::Kinematics::coordinates(bodies);
        let (x, y, spin) = (x.to_array(), y.to_array(), spin.to_array());
        for lane in 0..LANES {
            // SAFETY: as for this function.
            let body = unsafe { self.at(indices[lane]) };
            M::Kinematics::set(body, [x[lane], y[lane], spin[lane]]);
        }
    }
}

/// Solves contacts that share no grain: those of `blocks`, and those of `rows`.
///
/// # Safety
/// As [`Bodies`] says.
pub(super) unsafe fn solve_apart<M: Model, const MEASURE: bool, const PAIR: bool>(
    level: Level,
    law: &Law,
    (blocks, rows): (&mut [Block], &mut [Row<M::Kinematics>]),
    bodies: Bodies<M>,
) -> Change {
    // SAFETY: as for this function.
    dispatch!(level, simd => unsafe {
        let mut change = solve_blocks::<_, M, MEASURE, PAIR>(simd, law, blocks, bodies);
        change.add_all(solve_rows::<M, MEASURE, PAIR>(law, rows, bodies));
        change
    })
}

/// Solves contacts in blocks.
///
/// # Safety
/// As [`Bodies`] says.
#[inline(always)]
unsafe fn solve_blocks<S: Simd, M: Model, const MEASURE: bool, const PAIR: bool>(
    simd: S,
    law: &Law,
    blocks: &mut [Block],
    bodies: Bodies<M>,
) -> Change {
    let none = f64x4::splat(simd, 0.0);
    let mut change = Change { squared: none, absolute: none };
    for block in blocks {
        let local = block.local(simd);
        let mut shifted = f64x4::simd_from(simd, block.shifted_impulse);
        let mut tangential = f64x4::simd_from(simd, block.tangential_impulse);
        let row = (&local, [&mut shifted, &mut tangential]);
        // SAFETY: as for this function; the grains i and j of a block are all different.
        unsafe {
            let mut i = bodies.gather(simd, block.i);
            if PAIR {
                let mut j = bodies.gather(simd, block.j);
                law.solve_pair::<M, _, MEASURE>(row, &mut i, &mut j, &mut change);
                bodies.scatter(block.j, &j);
            } else {
                law.solve_single::<M, _, MEASURE>(row, &mut i, &mut change);
            }
            bodies.scatter(block.i, &i);
        }
        block.shifted_impulse = shifted.to_array();
        if M::FRICTION {
            block.tangential_impulse = tangential.to_array();
        }
    }
    let Change { squared, absolute } = change;
    Change { squared: sum(squared.to_array()), absolute: sum(absolute.to_array()) }
}

/// The sum over all lanes.
#[inline(always)]
pub(super) fn sum([a, b, c, d]: [f64; LANES]) -> f64 {
    (a + b) + (c + d)
}

/// Solves contacts one by one.
///
/// # Safety
/// As [`Bodies`] says.
#[inline(always)]
unsafe fn solve_rows<M: Model, const MEASURE: bool, const PAIR: bool>(
    law: &Law,
    rows: &mut [Row<M::Kinematics>],
    bodies: Bodies<M>,
) -> Change {
    let mut change = Change::default();
    for row in rows {
        // SAFETY: as for this function; grain j, where there is one, is not i.
        unsafe {
            let i = bodies.at(row.i);
            if PAIR {
                law.solve_pair_row::<M, MEASURE>(row, i, bodies.at(row.j), &mut change);
            } else {
                law.solve_single_row::<M, MEASURE>(row, i, &mut change);
            }
        }
    }
    change
}
