//! What several methods stand on.

pub mod body_system;
pub mod contact_system;
pub mod iterate;
pub mod stall;
pub mod update;
