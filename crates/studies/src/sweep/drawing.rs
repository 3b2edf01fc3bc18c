//! Draws the picture of a sweep: the mean slump of each combination of settings against a varied setting.

use serde_json::Value;

use super::drawing_choice::SweepChart;
use super::run_group::RunGroup;
use crate::chart::{Axis, Chart, Layer, Look, PALETTE, Point, Sheet};
use crate::harness::{Effort, Machine, distinct};

/// Ratio of the largest to the smallest value on an axis, at and above which the axis is logarithmic.
const LONG: f64 = 8.0;
/// Largest number of different values on an axis with which each value gets its own label. With more values, only round
/// numbers are labelled.
const MOST_TICKS: usize = 6;
/// Margin of the x axis beyond the smallest and the largest value, as a fraction of the distance between these values.
const MARGIN: f64 = 0.06;

fn is_level(chart: &SweepChart, group: &RunGroup) -> bool {
    let is_same = |(name, value): (&String, &toml::Value)| {
        let value = serde_json::to_value(value).unwrap_or_default();
        words(&value) == words(&group.settings[name.as_str()])
    };
    !chart.level.is_empty() && chart.level.iter().all(is_same)
}

/// Draws the mean slump of each group of runs (the runs that only differ in their initial state). A setting that varies
/// in the full pass can be constant in a quick pass (a pass with fewer runs); then it does not distinguish panels and
/// curves.
pub(super) fn sheet(
    choice: &SweepChart,
    groups: &[RunGroup],
    machine: &Machine,
    effort: Effort,
) -> Sheet {
    let said = |group: &RunGroup, name: &String| match group.settings.get(name.as_str()) {
        Some(value) => format!("{name} {}", words(value)),
        None => String::new(),
    };
    let panel_of = |group: &RunGroup| {
        let all: Vec<String> = choice.panels.iter().map(|name| said(group, name)).collect();
        all.join(", ")
    };
    let x_of = |group: &RunGroup| group.settings.get(choice.x.as_str()).and_then(Value::as_f64);
    let swept = || groups.iter().filter(|group| !is_level(choice, group));
    let x = axis(&choice.x, swept().filter_map(x_of));
    let highest = groups.iter().map(|group| group.slump[0] + finite(group.slump[1]));
    let lowest = groups.iter().map(|group| group.slump[0] - finite(group.slump[1]));
    let [low, high] = [lowest.fold(0.0, f64::min), highest.fold(0.1, f64::max)];
    let titles = distinct(groups.iter().map(panel_of));
    let curves = distinct(groups.iter().map(|group| said(group, &choice.curves)));
    let mut charts = Vec::new();
    for title in &titles {
        let y = Axis::linear("slump", 1.05 * low, 1.05 * high);
        let mut chart = Chart::new(title.clone(), x.clone(), y);
        for (number, name) in curves.iter().enumerate() {
            let colour = PALETTE[number % PALETTE.len()];
            let is_its = |group: &&RunGroup| {
                panel_of(group) == *title && said(group, &choice.curves) == *name
            };
            let point = |x: f64, group: &RunGroup| {
                let [mean, half] = group.slump;
                let interval = half.is_finite().then_some((mean - half, mean + half));
                Point { x, y: mean, interval }
            };
            let level = groups.iter().filter(is_its).find(|group| is_level(choice, group));
            if let Some(group) = level {
                let ends = [x.from, x.to].map(|x| Point { x, y: group.slump[0], interval: None });
                let name = format!("{name}, level");
                chart.layers.push(Layer::quiet(name, ends.to_vec(), colour, Look::Dashes(2)));
            }
            let points = swept().filter(is_its).filter_map(|it| Some(point(x_of(it)?, it)));
            let curve = Layer::curve(name, points.collect(), colour, Look::LineAndDots);
            chart.layers.push(curve.beside(number, curves.len()));
        }
        charts.push(chart);
    }
    let starts = groups.iter().map(|group| group.starts);
    let (least, most) =
        (starts.clone().min().unwrap_or_default(), starts.max().unwrap_or_default());
    let starts = if least == most { least.to_string() } else { format!("{least} to {most}") };
    let mut caption = vec![format!("Means over {starts} starts with 95 % intervals.")];
    if !choice.level.is_empty() {
        let all: Vec<String> =
            choice.level.iter().map(|(name, value)| format!("{name} {value}")).collect();
        caption[0].push_str(&format!(" Dashes: {}.", all.join(", ").replace('"', "")));
    }
    caption.push(format!("{}{}", effort.note(), machine.words()));
    Sheet { size: (380 * charts.len().max(2) as u32, 480), charts, caption }
}

