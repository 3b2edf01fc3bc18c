//! What of the observables plots show by themselves.

use super::{Observables, Quantity};

/// What can be plotted, in the order in which it is shown.
pub const QUANTITIES: &[Quantity<Observables>] = &[
    Quantity { name: "slump", title: "slump Δy", value: |row| row.slump, ..Quantity::PLAIN },
    Quantity {
        name: "overlap",
        title: "mean overlap δ/d (%)",
        value: |row| 100.0 * row.mean_overlap,
        ..Quantity::PLAIN
    },
    Quantity {
        name: "residual",
        title: "residual",
        logarithmic: true,
        value: |row| row.residual,
        beside: &[
            ("the model's", |row| row.model_residual.filter(|_| row.is_of_a_model())),
            ("its duality gap", |row| row.duality_gap.filter(|_| row.is_of_a_model())),
        ],
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
    use crate::sim::observables::Beside;

    /// Columns that the window does not plot.
    const NOT_PLOTTED: &str = "step time_secs time_step_secs sweeps factorisations converged stalled fell_back \
        contacts compressive_contacts tensile_contacts max_overlap potential_energy normal_work \
        tangential_work wall_work drive_work border_work gravity_work bond_work drive_energy lost_grains";

    #[test]
    fn every_column_is_plotted_or_said_not_to_be() {
        // A step that was solved under a model: others have nothing of it to plot.
        let plain = Observables { step: 7, duality_gap: Some(0.5), ..Observables::default() };
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
