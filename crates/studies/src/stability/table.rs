//! Verdicts on every solver variant for every challenge and level, as data, as CSV, in words and as a picture.

use std::fmt;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{CHALLENGES, Challenge, Trial, VARIANTS};
use crate::chart::{self, Axis, Chart, INK, Layer, Rgb, Sheet};
use crate::error::{Error, Result};
use crate::harness::Change;

/// Verdict on a method. Later variants are worse.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum StabilityVerdict {
    /// The answer is right.
    Holds,
    /// The answer is inaccurate, but the scene stays intact.
    Degrades,
    /// The answer is wrong.
    Fails,
}

impl StabilityVerdict {
    fn of(error: f64, [holds, fails]: [f64; 2]) -> Self {
        // Written so that NaN fails.
        if error <= holds {
            Self::Holds
        } else if error <= fails {
            Self::Degrades
        } else {
            Self::Fails
        }
    }

    /// The verdict in a word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Degrades => "degrades",
            Self::Fails => "fails",
        }
    }
}

/// One variant on one challenge at one level: a row of the table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StabilityCell {
    /// Name of the challenge.
    pub scene: String,
    /// Name of the variant.
    pub method: String,
    /// Value of the challenge's driver.
    pub level: f64,
    /// The verdict.
    pub verdict: StabilityVerdict,
    /// The error, to two digits, because further digits differ between builds.
    pub error: String,
}

/// All results.
#[derive(Clone, Debug, Default)]
pub struct StabilityTable {
    /// Sorted by challenge, variant and level.
    pub cells: Vec<StabilityCell>,
}

impl StabilityTable {
    /// Runs every variant on the challenges, on all cores.
    ///
    /// # Errors
    /// If a scene is invalid.
    pub fn run(
        challenges: &[&'static Challenge],
        quick: bool,
        progress: impl Fn() + Sync,
    ) -> Result<Self> {
        let cells: Vec<_> = Self::plan(challenges, quick)
            .into_par_iter()
            .map(|(challenge, trial)| {
                let cell = cell(challenge, &trial);
                progress();
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
            for variant in VARIANTS.iter() {
                for &level in challenge.quick.iter().chain(further) {
                    plan.push((*challenge, Trial { variant, level }));
                }
            }
        }
        plan
    }

    /// The table as CSV.
    ///
    /// # Errors
    /// If a row cannot be written as CSV.
    pub fn to_csv(&self) -> Result<Vec<u8>> {
        let refuse = |error: csv::Error| Error::file("table.csv", error);
        let mut writer = csv::Writer::from_writer(Vec::new());
        for cell in &self.cells {
            writer.serialize(cell).map_err(refuse)?;
        }
        writer.into_inner().map_err(|error| Error::file("table.csv", error.error()))
    }

    /// Reads a table from its CSV.
    ///
    /// # Errors
    /// Names the row that cannot be read.
    pub fn from_csv(text: &str) -> Result<Self> {
        let rows = csv::Reader::from_reader(text.as_bytes()).into_deserialize();
        let cells = rows.collect::<std::result::Result<_, _>>();
        Ok(Self { cells: cells.map_err(|error| Error::file("table.csv", error))? })
    }

    /// Results of a variant on a challenge, level by level.
    fn levels(&self, challenge: &Challenge, variant: &Change) -> Vec<&StabilityCell> {
        let of_both =
            |cell: &&StabilityCell| cell.scene == challenge.name && cell.method == variant.name;
        self.cells.iter().filter(of_both).collect()
    }

    fn challenges(&self) -> Vec<&'static Challenge> {
        let tried =
            |challenge: &&Challenge| self.cells.iter().any(|cell| cell.scene == challenge.name);
        CHALLENGES.iter().filter(tried).collect()
    }
}

/// The worst verdict over all levels, and the first level with it.
fn summary(levels: &[&StabilityCell]) -> (StabilityVerdict, Option<f64>) {
    let worst = levels.iter().map(|cell| cell.verdict).max().unwrap_or(StabilityVerdict::Holds);
    let first =
        levels.iter().find(|cell| cell.verdict == worst && worst != StabilityVerdict::Holds);
    (worst, first.map(|cell| cell.level))
}

fn cell(challenge: &Challenge, trial: &Trial) -> Result<StabilityCell> {
    let error = challenge.error(trial)?;
    Ok(StabilityCell {
        scene: challenge.name.to_owned(),
        method: trial.variant.name.clone(),
        level: trial.level,
        verdict: StabilityVerdict::of(error, challenge.limits),
        error: format!("{error:.1e}"),
    })
}

const SCENE_WIDTH: usize = 17;
const CELL_WIDTH: usize = 16;

impl fmt::Display for StabilityTable {
    /// One line per challenge and one column per variant: the worst verdict, and the first level with it.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{:SCENE_WIDTH$}", "")?;
        for variant in VARIANTS.iter() {
            write!(out, "{:CELL_WIDTH$}", variant.name)?;
        }
        writeln!(out)?;
        for challenge in self.challenges() {
            write!(out, "{:SCENE_WIDTH$}", challenge.name)?;
            for variant in VARIANTS.iter() {
                let (verdict, from) = summary(&self.levels(challenge, variant));
                let from = from.map_or(String::new(), |level| format!(" {}", number(level)));
                write!(out, "{:CELL_WIDTH$}", format!("{}{from}", verdict.name()))?;
            }
            writeln!(out, "{}", challenge.driver)?;
        }
        Ok(())
    }
}

