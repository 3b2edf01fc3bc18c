//! The extent of an experiment.

/// A quick pass, with smaller and fewer systems, or the full pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Effort {
    Quick,
    Full,
}

impl Effort {
    pub(crate) const fn new(is_quick: bool) -> Self {
        if is_quick { Self::Quick } else { Self::Full }
    }

    /// The value for a quick pass or for the full pass.
    pub(crate) fn pick<T>(self, quick: T, full: T) -> T {
        match self {
            Self::Quick => quick,
            Self::Full => full,
        }
    }

    /// The name of the folder of its results.
    pub(crate) fn name(self) -> &'static str {
        self.pick("quick", "full")
    }

    /// The option for it, after a space.
    pub(crate) fn option(self) -> &'static str {
        self.pick(" --quick", "")
    }

    /// The note on a quick pass in captions, before a space.
    pub(crate) fn note(self) -> &'static str {
        self.pick("Quick pass. ", "")
    }
}
