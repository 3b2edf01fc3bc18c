//! Observables: the measurements after each step, with their definitions, their computation and their plots.

use serde::{Deserialize, Serialize};

use crate::contact::{Numbering, Other};
use crate::number::{self, Parts};
use crate::sim::settings::Settings;
use crate::sim::state::State;
use crate::sim::stepping::{BondEnergies, Stage, StepResult};
use crate::solver::{Measures, Model, SolveReport};
use crate::world::{Drive, Periodic};

/// Measurements after a step: one row of the table of observables that a run can write to a file. The names of its
/// columns are the names that serde gives these fields.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Observables {
    /// Number of steps taken so far.
    pub step: u64,
    /// Simulated time, s.
    #[serde(rename = "time")]
    pub time_secs: f64,
    /// Length Δt of the last step, s.
    #[serde(rename = "time_step")]
    pub time_step_secs: f64,
    /// Number of sweeps of the solver in the step; for steppers without a solver, number of passes over all contacts.
    pub sweeps: u32,
    /// Number of matrix factorisations by the solver in the step.
    pub factorisations: u32,
    /// True if the solver met its stop criterion within the sweep limit. Always true for steppers without a solver:
    /// they do a fixed amount of work and have no criterion, and `residual` shows how well they solve a step.
    pub converged: bool,
    /// True if the residual of an unsolved step had stopped decreasing, so that more sweeps do not help. Such a step
    /// usually has no solution (`docs/accuracy-and-cost.md`).
    #[serde(default)]
    pub stalled: bool,
    /// Residual (relative error) of the step's contact problem, dimensionless: the same measure for all solvers
    /// (`solver::residual`). For steppers without a solver it is computed from the impulses summed over the step and
    /// the velocities at its end.
    pub residual: f64,
    /// Residual of the step's contact problem under the friction model that the solver used instead of Coulomb
    /// friction, dimensionless; `None` under Coulomb friction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model_residual: Option<f64>,
    /// Estimated distance of the velocities from a solution under Coulomb friction, m/s, also if the solver used
    /// another friction model: the mass-weighted root mean square over the grains in contact
    /// ([`VelocityError`](crate::solver::VelocityError)).
    #[serde(default)]
    pub velocity_error: f64,
    /// Number of contacts between grains, and between grains and fixed discs or boundaries.
    pub contacts: u32,
    /// Number of contacts with a normal force N above 0.
    pub compressive_contacts: u32,
    /// Number of contacts with a normal force N below 0.
    pub tensile_contacts: u32,
    /// Mean overlap δ: the mean of |gap| over touching grain pairs, in mean diameters d.
    pub mean_overlap: f64,
    /// Largest overlap of any contact, in mean diameters d.
    pub max_overlap: f64,
    /// Kinetic energy of all grains, J.
    pub kinetic_energy: f64,
    /// Potential energy of all grains in the gravity field, J.
    pub potential_energy: f64,
    /// Work of the normal contact forces in this step, J.
    pub normal_work: f64,
    /// Work of the tangential contact forces and of the moments of rolling friction in this step, J.
    pub tangential_work: f64,
    /// Work of moving surfaces on grains in this step, J. It is part of `normal_work` and `tangential_work`. The rest
    /// of these two works is the work of the contacts themselves, which is negative if they dissipate energy.
    #[serde(default)]
    pub wall_work: f64,
    /// Kinetic energy Σ ½MV² of the walls driven by a force, with their masses M and their speeds V along the forces,
    /// J. `None` without such walls.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drive_energy: Option<f64>,
    /// Work in this step of the forces that drive walls, minus the loss in the walls' damping, J. `drive_energy`
    /// changes by this work minus the energy transferred to grains. `None` without such walls.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drive_work: Option<f64>,
    /// Work of sheared periodic borders in this step, J: on contacts across the borders, and on grains that crossed
    /// them. It is not part of the other works. `None` without sheared borders.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub border_work: Option<f64>,
    /// Work of gravity, of body forces, and of the spring with which the user pulls a grain, in this step, J.
    pub gravity_work: f64,
    /// Slump Δy_G = Σ(y_i(0) − y_i(t)) / Σ y_i(0) with the heights y_i of the grains (Abramian & Staron 2020, eq. 11),
    /// dimensionless: the relative drop of the mean height. Both sums exclude grains that went through a wall or left
    /// the world. 0 if Σ y_i(0) is 0, and NaN if no grain remains.
    #[serde(with = "number")]
    pub slump: f64,
    /// Work of bonds in this step, J; part of `normal_work`, and negative while bonds are being stretched. `None` under
    /// contact laws other than `range`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bond_work: Option<f64>,
    /// Energy stored in the existing bonds, J: Σ C₀ s with the cohesion force C₀ and the stretch s of each bond. `None`
    /// under contact laws other than `range`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bond_energy: Option<f64>,
    /// Energy dissipated by bonds that broke since the start, J: C₀ δ_c for each bond with the cohesion force C₀ and
    /// the debonding distance δ_c. `None` under contact laws other than `range`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub broken_bond_energy: Option<f64>,
    /// Number of grains that went through a wall or left the world since the start.
    #[serde(default)]
    pub lost_grains: u32,
}

