//! Declares the columns of the table of steps: the measurements of each step.

use crate::column_spec::CellValue::{Count, Flag, Number, SomeNumber};
use crate::column_spec::{ColumnSpec, column};
use crate::sim::Observables;

/// Columns of the table of steps, which has one row per step.
pub const STEP_COLUMNS: &[ColumnSpec<Observables>] = &[
    ColumnSpec::step(|row| row.step),
    ColumnSpec::time(|row| row.time_secs),
    column("time_step", "s", "time step", Number(|row| row.time_step_secs)),
    column("sweeps", "", "sweeps of the solver", Count(|row| row.sweeps.into())),
    column(
        "factorisations",
        "",
        "matrices that the solver factorised",
        Count(|row| row.factorisations.into()),
    ),
    column("converged", "", "true if the stopping test was met", Flag(|row| Some(row.converged))),
    column("stalled", "", "true if more sweeps would not help", Flag(|row| Some(row.stalled))),
    column("residual", "1", "common residual of the step's problem", Number(|row| row.residual)),
    column(
        "model_residual",
        "1",
        "residual of the friction model, if one was solved in place of Coulomb friction",
        SomeNumber(|row| row.model_residual),
    ),
    column(
        "velocity_error",
        "m/s",
        "estimated distance of the velocities from those of Coulomb friction: root mean square, weighted with \
         mass, over the grains in contact",
        Number(|row| row.velocity_error),
    ),
    column("contacts", "", "contacts", Count(|row| row.contacts.into())),
    column(
        "compressive_contacts",
        "",
        "contacts that push",
        Count(|row| row.compressive_contacts.into()),
    ),
    column("tensile_contacts", "", "contacts that pull", Count(|row| row.tensile_contacts.into())),
    column(
        "mean_overlap",
        "1",
        "mean overlap of grains in touch, in mean diameters",
        Number(|row| row.mean_overlap),
    ),
    column("max_overlap", "1", "largest overlap, in mean diameters", Number(|row| row.max_overlap)),
    column("kinetic_energy", "J", "kinetic energy", Number(|row| row.kinetic_energy)),
    column(
        "potential_energy",
        "J",
        "potential energy of the grains in the gravity field at their positions; a step of moreau, which moves \
         grains by their velocities at its end, changes it by -gravity_work plus half the time step times -g times \
         the change of momentum",
        Number(|row| row.potential_energy),
    ),
    column(
        "normal_work",
        "J",
        "work of the normal contact forces in the step",
        Number(|row| row.normal_work),
    ),
    column(
        "tangential_work",
        "J",
        "work of the tangential contact forces and of the moments against rolling in the step",
        Number(|row| row.tangential_work),
    ),
    column(
        "wall_work",
        "J",
        "part of normal_work and tangential_work that moving surfaces did",
        Number(|row| row.wall_work),
    ),
    column(
        "drive_energy",
        "J",
        "kinetic energy of walls that a force drives",
        SomeNumber(|row| row.drive_energy),
    ),
    column(
        "drive_work",
        "J",
        "work in the step of the forces that drive walls, minus the work of their damping",
        SomeNumber(|row| row.drive_work),
    ),
    column(
        "border_work",
        "J",
        "work of shearing borders in the step, in addition to the other works",
        SomeNumber(|row| row.border_work),
    ),
    column(
        "gravity_work",
        "J",
        "work of gravity and external forces: their impulse in the step times the mean of the velocities before \
         and after; together with the other works it is the change of kinetic energy",
        Number(|row| row.gravity_work),
    ),
    column(
        "slump",
        "1",
        "decrease of the mean height of the grains, divided by its initial value; NaN if all grains are lost",
        Number(|row| row.slump),
    ),
    column("bond_work", "J", "work of the bonds in the step", SomeNumber(|row| row.bond_work)),
    column(
        "bond_energy",
        "J",
        "energy that stretched the present bonds",
        SomeNumber(|row| row.bond_energy),
    ),
    column(
        "broken_bond_energy",
        "J",
        "energy that stretched the bonds that have broken",
        SomeNumber(|row| row.broken_bond_energy),
    ),
    column(
        "lost_grains",
        "",
        "grains that went through a wall or left the world",
        Count(|row| row.lost_grains.into()),
    ),
];
