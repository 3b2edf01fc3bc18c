//! A study as its file says it, laid out as runs.

use std::collections::HashMap;
use std::path::Path;

use serde::{Deserialize, Serialize};
use toml::{Table, Value};

use super::axis;
use super::planned_run::{PlannedRun, short};
use crate::config::Config;
use crate::data::DataSettings;
use crate::error::{Error, Result, in_words};

/// More runs than this are a mistake rather than a wish: planned, run and told of they take some 2 kB
/// each.
const MOST_RUNS: usize = 1_000_000;

/// What a study file must be, for messages.
const FORM: &str = "a study file in TOML with name, base and vary";

/// A study file. Tables are read by hand below, since what they may hold is what a [`Config`] holds.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct StudyFile {
    name: String,
    /// What it is for, in words.
    #[serde(default, rename = "about")]
    _about: String,
    #[serde(default)]
    base: Table,
    #[serde(default)]
    vary: Table,
    series: Option<SeriesSettings>,
    data: Option<DataSettings>,
    #[serde(default)]
    quick: Quick,
}

/// What a quick pass does otherwise.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Quick {
    base: Table,
    vary: Table,
}

/// What is kept of the course of each run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SeriesSettings {
    /// Simulated time between two rows, s.
    pub interval: f64,
    /// The grains whose positions are kept, by number.
    #[serde(default)]
    pub grains: Vec<usize>,
}

/// A study: a list of runs in the order of its table.
#[derive(Clone, Debug)]
pub struct Study {
    /// Its name.
    pub name: String,
    /// Tells studies apart: hash of the keys of all runs.
    pub fingerprint: String,
    /// What is kept of the course of each run, if anything.
    pub series: Option<SeriesSettings>,
    /// What is recorded of each run, if anything: below the results, in a folder that has the run's key.
    pub data: Option<DataSettings>,
    /// The runs.
    pub runs: Vec<PlannedRun>,
}

impl Study {
    /// Reads a study file and lays out its runs, all of them checked.
    ///
    /// # Errors
    /// Where the file cannot be read or says something that no study says.
    pub fn read(path: &Path, quick: bool) -> Result<Self> {
        let text =
            std::fs::read_to_string(path).map_err(|error| Error::unread(path, error, FORM))?;
        Self::parse(&text, path, quick)
    }

    /// Lays out the runs of a study file's text; `path` is for messages.
    ///
    /// # Errors
    /// Where it says something that no study says.
    pub fn parse(text: &str, path: &Path, quick: bool) -> Result<Self> {
        let mut file: StudyFile = toml::from_str(text).map_err(|error| {
            let line = error.span().map(|span| 1 + text[..span.start].matches('\n').count());
            let place = line.map_or(String::new(), |line| format!("line {line}: "));
            Error::unread(path, format!("{place}{}", one_line(error.message())), FORM)
        })?;
        if quick {
            replace(
                "quick.base",
                &mut file.base,
                &mut file.vary,
                std::mem::take(&mut file.quick.base),
            )?;
            replace(
                "quick.vary",
                &mut file.vary,
                &mut file.base,
                std::mem::take(&mut file.quick.vary),
            )?;
        }
        let series_is_sound =
            |series: &SeriesSettings| series.interval > 0.0 && series.interval.is_finite();
        if let Some(series) = file.series.as_ref().filter(|series| !series_is_sound(series)) {
            return Err(Error::value(
                "series.interval",
                series.interval,
                "a finite number of seconds > 0",
            ));
        }
        if let Some(data) = &file.data {
            data.validate("data.every_secs")?;
            if let Some(folder) = &data.folder {
                let allowed = "left out in a study: each run has its own below the results";
                return Err(Error::value("data.folder", folder.display(), allowed));
            }
        }
        let runs = lay_out(&file)?;
        let mut hasher = blake3::Hasher::new();
        for run in &runs {
            hasher.update(run.key.as_bytes());
        }
        Ok(Self {
            name: file.name,
            fingerprint: short(&hasher),
            series: file.series,
            data: file.data,
            runs,
        })
    }
}

