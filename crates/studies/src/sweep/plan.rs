//! Reads study files and lists the runs of a study. Each run gets its complete settings and a unique key.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::path::Path;

use serde::{Deserialize, Serialize};
use toml::{Table, Value};

use super::drawing_choice::SweepChart;
use super::ranges::values;
use crate::config::{BaseScene, Config};
use crate::data::DataSettings;
use crate::error::{self, Error, Result, in_words};
use crate::input::{MOST_OF_TOML, read_text};

/// Largest number of runs of a study. A larger number is probably a mistake. Each run takes about 2 kB of memory.
const MOST_RUNS: usize = 1_000_000;

/// Name of the setting that distinguishes the initial states of a scene: the seed of the random numbers.
pub(super) const SEED: &str = "seed";

/// Description of the expected form of a study file, for error messages.
const FORM: &str = "a study file in TOML with name, base and vary";

/// A study file as written by the user. The values of its tables `base` and `vary` are parsed separately, because these
/// tables may contain every setting of a [`Config`].
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct StudyFile {
    name: String,
    /// Purpose of the study, in words.
    #[serde(default, rename = "about")]
    _about: String,
    #[serde(default)]
    base: Table,
    #[serde(default)]
    vary: Table,
    series: Option<SeriesSettings>,
    data: Option<DataSettings>,
    chart: Option<SweepChart>,
    #[serde(default)]
    quick: Quick,
}

/// Values that replace values of the study file's tables `base` and `vary` in a quick pass, which has fewer runs.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Quick {
    base: Table,
    vary: Table,
}

/// Settings of the time series of a run: a table with one row per interval of simulated time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SeriesSettings {
    /// Simulated time between two rows of a time series, s.
    pub interval: f64,
    /// Indices of the grains whose positions the rows of a time series contain.
    #[serde(default)]
    pub grains: Vec<usize>,
}

/// A study: a list of runs with different settings, in the order of the rows of its table of results.
#[derive(Clone, Debug)]
pub struct Study {
    /// Name of the study.
    pub name: String,
    /// Identity of the study: a hash of the keys of all runs.
    pub fingerprint: String,
    /// True if the runs are those of a quick pass (a pass with fewer runs), for which the study file gives other values
    /// than for the full pass.
    pub is_quick_pass: bool,
    /// Settings of the time series that each run writes, if any.
    pub series: Option<SeriesSettings>,
    /// Settings of the recordings, if any. A recording contains the grains of a run over time. It is stored in the
    /// folder of results, in a folder named after the run's key.
    pub data: Option<DataSettings>,
    /// Description of the chart of the results, if any.
    pub chart: Option<SweepChart>,
    /// Names of the settings that differ between the runs. Each inner list contains the settings that vary together,
    /// usually only one.
    pub varied: Vec<Vec<String>>,
    /// Runs of the study.
    pub runs: Vec<PlannedRun>,
}

impl Study {
    /// Reads a study file, and lists and checks all its runs. `quick` selects the quick pass (a pass with fewer runs),
    /// with the values of the file's table `quick`.
    ///
    /// # Errors
    /// If the file cannot be read or is not a valid study.
    pub fn read(path: &Path, quick: bool) -> Result<Self> {
        let text = read_text(path, FORM, MOST_OF_TOML)?;
        Self::parse(&text, path, quick)
    }

    /// Reads a study from the text of its file, and lists and checks all its runs. `quick` selects the quick pass (a
    /// pass with fewer runs). `path` is the file's path, for error messages and relative paths.
    ///
    /// # Errors
    /// If the text is not a valid study.
    pub fn parse(text: &str, path: &Path, quick: bool) -> Result<Self> {
        let mut file: StudyFile = toml::from_str(text).map_err(|error| {
            let line = error.span().map(|span| 1 + text[..span.start].matches('\n').count());
            let place = line.map_or(String::new(), |line| format!("line {line}: "));
            Error::unread(path, format!("{place}{}", one_line(error.message())), FORM)
        })?;
        let varied = |vary: &Table| -> Vec<_> { vary.keys().map(|key| names_of(key)).collect() };
        file.chart.as_ref().map_or(Ok(()), |chart| chart.check(&varied(&file.vary)))?;
        let Quick { base, vary } = std::mem::take(&mut file.quick);
        let is_quick_pass = quick && !(base.is_empty() && vary.is_empty());
        if is_quick_pass {
            replace("quick.base", &mut file.base, &mut file.vary, base)?;
            replace("quick.vary", &mut file.vary, &mut file.base, vary)?;
        }
        let interval = file.series.as_ref().map(|series| series.interval);
        if let Some(secs) = interval.filter(|secs| !(*secs > 0.0 && secs.is_finite())) {
            return Err(Error::value("series.interval", secs, "a finite number of seconds > 0"));
        }
        if let Some(data) = &file.data {
            data.validate("data.every_secs")?;
            if let Some(folder) = &data.folder {
                let allowed = "left out in a study: each run has its own below the results";
                return Err(Error::value("data.folder", folder.display(), allowed));
            }
        }
        let runs = lay_out(&file, path.parent().unwrap_or(Path::new("")))?;
        let mut hasher = blake3::Hasher::new();
        for run in &runs {
            hasher.update(run.key.as_bytes());
        }
        Ok(Self {
            name: file.name,
            fingerprint: short(&hasher),
            is_quick_pass,
            series: file.series,
            data: file.data,
            chart: file.chart,
            varied: varied(&file.vary),
            runs,
        })
    }
}

/// Replaces settings in the table `to` of a study file, which is `base` or `vary`, by `values`, the settings of a quick
/// pass (a pass with fewer runs). A setting that varies in the full pass may be constant in the quick pass or vice
/// versa, so each setting in `values` is also removed from `other`, the second of these two tables. `from` is the name
/// of the table that contains `values`, for error messages.
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

