//! What a way to step tells of a step that it took.

use crate::solver::{Measures, SolveReport};

/// What a step came to.
#[derive(Clone, Copy, Debug, Default)]
pub struct Outcome {
    /// How its problems were solved.
    pub report: SolveReport,
    /// Residual, contacts and works.
    pub measures: Measures,
    /// Work of gravity and of a spring that pulls, J.
    pub gravity_work: f64,
    /// Work of the forces that drive walls, less what their damping took, J.
    pub drive_work: f64,
    /// Of a law with bonds.
    pub bonds: Option<BondEnergies>,
}

/// What bonds took and gave, J.
///
/// A bond that is opened by s has taken C₀ s. It gives that back where it closes, and keeps it where
/// it breaks. So its work is −Δ(C₀ s), and that of its last step −C₀ (opening) until then, with the
/// impulse b m_ij of the time that it lived: −b m_ij ½(v⁺ + v^n), which leaves C₀δ_c in all. What a
/// contact does beyond that is the work of the grains' push on each other.
#[derive(Clone, Copy, Debug, Default)]
pub struct BondEnergies {
    /// Work of this step.
    pub work: f64,
    /// Σ C₀ s of the bonds that live.
    pub stored: f64,
    /// What the bonds took that broke in this step.
    pub broken: f64,
}

impl Outcome {
    /// Of a step in which nothing has happened yet.
    pub fn nothing_yet() -> Self {
        Self { report: SolveReport::nothing_yet(), ..Self::default() }
    }

    /// Counts another piece of the step; what it measures at its end counts for the whole.
    pub fn add(&mut self, piece: Self) {
        let Self { report, measures, gravity_work, drive_work, bonds } = piece;
        self.report.add(report);
        self.measures.add(measures);
        self.gravity_work += gravity_work;
        self.drive_work += drive_work;
        let earlier = self.bonds.unwrap_or_default();
        self.bonds = bonds.map(|BondEnergies { work, stored, broken }| BondEnergies {
            work: earlier.work + work,
            stored,
            broken: earlier.broken + broken,
        });
    }
}
