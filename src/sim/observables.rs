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
    /// more sweeps are of no use. As a rule it has no solution (see the README).
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
}
