//! What several methods stand on.

pub(super) mod body_system;
pub(super) mod contact_graph;
pub(super) mod contact_system;
pub(super) mod iterate;
pub(super) mod stall;
pub(super) mod update;
