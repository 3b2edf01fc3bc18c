//! `slump list`: what there is to choose from.

use crate::output::print_line;
use crate::scene::{SCENES, SceneGroup};
use crate::sim::Stepper;
use crate::solver::{FrictionModel, METHODS};

/// Prints the built-in scenes, the steppers, the methods and the models of friction.
pub(super) fn run() {
    for group in SceneGroup::ALL {
        print_line(format_args!("{}:", group.title()));
        for scene in SCENES.iter().filter(|scene| scene.group == group) {
            print_line(format_args!("  {:14} {}", scene.name, scene.summary));
        }
    }
    print_line(format_args!("Steppers:"));
    for stepper in Stepper::ALL {
        print_line(format_args!("  {:14} {}", stepper.name(), stepper.hint()));
        print_line(format_args!(
            "  {:14} solves {} ({})",
            "",
            stepper.info().solves,
            stepper.info().source
        ));
        print_line(format_args!("  {:14} reads {}", "", stepper.info().settings.join(", ")));
    }
    print_line(format_args!("Methods, for steppers that solve each step's problem by one:"));
    for info in METHODS {
        print_line(format_args!("  {:14} {}", info.name, info.summary));
        print_line(format_args!("  {:14} solves {} ({})", "", info.solves, info.source));
    }
    let takers = METHODS.iter().filter(|info| info.takes_models).map(|info| info.name);
    let takers: Vec<_> = takers.collect();
    print_line(format_args!("Models of friction, those beside coulomb for {}:", takers.join(", ")));
    for model in FrictionModel::ALL {
        print_line(format_args!("  {:14} {}", model.name(), model.hint()));
    }
}
