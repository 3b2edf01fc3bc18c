//! The bodies of a problem as its file lists them.

use serde::{Deserialize, Serialize};

/// Discs and their contacts: what W, q and c₀ were made of. Lists have an entry a body or an entry a
/// contact.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyForm {
    /// 1 (all on the x axis) or 2.
    pub axes: u8,
    /// Whether bodies turn.
    pub rotation: bool,
    /// Bond·g·Δt, m/s: c₀ = m_n times this.
    pub capture_speed: f64,
    /// Of each body, kg.
    pub mass: Vec<f64>,
    /// Of each body, kg·m²: that of a solid disc, ½mr².
    pub inertia: Vec<f64>,
    /// Of each body, m: the lever arm of all its contacts.
    pub radius: Vec<f64>,
    /// (v_x, v_y, ω) of each body without contact impulses, m/s and rad/s.
    pub free_velocity: Vec<[f64; 3]>,
    /// Bodies i and j of each contact; j is null for a fixed body.
    pub pair: Vec<(u32, Option<u32>)>,
    /// n of each contact, from j to i.
    pub normal: Vec<[f64; 2]>,
    /// Restitution's term in q of each contact, m/s.
    pub restitution_velocity: Vec<f64>,
    /// How fast the surface of the fixed body of each contact goes along t, n turned by +90°, m/s; 0 between two
    /// bodies, and left out where none moves.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub surface_speed: Vec<f64>,
}
