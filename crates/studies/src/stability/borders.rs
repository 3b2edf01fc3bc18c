//! Borders that theory gives to stability maps. A step of Gauss–Seidel from nothing leaves the share
//! ρ^s of what gravity adds to the slowest mode, g Δt, and of what the step before left. So a column
//! sinks with
//!
//! > v = A g Δt ρ^s / (1 − ρ^s),
//!
//! where A = 4/π is the slowest mode's part at the top of a column of many (1 for two discs) and ρ is
//! what `scene::stability` derives for each scene. In T it sinks by v T = 0.01 d where
//! s = ln(q/(1 + q)) / ln ρ, q = 0.01 d/(A g Δt T). The border of springs is their critical time step.
//!
//! Over Δt and Bond the border is that of statics, where C₀ no longer carries the cantilever, and Δt does
//! not enter. One might fear another where bonds are strong and steps long, with C₀Δt²/m_ij = Bond·g·Δt²
//! a hundredth of d: an impulse of cohesion, left alone for a step, would pull two grains into each other
//! by that much. There is none. In the map's corner of Bond 500 and Δt = 0.01 s that is 49 d, and where
//! steps are solved nothing overlaps: a bond pulls no more than is asked of it.

use std::f64::consts::{FRAC_PI_2, PI};

use super::contenders::Contender;
use crate::error::Result;
use crate::scene::stability::column_on_line;

/// Simulated time of every run, s.
pub(super) const DURATION_SECS: f64 = 0.1;
/// Sinking or overlap that counts, in d.
pub(super) const COUNTS: f64 = 0.01;
/// Part of the slowest mode in the motion of a column's top.
pub(super) const TOP_OF_COLUMN: f64 = 4.0 / PI;

/// What a sweep of Gauss–Seidel leaves of the slowest mode of a column.
pub fn contraction_of_column(count: f64) -> f64 {
    (FRAC_PI_2 / count).cos().powi(2)
}

pub(super) fn sweeps_at_border(part: f64, time_step_secs: f64, contraction: f64) -> f64 {
    let scene = column_on_line(1);
    let fall = part * scene.gravity.magnitude() * time_step_secs * DURATION_SECS;
    let q = COUNTS * scene.mean_diameter / fall;
    (q / (1.0 + q)).ln() / contraction.ln()
}

pub(super) fn substeps_at_border(count: usize, time_step_secs: f64) -> Result<f64> {
    let mut scene = column_on_line(count);
    if let Some(dem) = Contender::named("dem") {
        dem.apply(&mut scene);
    }
    let critical_secs = scene.simulation()?.critical_time_step_secs().unwrap_or(f64::INFINITY);
    Ok(time_step_secs / critical_secs)
}
