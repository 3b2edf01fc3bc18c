//! The pages of the sidebar.

use serde::{Deserialize, Serialize};

/// A page of the sidebar. At most one is open.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Page {
    /// The scene, its grains, and changes by hand.
    Pile,
    /// The contact law and the solver.
    Solver,
    /// Worlds and earlier runs side by side, and their measures.
    Compare,
    /// Colours and other choices of drawing.
    Look,
    /// Files that can be saved.
    Save,
}

impl Page {
    /// All pages, in the order of their tabs.
    pub const ALL: [Self; 5] = [Self::Pile, Self::Solver, Self::Compare, Self::Look, Self::Save];

    /// Text of the tab.
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