impl Observables {
    /// True if these observables have columns that only some runs have, such as the energies of bonds, the residual
    /// under a friction model, or the works of walls driven by a force or of sheared borders.
    pub fn has_further_columns(&self) -> bool {
        let Self { bond_work, model_residual, drive_energy, border_work, .. } = self;
        [bond_work, model_residual, drive_energy, border_work].iter().any(|some| some.is_some())
    }

    /// Replaces missing columns by NaN, so that rows with and without these columns fit in one table.
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

/// Returns the observables after a step. `before` are the observables after the previous step.
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

/// Returns the observables of an initial state after contact detection: energies, overlaps and the number of contacts.
/// Works, sweeps and residuals are 0. The settings determine which of the optional columns have a value.
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

/// Returns the observables of a state and of the step that led to it. Step number, time and lost grains depend on
/// earlier steps, so this function cannot compute them and sets them to 0. Every field is set by name here, so that no
/// field is forgotten.
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
        // A scene with one axis has no slump, and if the sum of initial heights is 0, the slump is undefined.
        slump: if M::AXES == 1 || initial_heights == 0.0 { 0.0 } else { dropped / initial_heights },
        bond_work: bonds.map(|bonds| bonds.work),
        bond_energy: bonds.map(|bonds| bonds.stored),
        broken_bond_energy: bonds.map(|bonds| bonds.broken),
        // The check for lost grains sets this number later (`sim::losses`).
        lost_grains: 0,
    }
}

/// Returns the sum of the heights of all grains, m, and the potential energy of all grains, J.
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

/// Returns the mean overlap of touching grain pairs and the largest overlap of all contacts, in mean diameters. `bonds`
/// is true under a contact law with bonds, in which a stretched pair has the overlap 0.
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
            // A bond may be stretched. A stretched pair counts as having the overlap 0.
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

/// Quantity that can be plotted: a number for each row of a table.
#[derive(Clone, Copy, Debug)]
pub struct Quantity<Row: 'static> {
    /// Short name of the quantity, shown on buttons.
    pub name: &'static str,
    /// Title of the plot.
    pub title: &'static str,
    /// Unit of the values if it can take a prefix such as k; otherwise empty, and the title contains the unit.
    pub unit: &'static str,
    /// True if the axis for the values of the quantity is logarithmic.
    pub logarithmic: bool,
    /// Computes the value of the quantity from a row of the table.
    pub value: fn(&Row) -> f64,
    /// Additional curves in the same plot: the first is dashed, the second dotted.
    pub beside: &'static [Beside<Row>],
}

/// Name of an additional curve, and a function that returns the value of the curve for a row of the table; `None` if
/// the row has no value.
pub type Beside<Row> = (&'static str, fn(&Row) -> Option<f64>);

impl<Row> Quantity<Row> {
    /// Default values of a plotted quantity: no unit, a linear axis, and no additional curves.
    pub const PLAIN: Self = Self {
        name: "",
        title: "",
        unit: "",
        logarithmic: false,
        value: |_| f64::NAN,
        beside: &[],
    };
}

/// Quantities of the observables that can be plotted, in display order.
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

    /// Names of the observables that the window does not plot, separated by spaces.
    const NOT_PLOTTED: &str = "step time time_step sweeps factorisations converged stalled residual \
        model_residual contacts compressive_contacts tensile_contacts potential_energy normal_work \
        tangential_work wall_work drive_work border_work gravity_work bond_work drive_energy lost_grains";

    #[test]
    fn every_column_is_plotted_or_said_not_to_be() {
        // This step is solved under a friction model, because other steps have no model residual to plot.
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
