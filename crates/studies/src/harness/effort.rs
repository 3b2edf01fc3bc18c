//! Defines the extent of an experiment: a quick pass, which has fewer and smaller systems, or the full pass.

/// The extent of an experiment: a quick pass, which has smaller and fewer systems, or the full pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Effort {
    Quick,
    Full,
}

impl Effort {
    pub(crate) const fn new(is_quick: bool) -> Self {
        if is_quick { Self::Quick } else { Self::Full }
    }

    /// Returns the value `quick` for a quick pass of an experiment (a pass with fewer and smaller systems), and the
    /// value `full` for the full pass.
    pub(crate) fn pick<T>(self, quick: T, full: T) -> T {
        match self {
            Self::Quick => quick,
            Self::Full => full,
        }
    }

    /// Returns the name of the folder in which the results of this pass of an experiment (quick or full) are stored.
    pub(crate) fn name(self) -> &'static str {
        self.pick("quick", "full")
    }

    /// Returns the command-line option that selects this pass of an experiment, with a space before the option, for a
    /// quick pass (a pass with fewer and smaller systems); returns an empty text for the full pass.
    pub(crate) fn option(self) -> &'static str {
        self.pick(" --quick", "")
    }

    /// Returns a note for captions, which says that the results are from a quick pass (a pass with fewer and smaller
    /// systems), with a space after the note; returns an empty text for the full pass.
    pub(crate) fn note(self) -> &'static str {
        self.pick("Quick pass. ", "")
    }
}
