//! The pages of the sidebar.

use serde::{Deserialize, Serialize};

/// A page of the sidebar. At most one page is open.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Page {
    /// Page with the scene, its grains, and edits of the grains by the user.
    Pile,
    /// Page with the contact law and the solver.
    Solver,
    /// Page with worlds (simulations side by side) and earlier runs, with their results.
    Compare,
    /// Page with colours and other drawing options.
    Look,
    /// Page with the files that the user can save.
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
