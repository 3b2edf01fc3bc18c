//! A study as its file has it, laid out as runs: what each is made of, and the key that tells it from all others.

use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};
use std::fmt::Display;
use std::path::Path;

use serde::{Deserialize, Serialize};
use toml::{Table, Value};

use super::sweep_chart::SweepChart;
use crate::config::{BaseScene, Config};
use crate::data::DataSettings;
use crate::error::{Error, Result, in_words};
use crate::input::{MOST_OF_TOML, read_text};

/// More runs than this are a mistake rather than a wish: planned, run and listed they take some 2 kB
/// each.
const MOST_RUNS: usize = 1_000_000;

/// The parameter that tells the starts of a scene apart.
pub(super) const SEED: &str = "seed";

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
    chart: Option<SweepChart>,
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

/// Which rows a run writes over time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SeriesSettings {
    /// Simulated time between two rows, s.
    pub interval: f64,
    /// The grains whose positions are written, by number.
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
    /// True if these are the runs of a quick pass, which differs from the full one.
    pub is_quick_pass: bool,
    /// Which rows each run writes over time, if any.
    pub series: Option<SeriesSettings>,
    /// What is recorded of each run, if anything: below the results, in a folder that has the run's key.
    pub data: Option<DataSettings>,
    /// What is drawn of the results, if anything.
    pub chart: Option<SweepChart>,
    /// The names of what varies, a list of them for what varies together.
    pub varied: Vec<Vec<String>>,
    /// The runs.
    pub runs: Vec<PlannedRun>,
}