fn finite(half: f64) -> f64 {
    if half.is_finite() { half } else { 0.0 }
}

fn words(value: &Value) -> String {
    match (value.as_f64(), value.as_str()) {
        (Some(number), _) if number != 0.0 && number.abs() < 1e-2 => format!("{number:e}"),
        (Some(number), _) => number.to_string(),
        (None, Some(text)) => text.to_owned(),
        (None, None) => value.to_string(),
    }
}

fn axis(name: &str, numbers: impl Iterator<Item = f64> + Clone) -> Axis {
    let [low, high] =
        [f64::min, f64::max].map(|best| numbers.clone().reduce(best).unwrap_or(f64::NAN));
    let axis = if low > 0.0 && high >= LONG * low {
        let margin = (high / low).powf(MARGIN);
        Axis::log(name, low / margin, high * margin)
    } else if high > low {
        let margin = MARGIN * (high - low);
        Axis::linear(name, low - margin, high + margin)
    } else {
        // There is only one value, or no value.
        let middle = if low.is_finite() { low } else { 0.0 };
        Axis::linear(name, middle - 1.0, middle + 1.0)
    };
    let tick = |number| (number, words(&Value::from(number)));
    let ticks: Vec<(f64, String)> = distinct(numbers).into_iter().map(tick).collect();
    // With more values, labels at round numbers are sufficient.
    if ticks.len() > MOST_TICKS { axis } else { Axis { ticks, ..axis } }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Study;
    use crate::error::Result;

    const STUDY: &str = "name = \"made\"\n[base]\nscene = \"pile\"\n[vary]\nbond = [0, 20]\nmax-sweeps = [10, 1000]\n";

    fn parse(chart: &str) -> Result<Study> {
        Study::parse(&format!("{STUDY}[chart]\n{chart}"), "made.toml".as_ref(), false)
    }

    fn group(bond: f64, sweeps: u64, slump: f64) -> RunGroup {
        let mut group = RunGroup { starts: 3, slump: [slump, 0.1], ..RunGroup::default() };
        group.settings.insert("bond".into(), bond.into());
        group.settings.insert("max-sweeps".into(), sweeps.into());
        group
    }

    #[test]
    fn a_chart_has_a_panel_a_curve_and_a_level_line_for_what_it_names() {
        let chart = "x = \"max-sweeps\"\ncurves = \"max-sweeps\"\npanels = [\"bond\"]\nlevel = { max-sweeps = 1000 }";
        let chart = parse(chart).expect("a study").chart.expect("a chart");
        let groups = [(0.0, 10, 0.5), (0.0, 1000, 0.4), (20.0, 10, 0.3), (20.0, 1000, 0.2)];
        let groups = groups.map(|(bond, sweeps, slump)| group(bond, sweeps, slump));
        let sheet = sheet(&chart, &groups, &Machine::this("0").expect("a machine"), Effort::Full);
        assert_eq!(sheet.charts.len(), 2);
        let csv = String::from_utf8(sheet.to_csv().expect("CSV")).expect("text");
        assert!(csv.contains("\n2,max-sweeps 10,10,0.3,0.19999"), "{csv}");
        let level = csv.lines().filter(|line| line.starts_with("2,\"max-sweeps 1000, level\","));
        assert_eq!(level.filter(|line| line.contains(",0.2,")).count(), 2, "{csv}");
    }

    #[test]
    fn what_does_not_vary_is_refused_by_name() {
        for (chart, said) in [
            (
                "x = \"dt\"\ncurves = \"bond\"",
                "chart.x is dt, but must be a setting that varies: bond, max-sweeps",
            ),
            (
                "x = \"bond\"\ncurves = \"bond\"\npanels = [\"rho\"]",
                "chart.panels is rho, but must be",
            ),
            (
                "x = \"bond\"\ncurves = \"bond\"\nlevel = { mu = 1 }",
                "chart.level is mu, but must be",
            ),
        ] {
            let error = parse(chart).expect_err(chart).to_string();
            assert!(error.contains(said), "{error}");
        }
    }
}
