//! Known remedies for known failures, all off in the paper's scheme. A remedy is a file, with its row in
//! [`ROWS`], its setting in [`Remedies`], and a line where the course of a step asks for it: in [`solve`] or
//! [`after_step`], or, where it looks ahead or cuts the step, in the way to step itself.

#![deny(
    dead_code,
    reason = "a remedy without a row, or one that no step asks, would not be missed"
)]

pub(super) mod calm_unsolved;
pub(super) mod declared;
pub(super) mod max_travel;
pub(super) mod push_out;
pub(super) mod sequential_impacts;
pub(super) mod speculative;

pub use declared::Remedy;
pub use declared::{Remedies, RemedyChanges};

use super::settings::Settings;
use super::stepping::Stage;
use crate::setting::Group;
use crate::solver::{Model, SolveReport};

/// All remedies, in the order of their settings.
pub const ROWS: [Remedy; 5] = [
    push_out::REMEDY,
    max_travel::REMEDY,
    calm_unsolved::REMEDY,
    sequential_impacts::REMEDY,
    speculative::REMEDY,
];

const _: () = assert!(ROWS.len() == Remedies::ABOUT.len(), "each remedy has a row and a setting");

/// Solves the problem that is set up.
pub(super) fn solve<M: Model>(stage: &mut Stage<'_, M>, settings: &Settings) -> SolveReport {
    let mut report = if settings.remedies.sequential_impacts {
        sequential_impacts::solve(stage, settings)
    } else {
        stage.solve(settings)
    };
    if settings.remedies.calm_unsolved && !report.converged {
        report = calm_unsolved::solve_again(stage, settings, report);
    }
    report
}

/// What is done once the grains have moved.
pub(super) fn after_step<M: Model>(stage: &mut Stage<'_, M>, settings: &Settings) {
    if settings.remedies.push_out {
        push_out::push_out(stage.state, settings.parameters.time_step_secs);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_row_is_about_the_setting_at_its_place() {
        for (row, about) in ROWS.iter().zip(Remedies::ABOUT) {
            assert_eq!(row.name, about.name);
        }
    }
}
