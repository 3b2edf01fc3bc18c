//! Known remedies for known failures, all off in the paper's scheme. A remedy is a file, with its row in
//! [`ROWS`] and its setting in [`Remedies`]; the steppers that take it call it by name.

pub(super) mod calm_unsolved;
pub(super) mod declared;
pub(super) mod max_travel;
pub(super) mod push_out;
pub(super) mod sequential_impacts;
pub(super) mod speculative;

pub use declared::{Remedies, Remedy, RemedyChanges};

use crate::setting::Group;

/// All remedies, in the order of their settings.
pub const ROWS: [Remedy; 5] = [
    push_out::REMEDY,
    max_travel::REMEDY,
    calm_unsolved::REMEDY,
    sequential_impacts::REMEDY,
    speculative::REMEDY,
];

const _: () = assert!(ROWS.len() == Remedies::ABOUT.len(), "each remedy has a row and a setting");

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
