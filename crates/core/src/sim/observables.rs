//! What every step reports of itself: the columns, how they are found, and what plots show of them.

use serde::{Deserialize, Serialize};

use crate::contact::{Numbering, Other};
use crate::number::{self, Parts};
use crate::sim::settings::Settings;
use crate::sim::state::State;
use crate::sim::stepping::{BondEnergies, Stage, StepResult};
use crate::solver::{Measures, Model, SolveReport};
use crate::world::{Drive, Periodic};

/// Measured after each step. One row of the observables' CSV, which has the names of columns in recordings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Observables {
    /// Steps taken so far.
    pub step: u64,
    /// Simulated time, s.
    #[serde(rename = "time")]
    pub time_secs: f64,
    /// Δt of this step, s.
    #[serde(rename = "time_step")]
    pub time_step_secs: f64,
    /// Sweeps of the solver; of a scheme, its passes over all contacts.
    pub sweeps: u32,
    /// Matrices that the solver factorised.
    pub factorisations: u32,
    /// True where the stopping test was met within the sweep limit; true for a scheme, which does a
    /// fixed amount of work and tests nothing. What its step is worth, `residual` tells.
    pub converged: bool,
    /// True where a step that did not converge had stalled: its residual had stopped falling, so that
    /// more sweeps are of no use. As a rule it has no solution (`docs/accuracy-and-cost.md`).
    #[serde(default)]
    pub stalled: bool,
    /// The common residual (`solver::residual`), dimensionless. For a scheme: that of the step's
    /// problem with the impulses that the scheme summed up and the velocities it ended with.
    pub residual: f64,
    /// The same measure of the model of friction that was solved in the place of Coulomb's law,
    /// dimensionless; none under that law.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model_residual: Option<f64>,
    /// How far the velocities are taken to be from those that Coulomb's law asks for, whatever was solved, m/s: root mean
    /// square over the grains that touch something, weighted with mass
    /// ([`VelocityError`](crate::solver::VelocityError)).
    #[serde(default)]
    pub velocity_error: f64,
    /// All contacts, with grains and with fixed shapes.
    pub contacts: u32,
    /// Contacts with N > 0.
    pub compressive_contacts: u32,
    /// Contacts with N < 0.
    pub tensile_contacts: u32,
    /// δ: mean of |gap|/d over touching grain pairs.
    pub mean_overlap: f64,
    /// Largest overlap of any contact, in units of d.
    pub max_overlap: f64,
    /// Kinetic energy, J.
    pub kinetic_energy: f64,
    /// Potential energy in the gravity field, J.
    pub potential_energy: f64,
    /// Work that the normal contact forces did in this step, J.
    pub normal_work: f64,
    /// Work that the tangential contact forces did in this step, J.
    pub tangential_work: f64,
    /// Work that surfaces which move did on grains in this step, a part of the two before, J: what is left of those
    /// is what contacts took.
    #[serde(default)]
    pub wall_work: f64,
    /// Σ ½MV² of the walls that a force drives, along the axes of the forces, J. None where there are no such walls.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drive_energy: Option<f64>,
    /// Work in this step of the forces that drive walls, less what the walls' damping took, J: it changes
    /// `drive_energy` by what the walls did not hand on to grains. None where there are no such walls.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drive_work: Option<f64>,
    /// Work that borders which shear did in this step, beside the other works, J: through contacts with images that
    /// slide, and on grains that crossed. None where no border shears.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub border_work: Option<f64>,
    /// Work of the gravity field, of body forces, and of a spring that pulls a grain, in this step, J.
    pub gravity_work: f64,
    /// Δy_G = Σ(y_i(0) − y_i(t)) / Σ y_i(0) (paper eq. 11), both sums over the grains that are not
    /// lost; 0 where Σ y_i(0) is 0, and NaN where all grains are lost.
    #[serde(with = "number")]
    pub slump: f64,
    /// Work that bonds did in this step, a part of `normal_work`, J: negative while they are
    /// stretched. None but under the law `range`, as all that is told of bonds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bond_work: Option<f64>,
    /// Σ C₀ s over the bonds that live, J: what stretching them took.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bond_energy: Option<f64>,
    /// What bonds took that have broken since the start, J: C₀ δ_c each.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub broken_bond_energy: Option<f64>,
    /// Grains that went through a wall or left the world since the start.
    #[serde(default)]
    pub lost_grains: u32,
}

impl Observables {
    /// True where it tells of what only some runs have: bonds, a model of friction, walls that a force drives, or
    /// borders that shear.
    pub fn has_further_columns(&self) -> bool {
        let Self { bond_work, model_residual, drive_energy, border_work, .. } = self;
        [bond_work, model_residual, drive_energy, border_work].iter().any(|some| some.is_some())
    }

