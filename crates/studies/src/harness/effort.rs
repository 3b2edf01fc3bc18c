//! How much an experiment computes.

/// A quick pass, with smaller systems and fewer of them, or the full one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Effort {
    Quick,
    Full,
}

impl Effort {
    pub(crate) const fn new(is_quick: bool) -> Self {
        if is_quick { Self::Quick } else { Self::Full }
    }

    /// The value for a quick pass, or the one for the full pass.
    pub(crate) fn pick<T>(self, quick: T, full: T) -> T {
        match self {
            Self::Quick => quick,
            Self::Full => full,
        }
    }

    /// The name of its folder.
    pub(crate) fn name(self) -> &'static str {
        self.pick("quick", "full")
    }

    /// The option that asks for it, after a space.
    pub(crate) fn option(self) -> &'static str {
        self.pick(" --quick", "")
    }

    /// What a caption says of a quick pass, before a space.
    pub(crate) fn note(self) -> &'static str {
        self.pick("Quick pass. ", "")
    }
}
