//! Computes the table of verdicts on every solver variant, in every stability test and at every value of its driving
//! parameter (the parameter that makes the test more difficult). Writes the table as CSV, as text and as a picture.

use std::fmt;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{CHALLENGES, Challenge, DEFAULT, Trial, VARIANTS};
use crate::chart::{self, Axis, Chart, INK, Layer, Rgb, Sheet};
use crate::error::{Error, Result};
use crate::harness::Change;

/// Verdict on a solver variant in a stability test. The verdicts are ordered from the best to the worst.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum StabilityVerdict {
    /// The result of the run is right: its error is at most the first limit of the test.
    Holds,
    /// The result of the run is inaccurate, but the scene stays intact: the error is between the two limits of the
    /// test.
    Degrades,
    /// The result of the run is wrong: its error is above the second limit of the test.
    Fails,
    /// The method does not support a part of the scene, such as rolling friction, and says so.
    Refuses,
}

impl StabilityVerdict {
    fn of(error: f64, [holds, fails]: [f64; 2]) -> Self {
        // The comparisons are false for an error of NaN, which therefore fails.
        if error <= holds {
            Self::Holds
        } else if error <= fails {
            Self::Degrades
        } else {
            Self::Fails
        }
    }

    /// Returns the verdict as a single word, such as "holds" or "fails".
    pub fn name(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Degrades => "degrades",
            Self::Fails => "fails",
            Self::Refuses => "refuses",
        }
    }
}

/// A row of the table of stability tests: the result of one solver variant in one test, at one value of the driving
/// parameter (the parameter that makes the test more difficult).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StabilityCell {
    /// Name of the stability test.
    pub scene: String,
    /// Name of the variant of the solver or stepper.
    pub method: String,
    /// Value of the test's driving parameter (the parameter that makes the test more difficult).
    pub level: f64,
    /// Verdict on the solver variant in this run.
    pub verdict: StabilityVerdict,
    /// Error with two digits, because further digits differ between builds of the program. Empty if the method refuses the
    /// scene.
    pub error: String,
}

/// The results of all stability tests.
#[derive(Clone, Debug, Default)]
pub struct StabilityTable {
    /// Results of the runs, sorted by test, then by solver variant, then by the value of the test's driving parameter.
    pub cells: Vec<StabilityCell>,
}

impl StabilityTable {
    /// Runs every solver variant in the given stability tests, on all cores. `progress` is called after each run.
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

    /// Returns the number of runs that [`StabilityTable::run`] computes.
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

    /// Returns the table as CSV.
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
    /// If a row cannot be read; the error names the row.
    pub fn from_csv(text: &str) -> Result<Self> {
        let rows = csv::Reader::from_reader(text.as_bytes()).into_deserialize();
        let cells = rows.collect::<std::result::Result<_, _>>();
        Ok(Self { cells: cells.map_err(|error| Error::file("table.csv", error))? })
    }

    /// Returns the results of a solver variant in a stability test, one per value of the driving parameter, from the
    /// easiest to the most difficult value.
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

/// Returns the worst verdict among the results `levels` of one solver variant in one test, and the first value of the
/// driving parameter with this verdict; `None` if all verdicts are "holds", or if the variant refuses the scene.
fn summary(levels: &[&StabilityCell]) -> (StabilityVerdict, Option<f64>) {
    let worst = levels.iter().map(|cell| cell.verdict).max().unwrap_or(StabilityVerdict::Holds);
    let has_levels = matches!(worst, StabilityVerdict::Degrades | StabilityVerdict::Fails);
    let first = levels.iter().find(|cell| cell.verdict == worst && has_levels);
    (worst, first.map(|cell| cell.level))
}

fn cell(challenge: &Challenge, trial: &Trial) -> Result<StabilityCell> {
    let (verdict, error) = match challenge.error(trial) {
        Ok(error) => (StabilityVerdict::of(error, challenge.limits), format!("{error:.1e}")),
        // The default accepts every scene, so the variant is the reason for the refusal.
        Err(Error::Value { .. }) if trial.variant.name != DEFAULT => {
            (StabilityVerdict::Refuses, String::new())
        }
        Err(error) => return Err(error),
    };
    Ok(StabilityCell {
        scene: challenge.name.to_owned(),
        method: trial.variant.name.clone(),
        level: trial.level,
        verdict,
        error,
    })
}

const SCENE_WIDTH: usize = 17;
const CELL_WIDTH: usize = 16;

impl fmt::Display for StabilityTable {
    /// Writes one line per stability test and one column per solver variant. A cell contains the worst verdict, and the
    /// first value of the test's driving parameter with this verdict.
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

/// Formats a value of a driving parameter in its shortest form, as in 1e−4 or 20.
fn number(value: f64) -> String {
    if value != 0.0 && !(1e-2..1e4).contains(&value.abs()) {
        format!("{value:e}").replace('-', "−")
    } else {
        format!("{value}")
    }
}

/// Number of columns (solver variants) side by side in the picture of the table. More columns would be too narrow for
/// their text.
const COLUMNS: usize = 10;
/// Width of the picture of the table, pixels.
const WIDTH: u32 = 1200;
/// Height of a row in the picture of the table, pixels.
const ROW: u32 = 32;
/// Height of the space for text below the table in its picture, pixels.
const BELOW: u32 = 150;

/// Colours of the verdicts "holds", "degrades", "fails" and "refuses". They also differ in lightness.
const COLOURS: [Rgb; 4] = [(206, 234, 214), (253, 226, 147), (240, 150, 130), (232, 232, 232)];

pub(super) fn colour(verdict: f64) -> Rgb {
    COLOURS[(verdict as usize).min(3)]
}

/// Draws the table of verdicts as a picture. The columns (solver variants) are divided into blocks, which are drawn one
/// below the other.
pub fn picture(table: &StabilityTable) -> Sheet {
    let challenges = table.challenges();
    // Each block has two lines of headers, because names with two words take two lines.
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
                    _ => verdict.name().to_owned(),
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
         the first on and fails from the second on. Grey: the method does not support rolling friction and refuses the scene."
            .into(),
        drivers.join("; "),
    ];
    Sheet { size: (WIDTH, BELOW + ROW * rows as u32), charts: vec![chart], caption }
}
