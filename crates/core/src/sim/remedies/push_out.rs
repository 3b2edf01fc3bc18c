//! The remedy `push-out`: grains that overlap are moved apart after a step.

use glam::DVec2;

use crate::contact::Numbering;
use crate::number::Parts;
use crate::sim::state::State;

/// Overlap that is left, in d: cohesive contacts live on overlap. Smaller: contacts are lost to
/// rounding; larger: it shows in what is measured.
const LEFT: f64 = 2e-4;
/// Part of the rest that one step takes away. Larger: piles visibly jump; smaller: it takes longer.
const SHARE: f64 = 0.2;
/// Sweeps. What they leave, the next step takes up.
const SWEEPS: u32 = 8;

/// A contact to be pushed.
struct PushedContact {
    i: usize,
    j: Option<usize>,
    normal: DVec2,
    /// By how much its gap has to grow, m; negative is what it may shrink.
    want: f64,
    /// λ, kg·m.
    push: f64,
    /// 1/w, kg.
    mass: f64,
}

/// Moves the grains after a step of that length, whose contacts are still those of its beginning.
///
/// After a step the grains are moved by δ so that each contact's gap grows by a part of what it
/// overlaps too much, and no contact is pushed into overlap by its neighbours. With w = 1/m_i + 1/m_j
/// and λ the push of a contact, δ_i = Σ n λ/m_i,
///
/// > 0 ≤ λ ⟂ n·(δ_i − δ_j) − want ≥ 0,
///
/// which is Signorini's law again, solved by a few sweeps of projected Gauss–Seidel. Velocities stay
/// as they are, so no kinetic energy is gained; a grain that is lifted gains the height.
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
