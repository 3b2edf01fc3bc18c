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
    /// How often the test would say that it holds with nothing behind it; empty where nothing is drawn at random.
    pub by_chance: String,
    /// The free choices that the verdict hangs on; empty where there are none but those of all runs of the figure.
    pub hangs_on: String,
}

impl Claim {
    /// A claim.
    pub(super) fn new(
        said: impl Into<String>,
        measured: impl Into<String>,
        verdict: Verdict,
    ) -> Self {
        let [by_chance, hangs_on] = [String::new(), String::new()];
        Self { said: said.into(), measured: measured.into(), verdict, by_chance, hangs_on }
    }

    /// The same with how often its test would say so with nothing behind it.
    pub(super) fn by_chance(self, by_chance: impl Into<String>) -> Self {
        Self { by_chance: by_chance.into(), ..self }
    }

    /// The same with the free choices that it hangs on.
    pub(super) fn hanging_on(self, hangs_on: impl Into<String>) -> Self {
        Self { hangs_on: hangs_on.into(), ..self }
    }
}
