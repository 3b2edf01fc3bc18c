//! What every step reports of itself.

use serde::{Deserialize, Serialize};

/// Measured after each step. One row of the observables' CSV.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Observables {
    /// Steps taken so far.
    pub step: u64,
    /// Simulated time, s.
    pub time_secs: f64,
    /// Δt of this step, s.
    pub time_step_secs: f64,
    /// Sweeps of the solver; of a scheme, its passes over all contacts.
    pub sweeps: u32,
    /// Matrices that the solver factorised.
    pub factorisations: u32,
    /// Whether the stopping test was met within the sweep limit; true for a scheme, which does a
    /// fixed amount of work and tests nothing. What its step is worth, `residual` tells.
    pub converged: bool,
    /// Whether a step that did not converge had stalled: its residual had stopped falling, so that
    /// more sweeps are of no use. As a rule it has no solution (see RESULTS.md).
    #[serde(default)]
    pub stalled: bool,
    /// The common residual (`solver::residual`), dimensionless. For a scheme: that of the step's
    /// problem with the impulses that the scheme summed up and the velocities it ended with.
    pub residual: f64,
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
    /// Work of the gravity field, and of a spring that pulls a grain, in this step, J.
    pub gravity_work: f64,
    /// Δy_G = Σ(y_i(0) − y_i(t)) / Σ y_i(0) (paper eq. 11); 0 where Σ y_i(0) is 0.
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
}

impl Observables {
    /// With numbers that are none where there are no bonds, so that rows with and without bonds fit
    /// in one table.
    pub fn with_columns_of_bonds(self) -> Self {
        let number = |value: Option<f64>| Some(value.unwrap_or(f64::NAN));
        Self {
            bond_work: number(self.bond_work),
            bond_energy: number(self.bond_energy),
            broken_bond_energy: number(self.broken_bond_energy),
            ..self
        }
    }
}
