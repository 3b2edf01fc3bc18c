//! Verdicts of every contender on every challenge at every level, as data, as CSV and in words.

use std::fmt;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{CHALLENGES, CONTENDERS, Challenge, Contender, Limits, Trial};
use crate::error::{Error, Result};

/// How a method did. Later is worse.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// The answer is right.
    Holds,
    /// The answer is off, but the scene lives.
    Degrades,
    /// The answer is wrong.
    Fails,
}

impl Verdict {
    /// The verdict on an error.
    pub(crate) fn of(error: f64, limits: Limits) -> Self {
        // Written so that NaN fails.
        if error <= limits.holds {
            Self::Holds
        } else if error <= limits.fails {
            Self::Degrades
        } else {
            Self::Fails
        }
    }

    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Degrades => "degrades",
            Self::Fails => "fails",
        }
    }
}

/// One contender on one challenge at one level. A row of the table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// Name of the challenge.
    pub scene: String,
    /// Name of the contender.
    pub method: String,
    /// Value of the challenge's driver.
    pub level: f64,
    /// What came of it.
    pub verdict: Verdict,
    /// The error, to two digits: the next ones differ from build to build.
    pub error: String,
}

/// All that was tried.
#[derive(Clone, Debug, Default)]
pub struct StabilityTable {
    /// By challenge, contender and level.
    pub cells: Vec<Cell>,
}

impl StabilityTable {
    /// Tries every contender on the challenges, on all cores.
    ///
    /// # Errors
    /// Where a scene is not sound.
    pub fn run(
        challenges: &[&'static Challenge],
        quick: bool,
        told: impl Fn() + Sync,
    ) -> Result<Self> {
        let cells: Vec<_> = Self::plan(challenges, quick)
            .into_par_iter()
            .map(|(challenge, trial)| {
                let cell = cell(challenge, &trial);
                told();
                cell
            })
            .collect::<Result<_>>()?;
        Ok(Self { cells })
    }

    /// Number of cells that [`StabilityTable::run`] fills.
    pub fn count(challenges: &[&'static Challenge], quick: bool) -> usize {
        Self::plan(challenges, quick).len()
    }

    fn plan(challenges: &[&'static Challenge], quick: bool) -> Vec<(&'static Challenge, Trial)> {
        let mut plan = Vec::new();
        for challenge in challenges {
            let further: &[f64] = if quick { &[] } else { challenge.further };
            for contender in CONTENDERS.iter() {
                for &level in challenge.quick.iter().chain(further) {
                    plan.push((*challenge, Trial { contender, level }));
                }
            }
        }
        plan
    }

    /// The table as CSV.
    ///
    /// # Errors
    /// Where a row cannot be said in CSV.
    pub fn to_csv(&self) -> Result<Vec<u8>> {
        let refuse = |error: csv::Error| Error::file("table.csv", error);
        let mut writer = csv::Writer::from_writer(Vec::new());
        for cell in &self.cells {
            writer.serialize(cell).map_err(refuse)?;
        }
        writer.into_inner().map_err(|error| Error::file("table.csv", error.error()))
    }

    /// A table from its CSV.
    ///
    /// # Errors
    /// Names the row that says something else.
    pub fn from_csv(text: &str) -> Result<Self> {
        let rows = csv::Reader::from_reader(text.as_bytes()).into_deserialize();
        let cells = rows.collect::<std::result::Result<_, _>>();
        Ok(Self { cells: cells.map_err(|error| Error::file("table.csv", error))? })
    }

    /// What came of a contender on a challenge, level by level.
    pub(crate) fn levels(&self, challenge: &Challenge, contender: &Contender) -> Vec<&Cell> {
        let of_both = |cell: &&Cell| cell.scene == challenge.name && cell.method == contender.name;
        self.cells.iter().filter(of_both).collect()
    }

    /// The challenges that were tried.
    pub(crate) fn challenges(&self) -> Vec<&'static Challenge> {
        let tried =
            |challenge: &&Challenge| self.cells.iter().any(|cell| cell.scene == challenge.name);
        CHALLENGES.iter().filter(tried).collect()
    }
}

/// What came of all levels together: the first level that did not hold, and how it failed at worst.
pub(super) fn summary(levels: &[&Cell]) -> (Verdict, Option<f64>) {
    let worst = levels.iter().map(|cell| cell.verdict).max().unwrap_or(Verdict::Holds);
    let first = levels.iter().find(|cell| cell.verdict == worst && worst != Verdict::Holds);
    (worst, first.map(|cell| cell.level))
}

fn cell(challenge: &Challenge, trial: &Trial) -> Result<Cell> {
    let error = challenge.error(trial)?;
    Ok(Cell {
        scene: challenge.name.to_owned(),
        method: trial.contender.name.to_owned(),
        level: trial.level,
        verdict: Verdict::of(error, challenge.limits),
        error: format!("{error:.1e}"),
    })
}

/// Widths of the columns in words.
const SCENE_WIDTH: usize = 17;
const CELL_WIDTH: usize = 16;

impl fmt::Display for StabilityTable {
    /// A line a challenge, a column a contender: the worst verdict, and the first level that got it.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{:SCENE_WIDTH$}", "")?;
        for contender in CONTENDERS.iter() {
            write!(out, "{:CELL_WIDTH$}", contender.name)?;
        }
        writeln!(out)?;
        for challenge in self.challenges() {
            write!(out, "{:SCENE_WIDTH$}", challenge.name)?;
            for contender in CONTENDERS.iter() {
                let (verdict, from) = summary(&self.levels(challenge, contender));
                let from = from.map_or(String::new(), |level| format!(" {}", number(level)));
                write!(out, "{:CELL_WIDTH$}", format!("{}{from}", verdict.name()))?;
            }
            writeln!(out, "{}", challenge.driver)?;
        }
        Ok(())
    }
}

/// A number as short as it can be said.
pub(super) fn number(value: f64) -> String {
    if value != 0.0 && !(1e-2..1e4).contains(&value.abs()) {
        format!("{value:e}").replace('-', "−")
    } else {
        format!("{value}")
    }
}