impl Study {
    /// Reads a study file and lays out its runs, all of them checked.
    ///
    /// # Errors
    /// Where the file cannot be read or says something that no study says.
    pub fn read(path: &Path, quick: bool) -> Result<Self> {
        let text = read_text(path, FORM, MOST_OF_TOML)?;
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

/// The runs of a study. Files that it names are relative to `folder`.
fn lay_out(file: &StudyFile, folder: &Path) -> Result<Vec<PlannedRun>> {
    let varied = file.vary.keys().flat_map(|key| key.split_whitespace());
    let mut given: Vec<&str> = file.base.keys().map(String::as_str).collect();
    for name in varied {
        if given.contains(&name) {
            let field = format!("vary.{name}");
            return Err(Error::value(field, "given twice", "in one place alone"));
        }
        given.push(name);
    }
    // Wrong names and types are refused by table and key, before any product is formed.
    for (key, value) in &file.base {
        config_of("base", [(key, value)])?;
    }
    let mut axes = Vec::new();
    let mut count = 1usize;
    for (key, said) in &file.vary {
        let axis = VariedParameters::read(key, said)?;
        count = count.saturating_mul(axis.values.len());
        // Before the next axis: its values, too, take room.
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

/// What varies together: most often one parameter, or several that go hand in hand, which the file
/// writes as `"grains box-width" = [[138, 16], [500, 30]]`.
struct VariedParameters {
    names: Vec<String>,
    /// A value for each name.
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

/// One run of a study.
#[derive(Clone, Debug)]
pub struct PlannedRun {
    /// Names it: hash of all that its result hangs on.
    pub key: String,
    /// What it runs, every number filled in.
    pub config: Config,
    /// How long it may take, in any unit: for the order of work and for progress.
    pub cost: f64,
}

/// A base scene that has been read.
struct Known {
    base: BaseScene,
    /// Hash of all its discs.
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
    /// That of a config. Series have these grains; `outputs` is what is written of the run besides its result, and
    /// `bases` what has been read, by name.
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
        // The study says what is written of its runs.
        scene.data = None;
        let config = config.resolved(&scene);
        let grains = config.source.grains.unwrap_or(scene.grains.len());
        if let Some(grain) = grains_asked_for.iter().find(|&&grain| grain >= grains) {
            return Err(Error::value("series.grains", grain, format!("below {grains}")));
        }
        // The scene stands in for the files that it may have been read from, the hash of its discs for them:
        // they are nearly all that it says, and the same in each run.
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

/// Half of a hash: 128 bits never meet by chance.
fn short(hasher: &blake3::Hasher) -> String {
    hasher.finalize().to_hex()[..32].to_owned()
}

/// Digits that the values of a range are rounded to, so that they read well and are the same on
/// every machine.
const DIGITS: usize = 9;
/// More values than this in one range are a mistake rather than a wish.
const MOST_VALUES: i64 = 1_000_000;

/// The values that a list or a range stands for. `field` is for messages.
///
/// A list is `[0, 20, 50]`. A range is `{ from = 1, to = 16 }`, whole numbers one by one, or
/// `{ from = 1e-4, to = 1e-2, count = 20 }`, evenly spaced, with `scale = "log"` in ratio.
fn values(field: &str, said: &Value) -> Result<Vec<Value>> {
    let values = match said {
        Value::Array(list) => list.clone(),
        Value::Table(range) => of_range(field, range)?,
        other => {
            let allowed = "a list [a, b] or a range { from = a, to = b }";
            return Err(Error::value(field, other, allowed));
        }
    };
    if values.is_empty() {
        return Err(Error::value(field, "empty", "at least one value"));
    }
    let mut earlier = HashSet::with_capacity(values.len());
    if let Some(value) = values.iter().find(|value| !earlier.insert(meaning(value))) {
        return Err(Error::value(field, format!("{value} twice"), "a list of different values"));
    }
    Ok(values)
}

/// What two values share that mean the same number or word: 1 and 1.0 do, 0 and -0.0 as well.
fn meaning(value: &Value) -> (Option<u64>, String) {
    match number(value) {
        Some(number) => (Some((number + 0.0).to_bits()), String::new()),
        None => (None, value.to_string()),
    }
}

fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Integer(integer) => Some(*integer as f64),
        Value::Float(float) => Some(*float),
        _ => None,
    }
}

fn of_range(field: &str, range: &Table) -> Result<Vec<Value>> {
    let known = ["from", "to", "count", "scale"];
    if let Some(key) = range.keys().find(|key| !known.contains(&key.as_str())) {
        return Err(Error::value(
            format!("{field}.{key}"),
            "given",
            "one of from, to, count, scale",
        ));
    }
    let bound = |key: &str| {
        let value = range.get(key);
        value.and_then(number).filter(|bound| bound.is_finite()).ok_or_else(|| {
            let found = value.map_or("missing".to_owned(), Value::to_string);
            Error::value(format!("{field}.{key}"), found, "a finite number")
        })
    };
    let (from, to) = (bound("from")?, bound("to")?);
    if !range.contains_key("count") {
        return whole_numbers(field, range);
    }
    let count = match &range["count"] {
        Value::Integer(count @ 2..=MOST_VALUES) => *count,
        other => {
            let allowed = format!("a whole number between 2 and {MOST_VALUES}");
            return Err(Error::value(format!("{field}.count"), other, allowed));
        }
    };
    if to <= from {
        return Err(not_above(field, "above", from, to));
    }
    let logarithmic = is_logarithmic(field, range, from)?;
    let value = |index: i64| {
        let share = index as f64 / (count - 1) as f64;
        let exact = match (index, logarithmic) {
            (0, _) => from,
            (index, _) if index == count - 1 => to,
            (_, true) => from * (to / from).powf(share),
            (_, false) => from + (to - from) * share,
        };
        Value::Float(rounded(exact))
    };
    Ok((0..count).map(value).collect())
}

/// A range that says no number of values: whole numbers one by one.
fn whole_numbers(field: &str, range: &Table) -> Result<Vec<Value>> {
    let (Value::Integer(from), Value::Integer(to)) = (&range["from"], &range["to"]) else {
        let allowed = "a number of values, as the bounds are not both whole numbers";
        return Err(Error::value(format!("{field}.count"), "missing", allowed));
    };
    if to < from {
        return Err(not_above(field, "at least", from, to));
    }
    if to.saturating_sub(*from) >= MOST_VALUES {
        let allowed = format!("no more than {MOST_VALUES} above from");
        return Err(Error::value(format!("{field}.to"), to, allowed));
    }
    Ok((*from..=*to).map(Value::Integer).collect())
}

fn not_above(field: &str, least: &str, from: impl Display, to: impl Display) -> Error {
    Error::value(format!("{field}.to"), to, format!("{least} from, which is {from}"))
}

/// True if values are evenly spaced in ratio.
fn is_logarithmic(field: &str, range: &Table, from: f64) -> Result<bool> {
    let Some(scale) = range.get("scale") else { return Ok(false) };
    match scale.as_str() {
        Some("linear") => Ok(false),
        Some("log") if from > 0.0 => Ok(true),
        Some("log") => Err(Error::value(format!("{field}.from"), from, "> 0 where scale is log")),
        _ => Err(Error::value(format!("{field}.scale"), scale, "\"linear\" or \"log\"")),
    }
}

fn rounded(exact: f64) -> f64 {
    format!("{exact:.*e}", DIGITS - 1).parse().unwrap_or(exact)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Result<Vec<Value>> {
        let table: Table = toml::from_str(&format!("x = {text}")).expect("TOML");
        values("x", &table["x"])
    }

    fn numbers(text: &str) -> Vec<f64> {
        of(text).expect("values").iter().filter_map(number).collect()
    }

    #[test]
    fn lists_and_ranges() {
        assert_eq!(numbers("[0, 20, 50.5]"), [0.0, 20.0, 50.5]);
        assert_eq!(numbers("{ from = 3, to = 6 }"), [3.0, 4.0, 5.0, 6.0]);
        assert_eq!(numbers("{ from = 0, to = 1, count = 5 }"), [0.0, 0.25, 0.5, 0.75, 1.0]);
        assert_eq!(
            numbers("{ from = 1e-4, to = 1e-1, count = 4, scale = 'log' }"),
            [1e-4, 1e-3, 1e-2, 1e-1]
        );
    }

    #[test]
    fn what_is_neither_is_refused_by_name() {
        let cases = [
            ("3", "x is 3"),
            ("[]", "x is empty"),
            ("[1, 2, 1.0]", "x is 1.0 twice"),
            ("{ from = 4, to = 3 }", "x.to is 3"),
            ("{ from = 1.0, to = 3 }", "x.count is missing"),
            ("{ from = 1, to = 3, count = 1 }", "x.count is 1"),
            ("{ from = 0, to = 3, count = 3, scale = 'log' }", "x.from is 0"),
            ("{ from = 1, to = 3, count = 3, scale = 'cubic' }", "x.scale is"),
            ("{ from = 1, to = 3, by = 3 }", "x.by is given"),
            ("{ from = 1, to = nan, count = 3 }", "x.to is nan"),
        ];
        for (text, said) in cases {
            let error = of(text).expect_err(text).to_string();
            assert!(error.starts_with(said), "{text}: {error}");
        }
    }
}
