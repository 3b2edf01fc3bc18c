//! What plots show of a world.

use std::sync::Arc;

use egui::Color32;

use super::other_piles::Band;
use crate::live::Curve;

/// What is plotted of a world.
#[derive(Clone, Debug)]
pub(crate) struct WorldCurve {
    /// What tells it from the others.
    pub name: String,
    /// Its colour.
    pub colour: Color32,
    /// Its rows.
    pub curve: Curve,
    /// What other piles slump with its settings.
    pub others: Option<Arc<Band>>,
}
