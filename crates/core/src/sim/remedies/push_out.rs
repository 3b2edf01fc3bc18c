//! Remedy (optional correction of a step) `push-out`: pushes overlapping grains apart after a step.

use glam::DVec2;

use crate::contact::Numbering;
use crate::number::Parts;
use crate::sim::state::State;

/// Overlap that the remedy `push-out` (an optional correction, which pushes overlapping grains apart) leaves, in mean
/// diameters. Cohesive contacts need some overlap: with a smaller value, rounding breaks contacts. A larger value is
/// visible in the measurements.
const LEFT: f64 = 2e-4;
/// Fraction of the overlap beyond [`LEFT`] that is removed per step. With a larger value, piles visibly jump; with a
/// smaller value, the removal takes more steps.
const SHARE: f64 = 0.2;
/// Number of Gauss–Seidel sweeps in the calculation of the displacements. The next step corrects the remaining error.
const SWEEPS: u32 = 8;

/// Data of one contact in the calculation of the displacements that push grains apart.
struct PushedContact {
    i: usize,
    j: Option<usize>,
    normal: DVec2,
    /// Required increase of the gap, m. If it is negative, the gap may decrease by up to its absolute value.
    want: f64,
    /// Push λ of the contact, kg·m: it displaces a grain of the mass m (kg) by λ/m (m), as an impulse would change the
    /// velocity of the grain.
    push: f64,
    /// Effective mass of the two bodies, kg.
    mass: f64,
}

/// Moves overlapping grains apart after a step with the time step `time_step_secs` (s). The contacts of `state` are
/// still those of the beginning of the step.
///
/// The displacements δ of the grains increase the gap of each contact that overlaps by more than [`LEFT`], by a
/// fraction ([`SHARE`]) of the overlap beyond [`LEFT`]. All other gaps may decrease, but only until the overlap is
/// [`LEFT`]. Let `want` (m) be the required increase of a gap, which is negative if the gap may decrease, n the normal
/// and λ ≥ 0 (kg·m) the push of the contact, and m_i (kg) the mass of grain i. Then δ_i (m) is the sum of n λ/m_i over
/// the contacts of grain i, and each contact of the grains i and j has
///
/// > 0 ≤ λ ⟂ n·(δ_i − δ_j) − want ≥ 0.
///
/// This is again Signorini's law, solved by a few sweeps of projected Gauss–Seidel. Velocities do not change, so grains
/// gain no kinetic energy; a lifted grain gains potential energy.
pub(in crate::sim) fn push_out(state: &mut State, time_step_secs: f64) {
    let State { world, contacts, walls, .. } = state;
    let left = LEFT * world.mean_diameter;
    let (grains, numbering) = (&world.grains, Numbering::of(world));
    let mut rows = Vec::with_capacity(contacts.contacts().len());
    let mut deepest = 0f64;
    for contact in contacts.contacts() {
        let i = contact.grain as usize;
        let j = numbering.other(contact.other).grain();
        let velocity_of = |j| grains.velocities[j] + world.speed_of_image(i, j) * DVec2::X;
        let velocity_of_other = j.map_or(DVec2::ZERO, velocity_of);
        let approach = (grains.velocities[i] - velocity_of_other).dot(contact.normal);
        let centre = grains.positions[i] - time_step_secs * grains.velocities[i];
        let surface = walls.surface_at(world, contact, centre);
        let approach = approach - surface.map_or(0.0, |it| it.along(contact.normal)[0]);
        let depth = -(contact.gap + time_step_secs * approach) - left;
        deepest = deepest.max(depth);
        let inverse = 1.0 / grains.masses[i] + j.map_or(0.0, |j| 1.0 / grains.masses[j]);
        let want = if depth > 0.0 { SHARE * depth } else { depth };
        rows.push(PushedContact {
            i,
            j,
            normal: contact.normal,
            want,
            push: 0.0,
            mass: 1.0 / inverse,
        });
    }
    if deepest <= 0.0 {
        return;
    }
    let mut moves = vec![DVec2::ZERO; grains.len()];
    for _ in 0..SWEEPS {
        for row in &mut rows {
            let move_of_other = row.j.map_or(DVec2::ZERO, |j| moves[j]);
            let lacks = row.want - (moves[row.i] - move_of_other).dot(row.normal);
            let push = (row.push + row.mass * lacks).positive_part();
            let change = (push - row.push) * row.normal;
            row.push = push;
            moves[row.i] += change / grains.masses[row.i];
            if let Some(j) = row.j {
                moves[j] -= change / grains.masses[j];
            }
        }
    }
    for (position, by) in world.grains.positions.iter_mut().zip(moves) {
        *position += by;
    }
}
