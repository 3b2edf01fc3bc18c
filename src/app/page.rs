//! The pages of the sidebar.

use serde::{Deserialize, Serialize};

/// A page of the sidebar, of which one is open at a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Page {
    /// What is stepped: the scene, its grains, and what a hand does to them.
    Pile,
    /// How it is stepped and solved.
    Solver,
    /// Worlds and runs side by side, and what is measured of them.
    Compare,
    /// How it is drawn.
    Look,
    /// What goes to files.
    Save,
}

impl Page {
    /// All of them, in their order.
    pub const ALL: [Self; 5] = [Self::Pile, Self::Solver, Self::Compare, Self::Look, Self::Save];

    /// What its tab says.
    pub fn title(self) -> &'static str {
        match self {
            Self::Pile => "Pile",
            Self::Solver => "Law, solver",
            Self::Compare => "Compare",
            Self::Look => "Look",
            Self::Save => "Save",
        }
    }
}
