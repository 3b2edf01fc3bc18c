//! Reproduces every figure of Abramian & Staron (2020) from simulation alone, adds figures that the conclusion of this
//! article suggests, and tests the statements of the article. Each figure is a row of [`FIGURES`].

mod claims;
mod fig5;
mod fig6;
mod fig8;
mod fig8_series;
mod pile_map;
mod reproduce;
mod studies;
mod two_bodies;

pub use reproduce::{figure_names, reproduce};

use self::claims::Claim;
use self::studies::StudyRunner;
use crate::chart::Sheet;
use crate::error::Result;
use crate::harness::ReportTable;

struct Figure {
    pub name: &'static str,
    pub sheet: Sheet,
    pub claims: Vec<Claim>,
    /// Table of the numbers on which the verdicts about the figure's statements are based, if the chart does not show
    /// them all.
    pub table: Option<ReportTable>,
}

struct FigureInfo {
    pub name: &'static str,
    /// Names of the studies (sets of runs) that the figure needs.
    pub studies: &'static [&'static str],
    pub make: fn(&StudyRunner) -> Result<Figure>,
}

impl FigureInfo {
    const fn new(
        name: &'static str,
        studies: &'static [&'static str],
        make: fn(&StudyRunner) -> Result<Figure>,
    ) -> Self {
        Self { name, studies, make }
    }
}

/// All figures that are charts and not pictures of grains, in the order of the report.
static FIGURES: [FigureInfo; 10] = [
    FigureInfo::new("fig2", &[], two_bodies::fig2),
    FigureInfo::new("two-body", &[], two_bodies::two_bodies),
    FigureInfo::new("fig5a", &["pile", "pile-compressive"], fig5::slump),
    FigureInfo::new("fig5b", &["pile"], fig5::overlap),
    FigureInfo::new("fig6", &["pile"], fig6::make),
    FigureInfo::new("fig8", &["cradle-courses"], fig8_series::make),
    FigureInfo::new("fig8-share", &["cradle-share"], fig8::share),
    FigureInfo::new("cradle-choices", &["cradle-choices"], fig8::choices),
    FigureInfo::new("cradle-map", &["cradle-map"], fig8::map),
    FigureInfo::new("pile-map", &["pile-map"], pile_map::make),
];
