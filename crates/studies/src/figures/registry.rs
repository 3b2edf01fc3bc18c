//! The list of all figures that are charts.

use super::figure::Figure;
use super::workshop::Workshop;
use super::{
    cohesion, cradle_choices, cradle_map, dry, fig2, fig5a, fig5b, fig6, fig8, fig8_courses,
    friction, pile_choices, pile_map, pile_series, range, range_regimes, tolerance, two_body,
};
use crate::error::Result;

/// A figure that can be asked for.
pub(super) struct FigureInfo {
    /// Its name on the command line.
    pub name: &'static str,
    /// The studies that it needs.
    pub studies: &'static [&'static str],
    /// Makes it.
    pub make: fn(&Workshop) -> Result<Figure>,
}

/// All figures that are charts, in the order of the report.
pub(super) const FIGURES: [FigureInfo; 20] = [
    FigureInfo { name: "fig2", studies: &[], make: fig2::make },
    FigureInfo { name: "two-body", studies: &[], make: two_body::make },
    FigureInfo { name: "fig5a", studies: &["pile", "pile-compressive"], make: fig5a::make },
    FigureInfo { name: "fig5b", studies: &["pile"], make: fig5b::make },
    FigureInfo { name: "pile-choices", studies: &["pile-choices"], make: pile_choices::make },
    FigureInfo { name: "fig6", studies: &["pile"], make: fig6::make },
    FigureInfo { name: "fig8", studies: &["cradle-courses"], make: fig8_courses::make },
    FigureInfo { name: "fig8-strip", studies: &["cradle"], make: fig8::strip },
    FigureInfo { name: "fig8-share", studies: &["cradle-share"], make: fig8::share },
    FigureInfo { name: "cradle-choices", studies: &["cradle-choices"], make: cradle_choices::make },
    FigureInfo { name: "cradle-map", studies: &["cradle-map"], make: cradle_map::make },
    FigureInfo { name: "pile-map", studies: &["pile-map"], make: pile_map::make },
    FigureInfo { name: "pile-size", studies: &["pile-size"], make: pile_series::size },
    FigureInfo {
        name: "pile-tolerance",
        studies: &["pile-tolerance"],
        make: pile_series::tolerance,
    },
    FigureInfo { name: "range", studies: &["range"], make: range::make },
    FigureInfo {
        name: "range-regimes",
        studies: &["range-regimes", "range-size"],
        make: range_regimes::make,
    },
    FigureInfo { name: "dry", studies: &["dry"], make: dry::make },
    FigureInfo { name: "cohesion", studies: &["cohesion"], make: cohesion::make },
    FigureInfo { name: "friction", studies: &["friction"], make: friction::make },
    FigureInfo { name: "tolerance", studies: &["tolerance"], make: tolerance::make },
];
