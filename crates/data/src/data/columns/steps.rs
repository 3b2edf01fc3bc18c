//! The table of steps: what each of them measured.

use crate::data::table::{Declared, Table, Value, table};
use crate::sim::Observables;

/// A column of energies that some runs alone have: those with bonds, driven walls, or borders that shear.
const fn of_some_runs(
    name: &'static str,
    about: &'static str,
    of: fn(&Observables) -> Option<f64>,
) -> Declared<Observables> {
    Declared::new(name, "J", about, Value::SomeNumber(of))
}

/// A column of what is so or not.
const fn flag(
    name: &'static str,
    about: &'static str,
    of: fn(&Observables) -> Option<bool>,
) -> Declared<Observables> {
    Declared::new(name, "", about, Value::Flag(of))
}

const COLUMNS: &[Declared<Observables>] = &[
    Declared::step(|row| row.step),
    Declared::time(|row| row.time_secs),
    Declared::number("time_step", "s", "time step", |row| row.time_step_secs),
    Declared::count("sweeps", "sweeps of the solver", |row| row.sweeps.into()),
    Declared::count("factorisations", "matrices that it factorised", |row| {
        row.factorisations.into()
    }),
    flag("converged", "whether the step was solved as asked", |row| Some(row.converged)),
    flag("stalled", "whether more sweeps would be of no use", |row| Some(row.stalled)),
    Declared::number("residual", "1", "common residual of the step's problem", |row| row.residual),
    Declared::new(
        "model_residual",
        "1",
        "the same of the model of friction that was solved in the place of Coulomb's law",
        Value::SomeNumber(|row| row.model_residual),
    ),
    Declared::new(
        "duality_gap",
        "1",
        "duality gap of that model, whose square root bounds the error of the velocities",
        Value::SomeNumber(|row| row.duality_gap),
    ),
    Declared::new(
        "fell_back",
        "1",
        "1 where it was solved under bounds of friction in the place of Coulomb's law, else 0",
        Value::SomeNumber(|row| row.fell_back.map(|fell_back| u8::from(fell_back).into())),
    ),
    Declared::count("contacts", "contacts", |row| row.contacts.into()),
    Declared::count("compressive_contacts", "contacts that push", |row| {
        row.compressive_contacts.into()
    }),
    Declared::count("tensile_contacts", "contacts that pull", |row| row.tensile_contacts.into()),
    Declared::number(
        "mean_overlap",
        "1",
        "mean overlap of grains in touch, in mean diameters",
        |row| row.mean_overlap,
    ),
    Declared::number("max_overlap", "1", "largest overlap, in mean diameters", |row| {
        row.max_overlap
    }),
    Declared::number("kinetic_energy", "J", "kinetic energy", |row| row.kinetic_energy),
    Declared::number("potential_energy", "J", "potential energy in the gravity field", |row| {
        row.potential_energy
    }),
    Declared::number("normal_work", "J", "work of the normal contact forces in the step", |row| {
        row.normal_work
    }),
    Declared::number(
        "tangential_work",
        "J",
        "work of the tangential contact forces in the step",
        |row| row.tangential_work,
    ),
    Declared::number(
        "wall_work",
        "J",
        "part of both that surfaces which move did in the step",
        |row| row.wall_work,
    ),
    of_some_runs("drive_energy", "kinetic energy of walls that a force drives", |row| {
        row.drive_energy
    }),
    of_some_runs(
        "drive_work",
        "work in the step of the forces that drive walls, less that of their damping",
        |row| row.drive_work,
    ),
    of_some_runs(
        "border_work",
        "work that borders which shear did in the step, beside the others",
        |row| row.border_work,
    ),
    Declared::number("gravity_work", "J", "work of the gravity field in the step", |row| {
        row.gravity_work
    }),
    Declared::number(
        "slump",
        "1",
        "how far the centre of mass has sunk, in its first height",
        |row| row.slump,
    ),
    of_some_runs("bond_work", "work that bonds did in the step", |row| row.bond_work),
    of_some_runs("bond_energy", "what stretching the bonds that live took", |row| row.bond_energy),
    of_some_runs("broken_bond_energy", "what bonds took that have broken", |row| {
        row.broken_bond_energy
    }),
    Declared::count("lost_grains", "grains that went through a wall or left the world", |row| {
        row.lost_grains.into()
    }),
];

/// Something that each step measures, as tables call it.
pub struct Observed(&'static Declared<Observables>);

impl Observed {
    /// All of them.
    pub fn all() -> impl Iterator<Item = Self> {
        COLUMNS.iter().map(Self)
    }

    /// The one of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::all().find(|observed| observed.0.name == name)
    }

    /// Its name in tables.
    pub fn name(&self) -> &'static str {
        self.0.name
    }

    /// Name and unit.
    pub fn title(&self) -> String {
        let name = self.0.name.replace('_', " ");
        match self.0.unit {
            "" | "1" => name,
            unit => format!("{name} ({unit})"),
        }
    }

    /// What it is, in a few words.
    pub fn about(&self) -> &'static str {
        self.0.about
    }

    /// Its value in a row that has it; 1 and 0 stand for what is so and what is not.
    pub fn of(&self, row: &Observables) -> Option<f64> {
        match self.0.value {
            Value::Number(of) => Some(of(row)),
            Value::SomeNumber(of) => of(row),
            Value::Count(of) => Some(of(row) as f64),
            Value::Flag(of) => of(row).map(|is_so| u8::from(is_so).into()),
            Value::Word(..) | Value::Name(_) => None,
        }
    }
}

/// A row a step.
pub(in crate::data) fn steps(rows: &[Observables]) -> Table {
    table("steps", COLUMNS, rows, &[])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_observable_has_its_column() {
        let row = Observables::default().with_further_columns();
        let row = serde_json::to_value(row).expect("JSON");
        let mut observables: Vec<&str> =
            row.as_object().expect("fields").keys().map(String::as_str).collect();
        let mut columns: Vec<&str> = COLUMNS.iter().map(|column| column.name).collect();
        observables.iter_mut().for_each(|name| *name = name.trim_end_matches("_secs"));
        observables.sort();
        columns.sort();
        assert_eq!(observables, columns);
    }
}
