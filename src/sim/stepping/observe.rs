//! What is observed of a state and of the step that led to it.

use super::{Outcome, Stage};
use crate::contact::{Numbering, Other};
use crate::sim::Observables;
use crate::sim::state::State;
use crate::solver::{Kinematics, Model};

/// The observables after a step of Δt that began with those `before`.
pub(crate) fn after_step<M: Model>(
    stage: &Stage<'_, M>,
    outcome: Outcome,
    time_step_secs: f64,
    before: &Observables,
    initial_heights: f64,
) -> Observables {
    let Outcome { report, measures, gravity_work, bonds } = outcome;
    let moving = stage.problem.bodies.iter().zip(&stage.state.world.grains.masses);
    let kinetic_energy =
        moving.map(|(body, &mass)| M::Kinematics::kinetic_energy(body, mass)).sum();
    Observables {
        step: before.step + 1,
        time_secs: before.time_secs + time_step_secs,
        time_step_secs,
        sweeps: report.sweeps,
        factorisations: report.factorisations,
        converged: report.converged,
        stalled: report.stalled,
        residual: measures.residual,
        compressive_contacts: measures.compressive_contacts,
        tensile_contacts: measures.tensile_contacts,
        normal_work: measures.normal_work,
        tangential_work: measures.tangential_work,
        gravity_work,
        kinetic_energy,
        bond_work: bonds.map(|bonds| bonds.work),
        bond_energy: bonds.map(|bonds| bonds.stored),
        broken_bond_energy: bonds
            .map(|bonds| before.broken_bond_energy.unwrap_or(0.0) + bonds.broken),
        ..geometry::<M>(stage.state, bonds.is_some(), initial_heights)
    }
}

/// The observables of an initial state whose contacts have been found: energies, and the contacts that
/// are there before any impulse. `bonds` tells whether there are any to be observed.
pub(crate) fn at_start<M: Model>(
    state: &State,
    bonds: bool,
    time_step_secs: f64,
    initial_heights: f64,
) -> Observables {
    let energy = |index: usize| {
        let body = M::Kinematics::body(&state.world, index);
        M::Kinematics::kinetic_energy(&body, state.world.grains.masses[index])
    };
    let none_yet = bonds.then_some(0.0);
    Observables {
        time_step_secs,
        converged: true,
        kinetic_energy: (0..state.world.grains.len()).map(energy).sum(),
        bond_work: none_yet,
        bond_energy: none_yet,
        broken_bond_energy: none_yet,
        ..geometry::<M>(state, bonds, initial_heights)
    }
}

/// The observables that positions and contacts alone tell.
fn geometry<M: Model>(state: &State, bonds: bool, initial_heights: f64) -> Observables {
    let State { world, contacts, .. } = state;
    let (grains, numbering) = (&world.grains, Numbering::of(world));
    let mut overlap_of_pairs = 0.0;
    let mut pairs = 0u32;
    let mut smallest_gap = 0f64;
    let mut in_touch = 0;
    for (index, contact) in contacts.contacts().iter().enumerate() {
        if !contacts.is_in_touch(index) {
            continue;
        }
        in_touch += 1;
        smallest_gap = smallest_gap.min(contact.gap);
        if let Other::Grain(_) = numbering.other(contact.other) {
            // A bond may be stretched; what is not overlap does not count as such.
            overlap_of_pairs += if bonds { (-contact.gap).max(0.0) } else { contact.gap.abs() };
            pairs += 1;
        }
    }
    let mut heights = 0.0;
    let mut potential_energy = 0.0;
    for index in 0..grains.len() {
        let position = grains.positions[index];
        heights += position.y;
        if grains.feels_gravity[index] {
            potential_energy += grains.masses[index] * world.gravity.potential(position);
        }
    }
    let dropped = initial_heights - heights;
    Observables {
        contacts: in_touch,
        mean_overlap: overlap_of_pairs / f64::from(pairs.max(1)) / world.mean_diameter,
        max_overlap: -smallest_gap / world.mean_diameter,
        potential_energy,
        // On a line nothing can slump, and about a mean height of 0 a relative drop says nothing.
        slump: if M::Kinematics::AXES == 1 || initial_heights == 0.0 {
            0.0
        } else {
            dropped / initial_heights
        },
        ..Observables::default()
    }
}
