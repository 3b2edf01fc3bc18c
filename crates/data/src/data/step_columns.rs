//! The columns of the table of steps: the measurements of each step.

use crate::column_spec::CellValue::{Count, Flag, Number, SomeNumber};
use crate::column_spec::{ColumnSpec, column};
use crate::sim::Observables;

/// The columns of the table of steps.
pub const STEP_COLUMNS: &[ColumnSpec<Observables>] = &[
    ColumnSpec::step(|row| row.step),
    ColumnSpec::time(|row| row.time_secs),
    column("time_step", "s", "time step", Number(|row| row.time_step_secs)),
    column("sweeps", "", "sweeps of the solver", Count(|row| row.sweeps.into())),
    column(
        "factorisations",
        "",
        "matrices that it factorised",
        Count(|row| row.factorisations.into()),
    ),
    column(
        "converged",
        "",
        "whether the step was solved as asked",
        Flag(|row| Some(row.converged)),
    ),
    column("stalled", "", "whether more sweeps would be of no use", Flag(|row| Some(row.stalled))),
    column("residual", "1", "common residual of the step's problem", Number(|row| row.residual)),
    column(
        "model_residual",
        "1",
        "the same of the model of friction that was solved in the place of Coulomb's law",
        SomeNumber(|row| row.model_residual),
    ),
    column(
        "velocity_error",
        "m/s",
        "how far velocities are taken to be from Coulomb's law: root mean square, weighted with mass, over the \
            grains that touch something",
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
        "of grains in the gravity field, where they are; a step of moreau, which moves them by the velocities after it, \
         changes it by -gravity_work and half the time step times -g times the change of momentum",
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
        "part of both that surfaces which move did in the step",
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
        "work in the step of the forces that drive walls, less that of their damping",
        SomeNumber(|row| row.drive_work),
    ),
    column(
        "border_work",
        "J",
        "work that borders which shear did in the step, beside the others",
        SomeNumber(|row| row.border_work),
    ),
    column(
        "gravity_work",
        "J",
        "impulse of gravity, and of forces from outside, in the step times the mean of the velocities before and after: with the other \
         works it is the change of kinetic energy",
        Number(|row| row.gravity_work),
    ),
    column(
        "slump",
        "1",
        "how far the mean height of the grains has sunk, in its first value; NaN if all grains are lost",
        Number(|row| row.slump),
    ),
    column("bond_work", "J", "work that bonds did in the step", SomeNumber(|row| row.bond_work)),
    column(
        "bond_energy",
        "J",
        "what stretching the bonds that live took",
        SomeNumber(|row| row.bond_energy),
    ),
    column(
        "broken_bond_energy",
        "J",
        "what bonds took that have broken",
        SomeNumber(|row| row.broken_bond_energy),
    ),
    column(
        "lost_grains",
        "",
        "grains that went through a wall or left the world",
        Count(|row| row.lost_grains.into()),
    ),
];
