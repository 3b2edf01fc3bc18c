//! Slump's own steppers and solvers, as engines of the benchmark.

use slump_core::error::Result;
use slump_core::sim::{Remedies, Simulation, Stepper};
use slump_core::solver::{Method, SolverSettings};

use crate::engine::Engine;
use crate::pile::Pile;

/// A stepper or solver of Slump with its settings.
#[derive(Clone, Copy, Debug)]
pub enum Way {
    /// The paper's scheme with `count` sweeps per step, with or without the remedies `push-out` and `speculative`.
    Sweeps { count: u32, push_out: bool, speculative: bool },
    /// Every step is solved to tolerance with bounded friction (Tresca), with or without the remedy `push-out`.
    Certified { push_out: bool },
    /// The stepper `tgs-soft`: soft contacts with substeps, with or without the remedy `speculative`.
    TgsSoft { substeps: u32, speculative: bool },
}

pub struct Slump(Simulation);

impl Slump {
    pub fn new(pile: &Pile, time_step_secs: f64, way: Way) -> Result<Self> {
        let mut scene = pile.scene.clone();
        scene.parameters.time_step_secs = time_step_secs;
        match way {
            Way::Sweeps { count, push_out, speculative } => {
                // No residual is as small as this tolerance, so all sweeps are taken.
                scene.solver = SolverSettings::to_residual(Method::Nsgs, f64::MIN_POSITIVE, count);
                scene.remedies = Remedies { push_out, speculative, ..Remedies::default() };
            }
            Way::Certified { push_out } => {
                scene.solver = SolverSettings::BOUNDED;
                scene.remedies = Remedies { push_out, ..Remedies::default() };
            }
            Way::TgsSoft { substeps, speculative } => {
                scene.stepper = Stepper::TgsSoft;
                scene.remedies = Remedies { speculative, ..Remedies::default() };
                scene.parameters.substeps = substeps;
            }
        }
        Ok(Self(scene.simulation()?))
    }
}

impl Engine for Slump {
    fn step(&mut self) {
        // A cohesionless pile with these settings stays finite.
        self.0.step().expect("a finite state");
    }

    fn positions(&mut self) -> Vec<[f64; 2]> {
        self.0.world().grains.positions.iter().map(|at| [at.x, at.y]).collect()
    }
}
