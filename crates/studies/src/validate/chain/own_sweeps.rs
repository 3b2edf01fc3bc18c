//! The paper's sweeps, which Slump has not among its methods.

use rand::seq::SliceRandom;
use rand_pcg::Pcg64;

use crate::sim::{Advance, Settings, Stage, StepResult};
use crate::solver::{ContactSystem, Model, SolveReport};

/// All contacts at once, or one after the other in random order.
pub(super) struct OwnSweeps {
    pub sweeps: u32,
    /// What orders are drawn from; all contacts at once where there is none.
    pub random: Option<Pcg64>,
}

impl Advance for OwnSweeps {
    fn advance<M: Model>(&mut self, stage: &mut Stage<'_, M>, settings: &Settings) -> StepResult {
        stage.prepare(settings, |_approach| 0.0);
        let mut root_masses = Vec::new();
        let mut system = stage.system(&mut root_masses);
        let (mut impulses, mut velocities) = (Vec::new(), Vec::new());
        system.read(&mut impulses);
        let mut order: Vec<usize> = (0..system.len()).collect();
        for _ in 0..self.sweeps {
            let at_a_time = if let Some(random) = &mut self.random {
                order.shuffle(random);
                1
            } else {
                order.len().max(1)
            };
            for contacts in order.chunks(at_a_time) {
                system.velocities(&mut velocities);
                for &contact in contacts {
                    let [normal, _] = &mut impulses[contact];
                    *normal = (*normal - velocities[contact][0]).max(0.0);
                }
                system.write(&impulses);
            }
        }
        let report = SolveReport { sweeps: self.sweeps, ..SolveReport::default() };
        stage.move_by(report, settings)
    }
}