/// Returns the runs of a study file: one run per combination of the varied values. Relative paths in the study file
/// refer to `folder`.
fn lay_out(file: &StudyFile, folder: &Path) -> Result<Vec<PlannedRun>> {
    let varied = file.vary.keys().flat_map(|key| key.split_whitespace());
    let mut given: Vec<&str> = file.base.keys().map(String::as_str).collect();
    for name in varied {
        let field = format!("vary.{name}");
        error::check(!given.contains(&name), field, "given twice", "in one place alone")?;
        given.push(name);
    }
    // Wrong names and types are found here, before combinations are formed, so that the error names the table and the
    // key.
    for (key, value) in &file.base {
        config_of("base", [(key, value)])?;
    }
    let mut axes = Vec::new();
    let mut count = 1usize;
    for (key, said) in &file.vary {
        let axis = VariedParameters::read(key, said)?;
        count = count.saturating_mul(axis.values.len());
        // The count is checked before the next setting is read, because the values of that setting also take memory.
        if count > MOST_RUNS {
            let found = format!("{count} runs with vary.{key}");
            let allowed = format!("no more than {MOST_RUNS}; take two studies for more");
            return Err(Error::value("vary", found, allowed));
        }
        axes.push(axis);
    }
    let mut bases = HashMap::new();
    let series = file.series.as_ref();
    let grains: &[usize] = series.map_or(&[], |series| &series.grains);
    let run = |mut number: usize| {
        let mut chosen = Vec::new();
        for VariedParameters { names, values } in axes.iter().rev() {
            chosen.extend(names.iter().zip(&values[number % values.len()]));
            number /= values.len();
        }
        chosen.extend(&file.base);
        let config = Config { folder: folder.to_owned(), ..config_of("base", chosen)? };
        PlannedRun::new(&config, grains, &(series, &file.data), &mut bases)
    };
    (0..count).map(run).collect()
}

/// Settings that vary together: usually one setting, or several whose values change in parallel, written as `"grains
/// box-width" = [[138, 16], [500, 30]]` in the study file.
struct VariedParameters {
    names: Vec<String>,
    /// Sets of values, each with one value per setting.
    values: Vec<Vec<Value>>,
}

impl VariedParameters {
    fn read(key: &str, said: &Value) -> Result<Self> {
        let field = format!("vary.{key}");
        let names = names_of(key);
        let sets = values(&field, said)?.into_iter().map(|value| match value {
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

fn names_of(key: &str) -> Vec<String> {
    key.split_whitespace().map(str::to_owned).collect()
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

/// A run of a study, before it is computed.
#[derive(Clone, Debug)]
pub struct PlannedRun {
    /// Unique name of the run: a hash of everything that affects its result.
    pub key: String,
    /// Settings of the run, with every default filled in.
    pub config: Config,
    /// Expected computing time, in a unit that all runs of the study share. It determines the order in which runs are
    /// computed, and how far the progress bar moves when the run is finished.
    pub cost: f64,
}

/// A scene before the settings of a run are applied. It is kept in memory, because several runs use it.
struct Known {
    base: BaseScene,
    /// Hash of all discs of the scene.
    discs: String,
}

impl Known {
    fn of(config: &Config) -> Result<Self> {
        let base = config.base_scene()?;
        let scene = config.change(&base)?;
        let discs = short(&hash(&(&scene.grains, &scene.fixed_discs), &scene.name)?);
        Ok(Self { base, discs })
    }
}

impl PlannedRun {
    /// Returns the run with the settings `config`. `grains_asked_for` are the indices of the grains whose positions the
    /// run writes over time. `outputs` are the output settings, which are a part of the run's key. `bases` keeps scenes
    /// that several runs use.
    fn new(
        config: &Config,
        grains_asked_for: &[usize],
        outputs: &impl Serialize,
        bases: &mut HashMap<String, Known>,
    ) -> Result<Self> {
        let known = match bases.entry(config.base_scene_key()) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(place) => place.insert(Known::of(config)?),
        };
        let mut scene = config.change(&known.base)?;
        // The study file alone determines the output of its runs.
        scene.data = None;
        let config = config.resolved(&scene);
        let grains = config.source.grains.unwrap_or(scene.grains.len());
        if let Some(grain) = grains_asked_for.iter().find(|&&grain| grain >= grains) {
            return Err(Error::value("series.grains", grain, format!("below {grains}")));
        }
        // The key contains the scene instead of the files from which the scene was read. It contains a hash of the
        // discs instead of the discs, which are nearly all of the data and the same in each run.
        scene.grains.clear();
        scene.fixed_discs.clear();
        let made_of = (env!("CARGO_PKG_VERSION"), &config, &scene, &known.discs, outputs);
        let hasher = hash(&made_of, &scene.name)?;
        let steps = scene.duration_secs / scene.parameters.time_step_secs;
        let digits = 1.0 - scene.solver.tolerance.log10().min(0.0);
        Ok(Self { key: short(&hasher), cost: steps * grains as f64 * digits, config })
    }
}

fn hash(said: &impl Serialize, scene: &str) -> Result<blake3::Hasher> {
    let said = serde_json::to_vec(said)
        .map_err(|error| Error::value("scene", scene, error.to_string()))?;
    let mut hasher = blake3::Hasher::new();
    hasher.update(&said);
    Ok(hasher)
}

/// Returns the first half of a hash (128 bits) as hexadecimal digits. With this many bits, two different inputs
/// practically never give the same digits.
fn short(hasher: &blake3::Hasher) -> String {
    hasher.finalize().to_hex()[..32].to_owned()
}