/// A number in its shortest form.
fn number(value: f64) -> String {
    if value != 0.0 && !(1e-2..1e4).contains(&value.abs()) {
        format!("{value:e}").replace('-', "−")
    } else {
        format!("{value}")
    }
}

/// Number of columns side by side. With more columns, their text would not fit into the page width.
const COLUMNS: usize = 10;
/// Width of a page, height of a row, and space for text below, pixels.
const WIDTH: u32 = 1200;
const ROW: u32 = 32;
const BELOW: u32 = 150;

/// Colours of holding, degrading and failing, which also differ in lightness.
const COLOURS: [Rgb; 3] = [(206, 234, 214), (253, 226, 147), (240, 150, 130)];

pub(super) fn colour(verdict: f64) -> Rgb {
    COLOURS[(verdict as usize).min(2)]
}

/// The table as a picture: blocks of columns, each below its headers.
pub fn picture(table: &StabilityTable) -> Sheet {
    let challenges = table.challenges();
    // Names with two words take two lines.
    let rows_of_block = challenges.len() + 2;
    let rows = VARIANTS.len().div_ceil(COLUMNS) * rows_of_block;
    let mut x = Axis::linear("", 0.0, COLUMNS as f64);
    x.ticks = vec![(0.0, String::new())];
    let mut y = Axis::linear("", 0.0, rows as f64);
    let mut cells = Vec::new();
    let mut words = Vec::new();
    for (block, variants) in VARIANTS.chunks(COLUMNS).enumerate() {
        let height = |row: usize| (rows - block * rows_of_block - row) as f64 - 0.5;
        let mut write = |text: String, column: usize, row: usize| {
            let at = (column as f64 + 0.04, height(row) + 0.26);
            words.push(Layer::Words { at, text, colour: INK });
        };
        for (column, variant) in variants.iter().enumerate() {
            let end_of_first = variant.name.find([' ', '-']).map_or(0, |at| at + 1);
            let (first, second) = variant.name.split_at(end_of_first);
            write(first.to_owned(), column, 0);
            write(second.to_owned(), column, 1);
        }
        for (challenge, row) in challenges.iter().zip(2..) {
            y.ticks.push((height(row), challenge.name.to_owned()));
            for (column, variant) in variants.iter().enumerate() {
                let levels = table.levels(challenge, variant);
                let (verdict, from) = summary(&levels);
                let (x, y) = (column as f64 + 0.5, height(row));
                cells.push(chart::MapCell {
                    x: (x, [x - 0.49, x + 0.49]),
                    y: (y, [y - 0.47, y + 0.47]),
                    value: f64::from(verdict as u8),
                });
                let first = levels.iter().find(|cell| cell.verdict != StabilityVerdict::Holds);
                let text = match (first.map(|cell| cell.level), from) {
                    (Some(first), Some(worst)) if first == worst => {
                        format!("from {}", number(first))
                    }
                    (Some(first), Some(worst)) => {
                        format!("{}, {}", number(first), number(worst))
                    }
                    _ => "holds".to_owned(),
                };
                write(text, column, row);
            }
        }
    }
    let mut chart = Chart::new("Where methods fail", x, y);
    chart.layers.push(Layer::Cells { name: "verdict".into(), cells, colour });
    chart.layers.extend(words);
    let drivers: Vec<String> =
        challenges.iter().map(|one| format!("{}: {}", one.name, one.driver)).collect();
    let caption = vec![
        "Green holds; yellow degrades and red fails, from that value of the parameter on. Two values: it degrades from \
         the first on and fails from the second on."
            .into(),
        drivers.join("; "),
    ];
    Sheet { size: (WIDTH, BELOW + ROW * rows as u32), charts: vec![chart], caption }
}
