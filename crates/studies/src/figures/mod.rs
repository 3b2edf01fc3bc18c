//! Every figure of the paper and those that its conclusion asks for, from simulation alone, and a report of what holds.
//! Each is a row of [`FIGURES`].

mod beyond;
mod claims;
mod cohesion;
mod fig5;
mod fig6;
mod fig8;
mod fig8_series;
mod paired;
mod pile_map;
mod reproduce;
mod studies;
mod two_bodies;

pub use reproduce::{figure_names, reproduce};

use self::claims::Claim;
use self::paired::PairedExperiment;
use self::studies::StudyRunner;
use crate::chart::{Point, Sheet};
use crate::error::Result;
use crate::report::ReportTable;
use crate::statistics::mean;

struct Figure {
    pub name: &'static str,
    pub sheet: Sheet,
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

struct FigureInfo {
    pub name: &'static str,
    /// The studies that it needs.
    pub studies: &'static [&'static str],
    pub make: FigureMaker,
}

enum FigureMaker {
    By(fn(&StudyRunner) -> Result<Figure>),
    Paired(PairedExperiment),
}

impl FigureInfo {
    const fn new(
        name: &'static str,
        studies: &'static [&'static str],
        make: fn(&StudyRunner) -> Result<Figure>,
    ) -> Self {
        Self { name, studies, make: FigureMaker::By(make) }
    }

    const fn paired(experiment: PairedExperiment) -> Self {
        let PairedExperiment { name, studies, .. } = experiment;
        Self { name, studies, make: FigureMaker::Paired(experiment) }
    }

    fn figure(&self, studies: &StudyRunner) -> Result<Figure> {
        match &self.make {
            FigureMaker::By(make) => make(studies),
            FigureMaker::Paired(experiment) => experiment.figure(studies),
        }
    }
}

/// All figures that are charts, in the order of the report.
static FIGURES: [FigureInfo; 19] = [
    FigureInfo::new("fig2", &[], two_bodies::fig2),
    FigureInfo::new("two-body", &[], two_bodies::two_bodies),
    FigureInfo::new("fig5a", &["pile", "pile-compressive"], fig5::slump),
    FigureInfo::new("fig5b", &["pile"], fig5::overlap),
    FigureInfo::paired(beyond::PILE_CHOICES),
    FigureInfo::new("fig6", &["pile"], fig6::make),
    FigureInfo::new("fig8", &["cradle-courses"], fig8_series::make),
    FigureInfo::new("fig8-share", &["cradle-share"], fig8::share),
    FigureInfo::new("cradle-choices", &["cradle-choices"], fig8::choices),
    FigureInfo::new("cradle-map", &["cradle-map"], fig8::map),
    FigureInfo::new("pile-map", &["pile-map"], pile_map::make),
    FigureInfo::paired(beyond::PILE_SIZE),
    FigureInfo::paired(beyond::PILE_TOLERANCE),
    FigureInfo::paired(beyond::RANGE),
    FigureInfo::paired(beyond::RANGE_REGIMES),
    FigureInfo::paired(beyond::DRY),
    FigureInfo::new("cohesion", &["cohesion"], cohesion::make),
    FigureInfo::paired(beyond::FRICTION),
    FigureInfo::paired(beyond::TOLERANCE),
];
