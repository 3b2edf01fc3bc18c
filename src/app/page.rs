//! The pages of the sidebar.

use serde::{Deserialize, Serialize};

/// A page of the sidebar. At most one page is open.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Page {
    /// The scene, its grains, and edits of the grains by the user.
    Pile,
    /// The contact law and the solver.
    Solver,
    /// Worlds (simulations side by side) and earlier runs, with their results.
    Compare,
    /// Colours and other drawing options.
    Look,
    /// Files that the user can save.
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
