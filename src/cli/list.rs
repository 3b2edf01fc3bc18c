//! `slump list`: what there is to choose from.

use crate::scene::{SCENES, SceneGroup};
use crate::sim::Stepper;
use crate::solver::METHODS;

/// Prints the built-in scenes, the steppers and the methods.
pub(super) fn run() {
    for group in SceneGroup::ALL {
        println!("{}:", group.title());
        for scene in SCENES.iter().filter(|scene| scene.group == group) {
            println!("  {:14} {}", scene.name, scene.summary);
        }
    }
    println!("Steppers:");
    for stepper in Stepper::ALL {
        println!("  {:14} {}", stepper.name(), stepper.hint());
        println!("  {:14} solves {} ({})", "", stepper.info().solves, stepper.info().source);
    }
    println!("Methods, for steppers that solve each step's problem by one:");
    for info in METHODS {
        println!("  {:14} {}", info.name, info.summary);
        println!("  {:14} solves {} ({})", "", info.solves, info.source);
    }
}
