//! Claims and what became of them.

/// p-values below this count as evidence.
pub(super) const SIGNIFICANT: f64 = 0.05;

/// Ratio of the ends of an interval that is narrow enough to confirm what lies in it.
const NARROW: f64 = 3.0;

/// Whether a claim holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// The data show it.
    Holds,
    /// The data show the contrary.
    Fails,
    /// The data show neither.
    Open,
}

impl Verdict {
    /// A claim that is shown where `p` is small, and its contrary where `p_contrary` is.
    pub(super) fn of(p: f64, p_contrary: f64) -> Self {
        match (p < SIGNIFICANT, p_contrary < SIGNIFICANT) {
            (true, _) => Self::Holds,
            (false, true) => Self::Fails,
            (false, false) => Self::Open,
        }
    }

    /// A guess at a ratio: it fails outside the interval, and an interval wider than a factor of
    /// [`NARROW`] decides nothing.
    pub(super) fn of_interval(guess: f64, low: f64, high: f64) -> Self {
        if guess < low || guess > high {
            Self::Fails
        } else if high < NARROW * low {
            Self::Holds
        } else {
            Self::Open
        }
    }

    /// In words.
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Fails => "does not hold",
            Self::Open => "not decided by these data",
        }
    }
}

impl From<bool> for Verdict {
    fn from(holds: bool) -> Self {
        if holds { Self::Holds } else { Self::Fails }
    }
}

/// What is said, what was measured, and whether it holds.
#[derive(Clone, Debug)]
pub(super) struct Claim {
    /// What the paper says, or is asked beyond it.
    pub said: String,
    /// What was measured, with its interval or p-value.
    pub measured: String,
    /// Whether it holds.
    pub verdict: Verdict,
}

impl Claim {
    /// A claim.
    pub(super) fn new(
        said: impl Into<String>,
        measured: impl Into<String>,
        verdict: Verdict,
    ) -> Self {
        Self { said: said.into(), measured: measured.into(), verdict }
    }
}