    /// True where a step was solved under another model of friction than Coulomb's law.
    pub fn is_of_a_model(&self) -> bool {
        self.step > 0 && self.model_residual.is_some_and(|left| left != self.residual)
    }

    /// With numbers that are none where there is not what they tell of, so that rows with and without them fit in
    /// one table.
    pub fn with_further_columns(self) -> Self {
        let number = |value: Option<f64>| Some(value.unwrap_or(f64::NAN));
        Self {
            model_residual: number(self.model_residual),
            drive_energy: number(self.drive_energy),
            drive_work: number(self.drive_work),
            border_work: number(self.border_work),
            bond_work: number(self.bond_work),
            bond_energy: number(self.bond_energy),
            broken_bond_energy: number(self.broken_bond_energy),
            ..self
        }
    }
}

/// The observables after a step of Δt that began with those `before`.
pub(super) fn after_step<M: Model>(
    stage: &Stage<'_, M>,
    result: StepResult,
    time_step_secs: f64,
    before: &Observables,
    initial_heights: f64,
) -> Observables {
    let moving = stage.problem.bodies.now.iter().zip(&stage.state.world.grains.masses);
    let kinetic_energy = moving.map(|(body, &mass)| M::kinetic_energy(body, mass)).sum();
    Observables {
        step: before.step + 1,
        time_secs: before.time_secs + time_step_secs,
        broken_bond_energy: result
            .bonds
            .map(|bonds| before.broken_bond_energy.unwrap_or(0.0) + bonds.broken),
        ..of_state::<M>(stage.state, result, kinetic_energy, time_step_secs, initial_heights)
    }
}

/// The observables of an initial state whose contacts have been found: energies, and the contacts that
/// are there before any impulse. The settings say which observables a step has.
pub(super) fn at_start<M: Model>(
    state: &State,
    settings: &Settings,
    initial_heights: f64,
) -> Observables {
    let energy = |index: usize| {
        let body = M::body(&state.world, index);
        M::kinetic_energy(&body, state.world.grains.masses[index])
    };
    let bonds = settings.stepper.has_bonds().then(BondEnergies::default);
    let none_yet = settings.solves_models().then_some(0.0);
    let measures = Measures { model_residual: none_yet, ..Measures::default() };
    let result = StepResult { bonds, measures, ..StepResult::nothing_yet() };
    let time_step_secs = settings.parameters.time_step_secs;
    let kinetic_energy = (0..state.world.grains.len()).map(energy).sum();
    of_state::<M>(state, result, kinetic_energy, time_step_secs, initial_heights)
}

/// What a state and what led to it tell, as at the beginning of a run. Each observable is named, so that none
/// is forgotten.
fn of_state<M: Model>(
    state: &State,
    result: StepResult,
    kinetic_energy: f64,
    time_step_secs: f64,
    initial_heights: f64,
) -> Observables {
    let StepResult { report, measures, gravity_work, drive_work, bonds, .. } = result;
    let SolveReport { sweeps, factorisations, converged, stalled } = report;
    let Measures { residual, model_residual, velocity_error, .. } = measures;
    let Measures { compressive_contacts, tensile_contacts, .. } = measures;
    let Measures { normal_work, tangential_work, wall_work, border_work, .. } = measures;
    let is_sheared = state.world.periodic.is_some_and(Periodic::is_sheared);
    let drives = state.world.motions.iter().filter_map(|motion| motion.drive.as_ref());
    let drive_energy = drives.map(Drive::kinetic_energy).reduce(|one, other| one + other);
    let [mean_overlap, max_overlap] = overlaps(state, bonds.is_some());
    let [heights, potential_energy] = heights(state);
    let dropped = initial_heights - heights;
    let in_touch = |index: &usize| state.contacts.is_in_touch(*index);
    Observables {
        step: 0,
        time_secs: 0.0,
        time_step_secs,
        sweeps,
        factorisations,
        converged,
        stalled,
        residual,
        model_residual,
        velocity_error,
        contacts: (0..state.contacts.contacts().len()).filter(in_touch).count() as u32,
        compressive_contacts,
        tensile_contacts,
        mean_overlap,
        max_overlap,
        kinetic_energy,
        potential_energy,
        normal_work,
        tangential_work,
        wall_work,
        drive_energy,
        drive_work: drive_energy.map(|_| drive_work),
        border_work: is_sheared.then_some(border_work),
        gravity_work,
        // On a line nothing can slump, and about a mean height of 0 a relative drop says nothing.
        slump: if M::AXES == 1 || initial_heights == 0.0 { 0.0 } else { dropped / initial_heights },
        bond_work: bonds.map(|bonds| bonds.work),
        bond_energy: bonds.map(|bonds| bonds.stored),
        broken_bond_energy: bonds.map(|bonds| bonds.broken),
        // Who watches over the run knows (`sim::losses`).
        lost_grains: 0,
    }
}

