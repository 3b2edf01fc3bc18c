//! Every figure of the paper and those that its conclusion asks for, from simulation alone, and a report of what holds.
//! Each is a row of [`FIGURES`].

mod choices;
mod claims;
mod cohesion;
mod comparison;
mod dry;
mod fig5;
mod fig6;
mod fig8;
mod fig8_series;
mod friction;
mod pile_map;
mod pile_series;
mod range;
mod reproduce;
mod studies;
mod tolerance;
mod two_bodies;

pub use reproduce::{figure_names, reproduce};

use self::claims::Claim;
use self::studies::StudyRunner;
use crate::chart::{Point, Sheet};
use crate::error::Result;
use crate::report::ReportTable;
use crate::statistics::mean;

/// A finished figure.
struct Figure {
    /// Name of its files.
    pub name: &'static str,
    /// What is drawn.
    pub sheet: Sheet,
    /// What it says of the paper's claims.
    pub claims: Vec<Claim>,
    /// The numbers behind them, where the chart shows too few.
    pub table: Option<ReportTable>,
}

/// The mean of some slumps on a chart.
fn slump_point(x: f64, slumps: &[f64]) -> Point {
    let mean = mean(slumps);
    // Two states tell next to nothing of their spread.
    let interval = (mean.count > 2).then_some((mean.low.max(0.0), mean.high.min(0.7)));
    Point { x, y: mean.mean, interval }
}

/// A figure that can be asked for.
struct FigureInfo {
    /// Its name on the command line.
    pub name: &'static str,
    /// The studies that it needs.
    pub studies: &'static [&'static str],
    /// Makes it.
    pub make: fn(&StudyRunner) -> Result<Figure>,
}

/// All figures that are charts, in the order of the report.
const FIGURES: [FigureInfo; 20] = [
    FigureInfo { name: "fig2", studies: &[], make: two_bodies::fig2 },
    FigureInfo { name: "two-body", studies: &[], make: two_bodies::two_bodies },
    FigureInfo { name: "fig5a", studies: &["pile", "pile-compressive"], make: fig5::slump },
    FigureInfo { name: "fig5b", studies: &["pile"], make: fig5::overlap },
    FigureInfo { name: "pile-choices", studies: &["pile-choices"], make: choices::of_piles },
    FigureInfo { name: "fig6", studies: &["pile"], make: fig6::make },
    FigureInfo { name: "fig8", studies: &["cradle-courses"], make: fig8_series::make },
    FigureInfo { name: "fig8-strip", studies: &["cradle"], make: fig8::strip },
    FigureInfo { name: "fig8-share", studies: &["cradle-share"], make: fig8::share },
    FigureInfo { name: "cradle-choices", studies: &["cradle-choices"], make: choices::of_cradle },
    FigureInfo { name: "cradle-map", studies: &["cradle-map"], make: fig8::map },
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
        make: choices::of_range,
    },
    FigureInfo { name: "dry", studies: &["dry"], make: dry::make },
    FigureInfo { name: "cohesion", studies: &["cohesion"], make: cohesion::make },
    FigureInfo { name: "friction", studies: &["friction"], make: friction::make },
    FigureInfo { name: "tolerance", studies: &["tolerance"], make: tolerance::make },
];
