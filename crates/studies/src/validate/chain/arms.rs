//! Who sweeps the row, and what q that has.

use super::super::quantity::Provenance;
use crate::sim::diffusion_of_sweep;
use crate::solver::{Method, Ordering};

/// Who sweeps.
pub(super) struct Arm {
    pub name: &'static str,
    /// How far off q the mean of short rows may be, in q.
    pub within: f64,
    pub provenance: Provenance,
    pub source: &'static str,
    pub sweeper: Sweeper,
}

#[derive(Clone, Copy)]
pub(super) enum Sweeper {
    /// A method of Slump.
    Of(Method, Ordering),
    /// All contacts at once.
    Parallel,
    /// One contact after the other, in an order drawn for each sweep.
    Random,
}

/// (4√e − 5)/2.
const OF_RANDOM_ORDER: f64 = 0.797_442_541_400_256_3;

impl Arm {
    /// Whether the order is drawn for each sweep.
    pub(super) fn is_random(&self) -> bool {
        matches!(self.sweeper, Sweeper::Random)
    }

    /// What q should be.
    pub(super) fn q(&self) -> f64 {
        match self.sweeper {
            Sweeper::Of(method, _) => diffusion_of_sweep(method).unwrap_or(f64::NAN),
            Sweeper::Parallel => 0.5,
            Sweeper::Random => OF_RANDOM_ORDER,
        }
    }
}

const YOUNG: &str = "D. M. Young 1971: any fixed order on a chain";

pub(super) const ARMS: [Arm; 5] = [
    Arm {
        name: "parallel sweep",
        within: 0.02,
        provenance: Provenance::Read,
        source: "Unger et al. 2002: ½",
        sweeper: Sweeper::Parallel,
    },
    Arm {
        name: "random order",
        within: 0.04,
        provenance: Provenance::Read,
        source: "Unger et al. 2002: (4√e − 5)/2",
        sweeper: Sweeper::Random,
    },
    Arm {
        name: "jacobi",
        within: 0.02,
        provenance: Provenance::Derived,
        source: "half of ½ by mass splitting",
        sweeper: Sweeper::Of(Method::Jacobi, Ordering::Interleaved),
    },
    Arm {
        name: "nsgs interleaved",
        within: 0.02,
        provenance: Provenance::Derived,
        source: YOUNG,
        sweeper: Sweeper::Of(Method::Nsgs, Ordering::Interleaved),
    },
    Arm {
        name: "nsgs bottom-up",
        within: 0.02,
        provenance: Provenance::Derived,
        source: YOUNG,
        sweeper: Sweeper::Of(Method::Nsgs, Ordering::BottomUp),
    },
];