/// Sum of the grains' heights, m, and their potential energy, J.
pub(super) fn heights(state: &State) -> [f64; 2] {
    let (grains, gravity) = (&state.world.grains, &state.world.gravity);
    let mut heights = 0.0;
    let mut potential_energy = 0.0;
    for (index, &position) in grains.positions.iter().enumerate() {
        heights += position.y;
        if grains.feels_gravity[index] {
            potential_energy += grains.masses[index] * gravity.potential(position);
        }
    }
    [heights, potential_energy]
}

/// Mean overlap of grains that touch and largest of all contacts, in d.
pub(super) fn overlaps(state: &State, bonds: bool) -> [f64; 2] {
    let State { world, contacts, .. } = state;
    let numbering = Numbering::of(world);
    let mut overlap_of_pairs = 0.0;
    let mut pairs = 0u32;
    let mut deepest = 0f64;
    for (index, contact) in contacts.contacts().iter().enumerate() {
        if !contacts.is_in_touch(index) {
            continue;
        }
        deepest = deepest.max((-contact.gap).positive_part());
        if let Other::Grain(_) = numbering.other(contact.other) {
            // A bond may be stretched; what is not overlap does not count as such.
            overlap_of_pairs +=
                if bonds { (-contact.gap).positive_part() } else { contact.gap.abs() };
            pairs += 1;
        }
    }
    [
        overlap_of_pairs / f64::from(pairs.max(1)) / world.mean_diameter,
        deepest / world.mean_diameter,
    ]
}

/// Something to plot of rows of a kind.
#[derive(Clone, Copy, Debug)]
pub struct Quantity<Row: 'static> {
    /// Its name on buttons.
    pub name: &'static str,
    /// What it shows.
    pub title: &'static str,
    /// Its unit, if that takes prefixes such as k.
    pub unit: &'static str,
    /// True where equal distances are equal factors.
    pub logarithmic: bool,
    /// Its value.
    pub value: fn(&Row) -> f64,
    /// What is shown beside it where there is any, the first dashed and the second dotted: names and values.
    pub beside: &'static [Beside<Row>],
}

/// Name and value.
pub type Beside<Row> = (&'static str, fn(&Row) -> Option<f64>);

impl<Row> Quantity<Row> {
    /// Without a unit, on a linear axis, alone.
    pub const PLAIN: Self = Self {
        name: "",
        title: "",
        unit: "",
        logarithmic: false,
        value: |_| f64::NAN,
        beside: &[],
    };
}

/// What can be plotted, in the order in which it is shown.
pub const QUANTITIES: &[Quantity<Observables>] = &[
    Quantity { name: "slump", title: "slump Δy", value: |row| row.slump, ..Quantity::PLAIN },
    Quantity {
        name: "overlap",
        title: "largest overlap δ/d (%)",
        value: |row| 100.0 * row.max_overlap,
        beside: &[("mean of pairs", |row| Some(100.0 * row.mean_overlap))],
        ..Quantity::PLAIN
    },
    Quantity {
        name: "error",
        title: "error of velocities (m/s)",
        logarithmic: true,
        value: |row| row.velocity_error,
        ..Quantity::PLAIN
    },
    Quantity {
        name: "energy",
        title: "kinetic energy",
        unit: "J",
        value: |row| row.kinetic_energy,
        beside: &[
            ("stored in bonds", |row| row.bond_energy),
            ("taken by broken ones", |row| row.broken_bond_energy),
        ],
        ..Quantity::PLAIN
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns that the window does not plot.
    const NOT_PLOTTED: &str = "step time time_step sweeps factorisations converged stalled residual \
        model_residual contacts compressive_contacts tensile_contacts potential_energy normal_work \
        tangential_work wall_work drive_work border_work gravity_work bond_work drive_energy lost_grains";

    #[test]
    fn every_column_is_plotted_or_said_not_to_be() {
        // A step that was solved under a model: others have nothing of it to plot.
        let plain = Observables { step: 7, model_residual: Some(0.5), ..Observables::default() };
        let columns = serde_json::to_value(plain.with_further_columns()).unwrap();
        let columns = columns.as_object().unwrap();
        let fields = format!("{plain:?}").matches(": ").count();
        assert_eq!(columns.len(), fields, "columns where there are bonds");
        for (column, value) in columns {
            let mut row = serde_json::to_value(plain).unwrap();
            row[column] = if value.is_boolean() { true.into() } else { 1.into() };
            let row: Observables = serde_json::from_value(row).unwrap();
            let tells = |quantity: &Quantity<Observables>| {
                let beside = |(_, value): &Beside<Observables>| value(&row) != value(&plain);
                (quantity.value)(&row) != (quantity.value)(&plain)
                    || quantity.beside.iter().any(beside)
            };
            let plotted = QUANTITIES.iter().any(tells);
            assert_ne!(plotted, NOT_PLOTTED.split(' ').any(|name| name == column), "{column}");
        }
    }
}