/// Puts the values of a quick pass in the place of those they stand for, whether those vary or not.
fn replace(from: &str, to: &mut Table, other: &mut Table, values: Table) -> Result<()> {
    for (key, value) in values {
        if other.remove(&key).is_none() && !to.contains_key(&key) {
            let field = format!("{from}.{key}");
            return Err(Error::value(field, "given", "a parameter of base or vary"));
        }
        to.insert(key, value);
    }
    Ok(())
}

fn lay_out(file: &StudyFile) -> Result<Vec<PlannedRun>> {
    let varied = file.vary.keys().flat_map(|key| key.split_whitespace());
    let mut given: Vec<&str> = file.base.keys().map(String::as_str).collect();
    for name in varied {
        if given.contains(&name) {
            let field = format!("vary.{name}");
            return Err(Error::value(field, "given twice", "in one place alone"));
        }
        given.push(name);
    }
    // Wrong names and types are told of by table and key, before any product is formed.
    for (key, value) in &file.base {
        config_of("base", [(key, value)])?;
    }
    let mut axes = Vec::new();
    let mut count = 1usize;
    for (key, said) in &file.vary {
        let axis = Axis::read(key, said)?;
        count = count.saturating_mul(axis.values.len());
        // Before the next axis: its values, too, take room.
        if count > MOST_RUNS {
            let found = format!("{count} runs with vary.{key}");
            let allowed = format!("no more than {MOST_RUNS}; take two studies for more");
            return Err(Error::value("vary", found, allowed));
        }
        axes.push(axis);
    }
    let mut grounds = HashMap::new();
    let series = file.series.as_ref();
    let grains: &[usize] = series.map_or(&[], |series| &series.grains);
    let run = |mut number: usize| {
        let mut chosen = Vec::new();
        for Axis { names, values } in axes.iter().rev() {
            chosen.extend(names.iter().zip(&values[number % values.len()]));
            number /= values.len();
        }
        chosen.extend(&file.base);
        PlannedRun::new(&config_of("base", chosen)?, grains, &(series, &file.data), &mut grounds)
    };
    (0..count).map(run).collect()
}

/// What varies together: most often one parameter, or several that go hand in hand, which the file
/// writes as `"grains box-width" = [[138, 16], [500, 30]]`.
struct Axis {
    names: Vec<String>,
    /// A value for each name.
    values: Vec<Vec<Value>>,
}

impl Axis {
    fn read(key: &str, said: &Value) -> Result<Self> {
        let field = format!("vary.{key}");
        let names: Vec<String> = key.split_whitespace().map(str::to_owned).collect();
        let sets = axis::values(&field, said)?.into_iter().map(|value| match value {
            value if names.len() == 1 => Ok(vec![value]),
            Value::Array(set) if set.len() == names.len() => Ok(set),
            other => {
                let allowed = format!("a list of {} values", names.len());
                Err(Error::value(&field, other, allowed))
            }
        });
        let values = sets.collect::<Result<Vec<_>>>()?;
        for (name, value) in values.iter().flat_map(|set| names.iter().zip(set)) {
            config_of("vary", [(name, value)])?;
        }
        Ok(Self { names, values })
    }
}

fn config_of<'a>(
    table: &str,
    said: impl IntoIterator<Item = (&'a String, &'a Value)>,
) -> Result<Config> {
    let said: Table = said.into_iter().map(|(key, value)| (key.clone(), value.clone())).collect();
    let words = said.iter().next().map(|(key, value)| (key.clone(), value.to_string()));
    Config::deserialize(said).map_err(|error| {
        let (key, value) = words.unwrap_or_default();
        let reason = one_line(&error.to_string());
        match reason.split_once("expected ") {
            Some((_, expected)) => {
                let expected = expected.split(" in '").next().unwrap_or(expected);
                Error::value(format!("{table}.{key}"), value, in_words(expected))
            }
            None => {
                let allowed = format!("of its range: {reason}");
                Error::value(format!("{table}.{key}"), value, allowed)
            }
        }
    })
}

fn one_line(message: &str) -> String {
    message.trim_end().replace('\n', " ").replace('`', "'")
}
